//! The files of single exposures: names, bytes, which of them are whole, stale or finished.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use serde_json::{Value as Json, json};

use super::{
    ANIMATION_PIXELS, Exposure, LANDMARKS, MANIFEST, OVERLAY, Orthoimage, SEQUENCE_FILES, SHEET_PIXELS, Settings,
    Spent, pretty,
};
use crate::dataset::disk;
use crate::dataset::error::DatasetError;
use crate::dataset::format::Format;
use crate::dataset::landmarks::{self, LandmarkFile};
use crate::dataset::manifest::PreviewScale;
use crate::dataset::preview::{self, Thumbnail};
use crate::dataset::record::{self, FileRecord, PlaneRecord, PreviewRecord, Record, SCHEMA_VERSION};
use crate::dataset::{exr_file, fits_file, npz_file, png_file, sequences, tiff_file};
use crate::files;
use crate::raster::{GeoTiff, GeoTiffBand};
use crate::render::{Image, Plane, Quantity};

/// Planes of 1024² pixels for a sequence of 32.
const PREVIEW_BYTES: usize = 256 << 20;

/// A preview reduced for the overviews.
pub struct Thumbnails {
    pub frame: Thumbnail,
    pub sheet: Thumbnail,
}

/// Names, reads and writes the files of exposures.
#[derive(Debug, Clone)]
pub struct ExposureWriter {
    pub directory: PathBuf,
    pub key: String,
    pub settings: Settings,
    pub previews: PreviewCache,
}

/// Planes that previews show, so that they need not be read again once their scale is known: as many as fit.
#[derive(Debug, Clone, Default)]
pub struct PreviewCache(Arc<Mutex<BTreeMap<usize, PreviewSource>>>);

/// What a preview is made from.
#[derive(Debug, Clone)]
struct PreviewSource {
    size: [usize; 2],
    values: Vec<f32>,
    gaps: Option<Vec<f32>>,
}

impl PreviewCache {
    fn keep(&self, index: usize, image: &Image, records: &[PlaneRecord]) {
        let plane = |channel: &str| image.planes.iter().find(|plane| plane.name == channel);
        let Some(values) = preview::shown(records).and_then(|record| plane(&record.channel)) else { return };
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let bytes = (2 * size_of::<f32>()) * values.values.len();
        if (kept.len() + 1) * bytes <= PREVIEW_BYTES {
            let gaps = plane(Quantity::DemGap.channels()[0]).map(|plane| plane.values.clone());
            kept.insert(
                index,
                PreviewSource { size: [image.columns, image.rows], values: values.values.clone(), gaps },
            );
        }
    }

    fn take(&self, index: usize) -> Option<PreviewSource> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).remove(&index)
    }
}

impl ExposureWriter {
    pub fn name(&self, index: usize, extension: &str) -> String {
        format!("exposure_{index:04}.{extension}")
    }

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
        let record_name = self.name(index, "json");
        if self.finished(index).is_none() {
            // Another run's record would vouch for this run's files. Two processes of one run write the same bytes.
            let _ = fs::remove_file(self.path(&record_name));
        }
        let start = Instant::now();
        let planes = record::planes(&exposure.image);
        let encoded = self.encoded(&exposure, &planes)?;
        let mut files: Vec<FileRecord> = encoded.iter().map(|(name, bytes)| FileRecord::of(name, bytes)).collect();
        if let Some(orthoimage) = &exposure.orthoimage {
            files.push(self.write_orthoimage(&self.name(index, "ortho.tif"), orthoimage)?);
        }
        self.previews.keep(index, &exposure.image, &planes);
        let facts = exposure.facts;
        let (schema_version, run_key) = (SCHEMA_VERSION.into(), self.key.clone());
        let record = Record { schema_version, run_key, facts, planes, preview: None, files };
        let encoded_by = Instant::now();
        let record = (record_name.as_str(), pretty(&record));
        let files = encoded.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
        disk::write_in_order(&self.directory, files.chain([(record.0, record.1.as_slice())]))?;
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
        let name = |extension: &str| self.name(*index, extension);
        let exr = name("exr");
        let mut files = vec![(exr.clone(), exr_file::encode(&self.path(&exr), image, &header)?)];
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
                Format::GeoTiff
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
        let path = self.path(&self.name(index, LANDMARKS));
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

    /// The record of an exposure that this run has finished.
    pub fn finished(&self, index: usize) -> Option<Record> {
        let record = read_record(&self.path(&self.name(index, "json"))).ok()?;
        (record.run_key == self.key).then_some(record)
    }

    pub fn is_whole(&self, file: &FileRecord) -> bool {
        disk::read(&self.path(&file.name)).is_ok_and(|bytes| crate::digest::sha256_hex(&bytes) == file.sha256)
    }

    /// Writes the preview of an exposure, from its planes on disk where they are not kept, and the record that names it.
    pub fn preview(&self, index: usize, record: &mut Record, scale: &PreviewScale) -> Result<Thumbnails, DatasetError> {
        let shown = self.previews.take(index).map_or_else(|| self.read_shown(index, scale), Ok)?;
        let PreviewSource { size, values, gaps } = shown;
        let dn = preview::digital_numbers(&values, gaps.as_deref(), size[0], scale.white);
        let name = self.name(index, "png");
        let bytes = png_file::encode_16(&self.path(&name), size, &dn, &preview::comment(scale))?;
        let written = self.write(&name, &bytes)?;
        self.overlay(index, record, &dn, size)?;
        record.preview = Some(PreviewRecord {
            file: written,
            channel: scale.channel.clone(),
            white: scale.white,
            unit: scale.unit.clone(),
            encoding: "16 bits, linear: DN = 65535 value / white".into(),
        });
        self.write(&self.name(index, "json"), &pretty(record))?;
        let reduced = |largest| Thumbnail::of(&dn, size[0], largest);
        Ok(Thumbnails { frame: reduced(ANIMATION_PIXELS), sheet: reduced(SHEET_PIXELS) })
    }

    /// Writes the preview with the landmarks of an exposure, where both are asked for.
    fn overlay(&self, index: usize, record: &mut Record, dn: &[u16], size: [usize; 2]) -> Result<(), DatasetError> {
        let wanted = if self.settings.overlay { self.landmarks(index)? } else { None };
        let Some(file) = wanted else { return Ok(()) };
        let rgb = landmarks::overlay(dn, size[0], &file.landmarks);
        let name = self.name(index, OVERLAY);
        let comment = "landmarks: lit green, in shadow amber, occluded red";
        let written = self.write(&name, &png_file::encode_rgb_8(&self.path(&name), size, &rgb, comment)?)?;
        record.files.retain(|file| file.name != name);
        record.files.push(written);
        Ok(())
    }

    fn read_shown(&self, index: usize, scale: &PreviewScale) -> Result<PreviewSource, DatasetError> {
        let mut file = exr_file::read_exr(&self.path(&self.name(index, "exr")))?;
        let mut channel = |wanted: &str| {
            let found = file.channels.iter().position(|(name, _)| name == wanted)?;
            Some(file.channels.swap_remove(found).1)
        };
        let values = channel(&scale.channel).unwrap_or_default();
        Ok(PreviewSource { values, gaps: channel(Quantity::DemGap.channels()[0]), size: [file.columns, file.rows] })
    }

    /// Removes what killed processes left half-written, and the files of other runs.
    pub fn remove_stale(&self) -> Result<(), DatasetError> {
        let error = |source| DatasetError::Read { path: self.directory.clone(), source };
        files::remove_stale(&self.directory).map_err(error)?;
        let entries = fs::read_dir(&self.directory).map_err(error)?;
        let names: Vec<String> = entries
            .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
            .collect::<Result<_, std::io::Error>>()
            .map_err(error)?;
        // Records are what tells whose the files are: they are read before any goes.
        let mut others = BTreeMap::new();
        for name in &names {
            if let Some(record) = record_of(name) {
                others.entry(record).or_insert_with_key(|record| self.is_of_another_run(record));
            }
        }
        for name in names.iter().filter(|name| record_of(name).is_some_and(|record| others[&record])) {
            // A file that will not go away is met again when it is written.
            let _ = fs::remove_file(self.path(name));
        }
        Ok(())
    }

    /// Whether a record or manifest was written by another run. Files without one may be those of a process that is about to
    /// write it.
    fn is_of_another_run(&self, record: &str) -> bool {
        let found = disk::read(&self.path(record)).ok().and_then(|bytes| serde_json::from_slice::<Json>(&bytes).ok());
        found.is_some_and(|found| found["run_key"].as_str().is_some_and(|key| key != self.key))
    }
}

impl FileRecord {
    pub fn of(name: &str, bytes: &[u8]) -> Self {
        Self { name: name.into(), sha256: crate::digest::sha256_hex(bytes), bytes: bytes.len() }
    }
}

/// The record or manifest that vouches for a file; `None`: a file of another program, which is not ours to remove.
fn record_of(name: &str) -> Option<String> {
    let exposure = name.strip_prefix("exposure_").and_then(|rest| rest.split_once('.'));
    match exposure {
        Some((index, _)) if index.bytes().all(|byte| byte.is_ascii_digit()) => Some(format!("exposure_{index}.json")),
        _ => (SEQUENCE_FILES.contains(&name) || sequences::is_one(name)).then(|| MANIFEST.into()),
    }
}

fn band(plane: &Plane) -> GeoTiffBand<'_> {
    GeoTiffBand { name: plane.name, unit: plane.quantity.unit(), values: &plane.values }
}

pub fn read_record(path: &Path) -> Result<Record, DatasetError> {
    let bytes = disk::read(path)?;
    serde_json::from_slice(&bytes).map_err(|source| DatasetError::Json { path: path.to_path_buf(), source })
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
