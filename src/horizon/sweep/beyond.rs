//! What lies so far beyond a level's end that lines of a coarser posting serve.
//!
//! Their hulls are made once per azimuth and are then only asked: by every receiver, from its own position and
//! height, interpolated between the two lines beside it.

use super::far::{Far, RING};
use super::grid::ABSENT_M;
use super::hull::{Hull, Point};
use super::line::Line;
use super::wide::Registers;

/// Coarse lines per coarse posting.
const LINES: f64 = 2.0;

/// Hulls of what a coarser level adds beyond the ring, on lines half its posting apart.
#[derive(Debug)]
pub struct Beyond {
    first_m: f64,
    spacing_m: f64,
    minor: f64,
    search_x: f32,
    hulls: Vec<Hull>,
}

impl Beyond {
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

    /// Slope of the skyline from a receiver at `(x, y)`; NaN where it lies beyond the search distance.
    #[inline(always)]
    pub fn slope(&self, registers: Registers, x_m: f64, y_m: f64, height_m: f32) -> f32 {
        let line = (y_m - self.minor * x_m - self.first_m) / self.spacing_m;
        let low = line.floor();
        let share = (line - low) as f32;
        let receiver = Point { x: x_m as f32, height_m };
        let (a, b) =
            (self.tangent(registers, low as usize, receiver), self.tangent(registers, low as usize + 1, receiver));
        (1.0 - share) * a + share * b
    }

    #[inline(always)]
    fn tangent(&self, registers: Registers, line: usize, receiver: Point) -> f32 {
        let touch = self.hulls[line].tangent_beyond(registers, receiver);
        let run_m = touch.x - receiver.x;
        let lost = run_m > self.search_x && touch.height_m > ABSENT_M;
        if lost { f32::NAN } else { (touch.height_m - receiver.height_m) / run_m }
    }
}
