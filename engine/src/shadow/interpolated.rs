//! Skylines of nodes as a source of shadows: interpolated, and over what they leave out.

use super::near::Near;
use super::site::{Disc, Shadow, Site};
use super::skylines::{Skylines, bilinear, line};
use crate::photometry::DiskLight;
use crate::terrain::Surface;

/// Skylines of nodes, interpolated, as a source of shadows.
#[derive(Debug)]
pub struct InterpolatedSkylines<'a> {
    pub surface: &'a Surface,
    pub skylines: Skylines,
    /// What they leave out.
    pub near: Near,
}

impl Shadow for InterpolatedSkylines<'_> {
    fn light(&self, site: &Site, disc: &Disc) -> DiskLight {
        let level = &self.surface.terrain.faces[site.face].levels[site.level];
        let at_m = site.lifted.truncate();
        let field = self.skylines.field(disc.light, site.face, site.level);
        let far = bilinear(level, field, level.grid_from_map(at_m) - level.margin as f64);
        let [elevation_rad, slope] = self.near.over(self.surface, site, disc, far);
        line(site, disc, elevation_rad, slope)
    }
}
