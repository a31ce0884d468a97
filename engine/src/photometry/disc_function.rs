//! How empirical laws spread light over a body's disc: `D(i, e, g)` of `RADF = A f(g) D`.
//!
//! With `μ0 = cos i`, `μ = cos e` and `g` the phase angle, `D/μ0` is
//!
//! ```text
//! Lambert           1
//! Lommel–Seeliger   2/(μ0 + μ)
//! lunar-Lambert     2 L(g)/(μ0 + μ) + 1 − L(g)     L = 1 − 0.019 g + 0.242e-3 g² − 1.46e-6 g³, g in deg, L ≥ 0
//! Minnaert          (μ0 μ)^(k−1)
//! Akimov            cos(g/2) cos(π d/(π − g)) (cos b)^(1 + η g/(π − g)) / (μ0 μ)
//! ```
//!
//! with the photometric latitude `b` and the longitude `d` from the middle between the points below the Sun and below
//! the camera:
//!
//! ```text
//! cos b cos d = (μ0 + μ)/(2 cos(g/2))        cos b sin d = (μ0 − μ)/(2 sin(g/2))
//! ```
//!
//! Akimov's `η` is 1 in his parameterless law; smaller ones fade less towards the poles of the photometric system.
//! Each is symmetric in `i` and `e`, and 1 at `i = e = g = 0`.
//!
//! # Assumptions
//! McEwen's weight `L(g)` is fitted to the Moon up to 100°; beyond 104°, where the fit turns negative, the law is
//! Lambert's.
//!
//! # References
//! McEwen (1996), LPSC XXVII, 841, for the lunar-Lambert weight (as in ISIS `LunarLambertMcEwen`);
//! Minnaert (1941), ApJ 93, 403; Shkuratov et al. (2011), PSS 59, 1326, doi:10.1016/j.pss.2011.06.011, for Akimov's law
//! with and without its parameter.
#![warn(missing_docs)]

use std::f64::consts::PI;

/// A disc function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DiscFunction {
    /// The same radiance towards all sides.
    Lambert,
    /// Single scattering by a dark, rough layer.
    LommelSeeliger,
    /// Lommel-Seeliger and Lambert, mixed by the phase angle.
    LunarLambert,
    /// Minnaert's law.
    Minnaert {
        /// Minnaert's `k`.
        exponent: f64,
    },
    /// Akimov's law.
    Akimov {
        /// Akimov's `η`: 1 is his parameterless law.
        smoothness: f64,
    },
}

/// Akimov's phase angle stays as far from 180°, where his law has no value.
const LEAST_SUPPLEMENT_RAD: f64 = 1e-3;

impl DiscFunction {
    /// `D/μ0` from the cosines of incidence and emission, both above 0, and of the phase angle.
    pub(super) fn over_incidence(&self, incidence_cosine: f64, emission_cosine: f64, phase_cosine: f64) -> f64 {
        let (mu0, mu) = (incidence_cosine, emission_cosine);
        match *self {
            Self::Lambert => 1.0,
            Self::LommelSeeliger => 2.0 / (mu0 + mu),
            Self::LunarLambert => {
                let weight = lunar_lambert_weight(phase_cosine.acos().to_degrees());
                2.0 * weight / (mu0 + mu) + 1.0 - weight
            }
            Self::Minnaert { exponent } => (mu0 * mu).powf(exponent - 1.0),
            Self::Akimov { smoothness } => akimov(smoothness, mu0, mu, phase_cosine),
        }
    }

    /// Its number in `reflectance.wgsl`, and its parameter.
    pub(super) fn constant(&self) -> (f64, f64) {
        match *self {
            Self::Lambert => (0.0, 0.0),
            Self::LommelSeeliger => (1.0, 0.0),
            Self::LunarLambert => (2.0, 0.0),
            Self::Minnaert { exponent } => (3.0, exponent),
            Self::Akimov { smoothness } => (5.0, smoothness),
        }
    }
}

/// Share of the Lommel–Seeliger term for the Moon; the fit turns negative beyond 104°, where 0 is taken.
fn lunar_lambert_weight(phase_deg: f64) -> f64 {
    (1.0 + phase_deg * (-0.019 + phase_deg * (0.242e-3 - 1.46e-6 * phase_deg))).max(0.0)
}

/// Akimov's disc function over the cosine of incidence; 1/μ0 in opposition.
fn akimov(smoothness: f64, mu0: f64, mu: f64, phase_cosine: f64) -> f64 {
    let phase_rad = phase_cosine.acos().min(PI - LEAST_SUPPLEMENT_RAD);
    let (half_sine, half_cosine) = (0.5 * phase_rad).sin_cos();
    let along = ((mu0 + mu) / (2.0 * half_cosine)).min(1.0);
    // In opposition the longitude has no influence, and no value.
    let reach = (1.0 - along * along).sqrt();
    let across = ((mu0 - mu) / (2.0 * half_sine).max(1e-12)).clamp(-reach, reach);
    let supplement_rad = PI - phase_rad;
    let towards_terminator = (PI / supplement_rad * across.atan2(along)).cos().max(0.0);
    let latitude_cosine = along.hypot(across);
    half_cosine * towards_terminator * latitude_cosine.powf(1.0 + smoothness * phase_rad / supplement_rad) / (mu0 * mu)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lunar_lambert_weight_is_that_of_isis() {
        let table = [1.0, 0.8327, 0.7051, 0.6084, 0.5338, 0.4725, 0.4158, 0.3550, 0.2813, 0.1859, 0.0600, 0.0, 0.0];
        for (i, weight) in (0..).zip(table) {
            let phase_deg = 10.0 * f64::from(i);
            assert!((lunar_lambert_weight(phase_deg) - weight).abs() < 6e-5, "{phase_deg} deg");
        }
    }
}
