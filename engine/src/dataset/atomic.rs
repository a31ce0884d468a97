//! Files that are there whole or not at all.

use std::fs;
use std::path::Path;

use super::error::DatasetError;

/// Ends the name of a file that is not finished.
pub const PARTIAL: &str = ".partial";

/// Writes `bytes` beside `path` and renames: no reader ever sees half a file under its final name.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), DatasetError> {
    let mut partial = path.as_os_str().to_owned();
    partial.push(PARTIAL);
    fs::write(&partial, bytes).and_then(|()| fs::rename(&partial, path)).map_err(|source| {
        // The full disk that stopped the writing is not helped by keeping the rest.
        let _ = fs::remove_file(&partial);
        DatasetError::Write { path: path.to_path_buf(), source }
    })
}

/// Makes `directory` where it is not there, and tries whether files can be written into it.
pub fn check_writable(directory: &Path) -> Result<(), DatasetError> {
    let path = directory.to_path_buf();
    if directory.is_file() {
        return Err(DatasetError::OutputIsAFile { path });
    }
    fs::create_dir_all(directory).map_err(|source| DatasetError::Create { path: path.clone(), source })?;
    let probe = directory.join(format!("probe{PARTIAL}"));
    fs::write(&probe, b"probe")
        .and_then(|()| fs::remove_file(&probe))
        .map_err(|source| DatasetError::Write { path, source })
}

pub fn read(path: &Path) -> Result<Vec<u8>, DatasetError> {
    fs::read(path).map_err(|source| DatasetError::Read { path: path.to_path_buf(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_neither_file_nor_remains() {
        let folder = tempfile::TempDir::new().unwrap();
        let path = folder.path().join("file");
        fs::create_dir(&path).unwrap();
        fs::write(path.join("inside"), "").unwrap();
        let error = write(&path, b"bytes").unwrap_err();
        assert!(error.to_string().starts_with(&format!("cannot write {}: ", path.display())), "{error}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    /// `/dev/full` answers every write with ENOSPC.
    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_said_in_the_systems_words() {
        let folder = tempfile::TempDir::new().unwrap();
        let path = folder.path().join("file");
        std::os::unix::fs::symlink("/dev/full", folder.path().join("file.partial")).unwrap();
        let error = write(&path, b"bytes").unwrap_err();
        assert!(error.to_string().contains("No space left on device"), "{error}");
        assert!(!path.exists());
    }
}
