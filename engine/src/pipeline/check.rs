//! All that can be said against a run without rendering it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{
    Error, Progress, applicability, auto, body_frame, globe, ground, kernels, motion, points, scene, sequence,
};
use crate::ephemeris::{Almanac, BodyFrame};
use crate::geometry::{Body, Geodetic};
use crate::labels::{Origin, catalogue};
use crate::scenario::{Albedo, CraterList, Dem, Scenario};
use crate::terrain::{Surface, Terrain};

/// What a check has found.
#[derive(Debug, Default)]
pub struct Checked {
    pub problems: Vec<Error>,
    /// What the images will not be, though they will be made.
    pub warnings: Vec<String>,
    /// Whether poses were held against the terrain: not where it is synthetic and not made yet, or cannot be read.
    pub over_terrain: bool,
}

/// Loads kernels, opens files, computes all poses. Makes nothing.
pub fn check(scenario: &Scenario, cache: &Path, progress: &dyn Progress) -> Checked {
    let mut checked = Checked::default();
    let problems = &mut checked.problems;
    problems.extend(scene::optics(scenario).err());
    problems.extend(scene::imaging(scenario).err());
    let points = points(scenario);
    problems.extend(points.iter().filter_map(|point| scene::detector(point).err()).take(1));
    problems.extend(scene::disk(scenario).err());
    problems.extend(points.iter().filter_map(|point| scene::reflectance(point).err()).take(1));
    if let Albedo::Map(path, reading) | Albedo::SingleScattering(path, reading) = &scenario.albedo {
        match ground::look_at_albedo(path, reading, &scenario.body) {
            Ok(findings) => checked.warnings.extend(findings),
            Err(error) => problems.push(error),
        }
    }
    for list in scenario.landmarks.iter().flat_map(|landmarks| &landmarks.lists) {
        if let CraterList::File(path) = list {
            problems.extend(catalogue::read(path, "", Origin::Catalogue).map_err(Error::from).err());
        }
    }
    let ground = surface(scenario, cache, progress, problems);
    checked.over_terrain = ground.is_some();
    checked.warnings.extend(ground.iter().flat_map(|ground| ground.findings.clone()));
    checked.warnings.extend(applicability::warnings(scenario, ground.as_ref().map(|ground| &*ground.surface)));
    let loaded = Almanac::load_sources(&kernels(scenario))
        .map_err(Error::from)
        .and_then(|almanac| Ok((body_frame(scenario, &almanac)?, almanac)));
    match loaded {
        Ok((frame, almanac)) => {
            // Views repeat what is wrong with the camera.
            let known: Vec<String> = problems.iter().map(ToString::to_string).collect();
            let found = poses(scenario, &almanac, &frame, ground, progress);
            problems.extend(found.into_iter().filter(|problem| !known.contains(&problem.to_string())));
        }
        Err(error) => problems.push(error),
    }
    checked
}

/// The surface, where it can be had without making terrain.
fn surface(
    scenario: &Scenario,
    cache: &Path,
    progress: &dyn Progress,
    problems: &mut Vec<Error>,
) -> Option<ground::Ground> {
    let (body, dems) = (&scenario.body, scenario.terrain.as_ref().map_or(&[][..], |terrain| &terrain.dems));
    let paths = ground::paths(body, dems, cache);
    let is_there =
        |(dem, path): &(&Dem, &PathBuf)| !matches!(dem, Dem::Synthetic { .. } | Dem::Detail { .. }) || path.is_file();
    let (there, missing): (Vec<_>, Vec<_>) = dems.iter().zip(&paths).partition(is_there);
    let opened = match missing[..] {
        [] => ground::surface(scenario.terrain.as_ref(), body, cache, progress).map(Some),
        _ => Ok(None),
    };
    // The surface stops at the first DEM that fails; the others may fail too.
    let centre = scenario.terrain.as_ref().and_then(|terrain| ground::centre(terrain, &paths).ok());
    let failures = || there.iter().filter_map(|(dem, path)| ground::open(dem, path, body, centre, progress).err());
    match opened {
        Ok(Some(ground)) => return Some(ground),
        Ok(None) => problems.extend(failures()),
        Err(error) => {
            let failed: Vec<Error> = failures().collect();
            problems.extend(if failed.is_empty() { vec![error] } else { failed });
        }
    }
    None
}

/// What stands against the exposures' poses; over the bare body where there is no ground to hold them against.
fn poses(
    scenario: &Scenario,
    almanac: &Almanac,
    frame: &BodyFrame,
    ground: Option<ground::Ground>,
    progress: &dyn Progress,
) -> Vec<Error> {
    let over_terrain = ground.is_some();
    let mut looked = None;
    let (surface, centre) = match ground {
        Some(mut ground) => {
            if ground.globe.is_some() {
                looked = globe::exposures::exposures(&points(scenario), almanac, frame, &mut ground, progress).err();
            }
            (ground.surface, ground.centre)
        }
        None => bare(&frame.body, scenario),
    };
    let outcomes = match motion::outcomes(&points(scenario), almanac, frame, &surface, centre) {
        Ok((outcomes, _)) => outcomes,
        Err(error) => return vec![error],
    };
    let counts = |error: &Error| over_terrain || !matches!(error, Error::BelowGround { .. });
    let (exposures, failed): (Vec<_>, Vec<_>) = outcomes.into_iter().partition(Result::is_ok);
    let exposures: Vec<_> = exposures.into_iter().flatten().collect();
    let lights = auto::lights(&exposures);
    let refusal = scenario.shadows.method().and_then(|method| method.refusal(&surface, &lights)).map(Error::from);
    let moves = sequence::check(scenario, &exposures).err();
    // It fails over what fails already.
    let looked = looked.filter(|_| failed.is_empty());
    failed.into_iter().filter_map(Result::err).filter(counts).chain(refusal).chain(moves).chain(looked).collect()
}

fn bare(body: &Body, scenario: &Scenario) -> (Arc<Surface>, Geodetic) {
    let centre = scenario.terrain.as_ref().and_then(|terrain| terrain.centre);
    let surface = Surface::new(Terrain { body: body.clone(), faces: Vec::new() });
    (Arc::new(surface), centre.unwrap_or(Geodetic::from_degrees(0.0, 0.0, 0.0)))
}
