//! One azimuth as a sweep sees it.

use glam::DVec2;

use crate::horizon::axis::Major;

/// A direction by its steps along the major axis.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    /// Whether a step goes up (+1) or down (−1) the major axis.
    pub sign: isize,
    /// Change of the minor coordinate per step, in −1 … 1.
    pub minor: f64,
    /// Unit (major, minor) direction.
    pub direction: DVec2,
    /// Length of a step over the posting: `√(1 + minor²)`.
    pub length: f64,
    /// The search distance, in major steps of the finest grid.
    pub search_steps: f64,
}

impl Ray {
    pub fn new(direction: DVec2, major: Major, posting_m: f64, search_m: f64) -> Self {
        let direction = major.split(direction);
        let minor = direction.y / direction.x.abs();
        let length = 1.0 / direction.x.abs();
        let sign = if direction.x > 0.0 { 1 } else { -1 };
        Self { sign, minor, direction, length, search_steps: search_m / (length * posting_m) }
    }
}
