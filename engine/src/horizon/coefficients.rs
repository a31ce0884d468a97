//! The coefficients in a map's texels, one by one, whatever the encoding: where each lies, what it is worth, what it counts for.
//!
//! ```text
//! h(x, y, A) = Σ coefficients  weight(name, A) · bilinear(value)(x, y)      h compressed where the encoding does
//! ```
//!
//! Files keep them as whole numbers in planes ([`super::pages`]), [`super::decode`] sums them. A half float becomes a whole
//! number that keeps its order:
//!
//! ```text
//! i = bits as a two's complement number;  x = i where i ≥ 0, i xor 0x7fff where i < 0      (its own inverse)
//! ```

use std::f64::consts::TAU;
use std::fmt;

use glam::DVec2;
use half::f16;

use super::pack::bit_fields::{gain_code, put_gain};
use super::pack::encoding::TEXEL_COEFFICIENTS;
use super::pack::{BitField, Encoding, Family};

/// What a coefficient multiplies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CoefficientName {
    /// `Re Xₖ` and `Im Xₖ` of [`super::pack::half`].
    Re(usize),
    Im(usize),
    /// `aₖ` and `bₖ` of [`super::series`].
    A(usize),
    B(usize),
    /// The gain of a texel's codes ([`super::pack::bit_fields`]): it counts for nothing by itself.
    Gain,
    /// The elevation at one of so many azimuths.
    Sample {
        index: usize,
        of: usize,
    },
}

impl fmt::Display for CoefficientName {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Re(k) => write!(f, "re {k}"),
            Self::Im(k) => write!(f, "im {k}"),
            Self::A(k) => write!(f, "a {k}"),
            Self::B(k) => write!(f, "b {k}"),
            Self::Gain => f.write_str("gain"),
            Self::Sample { index, .. } => write!(f, "h {index}"),
        }
    }
}

impl CoefficientName {
    /// What it counts for towards a unit map direction `(sin A, cos A)`.
    pub fn weight(self, direction: DVec2) -> f64 {
        let azimuth_rad = direction.x.atan2(direction.y);
        match self {
            Self::Re(k) | Self::A(k) => (k as f64 * azimuth_rad).cos(),
            Self::Im(k) => -(k as f64 * azimuth_rad).sin(),
            Self::B(k) => (k as f64 * azimuth_rad).sin(),
            Self::Gain => 0.0,
            Self::Sample { index, of } => {
                let distance = (azimuth_rad / TAU * of as f64 - index as f64).rem_euclid(of as f64);
                (1.0 - distance.min(of as f64 - distance)).max(0.0)
            }
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Location {
    /// Sixteen bits of a word, from a bit on.
    Half {
        word: usize,
        shift: u32,
    },
    Field(BitField),
    /// So many bits.
    Gain(u32),
}

/// A coefficient that every texel of a level holds, as a whole number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficient {
    pub level: usize,
    pub scale: usize,
    pub name: CoefficientName,
    location: Location,
}

impl Coefficient {
    /// The whole number in a texel.
    pub fn get(&self, texel: &[u32]) -> i32 {
        match &self.location {
            Location::Half { word, shift } => i32::from(ordered((texel[*word] >> shift) as u16 as i16)),
            Location::Field(field) => field.code(texel),
            Location::Gain(bits) => gain_code(texel, *bits) as i32,
        }
    }

    /// Puts it into a texel whose bits there are 0.
    pub fn put(&self, texel: &mut [u32], number: i32) {
        match &self.location {
            Location::Half { word, shift } => texel[*word] |= u32::from(ordered(number as i16) as u16) << shift,
            Location::Field(field) => field.put(texel, number),
            Location::Gain(_) => put_gain(texel, number as u32),
        }
    }

    /// What a number stands for in a texel of some gain.
    pub fn value_rad(&self, number: i32, gain: f32) -> f32 {
        match &self.location {
            Location::Half { .. } => f16::from_bits(ordered(number as i16) as u16).to_f32(),
            Location::Field(field) => field.value_rad(number, gain),
            Location::Gain(_) => 0.0,
        }
    }

    /// Its description where it is a field.
    pub fn field(&self) -> Option<BitField> {
        match self.location {
            Location::Half { .. } | Location::Gain(_) => None,
            Location::Field(field) => Some(field),
        }
    }
}

/// Sign and magnitude to two's complement, and back.
fn ordered(bits: i16) -> i16 {
    if bits < 0 { bits ^ i16::MAX } else { bits }
}

/// The coefficients of an encoding in the order of its pages.
pub fn coefficients(encoding: Encoding, fields: &[Vec<BitField>]) -> Vec<Coefficient> {
    let pages = encoding.pages().into_iter().enumerate();
    let halves = |level: usize, scale: usize, words: usize, name: &dyn Fn(usize, usize) -> CoefficientName| {
        let number = |half: usize| {
            let location = Location::Half { word: half / 2, shift: 16 * (half % 2) as u32 };
            Coefficient { level, scale, name: name(level, half), location }
        };
        (0..2 * words).map(number).collect::<Vec<_>>()
    };
    let complex = |level: usize, half: usize| {
        let k = level * TEXEL_COEFFICIENTS + half / 2;
        if half.is_multiple_of(2) { CoefficientName::Re(k) } else { CoefficientName::Im(k) }
    };
    let real =
        |real: usize| if real.is_multiple_of(2) { CoefficientName::A(real / 2) } else { CoefficientName::B(real / 2) };
    let of = encoding.samples();
    let of_page = |(level, page): (usize, super::pack::PageLayout)| match encoding.family() {
        Family::Fourier => halves(level, page.scale, page.words, &complex),
        Family::Sampled => halves(level, page.scale, page.words, &|_, index| CoefficientName::Sample { index, of }),
        Family::Quantised => {
            let (scale, bits) = (page.scale, encoding.gain_bits());
            let field = |field: &BitField| (real(field.real), Location::Field(*field));
            let gain = (bits > 0).then_some((CoefficientName::Gain, Location::Gain(bits)));
            let all = fields[level].iter().map(field).chain(gain);
            all.map(|(name, location)| Coefficient { level, scale, name, location }).collect()
        }
    };
    pages.flat_map(of_page).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_keep_the_order_of_half_floats() {
        let finite = |bits: &u16| f16::from_bits(*bits).is_finite();
        let mut halves: Vec<u16> = (0..=u16::MAX).filter(finite).collect();
        assert!(halves.iter().all(|bits| ordered(ordered(*bits as i16)) as u16 == *bits));
        halves.sort_by_key(|bits| ordered(*bits as i16));
        assert!(halves.is_sorted_by_key(|bits| f16::from_bits(*bits).to_f32()));
    }

    #[test]
    fn sampled_elevations_count_for_all_and_alone_at_their_azimuth() {
        let weights = |azimuth_rad: f64| {
            let direction = DVec2::new(azimuth_rad.sin(), azimuth_rad.cos());
            [0, 1, 2, 7].map(|index| CoefficientName::Sample { index, of: 8 }.weight(direction))
        };
        let near = |a: [f64; 4], b: [f64; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(near(weights(0.0), [1.0, 0.0, 0.0, 0.0]) && near(weights(TAU / 8.0), [0.0, 1.0, 0.0, 0.0]));
        assert!(near(weights(0.25 * TAU / 8.0), [0.75, 0.25, 0.0, 0.0]));
        assert!(near(weights(-0.25 * TAU / 8.0), [0.75, 0.0, 0.0, 0.25]));
    }
}
