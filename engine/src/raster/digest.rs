//! SHA-256 of a file, by which manifests name their inputs.

use std::fs::File;
use std::io;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::Error;
use super::access::file_of;

/// The SHA-256 of a file's bytes, or of those of the file that a name lies within, as 64 lower-case hexadecimal digits.
pub fn digest(path: &Path) -> Result<String, Error> {
    let failed = |source| Error::File { path: path.into(), source };
    let mut hash = Sha256::new();
    io::copy(&mut File::open(file_of(path)).map_err(failed)?, &mut hash).map_err(failed)?;
    Ok(crate::digest::hex(&hash.finalize()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// FIPS 180-2, appendix B.1.
    #[test]
    fn the_digest_of_abc_is_the_published_one() {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), "abc").unwrap();
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(digest(file.path()).unwrap(), expected);
        std::fs::write(file.path(), "abd").unwrap();
        assert_ne!(digest(file.path()).unwrap(), expected);
    }

    #[test]
    fn a_missing_file_is_named() {
        assert!(digest(Path::new("no/such.tif")).unwrap_err().to_string().contains("no/such.tif"));
    }
}
