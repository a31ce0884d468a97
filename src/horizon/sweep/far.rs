//! The far field: tangents from each receiver to the hulls of the two lines beside it.
//!
//! Lines run parallel to the azimuth, half a posting apart. Each carries the hull of its own profile, built
//! from far to near while the receivers beside it are served: the point just beyond the near field is pushed,
//! then the receiver asks for the tangent *from its own height*. Between its two lines a receiver interpolates the slopes.
//!
//! Beyond the level that is swept, a line goes on over the next coarser one for [`RING`] of its nodes. What
//! lies farther away changes little between fine lines: coarser lines carry it, half a coarse posting apart,
//! whose hulls are made once per azimuth ([`Beyond`]).

use super::grid::{Grid, NEVER_M};
use super::hull::Hull;
use super::line::{Line, Placed};
use super::ray::Ray;
use super::Receivers;

/// Lines worked on side by side.
const BLOCK: usize = 16;
/// Lines per posting.
const LINES: f64 = 2.0;
/// Nodes of a coarser level that finer lines carry beyond the finer level's end.
const RING: f64 = 32.0;

/// Everything the far field of one azimuth is made from.
#[derive(Debug)]
pub struct Far<'a> {
    pub ray: &'a Ray,
    pub receivers: &'a Receivers,
    /// The swept level and the coarser ones, placed in the azimuth's coordinates.
    pub levels: Vec<Placed<'a>>,
    /// Major steps that the near field covers.
    pub near: usize,
}

impl<'a> Far<'a> {
    fn fine(&self) -> &'a Grid {
        self.levels[0].grid
    }

    /// Major index at which lines cross their intercepts.
    fn pivot(&self) -> isize {
        (self.fine().majors / 2) as isize
    }

    /// Major index of the row `along` steps from the near side of the swept level.
    fn major(&self, along: isize) -> isize {
        if self.ray.sign > 0 { along } else { self.fine().majors as isize - 1 - along }
    }

    fn x_m(&self, u: isize) -> f64 {
        (self.ray.sign * (u - self.pivot())) as f64 * self.fine().posting_m
    }

    /// Intercepts of the lines through all receivers, in postings.
    fn intercepts(&self) -> (f64, f64) {
        let r = self.receivers;
        let slope = self.ray.sign as f64 * self.ray.minor;
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        for u in [r.margin, r.margin + r.majors - 1] {
            for v in [r.margin, r.margin + r.minors - 1] {
                let intercept = v as f64 - slope * (u as isize - self.pivot()) as f64;
                range = (range.0.min(intercept), range.1.max(intercept));
            }
        }
        range
    }

    /// Adds the far slopes, in metres per metre along the major axis, to `slopes` of zeros. NaN where the
    /// tangent touches beyond the search distance.
    pub fn sweep(&self, slopes: &mut [f32]) {
        let (low, high) = self.intercepts();
        let (first, last) = ((low * LINES).floor() as isize, (high * LINES).ceil() as isize);
        let mut hulls: [Hull; BLOCK] = std::array::from_fn(|_| Hull::default());
        for start in (first..=last).step_by(BLOCK) {
            self.block(start, &mut hulls, slopes);
        }
    }

    fn block(&self, start: isize, hulls: &mut [Hull; BLOCK], slopes: &mut [f32]) {
        let fine = self.fine();
        let r = self.receivers;
        let slope = self.ray.sign as f64 * self.ray.minor;
        for (k, hull) in hulls.iter_mut().enumerate() {
            hull.clear();
            let intercept_m = (start + k as isize) as f64 / LINES * fine.posting_m;
            self.carry_on(0, Line { intercept_m, minor: self.ray.minor }, 0.5 * fine.posting_m, hull);
        }
        let offset = |u: isize| start as f64 / LINES + slope * (u - self.pivot()) as f64;
        let width = (BLOCK - 1) as f64 / LINES;
        let ahead = self.near as isize + 1;
        let search_x = (self.ray.search_steps * fine.posting_m) as f32;
        for along in (0..fine.majors as isize).rev() {
            // The point beyond the near field of this row's receivers.
            let pushed = along + ahead;
            if pushed < fine.majors as isize {
                let u = self.major(pushed);
                let v = offset(u);
                if v + width > -0.5 && v < fine.minors as f64 - 0.5 {
                    let heights_m = sample(fine, u, v);
                    let x = self.x_m(u) as f32;
                    for (hull, height_m) in hulls.iter_mut().zip(heights_m) {
                        hull.push(x, height_m);
                    }
                }
            }
            let u = self.major(along);
            let Some(row) = r.row(u) else { continue };
            let v = offset(u) - r.margin as f64;
            if v + width < -0.5 || v > r.minors as f64 - 0.5 {
                continue;
            }
            let x = self.x_m(u) as f32;
            let observers_m = r.observers_of(row);
            let slopes = &mut slopes[row * r.stride..(row + 1) * r.stride];
            for (k, hull) in hulls.iter_mut().enumerate() {
                let v = v + k as f64 / LINES;
                let nearest = (v + 0.5).floor();
                if nearest < 0.0 || nearest >= r.minors as f64 {
                    continue;
                }
                let share = (1.0 - LINES * (v - nearest).abs()) as f32;
                let nearest = nearest as usize;
                slopes[nearest] += match hull.tangent(x, observers_m[nearest]) {
                    Some((_, at)) if at - x > search_x => f32::NAN,
                    Some((slope, _)) => share * slope,
                    None => share * NEVER_M,
                };
            }
        }
    }

    /// Pushes the first [`RING`] nodes of the level after `level` along a line that leaves `level`.
    fn carry_on(&self, level: usize, line: Line, slack_m: f64, hull: &mut Hull) {
        if let Some(next) = self.levels.get(level + 1) {
            let exit_m = self.levels[level].exit_x_m(line, slack_m);
            let ring_m = exit_m + RING * next.grid.posting_m;
            next.descend(line, exit_m, ring_m, |x, height_m| hull.push(x as f32, height_m));
        }
    }

    /// The hulls of coarser levels.
    pub fn beyond(&self) -> Vec<Beyond> {
        (1..self.levels.len()).map(|level| Beyond::new(self, level)).collect()
    }
}

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
    fn new(far: &Far, level: usize) -> Self {
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
            far.carry_on(level, line(i), 2.0 * spacing_m, &mut hull);
            // No finer line between this one and its neighbours leaves the finer level earlier.
            let leave_m = exit_m(i - 1.0).min(exit_m(i)).min(exit_m(i + 1.0));
            let from_m = leave_m + (RING - 1.0) * placed.grid.posting_m;
            placed.descend(line(i), from_m, f64::INFINITY, |x, height_m| hull.push(x as f32, height_m));
            hull
        });
        let hulls = hulls.collect();
        let search_x = (far.ray.search_steps * fine_m) as f32;
        Self { first_m, spacing_m, minor: far.ray.minor, search_x, hulls }
    }

    /// Slope of the skyline from a receiver at `(x, y)`; NaN where it lies beyond the search distance.
    pub fn slope(&mut self, x_m: f64, y_m: f64, height_m: f32) -> f32 {
        let line = (y_m - self.minor * x_m - self.first_m) / self.spacing_m;
        let low = line.floor();
        let share = (line - low) as f32;
        let mut of = |i: usize| match self.hulls[i].tangent_beyond(x_m as f32, height_m) {
            Some((_, at)) if at - x_m as f32 > self.search_x => f32::NAN,
            Some((slope, _)) => slope,
            None => NEVER_M,
        };
        let (a, b) = (of(low as usize), of(low as usize + 1));
        (1.0 - share) * a + share * b
    }
}

/// Heights of a block of lines where they cross row `u`, the first at minor coordinate `v`. Within half a
/// posting of the grid's sides the side's own height serves.
fn sample(grid: &Grid, u: isize, v: f64) -> [f32; BLOCK] {
    let row = grid.row(u);
    let last = (grid.minors - 1) as f64;
    std::array::from_fn(|k| {
        let v = v + k as f64 / LINES;
        if v < -0.5 || v > last + 0.5 {
            return NEVER_M;
        }
        let v = v.clamp(0.0, last);
        let low = v as usize;
        let share = (v - low as f64) as f32;
        let at = low + grid.pad();
        (1.0 - share) * row[at] + share * row[at + 1]
    })
}
