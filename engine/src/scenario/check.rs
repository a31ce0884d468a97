//! What collects the problems of a scenario's values.

use std::path::{Path, PathBuf};

use super::error::{Fault, Problem};
use super::files::{Found, SearchPath};
use super::tree::{Node, TextPosition};
use crate::ephemeris::KernelSource;
use crate::raster::Within;

/// Says what a file is and where it can be had, by its name.
pub type FileHint<'a> = &'a dyn Fn(&str) -> Option<String>;

/// Collects problems while a [`Spec`] becomes a [`Scenario`]. Where a value is wrong, a harmless one takes its place,
/// so that the rest can be checked too; the scenario is then thrown away.
pub struct Check<'a> {
    pub tree: Option<&'a Node>,
    pub problems: Vec<Problem>,
    /// What the user should know, though it works.
    pub notes: Vec<String>,
    pub places: &'a SearchPath,
    pub about: FileHint<'a>,
}

impl Check<'_> {
    pub fn report(&mut self, key: &str, fault: Fault) {
        let place = self.tree.map_or(TextPosition { line: 1, column: 1 }, |tree| tree.locate(key));
        self.problems.push(Problem { place, key: key.into(), fault });
    }

    /// Reports `key = got rule` unless the rule holds.
    pub fn rule(&mut self, holds: bool, key: &str, got: impl ToString, rule: impl Into<String>) {
        if !holds {
            self.report(key, Fault::Breaks { got: got.to_string(), rule: rule.into() });
        }
    }

    /// Reports `key needs …` unless it has it.
    pub fn needs(&mut self, holds: bool, key: &str, needs: impl Into<String>) {
        if !holds {
            self.report(key, Fault::Needs(needs.into()));
        }
    }

    pub fn file(&mut self, key: &str, name: &str) -> PathBuf {
        let found = self.places.find(name);
        self.found(key, name, found)
    }

    /// A raster's file, or the name of something within one.
    pub fn raster(&mut self, key: &str, name: &str) -> PathBuf {
        let find = |name: &str| match self.places.find(name) {
            Found::File(path) => Some(path),
            _ => None,
        };
        match (self.places.find(name), Within::find(name, &find)) {
            (Found::Nowhere(_), Some(within)) => within.name,
            (found, _) => self.found(key, name, found),
        }
    }

    pub fn folder(&mut self, key: &str, name: &str) -> PathBuf {
        match self.places.find(name) {
            Found::Directory(path) => path,
            Found::File(_) | Found::Excerpt(_) => {
                self.report(key, Fault::Needs("must be a folder".into()));
                PathBuf::new()
            }
            nowhere => self.found(key, name, nowhere),
        }
    }

    /// A kernel's file, or the kernel of that name that the program carries.
    pub fn kernel(&mut self, key: &str, name: &str) -> KernelSource {
        match (self.places.find(name), KernelSource::shipped(name)) {
            (Found::Nowhere(_), Some(shipped)) => shipped,
            (found, _) => KernelSource::File(self.found(key, name, found)),
        }
    }

    fn found(&mut self, key: &str, name: &str, found: Found) -> PathBuf {
        let got = name.to_string();
        match found {
            Found::File(path) => return path,
            Found::Excerpt(path) => {
                self.notes.push(format!("{key}: {name} is not there, its excerpt {} is used", path.display()));
                return path;
            }
            Found::Directory(_) => self.report(key, Fault::IsADirectory { got }),
            Found::Nowhere(looked_in) => {
                let file_name = Path::new(name).file_name().map(|name| name.to_string_lossy().into_owned());
                let about = file_name.and_then(|name| (self.about)(&name));
                self.report(key, Fault::FileNotFound { got, looked_in, about });
            }
        }
        PathBuf::new()
    }

    pub fn epoch(&mut self, key: &str, text: &str) -> Option<hifitime::Epoch> {
        let epoch = crate::ephemeris::parse_epoch(text).ok();
        if epoch.is_none() {
            self.report(key, Fault::NotAnEpoch { got: text.into() });
        }
        epoch
    }
}
