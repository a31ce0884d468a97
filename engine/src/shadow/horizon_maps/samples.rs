//! Horizon maps evaluated at every sample.
//!
//! Across a disc as small as the Sun's the skyline is straight: its elevation and slope at the azimuth of
//! the disc's centre.

use glam::DVec2;

use crate::horizon::HorizonMap;
use crate::photometry::DiskLight;
use crate::shadow::site::{BoundedShadow, Disc, Shadow, Site};
use crate::shadow::skylines::line;
use crate::terrain::Surface;

/// Horizon maps by face and level as a source of shadows.
#[derive(Debug)]
pub struct MapShadow<'a> {
    pub surface: &'a Surface,
    pub maps: &'a [Vec<HorizonMap>],
}

impl MapShadow<'_> {
    /// The light above a skyline that is lower by an angle, and higher by it.
    fn between(&self, site: &Site, disc: &Disc, off_rad: f64) -> [DiskLight; 2] {
        let [elevation_rad, slope] = self.skyline(site, disc);
        [-off_rad, off_rad].map(|off_rad| line(site, disc, elevation_rad + off_rad, slope))
    }

    /// Elevation and slope at the azimuth of the disc's centre.
    fn skyline(&self, site: &Site, disc: &Disc) -> [f64; 2] {
        let (map, grid) = self.at(site);
        let towards = site.map.map_direction(site.lifted.truncate(), disc.axes.sun);
        map.horizon(grid).evaluate_towards(towards.normalize_or(DVec2::Y)).into()
    }

    /// The map that a site lies on, and where on it.
    fn at(&self, site: &Site) -> (&HorizonMap, DVec2) {
        let level = &self.surface.terrain.faces[site.face].levels[site.level];
        let grid = level.grid_from_map(site.lifted.truncate()) - level.margin as f64;
        (&self.maps[site.face][site.level], grid)
    }
}

impl Shadow for MapShadow<'_> {
    fn light(&self, site: &Site, disc: &Disc) -> DiskLight {
        let [elevation_rad, slope] = self.skyline(site, disc);
        line(site, disc, elevation_rad, slope)
    }
}

impl BoundedShadow for MapShadow<'_> {
    fn sigma(&self, site: &Site, disc: &Disc) -> Option<f64> {
        let (map, grid) = self.at(site);
        let sigma_rad = map.sigma_rad(grid)?;
        let [below, above] = self.between(site, disc, sigma_rad).map(|light| light.fraction);
        Some((above - below).abs() / 2.0)
    }

    fn is_open(&self, site: &Site, disc: &Disc) -> bool {
        let (map, grid) = self.at(site);
        map.bound_rad(grid).is_none_or(|bound_rad| {
            let [below, above] = self.between(site, disc, bound_rad);
            below != above
        })
    }
}
