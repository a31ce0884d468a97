//! How the brightness of ground falls with the phase angle, beyond what its disc function says.
//!
//! Empirical laws are `RADF = A f(g) D(i, e, g)`: the disc function `D` spreads the light over the disc, the phase
//! function `f` says how much there is, with `f(0) = D(0, 0, 0) = 1`. That of the Moon is what the whole disc has, over
//! what the disc function alone would give it:
//!
//! ```text
//! f(g) = A_ROLO(g)/A_D(g) · A_D(0)/A_ROLO(0)        A_D(g) = ∫ D μ dω / π
//! ```
//!
//! so that each law's disc is as bright as ROLO saw the Moon, whatever its disc function. For the shader `ln f` is a sum
//! of six terms, fitted to that ratio:
//!
//! ```text
//! ln f = a₁ g + a₂ g² + a₃ g³ + a₄ g⁴ + s₁ (e^(−g/p₁) − 1) + s₂ (e^(−g/p₂) − 1)
//! ```
//!
//! with ROLO's two widths of the surge. The fit is within 1 % of the ratio up to 97°, where ROLO ends, and within 5 % up
//! to 130°; beyond, `f` stays what it is there.
//!
//! # References
//! Kieffer & Stone (2005), AJ 129, 2887, doi:10.1086/430185, equation 10 and table 4 (665.1 nm, mean of waxing and
//! waning, libration 0): fitted from 1.55° to 97°.

use super::PhotometryError;
use crate::linear::solve;

/// `ln f` of the phase angle as a sum of terms.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PhaseFunction {
    /// Of the first four powers of the phase angle in radians.
    pub powers: [f64; 4],
    /// Of the narrow and of the wide surge.
    pub surges: [f64; 2],
}

/// Phase angles over which the two surges fade, `p₁` and `p₂` of ROLO in degrees.
pub(super) const SURGE_WIDTHS_DEG: [f64; 2] = [4.06054, 12.8802];

/// Beyond this phase angle the function stays what it is.
pub(super) const LAST_DEG: f64 = 130.0;

/// ROLO's fit ends here; beyond it counts little.
const ROLO_LAST_DEG: f64 = 97.0;

impl PhaseFunction {
    /// 1 at every phase angle.
    pub const CONSTANT: Self = Self { powers: [0.0; 4], surges: [0.0; 2] };

    /// The Moon's, for a disc function whose sphere has the disc-integrated reflectance `of_sphere` at a phase angle in rad.
    pub(super) fn of_the_moon(of_sphere: impl Fn(f64) -> f64) -> Result<Self, PhotometryError> {
        let mut normal = [[0.0; 7]; 7];
        let mut right = [0.0; 7];
        for phase_deg in phases_deg() {
            let phase_rad = phase_deg.to_radians();
            let target = (lunar_disc_reflectance(phase_rad) / of_sphere(phase_rad)).ln();
            let weight = if phase_deg <= ROLO_LAST_DEG { 1.0 } else { 0.03 };
            let terms = terms(phase_rad);
            for (row, term) in terms.into_iter().enumerate() {
                right[row] += weight * term * target;
                for (entry, other) in normal[row].iter_mut().zip(terms) {
                    *entry += weight * term * other;
                }
            }
        }
        let [_, a, b, c, d, narrow, wide] = solve(normal, right).ok_or(PhotometryError::NoPhaseFunction)?;
        Ok(Self { powers: [a, b, c, d], surges: [narrow, wide] })
    }

    /// Share of the light at opposition that is left at a phase angle.
    pub fn value(&self, phase_rad: f64) -> f64 {
        let phase_rad = phase_rad.clamp(0.0, LAST_DEG.to_radians());
        let [_, powers @ .., narrow, wide] = terms(phase_rad);
        let power_sum: f64 = self.powers.iter().zip(powers).map(|(factor, term)| factor * term).sum();
        let [narrow_factor, wide_factor] = self.surges;
        (power_sum + narrow_factor * (narrow - 1.0) + wide_factor * (wide - 1.0)).exp()
    }
}

/// 1, four powers of the phase angle, and the two surges.
fn terms(phase_rad: f64) -> [f64; 7] {
    let [narrow, wide] = SURGE_WIDTHS_DEG.map(|width_deg| (-phase_rad / width_deg.to_radians()).exp());
    let square = phase_rad * phase_rad;
    [1.0, phase_rad, square, square * phase_rad, square * square, narrow, wide]
}

/// Where the fit is made: close together in the surge.
fn phases_deg() -> impl Iterator<Item = f64> {
    let surge = (0..40).map(|i| 0.02 + 0.25 * f64::from(i));
    surge.chain((0..).map(|i| 10.0 + 2.0 * f64::from(i)).take_while(|phase_deg| *phase_deg <= LAST_DEG))
}

/// Disc-integrated reflectance of the Moon at 665.1 nm, the mean of waxing and waning without libration: ROLO's `A(g)`,
/// in opposition the geometric albedo.
pub fn lunar_disc_reflectance(phase_rad: f64) -> f64 {
    let phase_deg = phase_rad.to_degrees();
    let [narrow, wide] = SURGE_WIDTHS_DEG.map(|width_deg| (-phase_deg / width_deg).exp());
    let even = -1.88914 + phase_rad * (-1.58096 + phase_rad * (0.30477 - 0.17908 * phase_rad)) + 0.37141 * narrow
        - 0.13514 * wide
        + 0.01248 * ((phase_deg + 30.5858) / 16.7498).cos();
    // The Sun's selenographic longitude is the phase angle, positive while the Moon waxes.
    let odd = phase_rad * (0.04415 + phase_rad.powi(2) * (0.00983 - 0.00389 * phase_rad.powi(2)));
    even.exp() * odd.cosh()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Kieffer & Stone 2005 at 665.1 nm, means of waxing and waning, three digits.
    #[test]
    fn the_curve_is_that_of_rolo() {
        for (phase_deg, expected) in [(2.0f64, 0.159), (7.0, 0.1227), (30.0, 0.068), (60.0, 0.033), (90.0, 0.0135)] {
            let got = lunar_disc_reflectance(phase_deg.to_radians());
            assert!((got / expected - 1.0).abs() < 6e-3, "{phase_deg}: {got}");
        }
    }

    /// Allen's phase curve in magnitudes, `0.026 g + 4e-9 g⁴`: beyond the fit of ROLO its curve goes on as the Moon does.
    #[test]
    fn beyond_its_fit_it_falls_as_the_moon_does() {
        let magnitude = |g: f64| 0.026 * g + 4e-9 * g.powi(4);
        for phase_deg in [100.0f64, 110.0, 120.0, 130.0] {
            let ratio = |g: f64| lunar_disc_reflectance(g.to_radians()) / lunar_disc_reflectance(90f64.to_radians());
            let expected = 10f64.powf(-0.4 * (magnitude(phase_deg) - magnitude(90.0)));
            assert!((ratio(phase_deg) / expected - 1.0).abs() < 0.15, "{phase_deg}: {} {expected}", ratio(phase_deg));
        }
    }

    #[test]
    fn it_begins_at_one_and_ends_in_a_plateau() {
        let lambert = |g: f64| 2.0 / 3.0 * (g.sin() + (std::f64::consts::PI - g) * g.cos()) / std::f64::consts::PI;
        let phase = PhaseFunction::of_the_moon(lambert).unwrap();
        assert!((phase.value(0.0) - 1.0).abs() < 1e-12);
        assert_eq!(phase.value(2.4), phase.value(3.1));
        assert_eq!(PhaseFunction::CONSTANT.value(1.0), 1.0);
    }
}
