//! Writes a sequence, beside the rendering, and finishes one that was interrupted.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use rayon::prelude::*;
use serde::Serialize;
use serde_json::{Value as Json, json};

use super::animation;
use super::atomic::{self, PARTIAL};
use super::contact_sheet;
use super::error::DatasetError;
use super::exr_file;
use super::landmarks::{self, LandmarkFile};
use super::manifest::{Manifest, ManifestEntry, PreviewScale, Run};
use super::png_file;
use super::poses;
use super::preview::{self, Thumbnail, White};
use super::record::{self, Facts, FileRecord, PreviewRecord, Record, SCHEMA_VERSION};
use super::tiff_file;
use crate::labels::Landmark;
use crate::render::{Image, Quantity};

/// Images that wait to be written; each may take some hundred megabytes.
const QUEUE: usize = 2;
const MANIFEST: &str = "manifest.json";
const POSES: &str = "poses.csv";
const SHEET: &str = "contact_sheet.png";
const ANIMATION: &str = "preview.gif";
const LANDMARKS: &str = "landmarks.json";
const OVERLAY: &str = "landmarks.png";
const SEQUENCE_FILES: [&str; 4] = [MANIFEST, POSES, SHEET, ANIMATION];
const ANIMATION_PIXELS: usize = 512;
const SHEET_PIXELS: usize = 256;
/// More exposures than this are shown by an even choice.
const SHEET_EXPOSURES: usize = 100;

/// One image with what is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Exposure {
    pub index: usize,
    pub image: Image,
    pub facts: Facts,
    /// `None`: none are asked for.
    pub landmarks: Option<Vec<Landmark>>,
}

/// What is written besides OpenEXR, previews and records.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    pub tiff: bool,
    pub animation: bool,
    /// Previews with the landmarks drawn over them.
    pub overlay: bool,
    pub white: White,
}

/// What a finished sequence holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    pub directory: PathBuf,
    /// Finished exposures, those of earlier runs among them.
    pub exposures: usize,
    pub preview: Option<PreviewScale>,
}

/// Writes one sequence into one directory.
#[derive(Debug)]
pub struct Writer {
    desk: Desk,
    run: Run,
    planned: usize,
    settings: Settings,
    sender: Option<SyncSender<Exposure>>,
    thread: Option<JoinHandle<Result<(), DatasetError>>>,
}

impl Writer {
    /// Opens `directory` for a run of `planned` exposures. Exposures of other runs that lie there are removed.
    pub fn open(directory: &Path, run: Run, planned: usize, settings: Settings) -> Result<Self, DatasetError> {
        atomic::check_writable(directory)?;
        let desk = Desk { directory: directory.to_path_buf(), key: run.key(), settings };
        desk.remove_stale()?;
        let (sender, receiver) = sync_channel(QUEUE);
        let background = desk.clone();
        let thread = std::thread::spawn(move || background.write_all(receiver));
        Ok(Self { desk, run, planned, settings, sender: Some(sender), thread: Some(thread) })
    }

    /// Whether an exposure of this very run is finished and whole.
    pub fn done(&self, index: usize) -> bool {
        self.desk.finished(index).is_some_and(|record| record.files.iter().all(|file| self.desk.is_whole(file)))
    }

    /// Hands an exposure over; waits while the writing is behind.
    pub fn submit(&mut self, exposure: Exposure) -> Result<(), DatasetError> {
        let sent = self.sender.as_ref().is_some_and(|sender| sender.send(exposure).is_ok());
        if sent { Ok(()) } else { Err(self.join().err().unwrap_or_else(|| self.ended())) }
    }

    /// Waits for the last exposure, then writes what concerns the whole sequence.
    pub fn finish(mut self) -> Result<Summary, DatasetError> {
        self.join()?;
        let mut records: Vec<(usize, Record)> =
            (0..self.planned).filter_map(|index| Some((index, self.desk.finished(index)?))).collect();
        let plain: Vec<Record> = records.iter().map(|(_, record)| record.clone()).collect();
        let scale = preview::scale(&plain, self.settings.white);
        let mut files = vec![self.desk.write(POSES, poses::csv(&plain).as_bytes())?];
        if let Some(scale) = &scale {
            let thumbnails: Vec<(usize, Dn)> = records
                .par_iter_mut()
                .map(|(index, record)| Ok((*index, self.desk.preview(*index, record, scale)?)))
                .collect::<Result<_, DatasetError>>()?;
            files.extend(self.overviews(&thumbnails, scale)?);
        }
        self.manifest(&records, scale.clone(), files)?;
        Ok(Summary { directory: self.desk.directory.clone(), exposures: records.len(), preview: scale })
    }

    fn overviews(&self, previews: &[(usize, Dn)], scale: &PreviewScale) -> Result<Vec<FileRecord>, DatasetError> {
        let step = previews.len().div_ceil(SHEET_EXPOSURES).max(1);
        let shown: Vec<_> = previews.iter().step_by(step).map(|(index, dn)| (*index, dn.sheet.clone())).collect();
        let sheet = contact_sheet::sheet(&shown);
        let comment = format!("{}; shown with gamma 2.2", preview::comment(scale));
        let name = SHEET;
        let bytes = png_file::encode_8(&self.desk.path(name), [sheet.columns, sheet.rows], &sheet.grey, &comment)?;
        let mut files = vec![self.desk.write(name, &bytes)?];
        if self.settings.animation {
            let name = ANIMATION;
            let frames: Vec<_> = previews.iter().map(|(index, dn)| (*index, dn.frame.clone())).collect();
            files.push(self.desk.write(name, &animation::encode(&self.desk.path(name), &frames)?)?);
        }
        Ok(files)
    }

    fn manifest(
        &self,
        records: &[(usize, Record)],
        preview: Option<PreviewScale>,
        files: Vec<FileRecord>,
    ) -> Result<(), DatasetError> {
        let entry = |(index, record): &(usize, Record)| {
            let json = FileRecord::of(&self.desk.name(*index, "json"), &pretty(record));
            let preview = record.preview.iter().map(|preview| preview.file.clone());
            ManifestEntry {
                index: *index,
                epoch_utc: record.facts.epoch.utc.clone(),
                files: record.files.iter().cloned().chain(preview).chain([json]).collect(),
            }
        };
        let manifest = Manifest {
            schema_version: SCHEMA_VERSION.into(),
            run_key: self.desk.key.clone(),
            run: self.run.clone(),
            exposures_planned: self.planned,
            preview,
            exposures: records.iter().map(entry).collect(),
            files,
        };
        self.desk.write(MANIFEST, &pretty(&manifest)).map(|_| ())
    }

    /// Lets the thread end and asks how it went; a second call has nothing to tell.
    fn join(&mut self) -> Result<(), DatasetError> {
        self.sender = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(outcome)) => outcome,
            Some(Err(_)) => Err(self.ended()),
            None => Ok(()),
        }
    }

    fn ended(&self) -> DatasetError {
        DatasetError::WriterEnded { path: self.desk.directory.clone() }
    }
}

/// A preview reduced for the overviews.
struct Dn {
    frame: Thumbnail,
    sheet: Thumbnail,
}

/// Names, reads and writes the files of exposures.
#[derive(Debug, Clone)]
struct Desk {
    directory: PathBuf,
    key: String,
    settings: Settings,
}

impl Desk {
    fn name(&self, index: usize, extension: &str) -> String {
        format!("exposure_{index:04}.{extension}")
    }

    fn path(&self, name: &str) -> PathBuf {
        self.directory.join(name)
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<FileRecord, DatasetError> {
        atomic::write(&self.path(name), bytes)?;
        Ok(FileRecord::of(name, bytes))
    }

    fn write_all(&self, exposures: Receiver<Exposure>) -> Result<(), DatasetError> {
        exposures.into_iter().try_for_each(|exposure| self.write_exposure(exposure))
    }

    /// The record last: it says that the exposure is finished.
    fn write_exposure(&self, exposure: Exposure) -> Result<(), DatasetError> {
        let Exposure { index, image, facts, landmarks } = exposure;
        check(index, &image)?;
        let planes = record::planes(&image);
        let record_path = self.path(&self.name(index, "json"));
        let _ = fs::remove_file(&record_path);
        let units: Vec<_> =
            planes.iter().map(|plane| json!({ "channel": plane.channel, "unit": plane.unit })).collect();
        let header = json!({ "schema_version": SCHEMA_VERSION, "run_key": self.key, "planes": units, "facts": facts });
        let name = self.name(index, "exr");
        let mut files = vec![self.write(&name, &exr_file::encode(&self.path(&name), &image, &header)?)?];
        if self.settings.tiff {
            let name = self.name(index, "tif");
            files.push(self.write(&name, &tiff_file::encode(&self.path(&name), &image)?)?);
        }
        if let Some(landmarks) = landmarks {
            let file = LandmarkFile {
                schema_version: SCHEMA_VERSION.into(),
                frame_id: facts.frame_id.clone(),
                columns: image.columns,
                rows: image.rows,
                conventions: landmarks::CONVENTIONS.into(),
                landmarks,
            };
            files.push(self.write(&self.name(index, LANDMARKS), &pretty(&file))?);
        }
        let record = Record {
            schema_version: SCHEMA_VERSION.into(),
            run_key: self.key.clone(),
            facts,
            planes,
            preview: None,
            files,
        };
        self.write(&self.name(index, "json"), &pretty(&record)).map(|_| ())
    }

    /// The record of an exposure that this run has finished.
    fn finished(&self, index: usize) -> Option<Record> {
        let record = read_record(&self.path(&self.name(index, "json"))).ok()?;
        (record.run_key == self.key).then_some(record)
    }

    fn is_whole(&self, file: &FileRecord) -> bool {
        atomic::read(&self.path(&file.name)).is_ok_and(|bytes| crate::digest::sha256_hex(&bytes) == file.sha256)
    }

    /// Writes the preview of an exposure from its planes on disk, and the record that names it.
    fn preview(&self, index: usize, record: &mut Record, scale: &PreviewScale) -> Result<Dn, DatasetError> {
        let file = exr_file::read_exr(&self.path(&self.name(index, "exr")))?;
        let channel = |name: &str| file.channels.iter().find(|(found, _)| found == name).map(|(_, values)| values);
        let nothing = Vec::new();
        let values = channel(&scale.channel).unwrap_or(&nothing);
        let gaps = channel(Quantity::DemGap.channels()[0]).map(Vec::as_slice);
        let dn = preview::digital_numbers(values, gaps, file.columns, scale.white);
        let name = self.name(index, "png");
        let size = [file.columns, file.rows];
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
        let reduced = |largest| Thumbnail::of(&dn, file.columns, largest);
        Ok(Dn { frame: reduced(ANIMATION_PIXELS), sheet: reduced(SHEET_PIXELS) })
    }

    /// Writes the preview with the landmarks of an exposure, where both are asked for.
    fn overlay(&self, index: usize, record: &mut Record, dn: &[u16], size: [usize; 2]) -> Result<(), DatasetError> {
        let path = self.path(&self.name(index, LANDMARKS));
        if !(self.settings.overlay && path.is_file()) {
            return Ok(());
        }
        let file: LandmarkFile =
            serde_json::from_slice(&atomic::read(&path)?).map_err(|source| DatasetError::Json { path, source })?;
        let rgb = landmarks::overlay(dn, size[0], &file.landmarks);
        let name = self.name(index, OVERLAY);
        let comment = "landmarks: lit green, in shadow amber, occluded red";
        let written = self.write(&name, &png_file::encode_rgb_8(&self.path(&name), size, &rgb, comment)?)?;
        record.files.retain(|file| file.name != name);
        record.files.push(written);
        Ok(())
    }

    /// Removes half-written files and those of other runs.
    fn remove_stale(&self) -> Result<(), DatasetError> {
        let error = |source| DatasetError::Read { path: self.directory.clone(), source };
        for entry in fs::read_dir(&self.directory).map_err(error)? {
            let name = entry.map_err(error)?.file_name().to_string_lossy().into_owned();
            if self.is_stale(&name) {
                // A file that will not go away is met again when it is written.
                let _ = fs::remove_file(self.path(&name));
            }
        }
        Ok(())
    }

    /// Half-written, or made by another run. Files of other programs are not ours to remove.
    fn is_stale(&self, name: &str) -> bool {
        let whole = name.strip_suffix(PARTIAL).unwrap_or(name);
        let exposure = whole.strip_prefix("exposure_").and_then(|rest| rest.split_once('.'));
        let belongs = match exposure {
            Some((index, _)) if index.bytes().all(|byte| byte.is_ascii_digit()) => {
                self.belongs(&format!("exposure_{index}.json"))
            }
            _ if SEQUENCE_FILES.contains(&whole) => self.belongs(MANIFEST),
            _ => return false,
        };
        whole != name || !belongs
    }

    /// Whether a record or manifest was written by this run.
    fn belongs(&self, name: &str) -> bool {
        let found = atomic::read(&self.path(name)).ok().and_then(|bytes| serde_json::from_slice::<Json>(&bytes).ok());
        found.is_some_and(|found| found["run_key"] == self.key.as_str())
    }
}

impl FileRecord {
    fn of(name: &str, bytes: &[u8]) -> Self {
        Self { name: name.into(), sha256: crate::digest::sha256_hex(bytes), bytes: bytes.len() }
    }
}

fn read_record(path: &Path) -> Result<Record, DatasetError> {
    let bytes = atomic::read(path)?;
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

/// JSON that people can read, with a last line that ends.
fn pretty(value: &impl Serialize) -> Vec<u8> {
    let mut bytes = serde_json::to_vec_pretty(value).expect("plain values become JSON");
    bytes.push(b'\n');
    bytes
}

#[cfg(test)]
mod tests;
