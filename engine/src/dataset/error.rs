//! What can go wrong with a dataset.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

#[derive(Debug, Error)]
pub enum DatasetError {
    #[error("the output {path} is a file, not a directory")]
    OutputIsAFile { path: PathBuf },
    #[error("cannot create the output directory {path}: {source}")]
    Create { path: PathBuf, source: io::Error },
    /// Keeps the system's own words, as in `No space left on device`.
    #[error("cannot write {path}: {source}")]
    Write { path: PathBuf, source: io::Error },
    #[error("cannot read {path}: {source}")]
    Read { path: PathBuf, source: io::Error },
    #[error("cannot encode {path} as OpenEXR: {source}")]
    EncodeExr { path: PathBuf, source: exr::error::Error },
    #[error("cannot read {path} as OpenEXR: {source}")]
    DecodeExr { path: PathBuf, source: exr::error::Error },
    #[error("cannot encode {path}: {source}")]
    EncodeImage { path: PathBuf, source: image::ImageError },
    #[error("cannot read {path} as an image: {source}")]
    DecodeImage { path: PathBuf, source: image::ImageError },
    #[error("cannot encode {path} as TIFF: {source}")]
    EncodeTiff { path: PathBuf, source: tiff::TiffError },
    #[error("cannot encode {path} as NPZ: {source}")]
    EncodeNpz { path: PathBuf, source: zip::result::ZipError },
    #[error(transparent)]
    Raster(#[from] crate::raster::Error),
    #[error("cannot read {path} as TIFF: {source}")]
    DecodeTiff { path: PathBuf, source: tiff::TiffError },
    #[error("cannot read {path} as JSON: {source}")]
    Json { path: PathBuf, source: serde_json::Error },
    #[error("the plane {channel} of exposure {index} has {got} values, allowed are {columns} × {rows}")]
    PlaneSize { index: usize, channel: &'static str, got: usize, columns: usize, rows: usize },
    #[error("exposure {index} has no planes")]
    NoPlanes { index: usize },
    #[error("the directory {path} holds no manifest.json, so it is no dataset")]
    NoDataset { path: PathBuf },
    #[error("{path} is none of OpenEXR, PNG, TIFF, a record, a manifest")]
    UnknownFile { path: PathBuf },
    /// A panic of the writing thread: a broken invariant, told apart from a full disk.
    #[error("the thread that writes {path} ended early")]
    WriterEnded { path: PathBuf },
}
