//! The part of a limb-darkened disc that another disc in front of it leaves: an eclipse.
//!
//! In the plane of the sky, with lengths in radii of the disc behind, `R` the radius of the other one and `d` the distance of
//! the centres, a ring of radius `ρ` is hidden over the half-angle `acos((ρ² + d² − R²)/(2ρd))`:
//!
//! ```text
//! share = 1 − ∫ I(ρ) φ(ρ) 2ρ dρ / ∫ I(ρ) π 2ρ dρ        φ: that angle, 0 outside the other disc, π inside
//! ```
//!
//! The integral is cut where `φ` starts and ends, over `ρ = sin θ`: good to 1e-9.
//!
//! Around the Moon the other disc is the Earth's with its atmosphere, `EARTH_SHADOW` times its own radius. Danjon's rule is
//! that of published contact times, and a choice: they vary by half a minute between rules.
//!
//! # Assumptions
//! - The sky is flat over the two discs: 1e-4 of the Sun's light, for the Earth seen from the Moon.
//! - A sharp, round edge. Sunlight bent into the umbra by the atmosphere, 1e-5 to 1e-4, is left out.
//!
//! # References
//! Danjon (1951), L'Astronomie 65, 51; Espenak & Meeus (2009), Five Millennium Canon of Lunar Eclipses, NASA/TP-2009-214172.

use std::f64::consts::{FRAC_PI_2, PI};

use super::LimbDarkening;
use super::quadrature::{gauss_legendre, integrate};

/// The Earth that casts a shadow over its own equatorial radius (Danjon 1951).
const EARTH_SHADOW: f64 = 1.01;

/// Points between two corners of the integrand.
const POINTS: usize = 32;

/// Share of the Sun's light that the Earth with its atmosphere leaves, with their centres `apart_rad` apart; `earth_sine`
/// is the sine of the Earth's angular radius, its own radius over its distance.
pub fn share_left_by_earth(law: LimbDarkening, sun_rad: f64, earth_sine: f64, apart_rad: f64) -> f64 {
    share_left(law, sun_rad, (EARTH_SHADOW * earth_sine).min(1.0).asin(), apart_rad)
}

/// Share of the light of a disc of radius `behind_rad` that a disc of radius `front_rad` in front of it leaves, with their
/// centres `apart_rad` apart.
pub fn share_left(law: LimbDarkening, behind_rad: f64, front_rad: f64, apart_rad: f64) -> f64 {
    let (radius, distance) = (front_rad / behind_rad, apart_rad / behind_rad);
    if distance >= 1.0 + radius {
        return 1.0;
    }
    if radius >= 1.0 + distance {
        return 0.0;
    }
    let rule = gauss_legendre(POINTS);
    let mut corners = [0.0, (radius - distance).abs().min(1.0), (radius + distance).min(1.0), 1.0].map(f64::asin);
    corners.sort_by(f64::total_cmp);
    let hidden_angle_rad = |rho: f64| {
        if rho + distance <= radius {
            return PI;
        }
        ((rho * rho + distance * distance - radius * radius) / (2.0 * rho * distance)).clamp(-1.0, 1.0).acos()
    };
    let (mut hidden, mut whole) = (0.0, 0.0);
    for ends in corners.windows(2) {
        // The angle begins and ends like a root, which a cosine flattens.
        let at = |t: f64| ends[0] + (ends[1] - ends[0]) * (0.5 - 0.5 * (PI * t).cos());
        let step = |t: f64| (ends[1] - ends[0]) * FRAC_PI_2 * (PI * t).sin();
        let ring = |theta_rad: f64| law.at(theta_rad.cos()) * theta_rad.sin() * theta_rad.cos();
        hidden += integrate(&rule, 0.0, 1.0, |t| ring(at(t)) * hidden_angle_rad(at(t).sin()) * step(t));
        whole += integrate(&rule, 0.0, 1.0, |t| ring(at(t)) * PI * step(t));
    }
    (1.0 - hidden / whole).clamp(0.0, 1.0)
}

/// Brightness of a Lambert sphere over that at full phase: `[sin a + (π − a) cos a]/π`.
pub fn lambert_sphere(phase_rad: f64) -> f64 {
    (phase_rad.sin() + (PI - phase_rad) * phase_rad.cos()) / PI
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAWS: [LimbDarkening; 2] = [LimbDarkening::Uniform, LimbDarkening::Power { alpha: 0.507_909 }];

    /// Area that two circles share, of radii 1 and r.
    fn lens(r: f64, d: f64) -> f64 {
        let near = (d * d + 1.0 - r * r) / (2.0 * d);
        let far = d - near;
        near.acos() - near * (1.0 - near * near).sqrt() + r * r * (far / r).acos() - far * (r * r - far * far).sqrt()
    }

    #[test]
    fn uniform_discs_overlap_in_a_lens() {
        for (r, d) in [(3.8, 3.0), (3.8, 4.5), (1.0, 0.5), (0.7, 0.9), (0.7, 1.69), (3.8, 2.81), (1.0, 1e-3)] {
            let got = share_left(LimbDarkening::Uniform, 1.0, r, d);
            let expected = 1.0 - lens(r, d) / PI;
            assert!((got - expected).abs() < 1e-9, "{r} {d}: {got} {expected}");
        }
    }

    /// A small disc before the middle: an annular eclipse leaves `(1 − r²)^(α/2 + 1)`, the ring outside.
    #[test]
    fn an_annular_eclipse_leaves_a_ring() {
        for (r, alpha) in [(0.3f64, 0.0), (0.9, 0.507_909), (0.999, 0.507_909)] {
            let got = share_left(LimbDarkening::Power { alpha }, 0.00465, 0.00465 * r, 0.0);
            let expected = (1.0 - r * r).powf(alpha / 2.0 + 1.0);
            assert!((got - expected).abs() < 1e-9, "{r}: {got} {expected}");
        }
    }

    /// Against a count of two million points of a sunflower pattern.
    #[test]
    fn a_darkened_disc_is_hidden_as_a_count_of_points_says() {
        let (alpha, radius, points) = (0.507_909, 3.8, 2_000_000);
        for distance in [3.0, 3.8, 4.4] {
            let (mut seen, mut all) = (0.0, 0.0);
            for i in 0..points {
                let square = (f64::from(i) + 0.5) / f64::from(points);
                let turn = f64::from(i) * PI * (3.0 - 5f64.sqrt());
                let (x, y) = (square.sqrt() * turn.cos(), square.sqrt() * turn.sin());
                let light = (1.0 - square).powf(alpha / 2.0);
                all += light;
                if (x - distance).hypot(y) > radius {
                    seen += light;
                }
            }
            let got = share_left(LimbDarkening::Power { alpha }, 1.0, radius, distance);
            assert!((got - seen / all).abs() < 2e-5, "{distance}: {got} {}", seen / all);
        }
    }

    #[test]
    fn contacts_are_exact_and_light_only_falls_until_the_middle() {
        for law in LAWS {
            assert_eq!(share_left(law, 1.0, 3.8, 4.8), 1.0);
            assert_eq!(share_left(law, 1.0, 3.8, 2.8), 0.0);
            let mut before = 1.0;
            for i in 0..=200 {
                let share = share_left(law, 1.0, 3.8, 4.8 - 0.01 * f64::from(i));
                assert!(share <= before + 1e-9, "{i}");
                before = share;
            }
        }
    }

    #[test]
    fn a_lambert_sphere_at_quadrature_shows_one_pi_th() {
        for (phase_rad, expected) in [(0.0, 1.0), (FRAC_PI_2, 1.0 / PI), (PI, 0.0)] {
            assert!((lambert_sphere(phase_rad) - expected).abs() < 1e-15);
        }
    }
}
