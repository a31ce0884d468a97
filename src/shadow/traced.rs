//! Shadows traced over every grid line of the terrain: the truth that others are held to.

use super::{Disc, Shadow, Site};
use crate::geometry::Direction;
use crate::horizon::{Settings, trace};
use crate::photometry::DiskLight;
use crate::terrain::Surface;

/// The believed horizon, traced anew for each site and each column of the disc.
#[derive(Debug)]
pub struct Traced<'a> {
    pub surface: &'a Surface,
    pub settings: Settings,
}

impl Shadow for Traced<'_> {
    fn light(&self, site: &Site, disc: &Disc) -> DiskLight {
        let face = &self.surface.terrain.faces[site.face];
        let at_m = site.lifted.truncate();
        let up = site.map.up(at_m).unit();
        let skyline = |x: f64| {
            let below = disc.axes.sun.unit() + disc.angular_radius_rad * x * disc.axes.x.unit();
            let Some(column) = Direction::new(below) else { return f64::NEG_INFINITY };
            let towards = site.map.map_direction(at_m, column).normalize_or(glam::DVec2::Y);
            let elevation_rad = trace::elevation_rad(face, site.lifted, towards, &self.settings);
            // Along the column the angle from the disc's centre line is all that counts.
            (elevation_rad - up.dot(column.unit()).clamp(-1.0, 1.0).asin()).tan() / disc.angular_radius_rad
        };
        disc.disk.light_above(&skyline, disc.facet)
    }
}
