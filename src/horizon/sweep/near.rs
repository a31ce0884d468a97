//! The near field: every crossing of the first cells, for many receivers at once.
//!
//! All receivers of an azimuth share the offsets and weights of their crossings, so that one crossing is a
//! few operations on contiguous heights. Between two crossings the surface is a parabola that follows from
//! its ends and the cell's twist `κ`: with `t` in major steps and `m` the minor step,
//!
//! ```text
//! H(t) − H₀ = c₀ + c₁t + c₂t²      c₂ = κm   c₁ = (H₂ − H₁)/(t₂ − t₁) − c₂(t₁ + t₂)   c₀ = H₁ − H₀ − c₁t₁ − c₂t₁²
//! ```
//!
//! and where `c₂t₂² < c₀ < c₂t₁²` the slope is largest inside the cell: `c₁ − 2√(c₀c₂)`.
//! In the receiver's own cell `c₀ = 0`, and the slope's limit at distance 0 is the facet's, `c₁`.

use super::grid::{Grid, LANES, NEVER_M};
use super::ray::Ray;

/// Major steps within which the surface between two crossings is searched exactly, and not in its middle.
const EXACT: f64 = 4.0;

/// A crossing of a grid line, with the cell passed on the way to it.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    /// Offsets of the two nodes beside it, and the share of the second.
    nodes: [isize; 2],
    share: f32,
    /// One over the distance in major steps.
    inverse: f32,
    /// Offset of the twist of the cell before.
    cell: isize,
    /// Distance at which that cell is entered, its square, that of leaving it squared, their sum, and one over their difference.
    enter: f32,
    enter_squared: f32,
    leave_squared: f32,
    sum: f32,
    inverse_run: f32,
    /// The slope half way: of the heights at both ends, and of the twist.
    middle: [f32; 2],
}

/// All crossings of one azimuth up to a reach.
#[derive(Debug)]
pub struct Stencil {
    crossings: Vec<Crossing>,
    /// How many of them are exact.
    exact: usize,
    /// `c₂` of a cell with a twist of 1.
    bend: f32,
    /// A raised observer does not stand on his facet.
    on_ground: bool,
}

impl Stencil {
    /// Crossings up to `reach` major steps away.
    pub fn new(grid: &Grid, ray: &Ray, reach: usize, on_ground: bool) -> Self {
        let mut steps: Vec<f64> = (1..=reach).map(|n| n as f64).collect();
        if ray.minor != 0.0 {
            steps.extend((1..).map(|j| f64::from(j) / ray.minor.abs()).take_while(|step| *step <= reach as f64));
        }
        steps.sort_by(f64::total_cmp);
        steps.dedup_by(|a, b| *a - *b < 1e-6);
        let limit = ray.search_steps;
        steps.retain(|step| *step <= limit);
        let from = std::iter::once(0.0).chain(steps.iter().copied());
        let crossings = from.zip(&steps).map(|(from, to)| Crossing::new(grid, ray, from, *to)).collect();
        let exact = steps.iter().filter(|step| **step <= EXACT).count();
        Self { crossings, exact, bend: (ray.sign as f64 * ray.minor) as f32, on_ground }
    }
}

impl Crossing {
    fn new(grid: &Grid, ray: &Ray, from: f64, to: f64) -> Self {
        let node = |u: f64, v: f64| u as isize * grid.stride as isize + v as isize;
        let (u, v) = (ray.sign as f64 * to, ray.minor * to);
        let near = |value: f64| (value - value.round()).abs() < 1e-6;
        let (nodes, share) = if near(u) {
            let low = if near(v) { v.round() } else { v.floor() };
            ([node(u.round(), low), node(u.round(), low + 1.0)], (v - low).max(0.0))
        } else {
            let low = u.floor();
            ([node(low, v.round()), node(low + 1.0, v.round())], u - low)
        };
        let share = if share < 1e-6 { 0.0 } else { share as f32 };
        let middle = 0.5 * (from + to);
        let cell = node((ray.sign as f64 * middle).floor(), (ray.minor * middle).floor());
        let bulge = -0.25 * (to - from) * (to - from) * ray.sign as f64 * ray.minor;
        Self {
            nodes,
            share,
            inverse: (1.0 / to) as f32,
            cell,
            enter: from as f32,
            enter_squared: (from * from) as f32,
            leave_squared: (to * to) as f32,
            sum: (from + to) as f32,
            inverse_run: (1.0 / (to - from)) as f32,
            middle: [(0.5 / middle) as f32, (bulge / middle) as f32],
        }
    }
}

/// The steepest near slope of `LANES` receivers from node `at` on, in metres per major step.
#[inline(always)]
pub fn slopes(
    heights_m: &[f32],
    twists_m: &[f32],
    stencil: &Stencil,
    at: usize,
    observers_m: &[f32; LANES],
) -> [f32; LANES] {
    let mut best = [NEVER_M; LANES];
    let mut before = *lanes(heights_m, at, 0);
    for i in 0..LANES {
        // A gap's own height is filled.
        before[i] = if before[i] > NEVER_M { before[i] - observers_m[i] } else { 0.0 };
    }
    let (exact, others) = stencil.crossings.split_at(stencil.exact);
    for (order, crossing) in exact.iter().enumerate() {
        let a = lanes(heights_m, at, crossing.nodes[0]);
        let b = lanes(heights_m, at, crossing.nodes[1]);
        let twist = lanes(twists_m, at, crossing.cell);
        let own = order == 0 && stencil.on_ground;
        for i in 0..LANES {
            let here = crossing.rise_m(a[i], b[i], observers_m[i]);
            let c2 = stencil.bend * twist[i];
            let c1 = (here - before[i]) * crossing.inverse_run - c2 * crossing.sum;
            let c0 = before[i] - c1 * crossing.enter - c2 * crossing.enter_squared;
            let peaks = (c0 < c2 * crossing.enter_squared) & (c0 > c2 * crossing.leave_squared);
            let inner = c1 - 2.0 * (c0 * c2).sqrt();
            let inner = if peaks { inner } else { NEVER_M };
            let inner = if own { c1 } else { inner };
            best[i] = larger(larger(best[i], here * crossing.inverse), inner);
            before[i] = here;
        }
    }
    for crossing in others {
        let a = lanes(heights_m, at, crossing.nodes[0]);
        let b = lanes(heights_m, at, crossing.nodes[1]);
        let twist = lanes(twists_m, at, crossing.cell);
        for i in 0..LANES {
            let here = crossing.rise_m(a[i], b[i], observers_m[i]);
            let middle = (before[i] + here).mul_add(crossing.middle[0], crossing.middle[1] * twist[i]);
            best[i] = larger(larger(best[i], here * crossing.inverse), middle);
            before[i] = here;
        }
    }
    best
}

impl Crossing {
    #[inline(always)]
    fn rise_m(&self, a: f32, b: f32, observer_m: f32) -> f32 {
        self.share.mul_add(b, (1.0 - self.share).mul_add(a, -observer_m))
    }
}

#[inline(always)]
fn lanes(array: &[f32], at: usize, offset: isize) -> &[f32; LANES] {
    let start = at.wrapping_add_signed(offset);
    array[start..start + LANES].first_chunk().expect("a slice of LANES")
}

/// The larger of two numbers, the first where one of them is NaN; one instruction.
#[inline(always)]
pub fn larger(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}
