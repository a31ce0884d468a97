//! Skylines towards one light, found for all nodes at once and fetched by every sample.
//!
//! While a light stands still, the skyline that matters at a node is one elevation `h` and its slope `dh/dA` by map
//! azimuth, at the map azimuth of the light's centre. A method ([`SkylineSource`]) finds them for a whole level; a sample
//! interpolates them bilinearly between nodes. A Fourier series is linear in its coefficients, so that interpolating
//! evaluated series is interpolating series: for coefficients at full resolution the change costs nothing but the turn of
//! the light's azimuth across a cell, `posting/R` times the tangent of its elevation. Coefficients at reduced
//! resolutions (`fm16`) have their knots between the nodes and are smoothed a second time.

use std::fmt::Debug;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::device::FieldMaker;
use super::light::QuantizedLight;
use super::site::{Disc, Site};
use crate::gpu::{Gpu, GpuError};
use crate::grid::{Cell, Grid2};
use crate::photometry::{DiskLight, HorizonLine};
use crate::terrain::{Face, Level, Surface};

/// Elevation above the local horizontal in radians, and its derivative by map azimuth.
pub type Skyline = [f32; 2];

/// Skylines of the seen nodes of a level, row by row, rows up the map.
pub type Field = Vec<Skyline>;

/// The seen nodes of a level as lifted points, in the order of a [`Field`].
#[derive(Debug, Clone, Copy)]
pub struct SurfacePoints<'a> {
    level: &'a Level,
    pub columns: usize,
    pub rows: usize,
}

impl<'a> SurfacePoints<'a> {
    pub fn of(level: &'a Level) -> Self {
        let [columns, rows] = level.seen_size();
        Self { level, columns, rows }
    }

    pub fn count(&self) -> usize {
        self.columns * self.rows
    }

    pub fn lifted(&self, index: usize) -> DVec3 {
        let (column, row) = (index % self.columns, index / self.columns);
        self.level.lifted_node(column + self.level.margin, row + self.level.margin)
    }
}

/// What finds the skylines of a level towards a light.
pub trait SkylineSource: Debug + Send + Sync {
    /// One skyline per seen node of level `level` of face `face`.
    fn field(
        &self,
        surface: &Surface,
        face: usize,
        level: usize,
        light: &QuantizedLight,
    ) -> Result<Field, UnpreparedLight>;

    /// What finds them on a device; `None` where it is the host that does.
    fn on_device(&self, _gpu: &Gpu, _surface: &Surface) -> Result<Option<Box<dyn FieldMaker>>, GpuError> {
        Ok(None)
    }
}

/// A light towards which no horizons were made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a light stands outside the azimuths for which horizons were made, as seen from level {level} of map {face}")]
pub struct UnpreparedLight {
    pub face: usize,
    pub level: usize,
}

/// By face and level.
type ByFace = Vec<Vec<Arc<Field>>>;

/// Skylines of a terrain towards all lights of a view, `[light][face][level]`.
#[derive(Debug, Clone, Default)]
pub struct Skylines {
    pub lights: Vec<QuantizedLight>,
    fields: Vec<ByFace>,
}

impl Skylines {
    /// The skylines towards `lights`; those that `self` holds are kept.
    pub fn towards(
        &self,
        surface: &Surface,
        source: &dyn SkylineSource,
        lights: &[QuantizedLight],
    ) -> Result<Self, UnpreparedLight> {
        self.found(
            surface,
            |light: &QuantizedLight, [face, level]: [usize; 2]| source.field(surface, face, level, light),
            lights,
        )
    }

    /// Fields towards `lights` by a function of a light, a face and a level of it; those that `self` holds are kept.
    pub fn found<E, F>(&self, surface: &Surface, field: F, lights: &[QuantizedLight]) -> Result<Self, E>
    where
        F: Fn(&QuantizedLight, [usize; 2]) -> Result<Field, E>,
    {
        let find = |light: &QuantizedLight| -> Result<ByFace, E> {
            if let Some(known) = self.lights.iter().position(|known| known == light) {
                return Ok(self.fields[known].clone());
            }
            let faces = surface.terrain.faces.iter().enumerate();
            let of_face = |(face, levels): (usize, &Face)| {
                (0..levels.levels.len()).map(|level| field(light, [face, level]).map(Arc::new)).collect()
            };
            faces.map(of_face).collect()
        };
        Ok(Self { lights: lights.to_vec(), fields: lights.iter().map(find).collect::<Result<_, E>>()? })
    }

    pub fn field(&self, light: usize, face: usize, level: usize) -> &Field {
        &self.fields[light][face][level]
    }
}

/// The light above a skyline of elevation `elevation_rad` and slope `slope` by map azimuth.
pub fn line(site: &Site, disc: &Disc, elevation_rad: f64, slope: f64) -> DiskLight {
    let at_m = site.lifted.truncate();
    let towards = site.map.map_direction(at_m, disc.axes.sun);
    let sun_elevation_rad = site.map.up(at_m).unit().dot(disc.axes.sun.unit()).clamp(-1.0, 1.0).asin();
    let slope = slope * site.map.azimuth_ratio(at_m, towards);
    let line = HorizonLine::new(elevation_rad, slope, sun_elevation_rad, disc.angular_radius_rad);
    disc.disk.light(line, disc.facet)
}

/// Both numbers at a grid point counted from the first seen node; beyond the edges those of the edge.
pub fn bilinear(level: &Level, field: &Field, grid: DVec2) -> [f64; 2] {
    let [columns, rows] = level.seen_size();
    let far = DVec2::new((columns - 1) as f64, (rows - 1) as f64);
    let skylines = Grid2::new(field, [columns, rows]);
    let cell = Cell::continued(skylines.size(), grid.clamp(DVec2::ZERO, far));
    cell.mix(|column, row| DVec2::from_array(skylines.get(column, row).map(f64::from))).to_array()
}
