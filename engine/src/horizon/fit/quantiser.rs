//! The best uniform quantiser of each number of bits.

use crate::horizon::wide::wide;

/// Most bits of a field.
pub const MAX_WIDTH: usize = 9;
/// Steps tried: so many, over so many octaves up from the smallest, which is this fraction of the deviation over the number of
/// codes.
const STEPS: usize = 18;
const SMALLEST_STEP: f32 = 1.2;
const OCTAVES: f32 = 5.4;
/// Where the mean may lie, in steps from the middle of the codes, an even number: between two of them, or on one. Most
/// residuals of ground with a few rims or needles are about 0, and few bits should be able to say so.
const SHIFTS: [f32; 3] = [0.0, 0.5, -0.5];

/// How a coefficient is quantised with some number of bits, `offset + gain · step · (code + bias)`, and the mean square error
/// then.
#[derive(Debug, Clone, Copy)]
pub struct Quantiser {
    pub step_rad: f32,
    pub offset_rad: f32,
    pub bias: f32,
    pub error_rad2: f64,
}

/// The best of each width from 0 on for values in texels of some gains.
pub fn quantisers(values_rad: &[f32], gains: &[f32]) -> [Quantiser; MAX_WIDTH + 1] {
    let count = values_rad.len() as f64;
    let square = |value: f32| f64::from(value) * f64::from(value);
    let offset_rad = (values_rad.iter().map(|value| f64::from(*value)).sum::<f64>() / count) as f32;
    let variance = values_rad.iter().map(|value| square(value - offset_rad)).sum::<f64>() / count;
    // What codes stand for before the gain, and what its error counts.
    let (shapes_rad, weights): (Vec<f32>, Vec<f32>) =
        values_rad.iter().zip(gains).map(|(value, gain)| ((value - offset_rad) / gain, gain * gain)).unzip();
    let total: f64 = weights.iter().map(|weight| f64::from(*weight)).sum();
    let nothing = Quantiser { step_rad: 0.0, offset_rad: 0.0, bias: 0.0, error_rad2: variance + square(offset_rad) };
    let smallest_rad = SMALLEST_STEP * (variance * count / total).sqrt() as f32;
    std::array::from_fn(|width| {
        if width == 0 {
            return nothing;
        }
        if variance == 0.0 {
            return Quantiser { step_rad: 1.0, offset_rad, bias: 0.0, error_rad2: 0.0 };
        }
        let codes = (1 << width) as f32;
        let trial = |step: usize, shift: f32| {
            let step_rad = smallest_rad * (OCTAVES * step as f32 / STEPS as f32).exp2() / codes;
            let bias = shift + 0.5;
            let error_rad2 = wide(
                #[inline(always)]
                || square_error(&shapes_rad, &weights, [step_rad, bias, codes]),
            );
            Quantiser { step_rad, offset_rad, bias, error_rad2: error_rad2 / count }
        };
        let all = (0..STEPS).flat_map(|step| SHIFTS.map(|shift| trial(step, shift)));
        let best = all.min_by(|a, b| a.error_rad2.total_cmp(&b.error_rad2));
        best.expect("steps are tried")
    })
}

/// Sum of the weighted squares of what a quantiser leaves, in so many sums side by side.
#[inline(always)]
fn square_error(shapes_rad: &[f32], weights: &[f32], [step_rad, bias, codes]: [f32; 3]) -> f64 {
    const LANES: usize = 16;
    let per_rad = 1.0 / step_rad;
    let error = |(shape_rad, weight): (&f32, &f32)| {
        let error_rad = error_rad(*shape_rad, [step_rad, per_rad, bias, codes]);
        weight * error_rad * error_rad
    };
    let mut sums = [0.0_f32; LANES];
    let ((shapes, rest), (weights, rest_weights)) = (shapes_rad.as_chunks::<LANES>(), weights.as_chunks::<LANES>());
    for (shapes, weights) in shapes.iter().zip(weights) {
        for (sum, of) in sums.iter_mut().zip(shapes.iter().zip(weights)) {
            *sum += error(of);
        }
    }
    sums.into_iter().chain(rest.iter().zip(rest_weights).map(error)).map(f64::from).sum()
}

/// What the nearest code leaves of a value less the offset, for a step, one over it, a bias and a number of codes.
#[inline(always)]
pub fn error_rad(shape_rad: f32, [step_rad, per_rad, bias, codes]: [f32; 4]) -> f32 {
    step_rad * (nearest(shape_rad * per_rad - bias, codes) + bias) - shape_rad
}

/// The nearest of so many codes, an even number, about 0.
#[inline(always)]
fn nearest(code: f32, codes: f32) -> f32 {
    /// Rounded by adding what leaves no bits for a fraction, counted from the lowest code: vectors have no cheaper `floor`.
    const NO_FRACTION: f32 = 8_388_608.0;
    let half = 0.5 * codes;
    (code + half).max(0.0).min(codes - 1.0) + NO_FRACTION - NO_FRACTION - half
}
