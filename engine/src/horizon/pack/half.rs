//! Complex coefficients as half floats (Fritsch et al. 2025).
//!
//! ```text
//! h(A) = Re Σₖ Xₖ e^{ikA} = Σₖ (Re Xₖ cos kA − Im Xₖ sin kA)      X₀ = a₀   Xₖ = aₖ − i bₖ
//! ```
//!
//! which is their equation 3: a one-sided sum, so that for `k ≥ 1` their `Xₖ` is *twice* the coefficient
//! `1/N Σ h e^{−ikA}` of a discrete Fourier transform. Page `p` holds `X₄ₚ … X₄ₚ₊₃`, a word each: the real part in the low
//! half, the imaginary part in the high one. In `fm4 … fm16` the resolution halves from page to page, in `f4 … f16` it does
//! not.
//!
//! # Assumptions
//! A half float keeps 11 bits: a coefficient of 0.23 rad is off by up to 6e-5 rad.

use glam::DVec2;
use half::f16;

use super::encoding::{Encoding, TEXEL_COEFFICIENTS};
use super::texels::Texels;
use crate::horizon::series::Series;

/// The series at a grid point.
pub(super) fn series(encoding: Encoding, levels: &[Texels], grid: DVec2) -> Series {
    let mut mean_rad = 0.0;
    let mut harmonics_rad = Vec::with_capacity(encoding.harmonics());
    for (page, (level, layout)) in levels.iter().zip(encoding.pages()).enumerate() {
        for slot in 0..TEXEL_COEFFICIENTS {
            let [re, im] = level.bilinear(grid, layout.scale, |words| unpack(words[slot]).map(f64::from));
            match (page, slot) {
                (0, 0) => mean_rad = re,
                _ => harmonics_rad.push([re, -im]),
            }
        }
    }
    Series { mean_rad, harmonics_rad }
}

/// Real part in the low half, imaginary part in the high one, as WGSL's `pack2x16float`.
pub fn pack([re, im]: [f32; 2]) -> u32 {
    u32::from(f16::from_f32(re).to_bits()) | u32::from(f16::from_f32(im).to_bits()) << 16
}

pub fn unpack(word: u32) -> [f32; 2] {
    [f16::from_bits(word as u16).to_f32(), f16::from_bits((word >> 16) as u16).to_f32()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_half_float_survives_packing() {
        for bits in 0..=u16::MAX {
            let value = f16::from_bits(bits).to_f32();
            if !value.is_nan() {
                let word = pack([value, 1.0]);
                assert_eq!(word & 0xffff, u32::from(bits));
                assert_eq!(unpack(word), [value, 1.0]);
            }
        }
    }
}
