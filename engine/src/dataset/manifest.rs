//! The manifest of a sequence: what made it, from what, and what it consists of.

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::record::{BodyRecord, FileRecord, SoftwareRecord, WarningRecord, is_false};
use super::seal;

/// Counts the changes of pixel values since the program's version: exposures of different models do not belong together.
/// It grows with every entry under "Changes pixel values" in the changelog, and starts again with a version.
const MODEL: u32 = 4;

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
    /// All that shapes the pixels and that the exposures share: what the run's key is the hash of.
    #[serde(default)]
    pub made_from: Json,
    /// Quarter size, one ray a pixel.
    #[serde(default, skip_serializing_if = "is_false")]
    pub draft: bool,
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
    /// Hash of all that shapes the pixels and that the exposures share.
    pub fn key(&self) -> String {
        hash(&self.made_from)
    }
}

/// What computes the pixels, for [`Run::made_from`].
pub fn model() -> String {
    format!("{} {MODEL}", env!("CARGO_PKG_VERSION"))
}

/// The key of an exposure: the run's, and what it is made from besides.
pub fn exposure_key(run_key: &str, made_from: &Json) -> String {
    hash(&serde_json::json!([run_key, made_from]))
}

fn hash(value: &Json) -> String {
    crate::digest::sha256_hex(value.to_string().as_bytes())
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
    /// Of all that stands before it in the file.
    #[serde(default)]
    pub sha256: String,
}

impl Manifest {
    /// The file, which ends with the hash of what comes before.
    pub fn text(self) -> String {
        seal::sealed(&Self { sha256: String::new(), ..self })
    }

    /// Reads a file; an error says what is wrong with it.
    pub fn parse(text: &str) -> Result<Self, String> {
        let manifest: Self = serde_json::from_str(text).map_err(|error| error.to_string())?;
        seal::check(text, &manifest.sha256).map(|()| manifest)
    }
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
    fn the_key_changes_with_what_shapes_pixels_and_with_nothing_else() {
        let run = Run { name: "a".into(), made_from: serde_json::json!({ "azimuths": 64 }), ..Run::default() };
        let text = Run { title: "b".into(), scenario: "// c".into(), ..run.clone() };
        assert_eq!(text.key(), run.key());
        assert_ne!(Run { made_from: serde_json::json!({ "azimuths": 65 }), ..run.clone() }.key(), run.key());
        let own = |epoch: f64| exposure_key(&run.key(), &serde_json::json!({ "epoch": epoch }));
        assert_ne!(own(1.0), own(2.0));
    }

    #[test]
    fn a_changed_manifest_is_noticed() {
        let manifest = Manifest {
            schema_version: "1".into(),
            run_key: "k".into(),
            run: Run { settings: serde_json::json!({ "a": 0.1 }), ..Run::default() },
            exposures_planned: 3,
            preview: None,
            exposures: Vec::new(),
            files: Vec::new(),
            sha256: String::new(),
        };
        let text = manifest.clone().text();
        let read = Manifest::parse(&text).unwrap();
        assert_eq!(Manifest { sha256: String::new(), ..read }, manifest);
        let changed = Manifest::parse(&text.replace("\"a\": 0.1", "\"a\": 0.2"));
        assert_eq!(changed.unwrap_err(), "it has not the SHA-256 that it states");
        assert!(Manifest::parse(&text[..text.len() / 2]).is_err());
    }
}
