//! What is seen of the solar disc, and half-planes that hide it.

use glam::DVec2;

use crate::photometry::Facet;

/// What is seen of the disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiskLight {
    /// Share of the disc's light, 0 to 1.
    pub fraction: f64,
    /// Share times the centroid of what is seen, in solar radii of the tangent plane.
    pub moment: DVec2,
}

impl DiskLight {
    pub const NONE: Self = Self { fraction: 0.0, moment: DVec2::ZERO };
    pub const FULL: Self = Self { fraction: 1.0, moment: DVec2::ZERO };

    /// Irradiance of the facet over that of a plane that faces the whole Sun.
    pub fn irradiance_factor(&self, facet: Facet, angular_radius_rad: f64) -> f64 {
        (angular_radius_rad * (facet.height * self.fraction + facet.slope.dot(self.moment))).max(0.0)
    }
}

/// The part of the plane with `normal·q ≥ height`; `normal` has length 1.
#[derive(Debug, Clone, Copy)]
pub struct HalfPlane {
    pub normal: DVec2,
    pub height: f64,
}

impl HalfPlane {
    /// Where `constant + gradient·q ≥ 0`.
    pub fn new(gradient: DVec2, constant: f64) -> Self {
        let length = gradient.length().max(f64::MIN_POSITIVE);
        Self { normal: gradient / length, height: -constant / length }
    }
}
