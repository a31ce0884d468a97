//! Exposures over ground that hangs on what they see.

use std::sync::Arc;

use super::super::{Error, Exposure, Progress, ground::Ground, motion, scene};
use crate::camera::Pose;
use crate::ephemeris::{Almanac, BodyFrame};
use crate::horizon::Settings;
use crate::scenario::Scenario;

/// All exposures and motions; over a globe, `ground` is then what they see of it.
///
/// A globe is seen at its coarsest first. What stands on its ground, or is looked at on it, finds its place anew on the
/// ground that is shown in the end.
pub fn exposures(
    points: &[Scenario],
    almanac: &Almanac,
    frame: &BodyFrame,
    ground: &mut Ground,
    progress: &dyn Progress,
) -> Result<(Vec<Exposure>, Vec<motion::Motion>), Error> {
    let placed = |ground: &Ground| motion::exposures(points, almanac, frame, &ground.surface, ground.centre);
    let (exposures, motions) = placed(ground)?;
    let (Some(coarsest), Some(scenario)) = (ground.globe.take(), points.first()) else {
        return Ok((exposures, motions));
    };
    progress.begin("choosing tiles", 1, "globe");
    let poses = poses(points, almanac, frame, &exposures, &motions)?;
    let shown = coarsest.seen(&ground.surface, &scene::optics(scenario)?, &poses);
    progress.say(&shown.summary());
    ground.surface = Arc::new(shown.surface()?);
    let (exposures, motions) = placed(ground)?;
    if scenario.shadows.method().is_none_or(|method| method.needs_maps()) {
        let band = motion::band(scenario, &exposures)?;
        shown.check_given(Settings { band, ..scene::horizon_settings(scenario) }, scenario.horizon.encoding)?;
    }
    ground.globe = Some(Box::new(shown));
    Ok((exposures, motions))
}

/// Of all moments of all parts of the exposures' images.
fn poses(
    points: &[Scenario],
    almanac: &Almanac,
    frame: &BodyFrame,
    exposures: &[Exposure],
    motions: &[motion::Motion],
) -> Result<Vec<Pose>, Error> {
    let mut all = Vec::new();
    for exposure in exposures {
        let scenario = &points[exposure.point];
        let times_s = scene::timing(scenario).times_s(scenario.camera.longest_exposure_s());
        let poses = motions[exposure.point].poses(almanac, frame, exposure.epoch, &times_s)?;
        all.extend(poses.into_iter().flatten());
    }
    Ok(all)
}
