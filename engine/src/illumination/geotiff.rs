//! Illumination maps as a GeoTIFF on the grid of the elevation model that is mapped: its reference system, its pixels, north up,
//! cropped to the nodes that have values. A cell takes the values of the node nearest to its centre.

use std::path::Path;

use glam::DVec2;

use super::maps::Maps;
use crate::geometry::Body;
use crate::raster::{self, GeoTiff, GeoTiffBand, Georeference, cells_around};
use crate::terrain::{Gnomonic, Level};

/// Where maps lie.
#[derive(Debug, Clone, Copy)]
pub struct MappedLevel<'a> {
    pub body: &'a Body,
    pub map: &'a Gnomonic,
    pub level: &'a Level,
}

impl Maps {
    /// Writes all maps of a level on the grid of `dem`, which has `dem_columns` columns.
    pub fn write(
        &self,
        on: MappedLevel,
        dem: &Georeference,
        dem_columns: usize,
        path: &Path,
    ) -> Result<(), raster::Error> {
        let planes = [
            ("lit_share", "1", &self.lit_share),
            ("disc_share", "1", &self.disc_share),
            ("longest_night", "h", &self.longest_night_h),
            ("earth_share", "1", &self.earth_share),
        ];
        // A level that is coarser than its model has cells of several pixels.
        let times = (on.level.posting_m / dem.posting_m()).round().max(1.0);
        let whole = dem.north_up(dem_columns, times)?;
        let known = (0..self.lit_share.len()).filter(|node| self.lit_share[*node].is_finite());
        let pixels = whole.projector()?.pixels(&known.map(|node| self.position(on, node)).collect::<Vec<_>>());
        let (first, [columns, rows]) = cells_around(pixels).unwrap_or(([0, 0], [1, 1]));
        let grid = whole.from_cell(first, columns)?;
        let nodes = self.nodes(on, &grid, [columns, rows])?;
        let values = planes.map(|(.., plane)| {
            nodes.iter().map(|node| node.map_or(f32::NAN, |node| plane[node])).collect::<Vec<f32>>()
        });
        let bands = planes.iter().zip(&values).map(|((name, unit, _), values)| GeoTiffBand { name, unit, values });
        GeoTiff { columns, rows, bands: bands.collect(), crs: &grid.wkt, geotransform: grid.geotransform }.write(path)
    }

    /// A node's place at its height.
    fn position(&self, on: MappedLevel, node: usize) -> crate::geometry::Position<crate::geometry::BodyFixed> {
        let margin = on.level.margin;
        on.map.body_from_lifted(on.level.lifted_node(node % self.columns + margin, node / self.columns + margin))
    }

    /// The node nearest to each cell of a grid; `None` beyond the nodes.
    fn nodes(
        &self,
        on: MappedLevel,
        grid: &Georeference,
        [columns, rows]: [usize; 2],
    ) -> Result<Vec<Option<usize>>, raster::Error> {
        let cells: Vec<DVec2> =
            (0..columns * rows).map(|cell| DVec2::new((cell % columns) as f64, (cell / columns) as f64)).collect();
        let places = grid.projector()?.positions(on.body, &cells, &vec![0.0; cells.len()]);
        let last = DVec2::new((self.columns - 1) as f64, (self.rows - 1) as f64);
        let node = |place: &crate::geometry::Position<crate::geometry::BodyFixed>| {
            let at_m = on.map.lifted_from_body(*place)?.truncate();
            let node = (on.level.grid_from_map(at_m) - on.level.margin as f64).round();
            let inside = node.cmpge(DVec2::ZERO).all() && node.cmple(last).all();
            inside.then(|| node.y as usize * self.columns + node.x as usize)
        };
        Ok(places.iter().map(node).collect())
    }

    /// A plane with its rows from the top of the map down.
    pub fn rows_down(&self, plane: &[f32]) -> Vec<f32> {
        plane.chunks(self.columns).rev().flatten().copied().collect()
    }
}
