//! One image: poses over its exposure, light, exposure time, detector.

use std::time::Duration;

use super::{Error, Exposure, Prepared};
use crate::camera::{Detector, Pose};
use crate::render::{Image, Imaging, Renderer, Samples, Scene, Taken, Timing, planes};
use crate::scenario::{AutoExposure, Scenario};

/// An image and how it came about.
#[derive(Debug)]
pub struct Shot {
    pub image: Image,
    /// Of the middle of the exposure, where all rows share it.
    pub samples: Option<Samples>,
    /// The scenario's, or the one that was chosen.
    pub exposure_s: f64,
    /// Times from the epoch and poses of the image's bands, where there are several.
    pub bands: Vec<(f64, Pose)>,
    /// Rows of the image at which they begin.
    pub first_rows: Vec<usize>,
    pub psf_cut_off: f64,
    /// With the exposure.
    pub detector: Option<Detector>,
    /// What the device spent, where it can tell.
    pub device: Duration,
}

/// Takes an exposure of the scenario.
pub fn take(
    scenario: &Scenario,
    prepared: &Prepared,
    scene: &Scene,
    imaging: &Imaging,
    renderer: &mut dyn Renderer,
    exposure: &Exposure,
) -> Result<Shot, Error> {
    let auto = scenario.camera.auto_exposure;
    let exposure_s = scenario.camera.exposure_s;
    if imaging.is_plain() && auto.is_none() {
        let samples = renderer.samples(scene, &exposure.view)?;
        let image = planes::image(scene, &exposure.view, &samples);
        let device = renderer.device_time().unwrap_or_default();
        let (samples, detector) = (Some(samples), scene.detector.clone());
        let (bands, first_rows, psf_cut_off) = (Vec::new(), Vec::new(), 0.0);
        return Ok(Shot { image, samples, exposure_s, bands, first_rows, psf_cut_off, detector, device });
    }
    let mut device = Duration::ZERO;
    let mut light = |imaging: &Imaging, exposure_s: f64| -> Result<(Taken, Vec<Vec<Pose>>), Error> {
        let times_s = imaging.timing.times_s(exposure_s);
        let poses = prepared.motion.poses(&prepared.almanac, &prepared.frame, exposure.epoch, &times_s)?;
        let taken = imaging.take(renderer, scene, &exposure.view, &poses)?;
        device += taken.device;
        Ok((taken, poses))
    };
    let metered = auto.zip(scene.detector.as_ref());
    let still = Imaging { timing: Timing { moments: 1, ..imaging.timing }, ..imaging.clone() };
    let (taken, poses, exposure_s) = match metered {
        None => {
            let (taken, poses) = light(imaging, exposure_s)?;
            (taken, poses, exposure_s)
        }
        Some((auto, detector)) => {
            // Light without motion blur tells the time; blur then lasts as long as that.
            let (taken, poses) = light(&still, exposure_s)?;
            let chosen_s = chosen_s(&auto, detector, taken.focal_plane_irradiance());
            if imaging.timing.moments == 1 {
                (taken, poses, chosen_s)
            } else {
                let (taken, poses) = light(imaging, chosen_s)?;
                (taken, poses, chosen_s)
            }
        }
    };
    let detector = scene.detector.as_ref().map(|detector| Detector { exposure_s, ..detector.clone() });
    let image = taken.image(scene, detector.as_ref());
    let (first_rows, bands) = bands(&imaging.timing, &poses).into_iter().unzip();
    let psf_cut_off = imaging.psf.as_ref().map_or(0.0, |psf| psf.cut_off);
    let samples = taken.into_samples();
    Ok(Shot { image, samples, exposure_s, bands, first_rows, psf_cut_off, detector, device })
}

/// First rows, times and poses in the middle of the bands' exposures; none where there is but one band.
fn bands(timing: &Timing, poses: &[Vec<Pose>]) -> Vec<(usize, (f64, Pose))> {
    let mut first_row = 0;
    let bands = timing.shutter.pieces(timing.rows).into_iter().flatten().zip(poses).map(|(band, moments)| {
        let first = first_row;
        first_row += band.rows as usize;
        (first, (band.time_s, moments[moments.len() / 2]))
    });
    if poses.len() > 1 { bands.collect() } else { Vec::new() }
}

/// The exposure after which the quantile of the lit pixels holds the level's electrons, dark current included.
///
/// ```text
/// t = level · capacity / (electrons of light a second + dark current),   capacity = min(full well, (2^bits − 1 − offset)/K)
/// ```
fn chosen_s(auto: &AutoExposure, detector: &Detector, irradiance_w_m2: Vec<f32>) -> f64 {
    let mut lit: Vec<f32> = irradiance_w_m2.into_iter().filter(|light| *light > 0.0).collect();
    if lit.is_empty() {
        return auto.longest_s;
    }
    let rank = (auto.quantile * (lit.len() - 1) as f64).round() as usize;
    let light = *lit.select_nth_unstable_by(rank, f32::total_cmp).1;
    let second = Detector { exposure_s: 1.0, ..detector.clone() };
    let rate_e_s = detector.quantum_efficiency * second.photons(f64::from(light)) + detector.dark_current_e_s;
    (auto.level * detector.capacity_e() / rate_e_s).clamp(auto.shortest_s, auto.longest_s)
}
