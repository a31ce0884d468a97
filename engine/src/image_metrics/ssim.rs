//! Structural similarity of grey images.
//!
//! ```text
//! SSIM = mean of (2 μ_a μ_b + c₁)(2 σ_ab + c₂)/((μ_a² + μ_b² + c₁)(σ_a² + σ_b² + c₂))
//! ```
//!
//! in Gaussian windows; `c₁` and `c₂` are (1 % and 3 % of the range)².
//!
//! # References
//! Wang et al. (2004), IEEE Trans. Image Process. 13, 600, doi:10.1109/TIP.2003.819861.

use super::ScalarImage;

/// Standard deviation of the window.
const SSIM_PX: f64 = 1.5;

/// The mean over pixels that both images have; `range` is that of their values.
pub fn mean(a: &ScalarImage, b: &ScalarImage, range: f64) -> f64 {
    let (c1, c2) = ((0.01 * range).powi(2), (0.03 * range).powi(2));
    let blurred = |image: &ScalarImage| image.blurred(SSIM_PX);
    let product = |x: &ScalarImage, y: &ScalarImage| x.zip(y, |x, y| x * y);
    let (ma, mb) = (blurred(a), blurred(b));
    let [aa, bb, ab] = [(a, a), (b, b), (a, b)].map(|(x, y)| blurred(&product(x, y)));
    let at = |i: usize| {
        let (ma, mb) = (ma.values[i], mb.values[i]);
        let (va, vb, cov) = (aa.values[i] - ma * ma, bb.values[i] - mb * mb, ab.values[i] - ma * mb);
        (2.0 * ma * mb + c1) * (2.0 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2))
    };
    let (sum, count) =
        (0..a.values.len()).map(at).filter(|v| v.is_finite()).fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    sum / count
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Flat images have no variance: of 0.2 and 0.4 what is left is (2 · 0.08 + c₁)/(0.04 + 0.16 + c₁), c₁ = 1e-4.
    #[test]
    fn of_two_flat_images_only_the_means_count() {
        let flat = |value: f64| ScalarImage::new(16, 16, vec![value; 256]);
        assert!((mean(&flat(0.2), &flat(0.4), 1.0) - 0.1601 / 0.2001).abs() < 1e-9);
        assert!((mean(&flat(0.3), &flat(0.3), 1.0) - 1.0).abs() < 1e-9);
    }
}
