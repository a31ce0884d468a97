//! What stands between the scene's radiance and the photograph's numbers.
//!
//! ```text
//! nothing   P = R
//! gain      P = g R + o
//! film      P = f(R), f rising: means of P over equal shares of R, made monotone (pool adjacent violators)
//! stray     P = g [R + k (R ∗ G)] + o,   G a Gaussian of an eighth of the image, k ≥ 0
//! ```
//!
//! Each is least squares over the shared pixels. Film and scanner have no scale that is known, so even `gain` says
//! nothing about absolute radiance.
//!
//! # References
//! Barlow et al. (1972), *Statistical Inference under Order Restrictions*, for pooling.

use serde::Serialize;

use super::ScalarImage;
use super::statistics::line;
use crate::linear::solve;

/// What is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Model {
    Nothing,
    #[default]
    Gain,
    Film,
    Stray,
}

/// What was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "model", rename_all = "snake_case")]
pub enum Response {
    Nothing,
    /// The photograph's numbers per radiance, and at none.
    Gain {
        gain: f64,
        offset: f64,
    },
    /// Radiances and the photograph's numbers there, both rising; straight between, level beyond.
    Film {
        knots: Vec<[f64; 2]>,
    },
    /// `share`: scattered light over direct light, `k`.
    Stray {
        gain: f64,
        offset: f64,
        share: f64,
    },
}

impl Model {
    pub const ALL: [Self; 4] = [Self::Nothing, Self::Gain, Self::Film, Self::Stray];

    pub fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Gain => "gain and offset",
            Self::Film => "film curve",
            Self::Stray => "gain, offset and stray light",
        }
    }
}

/// Shares of the pixels that make a knot of the film curve.
const KNOTS: usize = 32;

/// Width of stray light, over the longer side of the image.
const STRAY: f64 = 1.0 / 8.0;

impl Response {
    /// Fits a render, on the photograph's pixels, to the photograph.
    pub fn fit(model: Model, photo: &ScalarImage, render: &ScalarImage) -> Self {
        match model {
            Model::Nothing => Self::Nothing,
            Model::Gain => {
                let [gain, offset] = line(render.pairs(photo));
                Self::Gain { gain, offset }
            }
            Model::Film => Self::Film { knots: film(render.pairs(photo).collect()) },
            Model::Stray => stray(photo, render),
        }
    }

    /// The render as the photograph would show it.
    pub fn apply(&self, render: &ScalarImage) -> ScalarImage {
        match self {
            Self::Nothing => render.clone(),
            Self::Gain { gain, offset } => render.map(|value| gain * value + offset),
            Self::Film { knots } => render.map(|value| along(knots, value)),
            Self::Stray { gain, offset, share } => {
                render.zip(&scattered(render), |direct, glow| gain * (direct + share * glow) + offset)
            }
        }
    }
}

fn scattered(render: &ScalarImage) -> ScalarImage {
    render.blurred(STRAY * render.columns.max(render.rows) as f64)
}

fn stray(photo: &ScalarImage, render: &ScalarImage) -> Response {
    let glow = scattered(render);
    let (mut normal, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
    for ((&direct, &glow), &photo) in render.values.iter().zip(&glow.values).zip(&photo.values) {
        if !(direct + glow + photo).is_finite() {
            continue;
        }
        let row = [direct, glow, 1.0];
        for i in 0..3 {
            (0..3).for_each(|j| normal[i][j] += row[i] * row[j]);
            right[i] += row[i] * photo;
        }
    }
    match solve(normal, right) {
        Some([gain, glow, offset]) if gain > 0.0 && glow > 0.0 => Response::Stray { gain, offset, share: glow / gain },
        // Light is not taken away: without stray light the line is the best.
        _ => {
            let [gain, offset] = line(render.pairs(photo));
            Response::Stray { gain, offset, share: 0.0 }
        }
    }
}

/// Means of pairs over equal shares, pooled until the second rises with the first.
fn film(mut pairs: Vec<(f64, f64)>) -> Vec<[f64; 2]> {
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut pools: Vec<[f64; 3]> = Vec::new();
    for chunk in pairs.chunks(pairs.len().div_ceil(KNOTS).max(1)) {
        let count = chunk.len() as f64;
        let sum = chunk.iter().fold([0.0; 2], |sum, pair| [sum[0] + pair.0, sum[1] + pair.1]);
        let mut pool = [sum[0] / count, sum[1] / count, count];
        while let Some(&[x, y, weight]) = pools.last().filter(|last| last[1] >= pool[1] || last[0] >= pool[0]) {
            let whole = weight + pool[2];
            pool = [(x * weight + pool[0] * pool[2]) / whole, (y * weight + pool[1] * pool[2]) / whole, whole];
            pools.pop();
        }
        pools.push(pool);
    }
    pools.into_iter().map(|[x, y, _]| [x, y]).collect()
}

/// Straight between knots, level beyond them.
fn along(knots: &[[f64; 2]], at: f64) -> f64 {
    if at.is_nan() || knots.is_empty() {
        return f64::NAN;
    }
    let after = knots.partition_point(|knot| knot[0] < at);
    match (after.checked_sub(1).map(|before| knots[before]), knots.get(after)) {
        (None, Some(first)) => first[1],
        (Some(last), None) => last[1],
        (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (at - x0) / (x1 - x0),
        (None, None) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> ScalarImage {
        let value = |i: usize| 5.0 + 4.0 * ((i % 40) as f64 * 0.31).sin() * ((i / 40) as f64 * 0.23).cos();
        ScalarImage::new(40, 40, (0..1600).map(value).collect())
    }

    #[test]
    fn gain_and_offset_are_found() {
        let photo = scene().map(|radiance| 12.0 * radiance + 7.0);
        let Response::Gain { gain, offset } = Response::fit(Model::Gain, &photo, &scene()) else { panic!() };
        assert!((gain - 12.0).abs() < 1e-9 && (offset - 7.0).abs() < 1e-9, "{gain} {offset}");
    }

    /// Logarithmic film: between 32 knots a parabola's sagitta, (range/32)²/8 of its curvature 1, is 8e-3 at most.
    #[test]
    fn a_film_curve_is_found_and_rises() {
        let photo = scene().map(f64::ln);
        let response = Response::fit(Model::Film, &photo, &scene());
        let Response::Film { knots } = &response else { panic!() };
        assert!(knots.windows(2).all(|pair| pair[0][0] < pair[1][0] && pair[0][1] < pair[1][1]));
        let worst = response.apply(&scene()).pairs(&photo).map(|(a, b)| (a - b).abs()).sum::<f64>() / 1600.0;
        assert!(worst < 0.02, "{worst}");
        let falling = Response::fit(Model::Film, &scene().map(|radiance| -radiance), &scene());
        assert!(matches!(falling, Response::Film { knots } if knots.len() == 1), "a rising curve cannot fall");
    }

    #[test]
    fn stray_light_is_found_and_never_negative() {
        let glow = scattered(&scene());
        let photo = scene().zip(&glow, |direct, glow| 3.0 * (direct + 0.2 * glow) + 1.0);
        let Response::Stray { gain, share, .. } = Response::fit(Model::Stray, &photo, &scene()) else { panic!() };
        assert!((gain - 3.0).abs() < 1e-6 && (share - 0.2).abs() < 1e-6, "{gain} {share}");
        let photo = scene().zip(&glow, |direct, glow| 3.0 * (direct - 0.2 * glow));
        assert!(matches!(Response::fit(Model::Stray, &photo, &scene()), Response::Stray { share: 0.0, .. }));
    }
}
