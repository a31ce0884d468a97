//! Words of texels at one resolution, found and interpolated.

use glam::DVec2;

use super::encoding::PageLayout;
use crate::grid::Cell;

/// One resolution level of a horizon map, rows *up* the map like those of a [`crate::terrain::Level`].
#[derive(Debug, Clone, PartialEq)]
pub struct Texels {
    pub columns: usize,
    pub rows: usize,
    pub words_per_texel: usize,
    /// `[row][column][word]`.
    pub words: Vec<u32>,
}

impl Texels {
    /// A page for a map of so many pixels.
    pub fn empty(columns: usize, rows: usize, page: PageLayout) -> Self {
        let (columns, rows) = (columns.div_ceil(page.scale), rows.div_ceil(page.scale));
        Self { columns, rows, words_per_texel: page.words, words: vec![0; columns * rows * page.words] }
    }

    /// Words of one texel.
    pub fn texel(&self, column: usize, row: usize) -> &[u32] {
        let first = (row * self.columns + column) * self.words_per_texel;
        &self.words[first..first + self.words_per_texel]
    }

    /// A pair of numbers, read from each of the four texels about a grid point and interpolated.
    pub(super) fn bilinear(&self, grid: DVec2, scale: usize, read: impl Fn(&[u32]) -> [f64; 2]) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for ((column, row), weight) in self.corners(grid, scale) {
            let [a, b] = read(self.texel(column, row));
            sum[0] += weight * a;
            sum[1] += weight * b;
        }
        sum
    }

    /// Columns, rows and weights of the four texels about a grid point.
    pub(super) fn corners(&self, grid: DVec2, scale: usize) -> impl Iterator<Item = ((usize, usize), f64)> + use<> {
        let cell = Cell::clamped([self.columns, self.rows], (grid + 0.5) / scale as f64 - 0.5);
        cell.corners().into_iter().zip(cell.weights())
    }
}
