//! Horizon tiles on disk.
//!
//! A tile is a TIFF that GDAL and Python open. Page `l` holds coefficients `4l … 4l+3` as eight 16-bit IEEE
//! floats per pixel, `Re X, Im X` of each in turn ([`super::pack`]), deflated. The pages are ordinary images
//! (`NewSubfileType` 0) and not overviews: they hold *other* coefficients, at the scale that the header states.
//! Rows run from the top of the map down, so the first row on disk is the last one of the grid; where the number of rows is no
//! multiple of a page's scale the partial box is the first row on disk.
//!
//! `ImageDescription` of page 0 is a JSON [`Header`] with all that a decoder needs. Where the map is gnomonic with
//! north up, page 0 also carries GeoTIFF keys.
//!
//! A tile is found by its [`Key`]: the SHA-256 of the heights, the map, the settings, the encoding and the format
//! version. Files are written under another name and renamed, so that a tile is whole or absent.

use std::fs::{self, File};
use std::io::{BufReader, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use bytemuck::cast_slice;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::encoder::colortype::ColorType;
use tiff::encoder::{Compression, DeflateLevel, TiffEncoder};
use tiff::tags::{ExtraSamples, PhotometricInterpretation, SampleFormat, Tag};

use super::band::Band;
use super::error::{Error, TileErrors};
use super::georeference;
use super::pack::{Encoding, HorizonMap, Texels};
use super::request::Request;
use super::settings::Settings;
use crate::terrain::{Face, Level};

/// Changes whenever a file of the same inputs would hold other bytes.
pub const FORMAT_VERSION: u32 = 1;

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
        hash.update([encoding as u8]);
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
    pub encoding: Encoding,
    /// `h(A) = Re Σ Xₖ e^{ikA}`: one-sided, radians.
    pub series: String,
    pub azimuth: String,
    pub elevation: String,
    pub pixel: String,
    pub body: BodyHeader,
    /// Pixels of the full resolution, and the pages' scales against it.
    pub columns: usize,
    pub rows: usize,
    pub scales: [usize; 4],
    pub settings: Settings,
    pub map: MapHeader,
    /// The swept level, then the coarser ones that only occlude.
    pub inputs: Vec<InputHeader>,
    pub errors: TileErrors,
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
            series: "h(A) = sum over k of Re X_k cos kA - Im X_k sin kA, in radians; page l holds k = 4l ... 4l+3".into(),
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
            scales: map.encoding.scales(),
            settings,
            map: MapHeader::new(face, level),
            inputs: face.levels[level..].iter().map(input).collect(),
            errors: map.errors,
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

/// Eight half floats per pixel.
struct Halves;

impl ColorType for Halves {
    type Inner = u16;
    const TIFF_VALUE: PhotometricInterpretation = PhotometricInterpretation::BlackIsZero;
    const BITS_PER_SAMPLE: &'static [u16] = &[16];
    const SAMPLE_FORMAT: &'static [SampleFormat] = &[SampleFormat::IEEEFP];

    fn horizontal_predict(_: &[u16], _: &mut Vec<u16>) {
        unreachable!("tiles are written without a predictor")
    }
}

/// Writes a tile under its final name once it is whole.
pub fn write(path: &Path, header: &Header, map: &HorizonMap) -> Result<(), Error> {
    if let Some(directory) = path.parent() {
        fs::create_dir_all(directory).map_err(|source| Error::write(directory, source))?;
    }
    let partial = path.with_extension("tif.writing");
    let outcome = write_pages(&partial, header, map);
    let outcome = outcome.and_then(|()| fs::rename(&partial, path).map_err(|source| Error::write(path, source)));
    if outcome.is_err() {
        // The first error is the one to report.
        let _ = fs::remove_file(&partial);
    }
    outcome
}

fn write_pages(path: &Path, header: &Header, map: &HorizonMap) -> Result<(), Error> {
    let file = File::create(path).map_err(|source| Error::write(path, source))?;
    let mut file = BufWriter::new(file);
    encode(&mut file, header, map).map_err(|source| match source {
        tiff::TiffError::IoError(source) => Error::write(path, source),
        source => Error::Encode { path: path.into(), source },
    })?;
    file.flush().and_then(|()| file.get_ref().sync_all()).map_err(|source| Error::write(path, source))
}

fn encode(file: &mut BufWriter<File>, header: &Header, map: &HorizonMap) -> tiff::TiffResult<()> {
    let description = serde_json::to_string(header).expect("a header is plain data");
    let mut encoder = TiffEncoder::new(file)?.with_compression(Compression::Deflate(DeflateLevel::Balanced));
    for (index, level) in map.levels.iter().enumerate() {
        let mut page = encoder.new_image::<Halves>(level.columns as u32, level.rows as u32)?;
        page.extra_samples(&[ExtraSamples::Unspecified; 7])?;
        page.rows_per_strip(64)?;
        if index == 0 {
            page.encoder().write_tag(Tag::ImageDescription, description.as_str())?;
            georeference::write_tags(page.encoder(), header)?;
        }
        let top_down: Vec<u16> =
            (level.texels.chunks(level.columns).rev()).flat_map(|row| cast_slice(row).to_vec()).collect();
        page.write_data(&top_down)?;
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
    let mut levels = Vec::new();
    for (page, scale) in header.scales.into_iter().enumerate() {
        if page > 0 {
            decoder.next_image().map_err(decode)?;
        }
        let mut level = Texels::empty(header.columns, header.rows, scale);
        let (got, expected) = (decoder.dimensions().map_err(decode)?, (level.columns as u32, level.rows as u32));
        if got != expected {
            return Err(Error::Page { path: path.into(), page, got, expected });
        }
        let DecodingResult::F16(halves) = decoder.read_image().map_err(decode)? else {
            return Err(Error::header(path, format!("page {page} does not hold half floats")));
        };
        let halves: &[u16] = cast_slice(&halves);
        if halves.len() != level.texels.len() * 8 {
            return Err(Error::header(path, format!("page {page} does not hold eight samples per pixel")));
        }
        for (row, halves) in level.texels.chunks_mut(level.columns).rev().zip(halves.chunks(8 * level.columns)) {
            bytemuck::cast_slice_mut::<_, u16>(row).copy_from_slice(halves);
        }
        levels.push(level);
    }
    let map = HorizonMap {
        encoding: header.encoding,
        columns: header.columns,
        rows: header.rows,
        levels,
        errors: header.errors,
    };
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
    serde_json::from_value(json).map_err(|error| Error::header(path, error))
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
