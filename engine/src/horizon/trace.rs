//! The horizon of one point in one azimuth, exact on the bilinear surface, in `f64`.
//!
//! In the lifted map of [`Gnomonic`] a line of sight is straight, so the skyline is the largest slope from
//! the observer's lifted point `(X₀, H₀)` to the surface along the straight map line `X₀ + t d`:
//!
//! ```text
//! s = max over t of (H(X₀ + t d) − H₀)/t        tan ε = elevation_tangent(s)
//! ```
//!
//! The line is cut where it crosses the grid's rows and columns. Inside a cell the surface along it is a
//! parabola `c₀ + c₁t + c₂t²`, whose slope seen from the observer is largest at an end or, where
//! `c₀ − H₀ < 0` and `c₂ < 0`, at `t² = (c₀ − H₀)/c₂`. In the observer's own cell `c₀ = H₀`, so that the
//! slope tends to the facet's own, `c₁`. Nothing is sampled and nothing is clamped: a horizon may be negative.
//!
//! # Conventions
//! The finest level that covers a point is the surface there. Cells that touch a gap do not occlude, their
//! whole edges between valid nodes do. Beyond the last level lies the bare sphere ([`super::sphere`]).

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3};

use super::observer::{ON_GROUND_M, raised};
use super::settings::Settings;
use super::sphere::skyline_beyond;
use crate::grid;
use crate::terrain::{Face, Gnomonic, Level, Pyramid};

/// Mip of the blocks that are passed over at once: 32 × 32 cells.
const BLOCK_MIP: usize = 5;

/// The skyline in one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Skyline {
    /// Above the local horizontal; negative below it.
    pub elevation_rad: f64,
    /// Map distance to the point that makes the skyline; 0 where it is the observer's own facet.
    pub distance_m: f64,
}

/// Looks for skylines over the levels of a face.
#[derive(Debug, Clone, Copy)]
pub struct Tracer<'a> {
    map: &'a Gnomonic,
    levels: &'a [Level],
    /// Mipmaps of the levels; without them every cell is looked at.
    pyramids: &'a [Pyramid],
    settings: Settings,
    /// Nothing beyond the near terrain occludes, nor does the bare sphere.
    only_near: bool,
}

/// Elevation of the horizon of a point on the ground of `face` in a unit map direction, in radians.
pub fn elevation_rad(face: &Face, foot: DVec3, direction: DVec2, settings: &Settings) -> f64 {
    Tracer::new(face, settings).skyline(foot, direction).elevation_rad
}

impl<'a> Tracer<'a> {
    pub fn new(face: &'a Face, settings: &Settings) -> Self {
        Self::without_finer(face, 0, settings)
    }

    /// A tracer to which the levels finer than `level` do not exist.
    pub fn without_finer(face: &'a Face, level: usize, settings: &Settings) -> Self {
        Self { map: &face.map, levels: &face.levels[level..], pyramids: &[], settings: *settings, only_near: false }
    }

    /// A tracer of what `near` leaves out, and of nothing else.
    pub fn only_near(self) -> Self {
        Self { only_near: true, ..self }
    }

    /// The lifted point of the ground above a map point; `None` outside all levels.
    pub fn foot(&self, at_m: DVec2) -> Option<DVec3> {
        self.levels.iter().find_map(|level| Some(at_m.extend(level.bilinear_m(level.grid_from_map(at_m))?)))
    }

    /// The skyline from the observer's height above a lifted point `foot` of the ground.
    pub fn skyline(&self, foot: DVec3, direction: DVec2) -> Skyline {
        self.skyline_within(foot, direction, [-FRAC_PI_2, FRAC_PI_2])
    }

    /// A tracer that finds the skylines faster: blocks of cells whose highest point makes no difference are passed over.
    /// `pyramids` are those of the face's levels.
    pub fn with_pyramids(self, pyramids: &'a [Pyramid]) -> Self {
        Self { pyramids: &pyramids[pyramids.len() - self.levels.len()..], ..self }
    }

    /// The skyline if it stands between two elevations; else anything below the lower one, or the first terrain
    /// found that reaches the upper one. Whoever only asks how much of a disc is hidden need not look further.
    pub fn skyline_within(&self, foot: DVec3, direction: DVec2, [little_rad, enough_rad]: [f64; 2]) -> Skyline {
        let observer = raised(self.map, foot, self.settings.observer_height_m);
        let ground_m = self.foot(foot.truncate()).map_or(f64::NEG_INFINITY, |point| point.z);
        let on_ground = observer.z - ground_m < ON_GROUND_M;
        let observer = observer.truncate().extend(observer.z.max(ground_m));

        let end_m = self.levels.last().and_then(|level| stretch(level, observer.truncate(), direction));
        // The tangent is affine in the slope.
        let [level, one] = [0.0, 1.0].map(|slope| self.map.elevation_tangent(observer, direction, slope));
        let [little, enough] = [little_rad, enough_rad].map(|angle_rad| (angle_rad.tan() - level) / (one - level));
        let mut view =
            View { observer, direction, on_ground, little, enough, slope: f64::NEG_INFINITY, distance_m: 0.0 };
        if !self.only_near {
            let edge_m = end_m.map_or(0.0, |(_, out_m)| out_m);
            let (slope, distance_m) = skyline_beyond(self.map, observer, direction, edge_m);
            view.offer(slope, distance_m);
        }

        let [first_m, last_m] = self.reach_m(direction);
        for (index, level) in self.levels.iter().enumerate() {
            self.stretches(index, observer.truncate(), direction, &mut |from_m, to_m| {
                let (from_m, to_m) = (from_m.max(first_m), to_m.min(last_m));
                if from_m < to_m {
                    view.pass(level, self.pyramids.get(index), from_m, to_m, self.settings.search_limit_m());
                }
            });
        }
        let tangent = self.map.elevation_tangent(observer, direction, view.slope);
        Skyline { elevation_rad: tangent.atan(), distance_m: view.distance_m }
    }

    /// Map distances between which terrain counts.
    fn reach_m(&self, direction: DVec2) -> [f64; 2] {
        let near_m = self.levels.first().map_or(0.0, |level| self.settings.near_m(level.posting_m, direction));
        if self.only_near { [0.0, near_m] } else { [near_m, f64::INFINITY] }
    }

    /// Map distances between which the ray `at + t d` runs over a level where no finer one covers it.
    pub(super) fn stretches(&self, level: usize, at_m: DVec2, direction: DVec2, found: &mut dyn FnMut(f64, f64)) {
        if let Some((in_m, out_m)) = stretch(&self.levels[level], at_m, direction) {
            self.uncovered(level, at_m, direction, [in_m, out_m], found);
        }
    }

    /// The parts of an interval that none of the levels finer than `level` covers.
    fn uncovered(&self, level: usize, at_m: DVec2, towards: DVec2, [a, b]: [f64; 2], found: &mut dyn FnMut(f64, f64)) {
        if a >= b {
            return;
        }
        let Some(finer) = level.checked_sub(1) else { return found(a, b) };
        match stretch(&self.levels[finer], at_m, towards) {
            None => self.uncovered(finer, at_m, towards, [a, b], found),
            Some((from_m, to_m)) => {
                self.uncovered(finer, at_m, towards, [a, b.min(from_m)], found);
                self.uncovered(finer, at_m, towards, [a.max(to_m), b], found);
            }
        }
    }

    /// The larger of a slope and the steepest one over a level between two map distances, seen from a lifted point.
    pub(super) fn steepest(
        &self,
        level: usize,
        observer: DVec3,
        direction: DVec2,
        ends_m: [f64; 2],
        slope: f64,
    ) -> f64 {
        let mut view = View {
            observer,
            direction,
            on_ground: self.settings.observer_height_m < ON_GROUND_M,
            little: f64::NEG_INFINITY,
            enough: f64::INFINITY,
            slope,
            distance_m: 0.0,
        };
        view.walk(&self.levels[level], ends_m[0], ends_m[1], self.settings.search_limit_m());
        view.slope
    }
}

/// Where the ray `at + t d`, `t ≥ 0`, runs inside a level.
fn stretch(level: &Level, at_m: DVec2, direction: DVec2) -> Option<(f64, f64)> {
    let low = level.node_m(0, 0);
    let high = level.node_m(level.columns - 1, level.rows - 1);
    let mut range = (0.0_f64, f64::INFINITY);
    for axis in 0..2 {
        if direction[axis] == 0.0 {
            if at_m[axis] < low[axis] || at_m[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let (a, b) = ((low[axis] - at_m[axis]) / direction[axis], (high[axis] - at_m[axis]) / direction[axis]);
        range = (range.0.max(a.min(b)), range.1.min(a.max(b)));
    }
    (range.0 <= range.1).then_some(range)
}

/// The best slope found so far along one line of sight.
struct View {
    observer: DVec3,
    direction: DVec2,
    on_ground: bool,
    /// Slopes that nobody tells apart: all below the one, all above the other.
    little: f64,
    enough: f64,
    slope: f64,
    distance_m: f64,
}

impl View {
    fn offer(&mut self, slope: f64, distance_m: f64) {
        if slope > self.slope {
            (self.slope, self.distance_m) = (slope, distance_m);
        }
    }

    /// The blocks of a level between two map distances: their cells where their highest point makes a difference.
    fn pass(&mut self, level: &Level, pyramid: Option<&Pyramid>, from_m: f64, to_m: f64, search_m: f64) {
        let Some(mip) = pyramid.and_then(|pyramid| pyramid.mips.get(BLOCK_MIP)) else {
            return self.walk(level, from_m, to_m, search_m);
        };
        let cells = (1 << BLOCK_MIP) as f64;
        let start = on_node(level.grid_from_map(self.observer.truncate())) / cells;
        let rate = self.direction / level.posting_m / cells;
        let mut lines = [Crossings::after(start.x, rate.x, from_m), Crossings::after(start.y, rate.y, from_m)];
        let mut from_m = from_m;
        while from_m < to_m && from_m <= search_m && self.slope < self.enough {
            let next_m = lines[0].next_m.min(lines[1].next_m).min(to_m);
            if next_m > from_m {
                let middle = start + rate * (0.5 * (from_m + next_m));
                let block = |value: f64, blocks: usize| (value.max(0.0) as usize).min(blocks - 1);
                let index = block(middle.y, mip.rows) * mip.columns + block(middle.x, mip.columns);
                let rise_m = f64::from(mip.maxima_m[index]) - self.observer.z;
                let steepest_m = if rise_m > 0.0 { from_m } else { next_m };
                if rise_m > self.slope.max(self.little) * steepest_m {
                    self.walk(level, from_m, next_m, search_m);
                }
            }
            lines.iter_mut().filter(|line| line.next_m <= next_m).for_each(Crossings::advance);
            from_m = next_m;
        }
    }

    /// Every cell of a level between two map distances that is left within the search distance.
    fn walk(&mut self, level: &Level, from_m: f64, to_m: f64, search_m: f64) {
        let start = on_node(level.grid_from_map(self.observer.truncate()));
        let rate = self.direction / level.posting_m;
        let mut lines = [Crossings::after(start.x, rate.x, from_m), Crossings::after(start.y, rate.y, from_m)];
        let mut from_m = from_m;
        while from_m < to_m {
            let next_m = lines[0].next_m.min(lines[1].next_m).min(to_m);
            if next_m > search_m || self.slope >= self.enough {
                return;
            }
            if next_m > from_m {
                self.cell(level, start, rate, from_m, next_m);
            }
            lines.iter_mut().filter(|line| line.next_m <= next_m).for_each(Crossings::advance);
            from_m = next_m;
        }
    }

    /// The surface between two distances inside one cell.
    fn cell(&mut self, level: &Level, start: DVec2, rate: DVec2, from_m: f64, to_m: f64) {
        let middle = start + rate * (0.5 * (from_m + to_m));
        let corner = |value: f64, nodes: usize| (value.max(0.0) as usize).min(nodes - 2);
        let (column, row) = (corner(middle.x, level.columns), corner(middle.y, level.rows));
        let cell = Cell::of(level, column, row, start, rate);
        for t_m in [from_m, to_m] {
            if t_m > 0.0
                && let Some(height_m) = cell.height_m(t_m)
            {
                self.offer((height_m - self.observer.z) / t_m, t_m);
            }
        }
        if cell.gaps != [false; 4] {
            return;
        }
        let [c0, c1, c2] = cell.parabola();
        if from_m == 0.0 && self.on_ground {
            return self.offer(c1, 0.0);
        }
        let below_m = c0 - self.observer.z;
        if below_m < 0.0 && c2 < 0.0 {
            let t_m = (below_m / c2).sqrt();
            if from_m < t_m && t_m < to_m {
                self.offer(c1 + 2.0 * c2 * t_m, t_m);
            }
        }
    }
}

/// A grid point moved onto the grid lines that it misses by rounding: a sliver of the cell behind the
/// observer must not pass for his own facet.
fn on_node(grid: DVec2) -> DVec2 {
    let nearest = grid.round();
    DVec2::select((grid - nearest).abs().cmplt(DVec2::splat(1e-9)), nearest, grid)
}

/// Distances at which a line crosses the grid lines of one axis.
struct Crossings {
    start: f64,
    rate: f64,
    index: f64,
    next_m: f64,
}

impl Crossings {
    fn after(start: f64, rate: f64, from_m: f64) -> Self {
        let here = start + rate * from_m;
        let index = if rate > 0.0 { here.floor() } else { here.ceil() };
        let mut crossings = Self { start, rate, index, next_m: f64::INFINITY };
        crossings.advance();
        crossings
    }

    fn advance(&mut self) {
        if self.rate != 0.0 {
            self.index += self.rate.signum();
            self.next_m = (self.index - self.start) / self.rate;
        }
    }
}

/// A bilinear cell along a line: `f = offset + t rate` are its coordinates, 0 to 1.
struct Cell {
    heights_m: [f64; 4],
    gaps: [bool; 4],
    offset: DVec2,
    rate: DVec2,
}

impl Cell {
    fn of(level: &Level, column: usize, row: usize, start: DVec2, rate: DVec2) -> Self {
        let gaps = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(c, r)| level.gap[level.index(column + c, row + r)]);
        let offset = start - DVec2::new(column as f64, row as f64);
        Self { heights_m: level.corners_m(column, row), gaps, offset, rate }
    }

    /// `None` where a gap takes part in the height.
    fn height_m(&self, t_m: f64) -> Option<f64> {
        let f = (self.offset + self.rate * t_m).clamp(DVec2::ZERO, DVec2::ONE);
        let weights = grid::weights(f);
        let touched = self.gaps.iter().zip(weights).any(|(gap, weight)| *gap && weight > 1e-6);
        (!touched).then(|| self.heights_m.iter().zip(weights).map(|(height_m, weight)| height_m * weight).sum())
    }

    /// `c₀, c₁, c₂` of the surface along the line.
    fn parabola(&self) -> [f64; 3] {
        let [h00, h10, h01, h11] = self.heights_m;
        let (east, north, twist) = (h10 - h00, h01 - h00, h00 - h10 - h01 + h11);
        let (o, r) = (self.offset, self.rate);
        [
            h00 + east * o.x + north * o.y + twist * o.x * o.y,
            east * r.x + north * r.y + twist * (o.x * r.y + o.y * r.x),
            twist * r.x * r.y,
        ]
    }
}
