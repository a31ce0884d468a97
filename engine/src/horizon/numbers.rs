//! The numbers in a map's texels, one by one, whatever the encoding: where each lies, what it is worth, what it counts for.
//!
//! ```text
//! h(x, y, A) = Σ numbers  weight(name, A) · bilinear(value)(x, y)      h compressed where the encoding does
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

use super::pack::half::TEXEL_COEFFICIENTS;
use super::pack::water::{gain_code, put_gain};
use super::pack::{Encoding, Family, Field};

/// What a number is a coefficient of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Name {
    /// `Re Xₖ` and `Im Xₖ` of [`super::pack::half`].
    Re(usize),
    Im(usize),
    /// `aₖ` and `bₖ` of [`super::series`].
    A(usize),
    B(usize),
    /// The gain of a texel's codes ([`super::pack::water`]): it counts for nothing by itself.
    Gain,
    /// The elevation at one of so many azimuths.
    Sample {
        index: usize,
        of: usize,
    },
}

impl fmt::Display for Name {
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

impl Name {
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
enum Place {
    /// Sixteen bits of a word, from a bit on.
    Half {
        word: usize,
        shift: u32,
    },
    Field(Field),
    /// So many bits.
    Gain(u32),
}

/// A number that every texel of a level holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Number {
    pub level: usize,
    pub scale: usize,
    pub name: Name,
    place: Place,
}

impl Number {
    /// Of a texel.
    pub fn get(&self, texel: &[u32]) -> i32 {
        match &self.place {
            Place::Half { word, shift } => i32::from(ordered((texel[*word] >> shift) as u16 as i16)),
            Place::Field(field) => field.code(texel),
            Place::Gain(bits) => gain_code(texel, *bits) as i32,
        }
    }

    /// Puts it into a texel whose bits there are 0.
    pub fn put(&self, texel: &mut [u32], number: i32) {
        match &self.place {
            Place::Half { word, shift } => texel[*word] |= u32::from(ordered(number as i16) as u16) << shift,
            Place::Field(field) => field.put(texel, number),
            Place::Gain(_) => put_gain(texel, number as u32),
        }
    }

    /// What a number stands for in a texel of some gain.
    pub fn value_rad(&self, number: i32, gain: f32) -> f32 {
        match &self.place {
            Place::Half { .. } => f16::from_bits(ordered(number as i16) as u16).to_f32(),
            Place::Field(field) => field.value_rad(number, gain),
            Place::Gain(_) => 0.0,
        }
    }

    /// Its description where it is a field.
    pub fn field(&self) -> Option<Field> {
        match self.place {
            Place::Half { .. } | Place::Gain(_) => None,
            Place::Field(field) => Some(field),
        }
    }
}

/// Sign and magnitude to two's complement, and back.
fn ordered(bits: i16) -> i16 {
    if bits < 0 { bits ^ i16::MAX } else { bits }
}

/// The numbers of an encoding in the order of its pages.
pub fn numbers(encoding: Encoding, fields: &[Vec<Field>]) -> Vec<Number> {
    let pages = encoding.pages().into_iter().enumerate();
    let halves = |level: usize, scale: usize, words: usize, name: &dyn Fn(usize, usize) -> Name| {
        let number = |half: usize| {
            let place = Place::Half { word: half / 2, shift: 16 * (half % 2) as u32 };
            Number { level, scale, name: name(level, half), place }
        };
        (0..2 * words).map(number).collect::<Vec<_>>()
    };
    let complex = |level: usize, half: usize| {
        let k = level * TEXEL_COEFFICIENTS + half / 2;
        if half.is_multiple_of(2) { Name::Re(k) } else { Name::Im(k) }
    };
    let real = |real: usize| if real.is_multiple_of(2) { Name::A(real / 2) } else { Name::B(real / 2) };
    let of = encoding.samples();
    let of_page = |(level, page): (usize, super::pack::Page)| match encoding.family() {
        Family::Halves => halves(level, page.scale, page.words, &complex),
        Family::Samples => halves(level, page.scale, page.words, &|_, index| Name::Sample { index, of }),
        Family::Fields => {
            let (scale, bits) = (page.scale, encoding.gain_bits());
            let field = |field: &Field| (real(field.real), Place::Field(*field));
            let gain = (bits > 0).then_some((Name::Gain, Place::Gain(bits)));
            let all = fields[level].iter().map(field).chain(gain);
            all.map(|(name, place)| Number { level, scale, name, place }).collect()
        }
    };
    pages.flat_map(of_page).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_keep_the_order_of_half_floats_and_give_them_back() {
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
            [0, 1, 2, 7].map(|index| Name::Sample { index, of: 8 }.weight(direction))
        };
        let near = |a: [f64; 4], b: [f64; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(near(weights(0.0), [1.0, 0.0, 0.0, 0.0]) && near(weights(TAU / 8.0), [0.0, 1.0, 0.0, 0.0]));
        assert!(near(weights(0.25 * TAU / 8.0), [0.75, 0.25, 0.0, 0.0]));
        assert!(near(weights(-0.25 * TAU / 8.0), [0.75, 0.0, 0.0, 0.25]));
    }
}
