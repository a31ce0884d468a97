//! The horizons of all nodes of a level, one azimuth at a time.
//!
//! In the lifted map an azimuth is a family of parallel straight lines, so that a skyline is a tangent of slope `s`
//! from a receiver to the surface along its line. For one azimuth:
//!
//! 1. unless what is near is left out ([`Settings::near`]), [`near`]: every crossing of the first [`near::NEAR`] steps and the middle of every cell passed, many receivers at once,
//!    and where a cell may hide a hump that matters, the hump;
//! 2. [`far`]: tangents to convex hulls of lines a posting apart, built while they are asked, and where interpolation
//!    between two lines may err by more than 0.01° the receiver's own line about both touching points, exactly ([`profile`]);
//! 3. [`coarser_levels`]: tangents to the hulls of coarser levels;
//! 4. [`angle`]: the steepest slope, or the bare sphere's, as an elevation above the local horizontal.
//!
//! The axis along which a line advances by whole nodes is the *major* one (`u`), the other the *minor* one (`v`).
//! Nothing is quantised and nothing is clamped. The result does not depend on threads or on the machine.
//!
//! # Assumptions
//! Levels finer than the swept one do not exist: a coarse tile sees its own coarse surface where a finer one lies. A line's
//! far skyline is looked for where its two neighbours have theirs. Elevations differ from traced ones by 0.01° or less in 99 of
//! 100 samples (`docs/experiments/horizon_sweep_errors.md`), but for the two nodes next to the edge of a finer level, where a
//! coarser one does not meet it. A tile measures its own error.
//!
//! # References
//! Barrett, *Linear-time horizon sweep*; Timonen & Westerholm (2010), *Scalable height field self-shadowing*.

pub mod angle;
pub mod coarser_levels;

#[allow(clippy::needless_range_loop, reason = "several arrays are indexed alike")]
pub mod far;
pub mod grid;
#[allow(clippy::needless_range_loop, reason = "several arrays are indexed alike")]
pub mod hull;
pub mod line;
#[allow(clippy::needless_range_loop, reason = "several arrays are indexed alike")]
pub mod near;
pub mod profile;
pub mod ray;

use glam::{DVec2, DVec3};

use super::axis::Major;
use super::lanes::{LANES, larger, largest};
use super::receivers::Receivers;
use super::settings::Settings;
use super::trace::Tracer;
use super::wide::{Registers, prefetch, widest};
use crate::terrain::{Face, Level};
use angle::Shape;
use coarser_levels::CoarserHulls;
use far::{BLOCK, Block, Far, RowReceivers};
use grid::{HeightGrid, NEVER_M, middle_m};
use line::PlacedGrid;
use near::{NEAR, Site, Stencil};
use profile::Profile;
use ray::Ray;

/// Changes with the last digits of what is found: a tile that was kept is not taken for what would be made today.
pub const REVISION: u8 = 2;

/// Near slopes that may be this much too low are searched again: 0.01°.
const HUMP: f32 = 2e-4;

/// All that the azimuths along one major axis share.
#[derive(Debug)]
pub struct Sweep<'a> {
    face: &'a Face,
    level: usize,
    settings: Settings,
    major: Major,
    datum_m: f64,
    grids: Vec<HeightGrid>,
    twists_m: Vec<f32>,
    pub receivers: Receivers,
}

impl<'a> Sweep<'a> {
    /// Prepares one level of a face for the azimuths along `major`.
    pub fn new(face: &'a Face, level: usize, major: Major, settings: &Settings) -> Self {
        let levels = &face.levels[level..];
        let datum_m = middle_m(&levels[0]);
        let widened = levels.get(1).map(|coarser| widened(&levels[0], coarser, NEAR + 2));
        let fine = widened.as_ref().unwrap_or(&levels[0]);
        let coarser = levels[1..].iter().map(|level| HeightGrid::new(level, major, 1, datum_m));
        let grids: Vec<_> = std::iter::once(HeightGrid::new(fine, major, NEAR + 2, datum_m)).chain(coarser).collect();
        let twists_m = grids[0].twists_m();
        let receivers = Receivers::new(face, fine, major, datum_m, settings);
        Self { face, level, settings: *settings, major, datum_m, grids, twists_m, receivers }
    }

    /// Elevations of the skyline in a unit map direction along this sweep's major axis, as `Receivers` are laid
    /// out, in radians.
    pub fn elevations_rad(&self, direction: DVec2) -> Vec<f32> {
        let ray = Ray::new(direction, self.major, self.grids[0].posting_m, self.settings.search_limit_m());
        let fine = &self.grids[0];
        let pivot_m = fine.origin_m + DVec2::new((fine.majors / 2) as f64 * fine.posting_m, 0.0);
        let levels = self.grids.iter().map(|grid| PlacedGrid::new(grid, &ray, pivot_m)).collect();
        let profile = Profile::new(fine, &ray, self.settings.near);
        let far = Far { ray: &ray, receivers: &self.receivers, levels, profile, reach: self.near_steps() };
        let mut plane = vec![0.0; self.receivers.observers_m.len()];
        let stencil = match self.settings.near {
            0 => Some(Stencil::new(fine, &ray, NEAR, self.settings.observer_height_m == 0.0)),
            _ => None,
        };
        widest(
            #[inline(always)]
            |registers| {
                self.slopes(registers, &far, stencil.as_ref(), &mut plane);
                self.add_coarser_levels(registers, &far, &mut plane);
            },
        );
        // Slopes were taken in metres per step along the major axis.
        let shape =
            Shape { map: &self.face.map, grids: &self.grids, receivers: &self.receivers, datum_m: self.datum_m };
        shape.turn_into_elevations(&ray, (1.0 / ray.length) as f32, &mut plane);
        self.retrace(direction, &mut plane);
        plane
    }

    /// Major steps before the first row that hulls hold.
    fn near_steps(&self) -> usize {
        if self.settings.near == 0 { NEAR } else { self.settings.near - 1 }
    }

    /// Slopes to what lies on the level and on the next one close by, in metres per metre along the major axis.
    #[inline(always)]
    fn slopes(&self, registers: Registers, far: &Far, stencil: Option<&Stencil>, plane: &mut [f32]) {
        let fine = &self.grids[0];
        let mut block = Block::default();
        for start in far.starts() {
            let Some(nearest) = far.nearest_served(start) else { continue };
            far.begin(registers, start, &mut block);
            for along in (nearest..fine.majors as isize).rev() {
                self.serve(registers, far, stencil, along, &mut block, plane);
            }
        }
    }

    /// The receivers of a block in one row.
    #[inline(always)]
    fn serve(
        &self,
        registers: Registers,
        far: &Far,
        stencil: Option<&Stencil>,
        along: isize,
        block: &mut Block,
        plane: &mut [f32],
    ) {
        let (fine, r) = (&self.grids[0], &self.receivers);
        let scale = (1.0 / fine.posting_m) as f32;
        let ahead = along + far.reach as isize + 1;
        let row = far.row(block.start, along);
        let Some((u, taken)) = far.taken_receivers(&row) else {
            far.advance(registers, ahead, block);
            return;
        };
        let first = row.low + 1 - r.margin as isize;
        let observers_m = r.lanes_m(u, first);
        // The next row is a page away, where no processor guesses it.
        let next = far.row(block.start, along - 1);
        let next_row = (next.u - r.margin as isize) * r.stride as isize + next.low - r.margin as isize;
        let next_at = fine.at(0, 0).wrapping_add_signed(next.u * fine.stride as isize + next.low);
        for lane in [0, 16, 32] {
            prefetch(&r.observers_m, next_row.wrapping_add(lane) as usize);
            prefetch(&self.twists_m, next_at.wrapping_add_signed(lane));
            prefetch(&fine.heights_m, next_at.wrapping_add_signed(lane));
        }
        let receivers = RowReceivers { row, taken, observers_m: &observers_m };
        let query = far.ask(registers, ahead, block, &receivers);
        let at = fine.at(row.u as usize, 0).wrapping_add_signed(row.low + 1);
        let site = Site { heights_m: &fine.heights_m, twists_m: &self.twists_m, at, observers_m: &observers_m };
        let [mut slopes, perhaps] = stencil.map_or([[NEVER_M; LANES]; 2], |stencil| site.slopes(stencil));
        for slope in &mut slopes {
            *slope *= scale;
        }
        far.answer(block, &receivers, &query, &mut slopes);
        if let Some(stencil) = stencil {
            let mut missed = [0.0; LANES];
            for k in 0..LANES {
                missed[k] = perhaps[k] * scale - slopes[k];
            }
            if largest(&missed) > HUMP {
                let exact = site.exact_slopes(stencil);
                for k in 0..LANES {
                    slopes[k] = larger(slopes[k], exact[k] * scale);
                }
            }
        }
        let RowReceivers { taken, .. } = receivers;
        let seen = &mut plane[(u * r.stride).wrapping_add_signed(first + taken.start as isize)..][..taken.len()];
        if taken.len() == BLOCK {
            // A length that the compiler knows.
            seen.copy_from_slice(&slopes[..BLOCK]);
        } else {
            seen.copy_from_slice(&slopes[taken]);
        }
    }

    /// Raises far slopes to those of coarser levels.
    #[inline(always)]
    fn add_coarser_levels(&self, registers: Registers, far: &Far, slopes: &mut [f32]) {
        let (fine, r) = (&self.grids[0], &self.receivers);
        for hulls in (1..far.levels.len()).map(|level| CoarserHulls::new(registers, far, level)) {
            for u in 0..r.majors {
                let x_m =
                    (far.ray.sign * ((u + r.margin) as isize - (fine.majors / 2) as isize)) as f64 * fine.posting_m;
                for start in (0..r.stride).step_by(LANES) {
                    let i = u * r.stride + start;
                    let observers_m: &[f32; LANES] = r.observers_m[i..i + LANES].try_into().expect("LANES");
                    let y_m = (start + r.margin) as f64 * fine.posting_m;
                    let found = hulls.slopes(registers, x_m, y_m, fine.posting_m, observers_m);
                    for (slope, found) in slopes[i..i + LANES].iter_mut().zip(found) {
                        // NaN stays: it asks for a trace.
                        *slope = if found > *slope || found.is_nan() { found } else { *slope };
                    }
                }
            }
        }
    }

    /// Traces the receivers whose tangent touched beyond the search distance.
    fn retrace(&self, direction: DVec2, plane: &mut [f32]) {
        if self.settings.search_m.is_none() {
            return;
        }
        let tracer = Tracer::without_finer(self.face, self.level, &self.settings);
        let r = &self.receivers;
        for u in 0..r.majors {
            for v in 0..r.minors {
                let elevation = &mut plane[u * r.stride + v];
                if elevation.is_nan() {
                    *elevation = tracer.skyline(self.foot(u, v), direction).elevation_rad as f32;
                }
            }
        }
    }

    /// Lifted point of the ground under a receiver.
    pub fn foot(&self, u: usize, v: usize) -> DVec3 {
        self.major.foot(&self.face.levels[self.level], u, v)
    }
}

/// A level with a margin of the coarser level's surface around it, so that the near field of its outermost nodes is exact too.
fn widened(level: &Level, coarser: &Level, nodes: usize) -> Level {
    let (columns, rows) = (level.columns + 2 * nodes, level.rows + 2 * nodes);
    let mut wide = Level {
        columns,
        rows,
        posting_m: level.posting_m,
        west_m: level.west_m - nodes as f64 * level.posting_m,
        south_m: level.south_m - nodes as f64 * level.posting_m,
        heights_m: vec![0.0; columns * rows],
        gap: vec![true; columns * rows],
        margin: level.margin + nodes,
    };
    for row in 0..rows {
        for column in 0..columns {
            let node = wide.index(column, row);
            let (inner_column, inner_row) = (column.wrapping_sub(nodes), row.wrapping_sub(nodes));
            if inner_column < level.columns && inner_row < level.rows {
                let inner = level.index(inner_column, inner_row);
                (wide.heights_m[node], wide.gap[node]) = (level.heights_m[inner], level.gap[inner]);
                continue;
            }
            let grid = coarser.grid_from_map(wide.node_m(column, row));
            let Some((c, r)) = coarser.cell(grid) else { continue };
            if [(0, 0), (1, 0), (0, 1), (1, 1)].iter().all(|(x, y)| !coarser.gap[coarser.index(c + x, r + y)]) {
                wide.heights_m[node] = coarser.bilinear_m(grid).expect("the cell is inside") as f32;
                wide.gap[node] = false;
            }
        }
    }
    wide
}
