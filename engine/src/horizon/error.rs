//! What can go wrong with horizon tiles, and how wrong their horizons are.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::bound::BoundStatistics;
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

/// Quantiles of absolute errors over a sample, in radians.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ErrorStatistics {
    pub samples: usize,
    pub rms_rad: f64,
    pub p50_rad: f64,
    pub p95_rad: f64,
    pub p99_rad: f64,
    pub max_rad: f64,
}

impl ErrorStatistics {
    /// Statistics of signed errors; zeros for an empty sample.
    pub fn of(errors_rad: impl IntoIterator<Item = f64>) -> Self {
        let mut sizes_rad: Vec<f64> = errors_rad.into_iter().map(f64::abs).collect();
        sizes_rad.sort_by(f64::total_cmp);
        let Some(last) = sizes_rad.len().checked_sub(1) else { return Self::default() };
        let quantile = |share: f64| short(sizes_rad[(last as f64 * share).round() as usize]);
        let mean_square = sizes_rad.iter().map(|e| e * e).sum::<f64>() / sizes_rad.len() as f64;
        Self {
            samples: sizes_rad.len(),
            rms_rad: short(mean_square.sqrt()),
            p50_rad: quantile(0.50),
            p95_rad: quantile(0.95),
            p99_rad: quantile(0.99),
            max_rad: short(sizes_rad[last]),
        }
    }
}

/// A number of four digits: it reads back from text as itself.
fn short(value: f64) -> f64 {
    format!("{value:.3e}").parse().expect("a number printed is a number")
}

/// The errors of a tile against traced horizons, over all azimuths of a stated number of pixels. In a tile with a
/// band, decoded, swept and traced elevations beyond it count as its ends: the errors are those that a light can show.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct TileErrors {
    pub pixels: usize,
    /// Of the swept profiles, before compression.
    pub swept: ErrorStatistics,
    /// Of the series decoded from the tile.
    pub decoded: ErrorStatistics,
    pub bound: BoundStatistics,
}
