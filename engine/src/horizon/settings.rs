//! What a horizon is asked for.
#![warn(missing_docs)]

use std::f64::consts::TAU;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::band::ElevationBand;
use crate::terrain::Gnomonic;

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
    /// Whether it is the one that is taken where none is named.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// How horizons are searched. All of it shapes the result and is part of a tile's key.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Number of azimuths, evenly spaced, the first at 0.
    pub azimuths: usize,
    /// Terrain further away on the map does not occlude; `None` searches to the terrain's end. Beyond
    /// the terrain's end lies the bare sphere either way.
    pub search_m: Option<f64>,
    /// Height of the observer above the ground, along the vertical.
    pub observer_height_m: f64,
    /// How the skylines are looked for.
    #[serde(default, skip_serializing_if = "Method::is_default")]
    pub method: Method,
    /// Terrain nearer than so many postings of the level, counted along the axis of the map that a direction is nearer to, does
    /// not occlude: who uses the horizons looks at it from where he stands ([`crate::shadow::near`]).
    #[serde(default, skip_serializing_if = "is_zero")]
    pub near: usize,
    /// The elevations that matter: horizons beyond them are moved to their ends before they are compressed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub band: Option<ElevationBand>,
}

fn is_zero(number: &usize) -> bool {
    *number == 0
}

impl Default for Settings {
    fn default() -> Self {
        Self { azimuths: 360, search_m: None, observer_height_m: 0.0, method: Method::default(), near: 0, band: None }
    }
}

impl Settings {
    /// Map azimuth of a sample: clockwise from map +Y towards map +X.
    pub fn azimuth_rad(&self, index: usize) -> f64 {
        TAU * index as f64 / self.azimuths as f64
    }

    /// Unit map direction of a sample.
    pub fn direction(&self, index: usize) -> DVec2 {
        direction(self.azimuth_rad(index))
    }

    /// What of an elevation at a map point matters: itself, or the end of the band that it lies beyond.
    pub fn relevant_rad(&self, map: &Gnomonic, at_m: DVec2, elevation_rad: f64) -> f64 {
        self.band.map_or(elevation_rad, |band| band.clamp(map, at_m, elevation_rad))
    }

    /// Map distance within which terrain does not occlude in a unit map direction.
    pub fn near_m(&self, posting_m: f64, direction: DVec2) -> f64 {
        self.near as f64 * posting_m / direction.abs().max_element()
    }

    pub(super) fn search_limit_m(&self) -> f64 {
        self.search_m.unwrap_or(f64::INFINITY)
    }
}

/// The unit map direction `(sin A, cos A)` of a map azimuth, exact along the axes.
pub fn direction(azimuth_rad: f64) -> DVec2 {
    let (sin, cos) = azimuth_rad.sin_cos();
    // The sine of a rounded multiple of π is some 1e-16, a slope that no grid resolves.
    let snapped = |component: f64| if component.abs() < 1e-14 { 0.0 } else { component };
    DVec2::new(snapped(sin), snapped(cos))
}
