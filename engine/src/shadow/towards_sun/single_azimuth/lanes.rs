//! The same loop for nodes side by side in a row, in `f32`.
//!
//! Nodes that share a direction and a distance sample one row of cells: a row of heights is mixed once, and each
//! node takes its place in it. A line ends before its level where nothing that is left can rise above its skyline, which
//! changes nothing.

use glam::{DVec2, DVec3};

use super::reference::exit_m;
use crate::horizon::Settings;
use crate::horizon::sphere::skyline_beyond;
use crate::horizon::wide::wide;
use crate::terrain::{Gnomonic, Level, Surface};

/// Nodes side by side.
pub const LANES: usize = 16;

/// Azimuths nearer than this are one: 1/46 of the Sun's radius.
pub const ALIKE_RAD: f64 = 1e-4;

/// Steps between two looks at whether anything that is left matters.
const LOOK: usize = 32;

/// What never occludes.
const ABSENT_M: f32 = -1e30;
/// Below it something absent has a share in a height.
const SHARED_M: f32 = -1e20;

/// A level's heights above a datum, with columns of [`ABSENT_M`] on both sides.
#[derive(Debug)]
struct Heights<'a> {
    level: &'a Level,
    stride: usize,
    heights_m: Vec<f32>,
    /// The highest of this level and the coarser ones.
    top_m: f32,
}

/// Columns beside a level: a block of nodes may hang over by all but one of its lanes, and the next cell.
const PAD: usize = LANES + 1;

/// All lines over a level and those coarser ones.
#[derive(Debug)]
pub struct Lines<'a> {
    map: &'a Gnomonic,
    levels: Vec<Heights<'a>>,
    datum_m: f64,
    spacing: f64,
    settings: Settings,
}

impl<'a> Lines<'a> {
    pub fn new(surface: &'a Surface, face: usize, level: usize, spacing: f64, settings: &Settings) -> Self {
        let (terrain, pyramids) = (&surface.terrain.faces[face], &surface.pyramids[face]);
        let nodes = &terrain.levels[level];
        let datum_m = f64::from(nodes.heights_m[nodes.index(nodes.columns / 2, nodes.rows / 2)]);
        let heights = |index: usize| {
            let top_m = pyramids[index..].iter().map(|pyramid| pyramid.top_m()).fold(f64::MIN, f64::max);
            Heights::new(&terrain.levels[index], datum_m, (top_m - datum_m) as f32)
        };
        let levels = (level..terrain.levels.len()).map(heights).collect();
        Self { map: &terrain.map, levels, datum_m, spacing, settings: *settings }
    }

    pub fn map(&self) -> &Gnomonic {
        self.map
    }

    /// Columns and rows of the seen nodes.
    pub fn seen(&self) -> (usize, usize) {
        let level = self.levels[0].level;
        level.seen_size().into()
    }

    /// Lifted point of the ground at a seen node.
    pub fn point(&self, [column, row]: [usize; 2]) -> DVec3 {
        let level = self.levels[0].level;
        level.lifted_node(column + level.margin, row + level.margin)
    }

    /// Elevations of the skyline in a unit map direction at `count` seen nodes from `first` on.
    pub fn elevations_rad(&self, first: [usize; 2], count: usize, towards: DVec2) -> [f64; LANES] {
        let point = |lane: usize| self.point([first[0] + lane.min(count - 1), first[1]]);
        let observer = |lane: usize| match self.settings.observer_height_m {
            0.0 => point(lane),
            height_m => {
                let point = point(lane);
                let radius_m = self.map.radius_from_lifted_m(point) + height_m;
                point.truncate().extend(self.map.lifted_height_m(point.truncate(), radius_m))
            }
        };
        let observers: [DVec3; LANES] = std::array::from_fn(observer);
        let mut block = Block {
            first_m: observers[0].truncate(),
            towards,
            observers_m: observers.map(|observer| (observer.z - self.datum_m) as f32),
            steepest: [f32::MIN; LANES],
            from_m: [0.0; LANES],
        };
        let reach_m = self.settings.search_m.unwrap_or(f64::INFINITY);
        for (order, heights) in self.levels.iter().enumerate() {
            let ends_m = observers.map(|observer| exit_m(heights.level, observer.truncate(), towards));
            let posting_m = self.levels[0].level.posting_m;
            wide(
                #[inline(always)]
                || block.pass(heights, order == 0, posting_m, self.spacing, ends_m, reach_m),
            );
        }
        std::array::from_fn(|lane| {
            let observer = observers[lane];
            let (beyond, _) = skyline_beyond(self.map, observer, towards, block.from_m[lane]);
            let slope = f64::from(block.steepest[lane]).max(beyond);
            self.map.elevation_tangent(observer, towards, slope).atan()
        })
    }
}

impl<'a> Heights<'a> {
    fn new(level: &'a Level, datum_m: f64, top_m: f32) -> Self {
        let stride = level.columns + 2 * PAD;
        let mut heights_m = vec![ABSENT_M; stride * level.rows];
        for row in 0..level.rows {
            for column in 0..level.columns {
                let node = level.index(column, row);
                if !level.gap[node] {
                    let height_m = f64::from(level.heights_m[node]) - datum_m;
                    heights_m[row * stride + column + PAD] = height_m as f32;
                }
            }
        }
        Self { level, stride, heights_m, top_m }
    }

    /// Heights of `count` neighbouring columns from `column` on, at grid row `y`; columns may lie beside the level.
    #[inline(always)]
    fn mixed_m(&self, column: isize, count: usize, y: f64, row_m: &mut [f32; LANES + 2]) {
        let low = (y.max(0.0) as usize).min(self.level.rows - 2);
        let share = share(y - low as f64);
        let pad = PAD as isize;
        let start = low * self.stride + (column.clamp(-pad, self.level.columns as isize) + pad) as usize;
        let near = &self.heights_m[start..start + count];
        let far = &self.heights_m[start + self.stride..start + self.stride + count];
        for i in 0..count {
            row_m[i] = (1.0 - share) * near[i] + share * far[i];
        }
    }
}

/// The larger part of nothing is nothing: beside a gap rounding must not make one of it.
#[inline(always)]
fn share(share: f64) -> f32 {
    match share {
        share if share < 1e-6 => 0.0,
        share if share > 1.0 - 1e-6 => 1.0,
        share => share as f32,
    }
}

/// Nodes side by side that look in one direction.
struct Block {
    /// Map point of the first node.
    first_m: DVec2,
    towards: DVec2,
    observers_m: [f32; LANES],
    steepest: [f32; LANES],
    /// Where the finer level ends for each node.
    from_m: [f64; LANES],
}

impl Block {
    /// Samples one level from where the finer one ends to where it ends itself.
    #[inline(always)]
    fn pass(&mut self, heights: &Heights, own: bool, posting_m: f64, spacing: f64, ends_m: [f64; LANES], reach_m: f64) {
        let level = heights.level;
        let step_m = spacing * level.posting_m;
        let least = |values: &[f64; LANES]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let last_m = ends_m.iter().copied().fold(0.0, f64::max).min(reach_m);
        let first = (least(&self.from_m) / step_m).floor() as usize + 1;
        // In columns of this level.
        let lane_step = posting_m / level.posting_m;
        for k in first.. {
            let t_m = k as f64 * step_m;
            if t_m > last_m || k % LOOK == 0 && self.is_above_all(heights.top_m, t_m) {
                break;
            }
            let grid = level.grid_from_map(self.first_m + t_m * self.towards);
            let heights_m = if own { neighbours(heights, grid) } else { spread(heights, grid, lane_step) };
            let inverse = (1.0 / t_m) as f32;
            for lane in 0..LANES {
                let slope = (heights_m[lane] - self.observers_m[lane]) * inverse;
                let slope = if t_m > self.from_m[lane] && t_m <= ends_m[lane] { slope } else { f32::MIN };
                let slope = if heights_m[lane] > SHARED_M { slope } else { f32::MIN };
                self.steepest[lane] = self.steepest[lane].max(slope);
            }
        }
        for (from_m, end_m) in self.from_m.iter_mut().zip(ends_m) {
            *from_m = from_m.max(end_m);
        }
    }

    /// Whether no height up to `top_m` beyond a distance stands above any node's skyline.
    #[inline(always)]
    fn is_above_all(&self, top_m: f32, t_m: f64) -> bool {
        let inverse = (1.0 / t_m) as f32;
        (0..LANES).all(|lane| {
            let rise_m = top_m - self.observers_m[lane];
            rise_m * if rise_m > 0.0 { inverse } else { 0.0 } < self.steepest[lane]
        })
    }
}

/// Heights at grid points a column apart.
#[inline(always)]
fn neighbours(heights: &Heights, grid: DVec2) -> [f32; LANES] {
    let column = grid.x.floor();
    let mut row_m = [0.0; LANES + 2];
    heights.mixed_m(column as isize, LANES + 1, grid.y, &mut row_m);
    let share = share(grid.x - column);
    std::array::from_fn(|lane| (1.0 - share) * row_m[lane] + share * row_m[lane + 1])
}

/// Heights at grid points less than a column apart.
#[inline(always)]
fn spread(heights: &Heights, grid: DVec2, lane_step: f64) -> [f32; LANES] {
    let column = grid.x.floor();
    let first = (grid.x - column) as f32;
    let mut row_m = [0.0; LANES + 2];
    let count = (first + (LANES - 1) as f32 * lane_step as f32) as usize + 2;
    heights.mixed_m(column as isize, count, grid.y, &mut row_m);
    std::array::from_fn(|lane| {
        let at = first + lane as f32 * lane_step as f32;
        let low = (at as usize).min(LANES);
        let share = at - low as f32;
        (1.0 - share) * row_m[low] + share * row_m[low + 1]
    })
}
