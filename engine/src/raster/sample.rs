//! Heights between the pixels of an elevation model.
//!
//! Bicubic convolution with Keys' kernel ([`cubic_weights`]).
//!
//! Where one of the sixteen samples with weight is missing it is bilinear, where one of those four is
//! missing there is no height: no extrapolation, also not over the outer half of the edge pixels.
//! Over the seam of a map that goes around the body samples come from the other side, over a pole from
//! half a turn away. Within half a pixel of a pole that lies on a pixel's edge the height goes linearly
//! to the mean of the last row, so that it does not depend on longitude there.

use glam::DVec2;

use super::Dem;
use super::dem::Pole;
use crate::grid::cubic_weights;

/// Coordinates this close to a pixel centre are that centre: projections return to it within 1e-9 pixels.
const SNAP_PIXELS: f64 = 1e-6;

impl Dem {
    /// Height at pixel coordinates, NaN where there is none.
    pub fn height_m(&self, pixel: DVec2) -> f64 {
        if !pixel.is_finite() {
            return f64::NAN;
        }
        let inside = self
            .pole_share(pixel.y)
            .map(|(share, mean_m, row)| (1.0 - share) * self.interpolate(DVec2::new(pixel.x, row)) + share * mean_m);
        inside.unwrap_or_else(|| self.interpolate(pixel))
    }

    fn interpolate(&self, pixel: DVec2) -> f64 {
        let bicubic_m = self.bicubic_m(pixel);
        if bicubic_m.is_nan() { self.bilinear_m(pixel) } else { bicubic_m }
    }

    /// Bicubic height, NaN where a sample is missing.
    pub fn bicubic_m(&self, pixel: DVec2) -> f64 {
        let ((column, x), (row, y)) = (split(pixel.x), split(pixel.y));
        let (along, across) = (cubic_weights(x), cubic_weights(y));
        self.weighted_m(column - 1, row - 1, &along, &across)
    }

    /// Bilinear height, NaN where a sample is missing.
    pub fn bilinear_m(&self, pixel: DVec2) -> f64 {
        let ((column, x), (row, y)) = (split(pixel.x), split(pixel.y));
        self.weighted_m(column, row, &[1.0 - x, x], &[1.0 - y, y])
    }

    /// Samples without weight are not looked at: a missing one does not count.
    fn weighted_m(&self, column: i64, row: i64, along: &[f64], across: &[f64]) -> f64 {
        let weighed = |first: i64, weights: &[f64], sample: &dyn Fn(i64) -> f64| -> f64 {
            let pairs = (first..).zip(weights).filter(|(_, weight)| **weight != 0.0);
            pairs.map(|(at, weight)| weight * sample(at)).sum()
        };
        weighed(row, across, &|row| weighed(column, along, &|column| self.sample_m(column, row)))
    }

    /// The sample at a pixel, followed over seam and poles; NaN outside.
    fn sample_m(&self, column: i64, row: i64) -> f64 {
        let (mut column, mut row) = (column, row);
        if let Some(period) = self.seams.period {
            let beyond = |pole: &Pole| {
                let first = pole.twice_row <= 0;
                if first { 2 * row < pole.twice_row } else { 2 * row > pole.twice_row }
            };
            if let Some(pole) = self.seams.poles.iter().flatten().find(|pole| beyond(pole)) {
                row = pole.twice_row - row;
                column += period as i64 / 2;
            }
            column = column.rem_euclid(period as i64);
        }
        let inside = (0..self.columns as i64).contains(&column) && (0..self.rows as i64).contains(&row);
        if inside { f64::from(self.heights_m[row as usize * self.columns + column as usize]) } else { f64::NAN }
    }

    /// Within half a pixel of a pole on a pixel's edge: how near it is, its height, the row next to it.
    fn pole_share(&self, row: f64) -> Option<(f64, f64, f64)> {
        self.seams.poles.iter().flatten().find_map(|pole| {
            let (edge, nearest) = match pole.twice_row {
                -1 => (-0.5, 0.0),
                twice if twice % 2 != 0 => (twice as f64 / 2.0, (twice - 1) as f64 / 2.0),
                _ => return None,
            };
            let share = (row - nearest) / (edge - nearest);
            (0.0..=1.0 + 1e-6).contains(&share).then_some((share.min(1.0), pole.mean_m, nearest))
        })
    }
}

/// The pixel at or before a coordinate, and the rest.
fn split(at: f64) -> (i64, f64) {
    let nearest = at.round();
    if (at - nearest).abs() < SNAP_PIXELS {
        return (nearest as i64, 0.0);
    }
    (at.floor() as i64, at - at.floor())
}
