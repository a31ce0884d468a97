//! Planes of an exposure read back from whichever of its files holds them.

use std::path::Path;

use super::disk;
use super::error::DatasetError;
use super::exr_file;
use super::fits_planes;
use super::npz_file;
use super::record::FileRecord;

/// Some planes of an image.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredPlanes {
    pub columns: usize,
    pub rows: usize,
    /// Name and values.
    pub channels: Vec<(String, Vec<f32>)>,
}

impl StoredPlanes {
    /// From the first of an exposure's files that holds all planes.
    pub fn read(folder: &Path, files: &[FileRecord]) -> Result<Self, DatasetError> {
        let path = |extension: &str| {
            let ends = |file: &&FileRecord| file.name.split_once('.').is_some_and(|(_, end)| end == extension);
            files.iter().find(ends).map(|file| folder.join(&file.name))
        };
        if let Some(path) = path("exr") {
            let file = exr_file::read_exr(&path)?;
            return Ok(Self { columns: file.columns, rows: file.rows, channels: file.channels });
        }
        if let Some(path) = path("npz") {
            let arrays = npz_file::read(&path, &disk::read(&path)?)?;
            let is_plane = |array: &npz_file::Array| array.shape.len() == 2 && !array.single.is_empty();
            let planes: Vec<_> = arrays.into_iter().filter(is_plane).collect();
            let [rows, columns] = planes.first().map_or([0, 0], |plane| [plane.shape[0], plane.shape[1]]);
            let channels = planes.into_iter().map(|plane| (plane.name, plane.single)).collect();
            return Ok(Self { columns, rows, channels });
        }
        if let Some(path) = path("fits") {
            let planes = fits_planes::read(&disk::read(&path)?);
            let ([columns, rows], channels) = planes.ok_or(DatasetError::UnknownFile { path })?;
            return Ok(Self { columns, rows, channels });
        }
        Err(DatasetError::NoStoredPlanes { path: folder.to_path_buf() })
    }

    /// The values of a channel.
    pub fn take(&mut self, channel: &str) -> Option<Vec<f32>> {
        let found = self.channels.iter().position(|(name, _)| name == channel)?;
        Some(self.channels.swap_remove(found).1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::{ExposureMetadata, fits_file};
    use crate::render::{Image, Plane, Quantity};

    #[test]
    fn every_format_of_all_planes_gives_the_same_back() {
        let plane = |quantity, name, first: f32| {
            let values = (0..35).map(|pixel| if pixel == 3 { f32::NAN } else { first + pixel as f32 / 7.0 }).collect();
            Plane { quantity, name, values }
        };
        let planes = vec![plane(Quantity::Depth, "DEPTH", 1e6), plane(Quantity::Radiance, "RADIANCE", 0.1)];
        let image = Image { columns: 7, rows: 5, planes };
        let folder = tempfile::TempDir::new().unwrap();
        let facts = ExposureMetadata::default();
        let files = [
            ("a.exr", exr_file::encode(Path::new("a"), &image, &serde_json::Value::Null).unwrap()),
            ("a.npz", npz_file::encode(Path::new("a"), &image, &facts).unwrap()),
            ("a.fits", fits_file::encode(&image, &facts, "key")),
        ];
        for (name, bytes) in files {
            std::fs::write(folder.path().join(name), &bytes).unwrap();
            let mut back = StoredPlanes::read(folder.path(), &[FileRecord::of(name, &bytes)]).unwrap();
            assert_eq!((back.columns, back.rows), (7, 5), "{name}");
            for plane in &image.planes {
                let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&back.take(plane.name).unwrap()), bits(&plane.values), "{name}");
            }
        }
        assert!(StoredPlanes::read(folder.path(), &[]).is_err());
    }
}
