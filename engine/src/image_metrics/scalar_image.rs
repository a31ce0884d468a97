//! Grey images to compare: values row by row, NaN where there is none.
//!
//! Means over areas make images coarser, normalised Gaussians make them smooth, and cubic convolution reads them
//! between pixels. A missing pixel has no weight; where the known ones weigh less than half there is no value.

use glam::DVec2;
use rayon::prelude::*;

use crate::grid::cubic_weights;

/// An image. The centre of pixel (0, 0), top left, is the point (0, 0).
#[derive(Debug, Clone, PartialEq)]
pub struct ScalarImage {
    pub columns: usize,
    pub rows: usize,
    pub values: Vec<f64>,
}

/// What of the weight must fall on known pixels.
const KNOWN: f64 = 0.5;

/// A Gaussian ends here, in standard deviations.
const REACH: f64 = 3.5;

impl ScalarImage {
    pub fn new(columns: usize, rows: usize, values: Vec<f64>) -> Self {
        assert_eq!(values.len(), columns * rows, "an image fills its rows");
        Self { columns, rows, values }
    }

    pub fn from_f32(columns: usize, rows: usize, values: &[f32]) -> Self {
        Self::new(columns, rows, values.iter().map(|&value| f64::from(value)).collect())
    }

    pub fn at(&self, column: usize, row: usize) -> f64 {
        self.values[row * self.columns + column]
    }

    pub fn map(&self, value: impl Fn(f64) -> f64) -> Self {
        Self { values: self.values.iter().map(|&v| value(v)).collect(), ..*self }
    }

    pub fn zip(&self, other: &Self, value: impl Fn(f64, f64) -> f64) -> Self {
        assert_eq!((self.columns, self.rows), (other.columns, other.rows), "images of one size");
        Self { values: self.values.iter().zip(&other.values).map(|(&a, &b)| value(a, b)).collect(), ..*self }
    }

    /// NaN within `columns`, `rows` of the edges.
    pub fn without_border(&self, columns: usize, rows: usize) -> Self {
        let inside = |index: usize| {
            let (column, row) = (index % self.columns, index / self.columns);
            (columns..self.columns.saturating_sub(columns)).contains(&column)
                && (rows..self.rows.saturating_sub(rows)).contains(&row)
        };
        let values = self.values.iter().enumerate().map(|(index, &v)| if inside(index) { v } else { f64::NAN });
        Self { values: values.collect(), ..*self }
    }

    fn transposed(&self) -> Self {
        let values = (0..self.values.len()).map(|i| self.at(i / self.rows, i % self.rows)).collect();
        Self { columns: self.rows, rows: self.columns, values }
    }

    /// Means over the areas of fewer, larger pixels. Sizes need not divide.
    pub fn reduced(&self, columns: usize, rows: usize) -> Self {
        if (columns, rows) == (self.columns, self.rows) {
            return self.clone();
        }
        let along = |from: usize, to: usize| -> Vec<Vec<(usize, f64)>> {
            let step = from as f64 / to as f64;
            let cell = |i: usize| {
                let (start, end) = (i as f64 * step, (i + 1) as f64 * step);
                let overlap = |j: usize| ((j + 1) as f64).min(end) - (j as f64).max(start);
                (start as usize..(end.ceil() as usize).min(from)).map(|j| (j, overlap(j))).collect()
            };
            (0..to).map(cell).collect()
        };
        self.weighted(&along(self.columns, columns), &along(self.rows, rows))
    }

    /// Smoothed by a Gaussian of so many pixels; the edge and missing pixels have no weight.
    pub fn blurred(&self, sigma_px: f64) -> Self {
        if sigma_px <= 0.0 {
            return self.clone();
        }
        let reach = (REACH * sigma_px).ceil() as usize;
        let along = |count: usize| -> Vec<Vec<(usize, f64)>> {
            let weight = |i: usize, j: usize| (-0.5 * ((i as f64 - j as f64) / sigma_px).powi(2)).exp();
            let around = |i: usize| i.saturating_sub(reach)..(i + reach + 1).min(count);
            (0..count).map(|i| around(i).map(|j| (j, weight(i, j))).collect()).collect()
        };
        self.weighted(&along(self.columns), &along(self.rows))
    }

    /// Means of the known pixels with the products of weights along columns and rows.
    fn weighted(&self, along_row: &[Vec<(usize, f64)>], along_column: &[Vec<(usize, f64)>]) -> Self {
        let both = |image: &Self| image.summed_rows(along_row).transposed().summed_rows(along_column).transposed();
        let sum = both(&self.map(|value| if value.is_nan() { 0.0 } else { value }));
        let known = both(&self.map(|value| if value.is_nan() { 0.0 } else { 1.0 }));
        let whole = |weights: &[Vec<(usize, f64)>]| -> Vec<f64> {
            weights.iter().map(|weights| weights.iter().map(|(_, weight)| weight).sum()).collect()
        };
        let (across, down) = (whole(along_row), whole(along_column));
        let value = |i: usize| {
            let all = across[i % sum.columns] * down[i / sum.columns];
            // Rounding shall not make a whole pixel half known.
            if known.values[i] >= KNOWN * all * (1.0 - 1e-9) { sum.values[i] / known.values[i] } else { f64::NAN }
        };
        let values = (0..sum.values.len()).map(value).collect();
        Self::new(sum.columns, sum.rows, values)
    }

    fn summed_rows(&self, weights: &[Vec<(usize, f64)>]) -> Self {
        let sum = |line: &[f64], weights: &[(usize, f64)]| weights.iter().map(|&(i, weight)| weight * line[i]).sum();
        let line = |line: &[f64]| weights.iter().map(|weights| sum(line, weights)).collect::<Vec<f64>>();
        let values = self.values.par_chunks(self.columns).flat_map_iter(line).collect();
        Self::new(weights.len(), self.rows, values)
    }

    /// What a Gaussian takes away.
    pub fn high_pass(&self, sigma_px: f64) -> Self {
        self.zip(&self.blurred(sigma_px), |value, smooth| value - smooth)
    }

    /// Between pixels, by Keys' cubic convolution; NaN where one of the sixteen is missing or outside.
    pub fn sample(&self, at: DVec2) -> f64 {
        let nearest = at.round();
        // Sums of rounded numbers return to a pixel's centre within this.
        let at = if (at - nearest).abs().max_element() < 1e-9 { nearest } else { at };
        let (x, y) = (at.x.floor(), at.y.floor());
        let (wx, wy) = (cubic_weights(at.x - x), cubic_weights(at.y - y));
        let mut sum = 0.0;
        for (j, wy) in wy.into_iter().enumerate().filter(|(_, w)| *w != 0.0) {
            for (i, wx) in wx.into_iter().enumerate().filter(|(_, w)| *w != 0.0) {
                let (column, row) = (x + i as f64 - 1.0, y + j as f64 - 1.0);
                if column < 0.0 || row < 0.0 || column >= self.columns as f64 || row >= self.rows as f64 {
                    return f64::NAN;
                }
                sum += wx * wy * self.at(column as usize, row as usize);
            }
        }
        sum
    }

    /// The values where both images have one, in pairs.
    pub fn pairs<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = (f64, f64)> + Clone + 'a {
        let pairs = self.values.iter().zip(&other.values).map(|(&a, &b)| (a, b));
        pairs.filter(|(a, b)| a.is_finite() && b.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(columns: usize, rows: usize) -> ScalarImage {
        let value = |i: usize| 3.0 + 2.0 * (i % columns) as f64 - 0.5 * (i / columns) as f64;
        ScalarImage::new(columns, rows, (0..columns * rows).map(value).collect())
    }

    #[test]
    fn a_reduced_ramp_is_a_ramp_and_every_reduction_keeps_the_mean() {
        let reduced = ramp(60, 40).reduced(20, 10);
        for row in 0..10 {
            for column in 0..20 {
                // The centre of the larger pixel, in small ones.
                let (x, y) = ((column as f64 + 0.5) * 3.0 - 0.5, (row as f64 + 0.5) * 4.0 - 0.5);
                assert!((reduced.at(column, row) - (3.0 + 2.0 * x - 0.5 * y)).abs() < 1e-9);
            }
        }
        let mean = |image: &ScalarImage| image.values.iter().sum::<f64>() / image.values.len() as f64;
        assert!((mean(&ramp(60, 40).reduced(25, 16)) - mean(&ramp(60, 40))).abs() < 1e-9);
    }

    #[test]
    fn reducing_keeps_the_mean_and_leaves_missing_pixels_out() {
        let mut image = ScalarImage::new(6, 6, vec![4.0; 36]);
        image.values[0] = f64::NAN;
        assert!(image.reduced(4, 4).values.iter().all(|value| (value - 4.0).abs() < 1e-12));
        image.values.iter_mut().take(3).for_each(|value| *value = f64::NAN);
        image.values[6] = f64::NAN;
        image.values[7] = f64::NAN;
        assert!(image.reduced(3, 3).at(0, 0).is_nan());
    }

    #[test]
    fn cubic_convolution_returns_pixels_and_is_exact_for_a_ramp() {
        let image = ramp(12, 9);
        assert_eq!(image.sample(DVec2::new(5.0, 3.0)), image.at(5, 3));
        assert!((image.sample(DVec2::new(5.3, 3.7)) - (3.0 + 10.6 - 1.85)).abs() < 1e-12);
        assert!(image.sample(DVec2::new(0.5, 3.0)).is_nan(), "it would need a pixel to the left");
    }

    /// σ² adds up: a blurred Gaussian is a wider one.
    #[test]
    fn blurring_a_gaussian_widens_it() {
        let bell = |sigma: f64| {
            let value = |i: usize| {
                let (x, y) = ((i % 61) as f64 - 30.0, (i / 61) as f64 - 30.0);
                (-(x * x + y * y) / (2.0 * sigma * sigma)).exp() / (2.0 * std::f64::consts::PI * sigma * sigma)
            };
            ScalarImage::new(61, 61, (0..61 * 61).map(value).collect())
        };
        // A Gaussian cut at 3.5 σ lacks 5e-4 of its weight.
        let worst = bell(3.0).blurred(4.0).pairs(&bell(5.0)).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
        assert!(worst < 2e-3 * bell(5.0).at(30, 30), "{worst}");
    }
}
