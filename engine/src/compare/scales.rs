//! How alike photograph and render are, size by size: where the elevation model ends and the physics begins.
//!
//! ```text
//! B(σ) = G(σ) − G(2σ)      of both images;  strongest at wavelengths of 2π σ √(3/(2 ln 4)) = 6.54 σ
//! ```
//!
//! A model that lacks small relief shows it as contrast below 1 and correlation that falls towards short wavelengths; a
//! wrong law of reflection or another Sun spoils all of them.

use serde::Serialize;

use super::ScalarImage;
use super::statistics::{correlation, spread};

/// Likeness in an octave of wavelengths.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Scale {
    /// At which it is strongest.
    pub wavelength_px: f64,
    pub correlation: f64,
    /// Standard deviation of the fitted render over the photograph's.
    pub contrast: f64,
}

/// Of the smallest band, in pixels.
const FINEST_PX: f64 = 0.5;
/// Wavelengths over `σ`.
const WAVELENGTH: f64 = 6.54;
/// The longest wavelength, over the image's longer side.
const LONGEST: f64 = 0.3;

/// Octaves from the finest on, where both images are known.
pub fn scales(photo: &ScalarImage, fitted: &ScalarImage) -> Vec<Scale> {
    let known = |a: &ScalarImage, b: &ScalarImage| a.zip(b, |a, b| if b.is_nan() { f64::NAN } else { a });
    let (photo, fitted) = (known(photo, fitted), known(fitted, photo));
    let longest_px = LONGEST * photo.columns.max(photo.rows) as f64;
    let sigmas = std::iter::successors(Some(FINEST_PX), |sigma| Some(2.0 * sigma));
    let scale = |sigma_px: f64| {
        let band = |image: &ScalarImage| {
            image.blurred(sigma_px).zip(&image.blurred(2.0 * sigma_px), |fine, coarse| fine - coarse)
        };
        let (photo, fitted) = (band(&photo), band(&fitted));
        let contrast = |image: &ScalarImage| spread(image.values.iter().copied().filter(|value| value.is_finite())).0;
        Scale {
            wavelength_px: WAVELENGTH * sigma_px,
            correlation: correlation(photo.pairs(&fitted)),
            contrast: contrast(&fitted) / contrast(&photo),
        }
    };
    sigmas.take_while(|sigma| WAVELENGTH * sigma < longest_px).map(scale).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(period_px: f64, phase: f64) -> ScalarImage {
        let turn = std::f64::consts::TAU / period_px;
        ScalarImage::new(128, 128, (0..128 * 128).map(|i| (turn * (i % 128) as f64 + phase).sin()).collect())
    }

    /// Long waves alike but half as strong, short ones a quarter turn apart.
    #[test]
    fn what_differs_is_told_at_its_own_size() {
        let sum = |a: ScalarImage, b: ScalarImage| a.zip(&b, |a, b| a + b);
        let photo = sum(wave(26.0, 0.0), wave(3.3, 0.0));
        let render = sum(wave(26.0, 0.0).map(|v| 0.5 * v), wave(3.3, std::f64::consts::FRAC_PI_2));
        let found = scales(&photo, &render);
        let (fine, long) = (found[0], found[3]);
        assert!((fine.wavelength_px - 3.27).abs() < 0.01 && (long.wavelength_px - 26.16).abs() < 0.01);
        // The image's edges, and what a band lets through of the other wave.
        assert!(fine.correlation.abs() < 0.1 && (fine.contrast - 1.0).abs() < 0.05, "{found:?}");
        assert!(long.correlation > 0.99 && (long.contrast - 0.5).abs() < 0.02, "{found:?}");
    }
}
