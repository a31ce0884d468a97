//! The far field: tangents from each receiver to the hulls of the two lines beside it.
//!
//! Lines run parallel to the azimuth, a posting apart. Each carries the hull of its own profile, built from far to
//! near while the receivers beside it are served: the crossings just beyond the near field are pushed, then the receiver
//! asks for the tangent *from its own height*. Where the slopes of its two lines agree, the receiver interpolates between them. Where they do not, it
//! searches its own line about the two places where they touch ([`super::profile`]).
//!
//! Beyond the level that is swept, a line goes on over the next coarser one for [`RING`] of its nodes; coarser
//! lines carry what lies farther away ([`super::beyond`]).

use super::Receivers;
use super::grid::{ABSENT_M, Grid, NEVER_M};
use super::hull::{Hull, Touch};
use super::line::{Line, Placed};
use super::near::larger;
use super::profile::Profile;
use super::ray::Ray;

/// Receivers of a row worked on side by side, between lines that are.
const BLOCK: usize = 16;
/// The lines beside them.
const LINES: usize = BLOCK + 1;
/// Nodes of a coarser level that finer lines carry beyond the finer level's end.
pub const RING: f64 = 32.0;
/// Difference between the slopes of two lines above which a receiver searches its own: 0.017°.
const AGREEMENT: f32 = 3e-4;

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

/// The lines of one block where they cross a row.
#[derive(Debug, Clone, Copy)]
struct Row {
    /// Major index of the row, and its distance coordinate.
    u: isize,
    x: f32,
    /// The first line crosses at minor coordinate `low + share`, the next ones a posting apart.
    low: isize,
    share: f64,
}

impl<'a> Far<'a> {
    pub fn fine(&self) -> &'a Grid {
        self.levels[0].grid
    }

    /// Distance coordinate beyond which a receiver does not search.
    pub fn search_x(&self) -> f32 {
        (self.ray.search_steps * self.fine().posting_m) as f32
    }

    /// Major index at which lines cross their intercepts.
    fn pivot(&self) -> isize {
        (self.fine().majors / 2) as isize
    }

    /// Intercepts of the lines through all receivers, in postings.
    pub fn intercepts(&self) -> (f64, f64) {
        let r = self.receivers;
        let turn = self.ray.sign as f64 * self.ray.minor;
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        for u in [r.margin, r.margin + r.majors - 1] {
            for v in [r.margin, r.margin + r.minors - 1] {
                let intercept = v as f64 - turn * (u as isize - self.pivot()) as f64;
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
        let (first, last) = (low.floor() as isize - 1, high.ceil() as isize);
        let profile = Profile::new(self.fine(), self.ray);
        let mut hulls: [Hull; LINES] = std::array::from_fn(|_| Hull::default());
        for start in (first..=last).step_by(BLOCK) {
            self.block(start, &profile, &mut hulls, slopes);
        }
    }

    /// Where a block's lines cross the row `along` steps from the near side.
    fn row(&self, start: isize, along: isize) -> Row {
        let u = if self.ray.sign > 0 { along } else { self.fine().majors as isize - 1 - along };
        let steps = self.ray.sign * (u - self.pivot());
        // Split before `start` is added: rounding must not differ between blocks, or a receiver falls between them.
        let v = self.ray.minor * steps as f64;
        // `floor` is a call on targets without SSE 4.1.
        let whole = v as isize;
        let low = whole - isize::from(whole as f64 > v);
        Row { u, x: steps as f32 * self.fine().posting_m as f32, low: start + low, share: v - low as f64 }
    }

    /// The receivers between one block of lines.
    fn block(&self, start: isize, profile: &Profile, hulls: &mut [Hull; LINES], slopes: &mut [f32]) {
        let fine = self.fine();
        for (k, hull) in hulls.iter_mut().enumerate() {
            hull.clear();
            let intercept_m = (start + k as isize) as f64 * fine.posting_m;
            self.carry_on(0, Line { intercept_m, minor: self.ray.minor }, fine.posting_m, hull);
        }
        let mut beyond_m = [NEVER_M; LINES];
        for along in (0..fine.majors as isize).rev() {
            let ahead = along + self.near as isize + 1;
            if ahead < fine.majors as isize {
                let row = self.row(start, ahead);
                if row.low > -(LINES as isize) && row.low < fine.minors as isize {
                    let heights_m = sample(fine, &row);
                    if ahead + 1 < fine.majors as isize {
                        self.push_columns(&row, &heights_m, &beyond_m, hulls);
                    }
                    push_row(row.x, &heights_m, hulls);
                    beyond_m = heights_m;
                }
            }
            self.serve(&self.row(start, along), profile, hulls, slopes);
        }
    }

    /// Raises the slopes of the receivers of a row.
    #[inline(always)]
    fn serve(&self, row: &Row, profile: &Profile, hulls: &mut [Hull; LINES], slopes: &mut [f32]) {
        let r = self.receivers;
        let Some(start) = r.row(row.u).map(|u| u * r.stride) else { return };
        // The first receiver lies above the first line, the others a posting apart.
        let first = row.low + 1 - r.margin as isize;
        let from = (-first).clamp(0, BLOCK as isize) as usize;
        let to = (r.minors as isize - first).clamp(0, BLOCK as isize) as usize;
        for k in from..to {
            let v = (first + k as isize) as usize;
            let (slope, observer_m) = (&mut slopes[start + v], r.observers_m[start + v]);
            let touches = [hulls[k].tangent(row.x, observer_m), hulls[k + 1].tangent(row.x, observer_m)];
            let hidden = |touch: Touch| touch.rise_m <= *slope * touch.run_m;
            if hidden(touches[0]) & hidden(touches[1]) {
                continue;
            }
            let far = self.between(profile, row, v + r.margin, observer_m, touches);
            // NaN asks for a trace.
            if far > *slope || far.is_nan() {
                *slope = far;
            }
        }
    }

    /// Pushes where lines cross a column between a row and the one beyond it, if the surface stands above the chord there.
    #[inline(always)]
    fn push_columns(&self, row: &Row, heights_m: &[f32; LINES], beyond_m: &[f32; LINES], hulls: &mut [Hull; LINES]) {
        let fine = self.fine();
        // All lines of a block cross their columns at the same distance.
        let beyond = row.share + self.ray.minor;
        let column = if beyond > 1.0 { 1 } else { 0 };
        let along = (column as f64 - row.share) / self.ray.minor;
        if (0.0..=1.0).contains(&beyond) || along <= 1e-6 || along >= 1.0 - 1e-6 {
            return;
        }
        let start = (row.low + column + fine.pad() as isize) as usize;
        let near: &[f32; LINES] = fine.row(row.u)[start..].first_chunk().expect("padding");
        let far: &[f32; LINES] = fine.row(row.u + self.ray.sign)[start..].first_chunk().expect("padding");
        let (along, rest) = (along as f32, 1.0 - along as f32);
        let x = row.x + along * fine.posting_m as f32;
        for k in 0..LINES {
            let height_m = rest * near[k] + along * far[k];
            if height_m > larger(rest * heights_m[k] + along * beyond_m[k], ABSENT_M) {
                hulls[k].push(x, height_m);
            }
        }
    }

    /// The slope seen between two lines from their tangents. Where these do not agree, that on the receiver's own line.
    fn between(&self, profile: &Profile, row: &Row, v: usize, observer_m: f32, touches: [Touch; 2]) -> f32 {
        if larger(touches[0].run_m, touches[1].run_m) > self.search_x() {
            return f32::NAN;
        }
        // A receiver lies `1 − share` above its lower line.
        let share = row.share as f32;
        let [below, above] = touches.map(|touch| touch.rise_m / touch.run_m);
        let mixed = share * below + (1.0 - share) * above;
        if (below - above).abs() <= AGREEMENT {
            return mixed;
        }
        let inverse_posting = 1.0 / self.fine().posting_m as f32;
        let steps = touches.map(|touch| (touch.run_m * inverse_posting + 0.5) as usize);
        let reach = profile.reach(self.fine(), row.u, v);
        let own = profile.slope(self.fine(), row.u, v, observer_m, steps, reach) * inverse_posting;
        if steps[0].max(steps[1]) <= reach || self.levels.len() == 1 {
            return own;
        }
        // A touch on a coarser level, whose own line is not at hand: both lines see at least the lower one.
        let lower = if below < above { below } else { above };
        larger(own, if steps[0].min(steps[1]) > reach { mixed } else { lower })
    }

    /// Pushes the first [`RING`] nodes of the level after `level` along a line that leaves `level`, widened by a slack.
    pub fn carry_on(&self, level: usize, line: Line, slack_m: f64, hull: &mut Hull) {
        if let Some(next) = self.levels.get(level + 1) {
            let exit_m = self.levels[level].exit_x_m(line, slack_m);
            let ring_m = exit_m + RING * next.grid.posting_m;
            next.descend(line, exit_m, ring_m, |x, height_m| hull.push(x as f32, height_m));
        }
    }
}

/// Heights of a block's lines on a row of nodes.
#[inline(always)]
fn sample(grid: &Grid, row: &Row) -> [f32; LINES] {
    let start = (row.low + grid.pad() as isize) as usize;
    let nodes: &[f32; LINES + 1] = grid.row(row.u)[start..].first_chunk().expect("padding");
    let share = row.share as f32;
    let mut heights_m = [0.0; LINES];
    for k in 0..LINES {
        heights_m[k] = (1.0 - share) * nodes[k] + share * nodes[k + 1];
    }
    heights_m
}

#[inline(always)]
fn push_row(x: f32, heights_m: &[f32; LINES], hulls: &mut [Hull; LINES]) {
    for (hull, height_m) in hulls.iter_mut().zip(heights_m) {
        // A line may run beside the grid, or over a gap.
        if *height_m > ABSENT_M {
            hull.push(x, *height_m);
        }
    }
}
