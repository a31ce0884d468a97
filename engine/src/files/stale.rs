//! Temporary files of processes that are gone.

use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::time::{Duration, SystemTime};

use super::{PARTIAL, host};

/// No process of another machine leaves a file unchanged for so long.
const FOREIGN_AGE: Duration = Duration::from_secs(7 * 24 * 3600);

/// Removes the temporary files in `folder` that no process writes any more, and says how many.
pub fn remove_stale(folder: &Path) -> io::Result<usize> {
    let mut removed = 0;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let Some(owner) = name.to_str().and_then(Owner::of) else { continue };
        // Another process may remove it at the same time; one that will not go away harms nobody.
        if owner.is_gone(&entry.path()) && fs::remove_file(entry.path()).is_ok() {
            removed += 1;
        }
    }
    Ok(removed)
}

/// Who writes a temporary file.
#[derive(Debug, PartialEq)]
pub(super) struct Owner<'a> {
    pub host: &'a str,
    pub process: u32,
}

impl<'a> Owner<'a> {
    /// The owner that a temporary name tells; `None`: it is no such name.
    pub fn of(name: &'a str) -> Option<Self> {
        let (_, owner) = name.strip_prefix('.')?.strip_suffix(PARTIAL)?.rsplit_once('.')?;
        let mut parts = owner.split('-');
        let (host, process, random) = (parts.next()?, parts.next()?, parts.next()?);
        let is_random = random.len() == 16 && random.bytes().all(|byte| byte.is_ascii_hexdigit());
        let owner = Self { host, process: process.parse().ok()? };
        (is_random && !host.is_empty() && parts.next().is_none()).then_some(owner)
    }

    fn is_gone(&self, path: &Path) -> bool {
        if self.host == host() { !is_alive(self.process) && !is_locked(path) } else { age(path) > FOREIGN_AGE }
    }
}

/// Zero where it is not known.
fn age(path: &Path) -> Duration {
    let modified = fs::metadata(path).and_then(|found| found.modified());
    modified.ok().and_then(|then| SystemTime::now().duration_since(then).ok()).unwrap_or_default()
}

/// A container's processes are not in the list of the machine's, but their locks are.
fn is_locked(path: &Path) -> bool {
    let Ok(file) = File::open(path) else { return true };
    matches!(file.try_lock(), Err(fs::TryLockError::WouldBlock))
}

#[cfg(unix)]
fn is_alive(process: u32) -> bool {
    let Ok(process) = libc::pid_t::try_from(process) else { return false };
    // SAFETY: signal 0 is sent to nobody; the system only looks whether it could be.
    let status = unsafe { libc::kill(process, 0) };
    status == 0 || io::Error::last_os_error().raw_os_error() != Some(libc::ESRCH)
}

#[cfg(not(unix))]
fn is_alive(_: u32) -> bool {
    true
}
