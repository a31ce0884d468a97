//! Where a scenario's files are looked for.

use std::path::{Path, PathBuf};

use crate::ephemeris::known_file;

/// Directories in which file names of a scenario are looked up, in this order.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchPath {
    /// The scenario's own directory.
    pub beside: PathBuf,
    /// `--data`, then `SIM_DATA`.
    pub data: Vec<PathBuf>,
}

/// What became of a file name.
pub(super) enum Found {
    File(PathBuf),
    /// A part or a reduction of a known file that is not there.
    Excerpt(PathBuf),
    Directory(PathBuf),
    Nowhere(Vec<String>),
}

impl SearchPath {
    /// The directories for a scenario's file: its directory, `data`, and `SIM_DATA`.
    pub fn of(scenario: &Path, data: &[PathBuf]) -> Self {
        let beside = scenario.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let shared = std::env::var_os("SIM_DATA").map(PathBuf::from);
        Self { beside: beside.to_path_buf(), data: data.iter().cloned().chain(shared).collect() }
    }

    /// A file by its name, in `dem/` and `kernels/` of the directories too; in place of a known file that is nowhere, its excerpt.
    pub(super) fn find(&self, name: &str) -> Found {
        let found = find_in(name, self.directories());
        let is_plain = Path::new(name).file_name() == Some(Path::new(name).as_os_str());
        match found {
            Found::Nowhere(_) if is_plain => {
                let excerpts = known_file(name).map_or(&[][..], |file| &file.excerpts);
                let excerpt = || excerpts.iter().find_map(|excerpt| self.in_folders(excerpt)).map(Found::Excerpt);
                self.in_folders(name).map(Found::File).or_else(excerpt).unwrap_or(found)
            }
            found => found,
        }
    }

    fn in_folders(&self, name: &str) -> Option<PathBuf> {
        let within = |directory: &Path| ["", "dem", "kernels"].map(|folder| directory.join(folder).join(name));
        self.directories().flat_map(within).find(|path| path.is_file())
    }

    fn directories(&self) -> impl Iterator<Item = &Path> {
        [self.beside.as_path()].into_iter().chain(self.data.iter().map(PathBuf::as_path))
    }
}

fn find_in<'a>(name: &str, directories: impl Iterator<Item = &'a Path>) -> Found {
    if Path::new(name).is_absolute() {
        return state(Path::new(name), &[]);
    }
    let directories: Vec<_> = directories.collect();
    let candidate = directories.iter().map(|directory| directory.join(name)).find(|path| path.exists());
    match candidate {
        Some(path) => state(&path, &directories),
        None => nowhere(&directories),
    }
}

fn state(path: &Path, directories: &[&Path]) -> Found {
    match path {
        path if path.is_file() => Found::File(path.to_path_buf()),
        path if path.is_dir() => Found::Directory(path.to_path_buf()),
        _ => nowhere(directories),
    }
}

fn nowhere(directories: &[&Path]) -> Found {
    Found::Nowhere(directories.iter().map(|directory| directory.display().to_string()).collect())
}
