//! Lighting factors from horizon maps, as in Fritsch et al. (2025).
//!
//! ```text
//! E = E_n V max(n·s, 0)        V: the share of the disc above the skyline ([`Visibility`])
//! ```
//!
//! `V` is found at every sample, as in a fragment shader, or once per node and interpolated, as from a vertex shader:
//! there a shadow's edge is a ramp from node to node, however narrow the penumbra.
//!
//! # Assumptions
//! The product of share and cosine leaves out which part of the disc is seen, and that the facet's own plane may hide some
//! of it: across a penumbra at 1.5° Sun elevation it is 7 % too low at most ([`crate::photometry::SolarDisk`]).
//!
//! # References
//! Fritsch et al. (2025), sections 3.3 and 4.3, doi:10.2312/hpg.20251171.

use std::convert::Infallible;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::maps::{At, HorizonMaps};
use super::visibility::{DiscGeometry, Visibility};
use crate::geometry::{Direction, Map};
use crate::horizon::HorizonMap;
use crate::photometry::{DiskLight, SolarDisk};
use crate::shadow::light::QuantizedLight;
use crate::shadow::site::{Disc, Shadow, Site};
use crate::shadow::skylines::{Field, Skylines, bilinear};
use crate::terrain::{Gnomonic, Surface};

/// A map and what a light's disc needs to be placed over it.
struct Place<'a> {
    map: &'a Gnomonic,
    lifted: DVec3,
    horizons: &'a HorizonMap,
    /// On the map, in nodes.
    grid: DVec2,
}

impl Place<'_> {
    fn factor(&self, visibility: Visibility, disk: &SolarDisk, sun: Direction<Map>, angular_radius_rad: f64) -> f64 {
        let at_m = self.lifted.truncate();
        let up = self.map.up(at_m).unit();
        let elevation_rad = up.dot(sun.unit()).clamp(-1.0, 1.0).asin();
        let horizon = self.horizons.horizon(self.grid);
        let skyline = |offset_sine: f64| {
            let towards = beside(self.map, at_m, sun, up, offset_sine);
            let (elevation_rad, slope) = horizon.evaluate_towards(towards);
            (elevation_rad, slope * self.map.azimuth_ratio(at_m, towards))
        };
        visibility.share(disk, DiscGeometry { elevation_rad, angular_radius_rad }, skyline)
    }
}

/// The unit map direction of an azimuth, clockwise from the light's by the angle of this sine.
fn beside(map: &Gnomonic, at_m: DVec2, sun: Direction<Map>, up: DVec3, sine: f64) -> DVec2 {
    let (s, cosine) = (sun.unit(), (1.0 - sine * sine).max(0.0).sqrt());
    let turned = cosine * s + sine * s.cross(up) + (1.0 - cosine) * up.dot(s) * up;
    Direction::new(turned).map_or(DVec2::Y, |turned| map.map_direction(at_m, turned).normalize_or(DVec2::Y))
}

/// Lighting factors as a source of shadows.
#[derive(Debug)]
pub struct LightingFactors<'a> {
    surface: &'a Surface,
    maps: &'a [Vec<HorizonMap>],
    visibility: Visibility,
    /// Their factors, where they are found at nodes.
    fields: Option<Skylines>,
}

impl<'a> LightingFactors<'a> {
    /// Factors of `visibility`; those of nodes are found towards `lights`.
    pub fn new(
        surface: &'a Surface,
        method: &'a HorizonMaps,
        visibility: Visibility,
        disk: &SolarDisk,
        lights: &[QuantizedLight],
    ) -> Self {
        let unfound = Self { surface, maps: &method.maps, visibility, fields: None };
        let find = |light: &QuantizedLight, at: [usize; 2]| Ok::<_, Infallible>(unfound.nodes(disk, at, light));
        let found = || {
            let Ok(fields) = Skylines::default().found(surface, find, lights);
            fields
        };
        let fields = (method.at == At::Nodes).then(found);
        Self { fields, ..unfound }
    }

    /// Factors of all nodes of a level, row by row.
    fn nodes(&self, disk: &SolarDisk, [face, level]: [usize; 2], light: &QuantizedLight) -> Field {
        let surface = self.surface;
        let (map, nodes) = (&surface.terrain.faces[face].map, &surface.terrain.faces[face].levels[level]);
        let horizons = &self.maps[face][level];
        let factor = |index: usize| {
            let (column, row) = (index % horizons.columns, index / horizons.columns);
            let lifted = nodes.lifted_node(column + nodes.margin, row + nodes.margin);
            let place = Place { map, lifted, horizons, grid: DVec2::new(column as f64, row as f64) };
            let (_, sun) = light.from(map, lifted);
            [place.factor(self.visibility, disk, sun, light.angular_radius_rad) as f32, 0.0]
        };
        (0..horizons.columns * horizons.rows).into_par_iter().map(factor).collect()
    }
}

impl Shadow for LightingFactors<'_> {
    fn light(&self, site: &Site, disc: &Disc) -> DiskLight {
        if disc.facet.height <= 0.0 {
            return DiskLight::NONE;
        }
        let level = &self.surface.terrain.faces[site.face].levels[site.level];
        let grid = level.grid_from_map(site.lifted.truncate()) - level.margin as f64;
        let fraction = match &self.fields {
            Some(fields) => bilinear(level, fields.field(disc.light, site.face, site.level), grid)[0],
            None => {
                let horizons = &self.maps[site.face][site.level];
                let place = Place { map: site.map, lifted: site.lifted, horizons, grid };
                place.factor(self.visibility, disc.disk, disc.axes.sun, disc.angular_radius_rad)
            }
        };
        DiskLight { fraction, ..DiskLight::NONE }
    }
}
