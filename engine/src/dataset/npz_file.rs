//! Planes, camera and pose as one NPZ file: what `numpy.load` opens.
//!
//! ```text
//! RADIANCE, DEPTH, …  (rows, columns) float32, an array a channel; NaN without a value
//! K                   (3, 3) float64, pixels, the centre of the top left pixel is (0, 0)
//! q_wxyz              (4,) float64, camera_from_body, scalar first
//! r_body_fixed_m      (3,) float64
//! sun_body_fixed      (3,) float64, unit vector
//! tdb_s_past_j2000    () float64
//! ```
//!
//! Arrays are stored as `numpy.savez` stores them, without compression, each a NPY file of format version 1.0.
//!
//! # References
//! NumPy Enhancement Proposal 1 (NPY format).

use std::io::{Cursor, Read as _, Write};
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

use super::error::DatasetError;
use super::record::ExposureMetadata;
use crate::render::Image;

/// Header and magic fill a multiple of this.
const ALIGNMENT: usize = 64;
/// `\x93NUMPY`, the version, the header's length.
const PREFIX_BYTES: usize = 10;

/// The bytes of a file with the planes of `image` and the geometry of `facts`. `path` names it in errors.
pub fn encode(path: &Path, image: &Image, facts: &ExposureMetadata) -> Result<Vec<u8>, DatasetError> {
    archive(image, facts).map_err(|source| DatasetError::EncodeNpz { path: path.to_path_buf(), source })
}

fn archive(image: &Image, facts: &ExposureMetadata) -> Result<Vec<u8>, zip::result::ZipError> {
    let mut file = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default());
    let mut add = |name: &str, array: Vec<u8>| {
        file.start_file(format!("{name}.npy"), options)?;
        Ok::<_, zip::result::ZipError>(file.write_all(&array)?)
    };
    for plane in &image.planes {
        let values: Vec<u8> = plane.values.iter().flat_map(|value| value.to_le_bytes()).collect();
        add(plane.name, npy("<f4", &[image.rows, image.columns], &values))?;
    }
    let doubles = |shape: &[usize], values: &[f64]| {
        npy("<f8", shape, &values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>())
    };
    add("K", doubles(&[3, 3], facts.camera.k.as_flattened()))?;
    add("q_wxyz", doubles(&[4], &facts.pose.q_wxyz))?;
    add("r_body_fixed_m", doubles(&[3], &facts.pose.r_body_fixed_m))?;
    add("sun_body_fixed", doubles(&[3], &facts.sun.direction_body_fixed))?;
    add("tdb_s_past_j2000", doubles(&[], &[facts.epoch.tdb_s_past_j2000]))?;
    Ok(file.finish()?.into_inner())
}

/// A NPY file of version 1.0, rows first.
fn npy(kind: &str, shape: &[usize], values: &[u8]) -> Vec<u8> {
    let sides: Vec<String> = shape.iter().map(ToString::to_string).collect();
    // Python's tuple of one.
    let comma = if sides.len() == 1 { "," } else { "" };
    let dictionary = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}{comma}), }}", sides.join(", "));
    let length = (PREFIX_BYTES + dictionary.len() + 1).next_multiple_of(ALIGNMENT) - PREFIX_BYTES;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{dictionary:<width$}\n", width = length - 1).bytes());
    bytes.extend(values);
    bytes
}

/// An array of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    pub name: String,
    /// NumPy's name of the type, as in `<f4`.
    pub kind: String,
    pub shape: Vec<usize>,
    /// The values where they are little-endian 32-bit floats; else nothing.
    pub single: Vec<f32>,
}

/// The arrays of a file whose arrays are stored as they are. `path` names it in errors.
pub fn read(path: &Path, bytes: &[u8]) -> Result<Vec<Array>, DatasetError> {
    let error = |source| DatasetError::DecodeNpz { path: path.to_path_buf(), source };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(error)?;
    let mut arrays = Vec::new();
    for index in 0..archive.len() {
        let mut file = archive.by_index(index).map_err(error)?;
        let name = file.name().map_err(error)?.trim_end_matches(".npy").to_owned();
        let mut array = Vec::new();
        file.read_to_end(&mut array).map_err(|source| error(source.into()))?;
        arrays.push(parse(name, &array).ok_or_else(|| DatasetError::UnknownFile { path: path.to_path_buf() })?);
    }
    Ok(arrays)
}

/// A NPY file of any version.
fn parse(name: String, bytes: &[u8]) -> Option<Array> {
    let [major, _] = *bytes.strip_prefix(b"\x93NUMPY")?.first_chunk()?;
    let (length, start) = match major {
        1 => (usize::from(u16::from_le_bytes(*bytes.get(8..)?.first_chunk()?)), 10),
        _ => (u32::from_le_bytes(*bytes.get(8..)?.first_chunk()?) as usize, 12),
    };
    let header = std::str::from_utf8(bytes.get(start..start + length)?).ok()?;
    let after = |key: &str| header.split_once(key).map(|(_, rest)| rest);
    let kind = after("'descr': '")?.split('\'').next()?.to_owned();
    let sides = after("'shape': (")?.split(')').next()?.split(',').map(str::trim).filter(|side| !side.is_empty());
    let shape = sides.map(|side| side.parse().ok()).collect::<Option<Vec<usize>>>()?;
    let values = bytes.get(start + length..)?;
    let single = match kind.as_str() {
        "<f4" => values.as_chunks().0.iter().map(|value| f32::from_le_bytes(*value)).collect(),
        _ => Vec::new(),
    };
    (kind != "<f4" || single.len() == shape.iter().product::<usize>()).then_some(())?;
    Some(Array { name, kind, shape, single })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Byte for byte what `numpy.save` of NumPy 2.4 writes for `numpy.array([[1, 2]], '<f4')`.
    #[test]
    fn an_array_is_written_as_numpy_writes_it() {
        let values: Vec<u8> = [1.0_f32, 2.0].iter().flat_map(|value| value.to_le_bytes()).collect();
        let file = npy("<f4", &[1, 2], &values);
        let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2), }";
        assert_eq!(&file[..10], b"\x93NUMPY\x01\x00\x76\x00");
        assert_eq!(file[10..128], *format!("{header:<117}\n").as_bytes());
        assert_eq!(file[128..], [0, 0, 0x80, 0x3f, 0, 0, 0, 0x40]);
    }
}
