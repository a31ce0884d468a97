//! Which physics the photograph wants: the same comparison with one part of the model changed.
//!
//! Every row is rendered, registered from the main row's motion, fitted and compared as the main row was. How it differs
//! is stated as the mean over pixels of `(P − F)² − (P − F_main)²` over the main row's mean square, with its standard
//! error over blocks of the image: what lies within two of those errors the photograph cannot tell apart.

use serde::Serialize;

use super::numbers::Numbers;
use super::photometric::{Model, Response};
use super::register::{Freedom, Registration, register_detail, warped};
use super::render::{RenderSession, Trial};
use super::request::Law;
use super::resolution::Resolution;
use super::{Error, ScalarImage};
use crate::photometry::{LimbDarkening, SolarDisk};
use crate::pipeline::Progress;

/// What all rows share.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'a> {
    pub photo: &'a ScalarImage,
    /// The main row's render, NaN off the elevation models.
    pub radiance: &'a ScalarImage,
    pub resolution: &'a Resolution,
    pub freedom: Freedom,
    pub model: Model,
}

/// One variant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    pub name: String,
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

/// Azimuths that are tried first, all around the sky.
const AROUND_DEG: [f64; 6] = [0.0, -60.0, 60.0, -120.0, 120.0, 180.0];
/// Turns about the best of those, in azimuth and elevation, through which a parabola is laid.
const NEAR_DEG: [f64; 2] = [20.0, 5.0];
/// Turns that still agree. Elevation is told from contrast, which the law of reflection and film change too: on the
/// Apollo frames it comes out 3 degrees too high, azimuth within half a degree.
const AGREES_DEG: [f64; 2] = [10.0, 5.0];

/// The variants, the main one first.
pub fn trials(main: &Trial) -> Result<Vec<Trial>, Error> {
    let uniform = SolarDisk::new(LimbDarkening::Uniform)?;
    let limb_darkened = Trial::of(Law::LunarLambert)?.disk;
    let mut trials = vec![
        Trial { name: format!("{}, as compared", main.name), ..main.clone() },
        Trial { name: "limb-darkened disc".into(), disk: limb_darkened, ..main.clone() },
        Trial { name: "uniform disc".into(), disk: uniform, ..main.clone() },
        Trial { name: "hard shadows".into(), sun_radii: HARD, ..main.clone() },
        Trial { name: "no cast shadows".into(), shadows: false, ..main.clone() },
    ];
    for law in Law::ALL.into_iter().filter(|law| law.name() != main.name) {
        trials.push(Trial { shadows: main.shadows, ..Trial::of(law)? });
    }
    let baseline = Law::LommelSeeliger;
    let name = format!("{}, no cast shadows", baseline.name());
    trials.push(Trial { name, shadows: false, ..Trial::of(baseline)? });
    // What is no change is no variant.
    let main = trials[0].clone();
    let changes = |trial: &Trial| {
        (&trial.disk, trial.shadows, &trial.reflectance) != (&main.disk, main.shadows, &main.reflectance)
            || trial.sun_radii != main.sun_radii
    };
    let mut kept = vec![main.clone()];
    kept.extend(trials.into_iter().skip(1).filter(changes));
    Ok(kept)
}

/// Renders and compares all variants.
pub fn run(
    studio: &mut RenderSession,
    main: &Trial,
    setting: &Setting,
    progress: &dyn Progress,
) -> Result<Vec<Row>, Error> {
    let trials = trials(main)?;
    let count = trials.len();
    progress.begin("ablation", count, "variants");
    let high_pass_px = setting.resolution.high_pass_px;
    let mut main: Option<ScalarImage> = None;
    let mut rows = Vec::new();
    for (index, trial) in trials.into_iter().enumerate() {
        let radiance = setting.radiance(studio, &trial)?;
        let render = warped(&radiance, &setting.registration(&radiance)?.motion);
        let fitted = Response::fit(setting.model, setting.photo, &render).apply(&render);
        let main = main.get_or_insert_with(|| fitted.clone());
        let [photo, high, high_main] = [setting.photo, &fitted, main].map(|image| image.high_pass(high_pass_px));
        rows.push(Row {
            name: trial.name,
            numbers: Numbers::of(setting.photo, &render, &fitted, high_pass_px, 0.0),
            excess: excess(setting.photo, &fitted, main),
            high_pass_excess: excess(&photo, &high, &high_main),
        });
        progress.at(index + 1, count);
    }
    Ok(rows)
}

/// Where the photograph has the Sun: high-pass correlations with Suns turned from the place that was told.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sun {
    /// Azimuth and elevation of the turn in degrees, and the correlation.
    pub tried: Vec<[f64; 3]>,
    /// The vertex of a parabola about the best azimuth, in azimuth and in elevation; absent where it has no maximum.
    pub best_turn_deg: [Option<f64>; 2],
    /// Both vertices lie within 10 and 5 degrees.
    pub agrees: bool,
}

/// Turns the Sun, without cast shadows: shading says enough.
pub fn sun(studio: &mut RenderSession, main: &Trial, setting: &Setting, progress: &dyn Progress) -> Result<Sun, Error> {
    let [azimuth, elevation] = NEAR_DEG;
    let count = AROUND_DEG.len() + 4;
    progress.begin("turning the Sun", count, "directions");
    let mut tried = Vec::new();
    let mut alike = |turn_deg: [f64; 2]| -> Result<f64, Error> {
        let sun_turn_rad = turn_deg.map(f64::to_radians);
        let radiance = setting.radiance(studio, &Trial { shadows: false, sun_turn_rad, ..main.clone() })?;
        let correlation = setting.registration(&radiance)?.correlation;
        tried.push([turn_deg[0], turn_deg[1], correlation]);
        progress.at(tried.len(), count);
        Ok(correlation)
    };
    let mut best = (AROUND_DEG[0], alike([AROUND_DEG[0], 0.0])?);
    for turn in &AROUND_DEG[1..] {
        let correlation = alike([*turn, 0.0])?;
        best = if correlation > best.1 { (*turn, correlation) } else { best };
    }
    let (turn, top) = best;
    let by_azimuth = vertex(alike([turn - azimuth, 0.0])?, top, alike([turn + azimuth, 0.0])?);
    let by_elevation = vertex(alike([turn, -elevation])?, top, alike([turn, elevation])?);
    let best_turn_deg = [by_azimuth.map(|v| turn + azimuth * v), by_elevation.map(|v| elevation * v)];
    let agrees =
        best_turn_deg.iter().zip(AGREES_DEG).all(|(turn, allowed)| turn.is_some_and(|turn| turn.abs() <= allowed));
    Ok(Sun { tried, best_turn_deg, agrees })
}

/// Where a parabola through values at -1, 0 and 1 is highest; `None` where it has no maximum.
fn vertex(below: f64, middle: f64, above: f64) -> Option<f64> {
    let bend = below - 2.0 * middle + above;
    (bend < 0.0).then(|| 0.5 * (below - above) / bend)
}

impl Setting<'_> {
    /// A variant's radiance at the resolution compared, where the main one has ground.
    fn radiance(&self, studio: &mut RenderSession, trial: &Trial) -> Result<ScalarImage, Error> {
        let radiance = self.resolution.seen(studio.radiance(trial)?);
        Ok(radiance.zip(self.radiance, |value, main| if main.is_nan() { main } else { value }))
    }

    fn registration(&self, radiance: &ScalarImage) -> Result<Registration, Error> {
        let high_pass_px = self.resolution.high_pass_px;
        register_detail(self.photo, radiance, high_pass_px, self.freedom)
    }
}

/// Over blocks of the image.
fn excess(photo: &ScalarImage, fitted: &ScalarImage, main: &ScalarImage) -> Excess {
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
        let photo = ScalarImage::new(32, 32, vec![10.0; 1024]);
        let Excess { share, error } = excess(&photo, &photo.map(|v| v + 2.0), &photo.map(|v| v - 1.0));
        assert!((share - 3.0).abs() < 1e-12 && error < 1e-12, "{share} {error}");
    }

    #[test]
    fn each_variant_changes_one_thing() {
        let main = Trial::of(Law::LunarLambert).unwrap();
        let names: Vec<_> = trials(&main).unwrap().into_iter().map(|trial| trial.name).collect();
        let laws = ["Lambert", "Lommel-Seeliger", "Minnaert k = 0.7", "Hapke, Moon"];
        let mut expected = vec!["lunar-Lambert, as compared", "uniform disc", "hard shadows", "no cast shadows"];
        expected.extend(laws);
        expected.push("Lommel-Seeliger, no cast shadows");
        assert_eq!(names, expected);
    }
}
