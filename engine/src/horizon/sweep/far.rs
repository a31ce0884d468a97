//! The far field: tangents from each receiver to the hulls of the two lines beside it.
//!
//! Lines run parallel to the azimuth, a posting apart, worked on in blocks. Each carries the hull of its own profile, built
//! from far to near while the receivers beside it are served: the receiver asks for the tangent *from its own height*, then
//! the crossings just beyond the near field of the next receiver are pushed. A receiver interpolates between the slopes of
//! the two lines beside it. How far that may be off follows from the receivers to its left and right: where the differences
//! between the two lines of each are not alike, the slope bends from line to line, and where that makes more than 0.01° the
//! receiver searches its own line about the two places where its tangents touch ([`super::profile`]).
//!
//! Beyond the level that is swept, a line goes on over the next coarser one for [`RING`] of its nodes; coarser
//! lines carry what lies farther away ([`super::coarser_levels`]).

use std::ops::Range;

use super::grid::HeightGrid;
use super::hull::{Hull, LOWEST_M, Point};
use super::line::{Line, PlacedGrid};
use super::profile::Profile;
use super::ray::Ray;
use crate::horizon::lanes::{LANES, larger, largest};
use crate::horizon::receivers::Receivers;
use crate::horizon::wide::{Registers, larger_of};

/// Lines worked on side by side.
const LINES: usize = LANES;
/// Receivers of a row between them.
pub const BLOCK: usize = LINES - 1;
/// Nodes of a coarser level that finer lines carry beyond the finer level's end.
pub const RING: f64 = 32.0;
/// Error of interpolating between two lines above which a receiver searches its own: 0.01°.
const AGREEMENT: f32 = 2e-4;

/// Seen at this slope or less from the nearest receiver, the surface between two rows is their chord: 0.003°.
const UNSEEN: f32 = 5e-5;

/// Points of a line this close to each other, in steps, are one.
const LEAST: f64 = 1e-3;

/// Everything the far field of one azimuth is made from.
#[derive(Debug)]
pub struct Far<'a> {
    pub ray: &'a Ray,
    pub receivers: &'a Receivers,
    /// The swept level and the coarser ones, placed in the azimuth's coordinates.
    pub levels: Vec<PlacedGrid<'a>>,
    pub profile: Profile,
    /// Major steps from a receiver before the first row that hulls hold.
    pub reach: usize,
}

/// A row of nodes where it is crossed by a block of lines.
#[derive(Debug, Clone, Copy)]
pub struct CrossedRow {
    /// Major index of the row, and its distance coordinate.
    pub u: isize,
    pub x: f32,
    /// The first line crosses at minor coordinate `low + fraction`, the next ones a posting apart.
    pub low: isize,
    fraction: f64,
}

/// Receivers of a row, the first just above the first line of a block, the others a posting apart.
#[derive(Debug, Clone)]
pub struct RowReceivers<'a> {
    pub row: CrossedRow,
    /// Indices of the receivers that exist.
    pub taken: Range<usize>,
    pub observers_m: &'a [f32; LANES],
}

/// What the hulls of a block say. It is read some time after it was written, word by word, so that the processor need not
/// wait for the words to become vectors.
#[derive(Debug)]
pub struct TangentQuery {
    /// Where the row to be added lies, and the heights of the lines on it.
    x: f32,
    heights_m: [f32; LINES],
    /// The vertices that its tangents touch.
    touched: [usize; LINES],
    farther: [Point; LINES],
    /// Where the tangents of each receiver touch the lines below and above it.
    touches: [[Point; LINES]; 2],
}

/// The lines of a block.
#[derive(Debug)]
pub struct Block {
    pub start: isize,
    hulls: [Hull; LINES],
    /// Heights of the last row pushed.
    beyond_m: [f32; LINES],
}

impl<'a> Far<'a> {
    pub fn fine(&self) -> &'a HeightGrid {
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

    /// First lines of the blocks that all receivers lie in.
    pub fn starts(&self) -> impl Iterator<Item = isize> + use<> {
        let (low, high) = self.intercepts();
        // The first line lies below all receivers.
        (low.floor() as isize - 1..=high.ceil() as isize).step_by(BLOCK)
    }

    /// The nearest row in which a block serves a receiver: what lies before it nobody sees. `None` where it serves nobody.
    pub fn nearest_served(&self, start: isize) -> Option<isize> {
        (0..self.fine().majors as isize).find(|along| self.taken_receivers(&self.row(start, *along)).is_some())
    }

    /// The row of receivers on a row of nodes, and which of a block's receivers lie there.
    pub fn taken_receivers(&self, row: &CrossedRow) -> Option<(usize, Range<usize>)> {
        // The first receiver lies above the first line.
        let first = row.low + 1 - self.receivers.margin as isize;
        let from = (-first).clamp(0, BLOCK as isize) as usize;
        let to = (self.receivers.minors as isize - first).clamp(0, BLOCK as isize) as usize;
        self.receivers.row(row.u).filter(|_| from < to).map(|u| (u, from..to))
    }

    /// The lines of a block with what lies beyond the level on them.
    pub fn begin(&self, registers: Registers, start: isize, block: &mut Block) {
        let posting_m = self.fine().posting_m;
        block.start = start;
        block.beyond_m = [LOWEST_M; LINES];
        for (k, hull) in block.hulls.iter_mut().enumerate() {
            hull.clear();
            let intercept_m = (start + k as isize) as f64 * posting_m;
            self.carry_on(registers, 0, Line { intercept_m, minor: self.ray.minor }, posting_m, hull);
        }
    }

    /// Where the lines of the block that begins with `start` cross the row `along` steps from the near side.
    pub fn row(&self, start: isize, along: isize) -> CrossedRow {
        let u = if self.ray.sign > 0 { along } else { self.fine().majors as isize - 1 - along };
        let steps = self.ray.sign * (u - self.pivot());
        // Split before `start` is added: rounding must not differ between blocks, or a receiver falls between them.
        let v = self.ray.minor * steps as f64;
        // `floor` is a call on targets without SSE 4.1.
        let whole = v as isize;
        let low = whole - isize::from(whole as f64 > v);
        CrossedRow { u, x: steps as f32 * self.fine().posting_m as f32, low: start + low, fraction: v - low as f64 }
    }

    /// Adds the row `along` steps from the near side to the hulls of a block that serves nobody.
    #[inline(always)]
    pub fn advance(&self, registers: Registers, along: isize, block: &mut Block) {
        let row = self.row(block.start, along);
        let Some(heights_m) = self.approach(registers, &row, along, block) else { return };
        for k in 0..LINES {
            block.hulls[k].push(registers, Point { x: row.x, height_m: heights_m[k] });
        }
    }

    /// Heights of a block's lines on a row, once what lies between it and the row beyond is pushed; `None` where no
    /// line crosses it.
    #[inline(always)]
    fn approach(
        &self,
        registers: Registers,
        row: &CrossedRow,
        along: isize,
        block: &mut Block,
    ) -> Option<[f32; LINES]> {
        let fine = self.fine();
        let crosses =
            (0..fine.majors as isize).contains(&along) && row.low > -(LINES as isize) && row.low < fine.minors as isize;
        if !crosses {
            block.beyond_m = [LOWEST_M; LINES];
            return None;
        }
        let heights_m = sample(fine, row);
        if along + 1 < fine.majors as isize {
            self.push_columns(registers, row, &heights_m, block);
        }
        block.beyond_m = heights_m;
        Some(heights_m)
    }

    /// Asks the hulls of a block where the tangents of `receivers` touch, and those of the row `along` steps
    /// from the near side, which is to be added next.
    #[inline(always)]
    pub fn ask(&self, registers: Registers, along: isize, block: &mut Block, receivers: &RowReceivers) -> TangentQuery {
        let row = self.row(block.start, along);
        let heights_m = self.approach(registers, &row, along, block).unwrap_or([LOWEST_M; LINES]);
        let mut query = TangentQuery {
            x: row.x,
            heights_m,
            touched: [0; LINES],
            farther: [Point::default(); LINES],
            touches: [[Point::default(); LINES]; 2],
        };
        let (x, observers_m) = (receivers.row.x, receivers.observers_m);
        let mut lower_m = observers_m[0];
        for k in 0..LINES {
            let from = [
                Point { x: row.x, height_m: heights_m[k] },
                Point { x, height_m: lower_m },
                Point { x, height_m: observers_m[k] },
            ];
            let (vertex, [hidden, above, below]) = block.hulls[k].tangents(registers, from);
            (query.touched[k], query.farther[k]) = (vertex, hidden);
            query.touches[0][k] = below;
            // The first line lies above no receiver: its touch is overwritten.
            query.touches[1][k.saturating_sub(1)] = above;
            lower_m = observers_m[k];
        }
        query
    }

    /// Adds the row that `query` stands for, and raises the slopes of the receivers, in metres per metre along the major axis,
    /// to the far ones: NaN where the tangent touches beyond the search distance.
    #[inline(always)]
    pub fn answer(&self, block: &mut Block, receivers: &RowReceivers, query: &TangentQuery, slopes: &mut [f32; LANES]) {
        let (x, observers_m) = (receivers.row.x, receivers.observers_m);
        let TangentQuery { x: ahead_x, heights_m: ahead_m, touched, farther, touches } = query;
        let (mut lines, mut intercepts_m) = ([0.0; LINES], [0.0; LINES]);
        for k in 0..LINES {
            [lines[k], intercepts_m[k]] = Point { x: *ahead_x, height_m: ahead_m[k] }.line_to(farther[k]);
        }
        for k in 0..LINES {
            block.hulls[k].put(touched[k], Point { x: *ahead_x, height_m: ahead_m[k] }, [lines[k], intercepts_m[k]]);
        }
        // A receiver lies `1 − fraction` above its lower line.
        let fraction = receivers.row.fraction as f32;
        let ahead_run_m = ahead_x - x;
        let (mut runs_m, mut tangents) = ([[0.0; LINES]; 2], [[0.0; LINES]; 2]);
        let (mut mixed, mut turns, mut lost) = ([0.0; LINES], [0.0; LINES + 2], [0.0; LINES]);
        let search_x = self.search_x();
        let mut next_m = [LOWEST_M; LINES];
        next_m[..BLOCK].copy_from_slice(&ahead_m[1..]);
        for k in 0..LINES {
            let steeper = |touch: Point, ahead_m: f32| {
                let (rise, run) = (touch.height_m - observers_m[k], touch.x - x);
                let ahead_rise = ahead_m - observers_m[k];
                if ahead_rise * run > rise * ahead_run_m { (ahead_rise, ahead_run_m) } else { (rise, run) }
            };
            let (rise_a, run_a) = steeper(touches[0][k], ahead_m[k]);
            let (rise_b, run_b) = steeper(touches[1][k], next_m[k]);
            let inverse = 1.0 / (run_a * run_b);
            let (below, above) = (rise_a * run_b * inverse, rise_b * run_a * inverse);
            mixed[k] = fraction * below + (1.0 - fraction) * above;
            (runs_m[0][k], runs_m[1][k]) = (run_a, run_b);
            (tangents[0][k], tangents[1][k]) = (below, above);
            turns[k + 1] = above - below;
            let too_far = ((run_a > search_x) & (below > slopes[k])) | ((run_b > search_x) & (above > slopes[k]));
            lost[k] = if too_far { f32::INFINITY } else { 0.0 };
        }
        // The outermost receivers have a neighbour on one side.
        (turns[0], turns[LINES]) = (turns[1], turns[BLOCK]);
        // Linear interpolation errs by `fraction (1 − fraction)/2` of the second difference. A line through the receiver itself
        // still misses the humps of cells.
        let weight = 0.5 * fraction * (1.0 - fraction) + 0.01;
        let mut doubts = [0.0; LINES];
        for k in 0..LINES {
            let bends = larger((turns[k + 1] - turns[k]).abs(), (turns[k + 2] - turns[k + 1]).abs());
            let seen = larger(tangents[0][k], tangents[1][k]) > slopes[k];
            doubts[k] = larger(if seen { weight * bends } else { 0.0 }, lost[k]);
        }
        doubts[BLOCK] = 0.0;
        let worst = largest(&doubts);
        for k in 0..LINES {
            slopes[k] = if doubts[k] <= AGREEMENT { larger(slopes[k], mixed[k]) } else { slopes[k] };
        }
        if worst > AGREEMENT {
            self.search_doubtful(receivers, &doubts, &runs_m, &tangents, slopes);
        }
    }

    /// Searches the own line of receivers whose interpolated slope is in doubt.
    #[inline(always)]
    fn search_doubtful(
        &self,
        receivers: &RowReceivers,
        doubts: &[f32; LINES],
        runs_m: &[[f32; LINES]; 2],
        tangents: &[[f32; LINES]; 2],
        slopes: &mut [f32; LANES],
    ) {
        for k in receivers.taken.clone() {
            if doubts[k] > AGREEMENT {
                let of = |pair: &[[f32; LINES]; 2]| [pair[0][k], pair[1][k]];
                let own = if doubts[k] == f32::INFINITY {
                    f32::NAN
                } else {
                    self.own(receivers, k, of(runs_m), of(tangents))
                };
                if own > slopes[k] || own.is_nan() {
                    slopes[k] = own;
                }
            }
        }
    }

    /// The slope on a receiver's own line, near where its two neighbours are touched.
    #[cold]
    #[inline(never)]
    fn own(&self, receivers: &RowReceivers, k: usize, runs_m: [f32; 2], tangents: [f32; 2]) -> f32 {
        let inverse_posting = 1.0 / self.fine().posting_m as f32;
        let steps = runs_m.map(|run_m| (run_m * inverse_posting + 0.5) as usize);
        let v = (receivers.row.low + 1 + k as isize) as usize;
        let reach = self.profile.reach(self.fine(), receivers.row.u, v);
        let own = self.profile.slope(self.fine(), receivers.row.u, v, receivers.observers_m[k], steps, reach)
            * inverse_posting;
        if steps[0].max(steps[1]) <= reach || self.levels.len() == 1 {
            return own;
        }
        // A touch on a coarser level, whose own line is not at hand: both lines see at least the lower one.
        let [below, above] = tangents;
        let lower = if below < above { below } else { above };
        let fraction = receivers.row.fraction as f32;
        larger(own, if steps[0].min(steps[1]) > reach { fraction * below + (1.0 - fraction) * above } else { lower })
    }

    /// Pushes where lines cross a column between a row and the one beyond it, if the surface stands above the chord there.
    #[inline(always)]
    fn push_columns(&self, registers: Registers, row: &CrossedRow, heights_m: &[f32; LINES], block: &mut Block) {
        let fine = self.fine();
        // All lines of a block cross their columns at the same distance.
        let beyond = row.fraction + self.ray.minor;
        let column = if beyond > 1.0 { 1 } else { 0 };
        let along = (column as f64 - row.fraction) / self.ray.minor;
        if (0.0..=1.0).contains(&beyond) || along <= LEAST || along >= 1.0 - LEAST {
            return;
        }
        let near: &[f32; LINES] = fine.lanes(row.u, row.low + column);
        let far: &[f32; LINES] = fine.lanes(row.u + self.ray.sign, row.low + column);
        let (along, rest) = (along as f32, 1.0 - along as f32);
        let x = row.x + along * fine.posting_m as f32;
        let unseen_m = UNSEEN * self.reach.max(1) as f32 * fine.posting_m as f32;
        let (mut heights_between_m, mut least_m) = ([0.0; LINES], [0.0; LINES]);
        for k in 0..LINES {
            heights_between_m[k] = rest * near[k] + along * far[k];
            least_m[k] = rest * heights_m[k] + along * block.beyond_m[k] + unseen_m;
        }
        let mut standing = larger_of(registers, &heights_between_m, &least_m);
        while standing != 0 {
            let k = standing.trailing_zeros() as usize % LINES;
            standing &= standing - 1;
            block.hulls[k].push(registers, Point { x, height_m: heights_between_m[k] });
        }
    }

    /// Pushes the first [`RING`] nodes of the level after `level` along a line that leaves `level`, widened by a slack.
    pub fn carry_on(&self, registers: Registers, level: usize, line: Line, slack_m: f64, hull: &mut Hull) {
        if let Some(next) = self.levels.get(level + 1) {
            let exit_m = self.levels[level].exit_x_m(line, slack_m);
            let ring_m = exit_m + RING * next.grid.posting_m;
            next.descend(line, exit_m, ring_m, |x, height_m| hull.push(registers, Point { x: x as f32, height_m }));
        }
    }
}

impl Default for Block {
    fn default() -> Self {
        Self { start: 0, hulls: std::array::from_fn(|_| Hull::default()), beyond_m: [LOWEST_M; LINES] }
    }
}

/// Heights of a block's lines on a row of nodes.
#[inline(always)]
fn sample(grid: &HeightGrid, row: &CrossedRow) -> [f32; LINES] {
    let (low, high): (&[f32; LINES], &[f32; LINES]) = (grid.lanes(row.u, row.low), grid.lanes(row.u, row.low + 1));
    let fraction = row.fraction as f32;
    let mut heights_m = [0.0; LINES];
    for k in 0..LINES {
        heights_m[k] = larger((1.0 - fraction) * low[k] + fraction * high[k], LOWEST_M);
    }
    heights_m
}
