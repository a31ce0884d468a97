//! Skylines towards one light, found for all nodes at once and fetched by every sample.
//!
//! While a light stands still, the skyline that matters at a node is one elevation `h` and its slope `dh/dA` by map
//! azimuth, at the map azimuth of the light's centre. A method ([`Towards`]) finds them for a whole level; a sample
//! interpolates them bilinearly between nodes. A Fourier series is linear in its coefficients, so that interpolating
//! evaluated series is interpolating series: for coefficients at full resolution the change costs nothing but the turn of
//! the light's azimuth across a cell, `posting/R` times the tangent of its elevation. Coefficients at reduced
//! resolutions (`fm16`) have their knots between the nodes and are smoothed a second time.
//!
//! A light is *held still* on a raster of 2⁻¹⁷ in each component of its direction and of 0.07 % in distance and radius:
//! exposures a few seconds apart share their skylines, and each is the same whether it is rendered alone or after others.
//!
//! # Assumptions
//! The raster moves a light by up to 7e-6 rad (0.0004°, 1/700 of the Sun's radius) for its azimuth alone, 0.03 % of
//! the Earth's distance by as much again; the elevation above the skyline is that of the light itself.

use std::fmt::Debug;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::multiscale::device::OnDevice;
use super::{Disc, Shadow, Site};
use crate::geometry::{BodyFixed, Direction, Map, Position};
use crate::gpu::{Gpu, GpuError};
use crate::photometry::{DiskLight, HorizonLine};
use crate::terrain::{Face, Gnomonic, Level, Surface};

/// Elevation above the local horizontal in radians, and its derivative by map azimuth.
pub type Skyline = [f32; 2];

/// Skylines of the seen nodes of a level, row by row, rows up the map.
pub type Field = Vec<Skyline>;

/// The seen nodes of a level as lifted points, in the order of a [`Field`].
#[derive(Debug, Clone, Copy)]
pub struct Feet<'a> {
    level: &'a Level,
    pub columns: usize,
    pub rows: usize,
}

impl<'a> Feet<'a> {
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

/// A method that finds the skylines of a level towards a light.
pub trait Towards: Debug + Send + Sync {
    /// What the method is called in reports.
    fn name(&self) -> &'static str;

    /// One skyline per seen node of level `level` of face `face`.
    fn field(&self, surface: &Surface, face: usize, level: usize, light: &HeldLight) -> Result<Field, OutsideSwath>;

    /// What finds the same on a device; `None` where it is the host that does.
    fn on_device(&self, _gpu: &Gpu, _surface: &Surface) -> Result<Option<OnDevice>, GpuError> {
        Ok(None)
    }
}

/// A light towards which no horizons were made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a light stands outside the swath that was made, as seen from level {level} of map {face}")]
pub struct OutsideSwath {
    pub face: usize,
    pub level: usize,
}

/// A light held still.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldLight {
    /// Body-fixed, from the body's centre.
    pub position: Position<BodyFixed>,
    /// Of its disc.
    pub angular_radius_rad: f64,
}

/// Steps of the raster in a component of a direction.
const STEPS: f64 = 131_072.0;

/// Steps of the raster in an octave of distances and of radii.
const STEPS_OF_SIZE: f64 = 1024.0;

/// A disc is looked at no further than this to each side: one nearer than 1.3° to the zenith spans wider azimuths.
pub(super) const WIDEST_RAD: f64 = 0.2;

/// Where a light stands as seen from a point of the ground.
#[derive(Debug, Clone, Copy)]
pub struct Aim {
    /// Unit map direction.
    pub towards: DVec2,
    pub elevation_rad: f64,
    /// From the middle of its disc to the edges, in map azimuth: `asin(sin r / cos a)` for a radius `r` at elevation `a`.
    pub half_width_rad: f64,
}

impl HeldLight {
    pub fn new(position: Position<BodyFixed>, angular_radius_rad: f64) -> Self {
        let vector_m = position.vector_m();
        let direction = (vector_m / vector_m.length() * STEPS).round().normalize();
        let rounded = |size: f64| ((size.log2() * STEPS_OF_SIZE).round() / STEPS_OF_SIZE).exp2();
        Self {
            position: Position::from_m(rounded(vector_m.length()) * direction),
            angular_radius_rad: rounded(angular_radius_rad),
        }
    }

    /// The light from a point of the ground.
    pub fn aim(&self, map: &Gnomonic, lifted: DVec3) -> Aim {
        let at_m = lifted.truncate();
        let (towards, direction) = self.from(map, lifted);
        let up = map.up(at_m).unit();
        let level = direction.unit().reject_from_normalized(up).length();
        let elevation_rad = up.dot(direction.unit()).atan2(level);
        let half_width_rad = (self.angular_radius_rad.sin() / level).min(1.0).asin() * map.azimuth_ratio(at_m, towards);
        Aim { towards, elevation_rad, half_width_rad: half_width_rad.min(WIDEST_RAD) }
    }

    /// The unit map direction towards the light from a point of the ground, and the direction itself.
    pub fn from(&self, map: &Gnomonic, lifted: DVec3) -> (DVec2, Direction<Map>) {
        let towards_m = map.map_vector(self.position) - map.unlift(lifted);
        let towards = Direction::new(towards_m).unwrap_or_else(|| map.up(lifted.truncate()));
        (map.map_direction(lifted.truncate(), towards).normalize_or(DVec2::Y), towards)
    }
}

/// By face and level.
type ByFace = Vec<Vec<Arc<Field>>>;

/// Skylines of a terrain towards all lights of a view, `[light][face][level]`.
#[derive(Debug, Clone, Default)]
pub struct Skylines {
    pub lights: Vec<HeldLight>,
    fields: Vec<ByFace>,
}

impl Skylines {
    /// Finds the skylines towards `lights`, those that `self` holds already kept.
    pub fn towards(&self, surface: &Surface, method: &dyn Towards, lights: &[HeldLight]) -> Result<Self, OutsideSwath> {
        self.found(
            surface,
            |light: &HeldLight, [face, level]: [usize; 2]| method.field(surface, face, level, light),
            lights,
        )
    }

    /// The same by a function of a light, a face and a level of it.
    pub fn found<E, F>(&self, surface: &Surface, field: F, lights: &[HeldLight]) -> Result<Self, E>
    where
        F: Fn(&HeldLight, [usize; 2]) -> Result<Field, E>,
    {
        let find = |light: &HeldLight| -> Result<ByFace, E> {
            if let Some(known) = self.lights.iter().position(|held| held == light) {
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

/// Skylines as a source of shadows.
#[derive(Debug)]
pub struct Fetched<'a> {
    pub surface: &'a Surface,
    pub skylines: Skylines,
}

impl Shadow for Fetched<'_> {
    fn light(&self, site: &Site, disc: &Disc) -> DiskLight {
        let level = &self.surface.terrain.faces[site.face].levels[site.level];
        let at_m = site.lifted.truncate();
        let field = self.skylines.field(disc.light, site.face, site.level);
        let [elevation_rad, slope] = bilinear(level, field, level.grid_from_map(at_m) - level.margin as f64);
        line(site, disc, elevation_rad, slope)
    }
}

/// The light above a skyline of elevation `elevation_rad` and slope `slope` by map azimuth.
pub(super) fn line(site: &Site, disc: &Disc, elevation_rad: f64, slope: f64) -> DiskLight {
    let at_m = site.lifted.truncate();
    let towards = site.map.map_direction(at_m, disc.axes.sun);
    let sun_elevation_rad = site.map.up(at_m).unit().dot(disc.axes.sun.unit()).clamp(-1.0, 1.0).asin();
    let slope = slope * site.map.azimuth_ratio(at_m, towards);
    let line = HorizonLine::new(elevation_rad, slope, sun_elevation_rad, disc.angular_radius_rad);
    disc.disk.light(line, disc.facet)
}

/// Both numbers at a grid point counted from the first seen node; beyond the edges those of the edge.
pub(super) fn bilinear(level: &Level, field: &Field, grid: DVec2) -> [f64; 2] {
    let [columns, rows] = level.seen_size();
    let far = DVec2::new((columns - 1) as f64, (rows - 1) as f64);
    let grid = grid.clamp(DVec2::ZERO, far);
    let cell = grid.floor().min(far - 1.0);
    let f = grid - cell;
    let at = |c: usize, r: usize| {
        let [elevation_rad, slope] = field[(cell.y as usize + r) * columns + cell.x as usize + c];
        DVec2::new(f64::from(elevation_rad), f64::from(slope))
    };
    at(0, 0).lerp(at(1, 0), f.x).lerp(at(0, 1).lerp(at(1, 1), f.x), f.y).to_array()
}
