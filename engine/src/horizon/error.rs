//! What can go wrong with horizon tiles.

use std::path::{Path, PathBuf};

use super::pack::Encoding;

/// Why a tile cannot be made, written or read.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("azimuths = {got} is too few for {encoding}, at least {least} are needed")]
    TooFewAzimuths { got: usize, encoding: Encoding, least: usize },
    #[error("observer_height_m = {got} is outside [0, 1e6] m")]
    ObserverHeight { got: f64 },
    #[error("search_m = {got} is not a positive distance in m")]
    SearchDistance { got: f64 },
    #[error("level {got} does not exist, the face has {levels}")]
    NoLevel { got: usize, levels: usize },
    #[error("level {level} has {columns} × {rows} nodes within its margin, at least 2 × 2 are needed")]
    TooSmall { level: usize, columns: usize, rows: usize },
    #[error("cannot write {path}")]
    Write { path: PathBuf, source: std::io::Error },
    #[error("cannot read {path}")]
    Read { path: PathBuf, source: std::io::Error },
    #[error("cannot encode {path} as TIFF")]
    Encode { path: PathBuf, source: tiff::TiffError },
    #[error("{path} is truncated or not a TIFF")]
    Decode { path: PathBuf, source: tiff::TiffError },
    #[error("{path} is not a horizon tile of this program: {reason}")]
    Header { path: PathBuf, reason: String },
    #[error("{path} has format version {got}, this program reads {expected}")]
    Version { path: PathBuf, got: u32, expected: u32 },
    #[error("{path} was made from other heights or settings: its key is {got}, expected {expected}")]
    OtherKey { path: PathBuf, got: String, expected: String },
    #[error("{path}: page {page} is {got:?}, the header says {expected:?} texels")]
    Page { path: PathBuf, page: usize, got: (u32, u32), expected: (u32, u32) },
    #[error("the search on a graphics device was asked for, but no device was opened")]
    NoDevice,
    #[error(transparent)]
    Gpu(#[from] crate::gpu::GpuError),
}

impl Error {
    pub(super) fn write(path: &Path, source: std::io::Error) -> Self {
        Self::Write { path: path.into(), source }
    }

    pub(super) fn read(path: &Path, source: std::io::Error) -> Self {
        Self::Read { path: path.into(), source }
    }

    pub(super) fn header(path: &Path, reason: impl ToString) -> Self {
        Self::Header { path: path.into(), reason: reason.to_string() }
    }
}
