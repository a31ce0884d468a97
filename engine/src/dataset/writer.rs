//! Writes a sequence, beside the rendering, and finishes one that was interrupted.

mod exposure_writer;
mod previews;
mod sequence;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use rayon::prelude::*;
use serde::Serialize;
use serde_json::Value as Json;

use super::disk;
use super::error::DatasetError;
use super::folder::{Existing, Folder, MANIFEST, Plan};
use super::format::Format;
use super::manifest::{Manifest, PreviewScale, Run};
use super::preview::White;
use super::record::{ExposureMetadata, PreviewRecord, Record};
use crate::files;
use crate::labels::Landmark;
use crate::render::Image;
use exposure_writer::ExposureWriter;
use previews::Previews;

/// Images that wait to be written; each may take some hundred megabytes.
const QUEUE: usize = 2;
/// Each holds an image too.
const MOST_THREADS: usize = 4;
const LANDMARKS: &str = "landmarks.json";
const OVERLAY: &str = "landmarks.png";
const LINEAR: &str = "linear.png";
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
    /// Exposures of the sequence.
    pub planned: usize,
    pub preview: Option<PreviewScale>,
    /// Of this run's exposures.
    pub spent: Spent,
}

/// Writes one sequence into one directory.
#[derive(Debug)]
pub struct Writer {
    output: ExposureWriter,
    run: Run,
    /// Exposures of the sequence, those that an earlier, longer run has planned among them.
    planned: usize,
    settings: Settings,
    /// What the manifest told of the sequence when the run began.
    earlier: Option<Manifest>,
    notes: Vec<String>,
    sender: Option<SyncSender<Exposure>>,
    threads: Vec<JoinHandle<Result<Spent, DatasetError>>>,
    /// Set by a thread that ends with an error.
    failed: Arc<AtomicBool>,
    spent: Spent,
}

/// What there is of an exposure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum State {
    Missing,
    /// Finished and whole.
    Done,
    /// Finished, and changed since: what is wrong.
    Damaged(String),
    /// The same of a preview alone, which the end of the run makes anew.
    DamagedPreview(String),
}

/// Looks at what is finished.
#[derive(Debug)]
pub struct Reader(ExposureWriter);

impl Reader {
    /// Whether an exposure is finished, and its files were whole when they were written.
    pub fn is_done(&self, index: usize) -> bool {
        self.0.finished(index).is_some_and(|record| record.files.iter().all(|file| self.0.is_whole(file)))
    }
}

fn changed_since(name: &str) -> String {
    format!("{name} has not the SHA-256 that its record states")
}

/// How long the threads have worked.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spent {
    /// Compression and hashes.
    pub encoding: Duration,
    pub writing: Duration,
}

impl Writer {
    /// Opens `directory` for a run whose exposures are made from `exposures` besides [`Run::made_from`], and says in a manifest
    /// that they will be there. Refuses where an earlier run's exposures or somebody's files would be lost.
    pub fn open(
        directory: &Path,
        run: Run,
        exposures: Vec<Json>,
        settings: Settings,
        existing: Existing,
    ) -> Result<Self, DatasetError> {
        disk::check_writable(directory)?;
        files::remove_stale(directory)
            .map_err(|source| DatasetError::Read { path: directory.to_path_buf(), source })?;
        // Two runs that begin at once see each other's manifest.
        let lock = files::lock(directory);
        let mut folder = Folder::read(directory)?;
        let key = run.key();
        let plan = Plan { shared: &run.made_from, key: Some(&key), exposures: &exposures };
        if let Some(refusal) = folder.refusal(&plan, existing) {
            return Err(refusal);
        }
        folder.make_room(&key, &exposures);
        let notes =
            folder.damage().map(|damage| format!("{damage}; it is made anew from the records")).into_iter().collect();
        let earlier = folder.manifest().filter(|manifest| manifest.run_key == key).cloned();
        // Exposures keep the name of the sequence that they were made for.
        let name = earlier.as_ref().map_or(run.name.clone(), |manifest| manifest.run.name.clone());
        let planned = exposures.len().max(earlier.as_ref().map_or(0, |manifest| manifest.exposures_planned));
        let previews = Previews::new(settings.white);
        let output = ExposureWriter {
            directory: directory.to_path_buf(),
            key,
            exposures: exposures.into(),
            settings: settings.clone(),
            previews,
        };
        let (sender, receiver) = sync_channel(QUEUE);
        let receiver = Arc::new(Mutex::new(receiver));
        let failed = Arc::new(AtomicBool::new(false));
        let thread = |_| {
            let (output, receiver, failed) = (output.clone(), receiver.clone(), failed.clone());
            std::thread::spawn(move || write_all(&output, &receiver, &failed))
        };
        let threads = (0..threads()).map(thread).collect();
        let run = Run { name, ..run };
        let (sender, spent) = (Some(sender), Spent::default());
        let writer = Self { output, run, planned, settings, earlier, notes, sender, threads, failed, spent };
        let records = writer.records()?;
        writer.output.previews.know(&records);
        let (preview, files) =
            writer.earlier.as_ref().map_or_else(Default::default, |m| (m.preview.clone(), m.files.clone()));
        writer.manifest(&records, preview, files)?;
        drop(lock);
        Ok(writer)
    }

    /// What the user should know of the folder.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The run as the manifest describes it.
    pub fn run(&self) -> &Run {
        &self.run
    }

    /// The run as an earlier process has described it to its end.
    pub fn earlier_run(&self) -> Option<&Run> {
        self.earlier.as_ref().map(|manifest| &manifest.run)
    }

    /// Tells what is known of the run once its scene is ready; its key and its name stay.
    pub fn describe(&mut self, run: Run) -> Result<(), DatasetError> {
        self.run = Run { name: self.run.name.clone(), made_from: self.run.made_from.clone(), ..run };
        let _lock = files::lock(&self.output.directory);
        match Folder::read_manifest(&self.output.directory).filter(|manifest| manifest.run_key == self.output.key) {
            Some(manifest) => {
                let manifest = Manifest { run: self.run.clone(), ..manifest };
                self.output.write(MANIFEST, manifest.text().as_bytes()).map(|_| ())
            }
            None => Ok(()),
        }
    }

    /// Looks at what is finished beside the writing.
    pub fn reader(&self) -> Reader {
        Reader(self.output.clone())
    }

    /// Whether an exposure of this very run is finished and whole.
    pub fn state(&self, index: usize) -> State {
        let record = match self.output.record(index) {
            Ok(Some(record)) => record,
            Ok(None) => return State::Missing,
            Err(why) => return State::Damaged(why),
        };
        let changed = record.files.iter().find(|file| !self.output.is_whole(file));
        match changed {
            Some(file) => State::Damaged(changed_since(&file.name)),
            None => match record.preview.iter().flat_map(PreviewRecord::files).find(|file| !self.output.is_whole(file))
            {
                Some(file) => {
                    // What is not there is made again from the planes, which are whole.
                    let _ = std::fs::remove_file(self.output.path(&file.name));
                    State::DamagedPreview(changed_since(&file.name))
                }
                None => State::Done,
            },
        }
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
        let lock = files::lock(&self.output.directory);
        let mut records = self.records()?;
        loop {
            let preview = self.write_sequence(&mut records)?;
            let exposures = records.len();
            // What another process has finished meanwhile it will list itself, unless neither waits for the other.
            let now = if lock.is_some() { Vec::new() } else { self.records()? };
            if now.len() <= exposures {
                let directory = self.output.directory.clone();
                return Ok(Summary { directory, exposures, planned: self.planned, preview, spent: self.spent });
            }
            records = now;
        }
    }

    /// All finished exposures of the run, by index.
    fn records(&self) -> Result<Vec<(usize, Record)>, DatasetError> {
        let indices = self.output.indices()?;
        Ok(indices.into_par_iter().filter_map(|index| Some((index, self.output.finished(index)?))).collect())
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
