//! Values on a grid, and between them.
//!
//! Grid coordinates count columns and rows from the first value, which lies at (0, 0). A point lies in a [`Cell`],
//! between four values; `x` and `y`, the cell's fractions, are 0 at its low side and 1 at its high side:
//!
//! ```text
//! v(x, y) = (1 − y) [(1 − x) v00 + x v10] + y [(1 − x) v01 + x v11]
//! ```
//!
//! A NaN at one of the four corners makes the result NaN, also where its weight is 0. [`mix_known`] is the alternative for
//! images in which values are missing.
//!
//! [`cubic_weights`] are those of bicubic convolution with Keys' kernel, `a = −½` (Catmull–Rom), which is exact for
//! quadratics and passes through the values:
//!
//! ```text
//! w(t) = 1 − 5t²/2 + 3t³/2          0 ≤ t ≤ 1
//!        2 − 4t + 5t²/2 − t³/2      1 < t < 2
//! ```
//!
//! # References
//! Keys (1981), IEEE Trans. ASSP 29, 1153, doi:10.1109/TASSP.1981.1163711.

use std::ops::{Add, Mul};

use glam::DVec2;

/// Where a point lies: the columns and rows on both sides of it, and how far it is from the low ones to the high ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Column and row on the low side.
    pub low: [usize; 2],
    /// Column and row on the high side; those of the low side where the grid ends there.
    pub high: [usize; 2],
    /// 0 at the low side, 1 at the high side.
    pub fraction: DVec2,
}

impl Cell {
    /// The cell that begins at a column and a row of a grid of so many columns and rows.
    #[inline]
    pub fn new([columns, rows]: [usize; 2], low: [usize; 2], fraction: DVec2) -> Self {
        let high = [(low[0] + 1).min(columns.saturating_sub(1)), (low[1] + 1).min(rows.saturating_sub(1))];
        Self { low, high, fraction }
    }

    /// The cell of a point inside the grid, points on the far edges included in the last one.
    #[inline]
    pub fn inside(size: [usize; 2], grid: DVec2) -> Option<Self> {
        let is_inside = grid.cmpge(DVec2::ZERO).all() && grid.cmple(last(size)).all();
        is_inside.then(|| Self::continued(size, grid))
    }

    /// The cell of a point, or the nearest one: beyond the edges the outermost cells go on, with fractions below 0 or
    /// above 1. Points on the far edges lie in the last cell.
    #[inline]
    pub fn continued(size: [usize; 2], grid: DVec2) -> Self {
        let low = [(grid.x as usize).min(size[0].saturating_sub(2)), (grid.y as usize).min(size[1].saturating_sub(2))];
        Self::new(size, low, grid - DVec2::new(low[0] as f64, low[1] as f64))
    }

    /// The cell of the nearest point of the grid. A point on a column or a row, the last ones too, has it as low side.
    #[inline]
    pub fn clamped(size: [usize; 2], grid: DVec2) -> Self {
        let grid = grid.clamp(DVec2::ZERO, last(size));
        let low = [grid.x as usize, grid.y as usize];
        Self::new(size, low, grid - DVec2::new(low[0] as f64, low[1] as f64))
    }

    /// The cell of a point on a grid whose outermost values are repeated beyond its edges, as on a texture clamped to
    /// its edge: other than with [`Cell::clamped`], such a value is mixed with itself.
    #[inline]
    pub fn repeated(size: [usize; 2], grid: DVec2) -> Self {
        let low = grid.floor();
        let index = |at: DVec2| {
            let at = at.clamp(DVec2::ZERO, last(size));
            [at.x as usize, at.y as usize]
        };
        Self { low: index(low), high: index(low + 1.0), fraction: grid - low }
    }

    /// Columns and rows of the corners: low, then one along the row, then the same on the next row.
    #[inline]
    pub fn corners(&self) -> [(usize, usize); 4] {
        let ([left, first], [right, second]) = (self.low, self.high);
        [(left, first), (right, first), (left, second), (right, second)]
    }

    /// Weights of the corners, in the order of [`Cell::corners`].
    #[inline]
    pub fn weights(&self) -> [f64; 4] {
        weights(self.fraction)
    }

    /// Bilinear value of what is given by column and row.
    #[inline]
    pub fn mix<T: Add<Output = T> + Mul<f64, Output = T>>(&self, value: impl Fn(usize, usize) -> T) -> T {
        self.mix_by(value, |low, high, fraction| low * (1.0 - fraction) + high * fraction)
    }

    /// Along the two rows, then between them, by a rule of its own for two values and a fraction.
    #[inline]
    pub fn mix_by<T>(&self, value: impl Fn(usize, usize) -> T, mix: impl Fn(T, T, f64) -> T) -> T {
        let along = |row: usize| mix(value(self.low[0], row), value(self.high[0], row), self.fraction.x);
        mix(along(self.low[1]), along(self.high[1]), self.fraction.y)
    }
}

/// Column and row of the last value.
#[inline]
fn last([columns, rows]: [usize; 2]) -> DVec2 {
    DVec2::new(columns.saturating_sub(1) as f64, rows.saturating_sub(1) as f64)
}

/// Weights of a cell's corners at fractions of it, in the order of [`Cell::corners`].
///
/// Sums with these weights and [`Cell::mix`] differ in the last bit.
#[inline]
pub fn weights(f: DVec2) -> [f64; 4] {
    [(1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y]
}

/// The rule of images with missing values, for [`Cell::mix_by`]: in single precision, and at fraction 0 the high value
/// does not count, whether it is known or not.
#[inline]
pub fn mix_known(low: f32, high: f32, fraction: f64) -> f32 {
    let fraction = fraction as f32;
    if fraction == 0.0 { low } else { low * (1.0 - fraction) + high * fraction }
}

/// Weights of the values at −1, 0, 1, 2 for a point at `t` between 0 and 1.
pub fn cubic_weights(t: f64) -> [f64; 4] {
    let near = |t: f64| 1.0 + t * t * (1.5 * t - 2.5);
    let far = |t: f64| 2.0 + t * (-4.0 + t * (2.5 - 0.5 * t));
    if t == 0.0 { [0.0, 1.0, 0.0, 0.0] } else { [far(1.0 + t), near(t), near(1.0 - t), far(2.0 - t)] }
}

/// Borrowed values, row by row.
#[derive(Debug, Clone, Copy)]
pub struct Grid2<'a, T> {
    pub values: &'a [T],
    pub columns: usize,
    pub rows: usize,
}

impl<'a, T: Copy> Grid2<'a, T> {
    #[inline]
    pub fn new(values: &'a [T], [columns, rows]: [usize; 2]) -> Self {
        debug_assert_eq!(values.len(), columns * rows, "a grid fills its rows");
        Self { values, columns, rows }
    }

    /// Columns and rows.
    #[inline]
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// Where the value of a column and a row lies among all.
    #[inline]
    pub fn index(&self, column: usize, row: usize) -> usize {
        row * self.columns + column
    }

    #[inline]
    pub fn get(&self, column: usize, row: usize) -> T {
        self.values[self.index(column, row)]
    }

    /// Bilinear value in a cell of the grid.
    #[inline]
    pub fn bilinear(&self, cell: Cell) -> f64
    where
        T: Into<f64>,
    {
        cell.mix(|column, row| self.get(column, row).into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [3, 2];
    const VALUES: [f32; 6] = [1.0, 2.0, 4.0, 5.0, 8.0, 16.0];

    fn at(cell: Cell) -> f64 {
        Grid2::new(&VALUES, SIZE).bilinear(cell)
    }

    #[test]
    fn corners_have_the_grids_own_values() {
        let grid = Grid2::new(&VALUES, SIZE);
        for (column, row) in [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)] {
            let point = DVec2::new(column as f64, row as f64);
            let expected = f64::from(VALUES[grid.index(column, row)]);
            assert_eq!(f64::from(grid.get(column, row)), expected);
            let cells = [Cell::continued(SIZE, point), Cell::clamped(SIZE, point), Cell::repeated(SIZE, point)];
            assert_eq!(Cell::inside(SIZE, point).map(at), Some(expected));
            assert_eq!(cells.map(at), [expected; 3]);
        }
    }

    #[test]
    fn values_are_linear_along_edges_and_mean_in_the_middle() {
        let inside = |x: f64, y: f64| Cell::inside(SIZE, DVec2::new(x, y)).map(at);
        assert_eq!((inside(0.25, 0.0), inside(2.0, 0.25)), (Some(1.25), Some(7.0)));
        assert_eq!(inside(0.5, 0.5), Some(4.0));
    }

    #[test]
    fn far_edges_belong_to_the_last_cell_or_have_one_of_their_own() {
        let far = DVec2::new(2.0, 1.0);
        let [continued, clamped] = [Cell::continued(SIZE, far), Cell::clamped(SIZE, far)];
        assert_eq!((continued.low, continued.high, continued.fraction), ([1, 0], [2, 1], DVec2::ONE));
        assert_eq!((clamped.low, clamped.high, clamped.fraction), ([2, 1], [2, 1], DVec2::ZERO));
    }

    #[test]
    fn outside_a_cell_is_none_goes_on_or_holds() {
        let point = DVec2::new(-1.0, 0.0);
        assert_eq!(Cell::inside(SIZE, point), None);
        assert_eq!(Cell::inside(SIZE, DVec2::new(2.0 + 1e-9, 0.0)), None);
        assert_eq!(Cell::inside(SIZE, DVec2::new(f64::NAN, 0.0)), None);
        assert_eq!([Cell::continued(SIZE, point), Cell::clamped(SIZE, point)].map(at), [0.0, 1.0]);
        let repeated = Cell::repeated(SIZE, DVec2::new(2.25, -0.5));
        assert_eq!((repeated.low, repeated.high, at(repeated)), ([2, 0], [2, 0], 4.0));
    }

    #[test]
    fn a_single_value_holds_everywhere() {
        for point in [DVec2::ZERO, DVec2::splat(-3.5), DVec2::splat(7.25)] {
            for cell in [Cell::continued([1, 1], point), Cell::clamped([1, 1], point), Cell::repeated([1, 1], point)] {
                assert_eq!(Grid2::new(&[3.0_f64], [1, 1]).bilinear(cell), 3.0);
            }
        }
    }

    #[test]
    fn a_missing_corner_counts_without_weight_unless_known_ones_suffice() {
        let values = [1.0, f32::NAN, 3.0, 5.0];
        let grid = Grid2::new(&values, [2, 2]);
        let known = |x: f64, y: f64| {
            Cell::clamped([2, 2], DVec2::new(x, y)).mix_by(|column, row| grid.get(column, row), mix_known)
        };
        assert!(grid.bilinear(Cell::clamped([2, 2], DVec2::ZERO)).is_nan());
        assert_eq!((known(0.0, 0.0), known(0.0, 0.5), known(0.5, 1.0)), (1.0, 2.0, 4.0));
        assert!(known(0.5, 0.0).is_nan());
    }

    #[test]
    fn weights_add_up_to_one_and_give_the_bilinear_value() {
        let cell = Cell::clamped(SIZE, DVec2::new(1.3, 0.7));
        let grid = Grid2::new(&VALUES, SIZE);
        let pairs = cell.corners().into_iter().zip(cell.weights());
        let sum: f64 = pairs.map(|((column, row), weight)| weight * f64::from(grid.get(column, row))).sum();
        assert!((cell.weights().iter().sum::<f64>() - 1.0).abs() < 1e-15);
        assert!((sum - at(cell)).abs() < 1e-14);
    }

    #[test]
    fn cubic_weights_are_exact_for_quadratics() {
        assert_eq!(cubic_weights(0.0), [0.0, 1.0, 0.0, 0.0]);
        let sum: f64 =
            cubic_weights(0.3).iter().zip([1.0, 0.0, 1.0, 4.0]).map(|(weight, square)| weight * square).sum();
        assert!((sum - 0.09).abs() < 1e-15);
    }
}
