//! A light on a raster, and where its disc stands as seen from a point of the ground.
//!
//! A light is *quantised* on a raster of 2⁻¹⁷ in each component of its direction and of 0.07 % in distance and radius:
//! exposures a few seconds apart share what is found for it, and each is the same whether it is rendered alone or after
//! others.
//!
//! # Assumptions
//! The raster moves a light by up to 7e-6 rad (0.0004°, 1/700 of the Sun's radius) for its azimuth alone, 0.03 % of
//! the Earth's distance by as much again; the elevation above the skyline is that of the light itself.

use glam::{DVec2, DVec3};

use crate::geometry::{BodyFixed, Direction, Map, Position};
use crate::terrain::Gnomonic;

/// A light on the raster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuantizedLight {
    /// Body-fixed, from the body's centre.
    pub position: Position<BodyFixed>,
    /// Of its disc.
    pub angular_radius_rad: f64,
}

/// Steps of the raster in a component of a direction.
const STEPS: f64 = 131_072.0;

/// Steps of the raster in an octave of distances and of radii.
const STEPS_OF_SIZE: f64 = 1024.0;

/// A disc is looked at no further than this to each side: one nearer than 1.3° to the zenith spans wider azimuths.
pub const WIDEST_RAD: f64 = 0.2;

/// Where a light stands as seen from a point of the ground.
#[derive(Debug, Clone, Copy)]
pub struct Pointing {
    /// Unit map direction.
    pub towards: DVec2,
    pub elevation_rad: f64,
    /// From the middle of its disc to the edges, in map azimuth: `asin(sin r / cos a)` for a radius `r` at elevation `a`.
    pub half_width_rad: f64,
}

/// Half of what a disc spans in map azimuth, at a map point; `towards` is the map direction of its centre.
pub fn half_width_rad(map: &Gnomonic, at_m: DVec2, centre: Direction<Map>, towards: DVec2, radius_rad: f64) -> f64 {
    let level = centre.unit().reject_from_normalized(map.up(at_m).unit()).length();
    ((radius_rad.sin() / level).min(1.0).asin() * map.azimuth_ratio(at_m, towards)).min(WIDEST_RAD)
}

impl QuantizedLight {
    pub fn new(position: Position<BodyFixed>, angular_radius_rad: f64) -> Self {
        let vector_m = position.vector_m();
        let direction = (vector_m / vector_m.length() * STEPS).round().normalize();
        let rounded = |size: f64| ((size.log2() * STEPS_OF_SIZE).round() / STEPS_OF_SIZE).exp2();
        Self {
            position: Position::from_m(rounded(vector_m.length()) * direction),
            angular_radius_rad: rounded(angular_radius_rad),
        }
    }

    /// The light from a point of the ground.
    pub fn pointing(&self, map: &Gnomonic, lifted: DVec3) -> Pointing {
        let at_m = lifted.truncate();
        let (towards, direction) = self.from(map, lifted);
        let up = map.up(at_m).unit();
        let level = direction.unit().reject_from_normalized(up).length();
        let elevation_rad = up.dot(direction.unit()).atan2(level);
        let half_width_rad = half_width_rad(map, at_m, direction, towards, self.angular_radius_rad);
        Pointing { towards, elevation_rad, half_width_rad }
    }

    /// The unit map direction towards the light from a point of the ground, and the direction itself.
    pub fn from(&self, map: &Gnomonic, lifted: DVec3) -> (DVec2, Direction<Map>) {
        let towards_m = map.map_vector(self.position) - map.unlift(lifted);
        let towards = Direction::new(towards_m).unwrap_or_else(|| map.up(lifted.truncate()));
        (map.map_direction(lifted.truncate(), towards).normalize_or(DVec2::Y), towards)
    }
}
