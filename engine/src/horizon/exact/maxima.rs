//! Maxima of the surface along an azimuth's lines.
//!
//! `M₁[u][v]` holds the larger of the two nodes beside a line that passes row `u` between columns `v` and `v + 1`, and
//! as much as the cells before and behind may bulge over their chords. After `n` steps of minor `m` the line passes
//! between the columns `v + ⌊mn⌋` and two further on, wherever between `v` and `v + 1` it has started:
//!
//! ```text
//! M_L[u][v] = max over n = 0, l, 2l … L of  M_l[u ± n][v + ⌊mn⌋],  M_l[u ± n][v + ⌊mn⌋ + 1]
//! ```
//!
//! Every line has its own entry at every step, so that a group of receivers reads its bounds with one load. They are a
//! strip a few nodes wide, where a quad-tree's block is as wide as it is long.

use crate::horizon::sweep::grid::HeightGrid;
use crate::horizon::sweep::ray::Ray;
use crate::horizon::wide::wide;

/// Lengths of the stretches, in major steps.
pub const STEPS: [usize; 4] = [1, 8, 32, 128];

/// Tables for all [`STEPS`], laid out as the grid's heights.
#[derive(Debug)]
pub struct Maxima {
    pub tables: [Vec<f32>; STEPS.len()],
}

impl Maxima {
    pub fn new(grid: &HeightGrid, twists_m: &[f32], ray: &Ray) -> Self {
        let nodes = wide(
            #[inline(always)]
            || of_nodes(grid, twists_m, ray),
        );
        // A step has two ends.
        let single = longer(grid, ray, &nodes, 1, 2);
        let short = longer(grid, ray, &single, STEPS[0], STEPS[1] / STEPS[0]);
        let middle = longer(grid, ray, &short, STEPS[1], STEPS[2] / STEPS[1]);
        let long = longer(grid, ray, &middle, STEPS[2], STEPS[3] / STEPS[2]);
        Self { tables: [single, short, middle, long] }
    }
}

/// `M₁` of all rows.
#[inline(always)]
fn of_nodes(grid: &HeightGrid, twists_m: &[f32], ray: &Ray) -> Vec<f32> {
    // A parabola bulges by a quarter of its curvature over a run of at most a step.
    let bulge = (0.25001 * ray.minor.abs()) as f32;
    let mut maxima_m = grid.heights_m.clone();
    let length = grid.stride - 3;
    for u in 0..grid.majors {
        let row = grid.at(u, 0) - grid.pad;
        // Cells before and behind the row, of this column and its neighbours.
        let [below, above] = [row - grid.stride, row].map(|start| &twists_m[start..start + grid.stride]);
        let heights_m = &grid.heights_m[row..row + grid.stride];
        let out = &mut maxima_m[row..row + grid.stride];
        for v in 1..length {
            let mut twist_m = 0.0;
            for cells in [below, above] {
                for near in [cells[v - 1], cells[v], cells[v + 1]] {
                    let size_m = near.abs();
                    twist_m = if size_m > twist_m { size_m } else { twist_m };
                }
            }
            let (a, b) = (heights_m[v], heights_m[v + 1]);
            out[v] = if a > b { a } else { b } + bulge * twist_m;
        }
    }
    maxima_m
}

/// Maxima of stretches `count` times as long as those of `shorter`, which are `step` long.
fn longer(grid: &HeightGrid, ray: &Ray, shorter: &[f32], step: usize, count: usize) -> Vec<f32> {
    wide(
        #[inline(always)]
        || longer_plain(grid, ray, shorter, step, count),
    )
}

#[inline(always)]
fn longer_plain(grid: &HeightGrid, ray: &Ray, shorter: &[f32], step: usize, count: usize) -> Vec<f32> {
    let mut maxima_m = shorter.to_vec();
    let row = |u: isize| grid.at(0, 0) as isize - grid.pad as isize + u * grid.stride as isize;
    for u in 0..grid.majors as isize {
        let start = row(u) as usize;
        let out = &mut maxima_m[start..start + grid.stride];
        for n in 1..count {
            let ahead = u + ray.sign * (n * step) as isize;
            if !(0..grid.majors as isize).contains(&ahead) {
                break;
            }
            let start = row(ahead) as usize;
            let from = &shorter[start..start + grid.stride];
            let shift = (ray.minor * (n * step) as f64).floor() as isize;
            raise(out, from, shift);
        }
    }
    maxima_m
}

/// Raises `out[v]` to `from[v + shift]` and `from[v + shift + 1]` where there are such.
#[inline(always)]
fn raise(out: &mut [f32], from: &[f32], shift: isize) {
    let first = (-shift).max(0);
    let last = (from.len() as isize - 1 - shift).min(out.len() as isize);
    if first >= last {
        return;
    }
    let out = &mut out[first as usize..last as usize];
    let from = &from[(first + shift) as usize..(last + shift + 1) as usize];
    for (v, out) in out.iter_mut().enumerate() {
        let (a, b) = (from[v], from[v + 1]);
        let top = if a > b { a } else { b };
        *out = if top > *out { top } else { *out };
    }
}
