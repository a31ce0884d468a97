//! Horizon tiles on disk.
//!
//! A tile is a TIFF that GDAL and Python open: [`super::pages`] of whole numbers and a JSON [`Header`] with all that a
//! decoder needs. The specification of the file, from which `tests/vectors/decode.py` was written, stands below.
//!
//! A tile is found by its [`Key`]: the SHA-256 of the heights, the map, the settings, the encoding and the format
//! version. A tile is whole or absent ([`crate::files`]).
//!
#![doc = include_str!("FORMAT.md")]

use std::fs::{self, File};
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};

use bytemuck::cast_slice;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use tiff::decoder::{Decoder, Limits};
use tiff::encoder::{Compression, DeflateLevel, Predictor, TiffEncoder};
use tiff::tags::Tag;

use super::band::Band;
use super::error::{Error, TileErrors};
use super::fit::water;
use super::georeference;
use super::method::Method;
use super::pack::{Encoding, Family, HorizonMap, encoding};
use super::pages::{self, GDAL_METADATA, Page, PageHeader};
use super::request::Request;
use super::settings::Settings;
use super::sweep;
use crate::files::NewFile;
use crate::terrain::{Face, Level};

/// Changes whenever a file of the same inputs would hold other bytes.
pub const FORMAT_VERSION: u32 = 4;

const FORMAT: &str = "perilune horizon tile";

/// What identifies a tile.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Key(String);

impl Key {
    /// The key of the horizons asked for.
    pub fn of(request: &Request) -> Self {
        let Request { body, face, level, settings, encoding } = *request;
        let mut hash = Sha256::new();
        hash.update(FORMAT_VERSION.to_le_bytes());
        hash.update(&body.name);
        hash.update(cast_slice::<f64, u8>(&[body.equatorial_radius_m, body.polar_radius_m]));
        let map = &face.map;
        let numbers =
            [map.origin.vector_m().to_array(), [map.radius_m, settings.observer_height_m, settings.search_limit_m()]];
        hash.update(cast_slice::<f64, u8>(numbers.as_flattened()));
        hash.update(cast_slice::<f64, u8>(&map.map_from_body.matrix().to_cols_array()));
        hash.update((settings.azimuths as u64).to_le_bytes());
        hash.update(encoding.name());
        if encoding.family() == Family::Fields {
            hash.update([water::REVISION]);
        }
        match settings.method {
            Method::Sweep => hash.update([sweep::REVISION]),
            other => hash.update(format!("{other:?}")),
        }
        if let Some(Band { towards, reach_rad }) = settings.band {
            hash.update(b"band");
            hash.update(cast_slice::<f64, u8>(&[towards[0], towards[1], towards[2], reach_rad]));
        }
        for level in &face.levels[level..] {
            hash.update(level_hash(level));
        }
        Self(crate::digest::hex(&hash.finalize()))
    }

    pub fn as_str(&self) -> &str {
        &self.0
    }
}

fn level_hash(level: &Level) -> [u8; 32] {
    let mut hash = Sha256::new();
    let sizes = [level.columns as u64, level.rows as u64, level.margin as u64];
    hash.update(cast_slice::<u64, u8>(&sizes));
    hash.update(cast_slice::<f64, u8>(&[level.posting_m, level.west_m, level.south_m]));
    hash.update(cast_slice::<f32, u8>(&level.heights_m));
    hash.update(level.gap.iter().map(|gap| u8::from(*gap)).collect::<Vec<_>>());
    hash.finalize().into()
}

/// All that a decoder needs, as JSON in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    pub format: String,
    pub format_version: u32,
    pub generator: String,
    pub key: Key,
    #[serde(with = "encoding::by_name")]
    pub encoding: Encoding,
    /// `h(A) = Re Σ Xₖ e^{ikA}`: one-sided, radians.
    pub series: String,
    /// κ of [`super::companding`], where the series is of compressed elevations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub growth: Option<f64>,
    pub azimuth: String,
    pub elevation: String,
    pub pixel: String,
    pub body: BodyHeader,
    /// Nodes of the grid.
    pub columns: usize,
    pub rows: usize,
    pub settings: Settings,
    pub map: MapHeader,
    /// The swept level, then the coarser ones that only occlude.
    pub inputs: Vec<InputHeader>,
    pub errors: TileErrors,
    /// In the order of the file; filled in by [`write()`].
    pub pages: Vec<PageHeader>,
}

/// The spheroid that latitudes refer to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BodyHeader {
    pub name: String,
    pub equatorial_radius_m: f64,
    pub polar_radius_m: f64,
}

/// The gnomonic map of a tile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MapHeader {
    pub projection: String,
    pub radius_m: f64,
    /// Centre of projection, body-fixed.
    pub origin_m: [f64; 3],
    /// Body-fixed axes: right and up on the map, and outward.
    pub right: [f64; 3],
    pub up: [f64; 3],
    pub outward: [f64; 3],
    pub posting_m: f64,
    /// Map coordinates of the first seen node, bottom left.
    pub west_m: f64,
    pub south_m: f64,
    /// Latitude and longitude of the map's centre, and the map for PROJ; absent where it is no map about the body's
    /// centre with north up.
    pub centre_deg: Option<[f64; 2]>,
    pub proj4: Option<String>,
}

/// One level of heights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InputHeader {
    pub columns: usize,
    pub rows: usize,
    pub posting_m: f64,
    pub margin: usize,
    pub sha256: String,
}

impl Header {
    pub fn new(request: &Request, map: &HorizonMap) -> Self {
        let Request { body, face, level, settings, .. } = *request;
        let input = |level: &Level| InputHeader {
            columns: level.columns,
            rows: level.rows,
            posting_m: level.posting_m,
            margin: level.margin,
            sha256: crate::digest::hex(&level_hash(level)),
        };
        Self {
            format: FORMAT.into(),
            format_version: FORMAT_VERSION,
            generator: format!("perilune {}", env!("CARGO_PKG_VERSION")),
            key: request.key(),
            encoding: map.encoding,
            series: "h(A) = sum over pages of weight * value; weight: re k, a k: cos kA; im k: -sin kA; b k: sin kA; h i of n: \
                     max(0, 1 - |A n/2pi - i|); with a growth the skyline is h + growth * h^3"
                .into(),
            growth: map.encoding.growth(),
            azimuth: "map azimuth, clockwise from map up (+Y) towards map right (+X)".into(),
            elevation: "above the plane perpendicular to the vector from the centre of projection".into(),
            pixel: "pixel centres are grid nodes; a texel of scale s is the mean of its s x s nodes, counted from the bottom left".into(),
            body: BodyHeader {
                name: body.name.clone(),
                equatorial_radius_m: body.equatorial_radius_m,
                polar_radius_m: body.polar_radius_m,
            },
            columns: map.columns,
            rows: map.rows,
            settings,
            map: MapHeader::new(face, level),
            inputs: face.levels[level..].iter().map(input).collect(),
            errors: map.errors,
            pages: Vec::new(),
        }
    }
}

impl MapHeader {
    fn new(face: &Face, level: usize) -> Self {
        let (map, level) = (&face.map, &face.levels[level]);
        let axes = map.map_from_body.matrix();
        let centre_deg = georeference::centre_deg(map);
        let corner_m = level.node_m(level.margin, level.margin);
        Self {
            projection: "gnomonic: X = R x/z, Y = R y/z, with x, y, z along right, up, outward from the origin".into(),
            radius_m: map.radius_m,
            origin_m: map.origin.vector_m().to_array(),
            right: axes.row(0).to_array(),
            up: axes.row(1).to_array(),
            outward: axes.row(2).to_array(),
            posting_m: level.posting_m,
            west_m: corner_m.x,
            south_m: corner_m.y,
            centre_deg,
            proj4: centre_deg.map(|centre_deg| georeference::proj4(map.radius_m, centre_deg)),
        }
    }
}

/// Where the tile of a key lies in a directory.
pub fn path_for(directory: &Path, key: &Key) -> PathBuf {
    directory.join(format!("horizon_{}.tif", &key.0[..16]))
}

/// Writes a tile under its final name once it is whole.
pub fn write(path: &Path, header: &Header, map: &HorizonMap) -> Result<(), Error> {
    if let Some(directory) = path.parent() {
        fs::create_dir_all(directory).map_err(|source| Error::write(directory, source))?;
    }
    let mut file = BufWriter::new(NewFile::create(path).map_err(|source| Error::write(path, source))?);
    encode(&mut file, header, map).map_err(|source| match source {
        tiff::TiffError::IoError(source) => Error::write(path, source),
        source => Error::Encode { path: path.into(), source },
    })?;
    let file = file.into_inner().map_err(|error| Error::write(path, error.into_error()))?;
    file.commit().map(|_| ()).map_err(|source| Error::write(path, source))
}

fn encode(file: &mut BufWriter<NewFile>, header: &Header, map: &HorizonMap) -> tiff::TiffResult<()> {
    // The last 2 % of a water-filled texel's codes would take as long as all else.
    let effort = if map.encoding.gain_bits() > 0 { DeflateLevel::Balanced } else { DeflateLevel::Best };
    let mut file = TiffEncoder::new(file)?.with_compression(Compression::Deflate(effort));
    let header = Header { pages: pages::pages(map).map(|page| page.header).collect(), ..header.clone() };
    let description = serde_json::to_string(&header).expect("a header is plain data");
    for (index, page) in pages::pages(map).enumerate() {
        // Fields are differences from coarser pages already.
        let is_residual = page.header.field.is_some();
        file = file.with_predictor(if is_residual { Predictor::None } else { Predictor::Horizontal });
        page.write(&mut file, |tags| {
            if index == 0 {
                tags.write_tag(Tag::ImageDescription, description.as_str())?;
            }
            // Where texels have gains there is no one scale.
            if let Some(metadata) = page.gdal_metadata().filter(|_| map.encoding.gain_bits() == 0) {
                tags.write_tag(Tag::Unknown(GDAL_METADATA), metadata.as_str())?;
            }
            // The pictures that people look at: the mean, or the first sample, and the bound.
            let is_shown = page.header.scale == 1 && (index == 0 || index + 1 == header.pages.len());
            if is_shown { georeference::write_tags(tags, &header) } else { Ok(()) }
        })?;
    }
    Ok(())
}

/// Reads a tile with its header.
pub fn read(path: &Path) -> Result<(Header, HorizonMap), Error> {
    let file = File::open(path).map_err(|source| Error::read(path, source))?;
    let decode = |source| Error::Decode { path: path.into(), source };
    let mut decoder = Decoder::new(BufReader::new(file)).map_err(decode)?.with_limits(Limits::unlimited());
    let description = decoder.get_tag_ascii_string(Tag::ImageDescription).map_err(decode)?;
    let header = parse(path, &description)?;
    let mut pages = Vec::new();
    for (index, page) in header.pages.iter().enumerate() {
        if index > 0 {
            decoder.next_image().map_err(decode)?;
        }
        let (got, expected) = (decoder.dimensions().map_err(decode)?, (page.columns as u32, page.rows as u32));
        if got != expected {
            return Err(Error::Page { path: path.into(), page: index, got, expected });
        }
        let values = pages::read_values(&mut decoder, page.columns).map_err(decode)?;
        let values = values.ok_or_else(|| Error::header(path, format!("page {index} does not hold whole numbers")))?;
        pages.push(Page { header: page.clone(), values });
    }
    let map = pages::map(&pages, header.encoding, header.columns, header.rows, header.errors);
    let map = map.ok_or_else(|| Error::header(path, format!("its pages are not those of {}", header.encoding)))?;
    Ok((header, map))
}

fn parse(path: &Path, description: &str) -> Result<Header, Error> {
    let json: serde_json::Value = serde_json::from_str(description).map_err(|error| Error::header(path, error))?;
    if json["format"] != FORMAT {
        return Err(Error::header(path, "no format name"));
    }
    let got = json["format_version"].as_u64().unwrap_or(0) as u32;
    if got != FORMAT_VERSION {
        return Err(Error::Version { path: path.into(), got, expected: FORMAT_VERSION });
    }
    let header: Header = serde_json::from_value(json).map_err(|error| Error::header(path, error))?;
    if header.growth != header.encoding.growth() {
        return Err(Error::header(path, format!("its growth is not that of {}", header.encoding)));
    }
    Ok(header)
}

/// Reads the tile of a key.
pub fn read_of(directory: &Path, key: &Key) -> Result<HorizonMap, Error> {
    let path = path_for(directory, key);
    let (header, map) = read(&path)?;
    if header.key != *key {
        return Err(Error::OtherKey { path, got: header.key.0, expected: key.0.clone() });
    }
    Ok(map)
}
