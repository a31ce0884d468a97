//! FLIP for grey images: the difference that an observer sees who flips between two pictures.
//!
//! Lightness after the eye's contrast sensitivity, and edges and points, `67` pixels to a degree:
//!
//! ```text
//! ΔE_c  lightness difference to the power 0.7, mapped to 0 … 1 (0.4 of the largest becomes 0.95)
//! ΔE_f  [max(|Δ edge|, |Δ point|)/√2]^0.5
//! FLIP = ΔE_c^(1 − ΔE_f)
//! ```
//!
//! # Assumptions
//! Values 0 to 1 are sRGB. Without colour the chromatic filters and the Hunt effect drop out; the largest difference is
//! still that of green and blue.
//!
//! # References
//! Andersson et al. (2020), Proc. ACM CGIT 3, 15, doi:10.1145/3406183.

use super::ScalarImage;

const PIXELS_PER_DEGREE: f64 = 67.0;
/// Contrast sensitivity to luminance: one Gaussian of variance `b / (2 π²)` square degrees.
const SENSITIVITY_B: f64 = 0.0047;
/// Width of the feature detectors, in degrees.
const FEATURE_DEG: f64 = 0.082;
const COLOUR_POWER: f64 = 0.7;
const FEATURE_POWER: f64 = 0.5;
/// Hunt-adjusted HyAB distance of sRGB green and blue.
const LARGEST: f64 = 203.28;
const KNEE_AT: f64 = 0.4;
const KNEE: f64 = 0.95;

/// The mean over pixels that both images have.
pub fn mean(a: &ScalarImage, b: &ScalarImage) -> f64 {
    let [la, lb] = [a, b].map(lightness);
    let [ea, eb] = [a, b].map(|image| features(image, edge));
    let [pa, pb] = [a, b].map(|image| features(image, point));
    let mut sum = [0.0, 0.0];
    for i in 0..a.values.len() {
        let colour = colour_error((la.values[i] - lb.values[i]).abs());
        let feature = (ea.values[i] - eb.values[i]).abs().max((pa.values[i] - pb.values[i]).abs());
        // The larger of two numbers forgets one that is none, and anything to the power 0 is 1.
        if (colour + ea.values[i] + eb.values[i] + pa.values[i] + pb.values[i]).is_finite() {
            let feature = (feature / std::f64::consts::SQRT_2).powf(FEATURE_POWER);
            sum = [sum[0] + colour.powf(1.0 - feature.min(1.0)), sum[1] + 1.0];
        }
    }
    sum[0] / sum[1]
}

fn colour_error(lightness: f64) -> f64 {
    let (largest, error) = (LARGEST.powf(COLOUR_POWER), lightness.powf(COLOUR_POWER));
    let knee = KNEE_AT * largest;
    if error < knee { KNEE * error / knee } else { KNEE + (error - knee) / (largest - knee) * (1.0 - KNEE) }
}

/// sRGB's transfer curve.
fn linear(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// CIE lightness as the eye resolves it.
fn lightness(image: &ScalarImage) -> ScalarImage {
    let sigma_px = (SENSITIVITY_B / 2.0).sqrt() / std::f64::consts::PI * PIXELS_PER_DEGREE;
    let seen = image.map(linear).blurred(sigma_px);
    seen.map(|y| if y > 216.0 / 24389.0 { 116.0 * y.cbrt() - 16.0 } else { 24389.0 / 27.0 * y })
}

/// First derivative of a Gaussian, not normalised.
fn edge(x: f64, _sigma: f64) -> f64 {
    -x
}

/// Second derivative.
fn point(x: f64, sigma: f64) -> f64 {
    (x / sigma).powi(2) - 1.0
}

/// Size of a detector's answers along columns and rows.
fn features(image: &ScalarImage, shape: fn(f64, f64) -> f64) -> ScalarImage {
    let sigma = 0.5 * FEATURE_DEG * PIXELS_PER_DEGREE;
    let reach = (3.0 * sigma).ceil() as i64;
    let bell = |x: i64| (-(x * x) as f64 / (2.0 * sigma * sigma)).exp();
    let taps: Vec<f64> = (-reach..=reach).map(|x| shape(x as f64, sigma) * bell(x)).collect();
    let across: Vec<f64> = (-reach..=reach).map(bell).collect();
    // Positive and negative weights of the two-dimensional filter add up to 1 and −1.
    let sum = |sign: f64| taps.iter().filter(|tap| *tap * sign > 0.0).map(|tap| tap.abs()).sum::<f64>();
    let whole: f64 = across.iter().sum();
    let [positive, negative] = [sum(1.0), sum(-1.0)].map(|sum| sum * whole);
    let taps: Vec<f64> = taps.iter().map(|tap| if *tap > 0.0 { tap / positive } else { tap / negative }).collect();
    let luminance = image.map(linear);
    let [dx, dy] = [(&taps, &across), (&across, &taps)].map(|(x, y)| convolved(&luminance, x, y));
    dx.zip(&dy, f64::hypot)
}

/// Separable; the image goes on beyond its edges as it ends.
fn convolved(image: &ScalarImage, x: &[f64], y: &[f64]) -> ScalarImage {
    let (columns, rows) = (image.columns as i64, image.rows as i64);
    let along = |image: &ScalarImage, taps: &[f64], step: [i64; 2]| {
        let reach = taps.len() as i64 / 2;
        let value = |i: i64| {
            let (column, row) = (i % columns, i / columns);
            let at = |k: i64| {
                let (c, r) = (column + k * step[0], row + k * step[1]);
                image.at(c.clamp(0, columns - 1) as usize, r.clamp(0, rows - 1) as usize)
            };
            taps.iter().zip(-reach..).map(|(tap, k)| tap * at(k)).sum()
        };
        ScalarImage::new(image.columns, image.rows, (0..columns * rows).map(value).collect())
    };
    along(&along(image, x, [1, 0]), y, [0, 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(value: f64) -> ScalarImage {
        ScalarImage::new(24, 24, vec![value; 576])
    }

    /// Black and white differ by 100 in lightness: 0.95 + 0.05 (100^0.7 − 0.4 c)/(0.6 c) with c = 203.28^0.7.
    #[test]
    fn black_and_white_differ_by_0_967() {
        assert!((mean(&flat(0.0), &flat(1.0)) - 0.9669).abs() < 5e-4, "{}", mean(&flat(0.0), &flat(1.0)));
        assert_eq!(mean(&flat(0.3), &flat(0.3)), 0.0);
        // A missing pixel is no difference.
        let mut missing = flat(0.3);
        missing.values[0] = f64::NAN;
        assert_eq!(mean(&missing, &missing), 0.0);
    }

    /// Lab of sRGB green (87.73, −86.18, 83.18) and blue (32.30, 79.19, −107.86), a and b times L/100.
    #[test]
    fn green_and_blue_are_the_farthest_apart() {
        let green = [87.735, -86.183 * 0.87735, 83.180 * 0.87735];
        let blue = [32.303, 79.197 * 0.32303, -107.864 * 0.32303];
        let distance = (green[0] - blue[0]) + f64::hypot(green[1] - blue[1], green[2] - blue[2]);
        assert!((distance - LARGEST).abs() < 0.1, "{distance}");
    }

    #[test]
    fn an_edge_that_moves_is_seen_more_than_its_lightness_alone() {
        let step =
            |at: usize| ScalarImage::new(24, 24, (0..576).map(|i| if i % 24 < at { 0.3 } else { 0.7 }).collect());
        let moved = mean(&step(12), &step(14));
        assert!(moved > 0.02 && moved < mean(&flat(0.3), &flat(0.7)), "{moved}");
    }
}
