//! The surface along a receiver's own line, near a distance where its skyline is suspected.
//!
//! All receivers lie on nodes, so that the crossings of their lines have the same offsets and weights, and
//! a table of them serves a whole azimuth. From a suspected distance the slope is climbed to its local
//! maximum over whole steps; the two steps beside it are then searched exactly, as in `near`.

use super::grid::{HeightGrid, NEVER_M};
use super::ray::Ray;
use crate::horizon::lanes::larger;

/// The crossings of one major step.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// Offset of the lower node at the end of the step, and the weight of the upper one.
    node: isize,
    fraction: f32,
    inverse: f32,
    /// Where a minor grid line is crossed on the way: offset, weight of the node at the far end, and distance in steps.
    column: Option<(isize, f32, f32)>,
    /// Offsets of the cells passed on the way: before and after that crossing.
    cells: [isize; 2],
}

/// Crossings of every step along one azimuth.
#[derive(Debug)]
pub struct Profile {
    steps: Vec<Step>,
    sign: isize,
    minor: f64,
    search_steps: f64,
    /// Steps before this one do not count.
    near: usize,
    /// `c₂` of a cell with a twist of 1.
    bend: f32,
}

impl Profile {
    /// Crossings along an azimuth, those before step `near` left out.
    pub fn new(grid: &HeightGrid, ray: &Ray, near: usize) -> Self {
        let stride = grid.stride as isize * ray.sign;
        let steps = (0..grid.majors as isize).map(|n| {
            let v = ray.minor * n as f64;
            let before = v - ray.minor;
            let low = (v + 1e-9).floor();
            let column = before.max(v).floor();
            let crosses = n > 0 && column > before.min(v) + 1e-9 && column < before.max(v) - 1e-9;
            let on_the_way = crosses.then(|| {
                let part = (column - before) / ray.minor;
                (stride * (n - 1) + column as isize, part as f32, ((n - 1) as f64 + part) as f32)
            });
            let cell = |at: f64| {
                let along = if ray.sign > 0 { n - 1 } else { -n };
                grid.stride as isize * along + (ray.minor * at).floor() as isize
            };
            let middle = on_the_way.map_or(n as f64 - 0.5, |(_, part, _)| n as f64 - 1.0 + 0.5 * f64::from(part));
            let after = on_the_way.map_or(middle, |(_, part, _)| n as f64 - 0.5 + 0.5 * f64::from(part));
            Step {
                cells: [cell(middle), cell(after)],
                node: stride * n + low as isize,
                fraction: (v - low).max(0.0) as f32,
                inverse: (1.0 / n as f64) as f32,
                column: on_the_way,
            }
        });
        Self {
            steps: steps.collect(),
            sign: ray.sign,
            minor: ray.minor,
            search_steps: ray.search_steps,
            near,
            bend: (ray.sign as f64 * ray.minor) as f32,
        }
    }

    /// Steps from node (u, v) to the end of the grid or of the search.
    pub fn reach(&self, grid: &HeightGrid, u: isize, v: usize) -> usize {
        let majors = if self.sign > 0 { grid.majors as isize - 1 - u } else { u };
        let minors = if self.minor > 0.0 { grid.minors - 1 - v } else { v };
        let minors = if self.minor == 0.0 { f64::INFINITY } else { minors as f64 / self.minor.abs() };
        (majors as f64).min(minors + 1e-9).min(self.search_steps) as usize
    }

    /// The steepest slope, per major step, near some of the distances `steps`, those beyond `reach` moved there.
    pub fn slope(
        &self,
        grid: &HeightGrid,
        u: isize,
        v: usize,
        observer_m: f32,
        steps: [usize; 2],
        reach: usize,
    ) -> f32 {
        if reach < self.near.max(1) {
            return NEVER_M;
        }
        let view = View { profile: self, grid, at: grid.at(u as usize, v), observer_m, reach };
        let [a, b] = steps.map(|step| step.clamp(self.near.max(1), reach));
        if a.abs_diff(b) < 2 { view.climb(a) } else { larger(view.climb(a), view.climb(b)) }
    }
}

/// One receiver's line.
struct View<'a> {
    profile: &'a Profile,
    grid: &'a HeightGrid,
    at: usize,
    observer_m: f32,
    reach: usize,
}

impl View<'_> {
    fn mix(&self, low: isize, high: isize, fraction: f32) -> f32 {
        let node = |offset: isize| self.grid.heights_m[self.at.wrapping_add_signed(offset)];
        (1.0 - fraction) * node(low) + fraction * node(high) - self.observer_m
    }

    fn rise_m(&self, n: usize) -> f32 {
        let step = &self.profile.steps[n];
        self.mix(step.node, step.node + 1, step.fraction)
    }

    fn slope(&self, n: usize) -> f32 {
        self.rise_m(n) * self.profile.steps[n].inverse
    }

    fn climb(&self, from: usize) -> f32 {
        let (mut top, mut best) = (from, self.slope(from));
        while top < self.reach {
            let next = self.slope(top + 1);
            if next <= best {
                break;
            }
            (top, best) = (top + 1, next);
        }
        if top == from {
            while top > self.profile.near.max(1) {
                let next = self.slope(top - 1);
                if next <= best {
                    break;
                }
                (top, best) = (top - 1, next);
            }
        }
        if top > self.profile.near {
            best = larger(best, self.inside(top));
        }
        match self.profile.steps.get(top + 1) {
            Some(_) if top < self.reach => larger(best, self.inside(top + 1)),
            Some(step) => larger(best, self.last(step)),
            None => best,
        }
    }

    /// The slope to where the line leaves the grid across its last column, before the end of a step.
    fn last(&self, step: &Step) -> f32 {
        let stride = self.grid.stride as isize * self.profile.sign;
        match step.column {
            Some((node, fraction, at)) if f64::from(at) <= self.profile.search_steps => {
                self.mix(node, node + stride, fraction) / at
            }
            _ => NEVER_M,
        }
    }

    /// The steepest slope inside the step that ends at `n`.
    fn inside(&self, n: usize) -> f32 {
        let step = &self.profile.steps[n];
        let (before, after) = ((n - 1) as f32, n as f32);
        let ends = [self.rise_m(n - 1), self.rise_m(n)];
        let Some((node, fraction, at)) = step.column else {
            return self.peak(step.cells[0], [before, after], ends);
        };
        let stride = self.grid.stride as isize * self.profile.sign;
        let middle_m = self.mix(node, node + stride, fraction);
        let entering = self.peak(step.cells[0], [before, at], [ends[0], middle_m]);
        larger(entering, self.peak(step.cells[1], [at, after], [middle_m, ends[1]]))
    }

    /// The steepest slope in a cell passed between two distances, its near end excluded.
    fn peak(&self, cell: isize, [a, b]: [f32; 2], rises_m: [f32; 2]) -> f32 {
        let stride = self.grid.stride as isize;
        let node = |offset: isize| self.grid.heights_m[self.at.wrapping_add_signed(cell + offset)];
        let c2 = (node(0) - node(stride) - node(1) + node(stride + 1)) * self.profile.bend;
        let c1 = (rises_m[1] - rises_m[0]) / (b - a) - c2 * (a + b);
        let c0 = rises_m[0] - c1 * a - c2 * a * a;
        if c0 < c2 * a * a && c0 > c2 * b * b { c1 - 2.0 * (c0 * c2).sqrt() } else { rises_m[1] / b }
    }
}
