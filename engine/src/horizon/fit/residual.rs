//! What the coarser pages of a pyramid leave of a page's means.
//!
//! # References
//! Burt & Adelson (1983), *The Laplacian pyramid as a compact image code*, doi:10.1109/TCOM.1983.1095851.

use std::borrow::Cow;

use rayon::prelude::*;

use super::group::Group;
use super::sums::Sums;

/// Means of all coefficients at one page's resolution, in groups of as many each.
pub type Means = [Group];

/// One coefficient over a row of texels.
fn row_of(means: &Means, row: usize, real: usize) -> Cow<'_, [f32]> {
    let reals = means[0].reals;
    means[real / reals].row(row, real % reals)
}

/// Means over boxes of `scale²` texels, as far as they lie in the map.
pub fn box_means(sums: &Group, scale: usize) -> Group {
    let (columns, rows) = (sums.columns.div_ceil(scale), sums.rows.div_ceil(scale));
    let mut means = vec![0.0; columns * rows * sums.reals];
    means.par_chunks_mut(columns * sums.reals).enumerate().for_each(|(row, means)| {
        let rows = row * scale..((row + 1) * scale).min(sums.rows);
        for (real, means) in means.chunks_mut(columns).enumerate() {
            for row in rows.clone() {
                for (mean, boxed) in means.iter_mut().zip(sums.row(row, real).chunks(scale)) {
                    *mean += boxed.iter().sum::<f32>() / (boxed.len() * rows.len()) as f32;
                }
            }
        }
    });
    Group { scale, columns, rows, sums: Sums::Memory(means), ..*sums }
}

/// Means whose interpolation has about the means that were given. The mean of a bilinear interpolation over a texel is
/// `B = [⅛, ¾, ⅛]` of the texels along either axis; `2 − B` undoes it to first order.
pub fn sharpened(means: &Group) -> Group {
    let Group { columns, rows, reals, .. } = *means;
    let blurred = |[before, here, after]: [f32; 3]| 0.125 * before + 0.75 * here + 0.125 * after;
    let about = |index: usize, count: usize| [index.saturating_sub(1), index, (index + 1).min(count - 1)];
    let mut sharp = vec![0.0; columns * rows * reals];
    sharp.par_chunks_mut(columns * reals).enumerate().for_each(|(row, sharp)| {
        for (real, sharp) in sharp.chunks_mut(columns).enumerate() {
            let lines = about(row, rows).map(|row| means.row(row, real));
            for (column, sharp) in sharp.iter_mut().enumerate() {
                let along = about(column, columns);
                let blurred = blurred(lines.each_ref().map(|line| blurred(along.map(|column| line[column]))));
                *sharp = 2.0 * lines[1][column] - blurred;
            }
        }
    });
    Group { sums: Sums::Memory(sharp), ..*means }
}

/// What the coarser pages leave of a page's means.
#[derive(Debug, Clone, Copy)]
pub struct Residual<'a> {
    pub reals: usize,
    pub means: &'a Means,
    /// What the coarser pages decode to.
    pub coarser: &'a [Group],
}

impl Residual<'_> {
    /// Chosen coefficients over a row of texels.
    pub fn lines(&self, row: usize, reals: impl Iterator<Item = usize>) -> Vec<Vec<f32>> {
        let line = |real: usize| {
            let mut line = vec![0.0; self.means[0].columns];
            self.row(row, real, &mut line);
            line
        };
        reals.map(line).collect()
    }

    /// One coefficient over a row of texels.
    pub fn row(&self, row: usize, real: usize, residual: &mut [f32]) {
        residual.copy_from_slice(&row_of(self.means, row, real));
        let scale = self.means[0].scale;
        for page in self.coarser {
            let (low, high, fraction) = corner(row, scale, page.scale, page.rows);
            let (south, north) = (page.row(low, real), page.row(high, real));
            for (column, residual) in residual.iter_mut().enumerate() {
                let (west, east, x) = corner(column, scale, page.scale, page.columns);
                let south = south[west] + x * (south[east] - south[west]);
                let north = north[west] + x * (north[east] - north[west]);
                *residual -= south + fraction * (north - south);
            }
        }
    }
}

/// The two texels of a coarser page about the centre of texel `index`, and the weight of the second.
pub fn corner(index: usize, scale: usize, coarse: usize, count: usize) -> (usize, usize, f32) {
    let at = ((index as f32 + 0.5) * scale as f32 / coarse as f32 - 0.5).clamp(0.0, (count - 1) as f32);
    let low = at.floor();
    (low as usize, (low as usize + 1).min(count - 1), at - low)
}
