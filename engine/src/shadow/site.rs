//! What a source of shadows is asked, and what it answers.

use std::fmt::Debug;

use glam::DVec3;

use crate::geometry::Map;
use crate::photometry::{DiskLight, Facet, SolarDisk, SunAxes};
use crate::terrain::Gnomonic;

/// A point of a level's surface.
#[derive(Debug, Clone, Copy)]
pub struct Site<'a> {
    pub map: &'a Gnomonic,
    pub face: usize,
    pub level: usize,
    pub lifted: DVec3,
}

/// A luminous disc as a facet sees it.
#[derive(Debug, Clone, Copy)]
pub struct Disc<'a> {
    /// Which of a view's lights it is.
    pub light: usize,
    pub disk: &'a SolarDisk,
    pub axes: SunAxes<Map>,
    pub angular_radius_rad: f64,
    pub facet: Facet,
}

/// A source of shadows for the lights of a view.
pub trait Shadow: Debug + Sync {
    /// The part of the disc above the skyline of a site and above its facet's own plane.
    fn light(&self, site: &Site, disc: &Disc) -> DiskLight;
}

/// A source of shadows that knows how far it may be off.
pub trait BoundedShadow: Shadow {
    /// Standard deviation of the share of a disc that is seen; `None` where nothing is known of the skyline's error.
    fn sigma(&self, site: &Site, disc: &Disc) -> Option<f64>;

    /// Whether the skyline's bound lets more than one share of a disc be seen.
    fn is_open(&self, site: &Site, disc: &Disc) -> bool;
}
