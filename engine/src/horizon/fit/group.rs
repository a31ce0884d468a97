//! Coefficients of one resolution while azimuths are added to them.

use std::borrow::Cow;

use super::sums::Sums;

/// Pixel rows that a task takes: the coarsest texel's.
pub const STRIP: usize = 8;

/// Sums of one group of numbers, `[texel row][real][texel column]`.
#[derive(Debug, Clone)]
pub struct Group {
    pub scale: usize,
    /// The encoding's numbers `first` to before `first + reals`.
    pub first: usize,
    pub reals: usize,
    pub rows: usize,
    pub columns: usize,
    pub sums: Sums,
}

impl Group {
    /// Sums of the rows that a task takes.
    pub fn strip(&self) -> usize {
        self.reals * self.columns * STRIP / self.scale
    }

    /// One number of a row of texels.
    pub fn row(&self, row: usize, real: usize) -> Cow<'_, [f32]> {
        self.sums.at((row * self.reals + real) * self.columns, self.columns)
    }
}
