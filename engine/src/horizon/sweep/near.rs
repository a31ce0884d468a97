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
//! and where `c₂t₂² < c₀ < c₂t₁²` the slope is largest inside the cell: `c₁ − 2√(c₀c₂)`. That square root is taken in the
//! first steps; beyond, the slope half way through the cell comes from `(H₁ + H₂)/2 − c₂(t₂ − t₁)²/4`, and a bound,
//! `|c₂|(t₂ − t₁)²/16t₁` above the sampled slopes, says where a cell is worth the root after all. In the receiver's own
//! cell `c₀ = 0`, and the slope's limit at distance 0 is the facet's, `c₁`.

use super::grid::{HeightGrid, NEVER_M};
use super::ray::Ray;
use crate::horizon::lanes::{LANES, lanes, larger};
use crate::horizon::wide::wide;

/// Major steps of the exact near field.
pub const NEAR: usize = 16;
/// Major steps within which the surface between two crossings is always searched exactly.
const EXACT: f64 = 2.0;

/// A crossing of a grid line, with the cell passed on the way to it.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    /// Offsets of the two nodes beside it, and the weight of the second.
    nodes: [isize; 2],
    fraction: f32,
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
    /// By how much a twist of 1 may raise a slope in between above the three.
    hump: f32,
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
    pub fn new(grid: &HeightGrid, ray: &Ray, reach: usize, on_ground: bool) -> Self {
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
    fn new(grid: &HeightGrid, ray: &Ray, from: f64, to: f64) -> Self {
        let node = |u: f64, v: f64| u as isize * grid.stride as isize + v as isize;
        let (u, v) = (ray.sign as f64 * to, ray.minor * to);
        let near = |value: f64| (value - value.round()).abs() < 1e-6;
        let (nodes, fraction) = if near(u) {
            let low = if near(v) { v.round() } else { v.floor() };
            ([node(u.round(), low), node(u.round(), low + 1.0)], (v - low).max(0.0))
        } else {
            let low = u.floor();
            ([node(low, v.round()), node(low + 1.0, v.round())], u - low)
        };
        let fraction = if fraction < 1e-6 { 0.0 } else { fraction as f32 };
        let middle = 0.5 * (from + to);
        let cell = node((ray.sign as f64 * middle).floor(), (ray.minor * middle).floor());
        let bulge = -0.25 * (to - from) * (to - from) * ray.sign as f64 * ray.minor;
        Self {
            nodes,
            fraction,
            inverse: (1.0 / to) as f32,
            cell,
            enter: from as f32,
            enter_squared: (from * from) as f32,
            leave_squared: (to * to) as f32,
            sum: (from + to) as f32,
            inverse_run: (1.0 / (to - from)) as f32,
            middle: [(0.5 / middle) as f32, (bulge / middle) as f32],
            hump: (bulge.abs() / (4.0 * from.max(0.1))) as f32,
        }
    }
}

/// The receivers of a row, from node `at` on, and what lies around them.
#[derive(Debug, Clone, Copy)]
pub struct Site<'a> {
    pub heights_m: &'a [f32],
    pub twists_m: &'a [f32],
    pub at: usize,
    pub observers_m: &'a [f32; LANES],
}

impl Site<'_> {
    /// Heights of the ground above the observers.
    #[inline(always)]
    fn ground_m(&self) -> [f32; LANES] {
        let mut ground_m = *lanes(self.heights_m, self.at, 0);
        for i in 0..LANES {
            // A gap's own height is filled.
            ground_m[i] = if ground_m[i] > NEVER_M { ground_m[i] - self.observers_m[i] } else { 0.0 };
        }
        ground_m
    }

    /// The steepest near slopes, in metres per major step, but for humps between crossings; and what they may be with those.
    #[inline(always)]
    pub fn slopes(&self, stencil: &Stencil) -> [[f32; LANES]; 2] {
        let observers_m = *self.observers_m;
        let mut best = [NEVER_M; LANES];
        let mut before = self.ground_m();
        let (exact, others) = stencil.crossings.split_at(stencil.exact);
        for (order, crossing) in exact.iter().enumerate() {
            self.pass_exactly(stencil, order, crossing, &mut before, &mut best);
        }
        let mut perhaps = best;
        for crossing in others {
            // Copies: nothing written below may be taken for one of them.
            let a = *lanes(self.heights_m, self.at, crossing.nodes[0]);
            let b = *lanes(self.heights_m, self.at, crossing.nodes[1]);
            let twist = *lanes(self.twists_m, self.at, crossing.cell);
            for i in 0..LANES {
                let here = crossing.rise_m(a[i], b[i], observers_m[i]);
                let middle = (before[i] + here).mul_add(crossing.middle[0], crossing.middle[1] * twist[i]);
                let sampled = larger(here * crossing.inverse, middle);
                best[i] = larger(best[i], sampled);
                perhaps[i] = larger(perhaps[i], crossing.hump.mul_add(twist[i].abs(), sampled));
                before[i] = here;
            }
        }
        [best, perhaps]
    }

    /// The steepest near slopes.
    #[inline(never)]
    pub fn exact_slopes(&self, stencil: &Stencil) -> [f32; LANES] {
        wide(
            #[inline(always)]
            || {
                let mut best = [NEVER_M; LANES];
                let mut before = self.ground_m();
                for (order, crossing) in stencil.crossings.iter().enumerate() {
                    self.pass_exactly(stencil, order, crossing, &mut before, &mut best);
                }
                best
            },
        )
    }

    #[inline(always)]
    fn pass_exactly(
        &self,
        stencil: &Stencil,
        order: usize,
        crossing: &Crossing,
        before: &mut [f32; LANES],
        best: &mut [f32; LANES],
    ) {
        let a = *lanes(self.heights_m, self.at, crossing.nodes[0]);
        let b = *lanes(self.heights_m, self.at, crossing.nodes[1]);
        let twist = *lanes(self.twists_m, self.at, crossing.cell);
        let own = order == 0 && stencil.on_ground;
        for i in 0..LANES {
            let here = crossing.rise_m(a[i], b[i], self.observers_m[i]);
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
}

impl Crossing {
    #[inline(always)]
    fn rise_m(&self, a: f32, b: f32, observer_m: f32) -> f32 {
        self.fraction.mul_add(b, (1.0 - self.fraction).mul_add(a, -observer_m))
    }
}
