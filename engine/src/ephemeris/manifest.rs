//! Data files that Perilune knows by name: what they are, where they can be had, their SHA-256.
//!
//! The list is `kernels/manifest.ron`.

use std::sync::OnceLock;

use serde::Deserialize;

const MANIFEST: &str = include_str!("../../../kernels/manifest.ron");

/// One file of the manifest.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KnownFile {
    pub name: String,
    /// A phrase: `the planetary ephemeris DE440, short span`.
    pub what: String,
    /// Agency, product and address.
    pub source: String,
    /// Terms of use, for those who pass on what is made from the file.
    #[serde(default)]
    pub licence: Option<String>,
    /// Missing where the file was not at hand.
    #[serde(default)]
    pub sha256: Option<String>,
    /// Names of parts or reductions of it that serve in its place.
    #[serde(default)]
    pub excerpts: Vec<String>,
    /// Epochs for kernels, region for terrain.
    pub coverage: String,
}

/// All known files, in the order of the manifest.
pub fn known_files() -> &'static [KnownFile] {
    static FILES: OnceLock<Vec<KnownFile>> = OnceLock::new();
    FILES.get_or_init(|| ron::from_str(MANIFEST).expect("a test parses the manifest"))
}

/// A file by its name without folder.
pub fn known_file(name: &str) -> Option<&'static KnownFile> {
    known_files().iter().find(|file| file.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_known_file_is_listed_once_and_told_in_full() {
        for (i, file) in known_files().iter().enumerate() {
            assert!(!file.what.is_empty() && !file.source.is_empty() && !file.coverage.is_empty(), "{}", file.name);
            assert!(
                known_files()[..i].iter().all(|earlier| earlier.name != file.name),
                "{} is listed twice",
                file.name
            );
            if let Some(sha256) = &file.sha256 {
                assert!(sha256.len() == 64 && sha256.bytes().all(|c| c.is_ascii_hexdigit()), "{}", file.name);
            }
        }
        assert!(known_file("de440s.bsp").is_some());
    }
}
