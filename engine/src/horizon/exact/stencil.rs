//! Every crossing of an azimuth's lines with the grid's, for many receivers at once.
//!
//! From one crossing to the next, `run` steps on, the surface along a line is a parabola over its chord. With `τ` the
//! distance from the nearer crossing at distance `e`, rise `h` there and `h'` at the farther one, and the cell's twist `κ`:
//!
//! ```text
//! H(τ) − H₀ = h + bτ + c τ²      c = ± κ m      b = (h' − h)/run − c run
//! ```
//!
//! Where `c < 0` it bulges by no more than `−c run²/4`, which few receivers need to care about; the slope is largest at
//!
//! ```text
//! τ = q/(e + √(e² + q))          q = (h − b e)/c
//! ```
//!
//! if that lies within the run. In the receiver's own cell the slope's limit at distance 0 is the facet's, `b`.
//! Rises are differences of nodes before they are weighted: what rounds is the rise, not the height.

use crate::horizon::lanes::{LANES, lanes, larger};
use crate::horizon::sweep::grid::{HeightGrid, NEVER_M};
use crate::horizon::sweep::ray::Ray;

/// Shares of a node below this are none: it must not count as a gap's neighbour by rounding. As in the trace.
const NO_SHARE: f64 = 1e-6;

/// A crossing of a grid line, with the cell passed on the way to it. Distances are in major steps.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    /// Offsets of the two nodes beside it, and the weights of both.
    nodes: [isize; 2],
    weights: [f32; 2],
    inverse: f32,
    /// Offset of the cell before it.
    cell: isize,
    /// Distances of the crossing before and of this one, and between them.
    enter: f32,
    leave: f32,
    run: f32,
    inverse_run: f32,
    /// How much a cell with a curvature of −1 along the line bulges over the chord.
    bulge: f32,
}

/// All crossings of one azimuth.
#[derive(Debug)]
pub struct Stencil {
    crossings: Vec<Crossing>,
    /// Where the crossings beyond `n` steps begin.
    beyond: Vec<usize>,
    /// Offset of the lower of the two nodes beside a line after `n` steps.
    pub rows: Vec<isize>,
    /// `c` of a cell with a twist of 1.
    bend: f32,
    /// A raised observer does not stand on his facet.
    on_ground: bool,
}

impl Stencil {
    /// Crossings up to the grid's length.
    pub fn new(grid: &HeightGrid, ray: &Ray, on_ground: bool) -> Self {
        let (mut crossings, mut beyond, mut rows) = (Vec::new(), vec![0], Vec::new());
        let mut enter = 0.0;
        for n in 0..grid.majors {
            rows.push(ray.sign * n as isize * grid.stride as isize + snapped(ray.minor * n as f64).0 as isize);
            let (from, to) = (n as f64, (n + 1) as f64);
            let between = column_between(ray.minor, from, to);
            for leave in between.into_iter().chain([to]).filter(|leave| *leave <= ray.search_steps) {
                crossings.push(Crossing::new(grid, ray, enter, leave));
                enter = leave;
            }
            beyond.push(crossings.len());
        }
        Self { crossings, beyond, rows, bend: (ray.sign as f64 * ray.minor) as f32, on_ground }
    }

    /// Raises the steepest slopes, in metres per step, of receivers from node `at` on to those of the crossings between
    /// two distances in steps, the first not included.
    #[inline(always)]
    pub fn raise(
        &self,
        heights_m: &[f32],
        twists_m: &[f32],
        at: usize,
        observers_m: &[f32; LANES],
        [from, to]: [usize; 2],
        best: &mut [f32; LANES],
    ) {
        let mut before = [0.0; LANES];
        match self.beyond[from] {
            0 => {
                let own = lanes(heights_m, at, 0);
                for lane in 0..LANES {
                    // A gap's own height is filled.
                    before[lane] = if own[lane] > NEVER_M { own[lane] - observers_m[lane] } else { 0.0 };
                }
            }
            first => self.crossings[first - 1].rises(heights_m, at, observers_m, &mut before),
        }
        for (order, crossing) in (self.beyond[from]..).zip(&self.crossings[self.beyond[from]..self.beyond[to]]) {
            let mut here = [0.0; LANES];
            crossing.rises(heights_m, at, observers_m, &mut here);
            let twists = lanes(twists_m, at, crossing.cell);
            if order == 0 && self.on_ground {
                for lane in 0..LANES {
                    let facet = here[lane] * crossing.inverse - self.bend * twists[lane] * crossing.run;
                    best[lane] = larger(best[lane], facet);
                }
            }
            let mut bulging = 0;
            for lane in 0..LANES {
                best[lane] = larger(best[lane], here[lane] * crossing.inverse);
                let top = larger(before[lane], here[lane]) - self.bend * twists[lane] * crossing.bulge;
                let (a, b) = (best[lane] * crossing.enter, best[lane] * crossing.leave);
                let curved = self.bend * twists[lane] < 0.0;
                bulging |= u32::from(curved & (top > if a < b { a } else { b }));
            }
            if bulging != 0 && (order > 0 || !self.on_ground) {
                crossing.bulges(self.bend, twists, &before, &here, best);
            }
            before = here;
        }
    }
}

impl Crossing {
    fn new(grid: &HeightGrid, ray: &Ray, enter: f64, leave: f64) -> Self {
        let node = |u: f64, v: f64| u as isize * grid.stride as isize + v as isize;
        let (u, v) = (ray.sign as f64 * leave, ray.minor * leave);
        let (nodes, weight) = if leave.fract() == 0.0 {
            let (low, weight) = snapped(v);
            ([node(u, low), node(u, low + 1.0)], weight)
        } else {
            let (low, weight) = snapped(u);
            ([node(low, v.round()), node(low + 1.0, v.round())], weight)
        };
        let (middle, run) = (0.5 * (enter + leave), leave - enter);
        Self {
            nodes,
            weights: [(1.0 - weight) as f32, weight as f32],
            inverse: (1.0 / leave) as f32,
            cell: node((ray.sign as f64 * middle).floor(), (ray.minor * middle).floor()),
            enter: enter as f32,
            leave: leave as f32,
            run: run as f32,
            inverse_run: (1.0 / run) as f32,
            // A little more, for the rounding of the test.
            bulge: (0.25001 * run * run) as f32,
        }
    }

    /// Rises from the receivers to the line's surface here.
    #[inline(always)]
    fn rises(&self, heights_m: &[f32], at: usize, observers_m: &[f32; LANES], rises_m: &mut [f32; LANES]) {
        let (a, b) = (lanes(heights_m, at, self.nodes[0]), lanes(heights_m, at, self.nodes[1]));
        for lane in 0..LANES {
            let (rise_a, rise_b) = (a[lane] - observers_m[lane], b[lane] - observers_m[lane]);
            rises_m[lane] = self.weights[0] * rise_a + self.weights[1] * rise_b;
        }
    }

    /// Raises slopes to those inside the cell.
    #[inline(always)]
    fn bulges(
        &self,
        bend: f32,
        twists: &[f32; LANES],
        before: &[f32; LANES],
        here: &[f32; LANES],
        best: &mut [f32; LANES],
    ) {
        for lane in 0..LANES {
            let c = bend * twists[lane];
            let b = (here[lane] - before[lane]) * self.inverse_run - c * self.run;
            let q = (before[lane] - b * self.enter) / c;
            let root = larger(self.enter * self.enter + q, 0.0).sqrt();
            let tau = q / (self.enter + root);
            let inside = (c < 0.0) & (tau > 0.0) & (tau < self.run);
            let slope = (before[lane] + tau * (b + c * tau)) / (self.enter + tau);
            best[lane] = larger(best[lane], if inside { slope } else { NEVER_M });
        }
    }
}

/// The whole number below and the weight of the next one.
fn snapped(value: f64) -> (f64, f64) {
    let nearest = value.round();
    if (value - nearest).abs() < NO_SHARE { (nearest, 0.0) } else { (value.floor(), value - value.floor()) }
}

/// Where a line crosses a column well between two rows.
fn column_between(minor: f64, from: f64, to: f64) -> Option<f64> {
    let (low, high) = ((minor * from).min(minor * to), (minor * from).max(minor * to));
    let column = (high - NO_SHARE).floor();
    (column > low + NO_SHARE).then(|| column / minor)
}
