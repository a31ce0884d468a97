//! What can go wrong with a dataset.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// An error with the file or folder that it is about, but for those of images before they have one.
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
    #[error("cannot read {path} as NPZ: {source}")]
    DecodeNpz { path: PathBuf, source: zip::result::ZipError },
    #[error("{path} holds no file with the planes of an exposure")]
    NoStoredPlanes { path: PathBuf },
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
    #[error("{path} is damaged: {why}")]
    DamagedManifest { path: PathBuf, why: String },
    #[error("{path} is none of OpenEXR, PNG, TIFF, NPZ, COCO, a record, a manifest")]
    UnknownFile { path: PathBuf },
    #[error(
        "{path} holds {exposures} of another run: {differences}; choose another output, go on with the settings that they were \
         made with, or overwrite them"
    )]
    OtherRun { path: PathBuf, exposures: String, differences: String },
    #[error("{path} holds files that no run has made ({names}); choose another output, or overwrite them")]
    ForeignFiles { path: PathBuf, names: String },
    /// A panic of the writing thread: a broken invariant, told apart from a full disk.
    #[error("the thread that writes {path} ended early")]
    WriterEnded { path: PathBuf },
}

impl DatasetError {
    /// The file or folder that it is about.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::OutputIsAFile { path }
            | Self::Create { path, .. }
            | Self::Write { path, .. }
            | Self::Read { path, .. }
            | Self::EncodeExr { path, .. }
            | Self::DecodeExr { path, .. }
            | Self::EncodeImage { path, .. }
            | Self::DecodeImage { path, .. }
            | Self::EncodeTiff { path, .. }
            | Self::EncodeNpz { path, .. }
            | Self::DecodeNpz { path, .. }
            | Self::NoStoredPlanes { path }
            | Self::DecodeTiff { path, .. }
            | Self::Json { path, .. }
            | Self::NoDataset { path }
            | Self::DamagedManifest { path, .. }
            | Self::UnknownFile { path }
            | Self::OtherRun { path, .. }
            | Self::ForeignFiles { path, .. }
            | Self::WriterEnded { path } => Some(path),
            Self::Raster(_) | Self::PlaneSize { .. } | Self::NoPlanes { .. } => None,
        }
    }
}
