//! The believed integrals over the disc: slow, general, free of cases.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;

use super::super::quadrature::{gauss_legendre, integrate};
use super::light::{DiskLight, HalfPlane};

/// A disc and the rule that sums it.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadrature {
    pub alpha: f64,
    /// `∫ cos^(α+2)` over half a turn: the light of a disc, summed by lines.
    pub line_norm: f64,
    /// `∫ cos^(α+1)` over half a turn: the light of a chord.
    pub chord_norm: f64,
    rule: Vec<(f64, f64)>,
}

/// Points of the Gauss–Legendre rule between two corners. The integrands end like `δ^(α+1)`.
const POINTS: usize = 48;

impl Quadrature {
    pub fn new(alpha: f64) -> Self {
        let rule = gauss_legendre(POINTS);
        let [line_norm, chord_norm] =
            [alpha + 2.0, alpha + 1.0].map(|power| cosine_power(&rule, power, -FRAC_PI_2, FRAC_PI_2));
        Self { alpha, line_norm, chord_norm, rule }
    }

    pub fn visible_above(&self, height: f64) -> f64 {
        let from_rad = height.clamp(-1.0, 1.0).asin();
        cosine_power(&self.rule, self.alpha + 2.0, from_rad, FRAC_PI_2) / self.line_norm
    }

    pub fn moment_above(&self, height: f64) -> f64 {
        let inside = (1.0 - height * height).max(0.0);
        inside.powf((self.alpha + 3.0) / 2.0) / ((self.alpha + 3.0) * self.line_norm)
    }

    /// Share of a chord's light above `height`, with the chord from −1 to 1.
    pub fn chord_above(&self, height: f64) -> f64 {
        let from_rad = height.clamp(-1.0, 1.0).asin();
        cosine_power(&self.rule, self.alpha + 1.0, from_rad, FRAC_PI_2) / self.chord_norm
    }

    pub(super) fn light_above_line(&self, plane: HalfPlane) -> DiskLight {
        DiskLight { fraction: self.visible_above(plane.height), moment: self.moment_above(plane.height) * plane.normal }
    }

    /// Sums columns of constant `x = sin θ` between the corners of the region, where the integrand is smooth.
    pub(super) fn light_by_columns(&self, planes: [HalfPlane; 2]) -> DiskLight {
        let mut corners_rad = vec![-FRAC_PI_2, FRAC_PI_2];
        corners_rad.extend(planes.iter().flat_map(HalfPlane::circle_crossings).map(f64::asin));
        corners_rad.extend(planes[0].crossing(&planes[1]).map(f64::asin));
        corners_rad.sort_by(f64::total_cmp);

        let (mut fraction, mut moment) = (0.0, DVec2::ZERO);
        for ends in corners_rad.windows(2) {
            for &(node, weight) in &self.rule {
                let theta_rad = ends[0] + (ends[1] - ends[0]) * node;
                let (x, chord) = theta_rad.sin_cos();
                let weight = weight * (ends[1] - ends[0]) * chord.powf(self.alpha + 2.0);
                let (share, offset) = self.column(planes, x, chord);
                fraction += weight * share;
                moment += weight * DVec2::new(x * share, chord * offset);
            }
        }
        let norm = (self.alpha + 2.0) / (2.0 * PI);
        DiskLight { fraction: norm * fraction, moment: norm * moment }
    }

    /// `∫ cos^(α+1) φ dφ` of a column's visible part, and the same with `sin φ` as a factor, for `y = chord sin φ`.
    fn column(&self, planes: [HalfPlane; 2], x: f64, chord: f64) -> (f64, f64) {
        let Some([low, high]) = HalfPlane::column(planes, x, chord) else { return (0.0, 0.0) };
        let share = cosine_power(&self.rule, self.alpha + 1.0, low.asin(), high.asin());
        let end = |t: f64| (1.0 - t * t).max(0.0).powf(self.alpha / 2.0 + 1.0);
        (share, (end(low) - end(high)) / (self.alpha + 2.0))
    }
}

/// `∫ cos^power`.
fn cosine_power(rule: &[(f64, f64)], power: f64, from_rad: f64, to_rad: f64) -> f64 {
    integrate(rule, from_rad, to_rad, |angle_rad| angle_rad.cos().max(0.0).powf(power))
}

impl HalfPlane {
    /// From where to where all planes leave the column at `x` to be seen, of −1 to 1; `None`: nowhere.
    pub(super) fn column(planes: [Self; 2], x: f64, chord: f64) -> Option<[f64; 2]> {
        let (mut low, mut high) = (-1.0f64, 1.0f64);
        for plane in planes {
            let needed = plane.height - plane.normal.x * x;
            let end = needed / (plane.normal.y * chord);
            match plane.normal.y {
                y if y > 0.0 => low = low.max(end),
                y if y < 0.0 => high = high.min(end),
                _ if needed > 0.0 => return None,
                _ => {}
            }
        }
        (low < high).then_some([low, high])
    }

    /// The abscissas where the edge meets the unit circle.
    fn circle_crossings(&self) -> [f64; 2] {
        let half = (1.0 - self.height * self.height).max(0.0).sqrt();
        [-1.0, 1.0].map(|side| (self.height * self.normal.x + side * half * self.normal.y).clamp(-1.0, 1.0))
    }

    /// The abscissa where two edges meet, if that is inside the circle.
    fn crossing(&self, other: &Self) -> Option<f64> {
        let q = (other.height * self.normal - self.height * other.normal).perp() / self.normal.perp_dot(other.normal);
        (q.length_squared() < 1.0).then_some(q.x)
    }
}
