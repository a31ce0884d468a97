//! Which shadows moved between two exposures of a camera that stands still.
//!
//! ```text
//! change = lit(now) − lit(before),   lit = 1 where at least half of the Sun is seen, on average over the pixel, else 0
//! ```
//!
//! : 1 where the Sun came, −1 where it went, 0 elsewhere, and NaN where there is no ground, or no exposure before.

use crate::geometry::Direction;
use crate::render::planes::Radiometry;
use crate::render::{LIT_SHARE, View};

/// Two poses nearer to each other than this are one: rounding of ephemerides, far less than any pixel.
pub const STILL_M: f64 = 1e-3;
pub const STILL_RAD: f64 = 1e-7;

pub fn shadow_change(now: &[Radiometry], before: Option<&[Radiometry]>) -> Vec<f32> {
    let lit = |pixel: &Radiometry| {
        let fraction = pixel.sun_fraction;
        if fraction.is_nan() { f32::NAN } else { f32::from(u8::from(fraction >= LIT_SHARE)) }
    };
    match before {
        Some(before) => now.iter().zip(before).map(|(now, before)| lit(now) - lit(before)).collect(),
        None => vec![f32::NAN; now.len()],
    }
}

/// How far a camera moved and turned, in metres and radians, where that is more than standing still.
pub fn moved(from: &View, to: &View) -> Option<(f64, f64)> {
    let moved_m = from.camera_position.distance_m(to.camera_position);
    let relative = to.camera_from_body.matrix() * from.camera_from_body.matrix().transpose();
    let axis = |column: glam::DVec3, unit: glam::DVec3| {
        Direction::<crate::geometry::Camera>::new(column).zip(Direction::new(unit)).map_or(0.0, |(a, b)| a.angle_to(b))
    };
    let turned_rad = axis(relative.x_axis, glam::DVec3::X).max(axis(relative.z_axis, glam::DVec3::Z));
    (moved_m > STILL_M || turned_rad > STILL_RAD).then_some((moved_m, turned_rad))
}
