//! How wrong a tile's horizons are, as its header states it.
#![warn(missing_docs)]

use serde::{Deserialize, Serialize};

use crate::statistics::Errors;

/// Quantiles of absolute errors over a sample, in radians.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ErrorStatistics {
    /// Number of errors.
    pub samples: usize,
    /// Root of their mean square.
    pub rms_rad: f64,
    /// Median of their sizes.
    pub p50_rad: f64,
    /// 95 % are no larger.
    pub p95_rad: f64,
    /// 99 % are no larger.
    pub p99_rad: f64,
    /// The largest.
    pub max_rad: f64,
}

impl ErrorStatistics {
    /// Statistics of signed errors; zeros for an empty sample.
    pub fn of(errors_rad: impl IntoIterator<Item = f64>) -> Self {
        let mut sizes_rad: Vec<f64> = errors_rad.into_iter().map(f64::abs).collect();
        // Squares are added from the smallest on, whatever the order of the sample.
        sizes_rad.sort_by(f64::total_cmp);
        let Errors { count, rms, p50, p95, p99, max, .. } = Errors::of(sizes_rad);
        let [rms_rad, p50_rad, p95_rad, p99_rad, max_rad] = [rms, p50, p95, p99, max].map(short);
        Self { samples: count, rms_rad, p50_rad, p95_rad, p99_rad, max_rad }
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
    /// Nodes that were traced.
    pub pixels: usize,
    /// Errors of the swept profiles, before compression.
    pub swept: ErrorStatistics,
    /// Errors of the series decoded from the tile.
    pub decoded: ErrorStatistics,
    /// How the bounds of the nodes held.
    pub bound: BoundStatistics,
}

/// What a tile's bounds rest on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct BoundStatistics {
    /// Azimuths at which every node was compared with the sweep.
    pub azimuths: usize,
    /// From the largest error there to the bound; 0 where no node was measured and no bound is known.
    pub factor: f64,
    /// RMS of the measured samples' errors as fractions of their nodes' bounds: times a bound, a standard deviation.
    #[serde(rename = "rms_share")]
    pub rms_fraction: f64,
    /// Measured nodes, and samples of them, beyond their bound.
    pub nodes_beyond: usize,
    /// Samples beyond the bound of their node.
    pub samples_beyond: usize,
}
