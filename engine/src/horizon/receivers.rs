//! The observers whose skylines are searched.

use super::axis::Major;
use super::lanes::LANES;
use super::observer::raised;
use super::settings::Settings;
use crate::terrain::{Face, Level};

/// The nodes that get horizons, `[major][minor]`, rows padded to whole lanes.
#[derive(Debug)]
pub struct Receivers {
    pub majors: usize,
    pub minors: usize,
    pub stride: usize,
    pub margin: usize,
    /// Lifted heights of the observers above the datum.
    pub observers_m: Vec<f32>,
}

impl Receivers {
    pub(super) fn new(face: &Face, level: &Level, major: Major, datum_m: f64, settings: &Settings) -> Self {
        let [columns, rows] = level.seen_size();
        let (majors, minors) = match major {
            Major::Row => (rows, columns),
            Major::Column => (columns, rows),
        };
        let stride = minors.next_multiple_of(LANES);
        let mut observers_m = vec![0.0; majors * stride];
        for u in 0..majors {
            for v in 0..minors {
                let observer = raised(&face.map, major.foot(level, u, v), settings.observer_height_m);
                observers_m[u * stride + v] = (observer.z - datum_m) as f32;
            }
        }
        Self { majors, minors, stride, margin: level.margin, observers_m }
    }

    /// Where a plane along `major` has a node of the seen part, (column, row).
    pub fn index(&self, major: Major, node: [usize; 2]) -> usize {
        major.index(self.stride, node)
    }

    /// The row of receivers at a major index of the level.
    pub(super) fn row(&self, u: isize) -> Option<usize> {
        let row = u - self.margin as isize;
        (0..self.majors as isize).contains(&row).then_some(row as usize)
    }

    /// Observers of a row from minor index `first` on; anything where there is none.
    #[inline(always)]
    pub(super) fn lanes_m(&self, row: usize, first: isize) -> [f32; LANES] {
        let start = (row * self.stride) as isize + first;
        match self.observers_m.get(start as usize..(start + LANES as isize) as usize) {
            Some(lanes_m) if start >= 0 => *lanes_m.first_chunk().expect("LANES"),
            _ => std::array::from_fn(|i| *self.observers_m.get((start + i as isize) as usize).unwrap_or(&0.0)),
        }
    }
}
