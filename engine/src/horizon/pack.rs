//! Horizons as texels: pages of words, decoded at any point of a map.
//!
//! | encoding | what a pixel holds | bytes per pixel | of |
//! |---|---|---|---|
//! | `fm4 … fm16` | 4 … 16 complex coefficients as half floats, four at each of the resolutions 1, 1/2, 1/4, 1/8 ([`half`]) | 16 … 21.25 | Fritsch et al. (2025) |
//! | `f4 … f16` | the same at full resolution | 16 … 64 | Fritsch et al. (2025) |
//! | `raw8 … raw16` | elevations at 8 … 16 azimuths as half floats ([`raw`]) | 16 … 32 | Max (1988) |
//! | `w11, w16, w21` | up to 47 harmonics over those four resolutions in fields of bits ([`bit_fields`]) | 10.6, 15.9, 21.25 | this program |
//! | `q` | 19 harmonics over those four resolutions in fields of bits, equal steps: made for small files ([`super::fit::equal`]) | 42.5 | this program |
//!
//! A texel at a reduced resolution stands for its box of pixels, as far as the box lies in the map. Decoding is bilinear
//! between texel centres, the first and last texels reaching to the map's edge: texel `i` of scale `s` is centred at grid
//! `(i + ½) s − ½`. All encodings are linear in their words' values, so that interpolation and evaluation commute; `w*` are of
//! elevations that are expanded last.
//!
//! `w21` errs less than `fm16` at the nodes; in images interpolation between nodes decides, and `fm16` stays their default:
//! `docs/experiments/horizon_encodings_in_images.md`.
//!
//! # References
//! Fritsch et al. (2025), *Fast Planetary Shadows using Fourier-Compressed Horizon Maps*, doi:10.2312/hpg.20251171.
//! Max (1988), *Horizon mapping: shadows for bump-mapped surfaces*, The Visual Computer 4, 109.

pub mod bit_fields;
pub mod encoding;
pub mod half;
pub mod raw;
pub mod texels;

use glam::DVec2;

pub use bit_fields::BitField;
pub use encoding::{Encoding, Family, PageLayout};
pub use half::{pack, unpack};
pub use raw::Sampled;
pub use texels::Texels;

use super::bound::Bounds;
use super::companding;
use super::series::Series;
use super::statistics::TileErrors;

/// The horizons of all seen nodes of a level.
#[derive(Debug, Clone, PartialEq)]
pub struct HorizonMap {
    pub encoding: Encoding,
    /// Nodes of the level's seen part, its margin excluded.
    pub columns: usize,
    pub rows: usize,
    /// The encoding's pages.
    pub levels: Vec<Texels>,
    /// What the bits of fields mean, by page; empty for other encodings.
    pub fields: Vec<Vec<BitField>>,
    pub errors: TileErrors,
    pub bounds: Bounds,
}

/// A decoded skyline.
#[derive(Debug, Clone, PartialEq)]
pub enum Horizon {
    Series(Series),
    /// A series of compressed elevations, and κ of [`super::companding`].
    Companded(Series, f64),
    Sampled(Sampled),
}

impl Horizon {
    /// Elevation and its derivative by azimuth towards the unit map direction `(sin A, cos A)`.
    pub fn evaluate_towards(&self, towards: DVec2) -> (f64, f64) {
        match self {
            Self::Series(series) => series.evaluate_towards(towards),
            Self::Companded(series, growth) => companding::expanded(*growth, series.evaluate_towards(towards)),
            Self::Sampled(sampled) => sampled.evaluate_towards(towards),
        }
    }
}

impl Encoding {
    /// Whether a table of fields, by page, is one of this encoding: none where there is nothing to describe, and no bit of a
    /// texel in two of them.
    pub fn describes(self, fields: &[Vec<BitField>]) -> bool {
        let pages = self.pages();
        let reals = 2 * (self.harmonics() + 1);
        let fits = |(page, fields): (&PageLayout, &Vec<BitField>)| {
            fields.iter().all(|field| field.lies_in(page.words, reals))
                && bit_fields::are_apart(fields, page.words, self.gain_bits())
        };
        match self.family() {
            Family::Fourier | Family::Sampled => fields.is_empty(),
            Family::Quantised => fields.len() == pages.len() && pages.iter().zip(fields).all(fits),
        }
    }
}

impl HorizonMap {
    /// The horizon at a grid point, counted in nodes from the first seen one; beyond the edges that of the edge.
    pub fn horizon(&self, grid: DVec2) -> Horizon {
        match self.encoding.family() {
            Family::Fourier => Horizon::Series(half::series(self.encoding, &self.levels, grid)),
            Family::Sampled => Horizon::Sampled(raw::sampled(&self.levels[0], grid)),
            Family::Quantised => {
                let series = bit_fields::series(self.encoding, &self.levels, &self.fields, grid);
                match self.encoding.growth() {
                    None => Horizon::Series(series),
                    Some(growth) => Horizon::Companded(series, growth),
                }
            }
        }
    }

    /// The map with its first coefficients only; `None` where it has fewer, or has none ([`Encoding::with_coefficients`]).
    /// Nothing is known of its error.
    pub fn with_coefficients(mut self, coefficients: u32) -> Option<Self> {
        let encoding = self.encoding.with_coefficients(coefficients)?;
        if encoding != self.encoding {
            self.levels.truncate(encoding.pages().len());
            (self.errors, self.bounds) = (TileErrors::default(), Bounds::unknown(self.columns, self.rows));
        }
        Some(Self { encoding, ..self })
    }

    /// Bytes of all pages.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| size_of_val(level.words.as_slice())).sum()
    }

    /// Standard deviation of the skyline's error at a grid point, in radians; `None` where nothing is known.
    pub fn sigma_rad(&self, grid: DVec2) -> Option<f64> {
        self.bound_rad(grid).map(|bound_rad| self.errors.bound.rms_fraction * bound_rad)
    }

    /// How far the skyline at a grid point may be off in any azimuth, in radians ([`super::bound`]); `None` where nothing
    /// is known.
    pub fn bound_rad(&self, grid: DVec2) -> Option<f64> {
        self.bounds.bound_rad(grid)
    }
}

/// Where a map lies in a buffer of texels: `HorizonGrid` of `series.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub struct HorizonGrid {
    pub columns: u32,
    pub rows: u32,
    /// Where the fields of a water-filled pyramid are described.
    pub table: u32,
    pub offset_0: u32,
    pub offset_1: u32,
    pub offset_2: u32,
    pub offset_3: u32,
}

impl HorizonMap {
    /// Appends all pages, and the table of fields if there is one, to a buffer and tells where they lie in it.
    pub fn append_to(&self, buffer: &mut Vec<[u32; 4]>) -> HorizonGrid {
        let mut offsets = [0; 4];
        for (offset, level) in offsets.iter_mut().zip(&self.levels) {
            *offset = buffer.len() as u32;
            let chunks = level.words.chunks(4);
            buffer.extend(chunks.map(|words| std::array::from_fn(|i| words.get(i).copied().unwrap_or(0))));
        }
        let table = buffer.len() as u32;
        buffer.extend(bit_fields::table(&self.fields));
        let [offset_0, offset_1, offset_2, offset_3] = offsets;
        HorizonGrid {
            columns: self.columns as u32,
            rows: self.rows as u32,
            table,
            offset_0,
            offset_1,
            offset_2,
            offset_3,
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A map whose coefficient `k` grows linearly over the grid.
    fn ramp(encoding: Encoding, columns: usize, rows: usize) -> HorizonMap {
        let levels = encoding.pages().into_iter().map(|page| {
            let mut level = Texels::empty(columns, rows, page);
            for row in 0..level.rows {
                for column in 0..level.columns {
                    let x = (column as f64 + 0.5) * page.scale as f64 - 0.5;
                    let y = (row as f64 + 0.5) * page.scale as f64 - 0.5;
                    // Multiples of 1/256 below 1 are exact as half floats.
                    let value = ((x + y) / 256.0) as f32;
                    let first = (row * level.columns + column) * page.words;
                    level.words[first..first + page.words].fill(pack([value, -value]));
                }
            }
            level
        });
        let levels = levels.collect();
        let (errors, bounds) = (TileErrors::default(), Bounds::unknown(columns, rows));
        HorizonMap { encoding, columns, rows, levels, fields: Vec::new(), errors, bounds }
    }

    fn series(map: &HorizonMap, grid: DVec2) -> Series {
        let Horizon::Series(series) = map.horizon(grid) else { panic!("a series") };
        series
    }

    /// A map of numbers without any pattern: half floats between -1 and 1, or fields of one to nine bits.
    pub fn noise(encoding: Encoding, columns: usize, rows: usize) -> HorizonMap {
        let mut state = 1_u32;
        let mut next = || {
            // Numerical Recipes' linear congruence.
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state as f32 / u32::MAX as f32 * 2.0 - 1.0
        };
        let is_fields = encoding.family() == Family::Quantised;
        let pages = encoding.pages();
        let mut levels: Vec<_> = pages.iter().map(|page| Texels::empty(columns, rows, *page)).collect();
        for word in levels.iter_mut().flat_map(|level| &mut level.words) {
            *word = if is_fields { next().to_bits().wrapping_mul(2_654_435_761) } else { pack([next(), next()]) };
        }
        let field = |word: usize, index: usize, shift: u32, width: u32| BitField {
            real: (7 * word + index) % (2 * (encoding.harmonics() + 1)),
            word,
            shift,
            width,
            step_rad: 2e-5,
            offset_rad: 5e-4,
            bias: 0.5 * (word % 3) as f32,
        };
        let places = [(2, 9), (11, 1), (12, 4), (16, 6), (22, 2), (24, 3), (27, 5), (0, 2)];
        // The last one's bits are those of the gain, if there is one.
        let has_gain = encoding.gain_bits() > 0;
        let of_word = |word: usize| {
            let count = places.len() - usize::from(has_gain && word == 0);
            (0..count).map(move |index| field(word, index, places[index].0, places[index].1))
        };
        let of_page = |page: &PageLayout| (0..page.words).flat_map(of_word).collect();
        let fields = if is_fields { pages.iter().map(of_page).collect() } else { Vec::new() };
        let mut bounds = Bounds::unknown(columns, rows);
        bounds.codes.iter_mut().for_each(|code| *code = (next().abs() * 255.0) as u8);
        HorizonMap { encoding, columns, rows, levels, fields, errors: TileErrors::default(), bounds }
    }

    #[test]
    fn linear_coefficients_decode_exactly_between_texel_centres() {
        for encoding in [Encoding::Fm16, Encoding::F16, Encoding::Fm8, Encoding::F4] {
            let map = ramp(encoding, 64, 48);
            for grid in [DVec2::new(10.0, 20.0), DVec2::new(33.25, 7.5), DVec2::new(50.0, 40.0)] {
                let series = series(&map, grid);
                let expected = (grid.x + grid.y) / 256.0;
                assert_eq!(series.harmonics_rad.len(), encoding.harmonics());
                assert!((series.mean_rad - expected).abs() < 1e-12);
                for [a, b] in series.harmonics_rad {
                    assert!((a - expected).abs() < 1e-3 && (b - expected).abs() < 1e-3, "{a} {b} {expected}");
                }
            }
        }
    }

    #[test]
    fn the_first_coefficients_are_those_of_the_whole_series() {
        let at = DVec2::new(17.3, 22.8);
        for encoding in [Encoding::Fm16, Encoding::F16, Encoding::Fm12] {
            let whole = series(&noise(encoding, 40, 40), at);
            for coefficients in [4, 8, 12] {
                let first = series(&noise(encoding, 40, 40).with_coefficients(coefficients).unwrap(), at);
                assert_eq!(first.mean_rad, whole.mean_rad);
                assert_eq!(first.harmonics_rad, whole.harmonics_rad[..coefficients as usize - 1]);
            }
        }
        assert_eq!(noise(Encoding::Fm16, 8, 8).with_coefficients(8).unwrap().encoding, Encoding::Fm8);
        for (encoding, coefficients) in
            [(Encoding::Fm8, 12), (Encoding::Fm16, 10), (Encoding::W21, 8), (Encoding::Raw8, 4)]
        {
            assert!(noise(encoding, 8, 8).with_coefficients(coefficients).is_none(), "{encoding} {coefficients}");
        }
    }

    #[test]
    fn beyond_the_edge_the_edge_texel_counts() {
        let map = ramp(Encoding::Fm16, 16, 16);
        assert_eq!(series(&map, DVec2::new(-3.0, 0.0)).mean_rad, series(&map, DVec2::ZERO).mean_rad);
    }

    /// Table 1 of Fritsch et al. (2025): files of 256² pixels of 1.5 MB (raw, 12 samples), 1.33 MB (fm16), 4 MB (f16).
    #[test]
    fn maps_take_the_bytes_of_the_papers() {
        let mib = |encoding: Encoding| encoding.bytes_per_pixel() * 65536.0 / 1048576.0;
        assert_eq!(mib(Encoding::Raw12), 1.5);
        assert!((mib(Encoding::Fm16) - 1.33).abs() < 0.005);
        assert_eq!(mib(Encoding::F16), 4.0);
        assert_eq!(Encoding::W21.bytes_per_pixel(), Encoding::Fm16.bytes_per_pixel());
        assert!(Encoding::W16.bytes_per_pixel() <= 16.0);
        for encoding in Encoding::ALL {
            let pages = encoding.pages().into_iter().map(|page| Texels::empty(256, 256, page).words.len() * 4);
            assert_eq!(pages.sum::<usize>() as f64 / 65536.0, encoding.bytes_per_pixel());
        }
    }

    /// The shaders' functions are valid WGSL, and `HorizonGrid` has the members of its Rust twin in their order.
    #[test]
    fn the_shaders_are_valid_and_share_their_layout() {
        let bindings = "@group(0) @binding(0) var<storage, read> horizon_texels: array<vec4u>;
            fn horizon_texel(index: u32) -> vec4u { return horizon_texels[index]; }";
        for encoding in [Encoding::Fm16, Encoding::Raw8, Encoding::W21, Encoding::Q] {
            let module = naga::front::wgsl::parse_str(&format!("{bindings}{}", encoding.wgsl())).unwrap();
            // `unpack2x16float`, which every wgpu adapter of class WebGPU has.
            let needed = naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32;
            let mut validator = naga::valid::Validator::new(Default::default(), needed);
            validator.validate(&module).unwrap();
            let grid = module.types.iter().find(|(_, kind)| kind.name.as_deref() == Some("HorizonGrid")).unwrap().1;
            let naga::TypeInner::Struct { members, span } = &grid.inner else { panic!("a struct") };
            assert_eq!(*span as usize, size_of::<HorizonGrid>());
            let names: Vec<_> = members.iter().map(|m| (m.name.as_deref().unwrap(), m.offset)).collect();
            let expected = ["columns", "rows", "table", "offset_0", "offset_1", "offset_2", "offset_3"];
            assert_eq!(names, expected.into_iter().zip((0..).step_by(4)).collect::<Vec<_>>());
        }
    }
}
