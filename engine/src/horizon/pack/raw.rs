//! Elevations at a few azimuths (Max 1988), the baseline of Fritsch et al. (2025).
//!
//! ```text
//! h(A) = (1 − t) hᵢ + t hᵢ₊₁      A n/2π = i + t      h_n = h₀
//! ```
//!
//! A texel of `n/2` words holds `h₀ … h_{n−1}` as half floats, the first of a pair in the low half. Azimuths are map
//! azimuths, the first at 0. The slope across the disc is that of the piece, at a sampled azimuth that of the piece
//! clockwise of it.

use std::f64::consts::TAU;

use glam::DVec2;

use super::half::unpack;
use super::texels::Texels;

/// A skyline of straight pieces between evenly spaced azimuths.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampled {
    pub elevations_rad: Vec<f64>,
}

impl Sampled {
    /// Elevation and its derivative by azimuth towards the unit map direction `(sin A, cos A)`.
    pub fn evaluate_towards(&self, towards: DVec2) -> (f64, f64) {
        let count = self.elevations_rad.len();
        let per_rad = count as f64 / TAU;
        let at = towards.x.atan2(towards.y).rem_euclid(TAU) * per_rad;
        let (low, fraction) = (at.floor() as usize % count, at.fract());
        let [from, to] = [low, (low + 1) % count].map(|index| self.elevations_rad[index]);
        (from + fraction * (to - from), (to - from) * per_rad)
    }
}

/// The samples at a grid point.
pub(super) fn sampled(texels: &Texels, grid: DVec2) -> Sampled {
    let words = texels.words_per_texel;
    let pair = |word: usize| texels.bilinear(grid, 1, |words| unpack(words[word]).map(f64::from));
    Sampled { elevations_rad: (0..words).flat_map(pair).collect() }
}
