//! Swept planes projected onto the coefficients of an encoding, azimuth by azimuth.
//!
//! A plane of elevations is needed only until its azimuth has been added to every number that an encoding keeps: real
//! coefficients of a series, or sampled elevations. Each group of them is accumulated at its own resolution: box means
//! and sums over azimuths commute. Every texel adds its azimuths in the order given, so that the sums do not depend on the
//! number of threads.
//!
//! # Assumptions
//! A sampled azimuth that was not swept is interpolated between the two swept ones beside it.

pub mod bit_allocation;
pub mod equal;
pub mod gain;
pub mod group;
pub mod quantiser;
pub mod residual;
pub mod sums;
pub mod texels;

use std::borrow::Cow;
use std::ops::Range;

use rayon::prelude::*;

use super::axis::Major;
use super::bound::Bounds;
use super::companding;
use super::elevation_plane::ElevationPlane;
use super::pack::encoding::TEXEL_COEFFICIENTS;
use super::pack::{Encoding, Family, HorizonMap, Texels, pack};
use super::series::turned;
use super::statistics::TileErrors;
use super::wide::wide;
use group::{Group, STRIP};
use sums::Sums;

/// Sums that are in registers at a time.
const STRETCH: usize = 64;

/// The numbers of all pixels while azimuths are added.
#[derive(Debug, Clone)]
pub struct Accumulator {
    encoding: Encoding,
    azimuths: usize,
    columns: usize,
    rows: usize,
    pub groups: Vec<Group>,
}

impl Accumulator {
    /// Sums in memory, all 0.
    pub fn new(encoding: Encoding, columns: usize, rows: usize, azimuths: usize) -> Self {
        Self::with(encoding, columns, rows, azimuths, |length| Sums::Memory(vec![0.0; length]))
    }

    /// Sums that are kept in a checkpoint, all 0.
    pub fn on_disk(encoding: Encoding, columns: usize, rows: usize, azimuths: usize) -> Self {
        Self::with(encoding, columns, rows, azimuths, |length| Sums::Disk { length, file: None })
    }

    fn with(encoding: Encoding, columns: usize, rows: usize, azimuths: usize, sums: impl Fn(usize) -> Sums) -> Self {
        let group = |scale: usize, first: usize, reals: usize| {
            let (columns, rows) = (columns.div_ceil(scale), rows.div_ceil(scale));
            Group { scale, first, reals, rows, columns, sums: sums(reals * columns * rows) }
        };
        let texel = 2 * TEXEL_COEFFICIENTS;
        let groups = match encoding.family() {
            Family::Fourier => {
                let pages = encoding.pages().into_iter().enumerate();
                pages.map(|(index, page)| group(page.scale, index * texel, texel)).collect()
            }
            Family::Sampled => vec![group(1, 0, encoding.samples())],
            Family::Quantised => {
                (0..2 * (encoding.harmonics() + 1)).step_by(texel).map(|first| group(1, first, texel)).collect()
            }
        };
        Self { encoding, azimuths, columns, rows, groups }
    }

    pub fn columns(&self) -> usize {
        self.columns
    }

    pub fn rows(&self) -> usize {
        self.rows
    }

    pub fn in_memory(&self) -> bool {
        self.groups.iter().all(|group| matches!(group.sums, Sums::Memory(_)))
    }

    /// Bytes of all sums.
    pub fn bytes(&self) -> usize {
        4 * self.groups.iter().map(|group| group.sums.length()).sum::<usize>()
    }

    /// What [`Self::map`] takes beside the sums: of a pyramid of fields the coarse means, and what is decoded of them.
    pub fn fit_bytes(&self) -> usize {
        match self.encoding.family() {
            Family::Quantised => 2 * self.bytes() / 3,
            Family::Fourier | Family::Sampled => 0,
        }
    }

    /// Planes of what is fitted: elevations, compressed where the encoding does.
    pub fn fitted<'a>(&self, planes: &'a [ElevationPlane]) -> Cow<'a, [ElevationPlane]> {
        let Some(growth) = self.encoding.growth() else { return Cow::Borrowed(planes) };
        let compressed = |plane: &ElevationPlane| {
            let mut plane = plane.clone();
            companding::compress(growth as f32, &mut plane.elevations_rad);
            plane
        };
        Cow::Owned(planes.par_iter().map(compressed).collect())
    }

    /// Adds planes in their order to sums in memory.
    pub fn add(&mut self, planes: &[ElevationPlane], major: Major) {
        let planes = &self.fitted(planes);
        for index in 0..self.groups.len() {
            // Capture out, so that the rest can be read meanwhile.
            let Sums::Memory(sums) = &mut self.groups[index].sums else { continue };
            let mut sums = std::mem::take(sums);
            self.add_to(index, 0, &mut sums, planes, major);
            self.groups[index].sums = Sums::Memory(sums);
        }
    }

    /// Adds [`Self::fitted`] planes, which lie along one axis, in their order to the sums of some strips of a group.
    pub fn add_to(&self, index: usize, first_strip: usize, sums: &mut [f32], planes: &[ElevationPlane], major: Major) {
        if planes.is_empty() {
            return;
        }
        let (columns, rows) = (self.columns, self.rows);
        let group = &self.groups[index];
        let (scale, width, reals) = (group.scale, group.columns, group.reals);
        let of_group = |plane: &ElevationPlane| {
            let mut all = weights(self.encoding, plane.azimuth, self.azimuths);
            all.drain(group.first..group.first + reals).collect()
        };
        let weights: Vec<Vec<f32>> = planes.iter().map(of_group).collect();
        let of_strip = |buffers: &mut (Vec<f32>, Vec<f32>), (i, sums): (usize, &mut [f32])| {
            let (means, turned) = buffers;
            let first = (first_strip + i) * STRIP;
            let strip = first..(first + STRIP).min(rows);
            let texel_rows = strip.len().div_ceil(scale);
            means.resize(texel_rows * planes.len() * width, 0.0);
            for (index, plane) in planes.iter().enumerate() {
                let (pixels, stride) = plane.rows(strip.clone(), columns, major == Major::Column, turned);
                for row in 0..texel_rows {
                    let within = row * scale..((row + 1) * scale).min(strip.len());
                    let means = &mut means[(row * planes.len() + index) * width..][..width];
                    wide(
                        #[inline(always)]
                        || box_means(pixels, stride, columns, within, scale, means),
                    );
                }
            }
            for (means, sums) in means.chunks(planes.len() * width).zip(sums.chunks_mut(reals * width)) {
                wide(
                    #[inline(always)]
                    || add_scaled(means, &weights, sums, width),
                );
            }
        };
        sums.par_chunks_mut(group.strip()).enumerate().for_each_init(Default::default, of_strip);
    }

    /// These sums for an encoding that keeps the first groups of them, or all of them with other bits.
    pub fn narrowed(&self, encoding: Encoding) -> Self {
        let groups = Self::on_disk(encoding, self.columns, self.rows, self.azimuths).groups.len();
        Self { encoding, groups: self.groups[..groups].to_vec(), ..*self }
    }

    /// The sums as a map, its errors not yet measured.
    pub fn map(&self) -> HorizonMap {
        let (levels, fields) = match self.encoding.family() {
            Family::Fourier => (self.halves(|[re, im]| pack([re, -im])), Vec::new()),
            Family::Sampled => (self.halves(pack), Vec::new()),
            Family::Quantised if self.encoding == Encoding::Q => equal::pyramid(self.encoding, &self.groups),
            Family::Quantised => bit_allocation::pyramid(self.encoding, &self.groups),
        };
        let (encoding, columns, rows) = (self.encoding, self.columns, self.rows);
        let (errors, bounds) = (TileErrors::default(), Bounds::unknown(columns, rows));
        HorizonMap { encoding, columns, rows, levels, fields, errors, bounds }
    }

    /// A word from every two sums.
    fn halves(&self, word: impl Fn([f32; 2]) -> u32) -> Vec<Texels> {
        let level = |(group, page): (&Group, _)| {
            let mut level = Texels::empty(self.columns, self.rows, page);
            for (row, texels) in level.words.chunks_mut(page.words * group.columns).enumerate() {
                let reals: Vec<_> = (0..group.reals).map(|real| group.row(row, real)).collect();
                for (column, texel) in texels.chunks_mut(page.words).enumerate() {
                    for (slot, packed) in texel.iter_mut().enumerate() {
                        *packed = word([0, 1].map(|half| reals[2 * slot + half][column]));
                    }
                }
            }
            level
        };
        self.groups.iter().zip(self.encoding.pages()).map(level).collect()
    }
}

/// What one azimuth adds to each of an encoding's numbers: `a₀, b₀ = 0, a₁, b₁, …`, or the samples.
fn weights(encoding: Encoding, azimuth: usize, azimuths: usize) -> Vec<f32> {
    let count = encoding.samples();
    if count > 0 {
        let weight = |sample: usize| {
            // In steps of the azimuths swept, the shorter way round.
            let apart = (sample as f64 * azimuths as f64 / count as f64 - azimuth as f64).abs();
            (1.0 - apart.min(azimuths as f64 - apart)).max(0.0) as f32
        };
        return (0..count).map(weight).collect();
    }
    let pair = |k: usize| {
        let (sin, cos) = turned(k, azimuth, azimuths);
        let norm = if k == 0 { 1.0 } else { 2.0 } / azimuths as f64;
        [norm * cos, norm * sin].map(|weight| weight as f32)
    };
    (0..=encoding.harmonics()).flat_map(pair).collect()
}

/// Means over boxes of pixels, as far as the boxes lie in the plane.
#[inline(always)]
fn box_means(pixels: &[f32], stride: usize, columns: usize, rows: Range<usize>, scale: usize, means: &mut [f32]) {
    let row_of = |row: usize| &pixels[row * stride..row * stride + columns];
    if scale == 1 {
        means.copy_from_slice(row_of(rows.start));
        return;
    }
    means.fill(0.0);
    let count = rows.len();
    for row in rows {
        for (mean, pixels) in means.iter_mut().zip(row_of(row).chunks(scale)) {
            *mean += pixels.iter().sum::<f32>() / (pixels.len() * count) as f32;
        }
    }
}

/// Adds a row of each plane to the sums of each number: a stretch that stays in registers takes all planes in turn.
#[inline(always)]
fn add_scaled(planes: &[f32], weights: &[Vec<f32>], sums: &mut [f32], width: usize) {
    for start in (0..width).step_by(STRETCH) {
        let stretch = STRETCH.min(width - start);
        for (real, sums) in sums.chunks_mut(width).enumerate() {
            let sums = &mut sums[start..start + stretch];
            let mut added = [0.0; STRETCH];
            added[..stretch].copy_from_slice(sums);
            for (plane, weights) in planes.chunks(width).zip(weights) {
                let weight = weights[real];
                // Most weights of samples are 0.
                if weight == 0.0 {
                    continue;
                }
                let plane = &plane[start..start + stretch];
                // Of a length that is known the sums stay in registers.
                if let Ok(plane) = <&[f32; STRETCH]>::try_from(plane) {
                    added.iter_mut().zip(plane).for_each(|(sum, value)| *sum += weight * value);
                } else {
                    added.iter_mut().zip(plane).for_each(|(sum, value)| *sum += weight * value);
                }
            }
            sums.copy_from_slice(&added[..stretch]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::horizon::pack::Horizon;
    use crate::horizon::series::Series;
    use glam::DVec2;

    fn planes(columns: usize, rows: usize, azimuths: usize) -> Vec<ElevationPlane> {
        let plane = |azimuth: usize| {
            let a = std::f64::consts::TAU * azimuth as f64 / azimuths as f64;
            let h = |i: usize| (0.1 + 0.01 * (i % columns) as f64 * (a - 0.3).cos() + 0.02 * (7.0 * a).sin()) as f32;
            ElevationPlane { azimuth, stride: columns, elevations_rad: (0..columns * rows).map(h).collect() }
        };
        (0..azimuths).map(plane).collect()
    }

    #[test]
    fn sums_over_planes_are_the_series_of_each_pixel() {
        let (columns, rows) = (11, 9);
        let mut sums = Accumulator::new(Encoding::F16, columns, rows, 64);
        let planes = planes(columns, rows, 64);
        sums.add(&planes, Major::Row);
        let map = sums.map();
        for (column, row) in [(0, 0), (10, 8), (4, 5)] {
            let profile: Vec<_> = planes.iter().map(|p| f64::from(p.elevations_rad[row * columns + column])).collect();
            let expected = Series::fit(&profile, 15);
            let Horizon::Series(got) = map.horizon(DVec2::new(column as f64, row as f64)) else { panic!("a series") };
            for (a, b) in got.harmonics_rad.iter().flatten().zip(expected.harmonics_rad.iter().flatten()) {
                // Half floats of 0.1.
                assert!((a - b).abs() < 3.1e-5, "{a} {b}");
            }
        }
    }

    #[test]
    fn planes_along_columns_and_along_rows_add_alike() {
        let (columns, rows) = (19, 10);
        let along_rows = planes(columns, rows, 40);
        let turned = |plane: &ElevationPlane| {
            let elevations_rad = (0..columns * 16)
                .map(|i| (i / 16, i % 16))
                .map(|(column, row)| if row < rows { plane.elevations_rad[row * columns + column] } else { f32::NAN });
            ElevationPlane { azimuth: plane.azimuth, stride: 16, elevations_rad: elevations_rad.collect() }
        };
        let along_columns: Vec<_> = along_rows.iter().map(turned).collect();
        for encoding in [Encoding::Fm16, Encoding::F16, Encoding::W16, Encoding::Raw12] {
            let mut sums = [(); 2].map(|()| Accumulator::new(encoding, columns, rows, 40));
            sums[0].add(&along_rows, Major::Row);
            sums[1].add(&along_columns, Major::Column);
            assert!(sums[0].map() == sums[1].map());
        }
    }

    #[test]
    fn partial_boxes_average_the_pixels_they_have() {
        let mut sums = Accumulator::new(Encoding::Fm16, 9, 9, 40);
        let ramp = (0..81).map(|i| (i % 9) as f32).collect();
        sums.add(&[ElevationPlane { azimuth: 0, stride: 9, elevations_rad: ramp }], Major::Row);
        // The last of two boxes of 8 holds column 8 alone; 2/40 is the weight of a cosine at azimuth 0.
        let group = &sums.groups[3];
        assert_eq!((group.columns, group.rows), (2, 2));
        let sums = group.row(0, 0);
        assert!((sums[1] - 8.0 * 2.0 / 40.0).abs() < 1e-6 && (sums[0] - 3.5 * 2.0 / 40.0).abs() < 1e-6);
    }
}
