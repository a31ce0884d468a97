//! A map's skylines in a few azimuths, row by row: what [`HorizonMap::horizon`] gives at the nodes, in `f32`.
//!
//! For a fixed azimuth the sum over coefficients and the interpolation between texels commute:
//!
//! ```text
//! h = Σₗ bilinear(Σₖ Re Xₖ cos kA − Im Xₖ sin kA),  k of level l
//! ```
//!
//! so that each texel row is summed once per azimuth and only one number per level is interpolated.

use glam::{DVec2, Vec2Swizzles as _};

use super::pack::{HorizonMap, TEXEL_COEFFICIENTS, Texels, unpack};
use super::sweep::wide::wide;

/// Real numbers in a texel.
const REALS: usize = 2 * TEXEL_COEFFICIENTS;

/// A map and the weights of its coefficients in some directions.
#[derive(Debug)]
pub struct Decoder<'a> {
    map: &'a HorizonMap,
    /// `[direction][level]`: `cos kA` and `−sin kA` of each coefficient.
    weights: Vec<Vec<[f32; REALS]>>,
}

impl<'a> Decoder<'a> {
    /// A decoder for unit map directions.
    pub fn new(map: &'a HorizonMap, directions: impl Iterator<Item = DVec2>) -> Self {
        Self { map, weights: directions.map(|direction| weights(map, direction)).collect() }
    }

    /// Elevations of a row of nodes, `[direction][column]`, in radians.
    pub fn row(&self, row: usize) -> Vec<f32> {
        let columns = self.map.columns;
        let mut elevations_rad = vec![0.0; self.weights.len() * columns];
        for (index, (level, scale)) in self.map.levels.iter().zip(self.map.encoding.scales()).enumerate() {
            let (low, share) = neighbours(row, scale, level.rows);
            let rows = [low, (low + 1).min(level.rows - 1)];
            // At full resolution the second row has no share.
            let reals = rows[..if share == 0.0 { 1 } else { 2 }].iter().map(|row| reals(level, *row));
            let reals: Vec<_> = reals.collect();
            for (weights, elevations_rad) in self.weights.iter().zip(elevations_rad.chunks_mut(columns)) {
                let mut sums = vec![0.0; level.columns];
                for (reals, share) in reals.iter().zip([1.0 - share, share]) {
                    wide(
                        #[inline(always)]
                        || add_scaled(reals, weights[index].map(|weight| weight * share), &mut sums),
                    );
                }
                for (column, elevation_rad) in elevations_rad.iter_mut().enumerate() {
                    let (low, share) = neighbours(column, scale, level.columns);
                    let next = sums[(low + 1).min(level.columns - 1)];
                    *elevation_rad += (1.0 - share) * sums[low] + share * next;
                }
            }
        }
        elevations_rad
    }
}

/// The texel at or below a node, and the share of the next one.
fn neighbours(node: usize, scale: usize, texels: usize) -> (usize, f32) {
    let at = (((node as f32) + 0.5) / scale as f32 - 0.5).clamp(0.0, (texels - 1) as f32);
    (at as usize, at.fract())
}

/// A row of texels as numbers, `[real][column]`.
fn reals(level: &Texels, row: usize) -> Vec<f32> {
    let mut reals = vec![0.0; REALS * level.columns];
    for (column, texel) in level.texels[row * level.columns..(row + 1) * level.columns].iter().enumerate() {
        for (slot, word) in texel.iter().enumerate() {
            let [re, im] = unpack(*word);
            reals[2 * slot * level.columns + column] = re;
            reals[(2 * slot + 1) * level.columns + column] = im;
        }
    }
    reals
}

fn weights(map: &HorizonMap, direction: DVec2) -> Vec<[f32; REALS]> {
    let step = direction.yx();
    let mut turned = DVec2::X;
    let mut level = || {
        let mut weights = [0.0; REALS];
        for slot in 0..TEXEL_COEFFICIENTS {
            (weights[2 * slot], weights[2 * slot + 1]) = (turned.x as f32, -turned.y as f32);
            turned = step.rotate(turned);
        }
        weights
    };
    map.levels.iter().map(|_| level()).collect()
}

#[inline(always)]
fn add_scaled(reals: &[f32], weights: [f32; REALS], sums: &mut [f32]) {
    for (reals, weight) in reals.chunks(sums.len()).zip(weights) {
        for (sum, real) in sums.iter_mut().zip(reals) {
            *sum += weight * real;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::horizon::Encoding;
    use crate::horizon::pack::tests::noise;

    #[test]
    fn rows_are_the_series_at_their_nodes() {
        for encoding in [Encoding::Fm16, Encoding::F16] {
            let map = noise(encoding, 21, 13);
            let directions: Vec<_> = (0..5).map(|i| DVec2::from_angle(0.3 + 1.1 * f64::from(i))).collect();
            let decoder = Decoder::new(&map, directions.iter().copied());
            for row in 0..map.rows {
                let rows = decoder.row(row);
                for (direction, elevations_rad) in directions.iter().zip(rows.chunks(map.columns)) {
                    for (column, elevation_rad) in elevations_rad.iter().enumerate() {
                        let series = map.horizon(DVec2::new(column as f64, row as f64));
                        let expected = series.evaluate_towards(*direction).0;
                        // Thirty-one terms up to 1 rad in f32.
                        assert!((f64::from(*elevation_rad) - expected).abs() < 1e-5, "{elevation_rad} {expected}");
                    }
                }
            }
        }
    }
}
