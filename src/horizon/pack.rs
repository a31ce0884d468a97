//! Series as texels: complex half floats over resolution levels.
//!
//! With the series of [`super::series`], a texel holds the coefficients of
//!
//! ```text
//! h(A) = Re Σₖ Xₖ e^{ikA} = Σₖ (Re Xₖ cos kA − Im Xₖ sin kA)      X₀ = a₀   Xₖ = aₖ − i bₖ
//! ```
//!
//! which is equation 3 of Fritsch et al. (2025): a one-sided sum, so that for `k ≥ 1` their `Xₖ` is *twice* the
//! coefficient `1/N Σ h e^{−ikA}` of a discrete Fourier transform. Four coefficients make a texel of `4 × u32`, real part in
//! the low half, imaginary part in the high one (`Rgba32Uint`).
//!
//! | encoding | coefficients 0–3 | 4–7 | 8–11 | 12–15 | bytes per pixel |
//! |---|---|---|---|---|---|
//! | `fm16` | 1 | 1/2 | 1/4 | 1/8 | 21.25 |
//! | `f16` | 1 | 1 | 1 | 1 | 64 |
//!
//! A texel at a reduced resolution is the mean over its box of pixels, as far as the box lies in the map. Decoding is bilinear between texel centres, the
//! first and last texels reaching to the map's edge: texel `i` of scale `s` is centred at grid `(i + ½) s − ½`.
//!
//! # Assumptions
//! A half float keeps 11 bits: a coefficient of 0.23 rad is off by up to 6e-5 rad.
//!
//! # References
//! Fritsch et al. (2025), *Fourier-compressed horizon maps*. Max (1988), *Horizon mapping: shadows for bump-mapped surfaces*.

use glam::DVec2;
use half::f16;
use serde::{Deserialize, Serialize};

use super::bound::Bounds;
use super::error::TileErrors;
use super::series::Series;

/// Complex coefficients in a texel.
pub const TEXEL_COEFFICIENTS: usize = 4;

/// How a series is laid out in texels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Encoding {
    /// 16 coefficients, four at each of the resolutions 1, 1/2, 1/4 and 1/8.
    Fm16,
    /// 16 coefficients at full resolution.
    F16,
}

impl Encoding {
    /// Pixels per texel side of each group of four coefficients.
    pub fn scales(self) -> [usize; 4] {
        match self {
            Self::Fm16 => [1, 2, 4, 8],
            Self::F16 => [1; 4],
        }
    }

    /// Harmonics above the mean.
    pub fn harmonics(self) -> usize {
        self.scales().len() * TEXEL_COEFFICIENTS - 1
    }
}

/// One resolution level of a horizon map, rows *up* the map like those of a [`crate::terrain::Level`].
#[derive(Debug, Clone, PartialEq)]
pub struct Texels {
    pub columns: usize,
    pub rows: usize,
    pub texels: Vec<[u32; 4]>,
}

/// The horizons of all seen nodes of a level.
#[derive(Debug, Clone, PartialEq)]
pub struct HorizonMap {
    pub encoding: Encoding,
    /// Nodes of the level's seen part, its margin excluded.
    pub columns: usize,
    pub rows: usize,
    /// Coefficients 0–3, 4–7, 8–11, 12–15.
    pub levels: Vec<Texels>,
    pub errors: TileErrors,
    pub bounds: Bounds,
}

impl HorizonMap {
    /// The series at a grid point, counted in nodes from the first seen one; beyond the edges that of the edge.
    pub fn horizon(&self, grid: DVec2) -> Series {
        let mut mean_rad = 0.0;
        let mut harmonics_rad = Vec::with_capacity(self.encoding.harmonics());
        for (group, (level, scale)) in self.levels.iter().zip(self.encoding.scales()).enumerate() {
            for (slot, [re, im]) in level.bilinear(grid, scale).into_iter().enumerate() {
                match (group, slot) {
                    (0, 0) => mean_rad = re,
                    _ => harmonics_rad.push([re, -im]),
                }
            }
        }
        Series { mean_rad, harmonics_rad }
    }

    /// Standard deviation of the skyline's error at a grid point, in radians; `None` where nothing is known.
    pub fn sigma_rad(&self, grid: DVec2) -> Option<f64> {
        self.bound_rad(grid).map(|bound_rad| self.errors.bound.rms_share * bound_rad)
    }

    /// How far the skyline at a grid point may be off in any azimuth, in radians ([`super::bound`]); `None` where nothing is known.
    pub fn bound_rad(&self, grid: DVec2) -> Option<f64> {
        self.bounds.bound_rad(grid)
    }
}

/// Where a map lies in a buffer of texels: `HorizonGrid` of `series.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct HorizonGrid {
    pub columns: u32,
    pub rows: u32,
    /// How many times each level halves the one before: 1 for `fm16`, 0 for `f16`.
    pub halving: u32,
    pub offset_0: u32,
    pub offset_1: u32,
    pub offset_2: u32,
    pub offset_3: u32,
}

impl HorizonMap {
    /// Appends all texels to a buffer and tells where they lie in it.
    pub fn append_to(&self, buffer: &mut Vec<[u32; 4]>) -> HorizonGrid {
        let [offset_0, offset_1, offset_2, offset_3] = std::array::from_fn(|i| {
            let offset = buffer.len() as u32;
            buffer.extend_from_slice(&self.levels[i].texels);
            offset
        });
        let halving = u32::from(self.encoding == Encoding::Fm16);
        HorizonGrid {
            columns: self.columns as u32,
            rows: self.rows as u32,
            halving,
            offset_0,
            offset_1,
            offset_2,
            offset_3,
        }
    }
}

impl Texels {
    /// A level of `scale` for a map of so many pixels.
    pub(super) fn empty(columns: usize, rows: usize, scale: usize) -> Self {
        let (columns, rows) = (columns.div_ceil(scale), rows.div_ceil(scale));
        Self { columns, rows, texels: vec![[0; 4]; columns * rows] }
    }

    fn bilinear(&self, grid: DVec2, scale: usize) -> [[f64; 2]; TEXEL_COEFFICIENTS] {
        let last = DVec2::new((self.columns - 1) as f64, (self.rows - 1) as f64);
        let at = ((grid + 0.5) / scale as f64 - 0.5).clamp(DVec2::ZERO, last);
        let low = at.floor();
        let f = at - low;
        let (column, row) = (low.x as usize, low.y as usize);
        let (next_column, next_row) = ((column + 1).min(self.columns - 1), (row + 1).min(self.rows - 1));
        let corners = [
            (column, row, (1.0 - f.x) * (1.0 - f.y)),
            (next_column, row, f.x * (1.0 - f.y)),
            (column, next_row, (1.0 - f.x) * f.y),
            (next_column, next_row, f.x * f.y),
        ];
        let mut sum = [[0.0; 2]; TEXEL_COEFFICIENTS];
        for (column, row, share) in corners {
            for (sum, word) in sum.iter_mut().zip(self.texels[row * self.columns + column]) {
                let [re, im] = unpack(word);
                sum[0] += share * f64::from(re);
                sum[1] += share * f64::from(im);
            }
        }
        sum
    }
}

/// Real part in the low half, imaginary part in the high one, as WGSL's `pack2x16float`.
pub fn pack([re, im]: [f32; 2]) -> u32 {
    u32::from(f16::from_f32(re).to_bits()) | u32::from(f16::from_f32(im).to_bits()) << 16
}

pub fn unpack(word: u32) -> [f32; 2] {
    [f16::from_bits(word as u16).to_f32(), f16::from_bits((word >> 16) as u16).to_f32()]
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A map whose coefficient `k` grows linearly over the grid.
    fn ramp(encoding: Encoding, columns: usize, rows: usize) -> HorizonMap {
        let levels = encoding.scales().into_iter().map(|scale| {
            let mut level = Texels::empty(columns, rows, scale);
            for row in 0..level.rows {
                for column in 0..level.columns {
                    let x = (column as f64 + 0.5) * scale as f64 - 0.5;
                    let y = (row as f64 + 0.5) * scale as f64 - 0.5;
                    // Multiples of 1/256 below 1 are exact as half floats.
                    let value = ((x + y) / 256.0) as f32;
                    level.texels[row * level.columns + column] = [pack([value, -value]); 4];
                }
            }
            level
        });
        let levels = levels.collect();
        let (errors, bounds) = (TileErrors::default(), Bounds::unknown(columns, rows));
        HorizonMap { encoding, columns, rows, levels, errors, bounds }
    }

    /// A map of half floats between -1 and 1 without any pattern.
    pub fn noise(encoding: Encoding, columns: usize, rows: usize) -> HorizonMap {
        let mut map = ramp(encoding, columns, rows);
        let mut state = 1_u32;
        let mut next = || {
            // Numerical Recipes' linear congruence.
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state as f32 / u32::MAX as f32 * 2.0 - 1.0
        };
        for level in &mut map.levels {
            level.texels.iter_mut().flatten().for_each(|word| *word = pack([next(), next()]));
        }
        map.bounds.codes.iter_mut().for_each(|code| *code = (next().abs() * 255.0) as u8);
        map
    }

    #[test]
    fn coefficients_linear_over_the_map_decode_exactly_between_texel_centres() {
        for encoding in [Encoding::Fm16, Encoding::F16] {
            let map = ramp(encoding, 64, 48);
            for grid in [DVec2::new(10.0, 20.0), DVec2::new(33.25, 7.5), DVec2::new(50.0, 40.0)] {
                let series = map.horizon(grid);
                let expected = (grid.x + grid.y) / 256.0;
                assert!((series.mean_rad - expected).abs() < 1e-12);
                for [a, b] in series.harmonics_rad {
                    assert!((a - expected).abs() < 1e-3 && (b - expected).abs() < 1e-3, "{a} {b} {expected}");
                }
            }
        }
    }

    #[test]
    fn beyond_the_edge_the_edge_texel_counts() {
        let map = ramp(Encoding::Fm16, 16, 16);
        assert_eq!(map.horizon(DVec2::new(-3.0, 0.0)).mean_rad, map.horizon(DVec2::ZERO).mean_rad);
    }

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
