//! The near field: every crossing of the first cells, for many receivers at once.
//!
//! All receivers of an azimuth share the offsets and weights of their crossings, so that one crossing is a
//! few operations on contiguous heights. Between two crossings the surface is a parabola whose height in the
//! middle follows from the cell's twist `κ`:
//!
//! ```text
//! H(½(t₁ + t₂)) = ½(H₁ + H₂) − κ Δu Δv/4
//! ```
//!
//! Ends and middle stand for the parabola; what lies between them is missed by at most 1/16 of `κ`.
//! In the receiver's own cell the slope is linear in distance and its limit at 0 is the facet's.

use super::grid::{Grid, LANES, NEVER_M};
use super::ray::Ray;

/// A crossing of a grid line, with the cell passed on the way to it.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    /// Offsets of the two nodes beside it, and their shares.
    nodes: [isize; 2],
    shares: [f32; 2],
    /// One over the distance in major steps, here and in the middle of the cell before.
    inverse: f32,
    inverse_middle: f32,
    /// Offset of the cell's twist, and `Δu Δv/4`.
    cell: isize,
    bend: f32,
}

/// All crossings of one azimuth up to a reach.
#[derive(Debug)]
pub struct Stencil {
    crossings: Vec<Crossing>,
    /// `Δu Δv` per square major step times the distance of the first crossing: the fall of the slope over the
    /// receiver's own cell. `None` for a raised observer, who does not stand on his facet.
    facet: Option<f32>,
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
        let twist = ray.sign as f64 * ray.minor;
        let facet = on_ground.then(|| (twist * steps.first().copied().unwrap_or(0.0)) as f32);
        let from = std::iter::once(0.0).chain(steps.iter().copied());
        let crossings = from.zip(&steps).map(|(from, to)| Crossing::new(grid, ray, from, *to)).collect();
        Self { crossings, facet }
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
        Self {
            nodes,
            shares: [1.0 - share, share],
            inverse: (1.0 / to) as f32,
            inverse_middle: (1.0 / middle) as f32,
            cell,
            bend: (0.25 * (to - from).powi(2) * ray.sign as f64 * ray.minor) as f32,
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
    let lanes = |array: &[f32], offset: isize| -> [f32; LANES] {
        let start = at.wrapping_add_signed(offset);
        array[start..start + LANES].try_into().expect("a slice of LANES")
    };
    let mut best = [NEVER_M; LANES];
    let mut before = lanes(heights_m, 0);
    let mut facet = stencil.facet;
    for crossing in &stencil.crossings {
        let [a, b] = crossing.nodes.map(|node| lanes(heights_m, node));
        let twist = lanes(twists_m, crossing.cell);
        let [share_a, share_b] = crossing.shares;
        for i in 0..LANES {
            let here = share_a * a[i] + share_b * b[i];
            let middle = 0.5 * (here + before[i]) - crossing.bend * twist[i];
            let slope = (here - observers_m[i]) * crossing.inverse;
            let inner = (middle - observers_m[i]) * crossing.inverse_middle;
            best[i] = larger(best[i], larger(slope, inner));
            before[i] = here;
        }
        if let Some(fall) = facet.take() {
            for i in 0..LANES {
                best[i] = larger(best[i], best_facet(before[i] - observers_m[i], crossing.inverse, fall * twist[i]));
            }
        }
    }
    best
}

/// The facet's slope from its first crossing: the slope there less what the twist added.
#[inline(always)]
fn best_facet(rise_m: f32, inverse: f32, fall: f32) -> f32 {
    rise_m * inverse - fall
}

/// The larger of two numbers, the first where one of them is NaN; one instruction.
#[inline(always)]
pub fn larger(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}
