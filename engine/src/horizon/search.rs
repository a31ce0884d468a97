//! The search that a tile's settings name, prepared for the azimuths along one axis.

use glam::DVec2;

use super::axis::Major;
use super::band_limits::BandLimits;
use super::elevation_plane::ElevationPlane;
use super::error::Error;
use super::exact::Exact;
use super::gpu::OnDevice;
use super::receivers::Receivers;
use super::settings::{Method, Settings};
use super::sweep::Sweep;
use crate::gpu::Gpu;
use crate::terrain::Face;

/// A search prepared for the azimuths along one axis.
#[derive(Debug)]
pub enum Search<'a> {
    Sweep(Box<Sweep<'a>>),
    Exact(Box<Exact<'a>>),
    Gpu(Box<OnDevice<'a>>),
}

impl<'a> Search<'a> {
    /// The search that the settings name; an error where it wants a device and there is none.
    pub fn new(
        face: &'a Face,
        level: usize,
        major: Major,
        settings: &Settings,
        device: Option<&'a Gpu>,
    ) -> Result<Self, Error> {
        Ok(match settings.method {
            Method::Sweep => Self::Sweep(Box::new(Sweep::new(face, level, major, settings))),
            Method::Exact => Self::Exact(Box::new(Exact::new(face, level, major, settings))),
            Method::Gpu => {
                let device = device.ok_or(Error::NoDevice)?;
                Self::Gpu(Box::new(OnDevice::new(device, face, level, major, settings)?))
            }
        })
    }

    /// Other nodes than these of the seen part, (column, row), need no skyline: the exact search leaves them out.
    pub fn only(self, nodes: &[[usize; 2]]) -> Self {
        match self {
            Self::Exact(exact) => Self::Exact(Box::new(exact.only(nodes))),
            whole => whole,
        }
    }

    pub fn receivers(&self) -> &Receivers {
        match self {
            Self::Sweep(sweep) => &sweep.receivers,
            Self::Exact(exact) => &exact.receivers,
            Self::Gpu(device) => &device.receivers,
        }
    }

    /// Elevations of the skyline in a unit map direction along the search's axis, as `receivers` are laid out.
    pub fn elevations_rad(&self, direction: DVec2) -> Result<Vec<f32>, Error> {
        Ok(match self {
            Self::Sweep(sweep) => sweep.elevations_rad(direction),
            Self::Exact(exact) => exact.elevations_rad(direction),
            Self::Gpu(device) => device.elevations_rad(direction)?,
        })
    }

    /// The plane of an azimuth, moved into the band that matters.
    pub fn plane(
        &self,
        limits: Option<&BandLimits>,
        settings: &Settings,
        azimuth: usize,
    ) -> Result<ElevationPlane, Error> {
        let elevations_rad = self.elevations_rad(settings.direction(azimuth))?;
        let mut plane = ElevationPlane { azimuth, stride: self.receivers().stride, elevations_rad };
        limits.iter().for_each(|limits| limits.clamp(&mut plane));
        Ok(plane)
    }
}
