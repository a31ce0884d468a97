//! Shadows from Fourier-compressed horizon maps.
//!
//! Across a disc as small as the Sun's the skyline is straight: its elevation and slope at the azimuth of
//! the disc's centre.
//!
//! # References
//! Fritsch et al. (2025), horizon maps as truncated Fourier series.

use glam::DVec2;

use super::skylines::line;
use super::{Disc, Shadow, Site};
use crate::horizon::HorizonMap;
use crate::photometry::DiskLight;
use crate::terrain::Surface;

/// Horizon maps by face and level.
#[derive(Debug)]
pub struct FourierMaps<'a> {
    pub surface: &'a Surface,
    pub maps: &'a [Vec<HorizonMap>],
}

impl Shadow for FourierMaps<'_> {
    fn light(&self, site: &Site, disc: &Disc) -> DiskLight {
        let level = &self.surface.terrain.faces[site.face].levels[site.level];
        let at_m = site.lifted.truncate();
        let series = self.maps[site.face][site.level].horizon(level.grid_from_map(at_m) - level.margin as f64);
        let towards = site.map.map_direction(at_m, disc.axes.sun);
        let (elevation_rad, slope) = series.evaluate_towards(towards.normalize_or(DVec2::Y));
        line(site, disc, elevation_rad, slope)
    }
}
