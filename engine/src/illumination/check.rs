//! How far the maps are from what traced skylines give at the same nodes.

use rayon::prelude::*;

use super::blocks::Blocks;
use super::maps::{Maps, Study};
use super::place::{Place, Summary};
use crate::geometry::Body;
use crate::horizon::trace::Tracer;
use crate::statistics::Errors;

/// Errors of mapped shares at traced nodes: mapped less traced.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Check {
    pub nodes: usize,
    pub lit_share: Errors,
    pub disc_share: Errors,
    pub earth_share: Errors,
}

/// The light of traced nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Traced {
    nodes: Vec<usize>,
    light: Vec<Summary>,
}

impl Traced {
    /// At most `count` nodes, spread over those with light, which `study` would map.
    pub fn of(study: &Study, body: &Body, tracer: &Tracer, count: usize) -> Self {
        let level = &study.face.levels[study.level];
        let columns = Blocks::of(level).columns;
        let mapped = study.mapped();
        let mapped: Vec<usize> = (0..mapped.len()).filter(|node| mapped[*node]).collect();
        let count = count.min(mapped.len());
        // One node of every stretch of equal length, at Weyl's places in it: no pattern meets the map's rows.
        let node = |index: usize| {
            let within = (index as f64 * 0.618_033_988_749_895).fract();
            mapped[((index as f64 + within) / count as f64 * mapped.len() as f64) as usize]
        };
        let light = |&node: &usize| {
            let foot = level.lifted_node(node % columns + level.margin, node / columns + level.margin);
            let place = Place::of_foot(body, &study.face.map, tracer, foot);
            Summary::of(&place.moments(study.track, study.disk, study.lit), study.track.step_h())
        };
        let nodes: Vec<usize> = (0..count).map(node).collect();
        let light = nodes.par_iter().map(light).collect();
        Self { nodes, light }
    }

    /// How far maps are from it.
    pub fn check(&self, maps: &Maps) -> Check {
        let of = |plane: &[f32], share: &dyn Fn(&Summary) -> f64| {
            let pairs = self.nodes.iter().zip(&self.light);
            Errors::of(pairs.map(|(node, light)| f64::from(plane[*node]) - share(light)))
        };
        Check {
            nodes: self.nodes.len(),
            lit_share: of(&maps.lit_share, &|light| light.lit_share),
            disc_share: of(&maps.disc_share, &|light| light.disc_share),
            earth_share: of(&maps.earth_share, &|light| light.earth_share),
        }
    }
}
