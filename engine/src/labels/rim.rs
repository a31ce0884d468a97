//! A crater's rim in space: an ellipse in the plane that fits the ground around it.
//!
//! With `e₁`, `e₂` the horizontal directions of the crater's diameters at its centre, `u` up, and the ground along the rim at
//! `C + x e₁ + y e₂ + z u`, the plane `z = m + gx x + gy y` fits the points by least squares, and the rim is
//!
//! ```text
//! P(t) = (C + m u) + cos t · a (e₁ + gx u) + sin t · b (e₂ + gy u)
//! ```
//!
//! : seen from above it is the list's ellipse, whatever the slope. The semi-axes `a`, `b` are chords of the curved ground.
//!
//! # Assumptions
//! The rim lies in a plane. How far the ground departs from it is [`Rim::misfit_m`].

use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

use super::Crater;
use crate::geometry::{BodyFixed, Direction, Geodetic, Position};
use crate::terrain::{Hit, Surface};

/// Points of the rim that are looked at.
pub const RIM_POINTS: usize = 36;

/// Points of the floor that are looked at: the centre, and a ring at half the radius.
pub const FLOOR_POINTS: usize = 13;

/// The rim of a crater, and the ground that it was fitted to.
#[derive(Debug, Clone, PartialEq)]
pub struct Rim {
    pub centre: Position<BodyFixed>,
    /// Conjugate semi-axes: `centre + cos t · axes[0] + sin t · axes[1]`.
    pub axes_m: [DVec3; 2],
    pub normal: Direction<BodyFixed>,
    /// RMS distance of the ground from the plane, vertically.
    pub misfit_m: f64,
    /// The ground at the rim, then at the floor.
    pub ground: Vec<Hit>,
}

impl Rim {
    pub fn of(crater: &Crater, surface: &Surface) -> Self {
        let body = &surface.terrain.body;
        let local_from_body = body.local_from_body(crater.centre).matrix();
        let [east, north, up] = [0, 1, 2].map(|row| local_from_body.row(row));
        let (sin, cos) = crater.azimuth_rad.sin_cos();
        let (along, across) = (sin * east + cos * north, cos * east - sin * north);
        let place = body.position_from_geodetic(Geodetic { height_m: 0.0, ..crater.centre });
        let origin_m = surface.ground_below(place).position.vector_m();
        let radius_m = origin_m.length();
        let semi_m = crater.diameters_m.map(|diameter_m| diameter_m / 2.0);

        // The ground at a share of the way to the rim, over an arc of the body.
        let ground = |share: f64, turn_rad: f64| {
            let offset_m = share * (semi_m[0] * turn_rad.cos() * along + semi_m[1] * turn_rad.sin() * across);
            let arc_rad = offset_m.length() / radius_m;
            let towards = offset_m.normalize_or_zero();
            let above_m = radius_m * (arc_rad.sin() * towards - (1.0 - arc_rad.cos()) * up);
            surface.ground_below(Position::from_m(origin_m + above_m))
        };
        let turn_rad = |index: usize, count: usize| TAU * index as f64 / count as f64;
        let mut hits: Vec<Hit> = (0..RIM_POINTS).map(|k| ground(1.0, turn_rad(k, RIM_POINTS))).collect();
        let (mean_m, slope) = plane(hits.iter().map(|hit| {
            let offset_m = hit.position.vector_m() - origin_m;
            DVec3::new(offset_m.dot(along), offset_m.dot(across), offset_m.dot(up))
        }));
        let deviation_m = |hit: &Hit| {
            let offset_m = hit.position.vector_m() - origin_m;
            offset_m.dot(up) - mean_m - slope[0] * offset_m.dot(along) - slope[1] * offset_m.dot(across)
        };
        let misfit_m = (hits.iter().map(|hit| deviation_m(hit).powi(2)).sum::<f64>() / RIM_POINTS as f64).sqrt();
        hits.push(ground(0.0, 0.0));
        hits.extend((1..FLOOR_POINTS).map(|k| ground(0.5, turn_rad(k, FLOOR_POINTS - 1))));

        let chord_m = semi_m.map(|semi_m| (radius_m + mean_m) * (semi_m / radius_m).sin());
        let axes_m = [chord_m[0] * (along + slope[0] * up), chord_m[1] * (across + slope[1] * up)];
        let normal = Direction::new(up - slope[0] * along - slope[1] * across).expect("no plane is vertical");
        Self { centre: Position::from_m(origin_m + mean_m * up), axes_m, normal, misfit_m, ground: hits }
    }

    /// The point of the fitted ellipse at an angle.
    pub fn at(&self, turn_rad: f64) -> Position<BodyFixed> {
        let (sin, cos) = turn_rad.sin_cos();
        Position::from_m(self.centre.vector_m() + cos * self.axes_m[0] + sin * self.axes_m[1])
    }
}

/// Height and slopes of the plane `z = m + gx x + gy y` through points, by least squares.
fn plane(points: impl Iterator<Item = DVec3>) -> (f64, [f64; 2]) {
    let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for point in points {
        let row = DVec3::new(1.0, point.x, point.y);
        normal += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
        right += row * point.z;
    }
    let solution = normal.inverse() * right;
    (solution.x, [solution.y, solution.z])
}
