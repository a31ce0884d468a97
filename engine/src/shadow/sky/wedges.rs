//! What is seen above a skyline, as spherical harmonics: wedges between neighbouring azimuths (Snyder &
//! Nowrouzezahrai 2008).
//!
//! A wedge reaches over the azimuths 0 to `width`, from a skyline that rises evenly from `a` to `b` up to the zenith:
//!
//! ```text
//! v_j(a, b) = ∫_0^width ∫_ω(φ)^(π/2) Y_j(φ, θ) cos θ dθ dφ      ω(φ) = a + (b − a) φ/width
//! ```
//!
//! A whole sky is the sum of its wedges, each turned to its azimuth; a partial swath is closed on both sides by a wedge
//! of half the width that rises to the zenith. [`wedge`] integrates, [`Wedges`] interpolates a table of it.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3};

use super::harmonics::Harmonics;
use crate::grid::{Cell, Grid2};
use crate::photometry::quadrature::gauss_legendre;

/// Steps of the table from straight down to straight up.
const STEPS: usize = 96;

/// Nodes of the quadrature in azimuth and in elevation.
const NODES: [usize; 2] = [6, 10];

/// A wedge by quadrature.
pub fn wedge(width_rad: f64, [a_rad, b_rad]: [f64; 2]) -> Harmonics {
    let mut sum = Harmonics::ZERO;
    let [across, along] = NODES.map(gauss_legendre);
    for &(share, weight) in &across {
        let from_rad = a_rad + (b_rad - a_rad) * share;
        let (sin_azimuth, cos_azimuth) = (width_rad * share).sin_cos();
        for &(height, its_weight) in &along {
            let (sin, cos) = (from_rad + (FRAC_PI_2 - from_rad) * height).sin_cos();
            let towards = DVec3::new(cos_azimuth * cos, sin_azimuth * cos, sin);
            let area = weight * width_rad * its_weight * (FRAC_PI_2 - from_rad) * cos;
            sum = sum + Harmonics::towards(towards) * area;
        }
    }
    sum
}

/// Wedges of one width, tabulated.
#[derive(Debug)]
pub struct Wedges {
    width_rad: f64,
    table: Vec<Harmonics>,
    /// Wedges of half the width that begin, and that end, in the zenith.
    bounds: [Vec<Harmonics>; 2],
}

impl Wedges {
    pub fn new(width_rad: f64) -> Self {
        let knot_rad = |i: usize| PI * i as f64 / STEPS as f64 - FRAC_PI_2;
        let knots = (0..=STEPS).map(knot_rad);
        let row = |a: f64| (0..=STEPS).map(move |b| wedge(width_rad, [a, knot_rad(b)]));
        let bound = |ends: &dyn Fn(f64) -> [f64; 2]| knots.clone().map(|h| wedge(0.5 * width_rad, ends(h))).collect();
        Self {
            width_rad,
            table: knots.clone().flat_map(row).collect(),
            bounds: [bound(&|h| [FRAC_PI_2, h]), bound(&|h| [h, FRAC_PI_2])],
        }
    }

    /// What is seen all round: skylines in even steps of azimuth, the first at 0.
    pub fn all_round(&self, elevations_rad: &[f64]) -> Harmonics {
        let next = elevations_rad.iter().cycle().skip(1);
        let pairs = elevations_rad.iter().zip(next).enumerate();
        pairs.fold(Harmonics::ZERO, |sum, (i, (&a, &b))| sum + self.wedge([a, b]).turned(i as f64 * self.width_rad))
    }

    /// What is seen within a swath that begins half a width before `first_rad`.
    pub fn swath(&self, first_rad: f64, elevations_rad: &[f64]) -> Harmonics {
        let [Some(&first), Some(&last)] = [elevations_rad.first(), elevations_rad.last()] else {
            return Harmonics::ZERO;
        };
        let end_rad = first_rad + (elevations_rad.len() - 1) as f64 * self.width_rad;
        let inner = elevations_rad.windows(2).enumerate().fold(Harmonics::ZERO, |sum, (i, pair)| {
            sum + self.wedge([pair[0], pair[1]]).turned(first_rad + i as f64 * self.width_rad)
        });
        let [begin, end] = [(&self.bounds[0], first), (&self.bounds[1], last)].map(|(bounds, h)| {
            let (i, f) = knot(h);
            bounds[i] * (1.0 - f) + bounds[i + 1] * f
        });
        inner + begin.turned(first_rad - 0.5 * self.width_rad) + end.turned(end_rad)
    }

    /// Bilinear in the table: within 1e-3 of the open sky's share.
    pub fn wedge(&self, [a_rad, b_rad]: [f64; 2]) -> Harmonics {
        let [(i, f), (j, g)] = [a_rad, b_rad].map(knot);
        let table = Grid2::new(&self.table, [STEPS + 1; 2]);
        Cell::new(table.size(), [j, i], DVec2::new(g, f)).mix(|column, row| table.get(column, row))
    }
}

/// The knot before an elevation, and the share of the step to the next one.
fn knot(elevation_rad: f64) -> (usize, f64) {
    let place = ((elevation_rad + FRAC_PI_2) / PI).clamp(0.0, 1.0) * STEPS as f64;
    let knot = (place as usize).min(STEPS - 1);
    (knot, place - knot as f64)
}
