//! Reading and writing of whole files, with errors that name them.

use std::fs;
use std::path::Path;

use super::error::DatasetError;
use crate::files;

/// Writes `bytes` to `path`, whole or not at all ([`files::write`]).
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), DatasetError> {
    files::write(path, bytes).map_err(|source| DatasetError::Write { path: path.to_path_buf(), source })
}

/// Writes files of one folder in their order ([`files::write_in_order`]).
pub fn write_in_order<'a>(
    folder: &Path,
    files: impl IntoIterator<Item = (&'a str, &'a [u8])>,
) -> Result<(), DatasetError> {
    files::write_in_order(folder, files).map_err(|(path, source)| DatasetError::Write { path, source })
}

/// Makes `directory` where it is not there, and tries whether files can be written into it.
pub fn check_writable(directory: &Path) -> Result<(), DatasetError> {
    let path = directory.to_path_buf();
    if directory.is_file() {
        return Err(DatasetError::OutputIsAFile { path });
    }
    fs::create_dir_all(directory).map_err(|source| DatasetError::Create { path: path.clone(), source })?;
    files::probe(directory).map_err(|source| DatasetError::Write { path, source })
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
        let error = write(Path::new("/dev/full"), b"bytes").unwrap_err();
        assert!(error.to_string().contains("No space left on device"), "{error}");
    }
}
