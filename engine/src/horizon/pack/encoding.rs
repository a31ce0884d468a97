//! The encodings by name: what a page holds, at which resolution, in how many words.
#![warn(missing_docs)]

use std::fmt;
use std::str::FromStr;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How horizons are stored. Bytes are per pixel.
///
/// Three families: Fourier series of half floats, sampled azimuths, quantised pyramids. Of each a user needs one or none
/// ([`Encoding::SHIPPED`]); the others are what papers and benches compare with, and what old tiles hold.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Encoding {
    /// 4 complex coefficients as half floats (Fritsch 2025): 16 bytes.
    #[schemars(extend("deprecated" = true))]
    Fm4,
    /// 8 coefficients, four of them at half the resolution: 20 bytes.
    #[schemars(extend("deprecated" = true))]
    Fm8,
    /// 12 coefficients, four at each of the resolutions 1, 1/2, 1/4: 21 bytes.
    #[schemars(extend("deprecated" = true))]
    Fm12,
    /// A Fourier pyramid of 16 complex coefficients as half floats, four at each of the resolutions 1, 1/2, 1/4, 1/8 (Fritsch
    /// 2025): 21.25 bytes.
    #[default]
    Fm16,
    /// 4 complex coefficients at full resolution (Fritsch 2025): 16 bytes.
    #[schemars(extend("deprecated" = true))]
    F4,
    /// 8 coefficients at full resolution: 32 bytes.
    #[schemars(extend("deprecated" = true))]
    F8,
    /// 12 coefficients at full resolution: 48 bytes.
    #[schemars(extend("deprecated" = true))]
    F12,
    /// 16 coefficients at full resolution: 64 bytes.
    #[schemars(extend("deprecated" = true))]
    F16,
    /// Elevations at 8 azimuths as half floats (Max 1988): 16 bytes.
    #[schemars(extend("deprecated" = true))]
    Raw8,
    /// Elevations at 12 azimuths: 24 bytes.
    #[schemars(extend("deprecated" = true))]
    Raw12,
    /// Elevations at 16 azimuths: 32 bytes.
    #[schemars(extend("deprecated" = true))]
    Raw16,
    /// A water-filled pyramid of up to 47 harmonics in two words a texel: 10.6 bytes.
    #[schemars(extend("deprecated" = true))]
    W11,
    /// A water-filled pyramid in three words a texel: 15.9 bytes.
    #[schemars(extend("deprecated" = true))]
    W16,
    /// A quantised pyramid of up to 47 harmonics, bits where they lower the error most: 21.25 bytes.
    W21,
    /// A quantised pyramid of 19 harmonics in equal steps: 42.5 bytes; its planes compress well, for small files.
    Q,
}

/// Encodings in a header, by their lower-case names.
pub mod by_name {
    use serde::{Deserialize as _, Deserializer, Serializer, de};

    use super::Encoding;

    /// Writes the encoding by its name.
    pub fn serialize<S: Serializer>(encoding: &Encoding, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(encoding.name())
    }

    /// Reads an encoding from its name.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Encoding, D::Error> {
        String::deserialize(deserializer)?.parse().map_err(de::Error::custom)
    }
}

/// What the words of a texel mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Four complex coefficients as half floats ([`super::half`]).
    Fourier,
    /// Sampled elevations as half floats ([`super::raw`]).
    Sampled,
    /// Coefficients in fields of bits ([`super::bit_fields`]).
    Quantised,
}

/// A page of texels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PageLayout {
    /// Pixels per texel side.
    pub scale: usize,
    /// 32-bit words per texel.
    pub words: usize,
}

/// Complex coefficients in a texel of half floats.
pub const TEXEL_COEFFICIENTS: usize = 4;
/// Bits of a texel's gain, the lowest of its first word.
pub const GAIN_BITS: u32 = 2;
/// Highest harmonic of the water-filled pyramids, and of equal steps.
const WATER_HARMONICS: usize = 47;
const EQUAL_HARMONICS: usize = 19;
/// κ of the elevations in water-filled pyramids, in rad⁻².
const WATER_GROWTH: f64 = 2.5;

impl Encoding {
    /// What users choose from.
    pub const SHIPPED: [Self; 3] = [Self::Fm16, Self::W21, Self::Q];

    /// Every encoding, those of papers and benches included.
    pub const ALL: [Self; 15] = [
        Self::Fm4,
        Self::Fm8,
        Self::Fm12,
        Self::Fm16,
        Self::F4,
        Self::F8,
        Self::F12,
        Self::F16,
        Self::Raw8,
        Self::Raw12,
        Self::Raw16,
        Self::W11,
        Self::W16,
        Self::W21,
        Self::Q,
    ];

    /// The name in arguments, scenarios and headers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fm4 => "fm4",
            Self::Fm8 => "fm8",
            Self::Fm12 => "fm12",
            Self::Fm16 => "fm16",
            Self::F4 => "f4",
            Self::F8 => "f8",
            Self::F12 => "f12",
            Self::F16 => "f16",
            Self::Raw8 => "raw8",
            Self::Raw12 => "raw12",
            Self::Raw16 => "raw16",
            Self::W11 => "w11",
            Self::W16 => "w16",
            Self::W21 => "w21",
            Self::Q => "q",
        }
    }

    /// The kind of compression that it is.
    pub fn family(self) -> Family {
        match self {
            Self::Raw8 | Self::Raw12 | Self::Raw16 => Family::Sampled,
            Self::W11 | Self::W16 | Self::W21 | Self::Q => Family::Quantised,
            _ => Family::Fourier,
        }
    }

    /// All pages, the finest first.
    pub fn pages(self) -> Vec<PageLayout> {
        let halves = |pages: usize, scale: fn(usize) -> usize| {
            (0..pages).map(|page| PageLayout { scale: scale(page), words: 4 }).collect()
        };
        let pyramid = |words: usize| [1, 2, 4, 8].map(|scale| PageLayout { scale, words }).to_vec();
        let samples = |count: usize| vec![PageLayout { scale: 1, words: count / 2 }];
        match self {
            Self::Fm4 => halves(1, |page| 1 << page),
            Self::Fm8 => halves(2, |page| 1 << page),
            Self::Fm12 => halves(3, |page| 1 << page),
            Self::Fm16 => halves(4, |page| 1 << page),
            Self::F4 => halves(1, |_| 1),
            Self::F8 => halves(2, |_| 1),
            Self::F12 => halves(3, |_| 1),
            Self::F16 => halves(4, |_| 1),
            Self::Raw8 => samples(8),
            Self::Raw12 => samples(12),
            Self::Raw16 => samples(16),
            Self::W11 => pyramid(2),
            Self::W16 => pyramid(3),
            Self::W21 => pyramid(4),
            Self::Q => pyramid(8),
        }
    }

    /// Sampled azimuths; 0 for a series.
    pub fn samples(self) -> usize {
        match self.family() {
            Family::Sampled => 2 * self.pages()[0].words,
            Family::Fourier | Family::Quantised => 0,
        }
    }

    /// Harmonics above the mean, 0 for samples.
    pub fn harmonics(self) -> usize {
        match self.family() {
            Family::Fourier => self.pages().len() * TEXEL_COEFFICIENTS - 1,
            Family::Sampled => 0,
            Family::Quantised if self == Self::Q => EQUAL_HARMONICS,
            Family::Quantised => WATER_HARMONICS,
        }
    }

    /// Bits of a texel's gain.
    pub fn gain_bits(self) -> u32 {
        if self.is_water_filled() { GAIN_BITS } else { 0 }
    }

    /// κ of [`crate::horizon::companding`]; `None` where the series is of elevations themselves.
    pub fn growth(self) -> Option<f64> {
        self.is_water_filled().then_some(WATER_GROWTH)
    }

    fn is_water_filled(self) -> bool {
        matches!(self, Self::W11 | Self::W16 | Self::W21)
    }

    /// What is left of a series of half floats with its first coefficients, 4, 8, 12 or 16; `None` where it has fewer, or
    /// keeps something else.
    pub fn with_coefficients(self, coefficients: u32) -> Option<Self> {
        let of_halving = [Self::Fm4, Self::Fm8, Self::Fm12, Self::Fm16];
        let of_full = [Self::F4, Self::F8, Self::F12, Self::F16];
        let series = [of_halving, of_full].into_iter().find(|series| series.contains(&self))?;
        let has = |encoding: &Self| encoding.harmonics() + 1 == coefficients as usize;
        series.into_iter().find(has).filter(|encoding| encoding.harmonics() <= self.harmonics())
    }

    /// Fewest swept azimuths that determine all of it.
    pub fn least_azimuths(self) -> usize {
        self.samples().max(2 * self.harmonics() + 1)
    }

    /// Bytes per pixel of a large map in memory.
    pub fn bytes_per_pixel(self) -> f64 {
        self.pages().iter().map(|page| (4 * page.words) as f64 / (page.scale * page.scale) as f64).sum()
    }

    /// `horizon_elevation` in WGSL, and in two steps `horizon_profile` and `horizon_towards`; the pass declares
    /// `fn horizon_texel(index: u32) -> vec4u`.
    pub fn wgsl(self) -> String {
        let decoder = match self.family() {
            Family::Fourier => include_str!("half.wgsl"),
            Family::Sampled => concat!(include_str!("raw.wgsl"), include_str!("profile.wgsl")),
            Family::Quantised => concat!(include_str!("bit_fields.wgsl"), include_str!("profile.wgsl")),
        };
        [include_str!("../series.wgsl"), decoder].concat()
    }

    /// Its `override` values: a pipeline decodes one encoding.
    pub fn constants(self) -> Vec<(&'static str, f64)> {
        let pages = self.pages();
        let halving = f64::from(u8::from(pages.last().is_some_and(|page| page.scale > 1)));
        let mut constants = vec![("HORIZON_HALVING", halving)];
        match self.family() {
            Family::Fourier => constants.push(("HORIZON_PAGES", pages.len() as f64)),
            Family::Sampled => {
                let sector_rad = std::f64::consts::TAU / self.samples() as f64;
                constants.push(("HORIZON_SAMPLES", self.samples() as f64));
                constants.push(("HORIZON_SECTOR_RAD", sector_rad));
                constants.push(("HORIZON_SECTOR_COS", sector_rad.cos()));
                constants.push(("HORIZON_SECTOR_SIN", sector_rad.sin()));
                constants.push(("HORIZON_MIDDLE_COS", (0.5 * sector_rad).cos()));
                constants.push(("HORIZON_MIDDLE_SIN", (0.5 * sector_rad).sin()));
            }
            Family::Quantised => constants.extend([
                ("HORIZON_WORDS", pages[0].words as f64),
                ("HORIZON_GAIN_BITS", f64::from(self.gain_bits())),
                ("HORIZON_GROWTH", self.growth().unwrap_or(0.0)),
            ]),
        }
        constants
    }
}

impl fmt::Display for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A name that no encoding has.
#[derive(Debug, thiserror::Error)]
#[error("{got} is no encoding, allowed are {}", Encoding::SHIPPED.map(Encoding::name).join(", "))]
pub struct UnknownEncoding {
    /// What was written instead of a name.
    pub got: String,
}

impl FromStr for Encoding {
    type Err = UnknownEncoding;

    fn from_str(text: &str) -> Result<Self, UnknownEncoding> {
        let found = Self::ALL.into_iter().find(|encoding| encoding.name() == text);
        found.ok_or_else(|| UnknownEncoding { got: text.into() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_schema_offers_what_is_shipped_and_the_others_parse() {
        let schema = serde_json::to_value(schemars::schema_for!(Encoding)).unwrap();
        let variants = schema["oneOf"].as_array().unwrap();
        for encoding in Encoding::ALL {
            let written = format!("{encoding:?}");
            assert_eq!(serde_json::from_str::<Encoding>(&format!("\"{written}\"")).unwrap(), encoding);
            assert_eq!(encoding.name().parse::<Encoding>().unwrap(), encoding);
            let variant = variants.iter().find(|variant| variant["const"] == written.as_str()).unwrap();
            assert_eq!(variant["deprecated"].is_null(), Encoding::SHIPPED.contains(&encoding), "{variant}");
        }
        assert!("f5".parse::<Encoding>().unwrap_err().to_string().ends_with("allowed are fm16, w21, q"));
    }
}
