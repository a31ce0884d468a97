//! The far field: tangents from each receiver to the hulls of the two lines beside it.
//!
//! Lines run parallel to the azimuth, half a posting apart. Each carries the hull of its own profile, built
//! from far to near while the receivers beside it are served: the point just beyond the near field is pushed,
//! then the receiver asks for the tangent *from its own height*. Between its two lines a receiver interpolates the slopes.
//!
//! Beyond the level that is swept, a line goes on over the next coarser one for [`RING`] of its nodes. What
//! lies farther away changes little between fine lines: coarser lines carry it, half a coarse posting apart,
//! whose hulls are made once per azimuth ([`Beyond`]).

use super::Receivers;
use super::grid::{ABSENT_M, Grid, NEVER_M};
use super::hull::{Hull, Touch};
use super::line::{Line, Placed};
use super::near::larger;
use super::profile::Profile;
use super::ray::Ray;

/// Lines per posting.
const LINES: usize = 2;
/// Receivers of a row worked on side by side, between lines that are.
const BLOCK: usize = 16;
const BLOCK_LINES: usize = LINES * BLOCK + 1;
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
    pub search_x: f32,
    pub inverse_posting: f32,
    /// Difference of the slopes of neighbouring lines above which the receiver's own line is consulted.
    pub tolerance: f32,
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

    /// Raises near slopes, in metres per metre along the major axis, to the far ones. NaN where the tangent
    /// touches beyond the search distance.
    pub fn raise(&self, slopes: &mut [f32]) {
        let (low, high) = self.intercepts();
        // The first line lies below all receivers.
        let (first, last) = ((low * LINES as f64).floor() as isize - 1, (high * LINES as f64).ceil() as isize);
        let profile = Profile::new(self.fine(), self.ray);
        let mut hulls: [Hull; BLOCK_LINES] = std::array::from_fn(|_| Hull::default());
        for start in (first..=last).step_by(BLOCK * LINES) {
            self.block(start, &profile, &mut hulls, slopes);
        }
    }

    /// The receivers between one block of lines.
    fn block(&self, start: isize, profile: &Profile, hulls: &mut [Hull; BLOCK_LINES], slopes: &mut [f32]) {
        let (fine, r) = (self.fine(), self.receivers);
        let turn = self.ray.sign as f64 * self.ray.minor;
        for (k, hull) in hulls.iter_mut().enumerate() {
            hull.clear();
            let intercept_m = (start + k as isize) as f64 / LINES as f64 * fine.posting_m;
            self.carry_on(0, Line { intercept_m, minor: self.ray.minor }, 0.5 * fine.posting_m, hull);
        }
        let first_line = |u: isize| start as f64 / LINES as f64 + turn * (u - self.pivot()) as f64;
        let ahead = self.near as isize + 1;
        let mut before_m = [NEVER_M; BLOCK_LINES];
        for along in (0..fine.majors as isize).rev() {
            let pushed = along + ahead;
            if pushed < fine.majors as isize {
                let u = self.major(pushed);
                let (low, share) = split(first_line(u));
                if low >= -(BLOCK as isize) - 1 && low < fine.minors as isize {
                    let heights_m = sample(fine, u, low, share);
                    let x = self.x_m(u) as f32;
                    if pushed + 1 < fine.majors as isize {
                        self.push_columns(u, low, share, x, &heights_m, &before_m, hulls);
                    }
                    before_m = heights_m;
                    for (hull, height_m) in hulls.iter_mut().zip(heights_m) {
                        if height_m > ABSENT_M {
                            hull.push(x, height_m);
                        }
                    }
                }
            }
            let u = self.major(along);
            let Some(row) = r.row(u) else { continue };
            let (low, share) = split(first_line(u));
            // The first receiver lies above the first line, the others a posting apart.
            let first = low + 1 - r.margin as isize;
            let from = (-first).clamp(0, BLOCK as isize) as usize;
            let to = (r.minors as isize - first).clamp(0, BLOCK as isize) as usize;
            if from >= to {
                continue;
            }
            let lane = (((1.0 - share) * LINES as f64).ceil() as usize).saturating_sub(1);
            let weight = (1.0 - ((1.0 - share) * LINES as f64 - lane as f64)) as f32;
            let x = self.x_m(u) as f32;
            let start = row * r.stride;
            for i in from..to {
                let v = (first + i as isize) as usize;
                let slope = &mut slopes[start + v];
                let observer_m = r.observers_m[start + v];
                let k = lane + i * LINES;
                let below = hulls[k].tangent(x, observer_m);
                let above = hulls[k + 1].tangent(x, observer_m);
                let hidden = |touch: Touch| touch.rise_m <= *slope * touch.run_m;
                if hidden(below) & hidden(above) {
                    continue;
                }
                let far = self.between(profile, u, v + r.margin, observer_m, [below, above], weight);
                if !(far <= *slope) {
                    *slope = far;
                }
            }
        }
    }

    /// Pushes where lines cross a column between row `u` and the row beyond it, if the surface stands above the chord there.
    #[inline(always)]
    fn push_columns(
        &self,
        u: isize,
        low: isize,
        share: f64,
        x: f32,
        heights_m: &[f32; BLOCK_LINES],
        beyond_m: &[f32; BLOCK_LINES],
        hulls: &mut [Hull; BLOCK_LINES],
    ) {
        let fine = self.fine();
        for part in 0..LINES {
            // All lines of a part cross their columns at the same distance.
            let (step, share) = split(share + part as f64 / LINES as f64);
            let (beyond, _) = split(share + self.ray.minor);
            let column = beyond.max(0);
            let along = (column as f64 - share) / self.ray.minor;
            if beyond == 0 || along <= 1e-6 || along >= 1.0 - 1e-6 {
                continue;
            }
            let start = (low + step + column + fine.pad() as isize) as usize;
            let (near, far) = (&fine.row(u)[start..], &fine.row(u + self.ray.sign)[start..]);
            let along = along as f32;
            let x = x + along * fine.posting_m as f32;
            for i in 0..=BLOCK {
                let line = part + i * LINES;
                if line >= BLOCK_LINES {
                    break;
                }
                let height_m = (1.0 - along) * near[i] + along * far[i];
                let chord_m = (1.0 - along) * heights_m[line] + along * beyond_m[line];
                if height_m > larger(chord_m, ABSENT_M) {
                    hulls[line].push(x, height_m);
                }
            }
        }
    }

    /// The slope seen between two lines from their tangents. Where these do not agree, that on the receiver's own line.
    fn between(&self, profile: &Profile, u: isize, v: usize, observer_m: f32, touches: [Touch; 2], weight: f32) -> f32 {
        if larger(touches[0].run_m, touches[1].run_m) > self.search_x {
            return f32::NAN;
        }
        let [below, above] = touches.map(|touch| touch.rise_m / touch.run_m);
        if (below - above).abs() <= self.tolerance {
            return weight * below + (1.0 - weight) * above;
        }
        let steps = touches.map(|touch| (touch.run_m * self.inverse_posting + 0.5) as usize);
        let reach = profile.reach(self.fine(), u, v);
        let own = profile.slope(self.fine(), u, v, observer_m, steps, reach) * self.inverse_posting;
        if steps[0].max(steps[1]) <= reach || self.levels.len() == 1 {
            return own;
        }
        // A touch on a coarser level, whose own line is not at hand: both lines see at least the lower one.
        let lower = if below < above { below } else { above };
        let both = if steps[0].min(steps[1]) > reach { weight * below + (1.0 - weight) * above } else { lower };
        larger(own, both)
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
        let spacing_m = placed.grid.posting_m / LINES as f64;
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
        Self { first_m, spacing_m, minor: far.ray.minor, search_x: far.search_x, hulls }
    }

    /// Slope of the skyline from a receiver at `(x, y)`; NaN where it lies beyond the search distance.
    pub fn slope(&mut self, x_m: f64, y_m: f64, height_m: f32) -> f32 {
        let line = (y_m - self.minor * x_m - self.first_m) / self.spacing_m;
        let low = line.floor();
        let share = (line - low) as f32;
        let mut of = |i: usize| {
            let touch = self.hulls[i].tangent_beyond(x_m as f32, height_m);
            if touch.run_m > self.search_x { f32::NAN } else { touch.rise_m / touch.run_m }
        };
        let (a, b) = (of(low as usize), of(low as usize + 1));
        (1.0 - share) * a + share * b
    }
}

/// Whole part and the rest.
fn split(v: f64) -> (isize, f64) {
    // `floor` is a call on targets without SSE 4.1.
    let whole = v as isize;
    let low = whole - isize::from(whole as f64 > v);
    (low, v - low as f64)
}

/// Heights of a block of lines where they cross row `u`, the first at minor coordinate `low + share`.
#[inline(always)]
fn sample(grid: &Grid, u: isize, low: isize, share: f64) -> [f32; BLOCK_LINES] {
    let start = (low + grid.pad() as isize) as usize;
    let nodes: &[f32; BLOCK + 2] = grid.row(u)[start..start + BLOCK + 2].try_into().expect("BLOCK + 2");
    let mut heights_m = [0.0; BLOCK_LINES];
    for part in 0..LINES {
        let (step, share) = split(share + part as f64 / LINES as f64);
        let (step, share) = (step as usize, share as f32);
        for i in 0..BLOCK {
            heights_m[part + i * LINES] = (1.0 - share) * nodes[i + step] + share * nodes[i + step + 1];
        }
    }
    let share = share as f32;
    heights_m[BLOCK_LINES - 1] = (1.0 - share) * nodes[BLOCK] + share * nodes[BLOCK + 1];
    heights_m
}
