//! Planes as one OpenEXR file: 32-bit floats, a channel each, lossless.
//!
//! The header holds one attribute of our own, `perilune`: JSON with units and the record. It is one, because the
//! writer keeps attributes in a hash map, and two would change places from run to run. `comments` tells the units
//! to people.

use std::io::Cursor;
use std::path::Path;

use exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock};
use exr::block::writer::ChunksWriter;
use exr::error::Error as ExrError;
use exr::meta::attribute::{ChannelDescription, SampleType};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, Headers};
use exr::prelude::*;
use serde_json::Value as Json;

use super::error::DatasetError;
use super::{disk, exr_blocks};
use crate::render;

const ATTRIBUTE: &str = "perilune";

/// What an OpenEXR file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct ExrFile {
    pub columns: usize,
    pub rows: usize,
    /// Name and values, in the order of the names.
    pub channels: Vec<(String, Vec<f32>)>,
    /// Null in files of other programs.
    pub metadata: Json,
}

/// The bytes of a file with the planes of `image` and `metadata` in its header. `path` names it in errors.
pub fn encode(path: &Path, image: &render::Image, metadata: &Json) -> std::result::Result<Vec<u8>, DatasetError> {
    let units: Vec<String> =
        image.planes.iter().map(|plane| format!("{} [{}]", plane.name, plane.quantity.unit())).collect();
    let mut attributes = LayerAttributes {
        comments: Some(Text::from(units.join(", ").as_str())),
        software_name: Some(Text::from(concat!("perilune ", env!("CARGO_PKG_VERSION")))),
        ..LayerAttributes::default()
    };
    let json = Text::from(metadata.to_string().as_str());
    attributes.other.insert(Text::from(ATTRIBUTE), AttributeValue::Text(json));
    // The format wants channels in the order of their names.
    let mut planes: Vec<&render::Plane> = image.planes.iter().collect();
    planes.sort_by_key(|plane| plane.name);
    let channels = planes.iter().map(|plane| ChannelDescription::named(plane.name, SampleType::F32)).collect();
    // Lines rather than tiles: what every reader knows.
    let header = Header::new(Text::default(), (image.columns, image.rows), channels)
        .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_attributes(attributes);
    let values: Vec<&[f32]> = planes.iter().map(|plane| plane.values.as_slice()).collect();
    let blocks = exr_blocks::compressed(&values, image.columns, image.rows);
    let mut bytes = Cursor::new(Vec::new());
    exr::block::write(&mut bytes, Headers::from_elem(header, 1), true, |_, writer| {
        for (index, (first_row, compressed_pixels_le)) in blocks.into_iter().enumerate() {
            let y_coordinate = i32::try_from(first_row)?;
            let block = CompressedScanLineBlock { y_coordinate, compressed_pixels_le };
            writer.write_chunk(index, Chunk { layer_index: 0, compressed_block: CompressedBlock::ScanLine(block) })?;
        }
        Ok(())
    })
    .map_err(|source| DatasetError::EncodeExr { path: path.to_path_buf(), source })?;
    Ok(bytes.into_inner())
}

/// Writes `image` to `path`, whole or not at all.
pub fn write_exr(path: &Path, image: &render::Image, metadata: &Json) -> std::result::Result<(), DatasetError> {
    disk::write(path, &encode(path, image, metadata)?)
}

/// Reads the first part of an OpenEXR file as 32-bit floats.
pub fn read_exr(path: &Path) -> std::result::Result<ExrFile, DatasetError> {
    let bytes = disk::read(path)?;
    decode(&bytes).map_err(|source| DatasetError::DecodeExr { path: path.to_path_buf(), source })
}

fn decode(bytes: &[u8]) -> std::result::Result<ExrFile, ExrError> {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))?;
    let layer = image.layer_data;
    let metadata = match layer.attributes.other.get(&Text::from(ATTRIBUTE)) {
        Some(AttributeValue::Text(text)) => serde_json::from_str(&text.to_string()).unwrap_or_default(),
        _ => Json::Null,
    };
    let channel = |channel: &AnyChannel<FlatSamples>| {
        (channel.name.to_string(), channel.sample_data.values_as_f32().collect::<Vec<f32>>())
    };
    let channels = layer.channel_data.list.iter().map(channel).collect();
    Ok(ExrFile { columns: layer.size.width(), rows: layer.size.height(), channels, metadata })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Plane, Quantity};

    fn image() -> render::Image {
        let plane = |quantity: Quantity, name, offset: f32| Plane {
            quantity,
            name,
            values: (0..35).map(|pixel| if pixel == 3 { f32::NAN } else { offset + pixel as f32 / 7.0 }).collect(),
        };
        let planes = vec![
            plane(Quantity::Radiance, "RADIANCE", 0.0),
            plane(Quantity::Normal, "NORMAL.X", 1e-30),
            plane(Quantity::Depth, "DEPTH", 1e6),
        ];
        render::Image { columns: 7, rows: 5, planes }
    }

    #[test]
    fn planes_come_back_bit_for_bit_with_their_metadata() {
        let folder = tempfile::TempDir::new().unwrap();
        let path = folder.path().join("a.exr");
        let metadata = serde_json::json!({ "unit": "W m-2 sr-1 µ", "list": [1.5, null] });
        write_exr(&path, &image(), &metadata).unwrap();
        let back = read_exr(&path).unwrap();
        assert_eq!((back.columns, back.rows), (7, 5));
        assert_eq!(back.metadata, metadata);
        let names: Vec<&str> = back.channels.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["DEPTH", "NORMAL.X", "RADIANCE"]);
        for plane in image().planes {
            let (_, values) = back.channels.iter().find(|(name, _)| name == plane.name).unwrap();
            let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(values), bits(&plane.values));
        }
    }

    /// The hash map of attributes has another seed in each instance: equal bytes do not come by luck.
    #[test]
    fn the_same_image_makes_the_same_bytes() {
        let bytes = || encode(Path::new("a"), &image(), &serde_json::json!({ "b": 1, "a": 2 })).unwrap();
        let first = bytes();
        for _ in 0..20 {
            assert_eq!(bytes(), first);
        }
    }

    #[test]
    fn a_truncated_file_is_an_error() {
        let folder = tempfile::TempDir::new().unwrap();
        let path = folder.path().join("a.exr");
        let bytes = encode(&path, &image(), &Json::Null).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
        assert!(matches!(read_exr(&path), Err(DatasetError::DecodeExr { .. })));
    }
}
