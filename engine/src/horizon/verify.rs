//! Whether a horizon tile errs as its header says.
//!
//! A tile is verified on two samples of pixels, over all azimuths of each. On the sample that its builder measured,
//! the decoded error must be the stated one, to the digits of the header. On another one, drawn at random, the mean
//! square error may differ by chance only: with the means `m₁, m₂` and variances `s₁², s₂²` of the `n₁, n₂` pixels'
//! mean squares,
//!
//! ```text
//! |m₁ − m₂| ≤ 5 √(s₁²/n₁ + s₂²/n₂)
//! ```
//!
//! The measured sample lies beyond its bounds ([`crate::horizon::bound`]) as often as the header counts, to the sample. Of
//! the drawn one, nodes may lie beyond theirs as often as chance allows where a share `k/(n₁ + 1)` is expected to:
//! `n₂ p + 5 √(n₂ p (1 − p) (1 + n₂/(n₁ + 1)))`, the last factor since the share itself is known from `n₁` nodes only.
//!
//! In a tile with a band of elevations, decoded and traced skylines beyond it count as its ends, as they do in the header.
//!
//! Five deviations, since errors crowd at cliffs: their squares are far from a normal distribution.
//!
//! # References
//! Welch (1947), *The generalization of Student's problem*, doi:10.1093/biomet/34.1-2.28.

use glam::DVec2;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::horizon::build::MEASURED_PIXELS;
use crate::horizon::header::Header;
use crate::horizon::measure::Sample;
use crate::horizon::trace::Tracer;
use crate::horizon::{ErrorStatistics, HorizonMap, TileErrors, calibration};
use crate::terrain::Face;

/// The header keeps four digits; a rounding apart counts as the same.
const HEADER_DIGITS: f64 = 2e-3;
/// Deviations by which two samples may differ.
const DEVIATIONS: f64 = 5.0;

/// What tracing a tile anew has found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verification {
    /// On the pixels that the builder measured.
    pub repeated: ErrorStatistics,
    pub repeated_pixels: usize,
    /// On pixels drawn at random.
    pub drawn: ErrorStatistics,
    pub drawn_pixels: usize,
    pub seed: u64,
    /// How far the two samples' mean squares lie apart, in standard deviations of their difference.
    pub deviations: f64,
    /// Pixels that lie beyond their bound, and samples of pixels that do.
    pub repeated_beyond: [usize; 2],
    pub drawn_beyond: [usize; 2],
    stated: TileErrors,
}

impl Verification {
    /// The first stated figure that the builder's own pixels do not have: its name, what is stated, what is found.
    pub fn contradiction(&self) -> Option<(&'static str, f64, f64)> {
        let figures = |e: &ErrorStatistics| {
            let angles = [e.rms_rad, e.p50_rad, e.p95_rad, e.p99_rad, e.max_rad];
            [[e.samples as f64].as_slice(), &angles.map(f64::to_degrees)].concat()
        };
        let (stated, bound) = (&self.stated, &self.stated.bound);
        let names =
            ["samples", "rms", "p50", "p95", "p99", "max", "nodes beyond their bound", "samples beyond their bound"];
        let stated = [figures(&stated.decoded), vec![bound.nodes_beyond as f64, bound.samples_beyond as f64]].concat();
        let found = [figures(&self.repeated), self.repeated_beyond.map(|count| count as f64).to_vec()].concat();
        let pairs = names.into_iter().zip(stated).zip(found).map(|((name, stated), found)| (name, stated, found));
        pairs.into_iter().find(|(_, stated, found)| (found - stated).abs() > HEADER_DIGITS * stated.abs())
    }

    /// Whether the stated figures are those found on the builder's own pixels.
    pub fn repeats(&self) -> bool {
        self.contradiction().is_none()
    }

    /// Whether other pixels err alike.
    pub fn agrees(&self) -> bool {
        self.deviations <= DEVIATIONS && self.drawn_beyond[0] <= self.allowed_beyond()
    }

    /// Drawn pixels that may lie beyond their bounds.
    pub fn allowed_beyond(&self) -> usize {
        let (measured, drawn) = (self.repeated_pixels as f64, self.drawn_pixels as f64);
        let share = calibration::fraction_beyond(self.repeated_pixels);
        let variance = drawn * share * (1.0 - share) * (1.0 + drawn / (measured + 1.0));
        (drawn * share + DEVIATIONS * variance.sqrt()) as usize
    }
}

/// Traces `pixels` random pixels of a tile, and those that its builder measured. The face must be the one that the
/// tile was made from.
pub fn verify(face: &Face, level: usize, header: &Header, map: &HorizonMap, pixels: usize, seed: u64) -> Verification {
    let settings = &header.settings;
    let nodes = &face.levels[level];
    let tracer = Tracer::without_finer(face, level, settings);
    let errors_rad = |&[column, row]: &[usize; 2]| -> Vec<f64> {
        let foot = nodes.lifted_node(column + nodes.margin, row + nodes.margin);
        let series = map.horizon(DVec2::new(column as f64, row as f64));
        let relevant = |elevation_rad| settings.relevant_rad(&face.map, foot.truncate(), elevation_rad);
        let error_rad = |azimuth: usize| {
            let direction = settings.direction(azimuth);
            relevant(series.evaluate_towards(direction).0) - relevant(tracer.skyline(foot, direction).elevation_rad)
        };
        (0..settings.azimuths).map(error_rad).collect()
    };
    let errors_of = |pixels: &[[usize; 2]]| pixels.par_iter().map(errors_rad).collect::<Vec<_>>();

    let own = Sample::of(nodes, MEASURED_PIXELS, settings.azimuths).pixels;
    let known = |[column, row]: &[usize; 2]| !nodes.gap[nodes.index(column + nodes.margin, row + nodes.margin)];
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || [random.random_range(0..map.columns), random.random_range(0..map.rows)];
    let drawn: Vec<_> = (0..pixels).map(|_| draw()).filter(known).collect();
    let [repeated_rad, drawn_rad] = [&own, &drawn].map(|pixels| errors_of(pixels));
    Verification {
        repeated: ErrorStatistics::of(repeated_rad.iter().flatten().copied()),
        repeated_pixels: own.len(),
        drawn: ErrorStatistics::of(drawn_rad.iter().flatten().copied()),
        drawn_pixels: drawn.len(),
        seed,
        deviations: deviations(&mean_squares(&repeated_rad), &mean_squares(&drawn_rad)),
        repeated_beyond: map.bounds.exceeded(&own, &repeated_rad),
        drawn_beyond: map.bounds.exceeded(&drawn, &drawn_rad),
        stated: header.errors,
    }
}

fn mean_squares(errors_rad: &[Vec<f64>]) -> Vec<f64> {
    errors_rad.iter().map(|errors| errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).collect()
}

/// Welch's statistic: the difference of two means in its standard deviations.
fn deviations(a: &[f64], b: &[f64]) -> f64 {
    let moments = |values: &[f64]| {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        (mean, values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0) / count)
    };
    let ((mean_a, variance_a), (mean_b, variance_b)) = (moments(a), moments(b));
    let difference = (mean_a - mean_b).abs();
    // Two exact maps differ by nothing, without any scatter.
    if difference == 0.0 { 0.0 } else { difference / (variance_a + variance_b).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means 2 and 4, variances of the means 1/3 and 1/3: 2/√(2/3).
    #[test]
    fn two_samples_lie_apart_in_their_own_scatter() {
        let apart = deviations(&[1.0, 2.0, 3.0], &[3.0, 4.0, 5.0]);
        assert!((apart - 6.0_f64.sqrt()).abs() < 1e-12, "{apart}");
        assert_eq!(deviations(&[0.0, 0.0], &[0.0, 0.0]), 0.0);
    }
}
