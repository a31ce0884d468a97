//! Shadows traced over every grid line of the terrain: the truth that others are held to.
//!
//! # Assumptions
//! The ground is flat between its nodes, under the point too, so that its horizon is that of a facet: on a sphere with postings of
//! 1 km the Sun's share is off by 0.025 within the penumbra, with 10 m by 1e-5.

use std::sync::Arc;

use super::device::{DeviceError, DevicePart};
use super::light::QuantizedLight;
use super::method::{Bench, Family, Ingredients, MethodOptions, NamedMethod, PrepareError, ShadowMethod};
use super::site::{Disc, Shadow, Site};
use super::skylines::{Skylines, UnpreparedLight};
use crate::geometry::Direction;
use crate::gpu::Gpu;
use crate::horizon::Settings;
use crate::horizon::trace::Tracer;
use crate::photometry::{DiskLight, SolarDisk};
use crate::terrain::Surface;

/// Beyond the disc's edge whatever the tangent's second order and rounding do.
const BEYOND_DISC: f64 = 1.01;

pub const FAMILY: Family = Family {
    named: &[NamedMethod {
        name: "traced",
        bench: Bench::Unlisted,
        hard_cases: true,
        auto: false,
        options: || Box::new(Options),
    }],
    patterns: &[],
    parse: |_| None,
};

/// How traced shadows are asked for: there are no options.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options;

impl MethodOptions for Options {
    fn spelling(&self) -> String {
        "Traced".into()
    }

    fn runs_on_device(&self) -> bool {
        false
    }

    fn prepare(&self, ingredients: Ingredients) -> Result<Arc<dyn ShadowMethod>, PrepareError> {
        Ok(Arc::new(Traced { settings: ingredients.settings }))
    }
}

/// The exact horizon at every sample: slow, and only for the reference renderer.
#[derive(Debug, Clone, Copy)]
pub struct Traced {
    pub settings: Settings,
}

impl ShadowMethod for Traced {
    fn name(&self) -> &'static str {
        "traced"
    }

    fn shadow<'a>(
        &'a self,
        surface: &'a Surface,
        _: &SolarDisk,
        _: &[QuantizedLight],
        _: &Skylines,
    ) -> Result<Option<Box<dyn Shadow + 'a>>, UnpreparedLight> {
        Ok(Some(Box::new(TracedShadow { surface, settings: self.settings })))
    }

    fn device(&self, _: &Gpu, _: &Surface, _: &SolarDisk) -> Result<DevicePart, DeviceError> {
        Err(DeviceError::HostOnly(self.name()))
    }

    fn runs_on_device(&self) -> bool {
        false
    }

    fn is_exact(&self) -> bool {
        true
    }
}

/// The exact horizon, traced anew for each site and each column of the disc.
#[derive(Debug)]
pub struct TracedShadow<'a> {
    pub surface: &'a Surface,
    pub settings: Settings,
}

impl Shadow for TracedShadow<'_> {
    fn light(&self, site: &Site, disc: &Disc) -> DiskLight {
        // A facet that turns away from the whole disc needs no skyline.
        if disc.facet.height <= -disc.facet.slope.length() {
            return DiskLight::NONE;
        }
        let tracer = Tracer::new(&self.surface.terrain.faces[site.face], &self.settings)
            .with_pyramids(&self.surface.pyramids[site.face]);
        let at_m = site.lifted.truncate();
        let up = site.map.up(at_m).unit();
        let skyline = |x: f64| {
            let below = disc.axes.sun.unit() + disc.angular_radius_rad * x * disc.axes.x.unit();
            let Some(column) = Direction::new(below) else { return f64::NEG_INFINITY };
            let towards = site.map.map_direction(at_m, column).normalize_or(glam::DVec2::Y);
            let column_rad = up.dot(column.unit()).clamp(-1.0, 1.0).asin();
            // How far above or below the disc the skyline is does not matter.
            let ends_rad = [-BEYOND_DISC, BEYOND_DISC].map(|radii| column_rad + radii * disc.angular_radius_rad);
            let elevation_rad = tracer.skyline_within(site.lifted, towards, ends_rad).elevation_rad;
            // Along the column the angle from the disc's centre line is all that counts.
            (elevation_rad - column_rad).tan() / disc.angular_radius_rad
        };
        disc.disk.light_above(&skyline, disc.facet)
    }
}
