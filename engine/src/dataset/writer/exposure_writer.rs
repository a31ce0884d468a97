//! The files of single exposures: bytes, which of them are whole or finished.

use std::fs;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use serde_json::{Value as Json, json};

use super::previews::{Previews, Shown};
use super::{Exposure, LANDMARKS, LINEAR, OVERLAY, Orthoimage, Settings, Spent, pretty};
use crate::dataset::disk;
use crate::dataset::error::DatasetError;
use crate::dataset::folder::{Finished, index_of, name};
use crate::dataset::format::Format;
use crate::dataset::landmarks::{self, LandmarkFile};
use crate::dataset::manifest::{PreviewScale, exposure_key};
use crate::dataset::preview::{self, Thumbnail};
use crate::dataset::record::{self, FileRecord, PlaneRecord, PreviewRecord, Record, SCHEMA_VERSION};
use crate::dataset::stored_planes::StoredPlanes;
use crate::dataset::{exr_file, fits_file, npz_file, png_file, tiff_file};
use crate::raster::{GeoTiff, GeoTiffBand};
use crate::render::{Image, Plane, Quantity};

/// Reads and writes the files of exposures.
#[derive(Debug, Clone)]
pub struct ExposureWriter {
    pub directory: PathBuf,
    pub key: String,
    /// What each exposure is made from besides what they share.
    pub exposures: Arc<[Json]>,
    pub settings: Settings,
    pub previews: Previews,
}

impl ExposureWriter {
    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.join(name)
    }

    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<FileRecord, DatasetError> {
        disk::write(&self.path(name), bytes)?;
        Ok(FileRecord::of(name, bytes))
    }

    /// The record last: it says that the exposure is finished.
    pub fn write_exposure(&self, exposure: Exposure, spent: &mut Spent) -> Result<(), DatasetError> {
        let index = exposure.index;
        check(index, &exposure.image)?;
        let record_name = name(index, "json");
        if self.finished(index).is_none() {
            // Another's record would vouch for this run's files. Two processes of one run write the same bytes.
            let _ = fs::remove_file(self.path(&record_name));
        }
        let start = Instant::now();
        let planes = record::planes(&exposure.image);
        let encoded = self.encoded(&exposure, &planes)?;
        let mut files: Vec<FileRecord> = encoded.iter().map(|(name, bytes)| FileRecord::of(name, bytes)).collect();
        if let Some(orthoimage) = &exposure.orthoimage {
            files.push(self.write_orthoimage(&name(index, "ortho.tif"), orthoimage)?);
        }
        let first_look = self.first_look(index, &exposure.image, &planes)?;
        let made_from = self.exposures.get(index).cloned().unwrap_or_default();
        let record = Record {
            schema_version: SCHEMA_VERSION.into(),
            run_key: self.key.clone(),
            exposure_key: exposure_key(&self.key, &made_from),
            made_from,
            facts: exposure.facts,
            planes,
            preview: None,
            files,
            sha256: String::new(),
        };
        let encoded_by = Instant::now();
        let record = record.text();
        let files = first_look.iter().chain(&encoded).map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
        disk::write_in_order(&self.directory, files.chain([(record_name.as_str(), record.as_bytes())]))?;
        spent.encoding += encoded_by - start;
        spent.writing += encoded_by.elapsed();
        Ok(())
    }

    /// The files of an exposure with their bytes; GDAL's apart.
    fn encoded(&self, exposure: &Exposure, planes: &[PlaneRecord]) -> Result<Vec<(String, Vec<u8>)>, DatasetError> {
        let Exposure { index, image, facts, landmarks, .. } = exposure;
        let units: Vec<_> =
            planes.iter().map(|plane| json!({ "channel": plane.channel, "unit": plane.unit })).collect();
        let header = json!({ "schema_version": SCHEMA_VERSION, "run_key": self.key, "planes": units, "facts": facts });
        let name = |extension: &str| name(*index, extension);
        let mut files = Vec::new();
        if Format::writes_exr(&self.settings.formats) {
            let exr = name("exr");
            files.push((exr.clone(), exr_file::encode(&self.path(&exr), image, &header)?));
        }
        if self.settings.tiff {
            let tiff = name("tif");
            files.push((tiff.clone(), tiff_file::encode(&self.path(&tiff), image)?));
        }
        for format in &self.settings.formats {
            match format {
                Format::Fits => files.push((name("fits"), fits_file::encode(image, facts, &self.key))),
                Format::Npz => {
                    let npz = name("npz");
                    files.push((npz.clone(), npz_file::encode(&self.path(&npz), image, facts)?));
                }
                Format::Exr
                | Format::Png16
                | Format::GeoTiff
                | Format::Kitti
                | Format::Tum
                | Format::Oem
                | Format::Aem
                | Format::Coco
                | Format::CraterChallenge => {}
            }
        }
        if let Some(landmarks) = landmarks {
            let file = LandmarkFile {
                schema_version: SCHEMA_VERSION.into(),
                frame_id: facts.frame_id.clone(),
                columns: image.columns,
                rows: image.rows,
                conventions: landmarks::CONVENTIONS.into(),
                landmarks: landmarks.clone(),
            };
            files.push((name(LANDMARKS), pretty(&file)));
        }
        Ok(files)
    }

    /// The landmarks of an exposure; none where none were asked for.
    pub fn landmarks(&self, index: usize) -> Result<Option<LandmarkFile>, DatasetError> {
        let path = self.path(&name(index, LANDMARKS));
        if !path.is_file() {
            return Ok(None);
        }
        serde_json::from_slice(&disk::read(&path)?).map(Some).map_err(|source| DatasetError::Json { path, source })
    }

    /// GDAL writes files, not bytes: what it has written is read again for its hash.
    fn write_orthoimage(&self, name: &str, orthoimage: &Orthoimage) -> Result<FileRecord, DatasetError> {
        let Orthoimage { crs, geotransform, image } = orthoimage;
        let bands = image.planes.iter().map(band).collect();
        let geotransform = *geotransform;
        GeoTiff { columns: image.columns, rows: image.rows, bands, crs, geotransform }.write(&self.path(name))?;
        Ok(FileRecord::of(name, &disk::read(&self.path(name))?))
    }

    /// Exposures that have a record.
    pub fn indices(&self) -> Result<Vec<usize>, DatasetError> {
        let error = |source| DatasetError::Read { path: self.directory.clone(), source };
        let mut indices = Vec::new();
        for entry in fs::read_dir(&self.directory).map_err(error)? {
            let found = entry.map_err(error)?.file_name();
            let found = found.to_string_lossy();
            indices.extend(index_of(&found).filter(|index| name(*index, "json") == found));
        }
        indices.sort_unstable();
        Ok(indices)
    }

    /// The record of an exposure that this run has finished; an error says what is wrong with it.
    pub fn record(&self, index: usize) -> Result<Option<Record>, String> {
        let name = name(index, "json");
        let Ok(bytes) = disk::read(&self.path(&name)) else { return Ok(None) };
        let record =
            Record::parse(&String::from_utf8_lossy(&bytes)).map_err(|why| format!("{name} is damaged: {why}"))?;
        let head = Finished::of(&record);
        Ok(head.belongs(index, &self.key, &self.exposures).then_some(record))
    }

    /// The record of an exposure that this run has finished.
    pub fn finished(&self, index: usize) -> Option<Record> {
        self.record(index).ok().flatten()
    }

    pub fn is_whole(&self, file: &FileRecord) -> bool {
        disk::read(&self.path(&file.name)).is_ok_and(|bytes| crate::digest::sha256_hex(&bytes) == file.sha256)
    }

    /// A preview on the scale that is known so far, so that there is something to look at while the run goes on.
    fn first_look(
        &self,
        index: usize,
        image: &Image,
        planes: &[PlaneRecord],
    ) -> Result<Option<(String, Vec<u8>)>, DatasetError> {
        let Some(scale) = self.previews.keep(index, image, planes) else { return Ok(None) };
        let Some(shown) = self.previews.shown(index) else { return Ok(None) };
        let (name, grey) = (name(index, "png"), shown.grey(scale.white));
        let comment = format!("{}; white may rise until the sequence is finished", preview::comment(&scale));
        Ok(Some((name.clone(), png_file::encode_8(&self.path(&name), shown.size, &grey, &comment)?)))
    }

    /// Writes the preview of an exposure on the scale of the sequence, and the record that names it, unless both are there. The
    /// preview where it is asked for.
    pub fn preview(
        &self,
        index: usize,
        record: &mut Record,
        scale: &PreviewScale,
        wanted: bool,
    ) -> Result<Option<Thumbnail>, DatasetError> {
        let path = self.path(&name(index, "png"));
        if self.is_current(index, record, scale) {
            return wanted.then(|| Thumbnail::read(&path)).transpose();
        }
        let shown = self.previews.shown(index).map_or_else(|| self.read_shown(record, scale), Ok)?;
        let grey = shown.grey(scale.white);
        let file =
            self.write(&name(index, "png"), &png_file::encode_8(&path, shown.size, &grey, &preview::comment(scale))?)?;
        let linear = self.linear(index, &shown, scale)?;
        let thumbnail = Thumbnail { columns: shown.size[0], rows: shown.size[1], grey };
        self.overlay(index, record, &thumbnail)?;
        record.preview = Some(PreviewRecord {
            file,
            channel: scale.channel.clone(),
            white: scale.white,
            unit: scale.unit.clone(),
            encoding: preview::STRETCH.into(),
            linear,
        });
        record.sha256 = String::new();
        self.write(&name(index, "json"), record.text().as_bytes())?;
        Ok(wanted.then_some(thumbnail))
    }

    /// Whether the preview that a record names is there, as it is asked for.
    fn is_current(&self, index: usize, record: &Record, scale: &PreviewScale) -> bool {
        let Some(preview) = &record.preview else { return false };
        let has = |name: &str| preview.files().chain(&record.files).any(|file| file.name == name);
        let there =
            |file: &FileRecord| fs::metadata(self.path(&file.name)).is_ok_and(|found| found.len() == file.bytes as u64);
        let linear = self.settings.formats.contains(&Format::Png16);
        let overlay = self.settings.overlay && has(&name(index, LANDMARKS));
        (preview.white, &preview.channel) == (scale.white, &scale.channel)
            && preview.files().all(there)
            && preview.linear.is_some() == linear
            && has(&name(index, OVERLAY)) == overlay
    }

    /// Writes the plane of the preview in 16 bits, where it is asked for.
    fn linear(&self, index: usize, shown: &Shown, scale: &PreviewScale) -> Result<Option<FileRecord>, DatasetError> {
        if !self.settings.formats.contains(&Format::Png16) {
            return Ok(None);
        }
        let name = name(index, LINEAR);
        let comment = preview::linear_comment(scale);
        let bytes = png_file::encode_16(&self.path(&name), shown.size, &shown.numbers(scale.white), &comment)?;
        self.write(&name, &bytes).map(Some)
    }

    /// Writes the preview with the landmarks of an exposure, where both are asked for.
    fn overlay(&self, index: usize, record: &mut Record, preview: &Thumbnail) -> Result<(), DatasetError> {
        let wanted = if self.settings.overlay { self.landmarks(index)? } else { None };
        let Some(file) = wanted else { return Ok(()) };
        let rgb = landmarks::overlay(&preview.grey, preview.columns, &file.landmarks);
        let name = name(index, OVERLAY);
        let comment = "landmarks: lit green, in shadow amber, occluded red";
        let size = [preview.columns, preview.rows];
        let written = self.write(&name, &png_file::encode_rgb_8(&self.path(&name), size, &rgb, comment)?)?;
        record.files.retain(|file| file.name != name);
        record.files.push(written);
        Ok(())
    }

    fn read_shown(&self, record: &Record, scale: &PreviewScale) -> Result<Shown, DatasetError> {
        let mut planes = StoredPlanes::read(&self.directory, &record.files)?;
        let values = planes.take(&scale.channel).unwrap_or_default();
        let gaps = planes.take(Quantity::DemGap.channels()[0]);
        Ok(Shown { values, gaps, size: [planes.columns, planes.rows] })
    }
}

impl FileRecord {
    pub fn of(name: &str, bytes: &[u8]) -> Self {
        Self { name: name.into(), sha256: crate::digest::sha256_hex(bytes), bytes: bytes.len() }
    }
}

fn band(plane: &Plane) -> GeoTiffBand<'_> {
    GeoTiffBand { name: plane.name, unit: plane.quantity.unit(), values: &plane.values }
}

fn check(index: usize, image: &Image) -> Result<(), DatasetError> {
    let (columns, rows) = (image.columns, image.rows);
    if image.planes.is_empty() {
        return Err(DatasetError::NoPlanes { index });
    }
    match image.planes.iter().find(|plane| plane.values.len() != columns * rows) {
        Some(plane) => {
            Err(DatasetError::PlaneSize { index, channel: plane.name, got: plane.values.len(), columns, rows })
        }
        None => Ok(()),
    }
}
