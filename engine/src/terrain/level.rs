//! Nested grids of lifted heights on one gnomonic map, and the maps that make up a terrain.

use glam::{DVec2, DVec3};

use super::{Gnomonic, patch};
use crate::geometry::Body;
use crate::grid::{Cell, Grid2};

/// A square grid of lifted heights. The surface is bilinear in `H` between its nodes.
///
/// Node `(column, row)` lies at `X = west_m + column · posting_m`, `Y = south_m + row · posting_m`:
/// rows run *up* the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    pub columns: usize,
    pub rows: usize,
    pub posting_m: f64,
    pub west_m: f64,
    pub south_m: f64,
    /// Lifted heights, row by row.
    pub heights_m: Vec<f32>,
    /// True where no DEM gave a height. Such nodes carry a filled height, never occlude, and are masked.
    pub gap: Vec<bool>,
    /// Where the surface of this level is seen and has horizons, in nodes from each side: the rest is a
    /// margin that only casts shadows (a cube's face reaches past its edges).
    pub margin: usize,
}

impl Level {
    pub fn index(&self, column: usize, row: usize) -> usize {
        row * self.columns + column
    }

    pub fn height_m(&self, column: usize, row: usize) -> f64 {
        f64::from(self.heights_m[self.index(column, row)])
    }

    /// Map coordinates of a node.
    pub fn node_m(&self, column: usize, row: usize) -> DVec2 {
        DVec2::new(self.west_m + column as f64 * self.posting_m, self.south_m + row as f64 * self.posting_m)
    }

    /// The lifted point of a node.
    pub fn lifted_node(&self, column: usize, row: usize) -> DVec3 {
        self.node_m(column, row).extend(self.height_m(column, row))
    }

    /// Grid coordinates (columns, rows, counted from node (0, 0)) of a map point.
    pub fn grid_from_map(&self, at_m: DVec2) -> DVec2 {
        (at_m - DVec2::new(self.west_m, self.south_m)) / self.posting_m
    }

    pub fn map_from_grid(&self, grid: DVec2) -> DVec2 {
        grid * self.posting_m + DVec2::new(self.west_m, self.south_m)
    }

    /// The cell that holds a grid point, points on the far edges included in the last one.
    pub fn cell(&self, grid: DVec2) -> Option<(usize, usize)> {
        Cell::inside([self.columns, self.rows], grid).map(|cell| cell.low.into())
    }

    /// Bilinear lifted height at a grid point inside the grid.
    pub fn bilinear_m(&self, grid: DVec2) -> Option<f64> {
        self.bilinear_of(&self.heights_m, grid)
    }

    /// Bilinear value at a grid point of anything that is given at the nodes.
    pub fn bilinear_of(&self, values: &[f32], grid: DVec2) -> Option<f64> {
        let values = Grid2::new(values, [self.columns, self.rows]);
        Some(values.bilinear(Cell::inside(values.size(), grid)?))
    }

    /// Lifted heights of a cell's corners: (0, 0), (1, 0), (0, 1), (1, 1) in (column, row).
    pub fn corners_m(&self, column: usize, row: usize) -> [f64; 4] {
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(c, r)| self.height_m(column + c, row + r))
    }

    /// True where one of a cell's corners is a gap.
    pub fn cell_has_gap(&self, column: usize, row: usize) -> bool {
        [(0, 0), (1, 0), (0, 1), (1, 1)].iter().any(|(c, r)| self.gap[self.index(column + c, row + r)])
    }

    /// dH/dX and dH/dY at a node, as the smooth surface of [`patch`] has them.
    pub fn gradient(&self, column: usize, row: usize) -> DVec2 {
        let step = |node: usize, offset: isize, count: usize, height_m: &dyn Fn(usize) -> f64| {
            let low = node.checked_add_signed(offset).filter(|low| low + 1 < count)?;
            Some((height_m(low + 1) - height_m(low)) / self.posting_m)
        };
        DVec2::new(
            patch::slope(|offset| step(column, offset, self.columns, &|c| self.height_m(c, row))),
            patch::slope(|offset| step(row, offset, self.rows, &|r| self.height_m(column, r))),
        )
    }

    /// dH/dX and dH/dY at a map point: those of [`patch`], so that shading is continuous from cell to cell.
    pub fn interpolated_gradient(&self, at_m: DVec2) -> DVec2 {
        let cell = Cell::continued([self.columns, self.rows], self.grid_from_map(at_m));
        let corners = cell.corners();
        let heights = corners.map(|(column, row)| self.height_m(column, row) / self.posting_m);
        patch::gradient(heights, corners.map(|(column, row)| self.gradient(column, row)), cell.fraction)
    }

    /// Columns and rows of the seen part.
    pub fn seen_size(&self) -> [usize; 2] {
        [self.columns - 2 * self.margin, self.rows - 2 * self.margin]
    }

    /// How many nodes the seen part has.
    pub fn seen_nodes(&self) -> usize {
        let [columns, rows] = self.seen_size();
        columns * rows
    }

    /// The seen part alone, as a level without margin.
    pub fn seen(&self) -> Self {
        let m = self.margin;
        let [columns, rows] = self.seen_size();
        let cut = |row: usize| self.index(m, row)..self.index(m, row) + columns;
        let south_west_m = self.node_m(m, m);
        Self {
            columns,
            rows,
            posting_m: self.posting_m,
            west_m: south_west_m.x,
            south_m: south_west_m.y,
            heights_m: (m..m + rows).flat_map(|row| self.heights_m[cut(row)].iter().copied()).collect(),
            gap: (m..m + rows).flat_map(|row| self.gap[cut(row)].iter().copied()).collect(),
            margin: 0,
        }
    }

    /// Map coordinates of the seen part's corners.
    pub fn seen_m(&self) -> (DVec2, DVec2) {
        let far = (self.columns - 1 - self.margin, self.rows - 1 - self.margin);
        (self.node_m(self.margin, self.margin), self.node_m(far.0, far.1))
    }

    /// True where a map point lies in the part of the level that is seen (not in its margin).
    pub fn sees(&self, at_m: DVec2) -> bool {
        let grid = self.grid_from_map(at_m);
        let low = DVec2::splat(self.margin as f64);
        let high = DVec2::new((self.columns - 1) as f64, (self.rows - 1) as f64) - low;
        grid.cmpge(low).all() && grid.cmple(high).all()
    }
}

/// A gnomonic map with its nested levels, finest first. Where levels overlap the finest one is the
/// surface; along its edge it agrees with the next one, so that the surface has no cracks.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    pub map: Gnomonic,
    pub levels: Vec<Level>,
}

impl Face {
    /// The finest level whose seen part holds a map point.
    pub fn level_at(&self, at_m: DVec2) -> Option<usize> {
        self.levels.iter().position(|level| level.sees(at_m))
    }
}

/// The surface of a scene: maps with heights, and the bare spheroid where they end.
#[derive(Debug, Clone, PartialEq)]
pub struct Terrain {
    pub body: Body,
    pub faces: Vec<Face>,
}

impl Terrain {
    /// Nodes of the seen parts of all levels.
    pub fn seen_nodes(&self) -> usize {
        let seen = |level: &Level| level.seen_nodes();
        self.faces.iter().flat_map(|face| &face.levels).map(seen).sum()
    }
}
