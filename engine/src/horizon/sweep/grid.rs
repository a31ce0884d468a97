//! A level's heights as a sweep wants them: rows along the minor axis, padded, gaps far below everything.

use glam::DVec2;

use crate::horizon::axis::Major;
use crate::horizon::lanes::LANES;
use crate::terrain::Level;

/// Height of what never occludes: far below everything, yet finite, so that a weight of 0 makes it 0.
pub const NEVER_M: f32 = -1e30;

/// Heights below this are interpolated with [`NEVER_M`].
pub const ABSENT_M: f32 = -1e10;

/// Occluding heights, `[major][minor]`, with a margin of [`NEVER_M`] all around.
#[derive(Debug)]
pub struct HeightGrid {
    pub majors: usize,
    pub minors: usize,
    pub stride: usize,
    pub pad: usize,
    pub posting_m: f64,
    /// Map (major, minor) coordinates of node (0, 0).
    pub origin_m: DVec2,
    pub heights_m: Vec<f32>,
}

impl HeightGrid {
    /// Heights of `level` above `datum_m`, reachable up to `pad` nodes beyond its sides.
    pub fn new(level: &Level, major: Major, pad: usize, datum_m: f64) -> Self {
        let (majors, minors) = match major {
            Major::Row => (level.rows, level.columns),
            Major::Column => (level.columns, level.rows),
        };
        let stride = padded_stride(minors + 2 * pad);
        // A last row of lanes may read past the end.
        let mut heights_m = vec![NEVER_M; (majors + 2 * pad) * stride + LANES];
        for u in 0..majors {
            for v in 0..minors {
                let node = match major {
                    Major::Row => level.index(v, u),
                    Major::Column => level.index(u, v),
                };
                if !level.gap[node] {
                    heights_m[(u + pad) * stride + v + pad] = (f64::from(level.heights_m[node]) - datum_m) as f32;
                }
            }
        }
        let origin_m = major.split(level.node_m(0, 0));
        Self { majors, minors, stride, pad, posting_m: level.posting_m, origin_m, heights_m }
    }

    /// Where node (u, v) lies in the padded arrays.
    pub fn at(&self, u: usize, v: usize) -> usize {
        (u + self.pad) * self.stride + v + self.pad
    }

    /// Heights of consecutive nodes of a row from node (u, v) on, those within the padding included.
    #[inline(always)]
    pub fn lanes(&self, u: isize, v: isize) -> &[f32; LANES] {
        let pad = self.pad as isize;
        let start = ((u + pad) * self.stride as isize + v + pad) as usize;
        self.heights_m[start..start + LANES].first_chunk().expect("a slice of LANES")
    }

    /// The twist `h₀₀ − h₁₀ − h₀₁ + h₁₁` of every cell, 0 where a gap touches it.
    pub fn twists_m(&self) -> Vec<f32> {
        let mut twists_m = vec![0.0; self.heights_m.len()];
        for u in 0..self.majors - 1 {
            for v in 0..self.minors - 1 {
                let at = self.at(u, v);
                let corners = [at, at + self.stride, at + 1, at + self.stride + 1].map(|i| self.heights_m[i]);
                if corners.iter().all(|height_m| *height_m > ABSENT_M) {
                    twists_m[at] = corners[0] - corners[1] - corners[2] + corners[3];
                }
            }
        }
        twists_m
    }
}

/// At least `length`, an odd number of cache lines: rows 4096 bytes apart would share one cache set.
fn padded_stride(length: usize) -> usize {
    let lines = length.div_ceil(16);
    (lines | 1) * 16
}

/// The middle of a level's heights: `f32` heights above it keep more digits.
pub fn middle_m(level: &Level) -> f64 {
    let valid = level.heights_m.iter().zip(&level.gap).filter(|(_, gap)| !**gap).map(|(height_m, _)| *height_m);
    let (low, high) = valid.fold((f32::MAX, f32::MIN), |(low, high), h| (low.min(h), high.max(h)));
    if low > high { 0.0 } else { f64::from(0.5 * (low + high)) }
}
