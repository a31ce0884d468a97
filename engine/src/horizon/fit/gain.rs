//! One gain for all codes of a texel: a small power of two.
//!
//! A texel beside a cliff has residuals ten times those of its neighbours, in all harmonics alike. With steps for both, codes of
//! most texels are 0; two bits of a texel that say how large its steps are cost it 2 % of its bits.
//!
//! # References
//! Gersho & Gray (1992), *Vector Quantization and Signal Compression*, chapter 12: shape-gain quantisation.

use super::quantiser::error_rad;
use crate::horizon::pack::BitField;
use crate::horizon::pack::bit_fields::{GAINS, gain};
use crate::horizon::wide::wide;

/// The fraction of texels that have no more energy than the largest gain is for.
const LARGEST: f64 = 0.998;

/// Gains to begin with: by the weighted sums of the squares of what texels hold, `[coefficient][texel]`.
pub fn by_energy(values_rad: &[Vec<f32>], weights: &[f64]) -> Vec<f32> {
    let mut energies = vec![0.0_f64; values_rad.first().map_or(0, Vec::len)];
    for (values_rad, weight) in values_rad.iter().zip(weights) {
        let mean_rad = values_rad.iter().map(|value| f64::from(*value)).sum::<f64>() / values_rad.len() as f64;
        let square = |value: f32| weight * (f64::from(value) - mean_rad).powi(2);
        energies.iter_mut().zip(values_rad).for_each(|(energy, value)| *energy += square(*value));
    }
    let mut sorted = energies.clone();
    sorted.sort_by(f64::total_cmp);
    let largest = sorted.get(((sorted.len().max(1) - 1) as f64 * LARGEST) as usize).copied().unwrap_or(0.0);
    let last = (GAINS - 1) as f64;
    let code = |energy: &f64| last + (0.5 * (energy / largest).log2()).round().clamp(-last, 0.0);
    // The energy of nothing at all has no logarithm: a NaN becomes 0.
    energies.iter().map(|energy| gain(code(energy) as u32)).collect()
}

/// For each texel the gain with which fields lose the least, by weighted squares; `values_rad` are `[field][texel]`.
pub fn best(fields: &[BitField], weights: &[f64], values_rad: &[impl AsRef<[f32]>], texels: usize) -> Vec<u32> {
    let mut losses = vec![vec![0.0_f32; texels]; GAINS];
    for (field, values_rad) in fields.iter().zip(values_rad) {
        let weight = weights[field.real] as f32;
        for (code, losses) in losses.iter_mut().enumerate() {
            let step_rad = gain(code as u32) * field.step_rad;
            wide(
                #[inline(always)]
                || add_losses(field, step_rad, weight, values_rad.as_ref(), losses),
            );
        }
    }
    let least = |texel: usize| (0..GAINS).min_by(|a, b| losses[*a][texel].total_cmp(&losses[*b][texel]));
    (0..texels).map(|texel| least(texel).unwrap_or(0) as u32).collect()
}

#[inline(always)]
fn add_losses(field: &BitField, step_rad: f32, weight: f32, values_rad: &[f32], losses: &mut [f32]) {
    let quantiser = [step_rad, 1.0 / step_rad, field.bias, (1_u32 << field.width) as f32];
    for (loss, value_rad) in losses.iter_mut().zip(values_rad) {
        let error_rad = error_rad(value_rad - field.offset_rad, quantiser);
        *loss += weight * error_rad * error_rad;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energies_an_octave_apart_have_gains_an_octave_apart() {
        let values_rad = vec![[-1.0_f32, 1.0].repeat(4), [-8.0, 8.0, -4.0, 4.0, -2.0, 2.0, -0.01, 0.01].to_vec()];
        let of_second = by_energy(&values_rad, &[0.0, 1.0]);
        assert_eq!(of_second, [8.0, 8.0, 4.0, 4.0, 2.0, 2.0, 1.0, 1.0]);
        // Nothing to tell apart.
        assert!(by_energy(&[vec![0.5; 4]], &[1.0]).iter().all(|gain| *gain <= 8.0));
        assert!(by_energy(&[], &[]).is_empty());
    }

    #[test]
    fn the_best_gain_is_the_least_that_reaches_the_value() {
        let field = BitField { real: 0, word: 0, shift: 2, width: 3, step_rad: 0.1, offset_rad: 0.0, bias: 0.5 };
        // Three bits reach from -0.35 to 0.35.
        let values_rad = vec![vec![0.35, 0.7, 1.4, 2.8, 0.05]];
        assert_eq!(best(&[field], &[1.0], &values_rad, 5), [0, 1, 2, 3, 0]);
    }
}
