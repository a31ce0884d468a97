//! The corpora of `fuzz/`: what a fuzzer began with, and what it found, through the functions that it calls.

use std::path::{Path, PathBuf};

#[path = "../fuzz/entry.rs"]
mod entry;

/// Files of a reader's corpus by name, the same order on every machine.
fn corpus(name: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(name);
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// Readers refuse or read all files whole, cut short anywhere, and with any of their bytes changed (some hundred of each).
#[test]
fn readers_survive_their_corpora_and_damage_to_them() {
    for (name, read) in entry::TARGETS {
        let files = corpus(name);
        assert!(!files.is_empty(), "{name} has no corpus");
        for path in files {
            let bytes = std::fs::read(&path).unwrap();
            read(&bytes);
            let step = bytes.len().div_ceil(100).max(1);
            for at in (0..bytes.len()).step_by(step) {
                read(&bytes[..at]);
                for change in [0x00, 0xff, bytes[at] ^ 0x80, bytes[at].wrapping_add(1)] {
                    let mut damaged = bytes.clone();
                    damaged[at] = change;
                    read(&damaged);
                }
            }
        }
    }
}

/// Each reader has its program for the fuzzer.
#[test]
fn every_reader_is_a_target() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
    for (name, _) in entry::TARGETS {
        assert!(folder.join(format!("fuzz_targets/{name}.rs")).is_file(), "{name}");
        assert!(manifest.contains(&format!("name = \"{name}\"")), "{name}");
    }
}
