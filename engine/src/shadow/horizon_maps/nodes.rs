//! Horizon maps evaluated once for each node while the light stands still.

use glam::DVec2;
use rayon::prelude::*;

use super::maps::HorizonMaps;
use crate::shadow::light::QuantizedLight;
use crate::shadow::skylines::{Field, SkylineSource, UnpreparedLight};
use crate::terrain::Surface;

impl SkylineSource for HorizonMaps {
    fn field(
        &self,
        surface: &Surface,
        face: usize,
        level: usize,
        light: &QuantizedLight,
    ) -> Result<Field, UnpreparedLight> {
        let (map, nodes) = (&surface.terrain.faces[face].map, &surface.terrain.faces[face].levels[level]);
        let horizons = &self.maps[face][level];
        let columns = horizons.columns;
        let skyline = |index: usize| {
            let (column, row) = (index % columns, index / columns);
            let point = nodes.lifted_node(column + nodes.margin, row + nodes.margin);
            let (towards, _) = light.from(map, point);
            let series = horizons.horizon(DVec2::new(column as f64, row as f64));
            let (elevation_rad, slope) = series.evaluate_towards(towards);
            [elevation_rad as f32, slope as f32]
        };
        Ok((0..columns * horizons.rows).into_par_iter().map(skyline).collect())
    }
}
