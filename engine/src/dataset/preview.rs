//! Previews: one plane of each exposure as 16-bit grey, linear, on one scale for the whole sequence.
//!
//! ```text
//! DN = 65535 · clamp(value / white, 0, 1)
//! ```
//!
//! Pixels without a value are black. Where the elevation model has a gap, a grey checker stands in: a preview
//! must not show invented ground as if it were seen.

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
const CHECKER_GREYS: [u16; 2] = [0x5000, 0x7000];

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

/// The scale for a sequence; `None` where there is nothing to show.
pub fn scale(records: &[Record], white: White) -> Option<PreviewScale> {
    let chosen = shown(&records.first()?.planes)?;
    let quantiles = records.iter().flat_map(|record| &record.planes).filter(|plane| plane.channel == chosen.channel);
    let brightest = quantiles.filter_map(|plane| plane.statistics.quantile_995).fold(0.0_f32, f32::max);
    let white = match white {
        White::Radiance(radiance) if chosen.quantity == Quantity::Radiance => radiance,
        // A sequence of the night has no brightest value; any scale shows it black.
        _ if brightest <= 0.0 => 1.0,
        _ => f64::from(brightest),
    };
    Some(PreviewScale { channel: chosen.channel.clone(), white, unit: chosen.unit.clone() })
}

/// Digital numbers of a preview; `gaps` is the plane `DEM_GAP`.
pub fn digital_numbers(values: &[f32], gaps: Option<&[f32]>, columns: usize, white: f64) -> Vec<u16> {
    let gap = |pixel: usize| gaps.is_some_and(|gaps| gaps[pixel] > 0.5);
    let number = |(pixel, value): (usize, &f32)| {
        if gap(pixel) {
            let (column, row) = (pixel % columns, pixel / columns);
            return CHECKER_GREYS[(column / CHECKER_PIXELS + row / CHECKER_PIXELS) % 2];
        }
        // The conversion saturates, and makes 0 of what is not a number: pixels without a value are black.
        (f64::from(*value) / white * 65535.0).round() as u16
    };
    values.iter().enumerate().map(number).collect()
}

/// The line of text that goes with a preview.
pub fn comment(scale: &PreviewScale) -> String {
    format!("{} [{}], linear: DN 65535 = {:e} {}", scale.channel, scale.unit, scale.white, scale.unit)
}

/// A preview reduced to at most `largest` pixels a side, 8 bits, gamma 2.2.
#[derive(Debug, Clone, PartialEq)]
pub struct Thumbnail {
    pub columns: usize,
    pub rows: usize,
    pub grey: Vec<u8>,
}

impl Thumbnail {
    /// Means over squares of pixels, taken before the gamma: light adds up, grey values do not.
    pub fn of(dn: &[u16], columns: usize, largest: usize) -> Self {
        let rows = dn.len() / columns;
        let step = columns.max(rows).div_ceil(largest).max(1);
        let (small_columns, small_rows) = (columns.div_ceil(step), rows.div_ceil(step));
        let mean = |index: usize| {
            let (left, top) = (index % small_columns * step, index / small_columns * step);
            let (right, bottom) = ((left + step).min(columns), (top + step).min(rows));
            let sum: f64 = (top..bottom)
                .flat_map(|row| &dn[row * columns + left..row * columns + right])
                .map(|dn| f64::from(*dn))
                .sum();
            sum / ((right - left) * (bottom - top)) as f64
        };
        let grey = (0..small_columns * small_rows).map(|index| gamma(mean(index))).collect();
        Self { columns: small_columns, rows: small_rows, grey }
    }
}

/// `255 (DN / 65535)^(1/2.2)`.
pub fn gamma(dn: f64) -> u8 {
    (255.0 * (dn / 65535.0).powf(1.0 / 2.2)).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_linear_up_to_white_and_black_without_a_value() {
        let dn = digital_numbers(&[0.0, 1.0, 2.0, 3.0, f32::NAN, -1.0], None, 6, 2.0);
        assert_eq!(dn, [0, 32768, 65535, 65535, 0, 0]);
    }

    #[test]
    fn a_gap_of_the_elevation_model_is_a_checker() {
        let dn = digital_numbers(&[0.5; 32], Some(&[1.0; 32]), 16, 1.0);
        assert_eq!((dn[0], dn[7], dn[8]), (0x5000, 0x5000, 0x7000));
        assert_eq!(digital_numbers(&[0.5], Some(&[0.0]), 1, 1.0), [32768]);
    }

    #[test]
    fn a_thumbnail_keeps_the_mean_light() {
        let thumbnail = Thumbnail::of(&[0, 65535, 65535, 0, 65535, 65535], 3, 2);
        assert_eq!((thumbnail.columns, thumbnail.rows), (2, 1));
        // (0 + 65535 + 0 + 65535) / 4 is half of white: 255 · 0.5^(1/2.2) = 186.
        assert_eq!(thumbnail.grey, [186, 255]);
    }
}
