//! Fields of bits: every real coefficient as small integers, in water-filled pyramids summed over four resolutions.
//!
//! ```text
//! c(x) = Σ_pages Σ_texels weight · (offset + gain · step · (code + bias))      c = a₀, a₁, b₁, … a₄₇, b₄₇
//! ```
//!
//! A texel of `w` words at each of the resolutions 1, 1/2, 1/4, 1/8 holds a signed field of a few bits for each coefficient
//! that is worth them there ([`super::super::fit::bit_allocation`] decides). Skylines of neighbours are alike in their low
//! harmonics, so that the coarse pages say most of those and the fine ones only what is left; there no bit is spent on what
//! half floats keep twice over. The fields of a page are the same in all of its texels: the map's table says which bits of
//! which word, which coefficient, which step. No field crosses a word. The lowest two bits of a texel say its gain, 1, 2, 4 or
//! 8 ([`super::super::fit::gain`]), and the series is of elevations that are expanded afterwards
//! ([`crate::horizon::companding`]). A texel of a map in equal steps ([`super::super::fit::equal`]) has eight words, and neither.
//!
//! `bit_fields.wgsl` decodes the same from a buffer in which the table lies behind the pages.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::encoding::{Encoding, GAIN_BITS};
use super::texels::Texels;
use crate::horizon::series::Series;

/// Pages of a pyramid.
pub const PAGES: usize = 4;

/// Gains that a texel may have.
pub const GAINS: usize = 1 << GAIN_BITS;

/// The gain that a code stands for.
pub fn gain(code: u32) -> f32 {
    (1_u32 << code) as f32
}

/// The gain's code in a texel that has so many bits for it.
pub fn gain_code(words: &[u32], bits: u32) -> u32 {
    words[0] & ((1 << bits) - 1)
}

/// The gain of a texel that has so many bits for it.
pub fn gain_of(words: &[u32], bits: u32) -> f32 {
    gain(gain_code(words, bits))
}

/// Puts a gain's code into a texel whose bits there are 0.
pub fn put_gain(words: &mut [u32], code: u32) {
    words[0] |= code & (GAINS as u32 - 1);
}

/// A field of bits that every texel of a page has.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BitField {
    /// `2k` for `aₖ`, `2k + 1` for `bₖ`.
    pub real: usize,
    pub word: usize,
    /// Lowest bit in the word, and number of bits.
    pub shift: u32,
    pub width: u32,
    /// What a code stands for: `offset + gain · step · (code + bias)`.
    pub step_rad: f32,
    pub offset_rad: f32,
    pub bias: f32,
}

impl BitField {
    /// The signed code in a texel.
    pub fn code(&self, words: &[u32]) -> i32 {
        (words[self.word] << self.left()) as i32 >> self.right()
    }

    /// Puts a code into a texel whose bits there are 0.
    pub fn put(&self, words: &mut [u32], code: i32) {
        words[self.word] |= (code as u32) << self.right() >> self.left();
    }

    /// The lowest and the highest code.
    pub fn range(&self) -> [i32; 2] {
        [-(1 << (self.width - 1)), (1 << (self.width - 1)) - 1]
    }

    pub fn value_rad(&self, code: i32, gain: f32) -> f32 {
        self.offset_rad + gain * self.step_rad * (code as f32 + self.bias)
    }

    pub(super) fn lies_in(&self, words: usize, reals: usize) -> bool {
        let bits = (1..=32).contains(&self.width) && self.shift <= 32 - self.width;
        let numbers = [self.step_rad, self.offset_rad, self.bias];
        bits && self.word < words && self.real < reals && numbers.iter().all(|number| number.is_finite())
    }

    fn left(&self) -> u32 {
        32 - self.width - self.shift
    }

    fn right(&self) -> u32 {
        32 - self.width
    }
}

/// Whether no bit of a texel belongs to two fields, or to a field and the gain. All lie in the texel.
pub(super) fn are_apart(fields: &[BitField], words: usize, gain_bits: u32) -> bool {
    let mut taken = vec![0_u32; words];
    taken[0] = (1 << gain_bits) - 1;
    fields.iter().all(|field| {
        let bits = u32::MAX >> field.right() << field.shift;
        let is_free = taken[field.word] & bits == 0;
        taken[field.word] |= bits;
        is_free
    })
}

/// The series at a grid point.
pub(super) fn series(encoding: Encoding, levels: &[Texels], fields: &[Vec<BitField>], grid: DVec2) -> Series {
    let mut reals = vec![0.0; 2 * (encoding.harmonics() + 1)];
    for ((level, page), fields) in levels.iter().zip(encoding.pages()).zip(fields) {
        for ((column, row), weight) in level.corners(grid, page.scale) {
            let texel = level.texel(column, row);
            let gain = gain_of(texel, encoding.gain_bits());
            for field in fields {
                reals[field.real] += weight * f64::from(field.value_rad(field.code(texel), gain));
            }
        }
    }
    let harmonics_rad = reals.chunks_exact(2).skip(1).map(|pair| [pair[0], pair[1]]).collect();
    Series { mean_rad: reals[0], harmonics_rad }
}

/// The table as the shader reads it: where each page's entries end, then an entry a field.
pub(super) fn table(fields: &[Vec<BitField>]) -> Vec<[u32; 4]> {
    if fields.is_empty() {
        return Vec::new();
    }
    let mut table = vec![[0; PAGES]];
    for (page, fields) in fields.iter().enumerate() {
        for field in fields {
            let description = field.word as u32 | field.left() << 8 | field.right() << 16 | (field.real as u32) << 24;
            table.push([description, field.step_rad.to_bits(), field.offset_rad.to_bits(), field.bias.to_bits()]);
        }
        table[0][page] = table.len() as u32;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives_every_place_in_a_word() {
        for width in 1..=8 {
            for shift in 0..=32 - width {
                let field = BitField { real: 0, word: 1, shift, width, step_rad: 1.0, offset_rad: 0.0, bias: 0.0 };
                for code in field.range()[0]..=field.range()[1] {
                    let mut words = [!0, !(((1_u32 << width) - 1) << shift), !0];
                    field.put(&mut words, code);
                    assert_eq!(field.code(&words), code, "{width} bits at {shift}");
                    let mut alone = [0; 3];
                    field.put(&mut alone, code);
                    assert_eq!(alone[1] & words[1], alone[1]);
                    assert_eq!([alone[0], alone[2]], [0, 0]);
                }
            }
        }
    }
}
