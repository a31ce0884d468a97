//! Writes a sequence, beside the rendering, and finishes one that was interrupted.

mod exposure_writer;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use rayon::prelude::*;
use serde::Serialize;

use super::animation;
use super::card::Card;
use super::contact_sheet;
use super::disk;
use super::error::DatasetError;
use super::format::Format;
use super::manifest::{Manifest, ManifestEntry, PreviewScale, Run};
use super::png_file;
use super::poses;
use super::preview::{self, White};
use super::record::{ExposureMetadata, FileRecord, Record, SCHEMA_VERSION};
use super::{coco, sequences};
use crate::labels::Landmark;
use crate::render::Image;
use exposure_writer::{ExposureWriter, PreviewCache, Thumbnails};

/// Images that wait to be written; each may take some hundred megabytes.
const QUEUE: usize = 2;
/// Each holds an image too.
const MOST_THREADS: usize = 4;
const MANIFEST: &str = "manifest.json";
const POSES: &str = "poses.csv";
const CARD: &str = "dataset_card.md";
const SHEET: &str = "contact_sheet.png";
const ANIMATION: &str = "preview.gif";
const LANDMARKS: &str = "landmarks.json";
const OVERLAY: &str = "landmarks.png";
const SEQUENCE_FILES: [&str; 7] = [MANIFEST, POSES, CARD, SHEET, ANIMATION, coco::FILE, coco::CSV_FILE];
const ANIMATION_PIXELS: usize = 512;
const SHEET_PIXELS: usize = 256;
/// More exposures than this are shown by an even choice.
const SHEET_EXPOSURES: usize = 100;

/// One image with what is known of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Exposure {
    pub index: usize,
    pub image: Image,
    pub facts: ExposureMetadata,
    /// `None`: none are asked for.
    pub landmarks: Option<Vec<Landmark>>,
    /// The same planes on a map, where they are asked for and the image shows ground.
    pub orthoimage: Option<Orthoimage>,
}

/// Planes on a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Orthoimage {
    /// WKT or a PROJ string.
    pub crs: String,
    /// GDAL's affine map, from the first pixel's corner.
    pub geotransform: [f64; 6],
    pub image: Image,
}

/// What is written besides OpenEXR, previews and records.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    pub tiff: bool,
    pub animation: bool,
    /// Previews with the landmarks drawn over them.
    pub overlay: bool,
    pub white: White,
    pub formats: Vec<Format>,
}

/// What a finished sequence holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    pub directory: PathBuf,
    /// Finished exposures, those of earlier runs among them.
    pub exposures: usize,
    pub preview: Option<PreviewScale>,
    /// Of this run's exposures.
    pub spent: Spent,
}

/// Writes one sequence into one directory.
#[derive(Debug)]
pub struct Writer {
    output: ExposureWriter,
    run: Run,
    planned: usize,
    settings: Settings,
    sender: Option<SyncSender<Exposure>>,
    threads: Vec<JoinHandle<Result<Spent, DatasetError>>>,
    /// Set by a thread that ends with an error.
    failed: Arc<AtomicBool>,
    spent: Spent,
}

/// How long the threads have worked.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spent {
    /// Compression and hashes.
    pub encoding: Duration,
    pub writing: Duration,
}

impl Writer {
    /// Opens `directory` for a run of `planned` exposures. Exposures of other runs that lie there are removed.
    pub fn open(directory: &Path, run: Run, planned: usize, settings: Settings) -> Result<Self, DatasetError> {
        disk::check_writable(directory)?;
        let output = ExposureWriter {
            directory: directory.to_path_buf(),
            key: run.key(),
            settings: settings.clone(),
            previews: PreviewCache::default(),
        };
        output.remove_stale()?;
        let (sender, receiver) = sync_channel(QUEUE);
        let receiver = Arc::new(Mutex::new(receiver));
        let failed = Arc::new(AtomicBool::new(false));
        let thread = |_| {
            let (output, receiver, failed) = (output.clone(), receiver.clone(), failed.clone());
            std::thread::spawn(move || write_all(&output, &receiver, &failed))
        };
        let threads = (0..threads()).map(thread).collect();
        Ok(Self { output, run, planned, settings, sender: Some(sender), threads, failed, spent: Spent::default() })
    }

    /// Whether an exposure of this very run is finished and whole.
    pub fn done(&self, index: usize) -> bool {
        self.output.finished(index).is_some_and(|record| record.files.iter().all(|file| self.output.is_whole(file)))
    }

    /// Hands an exposure over; waits while the writing is behind.
    pub fn submit(&mut self, exposure: Exposure) -> Result<(), DatasetError> {
        let works = !self.failed.load(Ordering::Relaxed);
        let sent = works && self.sender.as_ref().is_some_and(|sender| sender.send(exposure).is_ok());
        if sent { Ok(()) } else { Err(self.join().err().unwrap_or_else(|| self.ended())) }
    }

    /// Waits for the last exposure, then writes what concerns the whole sequence.
    pub fn finish(mut self) -> Result<Summary, DatasetError> {
        self.join()?;
        let mut records: Vec<(usize, Record)> =
            (0..self.planned).filter_map(|index| Some((index, self.output.finished(index)?))).collect();
        let plain: Vec<Record> = records.iter().map(|(_, record)| record.clone()).collect();
        let scale = preview::scale(&plain, self.settings.white);
        let mut files = vec![self.output.write(POSES, poses::csv(&plain).as_bytes())?];
        let facts: Vec<&ExposureMetadata> = plain.iter().map(|record| &record.facts).collect();
        for (name, text) in sequences::files(&self.settings.formats, &self.run.name, &facts) {
            files.push(self.output.write(&name, text.as_bytes())?);
        }
        files.extend(self.annotations(&records)?);
        if let Some(scale) = &scale {
            let thumbnails: Vec<(usize, Thumbnails)> = records
                .par_iter_mut()
                .map(|(index, record)| Ok((*index, self.output.preview(*index, record, scale)?)))
                .collect::<Result<_, DatasetError>>()?;
            files.extend(self.overviews(&thumbnails, scale)?);
        }
        let card = Card {
            run: &self.run,
            records: &plain,
            planned: self.planned,
            preview: scale.as_ref(),
            formats: &self.settings.formats,
            tiff: self.settings.tiff,
        };
        files.push(self.output.write(CARD, card.text().as_bytes())?);
        self.manifest(&records, scale.clone(), files)?;
        Ok(Summary {
            directory: self.output.directory.clone(),
            exposures: records.len(),
            preview: scale,
            spent: self.spent,
        })
    }

    /// The landmarks of all exposures in the formats asked for.
    fn annotations(&self, records: &[(usize, Record)]) -> Result<Vec<FileRecord>, DatasetError> {
        let formats = &self.settings.formats;
        if ![Format::Coco, Format::CraterChallenge].iter().any(|format| formats.contains(format)) {
            return Ok(Vec::new());
        }
        let mut images = Vec::new();
        for (index, _) in records {
            if let Some(file) = self.output.landmarks(*index)? {
                images.push((*index, self.output.name(*index, "png"), file));
            }
        }
        let mut files = Vec::new();
        if formats.contains(&Format::Coco) {
            files.push(self.output.write(coco::FILE, &pretty(&coco::annotations(&self.run.title, &images)))?);
        }
        if formats.contains(&Format::CraterChallenge) {
            files.push(self.output.write(coco::CSV_FILE, coco::challenge_csv(&images).as_bytes())?);
        }
        Ok(files)
    }

    fn overviews(
        &self,
        previews: &[(usize, Thumbnails)],
        scale: &PreviewScale,
    ) -> Result<Vec<FileRecord>, DatasetError> {
        let step = previews.len().div_ceil(SHEET_EXPOSURES).max(1);
        let shown: Vec<_> = previews.iter().step_by(step).map(|(index, dn)| (*index, dn.sheet.clone())).collect();
        let sheet = contact_sheet::sheet(&shown);
        let comment = format!("{}; shown with gamma 2.2", preview::comment(scale));
        let name = SHEET;
        let bytes = png_file::encode_8(&self.output.path(name), [sheet.columns, sheet.rows], &sheet.grey, &comment)?;
        let mut files = vec![self.output.write(name, &bytes)?];
        if self.settings.animation {
            let name = ANIMATION;
            let frames: Vec<_> = previews.iter().map(|(index, dn)| (*index, dn.frame.clone())).collect();
            files.push(self.output.write(name, &animation::encode(&self.output.path(name), &frames)?)?);
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
            let json = FileRecord::of(&self.output.name(*index, "json"), &pretty(record));
            let preview = record.preview.iter().map(|preview| preview.file.clone());
            ManifestEntry {
                index: *index,
                epoch_utc: record.facts.epoch.utc.clone(),
                point: record.facts.sweep.as_ref().map(|sweep| sweep.point),
                split: record.facts.split.as_ref().map(|split| split.part.clone()),
                warnings: record.facts.quality.warnings.clone(),
                files: record.files.iter().cloned().chain(preview).chain([json]).collect(),
            }
        };
        let manifest = Manifest {
            schema_version: SCHEMA_VERSION.into(),
            run_key: self.output.key.clone(),
            run: self.run.clone(),
            exposures_planned: self.planned,
            preview,
            exposures: records.iter().map(entry).collect(),
            files,
        };
        self.output.write(MANIFEST, &pretty(&manifest)).map(|_| ())
    }

    /// Lets the threads end and asks how it went; a second call has nothing to tell.
    fn join(&mut self) -> Result<(), DatasetError> {
        self.sender = None;
        let outcomes: Vec<_> = self.threads.drain(..).map(JoinHandle::join).collect();
        for outcome in outcomes {
            let Spent { encoding, writing } = outcome.map_err(|_| self.ended())??;
            self.spent.encoding += encoding;
            self.spent.writing += writing;
        }
        Ok(())
    }

    fn ended(&self) -> DatasetError {
        DatasetError::WriterEnded { path: self.output.directory.clone() }
    }
}

/// Half of the machine's cores, which others need too.
fn threads() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    (cores / 2).clamp(1, MOST_THREADS)
}

/// Writes what comes until the end, or until some thread has failed.
fn write_all(
    output: &ExposureWriter,
    exposures: &Mutex<Receiver<Exposure>>,
    failed: &AtomicBool,
) -> Result<Spent, DatasetError> {
    let mut spent = Spent::default();
    while !failed.load(Ordering::Relaxed) {
        let next = exposures.lock().unwrap_or_else(PoisonError::into_inner).recv();
        let Ok(exposure) = next else { break };
        output.write_exposure(exposure, &mut spent).inspect_err(|_| failed.store(true, Ordering::Relaxed))?;
    }
    Ok(spent)
}

/// JSON that people can read, with a last line that ends.
fn pretty(value: &impl Serialize) -> Vec<u8> {
    let mut bytes = serde_json::to_vec_pretty(value).expect("plain values become JSON");
    bytes.push(b'\n');
    bytes
}

#[cfg(test)]
mod tests;
