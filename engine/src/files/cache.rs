//! The folder in which made terrain, horizons and findings of benches are kept for the next run.
//!
//! ```text
//! terrain/   highland-KEY.tif, detail-KEY.tif, each with its craters
//! horizon/   horizon_KEY.tif   tiles       plane_KEY.tif   skylines of one azimuth, for a run
//!            *.checkpoint      tiles that are half made
//! globe/     tiles of the part of a globe that a scenario shows
//! bench/     findings of a bench that is not finished
//! ```
//!
//! An entry's last change is its last use: who reads one touches it. [`trim`] removes what was used longest ago, but nothing that
//! was used since the oldest process that is still at work has begun. Processes say that they are with an [`InUse`].

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use super::{NewFile, remove_stale, stale};

/// Nothing else in the folder is ever removed.
const FOLDERS: [&str; 4] = ["terrain", "horizon", "globe", "bench"];
/// The final name that a process at work never gives its temporary file.
const MARK: &str = "in-use";
/// Clocks of machines that share a file system differ by less.
const CLOCKS: Duration = Duration::from_secs(60);

/// What is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    Terrain,
    HorizonTile,
    HalfMadeTile,
    Plane,
    Bench,
    Other,
}

impl Kind {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Terrain => "terrain",
            Self::HorizonTile => "horizon tile",
            Self::HalfMadeTile => "half-made horizon tile",
            Self::Plane => "skylines of one azimuth",
            Self::Bench => "bench",
            Self::Other => "other",
        }
    }

    fn of(folder: &str, name: &str) -> Self {
        match folder {
            "terrain" => Self::Terrain,
            "bench" => Self::Bench,
            _ if name.starts_with("plane_") => Self::Plane,
            _ if name.ends_with(".tif") => Self::HorizonTile,
            _ if name.contains("checkpoint") => Self::HalfMadeTile,
            _ => Self::Other,
        }
    }
}

/// A file of the cache.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    pub path: PathBuf,
    pub kind: Kind,
    pub bytes: u64,
    pub used: SystemTime,
}

/// What a cleaning has removed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Removed {
    pub files: usize,
    pub bytes: u64,
}

/// The user's own folder of caches: `XDG_CACHE_HOME`, or the system's usual place. `None`: the environment does not tell.
pub fn of_user() -> Option<PathBuf> {
    let folder = |variable: &str| std::env::var_os(variable).map(PathBuf::from).filter(|path| path.is_absolute());
    let base = if cfg!(windows) {
        folder("LOCALAPPDATA")
    } else {
        let usual = if cfg!(target_os = "macos") { "Library/Caches" } else { ".cache" };
        folder("XDG_CACHE_HOME").or_else(|| Some(folder("HOME")?.join(usual)))
    };
    Some(base?.join("perilune"))
}

/// Marks an entry as used now. Where that is not allowed it looks older than it is.
pub fn touch(path: &Path) {
    let _ = fs::File::open(path).and_then(|file| file.set_modified(SystemTime::now()));
}

/// All entries, those used longest ago first.
pub fn entries(cache: &Path) -> Vec<Entry> {
    let mut found = Vec::new();
    for folder in FOLDERS {
        collect(&cache.join(folder), folder, &mut found);
    }
    found.sort_by(|a, b| (a.used, &a.path).cmp(&(b.used, &b.path)));
    found
}

/// What another process removes meanwhile is left out.
fn collect(folder: &Path, kind: &str, found: &mut Vec<Entry>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        let Ok(metadata) = entry.metadata() else { continue };
        let name = entry.file_name().to_string_lossy().into_owned();
        if metadata.is_dir() {
            collect(&path, kind, found);
        } else if metadata.is_file() && stale::Owner::of(&name).is_none() {
            let used = metadata.modified().unwrap_or(SystemTime::UNIX_EPOCH);
            found.push(Entry { path, kind: Kind::of(kind, &name), bytes: metadata.len(), used });
        }
    }
}

/// A process at work in a cache, as long as it is held.
#[derive(Debug)]
pub struct InUse {
    // A temporary file: locked while it is held, removed with it, and taken for stale where its process was killed.
    _mark: NewFile,
}

impl InUse {
    /// Says that this process uses a cache. Where the folder cannot be written nothing can be said, nor removed.
    pub fn begin(cache: &Path) -> Option<Self> {
        fs::create_dir_all(cache).ok()?;
        NewFile::create(&cache.join(MARK)).ok().map(|mark| Self { _mark: mark })
    }
}

/// When the oldest of the processes began that are at work in a cache.
fn oldest_user(cache: &Path) -> Option<SystemTime> {
    let _ = remove_stale(cache);
    let is_mark = |name: &str| name.starts_with(&format!(".{MARK}.")) && stale::Owner::of(name).is_some();
    let marks = fs::read_dir(cache).into_iter().flatten().flatten();
    let began = |entry: fs::DirEntry| {
        let own = entry.file_name().to_str().is_some_and(is_mark);
        entry.metadata().ok()?.modified().ok().filter(|_| own)
    };
    marks.filter_map(began).min()
}

/// Removes the planes of swaths, unless a process is at work that may need them.
pub fn remove_planes(cache: &Path) -> Removed {
    if oldest_user(cache).is_some() {
        return Removed::default();
    }
    remove(entries(cache).into_iter().filter(|entry| entry.kind == Kind::Plane))
}

/// Removes what was used longest ago until at most so many bytes are left, and what killed processes have left; nothing that a
/// process at work may have used.
pub fn trim(cache: &Path, bytes: u64) -> Removed {
    for folder in FOLDERS {
        let _ = remove_stale(&cache.join(folder));
    }
    let spared = oldest_user(cache).and_then(|began| began.checked_sub(CLOCKS));
    let found = entries(cache);
    let mut left: u64 = found.iter().map(|entry| entry.bytes).sum();
    let unused = found.into_iter().filter(|entry| spared.is_none_or(|began| entry.used < began));
    remove(unused.take_while(|entry| {
        let over = left > bytes;
        left = left.saturating_sub(entry.bytes);
        over
    }))
}

fn remove(entries: impl Iterator<Item = Entry>) -> Removed {
    let mut removed = Removed::default();
    for entry in entries {
        // Another process may have been first; what will not go away is left.
        match fs::remove_file(&entry.path) {
            Ok(()) => {
                removed.files += 1;
                removed.bytes += entry.bytes;
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(_) => {}
        }
    }
    removed
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Files of 10 bytes, the first used longest ago.
    fn cache(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::TempDir::new().unwrap();
        let long_ago = SystemTime::now() - Duration::from_secs(100_000);
        for (age, name) in names.iter().enumerate() {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, [0; 10]).unwrap();
            let used = long_ago + Duration::from_secs(age as u64);
            fs::File::open(&path).unwrap().set_modified(used).unwrap();
        }
        folder
    }

    fn names(folder: &Path) -> Vec<String> {
        let below = |entry: &Entry| entry.path.strip_prefix(folder).unwrap().to_string_lossy().into_owned();
        entries(folder).iter().map(below).collect()
    }

    const NAMES: [&str; 4] = ["terrain/a.tif", "horizon/horizon_b.tif", "horizon/plane_c.tif", "bench/0/d.json"];

    #[test]
    fn what_was_used_longest_ago_goes_first() {
        let folder = cache(&NAMES);
        fs::write(folder.path().join("mine.txt"), "mine").unwrap();
        assert_eq!(names(folder.path()), NAMES);
        touch(&folder.path().join(NAMES[0]));
        assert_eq!(trim(folder.path(), 25), Removed { files: 2, bytes: 20 });
        assert_eq!(names(folder.path()), [NAMES[3], NAMES[0]]);
        assert_eq!(trim(folder.path(), 25), Removed::default());
        assert_eq!(trim(folder.path(), 0).files, 2);
        assert!(folder.path().join("mine.txt").exists());
    }

    #[test]
    fn what_a_process_at_work_has_used_stays() {
        let folder = cache(&NAMES);
        let at_work = InUse::begin(folder.path()).unwrap();
        touch(&folder.path().join(NAMES[2]));
        assert_eq!(remove_planes(folder.path()), Removed::default());
        assert_eq!(trim(folder.path(), 0).files, 3);
        assert_eq!(names(folder.path()), [NAMES[2]]);
        drop(at_work);
        assert_eq!(remove_planes(folder.path()).files, 1);
        assert_eq!(names(folder.path()), Vec::<String>::new());
    }

    #[test]
    fn a_cache_that_is_not_there_is_empty() {
        let nowhere = Path::new("/nowhere/at/all");
        assert_eq!((trim(nowhere, 0), entries(nowhere)), (Removed::default(), Vec::new()));
        assert!(InUse::begin(Path::new("/dev/null/cache")).is_none());
    }
}
