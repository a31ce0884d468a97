//! The manifest of a sequence: what made it, from what, and what it consists of.

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::record::{BodyRecord, FileRecord, SoftwareRecord, WarningRecord};

/// What a run is made from; equal runs make equal bytes.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Run {
    pub title: String,
    /// Name of the sequence, as in `lunar_descent`.
    pub name: String,
    /// The scenario as written.
    pub scenario: String,
    pub body: BodyRecord,
    pub seed: u64,
    pub software: SoftwareRecord,
    /// In the order of the scenario.
    pub inputs: Vec<Input>,
    /// Resolved settings that shape the result.
    pub settings: Json,
}

/// A file that the run reads. Its folder is left out: the same file elsewhere makes the same bytes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// `dem`, `horizon`, `kernel`, `albedo`, `trajectory`, `attitude`.
    pub role: String,
    pub name: String,
    /// Of the file; of a horizon tile its key, the hash of all that shapes it.
    pub sha256: String,
}

impl Run {
    /// Hash of all that shapes the images.
    pub fn key(&self) -> String {
        let json = serde_json::to_vec(self).expect("plain values become JSON");
        crate::digest::sha256_hex(&json)
    }
}

/// `manifest.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    pub schema_version: String,
    pub run_key: String,
    pub run: Run,
    /// Exposures of the scenario; `exposures` lists those that are finished.
    pub exposures_planned: usize,
    pub preview: Option<PreviewScale>,
    pub exposures: Vec<ManifestEntry>,
    /// Of the whole sequence.
    pub files: Vec<FileRecord>,
}

/// The scale that all previews share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PreviewScale {
    pub channel: String,
    pub white: f64,
    pub unit: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ManifestEntry {
    pub index: usize,
    pub epoch_utc: String,
    /// Absent: the run has no sweep.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point: Option<usize>,
    /// `train`, `validation` or `test`; absent: the dataset is not split.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub split: Option<String>,
    /// What is odd about the image; absent: nothing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<WarningRecord>,
    pub files: Vec<FileRecord>,
}

/// The commit the program was built from (`build.rs`); `None` outside git.
pub fn commit() -> Option<String> {
    option_env!("PERILUNE_COMMIT").map(String::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_key_changes_with_every_input() {
        let run = Run { name: "a".into(), ..Run::default() };
        let input = Input { role: "dem".into(), name: "a.tif".into(), sha256: "00".into() };
        let changes = [
            Run { seed: 1, ..run.clone() },
            Run { scenario: "()".into(), ..run.clone() },
            Run { inputs: vec![input], ..run.clone() },
            Run { settings: serde_json::json!({ "azimuths": 360 }), ..run.clone() },
        ];
        assert!(changes.iter().all(|changed| changed.key() != run.key()));
        assert_eq!(run.clone().key(), run.key());
    }
}
