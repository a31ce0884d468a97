//! Horizon profiles as truncated Fourier series.
//!
//! Seen from one point, the elevation of the skyline is periodic in map azimuth `A` (clockwise from map +Y
//! towards map +X):
//!
//! ```text
//! h(A) = a₀ + Σₖ₌₁ᴷ (aₖ cos kA + bₖ sin kA)
//! a₀ = 1/N Σ h(Aᵢ)   aₖ = 2/N Σ h(Aᵢ) cos kAᵢ   bₖ = 2/N Σ h(Aᵢ) sin kAᵢ
//! ```
//!
//! This one-sided normalisation is the only one in the program: `a₀` is the mean and no factor is left to whoever
//! evaluates. What truncation discards is known exactly: by Parseval's theorem the RMS error over the azimuths is
//! `√(mean h² − a₀² − ½ Σ (aₖ² + bₖ²))`. The maximum error has no such bound at a cliff (Gibbs), so a tile's header
//! records the measured one. The shaders beside [`super::pack`] evaluate the same sum from packed texels.

use glam::{DVec2, Vec2Swizzles as _};

/// A truncated Fourier series over azimuth, in radians.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    pub mean_rad: f64,
    /// `[aₖ, bₖ]` from `k = 1` on.
    pub harmonics_rad: Vec<[f64; 2]>,
}

impl Series {
    /// The least-squares series of evenly spaced samples, the first at azimuth 0.
    pub fn fit(samples_rad: &[f64], harmonics: usize) -> Self {
        let count = samples_rad.len() as f64;
        let mean_rad = samples_rad.iter().sum::<f64>() / count;
        let harmonic = |k: usize| {
            let mut sums = [0.0; 2];
            for (i, sample_rad) in samples_rad.iter().enumerate() {
                let (sin, cos) = turned(k, i, samples_rad.len());
                sums[0] += sample_rad * cos;
                sums[1] += sample_rad * sin;
            }
            sums.map(|sum| 2.0 / count * sum)
        };
        Self { mean_rad, harmonics_rad: (1..=harmonics).map(harmonic).collect() }
    }

    /// Elevation of the skyline and its derivative by azimuth.
    pub fn evaluate(&self, azimuth_rad: f64) -> (f64, f64) {
        let (sin, cos) = azimuth_rad.sin_cos();
        self.evaluate_towards(DVec2::new(sin, cos))
    }

    /// [`Self::evaluate`] towards the unit map direction `(sin A, cos A)`: the angles `kA` are reached by turning.
    pub fn evaluate_towards(&self, towards: DVec2) -> (f64, f64) {
        let step = towards.yx();
        let (mut turned, mut elevation_rad, mut slope) = (step, self.mean_rad, 0.0);
        for (k, [a, b]) in (1..).zip(&self.harmonics_rad) {
            elevation_rad += a * turned.x + b * turned.y;
            slope += f64::from(k) * (b * turned.x - a * turned.y);
            turned = step.rotate(turned);
        }
        (elevation_rad, slope)
    }

    pub fn elevation_rad(&self, azimuth_rad: f64) -> f64 {
        self.evaluate(azimuth_rad).0
    }

    /// RMS over azimuth of what the series discards of its samples.
    pub fn discarded_rms_rad(&self, samples_rad: &[f64]) -> f64 {
        let power = samples_rad.iter().map(|h| h * h).sum::<f64>() / samples_rad.len() as f64;
        let kept: f64 = self.harmonics_rad.iter().flatten().map(|c| 0.5 * c * c).sum();
        (power - self.mean_rad * self.mean_rad - kept).max(0.0).sqrt()
    }
}

/// Sine and cosine of `kA` for sample `i` of `count`, reduced so that 0 and a full turn agree exactly.
pub(super) fn turned(k: usize, i: usize, count: usize) -> (f64, f64) {
    (std::f64::consts::TAU * ((k * i) % count) as f64 / count as f64).sin_cos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn samples(count: usize, h: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..count).map(|i| h(TAU * i as f64 / count as f64)).collect()
    }

    #[test]
    fn a_raised_cosine_is_kept_exactly_with_its_phase() {
        for (b, phase_rad) in [(0.2, 0.0), (0.05, 1.3), (0.3, 4.0)] {
            let h = |azimuth_rad: f64| 0.1 + b * (azimuth_rad - phase_rad).cos();
            let series = Series::fit(&samples(360, h), 15);
            assert!((series.mean_rad - 0.1).abs() < 1e-15);
            for i in 0..100 {
                let azimuth_rad = f64::from(i) * 0.0731;
                let (elevation_rad, slope) = series.evaluate(azimuth_rad);
                assert!((elevation_rad - h(azimuth_rad)).abs() < 1e-14);
                assert!((slope + b * (azimuth_rad - phase_rad).sin()).abs() < 1e-13);
            }
        }
    }

    /// Wall of height q times its distance: atan(q cos A)₊.
    #[test]
    fn an_infinite_wall_loses_what_its_closed_form_says() {
        for (q, expected_rad) in [(0.1, 0.0021), (0.5, 0.0106), (2.0, 0.043)] {
            let h = |azimuth_rad: f64| (q * azimuth_rad.cos()).max(0.0_f64).atan();
            let series = Series::fit(&samples(3600, h), 15);
            let worst_rad = (0..3600)
                .map(|i| TAU * f64::from(i) / 3600.0)
                .map(|a| (series.elevation_rad(a) - h(a)).abs())
                .fold(0.0, f64::max);
            // The published figures have two digits.
            assert!((worst_rad / expected_rad - 1.0).abs() < 0.03, "q = {q}: {worst_rad}");
        }
    }

    #[test]
    fn a_box_rings_as_gibbs_says() {
        let h = |a: f64| if (a - 3.0).abs() < 0.5 { 0.2 } else { 0.0 };
        let series = Series::fit(&samples(7200, h), 15);
        let values: Vec<_> = (0..7200).map(|i| series.elevation_rad(TAU * f64::from(i) / 7200.0)).collect();
        let (low, high) = values.iter().fold((0.0_f64, 0.0_f64), |(low, high), v| (low.min(*v), high.max(*v)));
        assert!((high - 0.2 - 0.0129).abs() < 2e-4, "{high}");
        assert!((low + 0.0214).abs() < 2e-4, "{low}");
    }

    #[test]
    fn the_discarded_power_is_the_error_measured() {
        let all = samples(720, |a| if a < 1.0 { 0.3 } else { 0.02 * (9.0 * a).sin() - 0.1 });
        let series = Series::fit(&all, 15);
        let squares: f64 = (0..720).map(|i| (series.elevation_rad(TAU * i as f64 / 720.0) - all[i]).powi(2)).sum();
        assert!(((squares / 720.0).sqrt() - series.discarded_rms_rad(&all)).abs() < 1e-12);
    }
}
