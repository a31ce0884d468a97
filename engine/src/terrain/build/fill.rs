//! Heights where there are none: smooth continuation, and distances to data.
//!
//! Missing values come from a pyramid of means: each is the bilinear value of the next coarser level,
//! relaxed towards `∇²h = 0` on the way down. Known values stay as they are.

use glam::DVec2;

use crate::grid::{Cell, Grid2};
use crate::raster::Dem;

/// Sweeps of relaxation on each level of the pyramid.
const SWEEPS: usize = 8;

/// Replaces NaN by smoothly continued values; leaves all as it is where nothing or everything is known.
pub(super) fn continue_smoothly(values: &mut [f64], columns: usize) {
    let missing: Vec<usize> = (0..values.len()).filter(|&index| values[index].is_nan()).collect();
    let rows = values.len() / columns;
    if missing.is_empty() || missing.len() == values.len() || columns.max(rows) == 1 {
        return;
    }
    let (mut coarse, coarse_columns) = halve(values, columns);
    continue_smoothly(&mut coarse, coarse_columns);
    for &index in &missing {
        values[index] = upsampled(&coarse, coarse_columns, index % columns, index / columns);
    }
    for _ in 0..SWEEPS {
        for &index in &missing {
            values[index] = mean_of_neighbours(values, columns, index);
        }
    }
}

/// Means of the known values of 2 × 2 blocks.
fn halve(values: &[f64], columns: usize) -> (Vec<f64>, usize) {
    let rows = values.len() / columns;
    let (half_columns, half_rows) = (columns.div_ceil(2), rows.div_ceil(2));
    let mean = |index: usize| {
        let (column, row) = (2 * (index % half_columns), 2 * (index / half_columns));
        let block = (row..(row + 2).min(rows))
            .flat_map(|row| &values[row * columns..][column..(column + 2).min(columns)])
            .filter(|value| !value.is_nan());
        let (count, sum) = block.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
        sum / count
    };
    ((0..half_columns * half_rows).map(mean).collect(), half_columns)
}

/// Bilinear value of a half-sized grid of blocks at the centre of a full-sized node.
fn upsampled(coarse: &[f64], columns: usize, column: usize, row: usize) -> f64 {
    let blocks = Grid2::new(coarse, [columns, coarse.len() / columns]);
    // A node's centre lies a quarter block from its block's centre, towards the nearer neighbour.
    blocks.bilinear(Cell::repeated(blocks.size(), 0.5 * DVec2::new(column as f64, row as f64) - 0.25))
}

fn mean_of_neighbours(values: &[f64], columns: usize, index: usize) -> f64 {
    let (column, last) = (index % columns, values.len() - 1);
    let neighbours = [
        (column > 0).then(|| index - 1),
        (column + 1 < columns).then(|| index + 1),
        index.checked_sub(columns),
        (index + columns <= last).then(|| index + columns),
    ];
    let (count, sum) =
        neighbours.into_iter().flatten().fold((0.0, 0.0), |(count, sum), at| (count + 1.0, sum + values[at]));
    sum / count
}

/// Distance in nodes from each missing node to the nearest known one, 0 at known ones: chamfer 3-4,
/// within 8 % of Euclid's. Infinite where nothing is known.
pub(super) fn distances(missing: &[bool], columns: usize) -> Vec<f32> {
    const STRAIGHT: f32 = 1.0;
    const DIAGONAL: f32 = 4.0 / 3.0;
    let mut distance: Vec<f32> = missing.iter().map(|&missing| if missing { f32::INFINITY } else { 0.0 }).collect();
    if !missing.contains(&true) {
        return distance;
    }
    let rows = missing.len() / columns;
    // Neighbours before a node in reading order; turned about for the way back.
    let before = [(-1_i64, 0_i64, STRAIGHT), (-1, -1, DIAGONAL), (0, -1, STRAIGHT), (1, -1, DIAGONAL)];
    let mut visit = |index: usize, sign: i64| {
        let (column, row) = ((index % columns) as i64, (index / columns) as i64);
        for (right, up, step) in before {
            let (column, row) = (column + sign * right, row + sign * up);
            if (0..columns as i64).contains(&column) && (0..rows as i64).contains(&row) {
                let beside = distance[row as usize * columns + column as usize];
                distance[index] = distance[index].min(beside + step);
            }
        }
    };
    (0..missing.len()).for_each(|index| visit(index, 1));
    (0..missing.len()).rev().for_each(|index| visit(index, -1));
    distance
}

/// The model with its missing pixels continued from the others.
pub(super) fn filled(dem: &Dem) -> Dem {
    let mut heights_m: Vec<f64> = dem.heights_m.iter().map(|&height| f64::from(height)).collect();
    continue_smoothly(&mut heights_m, dem.columns);
    dem.with_heights(heights_m.into_iter().map(|height| height as f32).collect())
}

pub(super) fn replace_missing(values: &mut [f64], by: f64) {
    values.iter_mut().filter(|value| value.is_nan()).for_each(|value| *value = by);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane is its own smooth continuation.
    #[test]
    fn a_hole_in_a_plane_is_filled_with_the_plane() {
        let plane = |index: usize| 3.0 * (index % 64) as f64 - 2.0 * (index / 64) as f64;
        let hole = |index: usize| (20..40).contains(&(index % 64)) && (25..35).contains(&(index / 64));
        let mut values: Vec<f64> =
            (0..64 * 64).map(|index| if hole(index) { f64::NAN } else { plane(index) }).collect();
        continue_smoothly(&mut values, 64);
        // Relaxation is stopped after a few sweeps: a node's slope is 3, the hole 20 nodes wide.
        let worst = (0..64 * 64).map(|index| (values[index] - plane(index)).abs()).fold(0.0, f64::max);
        assert!(worst < 1.5, "{worst}");
        assert!((0..64 * 64).all(|index| hole(index) || values[index] == plane(index)));
    }

    #[test]
    fn a_continuation_stays_between_the_known_values() {
        let mut values = vec![f64::NAN; 37 * 21];
        (values[100], values[400]) = (5.0, -7.0);
        continue_smoothly(&mut values, 37);
        assert!(values.iter().all(|value| (-7.0..=5.0).contains(value)));
    }

    #[test]
    fn chamfer_distances_are_within_8_percent() {
        let mut missing = vec![true; 41 * 41];
        missing[20 * 41 + 20] = false;
        let distance = distances(&missing, 41);
        for (index, distance) in distance.into_iter().enumerate() {
            let expected = ((index % 41) as f32 - 20.0).hypot((index / 41) as f32 - 20.0);
            assert!((distance - expected).abs() <= 0.08 * expected, "{distance} {expected}");
        }
    }
}
