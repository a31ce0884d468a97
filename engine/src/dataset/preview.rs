//! Previews for eyes: one plane of each exposure as 8-bit grey, on one scale for the whole sequence, in image, contact sheet
//! and film alike; and the same plane linear in 16 bits, on request.
//!
//! ```text
//! v = clamp(value / white, 0, 1)
//! grey = 255 · 12.92 v                         v ≤ 0.0031308      (sRGB, IEC 61966-2-1)
//!      = 255 · (1.055 v^(1/2.4) − 0.055)       else
//! DN   = 65535 · v                             linear
//! ```
//!
//! Pixels without a value are black. Where the elevation model has a gap, a grey checker stands in: a preview
//! must not show invented ground as if it were seen.

use std::path::Path;

use super::disk;
use super::error::DatasetError;
use super::manifest::PreviewScale;
use super::record::{PlaneRecord, Record};
use crate::render::Quantity;

/// The planes that are worth looking at, the best first.
const PREFERRED: [Quantity; 5] = [
    Quantity::Radiance,
    Quantity::RadianceFactor,
    Quantity::GroundIrradiance,
    Quantity::FocalPlaneIrradiance,
    Quantity::SunFraction,
];

const CHECKER_PIXELS: usize = 8;
const CHECKER_NUMBERS: [u16; 2] = [0x5000, 0x7000];
const CHECKER_GREYS: [u8; 2] = [0x70, 0x90];

/// How white is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum White {
    /// The largest 99.5 % quantile of the sequence.
    Auto,
    /// A radiance.
    Radiance(f64),
}

/// The plane that previews show.
pub fn shown(planes: &[PlaneRecord]) -> Option<&PlaneRecord> {
    let preferred = PREFERRED.iter().find_map(|quantity| planes.iter().find(|plane| plane.quantity == *quantity));
    preferred.or(planes.first())
}

/// How values become grey, for records.
pub const STRETCH: &str = "8 bits, sRGB: the value over white, cut off at 0 and 1, by the sRGB transfer function";

/// The scale for a sequence; `None` where there is nothing to show.
pub fn scale(records: &[Record], white: White) -> Option<PreviewScale> {
    let chosen = shown(&records.first()?.planes)?;
    let brightest = records.iter().filter_map(|record| brightest(&record.planes)).fold(0.0_f32, f32::max);
    Some(scale_of(chosen, brightest, white))
}

/// The 99.5 % quantile of the plane that previews show.
pub fn brightest(planes: &[PlaneRecord]) -> Option<f32> {
    shown(planes)?.statistics.quantile_995
}

/// The scale of a sequence whose brightest quantile is known.
pub fn scale_of(chosen: &PlaneRecord, brightest: f32, white: White) -> PreviewScale {
    let white = match white {
        White::Radiance(radiance) if chosen.quantity == Quantity::Radiance => radiance,
        // A sequence of the night has no brightest value; any scale shows it black.
        _ if brightest <= 0.0 => 1.0,
        _ => f64::from(brightest),
    };
    PreviewScale { channel: chosen.channel.clone(), white, unit: chosen.unit.clone() }
}

/// Digital numbers of a linear preview; `gaps` is the plane `DEM_GAP`.
pub fn digital_numbers(values: &[f32], gaps: Option<&[f32]>, columns: usize, white: f64) -> Vec<u16> {
    // The conversion saturates, and makes 0 of what is not a number: pixels without a value are black.
    encoded(values, gaps, columns, CHECKER_NUMBERS, |value| (value / white * 65535.0).round() as u16)
}

/// Greys of a preview for eyes; `gaps` is the plane `DEM_GAP`.
pub fn grey(values: &[f32], gaps: Option<&[f32]>, columns: usize, white: f64) -> Vec<u8> {
    encoded(values, gaps, columns, CHECKER_GREYS, |value| srgb(value / white))
}

fn encoded<T: Copy>(
    values: &[f32],
    gaps: Option<&[f32]>,
    columns: usize,
    checker: [T; 2],
    encode: impl Fn(f64) -> T,
) -> Vec<T> {
    let gap = |pixel: usize| gaps.is_some_and(|gaps| gaps[pixel] > 0.5);
    let number = |(pixel, value): (usize, &f32)| match gap(pixel) {
        true => checker[(pixel % columns / CHECKER_PIXELS + pixel / columns / CHECKER_PIXELS) % 2],
        false => encode(f64::from(*value)),
    };
    values.iter().enumerate().map(number).collect()
}

/// A share of white as sRGB; what is not a number is black.
pub fn srgb(share: f64) -> u8 {
    let share = share.clamp(0.0, 1.0);
    let encoded = if share <= 0.003_130_8 { 12.92 * share } else { 1.055 * share.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}

/// The share of white that a grey shows.
fn linear(grey: u8) -> f64 {
    let encoded = f64::from(grey) / 255.0;
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The line of text that goes with a preview.
pub fn comment(scale: &PreviewScale) -> String {
    format!("{} [{}], sRGB: white is {:e} {}", scale.channel, scale.unit, scale.white, scale.unit)
}

/// The line of text that goes with a linear preview.
pub fn linear_comment(scale: &PreviewScale) -> String {
    format!("{} [{}], linear: DN 65535 = {:e} {}", scale.channel, scale.unit, scale.white, scale.unit)
}

/// A preview, or one reduced for the overviews: sRGB greys row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Thumbnail {
    pub columns: usize,
    pub rows: usize,
    pub grey: Vec<u8>,
}

impl Thumbnail {
    /// A preview that was written.
    pub fn read(path: &Path) -> Result<Self, DatasetError> {
        let decoded = image::load_from_memory_with_format(&disk::read(path)?, image::ImageFormat::Png);
        let image = decoded.map_err(|source| DatasetError::DecodeImage { path: path.to_path_buf(), source })?;
        let grey = image.into_luma8();
        Ok(Self { columns: grey.width() as usize, rows: grey.height() as usize, grey: grey.into_raw() })
    }

    /// At most `largest` pixels a side: means of light over squares of pixels. Light adds up, grey values do not.
    pub fn reduced(&self, largest: usize) -> Self {
        let Self { columns, rows, ref grey } = *self;
        let step = columns.max(rows).div_ceil(largest).max(1);
        let (small_columns, small_rows) = (columns.div_ceil(step), rows.div_ceil(step));
        let light: [f64; 256] = std::array::from_fn(|grey| linear(grey as u8));
        let mean = |index: usize| {
            let (left, top) = (index % small_columns * step, index / small_columns * step);
            let (right, bottom) = ((left + step).min(columns), (top + step).min(rows));
            let pixels = (top..bottom).flat_map(|row| &grey[row * columns + left..row * columns + right]);
            pixels.map(|grey| light[usize::from(*grey)]).sum::<f64>() / ((right - left) * (bottom - top)) as f64
        };
        let grey = (0..small_columns * small_rows).map(|index| srgb(mean(index))).collect();
        Self { columns: small_columns, rows: small_rows, grey }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_linear_up_to_white_and_black_without_a_value() {
        let values = [0.0, 1.0, 2.0, 3.0, f32::NAN, -1.0];
        assert_eq!(digital_numbers(&values, None, 6, 2.0), [0, 32768, 65535, 65535, 0, 0]);
        // IEC 61966-2-1: half of the light is grey 188 of 255.
        assert_eq!(grey(&values, None, 6, 2.0), [0, 188, 255, 255, 0, 0]);
    }

    /// IEC 61966-2-1, and its inverse: every grey comes back.
    #[test]
    fn greys_are_those_of_srgb() {
        assert_eq!([0.0, 0.001, 0.18, 0.5, 1.0].map(srgb), [0, 3, 118, 188, 255]);
        assert!((0..=255).all(|grey| srgb(linear(grey)) == grey));
    }

    #[test]
    fn a_gap_of_the_elevation_model_is_a_checker() {
        let dn = digital_numbers(&[0.5; 32], Some(&[1.0; 32]), 16, 1.0);
        assert_eq!((dn[0], dn[7], dn[8]), (0x5000, 0x5000, 0x7000));
        assert_eq!(digital_numbers(&[0.5], Some(&[0.0]), 1, 1.0), [32768]);
        assert_eq!(
            grey(&[0.5; 32], Some(&[1.0; 32]), 16, 1.0)[..9],
            [0x70, 0x70, 0x70, 0x70, 0x70, 0x70, 0x70, 0x70, 0x90]
        );
    }

    #[test]
    fn a_thumbnail_keeps_the_mean_light() {
        let preview = Thumbnail { columns: 3, rows: 2, grey: vec![0, 255, 255, 0, 255, 255] };
        let thumbnail = preview.reduced(2);
        assert_eq!((thumbnail.columns, thumbnail.rows), (2, 1));
        // Half of the light.
        assert_eq!(thumbnail.grey, [188, 255]);
        assert_eq!(preview.reduced(3), preview);
    }
}
