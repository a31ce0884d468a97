//! Files that are there whole or not at all.
//!
//! A [`NewFile`] is written under a temporary name in the folder of the final one, brought to the disk and renamed: a
//! reader, or a process that goes on after a crash, finds the old file or the new one, never a part. A temporary name is
//! `.NAME.HOST-PROCESS-RANDOM.partial`; it is created exclusively and locked while it is written, so that any number of
//! processes on any number of machines may write one name, and the last to finish wins.
//!
//! Temporaries of processes that were killed stay. [`remove_stale`] removes them: those of this machine whose process is
//! gone and whose lock is free, and those of other machines that have not changed for a week.

pub mod cache;
mod stale;

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::hash::{BuildHasher as _, RandomState};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

pub use stale::remove_stale;

/// Ends a temporary name.
const PARTIAL: &str = ".partial";
/// Bytes of a host's name that a temporary name carries; file names have 255 at most.
const HOST_BYTES: usize = 32;
/// Bytes of the final name that a temporary name repeats.
const NAME_BYTES: usize = 160;

/// A file that is being written; dropped before [`commit`](Self::commit), it leaves nothing.
#[derive(Debug)]
pub struct NewFile {
    path: PathBuf,
    temporary: PathBuf,
    /// `None` once it is committed.
    file: Option<File>,
}

impl NewFile {
    /// Opens a temporary file beside `path`, for reading and writing. The folder must be there.
    pub fn create(path: &Path) -> io::Result<Self> {
        loop {
            let temporary = beside(path)?;
            match OpenOptions::new().read(true).write(true).create_new(true).open(&temporary) {
                Ok(file) => {
                    // Windows enforces locks, also against GDAL. Where a file system has no locks, the process counts.
                    #[cfg(unix)]
                    let _ = file.try_lock();
                    return Ok(Self { path: path.into(), temporary, file: Some(file) });
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
    }

    /// Where the bytes lie until they are committed, for libraries that want a path.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Gives the file its final name, replacing what has it; the bytes and the name are on the disk then.
    pub fn commit(self) -> io::Result<File> {
        let folder = folder_of(&self.path);
        let file = self.commit_name()?;
        sync_folder(&folder)?;
        Ok(file)
    }

    /// The bytes are on the disk; the name is once the folder is.
    fn commit_name(mut self) -> io::Result<File> {
        let file = self.file.take().ok_or_else(closed)?;
        let moved = file.sync_all().and_then(|()| fs::rename(&self.temporary, &self.path));
        if moved.is_err() {
            self.file = Some(file);
            return moved.and(Err(closed()));
        }
        #[cfg(unix)]
        let _ = file.unlock();
        Ok(file)
    }

    fn open(&mut self) -> io::Result<&mut File> {
        self.file.as_mut().ok_or_else(closed)
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        if self.file.take().is_some() {
            // The error that led here is the one to report.
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

impl Write for NewFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.open()?.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.open()?.flush()
    }
}

impl Seek for NewFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.open()?.seek(to)
    }
}

/// Writes `bytes` to `path`, whole or not at all. A device or a pipe is written to as it is.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir()) {
        return fs::write(path, bytes);
    }
    let mut file = NewFile::create(path)?;
    file.write_all(bytes)?;
    file.commit().map(|_| ())
}

/// Writes files of one folder, each whole or not at all, in their order: the last is there only if all others are. An error
/// names its file.
pub fn write_in_order<'a>(
    folder: &Path,
    files: impl IntoIterator<Item = (&'a str, &'a [u8])>,
) -> Result<(), (PathBuf, io::Error)> {
    for (name, bytes) in files {
        let path = folder.join(name);
        let written = NewFile::create(&path).and_then(|mut file| {
            file.write_all(bytes)?;
            file.commit_name()
        });
        written.map_err(|error| (path, error))?;
    }
    sync_folder(folder).map_err(|error| (folder.into(), error))
}

/// Waits until no other process has the folder locked, and keeps it until the file is dropped. `None`: its file system has
/// no locks.
pub fn lock(folder: &Path) -> Option<File> {
    if !cfg!(unix) {
        return None;
    }
    let folder = File::open(folder).ok()?;
    folder.lock().ok().map(|()| folder)
}

/// Tries whether files can be written into a folder.
pub fn probe(folder: &Path) -> io::Result<()> {
    let mut file = NewFile::create(&folder.join("probe"))?;
    file.write_all(b"probe")
}

fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.into(),
        _ => PathBuf::from("."),
    }
}

/// Brings names to the disk, where the file system can.
fn sync_folder(folder: &Path) -> io::Result<()> {
    use io::ErrorKind::{InvalidInput, PermissionDenied, Unsupported};
    if !cfg!(unix) {
        return Ok(());
    }
    match File::open(folder).and_then(|folder| folder.sync_all()) {
        Err(error) if [InvalidInput, PermissionDenied, Unsupported].contains(&error.kind()) => Ok(()),
        synced => synced,
    }
}

/// A temporary name in the folder of `path`.
fn beside(path: &Path) -> io::Result<PathBuf> {
    let name = path.file_name().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "it has no file name"))?;
    let name = name.to_string_lossy();
    let end = (0..=name.len().min(NAME_BYTES)).rev().find(|end| name.is_char_boundary(*end)).unwrap_or(0);
    // Keyed by the system's random numbers.
    let random = RandomState::new().hash_one(std::time::SystemTime::now());
    let (host, process) = (host(), std::process::id());
    Ok(path.with_file_name(OsString::from(format!(".{}.{host}-{process}-{random:016x}{PARTIAL}", &name[..end]))))
}

/// This machine's name in letters, digits and underscores.
fn host() -> &'static str {
    static HOST: OnceLock<String> = OnceLock::new();
    HOST.get_or_init(|| {
        let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
        let name: String = host_name().chars().take(HOST_BYTES).map(plain).collect();
        if name.is_empty() { "unknown".into() } else { name }
    })
}

#[cfg(unix)]
fn host_name() -> String {
    let mut bytes = [0_u8; 256];
    // SAFETY: the system writes at most as many bytes as it is told there are.
    let status = unsafe { libc::gethostname(bytes.as_mut_ptr().cast(), bytes.len()) };
    let length = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    if status == 0 { String::from_utf8_lossy(&bytes[..length]).into_owned() } else { String::new() }
}

#[cfg(not(unix))]
fn host_name() -> String {
    std::env::var("COMPUTERNAME").unwrap_or_default()
}

fn closed() -> io::Error {
    io::Error::other("the file is closed")
}

#[cfg(test)]
mod tests;
