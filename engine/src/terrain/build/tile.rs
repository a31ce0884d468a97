//! The ground that a tile of a quad-tree is made from: its own nodes, and all that can rise above their horizon.
//!
//! The tile lies in nested levels, each of twice the posting and twice the width of the next finer one, out to the *reach*.
//! They are cut from lattices that all tiles of a face share, so that neighbours see the same nodes where their levels
//! overlap, and read from the model in windows: memory is that of the levels, whatever the model's size. Coarse levels hold
//! means of the model's pixels.
//!
//! A peak at radius `r₁` rises above the horizontal plane of an observer at `r₀` only within the central angle
//!
//! ```text
//! ψ = acos(r₀/r₁)        reach = ψ between the lowest and the highest ground: 262 km on the Moon
//! ```
//!
//! # Assumptions
//! Skylines *below* the horizontal plane end at the reach, and go on as the bare sphere. The means of far ground lack its peaks:
//! what that does to horizons is measured by `pipeline::globe`.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};
use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};

use super::grid::{Grid, Rectangle};
use super::{Error, nest, outermost, sample};
use crate::geometry::{Body, Position};
use crate::raster::{Around, Dem, Options, Reading, Values};
use crate::terrain::quadtree::{QuadTree, TileId};
use crate::terrain::{Face, Gnomonic, Level};

/// Nodes along the side of the blocks in which a level is read from its model.
const BLOCK: usize = 256;

/// An elevation model of a whole body that stays on disk.
#[derive(Debug, Clone, PartialEq)]
pub struct GlobalDem {
    pub path: PathBuf,
    pub reading: Reading,
    /// Never `Auto`.
    pub values: Values,
    /// Distance of pixels along a meridian.
    pub posting_m: f64,
    pub lowest_m: f64,
    pub highest_m: f64,
    /// What a user should know of the file, a line each.
    pub findings: Vec<String>,
}

impl GlobalDem {
    /// Looks at all of a model once.
    pub fn open(path: &Path, body: &Body, reading: &Reading, values: Values) -> Result<Self, Error> {
        let options = Options { reading: reading.clone(), values, ..Default::default() };
        let survey = Dem::survey(path, body, &options)?;
        let [lowest_m, highest_m] = survey.extremes;
        Ok(Self {
            path: path.into(),
            reading: reading.clone(),
            values: survey.values,
            posting_m: Dem::posting_m(path, reading)?,
            lowest_m,
            highest_m,
            findings: survey.findings,
        })
    }

    /// Central angle within which ground can rise above the horizontal.
    pub fn reach_rad(&self, body: &Body) -> f64 {
        let lowest_m = body.polar_radius_m.min(body.equatorial_radius_m) + self.lowest_m;
        (lowest_m / (lowest_m + self.highest_m - self.lowest_m)).acos()
    }
}

/// The levels around a tile, finest first, of which the first one's seen part is the tile.
///
/// A level reaches `margin` of its own nodes beyond the tile: the larger, the farther is ground seen at full resolution.
pub fn build_tile(tree: &QuadTree, tile: TileId, dem: &GlobalDem, margin: usize) -> Result<Face, Error> {
    let map = &tree.maps[tile.face];
    let reach = reach(tree, tile, dem.reach_rad(&tree.body));
    // What cannot be seen is not read.
    let margin = margin.min(nodes_to_reach(tree, tile, &reach));
    let mut grids = Vec::new();
    loop {
        let (grid, whole) = grid(tree, tile, grids.len(), margin, &reach);
        grids.push(grid);
        if whole {
            break;
        }
    }
    let mut levels: Vec<Level> = Vec::new();
    for (index, grid) in grids.iter().enumerate().rev() {
        let heights_m = read(&tree.body, map, grid, dem)?;
        let mut level = match levels.first() {
            Some(coarse) => nest(&tree.body, map, grid, &heights_m, coarse),
            None => outermost(&tree.body, map, grid, heights_m),
        };
        if index == 0 {
            level.margin = (grid.columns - 1 - tree.cells) / 2;
        }
        levels.insert(0, level);
    }
    Ok(Face { map: map.clone(), levels })
}

/// The part of the map within a central angle of a tile.
fn reach(tree: &QuadTree, tile: TileId, reach_rad: f64) -> Rectangle {
    const ALONG: usize = 16;
    const AROUND: usize = 32;
    let radius_m = tree.body.equatorial_radius_m;
    let (mut low_m, mut high_m) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for i in 0..=ALONG {
        let share = i as f64 / ALONG as f64;
        for edge in [DVec2::new(share, 0.0), DVec2::new(share, 1.0), DVec2::new(0.0, share), DVec2::new(1.0, share)] {
            let up = tree.node_m(tile, edge * tree.cells as f64).extend(radius_m).normalize();
            let (east, north) = up.any_orthonormal_pair();
            for around in 0..AROUND {
                let (sin, cos) = (TAU * around as f64 / AROUND as f64).sin_cos();
                let there: DVec3 = up * reach_rad.cos() + (east * sin + north * cos) * reach_rad.sin();
                // 63° from a face's middle at most on the Moon; a body with more relief is seen as far as a map can.
                let at_m = there.truncate() * (radius_m / there.z.max(0.1));
                (low_m, high_m) = (low_m.min(at_m), high_m.max(at_m));
            }
        }
    }
    Rectangle { low_m, high_m }
}

/// Nodes of the tile's own posting from its sides to the end of the reach, on the side where they are most.
fn nodes_to_reach(tree: &QuadTree, tile: TileId, reach: &Rectangle) -> usize {
    let (low_m, high_m) = (tree.node_m(tile, DVec2::ZERO), tree.node_m(tile, DVec2::splat(tree.cells as f64)));
    let beyond_m = (low_m - reach.low_m).max(reach.high_m - high_m).max_element();
    (beyond_m / tree.posting_m(tile.level)).ceil().max(0.0) as usize + 1
}

/// The grid of a tile's level `step`, and whether it holds all of the reach.
fn grid(tree: &QuadTree, tile: TileId, step: usize, margin: usize, reach: &Rectangle) -> (Grid, bool) {
    let stride = 1_i64 << step;
    let posting_m = tree.posting_m(tile.level) * stride as f64;
    let first = [tile.column, tile.row].map(|tile| (tile * tree.cells) as i64);
    let radius_m = tree.body.equatorial_radius_m;
    let (mut low, mut high) = ([0; 2], [0; 2]);
    let mut whole = true;
    for axis in 0..2 {
        let index = |at_m: f64| (at_m + radius_m) / posting_m;
        let needed = [index(reach.low_m[axis]).floor() as i64, index(reach.high_m[axis]).ceil() as i64];
        low[axis] = first[axis].div_euclid(stride) - margin as i64;
        high[axis] = (first[axis] + tree.cells as i64 + stride - 1).div_euclid(stride) + margin as i64;
        whole &= low[axis] <= needed[0] && high[axis] >= needed[1];
        if step > 0 {
            // Two nodes more: a finer level's border is feathered into this one's cells.
            (low[axis], high[axis]) = (low[axis].max(needed[0] - 2), high[axis].min(needed[1] + 2));
        }
    }
    (Grid::between(DVec2::splat(-radius_m), posting_m, low, high), whole)
}

/// Heights on the nodes of a grid, NaN where the model has none, read block by block.
pub(super) fn read(body: &Body, map: &Gnomonic, grid: &Grid, dem: &GlobalDem) -> Result<Vec<f64>, Error> {
    let mut heights_m = vec![f64::NAN; grid.nodes()];
    for block in grid.blocks(BLOCK) {
        let middle = map.up(0.5 * (block.at(0, 0) + block.at(block.columns - 1, block.rows - 1)));
        let corners = [(0, 0), (block.columns - 1, 0), (0, block.rows - 1), (block.columns - 1, block.rows - 1)];
        let angle_rad = |(column, row)| map.up(block.at(column, row)).angle_to(middle);
        let wide_rad = corners.map(angle_rad).into_iter().fold(0.0, f64::max);
        let towards = map.map_from_body.inverse().turn(middle.unit());
        let centre = body.geodetic_from_position(Position::from_m(towards * body.equatorial_radius_m));
        let around = Around { centre, distance_m: body.equatorial_radius_m * wide_rad.min(1.4).tan() };
        // The same for all of a level, or neighbours would disagree; nodes are 1 to 0.5 postings apart on the ground.
        let posting_m = FRAC_1_SQRT_2 * grid.posting_m;
        let (reading, values) = (dem.reading.clone(), dem.values);
        let options =
            Options { reading, values, around: Some(around), posting_m: Some(posting_m), ..Default::default() };
        let window = match Dem::open(&dem.path, body, &options) {
            Err(crate::raster::Error::AllNodata { .. }) => continue,
            window => window?,
        };
        let mut block_m = vec![f64::NAN; block.nodes()];
        sample(body, map, &block, &window, &mut block_m)?;
        grid.put(&block, &block_m, &mut heights_m);
    }
    Ok(heights_m)
}
