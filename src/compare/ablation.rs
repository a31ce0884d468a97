//! Which physics the photograph wants: the same comparison with one part of the model changed.
//!
//! Every row is rendered, registered from the main row's motion, fitted and compared as the main row was. How it differs
//! is stated as the mean over pixels of `(P − F)² − (P − F_main)²` over the main row's mean square, with its standard
//! error over blocks of the image: what lies within two of those errors the photograph cannot tell apart.

use serde::Serialize;

use super::numbers::Numbers;
use super::photometric::{Model, Response};
use super::register::{Freedom, Registration, register, warped};
use super::render::{Studio, Trial};
use super::study::Law;
use super::{Error, Grid};
use crate::photometry::{LimbDarkening, SolarDisk};
use crate::pipeline::Progress;

/// What all rows share.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'a> {
    pub photo: &'a Grid,
    /// The main row's render, NaN off the elevation models.
    pub radiance: &'a Grid,
    pub registration: &'a Registration,
    pub high_pass_px: f64,
    pub model: Model,
}

/// One variant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    pub name: String,
    pub shift_px: [f64; 2],
    pub numbers: Numbers,
    pub excess: Excess,
    /// Of high-passed images.
    pub high_pass_excess: Excess,
}

/// Mean square residual over the main row's, less 1, and its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Excess {
    pub share: f64,
    pub error: f64,
}

/// The Sun's radius of "hard" shadows, over the true one.
const HARD: f64 = 0.01;
/// Blocks along a side of the image.
const BLOCKS: usize = 8;

/// The variants, the main one first.
pub fn trials(law: Law) -> Result<Vec<Trial>, Error> {
    let main = Trial::of(law)?;
    let uniform = SolarDisk::new(LimbDarkening::Uniform)?;
    let mut trials = vec![
        Trial { name: format!("{}: soft shadows, limb-darkened disc", law.name()), ..main.clone() },
        Trial { name: "uniform disc".into(), disk: uniform, ..main.clone() },
        Trial { name: "hard shadows".into(), sun_radii: HARD, ..main.clone() },
        Trial { name: "no cast shadows".into(), shadows: false, ..main },
    ];
    for other in Law::ALL.into_iter().filter(|other| *other != law) {
        trials.push(Trial::of(other)?);
    }
    let baseline = Law::LommelSeeliger;
    if law != baseline {
        trials.push(Trial { name: format!("{}, no cast shadows", baseline.name()), shadows: false, ..Trial::of(baseline)? });
    }
    Ok(trials)
}

/// Renders and compares all variants.
pub fn run(studio: &mut Studio, law: Law, setting: &Setting, progress: &dyn Progress) -> Result<Vec<Row>, Error> {
    let trials = trials(law)?;
    progress.begin("ablation", trials.len(), "variants");
    let mut main: Option<Grid> = None;
    let mut rows = Vec::new();
    for (index, trial) in trials.into_iter().enumerate() {
        let radiance = studio.radiance(&trial)?.zip(setting.radiance, |value, main| if main.is_nan() { main } else { value });
        let (fitted, mut row) = row(trial.name, &radiance, setting)?;
        let main = main.get_or_insert_with(|| fitted.clone());
        row.excess = excess(setting.photo, &fitted, main);
        let [photo, fitted, main] = [setting.photo, &fitted, main].map(|image| image.high_pass(setting.high_pass_px));
        row.high_pass_excess = excess(&photo, &fitted, &main);
        rows.push(row);
        progress.at(index + 1, 0);
    }
    Ok(rows)
}

fn row(name: String, radiance: &Grid, setting: &Setting) -> Result<(Grid, Row), Error> {
    let Setting { photo, registration, high_pass_px, model, .. } = *setting;
    let found = match registration.freedom {
        Freedom::Nothing => registration.clone(),
        freedom => register(&photo.high_pass(high_pass_px), &radiance.high_pass(high_pass_px), freedom)?,
    };
    let render = warped(radiance, &found.motion);
    let fitted = Response::fit(model, photo, &render).apply(&render);
    let numbers = Numbers::of(photo, &render, &fitted, high_pass_px, 0.0);
    let shift_px = found.motion.shift_px;
    let same = Excess::default();
    Ok((fitted, Row { name, shift_px, numbers, excess: same, high_pass_excess: same }))
}

/// Over blocks of the image.
fn excess(photo: &Grid, fitted: &Grid, main: &Grid) -> Excess {
    let mut blocks = [[0.0_f64; 2]; BLOCKS * BLOCKS];
    for (i, ((p, f), m)) in photo.values.iter().zip(&fitted.values).zip(&main.values).enumerate() {
        if (p + f + m).is_finite() {
            let (column, row) = (i % photo.columns, i / photo.columns);
            let block = &mut blocks[row * BLOCKS / photo.rows * BLOCKS + column * BLOCKS / photo.columns];
            block[0] += (p - f).powi(2) - (p - m).powi(2);
            block[1] += (p - m).powi(2);
        }
    }
    let all = blocks.iter().fold([0.0; 2], |sum, block| [sum[0] + block[0], sum[1] + block[1]]);
    if all[1] == 0.0 {
        return Excess::default();
    }
    let share = all[0] / all[1];
    let used = blocks.iter().filter(|block| block[1] > 0.0).count() as f64;
    // The ratio's error by linearisation: blocks scatter about the common share.
    let scatter: f64 = blocks.iter().map(|[difference, main]| (difference - share * main).powi(2)).sum();
    Excess { share, error: (scatter * used / (used - 1.0).max(1.0)).sqrt() / all[1] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Residuals of 2 against 1 everywhere: three times more square, in every block alike.
    #[test]
    fn twice_the_residual_is_three_times_the_square_more() {
        let photo = Grid::new(32, 32, vec![10.0; 1024]);
        let Excess { share, error } = excess(&photo, &photo.map(|v| v + 2.0), &photo.map(|v| v - 1.0));
        assert!((share - 3.0).abs() < 1e-12 && error < 1e-12, "{share} {error}");
    }

    #[test]
    fn each_variant_changes_one_thing() {
        let names: Vec<_> = trials(Law::LunarLambert).unwrap().into_iter().map(|trial| trial.name).collect();
        assert_eq!(names.len(), 9);
        assert!(names[0].contains("limb-darkened") && names.last().unwrap().contains("no cast shadows"));
    }
}
