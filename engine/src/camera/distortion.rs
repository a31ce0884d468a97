//! Lens distortion after Brown and Conrady, with the coefficients of OpenCV.
//!
//! On the plane `z = 1`, from the undistorted point `(x, y)`, `r² = x² + y²`:
//!
//! ```text
//! x' = x R + 2 p1 x y + p2 (r² + 2 x²)        R = (1 + k1 r² + k2 r⁴ + k3 r⁶) / (1 + k4 r² + k5 r⁴ + k6 r⁶)
//! y' = y R + p1 (r² + 2 y²) + 2 p2 x y
//! ```
//!
//! `r R` grows only up to some radius; beyond it points would fold back into the image, so nothing is seen there.
//!
//! # References
//! Brown (1966), Photogrammetric Engineering 32, 444; OpenCV, module calib3d.

use glam::{DMat2, DVec2};

/// Coefficients in OpenCV's order of meaning; zeros distort nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Distortion {
    /// `k1` to `k6`; the last three are the denominator's.
    pub radial: [f64; 6],
    /// `p1`, `p2`.
    pub tangential: [f64; 2],
}

/// Radii are searched up to this one: 89° from the boresight.
const FARTHEST: f64 = 57.0;
/// Steps of that search, and the halvings that sharpen what it finds.
const SEARCH_STEP: f64 = 1e-3;
const HALVINGS: usize = 60;
/// Rounds of Newton's iteration; it doubles the digits with each.
const ROUNDS: usize = 20;

impl Distortion {
    /// `R` and its derivative with `r²`.
    fn factor(&self, square: f64) -> (f64, f64) {
        let [k1, k2, k3, k4, k5, k6] = self.radial;
        let polynomial = |a: f64, b: f64, c: f64| 1.0 + square * (a + square * (b + square * c));
        let slope = |a: f64, b: f64, c: f64| a + square * (2.0 * b + square * 3.0 * c);
        let (above, below) = (polynomial(k1, k2, k3), polynomial(k4, k5, k6));
        (above / below, (slope(k1, k2, k3) * below - above * slope(k4, k5, k6)) / (below * below))
    }

    /// Derivative of `r R` with `r`.
    fn growth(&self, radius: f64) -> f64 {
        let square = radius * radius;
        let (factor, slope) = self.factor(square);
        factor + 2.0 * square * slope
    }

    /// The radius on the plane `z = 1` up to which `r R` grows.
    pub fn largest_radius(&self) -> f64 {
        let grows = |radius: f64| self.growth(radius) > 0.0;
        let steps = (FARTHEST / SEARCH_STEP) as u32;
        let Some(first) = (1..=steps).map(|i| f64::from(i) * SEARCH_STEP).find(|&radius| !grows(radius)) else {
            return FARTHEST;
        };
        let (mut inside, mut outside) = (first - SEARCH_STEP, first);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if grows(middle) { inside = middle } else { outside = middle }
        }
        inside
    }

    pub fn distort(&self, p: DVec2) -> DVec2 {
        let square = p.length_squared();
        let (factor, _) = self.factor(square);
        let [p1, p2] = self.tangential;
        let across = 2.0 * p.x * p.y;
        p * factor
            + DVec2::new(p1 * across + p2 * (square + 2.0 * p.x * p.x), p1 * (square + 2.0 * p.y * p.y) + p2 * across)
    }

    /// Columns are the derivatives of [`Distortion::distort`] with x and y.
    fn jacobian(&self, p: DVec2) -> DMat2 {
        let (factor, slope) = self.factor(p.length_squared());
        let [p1, p2] = self.tangential;
        let mixed = 2.0 * (slope * p.x * p.y + p1 * p.x + p2 * p.y);
        DMat2::from_cols(
            DVec2::new(factor + 2.0 * slope * p.x * p.x + 2.0 * p1 * p.y + 6.0 * p2 * p.x, mixed),
            DVec2::new(mixed, factor + 2.0 * slope * p.y * p.y + 6.0 * p1 * p.y + 2.0 * p2 * p.x),
        )
    }

    /// The point within `largest_radius` that [`Distortion::distort`] takes to `distorted`, if there is one.
    pub fn undistort(&self, distorted: DVec2, largest_radius: f64) -> Option<DVec2> {
        let mut p = distorted * self.radial_start(distorted.length(), largest_radius);
        for _ in 0..ROUNDS {
            let miss = self.distort(p) - distorted;
            if miss.length() <= 4.0 * f64::EPSILON * (1.0 + distorted.length()) {
                break;
            }
            p -= self.jacobian(p).inverse() * miss;
        }
        let arrived = (self.distort(p) - distorted).length() <= 1e-12 * (1.0 + distorted.length());
        (arrived && p.length() <= largest_radius).then_some(p)
    }

    /// What to scale a distorted point of some radius with so that it is right but for the tangential terms.
    fn radial_start(&self, distorted_radius: f64, largest_radius: f64) -> f64 {
        let (mut inside, mut outside) = (0.0, largest_radius);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if middle * self.factor(middle * middle).0 < distorted_radius { inside = middle } else { outside = middle }
        }
        if distorted_radius > 0.0 { inside / distorted_radius } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_ends_where_the_cubic_turns() {
        // r − r³/3 turns at r = 1.
        let barrel = Distortion { radial: [-1.0 / 3.0, 0.0, 0.0, 0.0, 0.0, 0.0], ..Default::default() };
        assert!((barrel.largest_radius() - 1.0).abs() < 1e-12);
        assert_eq!(Distortion::default().largest_radius(), FARTHEST);
        assert_eq!(barrel.undistort(DVec2::new(0.7, 0.0), 1.0), None, "r − r³/3 never exceeds 2/3");
    }

    /// Against central differences, whose own error is 1e-9 here.
    #[test]
    fn the_jacobian_is_the_derivative() {
        let lens = Distortion { radial: [-0.5, 0.3, -0.1, 0.02, -0.01, 0.005], tangential: [3e-3, -2e-3] };
        let p = DVec2::new(0.31, -0.22);
        for (axis, column) in [(DVec2::X, lens.jacobian(p).x_axis), (DVec2::Y, lens.jacobian(p).y_axis)] {
            let difference = (lens.distort(p + 1e-6 * axis) - lens.distort(p - 1e-6 * axis)) / 2e-6;
            assert!((difference - column).length() < 1e-8, "{difference} {column}");
        }
    }
}
