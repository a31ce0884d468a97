//! The surface along a receiver's own line, near a distance where its skyline is suspected.
//!
//! All receivers lie on nodes, so that the crossings of their lines have the same offsets and weights, and
//! a table of them serves a whole azimuth. From a suspected distance the slope is climbed to its local
//! maximum over whole steps; the two steps beside it are then searched exactly, as in `near`.

use super::grid::Grid;
use super::near::larger;
use super::ray::Ray;

/// The crossings of one major step.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// Offset of the lower node at the end of the step, and the share of the upper one.
    node: isize,
    share: f32,
    inverse: f32,
    /// Where a minor grid line is crossed on the way: offset, share of the node at the far end, and distance in steps.
    column: Option<(isize, f32, f32)>,
}

/// Crossings of every step along one azimuth.
#[derive(Debug)]
pub struct Profile {
    steps: Vec<Step>,
    sign: isize,
    minor: f64,
}

impl Profile {
    pub fn new(grid: &Grid, ray: &Ray) -> Self {
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
            Step {
                node: stride * n + low as isize,
                share: (v - low).max(0.0) as f32,
                inverse: (1.0 / n as f64) as f32,
                column: on_the_way,
            }
        });
        Self { steps: steps.collect(), sign: ray.sign, minor: ray.minor }
    }

    /// Steps from node (u, v) to the end of the grid.
    fn reach(&self, grid: &Grid, u: isize, v: usize) -> usize {
        let majors = if self.sign > 0 { grid.majors as isize - 1 - u } else { u };
        let minors = if self.minor > 0.0 { grid.minors - 1 - v } else { v };
        let minors = if self.minor == 0.0 { f64::INFINITY } else { minors as f64 / self.minor.abs() };
        (majors as f64).min(minors + 1e-9) as usize
    }

    /// The steepest slope, per major step, near some of the distances `steps`; `None` if all lie beyond the grid.
    pub fn slope(&self, grid: &Grid, u: isize, v: usize, observer_m: f32, steps: [usize; 2]) -> Option<f32> {
        let reach = self.reach(grid, u, v);
        let at = grid.at(u as usize, v);
        let view = View { profile: self, grid, at, observer_m, reach };
        let inside = |n: usize| n >= 1 && n <= reach;
        let close = steps[0].abs_diff(steps[1]) < 2;
        match steps.map(inside) {
            [true, true] if close => Some(view.climb(steps[0])),
            [true, true] => Some(larger(view.climb(steps[0]), view.climb(steps[1]))),
            [true, false] => Some(view.climb(steps[0])),
            [false, true] => Some(view.climb(steps[1])),
            [false, false] => None,
        }
    }
}

/// One receiver's line.
struct View<'a> {
    profile: &'a Profile,
    grid: &'a Grid,
    at: usize,
    observer_m: f32,
    reach: usize,
}

impl View<'_> {
    fn mix(&self, low: isize, high: isize, share: f32) -> f32 {
        let node = |offset: isize| self.grid.heights_m[self.at.wrapping_add_signed(offset)];
        (1.0 - share) * node(low) + share * node(high) - self.observer_m
    }

    fn rise_m(&self, n: usize) -> f32 {
        let step = &self.profile.steps[n];
        self.mix(step.node, step.node + 1, step.share)
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
            while top > 1 {
                let next = self.slope(top - 1);
                if next <= best {
                    break;
                }
                (top, best) = (top - 1, next);
            }
        }
        best = larger(best, self.inside(top));
        if top < self.reach { larger(best, self.inside(top + 1)) } else { best }
    }

    /// The steepest slope inside the step that ends at `n`.
    fn inside(&self, n: usize) -> f32 {
        let stride = self.grid.stride as isize * self.profile.sign;
        let (before, after) = ((n - 1) as f32, n as f32);
        let ends = [self.rise_m(n - 1), self.rise_m(n)];
        let Some((node, share, at)) = self.profile.steps[n].column else {
            return self.peak(before, ends[0], after, ends[1]);
        };
        let middle_m = self.mix(node, node + stride, share);
        let slope = middle_m / at;
        let peaks = larger(self.peak(before, ends[0], at, middle_m), self.peak(at, middle_m, after, ends[1]));
        larger(slope, peaks)
    }

    /// The slope's maximum inside one cell between distances `a` and `b`, or a value it reaches there.
    fn peak(&self, a: f32, rise_a: f32, b: f32, rise_b: f32) -> f32 {
        let middle = 0.5 * f64::from(a + b);
        let along = middle as isize;
        let across = (self.profile.minor * middle).floor() as isize;
        let along = if self.profile.sign > 0 { along } else { -along - 1 };
        let stride = self.grid.stride as isize;
        let corner = (along * stride + across) as isize;
        let node = |offset: isize| self.grid.heights_m[self.at.wrapping_add_signed(corner + offset)];
        let twist_m = node(0) - node(stride) - node(1) + node(stride + 1);
        let c2 = twist_m * (self.profile.sign as f64 * self.profile.minor) as f32;
        let c1 = (rise_b - rise_a) / (b - a) - c2 * (a + b);
        let c0 = rise_a - c1 * a - c2 * a * a;
        if c0 < c2 * a * a && c0 > c2 * b * b { c1 - 2.0 * (c0 * c2).sqrt() } else { rise_b / b }
    }
}
