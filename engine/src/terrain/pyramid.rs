//! Maxima of a level's cells over ever larger blocks: the bound that lets a ray skip empty space.
//!
//! Mip 0 holds the maximum of each cell's four corners, mip `m` that of `2^m × 2^m` cells. A bilinear
//! cell never rises above its corners, so a ray whose lowest point over a block lies above the block's
//! maximum misses everything in it. The maxima are bounds, never used as heights.

use super::Level;

/// Maxima of all mips, mip 0 first.
#[derive(Debug, Clone, PartialEq)]
pub struct Pyramid {
    pub mips: Vec<Mip>,
}

/// One mip: blocks row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Mip {
    pub columns: usize,
    pub rows: usize,
    pub maxima_m: Vec<f32>,
}

impl Pyramid {
    pub fn new(level: &Level) -> Self {
        let mut mips = vec![Mip::of_cells(level)];
        while mips.last().is_some_and(|mip| mip.columns > 1 || mip.rows > 1) {
            mips.push(mips[mips.len() - 1].coarser());
        }
        Self { mips }
    }

    /// The highest lifted height of the level.
    pub fn top_m(&self) -> f64 {
        f64::from(self.mips.last().expect("a pyramid has a top").maxima_m[0])
    }
}

impl Mip {
    fn of_cells(level: &Level) -> Self {
        let (columns, rows) = (level.columns - 1, level.rows - 1);
        let mut maxima_m = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            let low = &level.heights_m[row * level.columns..][..level.columns];
            let high = &level.heights_m[(row + 1) * level.columns..][..level.columns];
            maxima_m.extend((0..columns).map(|c| low[c].max(low[c + 1]).max(high[c]).max(high[c + 1])));
        }
        Self { columns, rows, maxima_m }
    }

    fn coarser(&self) -> Self {
        let (columns, rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        let mut maxima_m = vec![f32::NEG_INFINITY; columns * rows];
        for row in 0..self.rows {
            for column in 0..self.columns {
                let block = &mut maxima_m[row / 2 * columns + column / 2];
                *block = block.max(self.maxima_m[row * self.columns + column]);
            }
        }
        Self { columns, rows, maxima_m }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_node_lies_under_every_block_that_holds_it() {
        let (columns, rows) = (13, 7);
        let heights_m: Vec<f32> = (0..columns * rows).map(|i| ((i * 7919) % 101) as f32).collect();
        let gap = vec![false; heights_m.len()];
        let level = Level { columns, rows, posting_m: 1.0, west_m: 0.0, south_m: 0.0, heights_m, gap, margin: 0 };
        let pyramid = Pyramid::new(&level);
        for (m, mip) in pyramid.mips.iter().enumerate() {
            for row in 0..rows - 1 {
                for column in 0..columns - 1 {
                    let bound = mip.maxima_m[(row >> m) * mip.columns + (column >> m)];
                    assert!(level.corners_m(column, row).iter().all(|&h| h as f32 <= bound));
                }
            }
        }
        assert_eq!(pyramid.top_m(), 100.0);
    }
}
