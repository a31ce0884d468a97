//! A map's skylines in a few azimuths, row by row: what [`HorizonMap::horizon`] gives at the nodes, in `f32`.
//!
//! For a fixed azimuth the sum over coefficients and the interpolation between texels commute:
//!
//! ```text
//! h = Σₗ bilinear(Σ weight · value),  the sum over the coefficients of level l
//! ```
//!
//! so that each texel row is summed once per azimuth and only one coefficient per level is interpolated. Elevations that were
//! compressed are expanded last.

use glam::DVec2;

use super::coefficients::{Coefficient, CoefficientName, coefficients};
use super::companding;
use super::pack::bit_fields::gain_of;
use super::pack::{HorizonMap, Texels};
use super::wide::wide;

/// A map and the weights of its coefficients in some directions.
#[derive(Debug)]
pub struct Decoder<'a> {
    map: &'a HorizonMap,
    /// `[level][coefficient]`.
    coefficients: Vec<Vec<Coefficient>>,
    /// `[level][direction][coefficient]`.
    weights: Vec<Vec<Vec<f32>>>,
}

impl<'a> Decoder<'a> {
    /// A decoder for unit map directions.
    pub fn new(map: &'a HorizonMap, directions: &[DVec2]) -> Self {
        let all = coefficients(map.encoding, &map.fields);
        let counts = |coefficient: &&Coefficient| coefficient.name != CoefficientName::Gain;
        let of_level = |level: usize| all.iter().filter(|n| n.level == level).filter(counts).copied().collect();
        let coefficients: Vec<Vec<Coefficient>> = (0..map.levels.len()).map(of_level).collect();
        let weights = |coefficients: &Vec<Coefficient>| {
            let towards = |direction: &DVec2| coefficients.iter().map(|n| n.name.weight(*direction) as f32).collect();
            directions.iter().map(towards).collect()
        };
        Self { map, weights: coefficients.iter().map(weights).collect(), coefficients }
    }

    /// Elevations of a row of nodes, `[direction][column]`, in radians.
    pub fn row(&self, row: usize) -> Vec<f32> {
        let (columns, bits) = (self.map.columns, self.map.encoding.gain_bits());
        let directions = self.weights.first().map_or(0, Vec::len);
        let mut elevations_rad = vec![0.0; directions * columns];
        for (index, (level, coefficients)) in self.map.levels.iter().zip(&self.coefficients).enumerate() {
            let Some(scale) = coefficients.first().map(|coefficient| coefficient.scale) else { continue };
            let (low, fraction) = neighbours(row, scale, level.rows);
            // Where the second row has no weight it is not decoded.
            let rows = [(low, 1.0 - fraction), ((low + 1).min(level.rows - 1), fraction)];
            let decoded = rows.iter().filter(|(_, fraction)| *fraction > 0.0);
            let decoded: Vec<_> =
                decoded.map(|(row, fraction)| values_rad(level, bits, coefficients, *row, *fraction)).collect();
            for (weights, elevations_rad) in self.weights[index].iter().zip(elevations_rad.chunks_mut(columns)) {
                let mut sums = vec![0.0; level.columns];
                for values_rad in &decoded {
                    wide(
                        #[inline(always)]
                        || add_scaled(values_rad, weights, &mut sums),
                    );
                }
                for (column, elevation_rad) in elevations_rad.iter_mut().enumerate() {
                    let (low, fraction) = neighbours(column, scale, level.columns);
                    let next = sums[(low + 1).min(level.columns - 1)];
                    *elevation_rad += (1.0 - fraction) * sums[low] + fraction * next;
                }
            }
        }
        if let Some(growth) = self.map.encoding.growth() {
            companding::expand(growth as f32, &mut elevations_rad);
        }
        elevations_rad
    }
}

/// The texel at or below a node, and the weight of the next one.
fn neighbours(node: usize, scale: usize, texels: usize) -> (usize, f32) {
    let at = (((node as f32) + 0.5) / scale as f32 - 0.5).clamp(0.0, (texels - 1) as f32);
    (at as usize, at.fract())
}

/// What the coefficients of a row of texels stand for, times a fraction; so many bits of a texel are its gain, `[coefficient][column]`.
fn values_rad(level: &Texels, bits: u32, coefficients: &[Coefficient], row: usize, fraction: f32) -> Vec<f32> {
    let words = level.words_per_texel;
    let texels = || level.words[row * level.columns * words..][..level.columns * words].chunks(words);
    let gains: Vec<f32> = texels().map(|texel| gain_of(texel, bits)).collect();
    let mut values_rad = Vec::with_capacity(coefficients.len() * level.columns);
    for coefficient in coefficients {
        let value = |(texel, gain)| fraction * coefficient.value_rad(coefficient.get(texel), gain);
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
