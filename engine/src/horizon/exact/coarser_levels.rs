//! The skyline over coarser levels, receiver by receiver.
//!
//! A receiver's line enters a coarser level between its nodes, but passes its rows as any line does: the same maxima
//! bound it. What they do not rule out is searched by the trace, in `f64`.

use glam::{DVec2, DVec3};

use super::Exact;
use super::maxima::{Maxima, STEPS};
use crate::horizon::observer::raised;
use crate::horizon::sweep::grid::HeightGrid;
use crate::horizon::sweep::ray::Ray;

/// A coarser level as one azimuth sees it.
#[derive(Debug)]
struct Coarse<'a> {
    /// Counted from the searched level.
    level: usize,
    grid: &'a HeightGrid,
    maxima: Maxima,
    /// Map metres along the line per major step.
    step_m: f64,
}

/// All coarser levels.
#[derive(Debug)]
pub struct CoarserLevels<'a> {
    exact: &'a Exact<'a>,
    ray: &'a Ray,
    direction: DVec2,
    levels: Vec<Coarse<'a>>,
}

/// One receiver.
struct Receiver {
    observer: DVec3,
    /// Major and minor map coordinates.
    place_m: DVec2,
    slope: f64,
    /// Level, and row along the line, of the step in which the steepest slope was found.
    touched: Option<(usize, f64)>,
}

impl<'a> CoarserLevels<'a> {
    pub fn new(exact: &'a Exact<'a>, ray: &'a Ray, direction: DVec2) -> Self {
        let coarse = |(level, grid): (usize, &'a HeightGrid)| Coarse {
            level,
            grid,
            maxima: Maxima::new(grid, &grid.twists_m(), ray),
            step_m: ray.length * grid.posting_m,
        };
        let levels = exact.grids.iter().enumerate().skip(1).map(coarse).collect();
        Self { exact, ray, direction, levels }
    }

    /// Raises slopes, in metres per map metre, to those over coarser levels.
    pub fn raise(&self, plane: &mut [f32]) {
        let r = &self.exact.receivers;
        for u in 0..r.majors {
            // Neighbours often see the same ridge: where one has found it the next one looks first.
            let mut touched = None;
            for v in 0..r.minors {
                if !self.exact.wanted[u * r.stride + v] {
                    continue;
                }
                let slope = &mut plane[u * r.stride + v];
                let foot = self.exact.foot(u, v);
                let observer = raised(&self.exact.face.map, foot, self.exact.settings.observer_height_m);
                let place_m = self.exact.major.split(observer.truncate());
                let mut receiver = Receiver { observer, place_m, slope: f64::from(*slope), touched };
                let before = receiver.slope;
                self.look(&mut receiver);
                if receiver.slope > before {
                    *slope = receiver.slope as f32;
                }
                touched = receiver.touched;
            }
        }
    }

    fn look(&self, receiver: &mut Receiver) {
        let search_m = self.exact.settings.search_limit_m();
        for coarse in &self.levels {
            self.exact.tracer.stretches(
                coarse.level,
                receiver.observer.truncate(),
                self.direction,
                &mut |from_m, to_m| {
                    self.pass(coarse, receiver, [from_m, to_m], search_m);
                },
            );
        }
    }

    /// One stretch of a level: its parts from `STEPS` to `STEPS`, the longest that are not much longer than far.
    fn pass(&self, coarse: &Coarse, receiver: &mut Receiver, [from_m, to_m]: [f64; 2], search_m: f64) {
        let along = (receiver.place_m.x - coarse.grid.origin_m.x) / coarse.grid.posting_m * self.ray.sign as f64;
        if let Some((_, row)) = receiver.touched.filter(|(level, _)| *level == coarse.level) {
            for row in [row, row - 1.0, row + 1.0] {
                self.descend(coarse, receiver, 0, row, along, [from_m, to_m]);
            }
        }
        // The last row before the stretch; whole rows in the direction of the line.
        let mut row = (along + from_m / coarse.step_m - 1e-9).floor();
        while (row - along) * coarse.step_m < to_m.min(search_m) {
            let steps = row - along;
            let table = STEPS.iter().rposition(|length| steps >= *length as f64).unwrap_or(0);
            self.descend(coarse, receiver, table, row, along, [from_m, to_m]);
            row += STEPS[table] as f64;
        }
    }

    fn descend(&self, coarse: &Coarse, receiver: &mut Receiver, table: usize, row: f64, along: f64, ends_m: [f64; 2]) {
        let length = STEPS[table] as f64;
        let near_m = ((row - along) * coarse.step_m).max(ends_m[0]);
        let far_m = ((row - along + length) * coarse.step_m).min(ends_m[1]);
        if near_m >= far_m || !self.promises(coarse, receiver, table, row, along, [near_m, far_m]) {
            return;
        }
        if table == 0 {
            let Receiver { observer, slope, .. } = *receiver;
            let found = self.exact.tracer.steepest(coarse.level, observer, self.direction, [near_m, far_m], slope);
            if found > slope {
                (receiver.slope, receiver.touched) = (found, Some((coarse.level, row)));
            }
            return;
        }
        let part = STEPS[table - 1];
        for row in (0..STEPS[table]).step_by(part).map(|n| row + n as f64) {
            self.descend(coarse, receiver, table - 1, row, along, ends_m);
        }
    }

    fn promises(
        &self,
        coarse: &Coarse,
        receiver: &Receiver,
        table: usize,
        row: f64,
        along: f64,
        [near_m, far_m]: [f64; 2],
    ) -> bool {
        let grid = coarse.grid;
        let across = (receiver.place_m.y - grid.origin_m.y) / grid.posting_m + self.ray.minor * (row - along);
        let (u, v) = (row as isize * self.ray.sign, across.floor() as isize);
        // Before a level's first row a line has no maxima.
        // At a receiver's feet the facet counts, which no height bounds.
        if near_m == 0.0 || !(0..grid.majors as isize).contains(&u) || v < -1 || v > grid.minors as isize {
            return true;
        }
        let at = grid.at(u as usize, 0).wrapping_add_signed(v);
        // A line that all but touches the next node may be rounded to either side of it.
        let maxima_m = &coarse.maxima.tables[table];
        let beside = if across.fract() < 0.5 { at - 1 } else { at + 1 };
        let near_node = (across - across.round()).abs() < 1e-6;
        let highest_m = if near_node { maxima_m[at].max(maxima_m[beside]) } else { maxima_m[at] };
        let rise_m = f64::from(highest_m) - receiver.observer.z;
        rise_m > (receiver.slope * near_m).min(receiver.slope * far_m)
    }
}
