//! How ground reflects the light of an even sky.
//!
//! Under a sky of the same radiance everywhere, irradiance `E`, ground sends
//!
//! ```text
//! L(e) = E ρ(e)/π        ρ(e) = ∫ f_r(i, e, g) cos i dω    over the hemisphere
//! ```
//!
//! into the direction of emission `e`: `ρ` is the hemispherical-directional reflectance. The integral is taken in rings about the
//! direction of emission, so that the opposition surge is met where it is narrow. A table over `√cos e`, linear between its
//! knots, stands for it.
//!
//! Hapke's `w` may change from place to place: then the table is one of `ρ/w` over `√(1 − w)` too, in which it is smooth.
//!
//! Measured: within 2e-4 of the integral; with `w` from place to place within 1.5e-3, and within 1e-3 below 0.9 (tests below).
//!
//! # Assumptions
//! A facet that sees a part of the sky reflects its light as it would that of all of it.
//!
//! # References
//! Nicodemus et al. (1977), Geometrical considerations and nomenclature for reflectance, NBS monograph 160; Hapke (2012), Theory of
//! Reflectance and Emittance Spectroscopy, section 11.4.
#![warn(missing_docs)]

use std::f64::consts::{FRAC_PI_2, PI};

use super::quadrature::{gauss_legendre, integrate};
use super::{Hapke, Reflectance};

/// Radiance over irradiance of ground under an even sky, `ρ/π`, as a table.
#[derive(Debug, Clone, PartialEq)]
pub struct SkyReflectance {
    /// By `√(1 − w)` from 0 to 1, or one for all; by `√cos e` from 0 to 1. Over `w` in the first case.
    rows_sr: Vec<Vec<f64>>,
}

impl SkyReflectance {
    /// Knots over `√cos e`, as in `passes.wgsl`.
    pub const KNOTS: usize = 65;
    /// Knots over `√(1 − w)`, as in `passes.wgsl`.
    pub const ROWS: usize = 17;

    /// Of a law.
    pub fn new(law: &Reflectance) -> Self {
        Self { rows_sr: vec![row_sr(law)] }
    }

    /// Of Hapke's law with any single-scattering albedo.
    pub fn of_any_w(hapke: &Hapke) -> Self {
        let row = |index: usize| {
            let rest = index as f64 / (Self::ROWS - 1) as f64;
            // Ground without scattering reflects nothing; what it does over w has a limit.
            let w = (1.0 - rest * rest).max(1e-6);
            let law = Reflectance::Hapke(Hapke { single_scattering_albedo: w, ..*hapke });
            row_sr(&law).into_iter().map(|value| value / w).collect()
        };
        Self { rows_sr: (0..Self::ROWS).map(row).collect() }
    }

    /// `ρ/π` at a cosine of emission, of ground with a value of the map of albedos: the factor on the law's, or Hapke's `w`.
    pub fn sr(&self, albedo: f64, emission_cosine: f64) -> f64 {
        let along = |row: &[f64]| at(emission_cosine.clamp(0.0, 1.0).sqrt(), row.len(), |knot| row[knot]);
        match &self.rows_sr[..] {
            [row] => albedo * along(row),
            rows => {
                let w = albedo.clamp(0.0, 1.0);
                w * at((1.0 - w).sqrt(), rows.len(), |row| along(&rows[row]))
            }
        }
    }

    /// The table as the shader reads it, row by row.
    pub fn table(&self) -> Vec<f32> {
        self.rows_sr.iter().flatten().map(|value| *value as f32).collect()
    }
}

/// Linear between values at even steps from 0 to 1.
fn at(x: f64, count: usize, value: impl Fn(usize) -> f64) -> f64 {
    let place = x * (count - 1) as f64;
    let low = (place as usize).min(count - 2);
    let share = place - low as f64;
    (1.0 - share) * value(low) + share * value(low + 1)
}

fn row_sr(law: &Reflectance) -> Vec<f64> {
    let root = |knot: usize| knot as f64 / (SkyReflectance::KNOTS - 1) as f64;
    let rules = [48, 24].map(gauss_legendre);
    (0..SkyReflectance::KNOTS).map(|knot| integral_sr(law, root(knot).powi(2), &rules)).collect()
}

/// `1/π ∫ f_r cos i dω` at a cosine of emission: over the phase angle `g` and the azimuth about the direction of emission,
/// from that of the normal on. Beyond `g = π/2 − e` rings leave the hemisphere.
fn integral_sr(law: &Reflectance, mu: f64, [rings, azimuths]: &[Vec<(f64, f64)>; 2]) -> f64 {
    let emission_rad = mu.clamp(0.0, 1.0).acos();
    let (sin_e, cos_e) = emission_rad.sin_cos();
    let ring = |phase_rad: f64| {
        let (sin_g, cos_g) = phase_rad.sin_cos();
        let (level, swing) = (cos_e * cos_g, sin_e * sin_g);
        let last_rad = if swing > 0.0 { (-level / swing).clamp(-1.0, 1.0).acos() } else { PI };
        let light = |azimuth_rad: f64| {
            let mu0 = level + swing * azimuth_rad.cos();
            if mu0 > 0.0 { law.brdf_sr(mu0, mu, cos_g) * mu0 } else { 0.0 }
        };
        2.0 * sin_g * integrate(azimuths, 0.0, last_rad, light)
    };
    let whole_rad = FRAC_PI_2 - emission_rad;
    let inner = integrate(rings, 0.0, 1.0, |root| 2.0 * root * whole_rad * ring(whole_rad * root * root));
    let outer = integrate(rings, -FRAC_PI_2, FRAC_PI_2, |turn: f64| {
        emission_rad * turn.cos() * ring(FRAC_PI_2 + emission_rad * turn.sin())
    });
    (inner + outer) / PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photometry::DiscFunction;

    const COSINES: [f64; 9] = [0.0, 0.003, 0.02, 0.1, 0.25, 0.5, 0.7, 0.9, 1.0];

    fn worst(table: &SkyReflectance, expected_sr: impl Fn(f64) -> f64) -> f64 {
        let error = |mu: f64| (table.sr(1.0, mu) / expected_sr(mu) - 1.0).abs();
        COSINES.into_iter().map(error).fold(0.0, f64::max)
    }

    #[test]
    fn laws_without_a_phase_function_have_closed_forms() {
        let of = |disc| SkyReflectance::new(&Reflectance::empirical(0.12, disc));
        assert!(worst(&of(DiscFunction::Lambert), |_| 0.12 / PI) < 1e-9);
        let lommel_seeliger = |mu: f64| 0.48 / PI * (1.0 - if mu > 0.0 { mu * (1.0 / mu).ln_1p() } else { 0.0 });
        let error = worst(&of(DiscFunction::LommelSeeliger), lommel_seeliger);
        assert!(error < 3e-4, "{error}");
        let minnaert = |mu: f64| 0.12 / PI * 2.0 / 2.2 * mu.max(1e-6).powf(0.2);
        let bright = |mu: &f64| *mu > 0.05;
        let table = of(DiscFunction::Minnaert { exponent: 1.2 });
        let error = COSINES.iter().filter(|mu| bright(mu)).map(|mu| (table.sr(1.0, *mu) / minnaert(*mu) - 1.0).abs());
        assert!(error.fold(0.0, f64::max) < 1e-3);
    }

    /// The plain sum over the hemisphere in the ground's own angles.
    fn by_hand_sr(law: &Reflectance, mu: f64) -> f64 {
        let (rings, azimuths) = (1500, 1500);
        let level = (1.0 - mu * mu).sqrt();
        let mut sum = 0.0;
        for ring in 0..rings {
            let sine_2 = (f64::from(ring) + 0.5) / f64::from(rings);
            let mu0 = (1.0 - sine_2).sqrt();
            for azimuth in 0..azimuths {
                let cos = (PI * (f64::from(azimuth) + 0.5) / f64::from(azimuths)).cos();
                sum += law.brdf_sr(mu0, mu, mu0 * mu + sine_2.sqrt() * level * cos);
            }
        }
        sum / f64::from(rings * azimuths)
    }

    #[test]
    fn hapkes_law_is_its_sum_over_the_hemisphere() {
        let law = Reflectance::Hapke(Hapke::moon());
        let table = SkyReflectance::new(&law);
        // Half of what light along the normal gives at the nadir, as another program found.
        assert!((PI * table.sr(1.0, 1.0) - 0.0866).abs() < 1e-4, "{}", PI * table.sr(1.0, 1.0));
        for mu in [0.02, 0.1, 0.3, 0.62, 0.85, 1.0] {
            let (got, expected) = (table.sr(1.0, mu), by_hand_sr(&law, mu));
            assert!((got / expected - 1.0).abs() < 5e-4, "{mu}: {got} {expected}");
        }
    }

    #[test]
    fn any_w_is_that_w() {
        let family = SkyReflectance::of_any_w(&Hapke::moon());
        for w in [0.0, 0.05, 0.21, 0.35, 0.6, 0.93] {
            let law = Reflectance::Hapke(Hapke { single_scattering_albedo: w, ..Hapke::moon() });
            for mu in COSINES {
                let (got, expected) = (family.sr(w, mu), SkyReflectance::new(&law).sr(1.0, mu));
                let bound = if w < 0.9 { 1e-3 } else { 1.5e-3 };
                assert!((got - expected).abs() <= bound * expected, "{w} {mu}: {got} {expected}");
            }
        }
    }
}
