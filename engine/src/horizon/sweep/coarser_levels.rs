//! What lies so far beyond a level's end that lines of a coarser posting serve.
//!
//! Their hulls are made once per azimuth and are then only asked: by every receiver, from its own position and
//! height, interpolated between the two lines beside it.

use super::far::{Far, RING};
use super::hull::{Hull, Point};
use super::line::Line;
use crate::horizon::lanes::{LANES, largest};
use crate::horizon::wide::Registers;

/// Coarse lines per coarse posting.
const LINES: f64 = 2.0;

/// Slopes below this lead to nothing.
const NOWHERE: f32 = -1e9;

/// Hulls of what a coarser level adds beyond the ring, on lines half its posting apart.
#[derive(Debug)]
pub struct CoarserHulls {
    first_m: f64,
    spacing_m: f64,
    minor: f64,
    search_x: f32,
    hulls: Vec<Hull>,
}

impl CoarserHulls {
    /// The hulls of level `level` of `far`, beyond those that finer lines carry.
    pub fn new(registers: Registers, far: &Far, level: usize) -> Self {
        let (placed, finer) = (&far.levels[level], &far.levels[level - 1]);
        let spacing_m = placed.grid.posting_m / LINES;
        let (low, high) = far.intercepts();
        let fine_m = far.fine().posting_m;
        let first_m = low * fine_m - spacing_m;
        let lines = ((high - low) * fine_m / spacing_m) as usize + 4;
        let line = |i: f64| Line { intercept_m: first_m + i * spacing_m, minor: far.ray.minor };
        let exit_m = |i: f64| finer.exit_x_m(line(i), 2.0 * spacing_m);
        let hulls = (0..lines).map(|i| {
            let i = i as f64;
            let mut hull = Hull::default();
            far.carry_on(registers, level, line(i), 2.0 * spacing_m, &mut hull);
            // No finer line between this one and its neighbours leaves the finer level earlier.
            let leave_m = exit_m(i - 1.0).min(exit_m(i)).min(exit_m(i + 1.0));
            let from_m = leave_m + (RING - 1.0) * placed.grid.posting_m;
            placed.descend(line(i), from_m, f64::INFINITY, |x, height_m| {
                hull.push(registers, Point { x: x as f32, height_m })
            });
            hull
        });
        let hulls = hulls.collect();
        Self { first_m, spacing_m, minor: far.ray.minor, search_x: far.search_x(), hulls }
    }

    /// Slopes of the skyline from receivers at `x`, the first at `y`, the others `step_m` apart; NaN where it lies beyond the
    /// search distance.
    #[inline(always)]
    pub fn slopes(
        &self,
        registers: Registers,
        x_m: f64,
        y_m: f64,
        step_m: f64,
        observers_m: &[f32; LANES],
    ) -> [f32; LANES] {
        let lines: [f64; LANES] =
            std::array::from_fn(|lane| (y_m + lane as f64 * step_m - self.minor * x_m - self.first_m) / self.spacing_m);
        let mut slopes = [0.0; LANES];
        let last = (lines[LANES - 1] as usize + 1).min(self.hulls.len() - 1);
        for line in lines[0] as usize..=last {
            let tangents = self.tangents(registers, line, x_m as f32, observers_m);
            for lane in 0..LANES {
                let fraction = 1.0 - (lines[lane] - line as f64).abs() as f32;
                slopes[lane] += if fraction > 0.0 { fraction * tangents[lane] } else { 0.0 };
            }
        }
        slopes
    }

    /// Slopes to one line: the steepest of those to all vertices between the ones that the tangents from the lowest and
    /// from the highest receiver touch.
    #[inline(always)]
    fn tangents(&self, registers: Registers, line: usize, x: f32, observers_m: &[f32; LANES]) -> [f32; LANES] {
        let mut depths_m = [0.0; LANES];
        for lane in 0..LANES {
            depths_m[lane] = -observers_m[lane];
        }
        let (lowest_m, highest_m) = (-largest(&depths_m), largest(observers_m));
        let (mut slopes, mut runs_m) = ([f32::NEG_INFINITY; LANES], [0.0; LANES]);
        for vertex in self.hulls[line].touched_between(registers, x, [lowest_m, highest_m]) {
            let run_m = vertex.x - x;
            let inverse = 1.0 / run_m;
            for lane in 0..LANES {
                let slope = (vertex.height_m - observers_m[lane]) * inverse;
                let steeper = slope > slopes[lane];
                slopes[lane] = if steeper { slope } else { slopes[lane] };
                runs_m[lane] = if steeper { run_m } else { runs_m[lane] };
            }
        }
        for lane in 0..LANES {
            let lost = runs_m[lane] > self.search_x && slopes[lane] > NOWHERE;
            slopes[lane] = if lost { f32::NAN } else { slopes[lane] };
        }
        slopes
    }
}
