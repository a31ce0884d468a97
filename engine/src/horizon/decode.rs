//! A map's skylines in a few azimuths, row by row: what [`HorizonMap::horizon`] gives at the nodes, in `f32`.
//!
//! For a fixed azimuth the sum over numbers and the interpolation between texels commute:
//!
//! ```text
//! h = Σₗ bilinear(Σ weight · value),  the sum over the numbers of level l
//! ```
//!
//! so that each texel row is summed once per azimuth and only one number per level is interpolated. Elevations that were
//! compressed are expanded last.

use glam::DVec2;

use super::companding;
use super::numbers::{Name, Number, numbers};
use super::pack::water::gain_of;
use super::pack::{HorizonMap, Texels};
use super::sweep::wide::wide;

/// A map and the weights of its numbers in some directions.
#[derive(Debug)]
pub struct Decoder<'a> {
    map: &'a HorizonMap,
    /// `[level][number]`.
    numbers: Vec<Vec<Number>>,
    /// `[level][direction][number]`.
    weights: Vec<Vec<Vec<f32>>>,
}

impl<'a> Decoder<'a> {
    /// A decoder for unit map directions.
    pub fn new(map: &'a HorizonMap, directions: &[DVec2]) -> Self {
        let all = numbers(map.encoding, &map.fields);
        let counts = |number: &&Number| number.name != Name::Gain;
        let of_level = |level: usize| all.iter().filter(|n| n.level == level).filter(counts).copied().collect();
        let numbers: Vec<Vec<Number>> = (0..map.levels.len()).map(of_level).collect();
        let weights = |numbers: &Vec<Number>| {
            let towards = |direction: &DVec2| numbers.iter().map(|n| n.name.weight(*direction) as f32).collect();
            directions.iter().map(towards).collect()
        };
        Self { map, weights: numbers.iter().map(weights).collect(), numbers }
    }

    /// Elevations of a row of nodes, `[direction][column]`, in radians.
    pub fn row(&self, row: usize) -> Vec<f32> {
        let (columns, bits) = (self.map.columns, self.map.encoding.gain_bits());
        let directions = self.weights.first().map_or(0, Vec::len);
        let mut elevations_rad = vec![0.0; directions * columns];
        for (index, (level, numbers)) in self.map.levels.iter().zip(&self.numbers).enumerate() {
            let Some(scale) = numbers.first().map(|number| number.scale) else { continue };
            let (low, share) = neighbours(row, scale, level.rows);
            // Where the second row has no share it is not decoded.
            let rows = [(low, 1.0 - share), ((low + 1).min(level.rows - 1), share)];
            let decoded = rows.iter().filter(|(_, share)| *share > 0.0);
            let decoded: Vec<_> = decoded.map(|(row, share)| values_rad(level, bits, numbers, *row, *share)).collect();
            for (weights, elevations_rad) in self.weights[index].iter().zip(elevations_rad.chunks_mut(columns)) {
                let mut sums = vec![0.0; level.columns];
                for values_rad in &decoded {
                    wide(
                        #[inline(always)]
                        || add_scaled(values_rad, weights, &mut sums),
                    );
                }
                for (column, elevation_rad) in elevations_rad.iter_mut().enumerate() {
                    let (low, share) = neighbours(column, scale, level.columns);
                    let next = sums[(low + 1).min(level.columns - 1)];
                    *elevation_rad += (1.0 - share) * sums[low] + share * next;
                }
            }
        }
        if let Some(growth) = self.map.encoding.growth() {
            companding::expand(growth as f32, &mut elevations_rad);
        }
        elevations_rad
    }
}

/// The texel at or below a node, and the share of the next one.
fn neighbours(node: usize, scale: usize, texels: usize) -> (usize, f32) {
    let at = (((node as f32) + 0.5) / scale as f32 - 0.5).clamp(0.0, (texels - 1) as f32);
    (at as usize, at.fract())
}

/// The share of a row of texels, with so many bits for a gain, in what its numbers stand for, `[number][column]`.
fn values_rad(level: &Texels, bits: u32, numbers: &[Number], row: usize, share: f32) -> Vec<f32> {
    let words = level.words_per_texel;
    let texels = || level.words[row * level.columns * words..][..level.columns * words].chunks(words);
    let gains: Vec<f32> = texels().map(|texel| gain_of(texel, bits)).collect();
    let mut values_rad = Vec::with_capacity(numbers.len() * level.columns);
    for number in numbers {
        let value = |(texel, gain)| share * number.value_rad(number.get(texel), gain);
        values_rad.extend(texels().zip(gains.iter().copied()).map(value));
    }
    values_rad
}

#[inline(always)]
fn add_scaled(values_rad: &[f32], weights: &[f32], sums: &mut [f32]) {
    for (values_rad, weight) in values_rad.chunks(sums.len()).zip(weights) {
        for (sum, value_rad) in sums.iter_mut().zip(values_rad) {
            *sum += weight * value_rad;
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
        for encoding in Encoding::ALL {
            let map = noise(encoding, 21, 13);
            let directions: Vec<_> = (0..5).map(|i| DVec2::from_angle(0.3 + 1.1 * f64::from(i))).collect();
            let decoder = Decoder::new(&map, &directions);
            for row in 0..map.rows {
                let rows = decoder.row(row);
                for (direction, elevations_rad) in directions.iter().zip(rows.chunks(map.columns)) {
                    for (column, elevation_rad) in elevations_rad.iter().enumerate() {
                        let series = map.horizon(DVec2::new(column as f64, row as f64));
                        let expected = series.evaluate_towards(*direction).0;
                        // Some fifty terms up to 1 rad in f32.
                        assert!((f64::from(*elevation_rad) - expected).abs() < 1e-5, "{elevation_rad} {expected}");
                    }
                }
            }
        }
    }
}
