//! The share of an even sky that lights a facet.
//!
//! A sky of constant radiance `L` gives a facet of normal `n` the irradiance `π L F`,
//!
//! ```text
//! F = 1/π ∫ over the sky above the skyline and the facet of (n·s) dΩ
//!   = 1/π Σ_A w_A [ n_A (π/4 − ω/2 − sin 2ω/4) + n_z cos² ω/2 ]
//! ```
//!
//! with `n_A` the normal's part towards azimuth `A`, `n_z` the part upwards, `ω` the higher one of skyline and facet,
//! `w_A` the step of true azimuth. [`share`] is that sum; [`Harmonic`] is Snyder & Nowrouzezahrai's way over the whole
//! swath: visibility and clamped cosine as spherical harmonics, `F` their product's integral.
//!
//! # Assumptions
//! The harmonics take map azimuths for true ones: within 1 % up to 8° from the map's centre.

mod harmonics;
mod wedges;

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use glam::{DVec2, DVec3};
use rayon::prelude::*;

pub use harmonics::Harmonics;
pub use wedges::{Wedges, wedge};

use super::multiscale::Multiscale;
use crate::horizon::HorizonMap;
use crate::horizon::settings::direction;
use crate::terrain::{Gnomonic, Surface};

/// Where the skyline all round a point comes from.
pub trait AllRound: Sync {
    /// The share of the sky at a seen node, counted from the first one, of a level: see [`share`].
    fn share(&self, surface: &Surface, place: [usize; 2], node: [usize; 2]) -> f64;
}

/// Shares of the sky for all nodes of a level, row by row; 1 in its margin, which nobody sees.
pub fn shares(surface: &Surface, [face, level]: [usize; 2], sky: &dyn AllRound) -> Vec<f32> {
    let nodes = &surface.terrain.faces[face].levels[level];
    let share = |index: usize| {
        let node = [index % nodes.columns, index / nodes.columns];
        let inside = |at: usize, count: usize| (nodes.margin..count - nodes.margin).contains(&at);
        let seen = inside(node[0], nodes.columns) && inside(node[1], nodes.rows);
        if seen { sky.share(surface, [face, level], node.map(|at| at - nodes.margin)) as f32 } else { 1.0 }
    };
    (0..nodes.columns * nodes.rows).into_par_iter().map(share).collect()
}

/// Horizon maps by face and level, evaluated in some azimuths.
#[derive(Debug)]
pub struct FromMaps<'a> {
    pub maps: &'a [Vec<HorizonMap>],
    pub azimuths: usize,
}

impl AllRound for FromMaps<'_> {
    fn share(&self, surface: &Surface, [face, level]: [usize; 2], [column, row]: [usize; 2]) -> f64 {
        let series = self.maps[face][level].horizon(DVec2::new(column as f64, row as f64));
        let elevations_rad = directions(self.azimuths).map(|towards| series.evaluate_towards(towards).0);
        let (at_m, normal) = facet(surface, [face, level], [column, row]);
        share(&surface.terrain.faces[face].map, at_m, normal, &elevations_rad.collect::<Vec<_>>())
    }
}

/// The multi-scale pyramid through spherical harmonics.
#[derive(Debug)]
pub struct Harmonic {
    multiscale: Multiscale,
    azimuths: usize,
    wedges: Wedges,
}

impl Harmonic {
    pub fn new(multiscale: Multiscale, azimuths: usize) -> Self {
        Self { multiscale, azimuths, wedges: Wedges::new(TAU / azimuths as f64) }
    }
}

impl AllRound for Harmonic {
    fn share(&self, surface: &Surface, place: [usize; 2], node: [usize; 2]) -> f64 {
        let map = &surface.terrain.faces[place[0]].map;
        let (at_m, normal) = facet(surface, place, node);
        let elevations_rad = self.multiscale.elevations_rad(map, place, at_m, directions(self.azimuths));
        let [north, up] = [tangent(map, at_m, DVec2::Y), map.up(at_m).unit()];
        let local = DVec3::new(normal.dot(north), normal.dot(north.cross(up)), normal.dot(up));
        let seen = self.wedges.all_round(&elevations_rad);
        (seen.dot(&Harmonics::clamped_cosine(local)) / PI).clamp(0.0, 1.0)
    }
}

/// Directions on a map in even steps of azimuth, the first one north.
pub fn directions(azimuths: usize) -> impl Iterator<Item = DVec2> {
    (0..azimuths).map(move |i| direction(TAU * i as f64 / azimuths as f64))
}

/// Map point and normal (map axes) of a seen node.
pub fn facet(surface: &Surface, [face, level]: [usize; 2], [column, row]: [usize; 2]) -> (DVec2, DVec3) {
    let (map, nodes) = (&surface.terrain.faces[face].map, &surface.terrain.faces[face].levels[level]);
    let (column, row) = (column + nodes.margin, row + nodes.margin);
    let lifted = nodes.lifted_node(column, row);
    (lifted.truncate(), map.normal(lifted, nodes.gradient(column, row)).unit())
}

/// The horizontal direction in space that is a unit direction on the map.
pub fn tangent(map: &Gnomonic, at_m: DVec2, towards: DVec2) -> DVec3 {
    let up = map.up(at_m).unit();
    (towards.extend(0.0) - up * up.dot(towards.extend(0.0))).normalize()
}

/// The share `F` of an even sky, from skylines in even steps of map azimuth, the first at 0.
pub fn share(map: &Gnomonic, at_m: DVec2, normal: DVec3, elevations_rad: &[f64]) -> f64 {
    let count = elevations_rad.len();
    let upwards = normal.dot(map.up(at_m).unit());
    let sector = |(towards, skyline_rad): (DVec2, &f64)| {
        let along = normal.dot(tangent(map, at_m, towards));
        let from_rad = skyline_rad.max((-along).atan2(upwards));
        let width_rad = TAU / count as f64 / map.azimuth_ratio(at_m, towards);
        let level = FRAC_PI_4 - 0.5 * from_rad - 0.25 * (2.0 * from_rad).sin();
        width_rad * (along * level + 0.5 * upwards * from_rad.cos().powi(2))
    };
    directions(count).zip(elevations_rad).map(sector).sum::<f64>() / PI
}
