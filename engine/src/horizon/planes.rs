//! The skylines of all nodes of a level in single azimuths: swept, kept in 16 bits, stored one plane a tile.
//!
//! ```text
//! elevation = low + unit · value,   value = 0 … 65535 over the plane's own range
//! ```
//!
//! Rounding moves an elevation by half a unit: 1e-5 rad, 1/400 of the Sun's radius, where skylines stand up to 75° high.
//! Two bytes a node, deflated on disk. A plane's key ([`key`]) is that of the level's horizons and the azimuth, so that an
//! interrupted run goes on with the planes that it has, and scenarios under a similar Sun share theirs.

use std::fs::{self, File};
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};

use bytemuck::cast_slice;
use glam::DVec2;
use serde::{Deserialize, Serialize};
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::encoder::colortype::Gray16;
use tiff::encoder::{Compression, DeflateLevel, TiffEncoder};
use tiff::tags::Tag;

use super::axis::Major;
use super::error::Error;
use super::pack::Encoding;
use super::request::Request;
use super::settings::Settings;
use super::sweep::Sweep;
use crate::files::NewFile;
use crate::geometry::Body;
use crate::terrain::Face;

const FORMAT: &str = "perilune horizon plane";

/// Sweeps of one level along both axes, as far as they are needed.
#[derive(Debug)]
pub struct Sweeps<'a> {
    along_rows: Option<Sweep<'a>>,
    along_columns: Option<Sweep<'a>>,
}

impl<'a> Sweeps<'a> {
    /// Prepares a level for unit map directions.
    pub fn new(face: &'a Face, level: usize, settings: &Settings, directions: &[DVec2]) -> Self {
        let prepare = |major: Major| {
            let needed = directions.iter().any(|towards| Major::of(*towards) == major);
            needed.then(|| Sweep::new(face, level, major, settings))
        };
        Self { along_rows: prepare(Major::Row), along_columns: prepare(Major::Column) }
    }

    /// Elevations of the skyline at the seen nodes, row by row, in one of the directions.
    pub fn elevations_rad(&self, towards: DVec2) -> Vec<f32> {
        let major = Major::of(towards);
        let sweep = match major {
            Major::Row => &self.along_rows,
            Major::Column => &self.along_columns,
        };
        let sweep = sweep.as_ref().expect("the sweeps were prepared for this direction");
        let (plane, r) = (sweep.elevations_rad(towards), &sweep.receivers);
        match major {
            Major::Row => plane.chunks(r.stride).flat_map(|row| &row[..r.minors]).copied().collect(),
            Major::Column => {
                (0..r.minors).flat_map(|row| plane.iter().skip(row).step_by(r.stride).take(r.majors)).copied().collect()
            }
        }
    }
}

/// Elevations of the skyline at all seen nodes of a level in one azimuth.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredPlane {
    pub columns: usize,
    pub rows: usize,
    low_rad: f32,
    unit_rad: f32,
    /// Row by row, rows up the map.
    values: Vec<u16>,
}

impl StoredPlane {
    pub fn new(columns: usize, elevations_rad: &[f32]) -> Self {
        let range = elevations_rad.iter().fold((f32::MAX, f32::MIN), |(low, high), e| (low.min(*e), high.max(*e)));
        let (low_rad, high_rad) = if range.0 <= range.1 { range } else { (0.0, 0.0) };
        let unit_rad = (high_rad - low_rad) / f32::from(u16::MAX);
        let value = |elevation_rad: &f32| ((elevation_rad - low_rad) / unit_rad).round() as u16;
        let rows = elevations_rad.len() / columns;
        Self { columns, rows, low_rad, unit_rad, values: elevations_rad.iter().map(value).collect() }
    }

    pub fn elevation_rad(&self, index: usize) -> f32 {
        self.low_rad + self.unit_rad * f32::from(self.values[index])
    }

    /// What rounding may have moved an elevation by.
    pub fn rounding_rad(&self) -> f32 {
        0.5 * self.unit_rad
    }

    pub fn bytes(&self) -> usize {
        size_of_val(self.values.as_slice())
    }
}

/// What the keys of a level's planes begin with: all that shapes its horizons but azimuths, band and encoding. It reads all
/// heights.
pub fn level_key(body: &Body, face: &Face, level: usize, settings: &Settings) -> String {
    let settings = Settings { azimuths: 0, band: None, ..*settings };
    Request { body, face, level, settings, encoding: Encoding::Fm16 }.key().as_str().into()
}

/// The key of a plane.
pub fn key(level_key: &str, azimuth_rad: f64) -> String {
    crate::digest::sha256_hex(format!("{FORMAT} {level_key} {}", shortest(azimuth_rad)).as_bytes())
}

/// The shortest decimal that reads back as a number: with a fraction always, with an exponent below 1e-4 and from 1e16 on.
fn shortest(number: f64) -> String {
    let size = number.abs();
    match size {
        _ if size != 0.0 && !(1e-4..1e16).contains(&size) => format!("{number:e}"),
        _ if number.fract() == 0.0 => format!("{number}.0"),
        _ => number.to_string(),
    }
}

/// All that a decoder needs, as JSON in the file.
#[derive(Debug, Serialize, Deserialize)]
struct PlaneHeader {
    format: String,
    key: String,
    azimuth_rad: f64,
    low_rad: f32,
    unit_rad: f32,
    /// Hash of the values, little-endian.
    sha256: String,
}

/// Where the plane of a key lies.
pub fn path_for(directory: &Path, key: &str) -> PathBuf {
    directory.join(format!("plane_{}.tif", &key[..16]))
}

/// Writes a plane under its final name once it is whole.
pub fn write(directory: &Path, key: &str, azimuth_rad: f64, plane: &StoredPlane) -> Result<(), Error> {
    fs::create_dir_all(directory).map_err(|source| Error::write(directory, source))?;
    let path = path_for(directory, key);
    let header = PlaneHeader {
        format: FORMAT.into(),
        key: key.into(),
        azimuth_rad,
        low_rad: plane.low_rad,
        unit_rad: plane.unit_rad,
        sha256: digest(&plane.values),
    };
    let description = serde_json::to_string(&header).expect("a header is plain data");
    let mut file = BufWriter::new(NewFile::create(&path).map_err(|source| Error::write(&path, source))?);
    let encoded = (|| {
        let mut encoder = TiffEncoder::new(&mut file)?.with_compression(Compression::Deflate(DeflateLevel::Fast));
        let mut page = encoder.new_image::<Gray16>(plane.columns as u32, plane.rows as u32)?;
        page.encoder().write_tag(Tag::ImageDescription, description.as_str())?;
        let top_down: Vec<u16> = plane.values.chunks(plane.columns).rev().flatten().copied().collect();
        page.write_data(&top_down)
    })();
    encoded.map_err(|source| match source {
        tiff::TiffError::IoError(source) => Error::write(&path, source),
        source => Error::Encode { path: path.clone(), source },
    })?;
    let file = file.into_inner().map_err(|error| Error::write(&path, error.into_error()))?;
    file.commit().map(|_| ()).map_err(|source| Error::write(&path, source))
}

/// Reads the plane of a key of a level with so many seen nodes.
pub fn read(directory: &Path, key: &str, [columns, rows]: [usize; 2]) -> Result<StoredPlane, Error> {
    let path = path_for(directory, key);
    let file = File::open(&path).map_err(|source| Error::read(&path, source))?;
    let decode = |source| Error::Decode { path: path.clone(), source };
    let mut decoder = Decoder::new(BufReader::new(file)).map_err(decode)?.with_limits(Limits::unlimited());
    let description = decoder.get_tag_ascii_string(Tag::ImageDescription).map_err(decode)?;
    let header: PlaneHeader = serde_json::from_str(&description).map_err(|error| Error::header(&path, error))?;
    if header.format != FORMAT || header.key != key {
        return Err(Error::OtherKey { path, got: header.key, expected: key.into() });
    }
    let (got, expected) = (decoder.dimensions().map_err(decode)?, (columns as u32, rows as u32));
    if got != expected {
        return Err(Error::Page { path, page: 0, got, expected });
    }
    let DecodingResult::U16(top_down) = decoder.read_image().map_err(decode)? else {
        return Err(Error::header(&path, "it does not hold 16-bit numbers"));
    };
    let values: Vec<u16> = top_down.chunks(columns).rev().flatten().copied().collect();
    if digest(&values) != header.sha256 {
        return Err(Error::header(&path, "its values do not have the SHA-256 that it states"));
    }
    Ok(StoredPlane { columns, rows, low_rad: header.low_rad, unit_rad: header.unit_rad, values })
}

fn digest(values: &[u16]) -> String {
    crate::digest::sha256_hex(cast_slice(values))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A key that changes leaves every plane out there to be made anew.
    #[test]
    fn keys_are_those_of_planes_that_were_kept() {
        let cases = [
            (0.0, "fbbd8889abcbf2cf5acf28ae9810b66bb14aca776b43b9102c4ac68bfc85418f"),
            (1.5, "5630652457499c703148d1aef947e499b9a4dbc738810c23309ce7102ece1d97"),
            (0.1, "737c0747e26da0b0e3d6ff78dac9cb6eec5aa72b456ee959eb8fa36a1f19f177"),
            (1e-4, "4a308883e96ee29b41981082ccd9a41f0f7ba6ee6a93f96587cc0007b6916a11"),
            (9.9e-5, "db576688f43ac69afac06a793bd45330d0b6d14a6831f0aecdf98b26195f4ed8"),
            (2e16, "fe27cbc141b59b4a0e6860348f4519596136bf4874050cf37fa85880eab65a5b"),
        ];
        for (azimuth_rad, expected) in cases {
            assert_eq!(key("0123abcd", azimuth_rad), expected, "{azimuth_rad}");
        }
    }
}
