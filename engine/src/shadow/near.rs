//! The terrain around a sample, whose skyline no node's stands for.
//!
//! What stands a few postings away swings through many degrees from one node to the next, so that interpolated skylines err there
//! most. Nodes then have the skylines of what stands farther away ([`Settings::near`]), and every sample looks at the rest:
//!
//! ```text
//! h(A) = max( near(A): traced from the sample itself, far(A): interpolated between nodes )
//! ```
//!
//! at three azimuths across the disc, which the line of [`super::fan::line_of_three`] takes the place of. The terrain is split at a
//! number of postings along the axis of the map that a direction is nearer to.
//!
//! `near.wgsl` does the same in `f32`; `tests/conformance/near.rs` holds the two together.
//!
//! # Assumptions
//! Terrain that is nearer to a sample than the split and farther from one of its nodes counts twice, terrain that is farther from
//! the sample and nearer to a node is missing in that node's share: an error that falls with the square of postings.

use glam::DVec2;

use super::fan::{THREE, line_of_three};
use super::light::half_width_rad;
use super::site::{Disc, Site};
use crate::horizon::Settings;
use crate::horizon::trace::Tracer;
use crate::terrain::Surface;

/// Skylines this far below the middle of a disc, in its radii and more, are not told from lower ones: a step down within the disc
/// would tilt the line that takes its place.
const LOWEST_RADII: f64 = 2.0;
/// So that a Sun without a size stands above it.
const LOWEST_RAD: f64 = 1e-3;

/// How much of the terrain is looked at from a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Near {
    /// Postings of the sample's level; 0: nothing.
    pub postings: usize,
}

impl Near {
    /// Nodes have whole skylines.
    pub const NONE: Self = Self { postings: 0 };

    /// Elevation and slope by map azimuth of the skyline across a disc, from those of what stands farther away.
    pub fn over(self, surface: &Surface, site: &Site, disc: &Disc, far: [f64; 2]) -> [f64; 2] {
        let at_m = site.lifted.truncate();
        let Some(towards) = site.map.map_direction(at_m, disc.axes.sun).try_normalize() else { return far };
        if self == Self::NONE {
            return far;
        }
        let settings = Settings { near: self.postings, ..Settings::default() };
        let tracer = Tracer::without_finer(&surface.terrain.faces[site.face], site.level, &settings).only_near();
        let sun_rad = site.map.up(at_m).unit().dot(disc.axes.sun.unit()).clamp(-1.0, 1.0).asin();
        let lowest_rad = sun_rad - LOWEST_RADII * disc.angular_radius_rad - LOWEST_RAD;
        let half_width_rad = half_width_rad(site.map, at_m, disc.axes.sun, towards, disc.angular_radius_rad);
        let elevations_rad = THREE.map(|place| {
            let turn_rad = place * half_width_rad;
            let direction = DVec2::from_angle(-turn_rad).rotate(towards);
            let known_rad = lowest_rad.max(far[0] + far[1] * turn_rad);
            tracer.skyline(site.lifted, direction).elevation_rad.max(known_rad)
        });
        line_of_three(elevations_rad, half_width_rad).map(f64::from)
    }
}
