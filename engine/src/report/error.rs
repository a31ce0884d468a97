//! What can go wrong while a report is written.

use std::path::PathBuf;

/// A report that could not be written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A file or folder cannot be written.
    #[error("cannot write {path}")]
    Write { path: PathBuf, source: std::io::Error },
    /// A file cannot be written whole.
    #[error(transparent)]
    Dataset(#[from] crate::dataset::DatasetError),
    /// A picture cannot be encoded.
    #[error("cannot encode the image {name} as PNG")]
    Png { name: String, source: image::ImageError },
}
