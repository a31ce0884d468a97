//! Findings of a benchmark's steps, kept on disk until the last one is done: a run that is stopped goes on where it was.
//!
//! They belong to one program with one set of options. A run that ends takes them away, so that the next one measures anew.

use std::fmt::Debug;
use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::Error;
use perilune_engine::dataset::write_whole;
use perilune_engine::digest::sha256_hex;

/// The steps of one run.
#[derive(Debug)]
pub struct StepCache {
    directory: PathBuf,
}

impl StepCache {
    /// Of the run that `options` describe, in a cache.
    pub fn new(cache: &Path, options: &impl Debug) -> Result<Self, Error> {
        // Another build of the program has other figures.
        let program = std::env::current_exe().and_then(fs::read).unwrap_or_default();
        let run = sha256_hex(format!("{} {options:?}", sha256_hex(&program)).as_bytes());
        let directory = cache.join("bench").join(&run[..16]);
        fs::create_dir_all(&directory).map_err(|source| Error::Write { path: directory.clone(), source })?;
        Ok(Self { directory })
    }

    /// What a step found before, or finds now.
    pub fn step<T: Serialize + DeserializeOwned>(
        &self,
        name: &str,
        find: impl FnOnce() -> Result<T, Error>,
    ) -> Result<T, Error> {
        let path = self.directory.join(format!("{name}.json"));
        if let Some(found) = fs::read(&path).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok()) {
            return Ok(found);
        }
        let found = find()?;
        write_whole(&path, &serde_json::to_vec(&found).expect("text and numbers"))?;
        Ok(found)
    }

    /// Forgets all steps.
    pub fn end(self) -> Result<(), Error> {
        fs::remove_dir_all(&self.directory).map_err(|source| Error::Write { path: self.directory, source })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stopped_run_goes_on_and_a_finished_one_starts_anew() {
        let folder = tempfile::TempDir::new().unwrap();
        let kept = |options: &str| StepCache::new(folder.path(), &options.to_owned()).unwrap();
        let stopped = || Err(Error::NoTerrain);
        assert_eq!(kept("a").step("first", || Ok(1.5)).unwrap(), 1.5);
        assert!(kept("a").step::<f64>("second", stopped).is_err());
        assert_eq!(kept("a").step("first", || Ok(2.5)).unwrap(), 1.5);
        assert_eq!(kept("a").step("second", || Ok(3.5)).unwrap(), 3.5);
        assert_eq!(kept("b").step("first", || Ok(2.5)).unwrap(), 2.5);
        kept("a").end().unwrap();
        assert_eq!(kept("a").step("first", || Ok(4.5)).unwrap(), 4.5);
    }
}
