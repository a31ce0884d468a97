//! Methods that answer how much of a light's disc is seen from a point of the terrain.
//!
//! A method knows the skyline across the disc; the disc integral ([`crate::photometry::SolarDisk`]) does the
//! rest.
//!
//! ```text
//! at every sample    Traced: exact           FourierMaps, Lighting: from compressed horizons of all azimuths
//! at every node,     Baked: from the same compressed horizons        Swath: from kept planes of few azimuths
//! for a still light  Swept: from planes swept for it                 SingleAzimuth: stepped for it
//! ```

mod baked;
pub mod fan;
mod fourier;
mod lighting;
mod mipmaps;
pub mod multiscale;
pub mod single_azimuth;
pub mod sky;
pub mod skylines;
pub mod swath;
mod sweep;
mod traced;
pub mod visibility;

pub use baked::Baked;
pub use fourier::FourierMaps;
pub use lighting::{At, Lighting, LightingFactors};
pub use mipmaps::{MipmapRuns, Mipmaps};
pub use multiscale::{HeightPyramid, Multiscale};
pub use single_azimuth::{Edge, SingleAzimuth};
pub use skylines::{Fetched, HeldLight, OutsideSwath, Skylines, Towards};
pub use swath::Swath;
pub use sweep::Swept;
pub use traced::Traced;
pub use visibility::Visibility;

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

/// A source of shadows.
pub trait Shadow: Debug + Sync {
    /// The part of the disc above the skyline of a site and above its facet's own plane.
    fn light(&self, site: &Site, disc: &Disc) -> DiskLight;
}
