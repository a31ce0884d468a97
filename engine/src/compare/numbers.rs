//! How alike two registered images are.
//!
//! With `P` the photograph and `F` the render as the photograph would show it:
//!
//! ```text
//! correlation        of P and R, and of both less their Gaussian mean
//! normalised RMS     √⟨(P − F)²⟩ / (q₉₉.₅ − q₀.₅ of P)
//! SSIM               mean of (2 μ_P μ_F + c₁)(2 σ_PF + c₂)/((μ_P² + μ_F² + c₁)(σ_P² + σ_F² + c₂)), Gaussian of 1.5 px
//! Jung 2020          e = R/max R − (P/max P − dark),  σ(e) and the share |e − ⟨e⟩| ≤ 3σ
//! ```
//!
//! Jung's protocol divides each image by its own maximum and hides errors of gain; it is here so that its figures
//! (σ ≈ 0.040, 97 %) can be stood beside.
//!
//! # References
//! Wang et al. (2004), IEEE Trans. Image Process. 13, 600, doi:10.1109/TIP.2003.819861, for SSIM; Jung, Schrempp & Son
//! (2020), section 6.1.

use serde::Serialize;

use super::statistics::{correlation, spread};
use super::{ScalarImage, flip};
use crate::image_metrics::ssim;
use crate::statistics::quantile;

/// Of a photograph and a registered render.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Numbers {
    pub pixels: usize,
    pub correlation: f64,
    pub high_pass_correlation: f64,
    /// Of the fitted render.
    pub rms: f64,
    pub normalised_rms: f64,
    pub residual_sigma: f64,
    pub within_3_sigma: f64,
    pub ssim: f64,
    pub flip: f64,
    pub jung: Jung,
}

/// Images divided by their maxima.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Jung {
    pub dark: f64,
    pub sigma: f64,
    pub within_3_sigma: f64,
}

impl Numbers {
    /// `render` in radiance, `fitted` in the photograph's numbers, both on its pixels.
    pub fn of(photo: &ScalarImage, render: &ScalarImage, fitted: &ScalarImage, high_pass_px: f64, dark: f64) -> Self {
        // Only what all share, so that every number is about the same pixels.
        let photo = photo.zip(fitted, |photo, fitted| if fitted.is_nan() { f64::NAN } else { photo });
        let render = render.zip(&photo, |render, photo| if photo.is_nan() { f64::NAN } else { render });
        let fitted = fitted.zip(&photo, |fitted, photo| if photo.is_nan() { f64::NAN } else { fitted });
        let residuals = || photo.pairs(&fitted).map(|(photo, fitted)| photo - fitted);
        let pixels = residuals().count();
        let rms = (residuals().map(|residual| residual * residual).sum::<f64>() / pixels as f64).sqrt();
        let range = range(&photo);
        let (residual_sigma, within_3_sigma) = within(residuals());
        Self {
            pixels,
            correlation: correlation(photo.pairs(&render)),
            high_pass_correlation: high_passed(&photo, &fitted, high_pass_px),
            rms,
            normalised_rms: rms / (range[1] - range[0]),
            residual_sigma,
            within_3_sigma,
            ssim: ssim::mean(&photo, &fitted, range[1] - range[0]),
            flip: flip::mean(&shown(&photo, range), &shown(&fitted, range)),
            jung: jung(&photo, &render, dark),
        }
    }
}

/// From the 0.5 % to the 99.5 % quantile.
pub fn range(image: &ScalarImage) -> [f64; 2] {
    let known = || image.values.iter().copied().filter(|value| value.is_finite()).collect::<Vec<_>>();
    [quantile(known(), 0.005), quantile(known(), 0.995)]
}

/// 0 to 1 over a range.
pub fn shown(image: &ScalarImage, [low, high]: [f64; 2]) -> ScalarImage {
    image.map(|value| ((value - low) / (high - low)).clamp(0.0, 1.0))
}

/// Correlation of what a Gaussian takes away from both, where both are known.
pub fn high_passed(a: &ScalarImage, b: &ScalarImage, sigma_px: f64) -> f64 {
    let known =
        |x: &ScalarImage, y: &ScalarImage| x.zip(y, |x, y| if y.is_nan() { f64::NAN } else { x }).high_pass(sigma_px);
    correlation(known(a, b).pairs(&known(b, a)))
}

/// Standard deviation, and the share within three of it.
fn within(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let (sigma, mean) = spread(values.clone());
    let (count, inside) =
        values.fold((0.0, 0.0), |(n, k), v| (n + 1.0, k + f64::from(u8::from((v - mean).abs() <= 3.0 * sigma))));
    (sigma, inside / count)
}

fn jung(photo: &ScalarImage, render: &ScalarImage, dark: f64) -> Jung {
    let largest = |image: &ScalarImage| image.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (photo_max, render_max) = (largest(photo), largest(render));
    let errors = photo.pairs(render).map(|(photo, render)| render / render_max - (photo / photo_max - dark).max(0.0));
    let (sigma, within_3_sigma) = within(errors);
    Jung { dark, sigma, within_3_sigma }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image() -> ScalarImage {
        let value = |i: usize| 100.0 + 60.0 * ((i % 48) as f64 * 0.4).sin() + 20.0 * ((i / 48) as f64 * 0.7).cos();
        ScalarImage::new(48, 48, (0..48 * 48).map(value).collect())
    }

    #[test]
    fn an_image_and_itself_differ_by_nothing() {
        let numbers = Numbers::of(&image(), &image(), &image(), 6.0, 0.0);
        assert_eq!((numbers.rms, numbers.residual_sigma, numbers.jung.sigma, numbers.flip), (0.0, 0.0, 0.0, 0.0));
        assert!((numbers.correlation - 1.0).abs() < 1e-12 && (numbers.ssim - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_constant_error_is_its_rms_and_has_no_sigma() {
        let brighter = image().map(|value| value + 5.0);
        let numbers = Numbers::of(&image(), &image(), &brighter, 6.0, 0.0);
        assert!((numbers.rms - 5.0).abs() < 1e-12 && numbers.residual_sigma < 1e-12);
        assert!(numbers.ssim < 1.0 && numbers.flip > 0.0);
    }

    /// 2σ, mean 0: values ±1 lie within 3σ = 3; one value of 10 among 99 zeros lies outside 3σ = 3 · 0.995.
    #[test]
    fn the_share_within_three_sigma_counts_outliers() {
        let outlier = (0..100).map(|i| if i == 7 { 10.0 } else { 0.0 });
        let (sigma, share) = within(outlier);
        assert!((sigma - 0.99f64.sqrt()).abs() < 1e-12 && (share - 0.99).abs() < 1e-12);
    }

    /// Twice the brightness changes nothing once each image is divided by its maximum; a dark level does.
    #[test]
    fn jungs_protocol_hides_gain_and_takes_the_dark_level_away() {
        let twice = image().map(|value| 2.0 * value);
        assert!(jung(&image(), &twice, 0.0).sigma < 1e-12);
        // Photograph (R + 20)/(max + 20) against R/max; with 20/(max + 20) taken away only the gain's rest remains.
        let photo = image().map(|value| value + 20.0);
        let dark = 20.0 / 199.0;
        assert!(jung(&photo, &image(), dark).sigma < jung(&photo, &image(), 0.0).sigma + 1e-12);
    }
}
