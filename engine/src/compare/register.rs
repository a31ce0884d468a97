//! Where the photograph's pixels lie on the render: shift, rotation and scale, with their uncertainty.
//!
//! A point `x` of the photograph is the point
//!
//! ```text
//! T(x) = c + (1 + s) R(θ) (x − c) + t,      c the middle of the image
//! ```
//!
//! of the render. On high-passed images Gauss–Newton minimises `Σ [P(x) − g W(T(x)) − o]²` over `t`, `θ`, `s`, the gain
//! `g` and the offset `o`, from the shift of largest correlation among whole pixels within a tenth of the image.
//!
//! Residuals of neighbouring pixels are not independent: terrain that the model lacks covers many. So the covariance is
//! the sandwich over blocks `b` of the image, each counted once (`H` the normal matrix, `J` the Jacobian):
//!
//! ```text
//! C = H⁻¹ (Σ_b g_b g_bᵀ) H⁻¹ · B/(B − 1),     g_b = Σ_{x in b} J(x) r(x)
//! ```
//!
//! # References
//! Baker & Matthews (2004), IJCV 56, 221, doi:10.1023/B:VISI.0000011205.11775.fd; Liang & Zeger (1986), Biometrika 73,
//! 13, doi:10.1093/biomet/73.1.13, for the sandwich.

use glam::DVec2;
use serde::Serialize;

use super::statistics::correlation;
use super::{Error, ScalarImage};
use crate::linear::solve;

/// What may move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Freedom {
    Nothing,
    Shift,
    #[default]
    Similarity,
}

/// From the photograph's pixels to the render's.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Motion {
    /// `t`: columns, rows.
    pub shift_px: [f64; 2],
    /// `θ`, from +x (right) towards +y (down).
    pub rotation_rad: f64,
    /// `s`.
    pub scale: f64,
}

/// A motion, how sure it is, and how alike the high-passed images are under it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Registration {
    pub freedom: Freedom,
    pub motion: Motion,
    /// Standard deviations: shift along columns and rows, rotation, scale.
    pub sigma: Motion,
    pub correlation: f64,
    pub pixels: usize,
    /// Gauss-Newton came to rest on shared ground. Where it did not, the motion is none and the deviations are unknown.
    pub settled: bool,
}

/// Shifts up to this share of the image are looked for.
const SEARCH: f64 = 0.1;
/// The search begins on images of at most so many pixels a side.
const COARSE_PX: usize = 96;
/// Fewer shared pixels register nothing.
const LEAST_PIXELS: usize = 256;
const ROUNDS: usize = 30;
/// Times that both are high-passed over the ground that they share: the second changes a hundredth of the first.
const REFINEMENTS: usize = 2;
/// Motion of the image's corner in one round that ends the iteration.
const SETTLED_PX: f64 = 1e-7;
/// A motion of the image's corner by more than this share of the image has lost its way.
const LOST: f64 = 0.5;
/// Blocks along a side of the image for the covariance.
const BLOCKS: usize = 8;

impl Motion {
    const UNKNOWN: Self = Self { shift_px: [f64::NAN; 2], rotation_rad: f64::NAN, scale: f64::NAN };

    pub fn apply(&self, columns: usize, rows: usize, at: DVec2) -> DVec2 {
        let middle = middle(columns, rows);
        let turned = DVec2::from_angle(self.rotation_rad).rotate(at - middle);
        middle + (1.0 + self.scale) * turned + DVec2::from(self.shift_px)
    }

    /// How far it moves the corner of an image, at most.
    pub fn corner_px(&self, columns: usize, rows: usize) -> f64 {
        let [x, y] = self.shift_px;
        x.hypot(y) + middle(columns, rows).length() * self.rotation_rad.hypot(self.scale)
    }

    /// `self` of what `first` gives.
    fn after(&self, first: &Self) -> Self {
        let turned = DVec2::from_angle(self.rotation_rad).rotate(first.shift_px.into());
        Self {
            shift_px: ((1.0 + self.scale) * turned + DVec2::from(self.shift_px)).to_array(),
            rotation_rad: self.rotation_rad + first.rotation_rad,
            scale: (1.0 + self.scale) * (1.0 + first.scale) - 1.0,
        }
    }
}

fn middle(columns: usize, rows: usize) -> DVec2 {
    (DVec2::new(columns as f64, rows as f64) - 1.0) / 2.0
}

/// The render seen through a motion, on the photograph's pixels.
pub fn warped(render: &ScalarImage, motion: &Motion) -> ScalarImage {
    let (columns, rows) = (render.columns, render.rows);
    let at = |i: usize| DVec2::new((i % columns) as f64, (i / columns) as f64);
    let values = (0..columns * rows).map(|i| render.sample(motion.apply(columns, rows, at(i)))).collect();
    ScalarImage::new(columns, rows, values)
}

/// Registers a photograph and a render by what a Gaussian takes away from both. What lies beyond an image's edge has no
/// part in its mean: both are high-passed anew once they cover the same ground.
pub fn register_detail(
    photo: &ScalarImage,
    render: &ScalarImage,
    high_pass_px: f64,
    freedom: Freedom,
) -> Result<Registration, Error> {
    // An image and itself differ by nothing, whatever part of it counts.
    if photo.pairs(render).all(|(a, b)| a == b) {
        let detail =
            render.zip(photo, |value, photo| if photo.is_nan() { photo } else { value }).high_pass(high_pass_px);
        return register(&detail, &detail, freedom);
    }
    let mut found = register(&photo.high_pass(high_pass_px), &render.high_pass(high_pass_px), freedom)?;
    if freedom == Freedom::Nothing || !found.settled {
        return Ok(found);
    }
    for _ in 0..REFINEMENTS {
        let moved = warped(render, &found.motion);
        let shared = |image: &ScalarImage, other: &ScalarImage| {
            image.zip(other, |value, other| if other.is_nan() { other } else { value }).high_pass(high_pass_px)
        };
        let (photo, moved) = (shared(photo, &moved), shared(&moved, photo));
        let mut fit = Fit { photo: &photo, render: &moved, gradient: gradient(&moved), freedom };
        let Some((motion, sigma)) = fit.settle(Motion::default()) else {
            let correlation = correlation(photo.pairs(render));
            return Ok(Registration {
                motion: Motion::default(),
                sigma: Motion::UNKNOWN,
                correlation,
                settled: false,
                ..found
            });
        };
        found.motion = found.motion.after(&motion);
        found.sigma = sigma;
        found.correlation = correlation(photo.pairs(&warped(&moved, &motion)));
    }
    Ok(found)
}

/// Registers two high-passed images of one size.
pub fn register(photo: &ScalarImage, render: &ScalarImage, freedom: Freedom) -> Result<Registration, Error> {
    let pixels = photo.pairs(render).count();
    if pixels < LEAST_PIXELS {
        return Err(Error::NothingShared { pixels, allowed: LEAST_PIXELS });
    }
    let alike = |motion: Motion| correlation(photo.pairs(&warped(render, &motion)));
    if !alike(Motion::default()).is_finite() {
        return Err(Error::Featureless { pixels });
    }
    let unmoved = |sigma, settled| {
        let motion = Motion::default();
        Registration { freedom, motion, sigma, correlation: alike(motion), pixels, settled }
    };
    let identical = photo.pairs(render).all(|(a, b)| a == b);
    if freedom == Freedom::Nothing || identical {
        return Ok(unmoved(Motion::default(), true));
    }
    let start = whole_pixels(photo, render);
    let [columns, rows] = start.map(|shift| shift as f64);
    let mut fit = Fit { photo, render, gradient: gradient(render), freedom };
    Ok(match fit.settle(Motion { shift_px: [columns, rows], ..Motion::default() }) {
        Some((motion, sigma)) => {
            Registration { freedom, motion, sigma, correlation: alike(motion), pixels, settled: true }
        }
        None => unmoved(Motion::UNKNOWN, false),
    })
}

/// The shift of largest correlation: first among all on coarse images, then about it on finer ones.
fn whole_pixels(photo: &ScalarImage, render: &ScalarImage) -> [i64; 2] {
    let longer = photo.columns.max(photo.rows);
    let mut factor = longer.div_ceil(COARSE_PX);
    let (mut best, mut reach) = ([0, 0], None);
    loop {
        let size = [photo.columns, photo.rows].map(|side| (side / factor).max(4));
        let coarse = [photo, render].map(|image| image.reduced(size[0], size[1]));
        let reach_px = reach.unwrap_or((SEARCH * longer as f64 / factor as f64).ceil() as i64);
        best = best_shift(&coarse[0], &coarse[1], best, reach_px);
        if factor == 1 {
            return best;
        }
        let finer = factor.div_ceil(2);
        best = best.map(|shift| (shift as f64 * factor as f64 / finer as f64).round() as i64);
        (factor, reach) = (finer, Some(2));
    }
}

fn best_shift(photo: &ScalarImage, render: &ScalarImage, about: [i64; 2], reach: i64) -> [i64; 2] {
    use rayon::prelude::*;
    let side = 2 * reach + 1;
    let shift = |index: i64| [about[0] + index % side - reach, about[1] + index / side - reach];
    let alike = |index: i64| {
        let found = correlation(shifted_pairs(photo, render, shift(index)));
        (if found.is_finite() { found } else { -2.0 }, index)
    };
    // Of equals the first: the same whatever the threads.
    let better = |a: (f64, i64), b: (f64, i64)| if b.0 > a.0 || (b.0 == a.0 && b.1 < a.1) { b } else { a };
    let (_, index) = (0..side * side).into_par_iter().map(alike).reduce(|| (f64::NEG_INFINITY, i64::MAX), better);
    shift(index)
}

fn shifted_pairs<'a>(
    photo: &'a ScalarImage,
    render: &'a ScalarImage,
    [dx, dy]: [i64; 2],
) -> impl Iterator<Item = (f64, f64)> + Clone + 'a {
    let inside = |count: usize, shift: i64| {
        let (low, high) = ((-shift).max(0), (count as i64 - shift).min(count as i64));
        low as usize..high.max(low) as usize
    };
    let (columns, rows) = (inside(photo.columns, dx), inside(photo.rows, dy));
    rows.flat_map(move |row| {
        let other_row = (row as i64 + dy) as usize;
        columns.clone().map(move |column| (photo.at(column, row), render.at((column as i64 + dx) as usize, other_row)))
    })
    .filter(|(a, b)| a.is_finite() && b.is_finite())
}

/// Central differences along columns and rows.
fn gradient(image: &ScalarImage) -> [ScalarImage; 2] {
    let (columns, rows) = (image.columns, image.rows);
    let along = |step: [usize; 2]| {
        let value = |i: usize| {
            let (x, y) = (i % columns, i / columns);
            let (x1, y1) = (x + step[0], y + step[1]);
            match (x.checked_sub(step[0]), y.checked_sub(step[1])) {
                (Some(x0), Some(y0)) if x1 < columns && y1 < rows => (image.at(x1, y1) - image.at(x0, y0)) / 2.0,
                _ => f64::NAN,
            }
        };
        ScalarImage::new(columns, rows, (0..columns * rows).map(value).collect())
    };
    [along([1, 0]), along([0, 1])]
}

/// Gain, offset, and up to four motions.
const UNKNOWNS: usize = 6;
type Normal = [[f64; UNKNOWNS]; UNKNOWNS];

struct Fit<'a> {
    photo: &'a ScalarImage,
    render: &'a ScalarImage,
    gradient: [ScalarImage; 2],
    freedom: Freedom,
}

/// Normal equations of one round.
struct Equations {
    normal: Normal,
    right: [f64; UNKNOWNS],
    blocks: Vec<[f64; UNKNOWNS]>,
}

impl Fit<'_> {
    /// Rotation and scale are counted by the way of a point at this distance from the middle.
    fn arm_px(&self) -> f64 {
        middle(self.photo.columns, self.photo.rows).length()
    }

    /// The motion and its deviations; `None` where the images drift apart or leave a motion open.
    fn settle(&mut self, start: Motion) -> Option<(Motion, Motion)> {
        let mut motion = start;
        let mut photometry = self.photometry(&motion);
        for _ in 0..ROUNDS {
            let equations = self.equations(&motion, photometry);
            let step = solve(equations.normal, equations.right)?;
            let (next, moved_px) = self.stepped(&motion, &step);
            motion = next;
            if self.is_lost(&motion) {
                return None;
            }
            photometry = self.photometry(&motion);
            if moved_px < SETTLED_PX {
                break;
            }
        }
        let sigma = self.sigma(&self.equations(&motion, photometry));
        Some((motion, sigma))
    }

    fn is_lost(&self, motion: &Motion) -> bool {
        let corner_px = motion.corner_px(self.photo.columns, self.photo.rows);
        corner_px.is_nan() || corner_px > LOST * self.photo.columns.max(self.photo.rows) as f64
    }

    /// Gain and offset under a motion.
    fn photometry(&self, motion: &Motion) -> [f64; 2] {
        super::statistics::line(self.photo.pairs(&warped(self.render, motion)).map(|(photo, render)| (render, photo)))
    }

    fn equations(&self, motion: &Motion, [gain, offset]: [f64; 2]) -> Equations {
        let (columns, rows) = (self.photo.columns, self.photo.rows);
        let (middle, arm_px) = (middle(columns, rows), self.arm_px());
        let mut equations = Equations {
            normal: [[0.0; UNKNOWNS]; UNKNOWNS],
            right: [0.0; UNKNOWNS],
            blocks: vec![[0.0; UNKNOWNS]; BLOCKS * BLOCKS],
        };
        for row in 0..rows {
            for column in 0..columns {
                let photo = self.photo.at(column, row);
                if photo.is_nan() {
                    continue;
                }
                let at = DVec2::new(column as f64, row as f64);
                let there = motion.apply(columns, rows, at);
                let value = self.render.sample(there);
                let slope = DVec2::new(self.gradient[0].sample(there), self.gradient[1].sample(there));
                if !(value + slope.x + slope.y).is_finite() {
                    continue;
                }
                let turned = DVec2::from_angle(motion.rotation_rad).rotate(at - middle);
                let around = (1.0 + motion.scale) * turned.perp() / arm_px;
                let away = turned / arm_px;
                let motions = match self.freedom {
                    Freedom::Similarity => [slope.x, slope.y, slope.dot(around), slope.dot(away)],
                    _ => [slope.x, slope.y, 0.0, 0.0],
                };
                let [a, b, c, d] = motions.map(|motion| gain * motion);
                let block = (row * BLOCKS / rows) * BLOCKS + column * BLOCKS / columns;
                equations.add(block, [value, 1.0, a, b, c, d], photo - gain * value - offset);
            }
        }
        if self.freedom != Freedom::Similarity {
            equations.normal[4][4] = 1.0;
            equations.normal[5][5] = 1.0;
        }
        equations
    }

    /// The motion after a step, and how far it moves the image's corner.
    fn stepped(&self, motion: &Motion, step: &[f64; UNKNOWNS]) -> (Motion, f64) {
        let arm_px = self.arm_px();
        let [_, _, x, y, turn, away] = *step;
        let next = Motion {
            shift_px: [motion.shift_px[0] + x, motion.shift_px[1] + y],
            rotation_rad: motion.rotation_rad + turn / arm_px,
            scale: motion.scale + away / arm_px,
        };
        (next, x.hypot(y) + turn.hypot(away))
    }

    fn sigma(&self, equations: &Equations) -> Motion {
        let variance = |unknown: usize| {
            // Row `unknown` of H⁻¹ is the solution for a unit right-hand side: H is symmetric.
            let mut unit = [0.0; UNKNOWNS];
            unit[unknown] = 1.0;
            let row = solve(equations.normal, unit).unwrap_or([f64::NAN; UNKNOWNS]);
            let used =
                equations.blocks.iter().filter(|block| block.iter().any(|sum| *sum != 0.0)).count().max(2) as f64;
            let projected = |block: &[f64; UNKNOWNS]| block.iter().zip(&row).map(|(g, h)| g * h).sum::<f64>();
            equations.blocks.iter().map(|block| projected(block).powi(2)).sum::<f64>() * used / (used - 1.0)
        };
        let [x, y, turn, away] = [2, 3, 4, 5].map(|unknown| variance(unknown).sqrt());
        let arm_px = self.arm_px();
        Motion { shift_px: [x, y], rotation_rad: turn / arm_px, scale: away / arm_px }
    }
}

impl Equations {
    fn add(&mut self, block: usize, jacobian: [f64; UNKNOWNS], residual: f64) {
        for (i, a) in jacobian.iter().enumerate() {
            for (j, b) in jacobian.iter().enumerate() {
                self.normal[i][j] += a * b;
            }
            self.right[i] += a * residual;
            self.blocks[block][i] += a * residual;
        }
    }
}
