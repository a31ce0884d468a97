//! Fourier horizon maps evaluated once per node while the light stands still.

use glam::DVec2;
use rayon::prelude::*;

use super::skylines::{Field, HeldLight, OutsideSwath, Towards};
use crate::horizon::HorizonMap;
use crate::terrain::Surface;

/// Horizon maps by face and level; the device evaluates them itself (`bake.wgsl`).
#[derive(Debug)]
pub struct Baked(pub Vec<Vec<HorizonMap>>);

impl Towards for Baked {
    fn name(&self) -> &'static str {
        "baked"
    }

    fn field(&self, surface: &Surface, face: usize, level: usize, light: &HeldLight) -> Result<Field, OutsideSwath> {
        let (map, nodes) = (&surface.terrain.faces[face].map, &surface.terrain.faces[face].levels[level]);
        let horizons = &self.0[face][level];
        let columns = horizons.columns;
        let skyline = |index: usize| {
            let (column, row) = (index % columns, index / columns);
            let foot = nodes.lifted_node(column + nodes.margin, row + nodes.margin);
            let (towards, _) = light.from(map, foot);
            let series = horizons.horizon(DVec2::new(column as f64, row as f64));
            let (elevation_rad, slope) = series.evaluate_towards(towards);
            [elevation_rad as f32, slope as f32]
        };
        Ok((0..columns * horizons.rows).into_par_iter().map(skyline).collect())
    }
}
