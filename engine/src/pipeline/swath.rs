//! A swath for all exposures of a scenario.

use std::path::Path;

use super::{Error, Exposure, Progress};
use crate::horizon::Settings;
use crate::shadow::swath::{MOST_PLANES, Plan};
use crate::shadow::{HeldLight, Swath};
use crate::terrain::Surface;

/// The planes of the azimuths that the lights span.
pub fn swath(
    surface: &Surface,
    exposures: &[Exposure],
    azimuth_step_deg: f64,
    settings: &Settings,
    folder: &Path,
    progress: &dyn Progress,
) -> Result<Swath, Error> {
    let plan = plan(surface, exposures, azimuth_step_deg)?;
    progress.begin("horizons, a swath", plan.planes(), "azimuths");
    Ok(plan.open_or_build(surface, settings, folder, &|done, all| progress.at(done, all))?)
}

/// The azimuths that the lights of all exposures span, where a swath can hold them.
pub fn plan(surface: &Surface, exposures: &[Exposure], azimuth_step_deg: f64) -> Result<Plan, Error> {
    let plan = spanned(surface, exposures, azimuth_step_deg);
    match plan.most_planes() {
        got if got > MOST_PLANES => Err(Error::SwathTooWide { got, step_deg: azimuth_step_deg, allowed: MOST_PLANES }),
        _ => Ok(plan),
    }
}

/// The azimuths that the lights of all exposures span, however many.
pub fn spanned(surface: &Surface, exposures: &[Exposure], azimuth_step_deg: f64) -> Plan {
    let lights = exposures.first().map_or(0, |exposure| exposure.view.lights.len());
    let held: Vec<Vec<HeldLight>> = exposures.iter().map(|exposure| exposure.view.held_lights()).collect();
    let of_light = |light: usize| held.iter().map(|lights| lights[light]).collect();
    let lights: Vec<Vec<HeldLight>> = (0..lights).map(of_light).collect();
    Plan::new(surface, &lights, azimuth_step_deg.to_radians())
}
