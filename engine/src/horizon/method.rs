//! Which search makes the horizons of a tile.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::exact::Exact;
use super::gpu::OnDevice;
use super::sweep::grid::Major;
use super::sweep::{Receivers, Sweep};
use super::{Error, Settings};
use crate::terrain::Face;

/// How the skyline of each node is looked for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Method {
    /// The fast one, with errors at few samples ([`super::sweep`]).
    #[default]
    Sweep,
    /// Right to the rounding of `f32` ([`super::exact`]).
    Exact,
    /// As right, on a graphics device ([`super::gpu`]).
    Gpu,
}

impl Method {
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// A search prepared for the azimuths along one axis.
#[derive(Debug)]
pub enum Search<'a> {
    Sweep(Box<Sweep<'a>>),
    Exact(Box<Exact<'a>>),
    Gpu(Box<OnDevice>),
}

impl<'a> Search<'a> {
    /// The search that the settings name; an error where it wants a device and there is none.
    pub fn new(face: &'a Face, level: usize, major: Major, settings: &Settings) -> Result<Self, Error> {
        Ok(match settings.method {
            Method::Sweep => Self::Sweep(Box::new(Sweep::new(face, level, major, settings))),
            Method::Exact => Self::Exact(Box::new(Exact::new(face, level, major, settings))),
            Method::Gpu => Self::Gpu(Box::new(OnDevice::new(face, level, major, settings)?)),
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
}
