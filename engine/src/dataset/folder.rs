//! What lies in the folder that a run is to write into: finished exposures that it goes on with, or that are not its own and
//! must not be lost.
//!
//! ```text
//! exposure_0007.json   vouches for the files that it lists: key of the run, key of the exposure
//! manifest.json        written before the first exposure: all names of its sequence are the program's from then on
//! ```
//!
//! Other files are somebody's own: they are never removed, and written over only where the user says so.

use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value as Json;

use super::differences;
use super::disk;
use super::error::DatasetError;
use super::manifest::{Manifest, exposure_key};
use super::record::{FileRecord, PreviewRecord, Record};
use super::{coco, sequences};

pub const MANIFEST: &str = "manifest.json";
pub const POSES: &str = "poses.csv";
pub const CARD: &str = "dataset_card.md";
pub const SHEET: &str = "contact_sheet.png";
pub const ANIMATION: &str = "preview.gif";
const SEQUENCE_FILES: [&str; 7] = [MANIFEST, POSES, CARD, SHEET, ANIMATION, coco::FILE, coco::CSV_FILE];

/// Names of other people's files that an error lists.
const LISTED: usize = 3;

/// What a run may do with what an earlier one has left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Existing {
    /// Exposures that are finished are not rendered again.
    pub resume: bool,
    /// What does not belong to the run may be lost.
    pub overwrite: bool,
}

/// What a run makes: what all exposures share, and what each is made from besides.
#[derive(Debug, Clone, Copy)]
pub struct Plan<'a> {
    /// [`super::Run::made_from`], or the part of it that is known before the work.
    pub shared: &'a Json,
    /// The hash of all of it; `None`: not known yet.
    pub key: Option<&'a str>,
    pub exposures: &'a [Json],
}

/// Of a record, what tells whose it is.
#[derive(Debug, Clone, Deserialize)]
pub struct Finished {
    pub run_key: String,
    #[serde(default)]
    exposure_key: String,
    #[serde(default)]
    made_from: Json,
    pub files: Vec<FileRecord>,
    pub preview: Option<PreviewRecord>,
}

impl Finished {
    pub fn of(record: &Record) -> Self {
        let Record { run_key, exposure_key, made_from, files, preview, .. } = record.clone();
        Self { run_key, exposure_key, made_from, files, preview }
    }

    /// Whether it is exposure `index` of a plan, or one beyond its end.
    pub fn belongs(&self, index: usize, run_key: &str, exposures: &[Json]) -> bool {
        let same = |own: &Json| self.exposure_key == exposure_key(run_key, own);
        self.run_key == run_key && exposures.get(index).is_none_or(same)
    }
}

/// A folder's manifest.
#[derive(Debug)]
enum Found {
    Missing,
    /// What is wrong with it; it may be another program's.
    Damaged(String),
    Whole(Box<Manifest>),
}

impl Found {
    fn of(folder: &Path) -> Self {
        let path = folder.join(MANIFEST);
        match disk::read(&path) {
            Ok(bytes) => match Manifest::parse(&String::from_utf8_lossy(&bytes)) {
                Ok(manifest) => Self::Whole(Box::new(manifest)),
                Err(error) => Self::Damaged(error),
            },
            Err(error) if path.exists() => Self::Damaged(error.to_string()),
            Err(_) => Self::Missing,
        }
    }
}

/// What lies in a folder.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    names: Vec<String>,
    manifest: Found,
    pub finished: BTreeMap<usize, Finished>,
}

impl Folder {
    /// Reads the manifest and all records. A folder that is not there is empty.
    pub fn read(path: &Path) -> Result<Self, DatasetError> {
        let error = |source| DatasetError::Read { path: path.to_path_buf(), source };
        let entries = match fs::read_dir(path) {
            Ok(entries) => entries.collect::<Result<Vec<_>, _>>().map_err(error)?,
            Err(source) if source.kind() == ErrorKind::NotFound => Vec::new(),
            Err(source) => return Err(error(source)),
        };
        let mut names: Vec<String> =
            entries.iter().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        // Temporary files are hidden ones.
        names.retain(|name| !name.starts_with('.'));
        names.sort();
        let manifest = Found::of(path);
        let record = |name: &String| {
            let index = index_of(name).filter(|_| name.ends_with(".json") && name.matches('.').count() == 1)?;
            let bytes = disk::read(&path.join(name)).ok()?;
            Some((index, serde_json::from_slice(&bytes).ok()?))
        };
        let finished = names.iter().filter_map(record).collect();
        Ok(Self { path: path.into(), names, manifest, finished })
    }

    /// The manifest alone, where it is whole.
    pub fn read_manifest(path: &Path) -> Option<Manifest> {
        match Found::of(path) {
            Found::Whole(manifest) => Some(*manifest),
            _ => None,
        }
    }

    pub fn manifest(&self) -> Option<&Manifest> {
        match &self.manifest {
            Found::Whole(manifest) => Some(manifest),
            _ => None,
        }
    }

    /// What is wrong with the manifest, on one line.
    pub fn damage(&self) -> Option<String> {
        match &self.manifest {
            Found::Damaged(why) => Some(format!("{} is damaged: {why}", self.path.join(MANIFEST).display())),
            _ => None,
        }
    }

    /// Why a run may not begin: something here would be lost.
    pub fn refusal(&self, plan: &Plan, existing: Existing) -> Option<DatasetError> {
        if existing.overwrite {
            return None;
        }
        self.other_run(plan).or_else(|| {
            let others = self.others(plan.exposures.len(), existing);
            let listed = others.iter().take(LISTED).map(|name| name.as_str()).collect::<Vec<_>>().join(", ");
            let more = others.len().saturating_sub(LISTED);
            let names = if more > 0 { format!("{listed} and {more} more") } else { listed };
            (!others.is_empty()).then(|| DatasetError::ForeignFiles { path: self.path.clone(), names })
        })
    }

    fn other_run(&self, plan: &Plan) -> Option<DatasetError> {
        let path = self.path.clone();
        let exposures = plural(self.finished.len(), "exposure");
        let refused = |differences: String| DatasetError::OtherRun { path, exposures, differences };
        if self.finished.is_empty() {
            return None;
        }
        let differs = |finished: &Finished| plan.key.is_some_and(|key| finished.run_key != key);
        match self.manifest() {
            Some(manifest) if manifest.run.made_from.is_null() => {
                return Some(refused("made by an earlier version of the program".into()));
            }
            Some(manifest) => {
                // Of what is not known yet nothing can be said.
                let known = |old: &Json| match (old, plan.shared) {
                    (Json::Object(old), Json::Object(new)) if plan.key.is_none() => old
                        .iter()
                        .filter(|(key, _)| new.contains_key(*key))
                        .map(|(k, v)| (k.clone(), v.clone()))
                        .collect(),
                    _ => old.clone(),
                };
                let differences = differences::told(&known(&manifest.run.made_from), plan.shared, "");
                if !differences.is_empty() {
                    return Some(refused(differences));
                }
            }
            None => {}
        }
        if self.finished.values().any(differs) {
            let why = self.damage().unwrap_or_else(|| "its manifest does not tell which".into());
            return Some(refused(why));
        }
        let own = self.finished.iter().filter_map(|(index, finished)| {
            let differences =
                differences::told(&finished.made_from, plan.exposures.get(*index)?, &format!("exposures[{index}]"));
            (!differences.is_empty()).then_some(differences)
        });
        own.into_iter().next().map(refused)
    }

    /// Names that are not the program's and that a run of so many exposures writes over; where nobody says to go on, all.
    fn others(&self, planned: usize, existing: Existing) -> Vec<&String> {
        let begun = self.manifest().map(|manifest| manifest.exposures_planned);
        // Without a manifest records vouch for what lies beside them.
        let begun = begun.or((!self.finished.is_empty()).then_some(usize::MAX));
        let is_ours = |name: &str| match (begun, index_of(name)) {
            (None, _) => false,
            (Some(begun), Some(index)) => index < begun || self.finished.contains_key(&index),
            (Some(_), None) => true,
        };
        let is_written = |name: &str| index_of(name).map_or_else(|| is_of_sequence(name), |index| index < planned);
        let matters = |name: &str| is_written(name) || (begun.is_none() && !existing.resume);
        self.names.iter().filter(|name| matters(name) && !is_ours(name)).collect()
    }

    /// Removes what does not belong to a run that may overwrite: exposures of others with what they list, and the files of
    /// their sequences. What no record or manifest lists stays.
    pub fn make_room(&mut self, run_key: &str, exposures: &[Json]) {
        let strange = |(index, finished): &(&usize, &Finished)| !finished.belongs(**index, run_key, exposures);
        let indices: Vec<usize> = self.finished.iter().filter(strange).map(|(index, _)| *index).collect();
        let mut names = Vec::new();
        for index in indices {
            let Some(finished) = self.finished.remove(&index) else { continue };
            // The record goes first: without it nothing is taken for finished.
            names.push(name(index, "json"));
            names.extend(
                finished
                    .files
                    .iter()
                    .chain(finished.preview.iter().flat_map(PreviewRecord::files))
                    .map(|file| file.name.clone()),
            );
        }
        let other = self.manifest().filter(|manifest| manifest.run_key != run_key);
        names.extend(other.iter().flat_map(|manifest| &manifest.files).map(|file| file.name.clone()));
        // Lists are files: a name that leads elsewhere is none of ours.
        for name in names.iter().filter(|name| Path::new(name).components().count() == 1) {
            // What will not go away is met again when it is written.
            let _ = fs::remove_file(self.path.join(name));
        }
    }
}

/// `exposure_0007.json`.
pub fn name(index: usize, extension: &str) -> String {
    format!("exposure_{index:04}.{extension}")
}

/// The exposure that a file belongs to.
pub fn index_of(name: &str) -> Option<usize> {
    let (digits, _) = name.strip_prefix("exposure_")?.split_once('.')?;
    let plain = digits.len() >= 4 && digits.bytes().all(|byte| byte.is_ascii_digit());
    digits.parse().ok().filter(|_| plain)
}

fn is_of_sequence(name: &str) -> bool {
    SEQUENCE_FILES.contains(&name) || sequences::is_one(name)
}

/// `1 exposure`, `2 exposures`.
pub fn plural(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
