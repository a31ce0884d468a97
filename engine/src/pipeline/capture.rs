//! One image: poses over its exposure, light, exposure time, detector.

use super::{Error, Exposure, Prepared};
use crate::camera::{Detector, Pose};
use crate::labels;
use crate::render::{Capture, Image, Imaging, Scene, Session, Timing, View};
use crate::scenario::{AutoExposure, Scenario};
use crate::shadow::Skylines;

/// An image's light, and how it came about.
#[derive(Debug)]
pub struct CapturedExposure {
    pub light: Capture,
    /// The scenario's, or the one that was chosen.
    pub exposure_s: f64,
    /// Times from the epoch and poses of the image's bands, where there are several.
    pub bands: Vec<(f64, Pose)>,
    /// Rows of the image at which they begin.
    pub first_rows: Vec<usize>,
    /// Of the lens's spreads.
    pub psf_cut_off: f64,
    /// With the exposure.
    pub detector: Option<Detector>,
    /// That the image was rendered with, where labels ask about light and they are found in advance.
    pub skylines: Skylines,
}

impl CapturedExposure {
    /// What the detector makes of it.
    pub fn image(&self, scene: &Scene) -> Image {
        self.light.image(scene, self.detector.as_ref())
    }
}

/// Takes an exposure.
pub fn take(
    prepared: &Prepared,
    imaging: &Imaging,
    session: &mut Session,
    exposure: &Exposure,
) -> Result<CapturedExposure, Error> {
    let Prepared { almanac, frame, points, motions, .. } = prepared;
    let (scenario, motion) = (&points[exposure.point], &motions[exposure.point]);
    let detector = exposure.view.detector.clone();
    let mut captured = |timing: Timing, exposure_s: f64| -> Result<(Capture, Vec<Vec<Pose>>), Error> {
        let imaging = Imaging { timing, ..imaging.clone() };
        let times_s = timing.times_s(exposure_s);
        let poses = motion.poses(almanac, frame, exposure.epoch, &times_s)?;
        let of_band = |(times_s, poses): (&Vec<f64>, &Vec<Pose>)| {
            times_s.iter().zip(poses).map(|(time_s, pose)| exposure.view_at(*time_s, pose)).collect()
        };
        let views = times_s.iter().zip(&poses).map(of_band).collect();
        Ok((imaging.take(session, views)?, poses))
    };
    let (timing, written_s) = (imaging.timing, scenario.camera.exposure_s);
    let (light, poses, exposure_s) = match scenario.camera.auto_exposure.zip(detector.as_ref()) {
        None => {
            let (light, poses) = captured(timing, written_s)?;
            (light, poses, written_s)
        }
        Some((auto, detector)) => {
            // Light without motion blur tells the time; blur then lasts as long as that.
            let (still, poses) = captured(Timing { moments: 1, ..timing }, written_s)?;
            let chosen_s = chosen_s(&auto, detector, still.focal_plane_irradiance());
            if timing.moments == 1 {
                (still, poses, chosen_s)
            } else {
                let device = still.device;
                let (mut light, poses) = captured(timing, chosen_s)?;
                light.device += device;
                (light, poses, chosen_s)
            }
        }
    };
    let (first_rows, bands) = bands(&timing, &poses).into_iter().unzip();
    let psf_cut_off = imaging.psf.as_ref().map_or(0.0, |psf| psf.cut_off);
    let detector = detector.map(|detector| Detector { exposure_s, ..detector });
    let needs_light = needs_light(scenario, &exposure.view);
    let skylines = if needs_light { session.skylines()? } else { Skylines::default() };
    Ok(CapturedExposure { light, exposure_s, bands, first_rows, psf_cut_off, detector, skylines })
}

/// Whether labels of a scenario's exposures ask which ground the Sun lights.
pub fn needs_light(scenario: &Scenario, view: &View) -> bool {
    scenario.landmarks.is_some() || labels::need_light(&view.quantities, &scenario.hazards)
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
pub fn chosen_s(auto: &AutoExposure, detector: &Detector, irradiance_w_m2: Vec<f32>) -> f64 {
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
