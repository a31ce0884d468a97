//! The tangent plane at the Sun: horizon and facet as straight lines across the disc.
//!
//! With `s` the direction of the Sun, `u` the local up and `r` the Sun's angular radius, points of the plane
//! are counted in solar radii from the disc's centre:
//!
//! ```text
//! e_y = (u − (u·s) s) / |…|    e_x = e_y × s        (e_x towards smaller azimuths)
//! x   = d·e_x / (r d·s)        y   = d·e_y / (r d·s)  for a direction d
//! ```
//!
//! A horizon of elevation `h(A)`, azimuth `A` clockwise, meets the vertical through the Sun (elevation `a`) at
//!
//! ```text
//! y₀ = tan(h − a) / r          dy/dx = −(dh/dA) / (cos h cos(h − a))
//! ```
//!
//! A facet of normal `n` sees the point `(x, y)` under the cosine `n·s + r (x n·e_x + y n·e_y)`.
//!
//! # Assumptions
//! - The horizon is straight across the disc. A level horizon of elevation `h` bends by `½ r tan h` solar radii
//!   at the disc's edge: 6e-5 at 1.5°, 0.004 at 60°.
//! - The disc is a circle of radius `r` in the plane; its true radius there is `tan r`, 7e-6 more.
//!
//! The shader `horizon_line` in `solar_disk.wgsl` does the same without trigonometric functions.

use glam::{DVec2, DVec3};

use crate::geometry::{Direction, Frame};

/// A straight horizon `y = height + slope x`, in solar radii; the sky is above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HorizonLine {
    pub height: f64,
    pub slope: f64,
}

/// A facet as seen from the disc: the cosine of incidence of the point `q` is `r (height + slope·q)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet {
    pub height: f64,
    pub slope: DVec2,
}

/// The axes of the tangent plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunAxes<F> {
    pub sun: Direction<F>,
    pub x: Direction<F>,
    pub y: Direction<F>,
}

/// Beyond this angle from the Sun the horizon counts as far off the disc.
const FARTHEST_COSINE: f64 = 0.1;

/// Sine of the zenith distance below which the Sun stands in the zenith; rounding leaves 1e-16.
const ZENITH: f64 = 1e-9;

impl HorizonLine {
    /// No horizon at all: the sky all round.
    pub const NONE: Self = Self { height: -1e6, slope: 0.0 };

    /// The line of a horizon with elevation `elevation_rad` and slope `slope` (`dh/dA`, `A` clockwise) at the
    /// Sun's azimuth.
    pub fn new(elevation_rad: f64, slope: f64, sun_elevation_rad: f64, angular_radius_rad: f64) -> Self {
        let above_sun_rad = elevation_rad - sun_elevation_rad;
        let cosine = above_sun_rad.cos().max(FARTHEST_COSINE);
        Self {
            height: above_sun_rad.sin() / (cosine * angular_radius_rad),
            slope: -slope / (cosine * elevation_rad.cos().max(f64::EPSILON)),
        }
    }
}

impl<F: Frame> SunAxes<F> {
    /// With the Sun in the zenith any axes do, and some are given.
    pub fn new(sun: Direction<F>, up: Direction<F>) -> Self {
        let s = sun.unit();
        let vertical = up.unit() - up.unit().dot(s) * s;
        let y = axis(if vertical.length() > ZENITH { vertical } else { s.any_orthonormal_vector() });
        Self { sun, x: axis(y.unit().cross(s)), y }
    }

    pub fn facet(&self, normal: Direction<F>, angular_radius_rad: f64) -> Facet {
        let n = normal.unit();
        Facet {
            height: n.dot(self.sun.unit()) / angular_radius_rad,
            slope: DVec2::new(n.dot(self.x.unit()), n.dot(self.y.unit())),
        }
    }
}

fn axis<F: Frame>(vector: DVec3) -> Direction<F> {
    Direction::new(vector).expect("an axis has a length")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Local;

    const RADIUS_RAD: f64 = 0.00465;

    fn direction(azimuth_rad: f64, elevation_rad: f64) -> DVec3 {
        let (sin, cos) = elevation_rad.sin_cos();
        DVec3::new(cos * azimuth_rad.sin(), cos * azimuth_rad.cos(), sin)
    }

    fn local(vector: DVec3) -> Direction<Local> {
        Direction::new(vector).unwrap()
    }

    /// The horizon h = h₀ + k (A − A_s), projected point by point with the formulas of the module's document.
    #[test]
    fn the_line_is_the_tangent_of_the_projected_horizon() {
        for sun_elevation_deg in [-1.0f64, 0.0, 1.5, 20.0, 60.0, 85.0, 89.5] {
            for above_radii in [-2.0, -0.5, 0.0, 0.9] {
                for slope in [-3.0, -0.2, 0.0, 0.5] {
                    let (azimuth_rad, sun_rad) = (2.1, sun_elevation_deg.to_radians());
                    let elevation_rad = sun_rad + above_radii * RADIUS_RAD;
                    let axes = SunAxes::new(local(direction(azimuth_rad, sun_rad)), local(DVec3::Z));
                    let point = |turn_rad: f64| {
                        let d = direction(azimuth_rad + turn_rad, elevation_rad + slope * turn_rad);
                        let forward = RADIUS_RAD * d.dot(axes.sun.unit());
                        DVec2::new(d.dot(axes.x.unit()), d.dot(axes.y.unit())) / forward
                    };
                    let line = HorizonLine::new(elevation_rad, slope, sun_rad, RADIUS_RAD);
                    let chord = point(1e-6) - point(-1e-6);
                    assert!((point(0.0) - DVec2::new(0.0, line.height)).length() < 1e-9);
                    assert!((chord.y / chord.x - line.slope).abs() < 1e-4 * (1.0 + line.slope.abs()));
                }
            }
        }
    }

    /// From the spherical triangle, half the disc is asin(sin r / cos a) wide in azimuth.
    #[test]
    fn the_disc_spans_more_azimuth_the_higher_the_sun() {
        let radius_rad = 0.26645f64.to_radians();
        for (elevation_deg, half_width_deg) in [(60.0f64, 0.533), (85.0, 3.059), (89.5, 32.2)] {
            let sun_rad = elevation_deg.to_radians();
            let axes = SunAxes::new(local(direction(0.0, sun_rad)), local(DVec3::Z));
            let widest = (0..1000)
                .map(|i| {
                    // Minus x points to larger azimuths; the widest point is a little above the Sun.
                    let (sin, cos) = (f64::from(i) * 1e-3).sin_cos();
                    let q = axes.sun.unit() + radius_rad.tan() * (sin * axes.y.unit() - cos * axes.x.unit());
                    q.x.atan2(q.y).to_degrees()
                })
                .fold(0.0, f64::max);
            assert!((widest - half_width_deg).abs() < 0.01 * half_width_deg, "{elevation_deg}: {widest}");
        }
    }

    #[test]
    fn a_horizon_behind_the_zenith_or_below_the_feet_leaves_the_sun_alone() {
        let line = |horizon_deg: f64, sun_deg: f64| {
            HorizonLine::new(horizon_deg.to_radians(), 0.0, sun_deg.to_radians(), RADIUS_RAD).height
        };
        assert!(line(-40.0, 60.0) < -100.0);
        assert!(line(-89.0, 89.0) < -1.0);
        assert!(line(0.0, 90.0) < -100.0);
        assert!(line(60.0, -40.0) > 100.0);
    }

    #[test]
    fn a_facet_sees_a_point_of_the_disc_under_the_cosine_of_its_direction() {
        let axes = SunAxes::new(local(direction(1.0, 0.4)), local(DVec3::Z));
        let normal = local(DVec3::new(0.3, -0.5, 0.8));
        let facet = axes.facet(normal, RADIUS_RAD);
        let q = DVec2::new(0.6, -0.7);
        let towards = axes.sun.unit() + RADIUS_RAD * (q.x * axes.x.unit() + q.y * axes.y.unit());
        let expected = normal.unit().dot(towards);
        assert!((RADIUS_RAD * (facet.height + facet.slope.dot(q)) - expected).abs() < 1e-15);
    }

    #[test]
    fn the_axes_are_orthonormal_with_the_sun_in_the_zenith_too() {
        for off_rad in [0.0, 1e-17, 1e-12, 1e-3] {
            let sun = local(DVec3::new(0.36, 0.48, 0.8) + DVec3::X * off_rad);
            let axes = SunAxes::new(sun, local(DVec3::new(0.36, 0.48, 0.8)));
            let [s, x, y] = [axes.sun, axes.x, axes.y].map(Direction::unit);
            for product in [s.dot(x), s.dot(y), x.dot(y), y.cross(s).dot(x) - 1.0] {
                assert!(product.abs() < 1e-6, "{off_rad}: {product}");
            }
        }
    }
}
