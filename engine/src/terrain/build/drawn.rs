//! A tile of a quad-tree as it is drawn beside tiles of other levels of detail.
//!
//! A tile's own heights `h` are means of the model at its own posting: those of a coarser neighbour are others, and its surface
//! is straight where this one has a node more. As levels nest ([`super`]), the tile turns into the coarser surface
//! `s'` towards such neighbours, within [`FEATHER_POSTINGS`] coarse postings,
//!
//! ```text
//! s = s' + w (h − s')      w = 0 on a side or corner beside a coarser tile, 1 from the feather's end on
//! ```
//!
//! where `s'` is what the tile of half the resolution would show in this one's place, turned in the same way into what lies
//! beside that. On a side that two tiles share both have the same nodes, the same `w` and the same `s'`: there is no crack,
//! across the cube's edges neither, where lifted heights of two maps are the same numbers.
//!
//! # Assumptions
//! A tile's horizons are those of the ground before it is turned: within the feather they belong to heights that differ by
//! what the next level of detail leaves out.

use glam::DVec2;
use rayon::prelude::*;

use super::grid::Grid;
use super::tile::read;
use super::{Error, FEATHER_POSTINGS, GlobalDem, fill, level, smooth_step};
use crate::geometry::Body;
use crate::terrain::cut::{Cut, NEIGHBOURS};
use crate::terrain::quadtree::{QuadTree, TileId};
use crate::terrain::{Face, Gnomonic, Level};

/// Nodes around the tile, for the gradients on its sides.
const MARGIN: usize = 1;

/// The tile with its margin, alone on its face's map.
pub fn drawn_tile(tree: &QuadTree, cut: &Cut, tile: TileId, dem: &GlobalDem) -> Result<Face, Error> {
    let map = &tree.maps[tile.face];
    let mut turned = vec![(tile, cut.coarser_beside(tree, tile))];
    while let Some((last, beside)) = turned.last().filter(|(_, beside)| beside.contains(&true)) {
        debug_assert!(last.level > 0, "nothing is coarser than {last}, got {beside:?}");
        let Some(parent) = last.parent() else { break };
        turned.push((parent, cut.coarser_beside(tree, parent)));
    }
    let mut drawn: Option<Level> = None;
    for (step, (ancestor, beside)) in turned.iter().enumerate().rev() {
        let grid = around(tree, tile, step);
        let mut own = ground(&tree.body, map, &grid, dem)?;
        if let Some(coarse) = &drawn {
            turn(&mut own, coarse, |at_m| weight(tree, *ancestor, beside, at_m));
        }
        drawn = Some(own);
    }
    let level = drawn.expect("the tile itself is among them");
    Ok(Face { map: map.clone(), levels: vec![Level { margin: MARGIN, ..level }] })
}

/// The nodes of `step` levels above a tile's that lie under it, and one more on each side.
fn around(tree: &QuadTree, tile: TileId, step: usize) -> Grid {
    let stride = 1_i64 << step;
    let first = [tile.column, tile.row].map(|tile| (tile * tree.cells) as i64);
    let margin = MARGIN as i64;
    let low = first.map(|first| first.div_euclid(stride) - margin);
    let high = first.map(|first| (first + tree.cells as i64 + stride - 1).div_euclid(stride) + margin);
    Grid::between(DVec2::splat(-tree.body.equatorial_radius_m), tree.posting_m(tile.level - step), low, high)
}

/// The model's heights on a grid; the mean where it has none within.
fn ground(body: &Body, map: &Gnomonic, grid: &Grid, dem: &GlobalDem) -> Result<Level, Error> {
    let mut heights_m = read(body, map, grid, dem)?;
    let gap = heights_m.iter().map(|height| height.is_nan()).collect();
    fill::continue_smoothly(&mut heights_m, grid.columns);
    fill::replace_missing(&mut heights_m, 0.5 * (dem.lowest_m + dem.highest_m));
    Ok(Level { gap, ..level(body, map, grid, &heights_m) })
}

/// Turns a level into the one that it lies on, as far as `weight` says.
fn turn(own: &mut Level, coarse: &Level, weight: impl Fn(DVec2) -> f64 + Sync) {
    let (columns, west_south_m, posting_m) = (own.columns, DVec2::new(own.west_m, own.south_m), own.posting_m);
    let far = DVec2::new((coarse.columns - 1) as f64, (coarse.rows - 1) as f64);
    own.heights_m.par_iter_mut().enumerate().for_each(|(index, height_m)| {
        let at_m = west_south_m + posting_m * DVec2::new((index % columns) as f64, (index / columns) as f64);
        let weight = weight(at_m);
        if weight < 1.0 {
            let grid = coarse.grid_from_map(at_m).clamp(DVec2::ZERO, far);
            let base_m = coarse.bilinear_m(grid).expect("clamped");
            *height_m = (base_m + weight * (f64::from(*height_m) - base_m)) as f32;
        }
    });
}

/// How much of a tile's own heights there is at a point of the map.
fn weight(tree: &QuadTree, tile: TileId, coarser_beside: &[bool; 8], at_m: DVec2) -> f64 {
    let cells = tree.cells as f64;
    // To rounding a node on the side is on it.
    let node =
        ((at_m - tree.node_m(tile, DVec2::ZERO)) / tree.posting_m(tile.level)).clamp(DVec2::ZERO, DVec2::splat(cells));
    let feather = 2.0 * FEATHER_POSTINGS;
    let away = |step: i8, at: f64| match step {
        -1 => at,
        1 => cells - at,
        _ => 0.0,
    };
    let distances = NEIGHBOURS.iter().zip(coarser_beside).filter(|(_, coarser)| **coarser);
    let distances = distances.map(|([east, north], _)| away(*east, node.x).max(away(*north, node.y)));
    smooth_step(distances.fold(feather, f64::min) / feather)
}
