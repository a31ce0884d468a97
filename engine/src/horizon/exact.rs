//! The horizons of all nodes of a level, one azimuth at a time, exact on the bilinear surface: branch and bound.
//!
//! All receivers share the offsets and weights of an azimuth's crossings, so that one crossing serves many of them
//! with contiguous loads ([`stencil`]), and so does one bound: the maximum of the nodes beside 8, 32 or 128 steps of a line
//! ([`maxima`]). From a receiver at height `H₀` whose steepest slope so far is `s`, a stretch of line between the
//! distances `a` and `b` with maximum `M` hides nothing steeper if
//!
//! ```text
//! M − H₀ ≤ s t   for all t in a … b,   that is   M − H₀ ≤ min(s a, s b)
//! ```
//!
//! Stretches for which no receiver of a group passes this test are left out, the others are halved, quartered and at last
//! searched crossing by crossing. Coarser levels are bounded by the same maxima, receiver by receiver, and searched by the
//! trace itself ([`coarser_levels`]). Neither sampling nor interpolation takes part: what remains is the rounding of `f32`.
//!
//! # The certificate
//! With `u = 2⁻²⁴`, heights that are differences of `f32` nodes, and `G` the steepest step between two nodes of the
//! level, a slope `s` is wrong by no more than `32 u (|s| + G)`; the angle of a slope by no more than
//! [`ANGLE_ROUNDING_RAD`]. [`Exact::intervals_rad`] gives the elevations between which the skyline of the bilinear
//! surface lies. A raised observer's height is rounded once more, by `u |H₀|` seen over the shortest distance, a posting.
//!
//! # Assumptions
//! Levels finer than the searched one do not exist, as in the sweep. Tests hold the intervals to the trace.

pub mod coarser_levels;
pub mod maxima;
pub mod stencil;

use glam::{DVec2, DVec3};

use super::axis::Major;
use super::lanes::{LANES, lanes};
use super::observer::ON_GROUND_M;
use super::receivers::Receivers;
use super::settings::Settings;
use super::sweep::angle::Shape;
use super::sweep::grid::{HeightGrid, NEVER_M};
use super::sweep::ray::Ray;
use super::trace::Tracer;
use super::wide::wide;
use crate::terrain::Face;
use coarser_levels::CoarserLevels;
use maxima::{Maxima, STEPS};
use stencil::Stencil;

/// Nodes around the heights: a group of receivers reads past the sides until its last one has left.
const PAD: usize = LANES + 8;

/// Half the step between 1 and the next `f32`.
const ROUNDING: f64 = 1.0 / (1 << 24) as f64;

/// Rounding on the way from a slope to an elevation in `f32`: ten operations and the arc tangent's 2e-7.
pub const ANGLE_ROUNDING_RAD: f64 = 1e-6;

/// Elevations between which a skyline lies, in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    pub low_rad: f32,
    pub high_rad: f32,
}

impl Interval {
    pub fn contains(&self, elevation_rad: f64) -> bool {
        (f64::from(self.low_rad)..=f64::from(self.high_rad)).contains(&elevation_rad)
    }
}

/// All that the azimuths along one major axis share.
#[derive(Debug)]
pub struct Exact<'a> {
    face: &'a Face,
    level: usize,
    settings: Settings,
    major: Major,
    tracer: Tracer<'a>,
    grids: Vec<HeightGrid>,
    twists_m: Vec<f32>,
    /// The steepest step between neighbouring nodes, as a slope.
    steepest: f64,
    /// Whether each receiver is searched.
    wanted: Vec<bool>,
    pub receivers: Receivers,
}

impl<'a> Exact<'a> {
    /// Prepares one level of a face for the azimuths along `major`.
    pub fn new(face: &'a Face, level: usize, major: Major, settings: &Settings) -> Self {
        let grids: Vec<_> = face.levels[level..].iter().map(|level| HeightGrid::new(level, major, PAD, 0.0)).collect();
        let twists_m = grids[0].twists_m();
        let receivers = Receivers::new(face, &face.levels[level], major, 0.0, settings);
        let tracer = Tracer::without_finer(face, level, settings);
        let steepest = steepest(&grids[0]);
        let wanted = vec![true; receivers.observers_m.len()];
        Self { face, level, settings: *settings, major, tracer, grids, twists_m, steepest, wanted, receivers }
    }

    /// Searches these nodes of the seen part, (column, row), and leaves the others without a skyline that means anything.
    pub fn only(mut self, nodes: &[[usize; 2]]) -> Self {
        self.wanted.fill(false);
        for node in nodes {
            self.wanted[self.receivers.index(self.major, *node)] = true;
        }
        self
    }

    /// Elevations of the skyline in a unit map direction along this axis, as `receivers` are laid out, in radians.
    pub fn elevations_rad(&self, direction: DVec2) -> Vec<f32> {
        let ray = self.ray(direction);
        let mut plane = self.slopes(&ray, direction);
        self.turn_into_elevations(&ray, &mut plane);
        plane
    }

    /// The elevations between which the skylines lie, whatever was rounded.
    pub fn intervals_rad(&self, direction: DVec2) -> Vec<Interval> {
        let ray = self.ray(direction);
        let slopes = self.slopes(&ray, direction);
        let [low, high] = [-1.0, 1.0].map(|side| {
            let moved = slopes.iter().zip(&self.receivers.observers_m);
            let mut plane: Vec<f32> = moved
                .map(|(&slope, &height_m)| (f64::from(slope) + side * self.slack(slope, height_m)) as f32)
                .collect();
            self.turn_into_elevations(&ray, &mut plane);
            plane.iter_mut().for_each(|rad| *rad = (f64::from(*rad) + side * ANGLE_ROUNDING_RAD) as f32);
            plane
        });
        low.into_iter().zip(high).map(|(low_rad, high_rad)| Interval { low_rad, high_rad }).collect()
    }

    fn ray(&self, direction: DVec2) -> Ray {
        Ray::new(direction, self.major, self.grids[0].posting_m, self.settings.search_limit_m())
    }

    /// How far a slope may be off.
    fn slack(&self, slope: f32, observer_m: f32) -> f64 {
        let raised = if self.settings.observer_height_m == 0.0 { 0.0 } else { f64::from(observer_m.abs()) };
        32.0 * ROUNDING * (f64::from(slope.abs()) + self.steepest) + ROUNDING * raised / self.grids[0].posting_m
    }

    /// The steepest slopes, in metres per map metre.
    fn slopes(&self, ray: &Ray, direction: DVec2) -> Vec<f32> {
        let fine = &self.grids[0];
        let on_ground = self.settings.observer_height_m < ON_GROUND_M;
        let stencil = Stencil::new(fine, ray, on_ground);
        let maxima = Maxima::new(fine, &self.twists_m, ray);
        let mut plane = vec![NEVER_M; self.receivers.observers_m.len()];
        wide(
            #[inline(always)]
            || self.search(&stencil, &maxima, ray, &mut plane),
        );
        let scale = (1.0 / (ray.length * fine.posting_m)) as f32;
        plane.iter_mut().for_each(|slope| *slope *= scale);
        if self.grids.len() > 1 {
            CoarserLevels::new(self, ray, direction).raise(&mut plane);
        }
        plane
    }

    /// The steepest slopes over the searched level itself, in metres per step.
    #[inline(always)]
    fn search(&self, stencil: &Stencil, maxima: &Maxima, ray: &Ray, plane: &mut [f32]) {
        let (fine, r) = (&self.grids[0], &self.receivers);
        for start in (0..r.minors).step_by(LANES) {
            for u in 0..r.majors {
                let i = u * r.stride + start;
                if !self.wanted[i..i + LANES].contains(&true) {
                    continue;
                }
                let observers_m: &[f32; LANES] = r.observers_m[i..i + LANES].try_into().expect("LANES");
                let best: &mut [f32; LANES] = (&mut plane[i..i + LANES]).try_into().expect("LANES");
                // Lanes without a receiver want nothing.
                best[(r.minors - start).min(LANES)..].fill(f32::INFINITY);
                let group = Group {
                    exact: self,
                    stencil,
                    maxima,
                    at: fine.at(u + r.margin, start + r.margin),
                    observers_m,
                    end: reach(fine, ray, u + r.margin, start + r.margin),
                };
                group.search(best);
            }
        }
    }

    /// From slopes to elevations above the local horizontal, the bare sphere included.
    fn turn_into_elevations(&self, ray: &Ray, plane: &mut [f32]) {
        let shape = Shape { map: &self.face.map, grids: &self.grids, receivers: &self.receivers, datum_m: 0.0 };
        shape.turn_into_elevations(ray, 1.0, plane);
    }

    /// Lifted point of the ground under a receiver.
    pub fn foot(&self, u: usize, v: usize) -> DVec3 {
        self.major.foot(&self.face.levels[self.level], u, v)
    }
}

/// Receivers side by side that look the same way.
struct Group<'a> {
    exact: &'a Exact<'a>,
    stencil: &'a Stencil,
    maxima: &'a Maxima,
    /// Node of the first one.
    at: usize,
    observers_m: &'a [f32; LANES],
    /// Steps after which the last one has left the grid.
    end: usize,
}

impl Group<'_> {
    #[inline(always)]
    fn search(&self, best: &mut [f32; LANES]) {
        let [_, short, middle, long] = STEPS;
        self.leaf(0, short, best);
        let mut from = short;
        while from < self.end {
            // The longest stretch that is not much longer than it is far.
            let table = if from >= long { 3 } else { 1 + usize::from(from >= middle) };
            self.descend(table, from, best);
            from += STEPS[table];
        }
    }

    /// Searches a stretch unless its maximum says that there is nothing in it.
    #[inline(always)]
    fn descend(&self, table: usize, from: usize, best: &mut [f32; LANES]) {
        if !self.promises(table, from, best) {
            return;
        }
        match table {
            1 => self.leaf(from, from + STEPS[1], best),
            2 => self.parts(from, best),
            _ => {
                for from in (from..(from + STEPS[3]).min(self.end)).step_by(STEPS[2]) {
                    if self.promises(2, from, best) {
                        self.parts(from, best);
                    }
                }
            }
        }
    }

    #[inline(always)]
    fn parts(&self, from: usize, best: &mut [f32; LANES]) {
        for from in (from..(from + STEPS[2]).min(self.end)).step_by(STEPS[1]) {
            if self.promises(1, from, best) {
                self.leaf(from, from + STEPS[1], best);
            }
        }
    }

    /// Whether a stretch may hide something steeper from one of the receivers.
    #[inline(always)]
    fn promises(&self, table: usize, from: usize, best: &[f32; LANES]) -> bool {
        let maxima_m = lanes(&self.maxima.tables[table], self.at, self.stencil.rows[from]);
        let (near, far) = (from as f32, (from + STEPS[table]) as f32);
        let mut promising = 0;
        for lane in 0..LANES {
            let rise_m = maxima_m[lane] - self.observers_m[lane];
            let (a, b) = (best[lane] * near, best[lane] * far);
            promising |= u32::from(rise_m > if a < b { a } else { b });
        }
        promising != 0
    }

    #[inline(always)]
    fn leaf(&self, from: usize, to: usize, best: &mut [f32; LANES]) {
        let grid = &self.exact.grids[0];
        let to = to.min(self.end);
        self.stencil.raise(&grid.heights_m, &self.exact.twists_m, self.at, self.observers_m, [from, to], best);
    }
}

/// Steps after which all receivers of a group have left the grid or the search.
fn reach(grid: &HeightGrid, ray: &Ray, u: usize, v: usize) -> usize {
    let majors = if ray.sign > 0 { grid.majors - 1 - u } else { u };
    let columns = if ray.minor > 0.0 { grid.minors.saturating_sub(v) } else { v + LANES };
    let minors = if ray.minor == 0.0 { f64::INFINITY } else { columns as f64 / ray.minor.abs() };
    // What lies between two rows counts with the farther one.
    (majors as f64).min(minors.ceil()).min(ray.search_steps.ceil()) as usize
}

/// The steepest step between two neighbouring nodes, as a slope.
fn steepest(grid: &HeightGrid) -> f64 {
    let mut step_m = 0.0_f32;
    for u in 0..grid.majors {
        for v in 0..grid.minors {
            let at = grid.at(u, v);
            for next in [at + 1, at + grid.stride] {
                let change_m = (grid.heights_m[next] - grid.heights_m[at]).abs();
                // A step into a gap is none.
                if change_m > step_m && change_m < -0.1 * NEVER_M {
                    step_m = change_m;
                }
            }
        }
    }
    f64::from(step_m) / grid.posting_m
}
