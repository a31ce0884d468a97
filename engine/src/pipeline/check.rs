//! All that can be said against a run without rendering it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::facts::{self, Facts, Known};
use super::models::ModelFacts;
use super::{
    Error, Progress, applicability, auto, body_frame, globe, ground, kernels, motion, points, scene, sequence, stand_in,
};
use crate::ephemeris::{Almanac, BodyFrame};
use crate::geometry::Geodetic;
use crate::labels::{Origin, catalogue};
use crate::scenario::{self, Albedo, CraterList, Dem, Scenario};
use crate::terrain::{Face, Surface, Terrain};

/// What a check has found.
#[derive(Debug, Default)]
pub struct Checked {
    pub problems: Vec<Error>,
    /// What the images will not be, though they will be made.
    pub warnings: Vec<String>,
    /// Whether poses were held against the terrain: not where it is synthetic and not made yet, or cannot be read.
    pub over_terrain: bool,
    /// Where nothing stands against the poses.
    pub facts: Option<Facts>,
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
    let mut here = ground.unwrap_or_else(|| stand_in(scenario, cache, progress));
    checked.warnings.extend(here.findings.clone());
    checked.warnings.extend(applicability::warnings(scenario, checked.over_terrain.then_some(&*here.surface)));
    let loaded = Almanac::load_sources(&kernels(scenario))
        .map_err(Error::from)
        .and_then(|almanac| Ok((body_frame(scenario, &almanac)?, almanac)));
    match loaded {
        Ok(((frame, note), almanac)) => {
            // Views repeat what is wrong with the camera.
            let known: Vec<String> = problems.iter().map(ToString::to_string).collect();
            let (found, facts) = poses(scenario, &almanac, &frame, &mut here, checked.over_terrain, progress);
            problems.extend(found.into_iter().filter(|problem| !known.contains(&problem.to_string())));
            if let Some((facts, odd)) = facts {
                note.iter().for_each(|note| progress.say(note));
                checked.warnings.extend(odd);
                checked.facts = Some(facts);
            }
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

/// Ground that stands for terrain which is not made yet, or cannot be read: measured models without what is invented below
/// their posting, flat ones for synthetic models, else the bare body.
fn stand_in(scenario: &Scenario, cache: &Path, progress: &dyn Progress) -> ground::Ground {
    let body = &scenario.body;
    let bare = |centre: Option<Geodetic>, faces: Vec<Face>, models: Vec<ModelFacts>| ground::Ground {
        surface: Arc::new(Surface::new(Terrain { body: body.clone(), faces })),
        centre: centre.unwrap_or(Geodetic::from_degrees(0.0, 0.0, 0.0)),
        inputs: Vec::new(),
        findings: Vec::new(),
        models,
        map: None,
        resampling: Vec::new(),
        globe: None,
    };
    let Some(terrain) = &scenario.terrain else { return bare(None, Vec::new(), Vec::new()) };
    let measured = terrain.dems.iter().filter(|dem| matches!(dem, Dem::File { .. })).cloned().collect::<Vec<_>>();
    let invented = terrain.dems.iter().filter(|dem| matches!(dem, Dem::Detail { .. })).count();
    if invented > 0 && invented + measured.len() == terrain.dems.len() {
        let without = scenario::Terrain { dems: measured, ..terrain.clone() };
        if let Ok(ground) = ground::surface(Some(&without), body, cache, progress) {
            return ground;
        }
    }
    let models = terrain.dems.iter().filter_map(|dem| stand_in::model(body, dem)).collect();
    match stand_in::face(body, terrain) {
        Some((face, centre)) => bare(Some(centre), vec![face], models),
        None => bare(terrain.centre, Vec::new(), models),
    }
}

/// What stands against the exposures' poses, and the facts where nothing does.
fn poses(
    scenario: &Scenario,
    almanac: &Almanac,
    frame: &BodyFrame,
    ground: &mut ground::Ground,
    over_terrain: bool,
    progress: &dyn Progress,
) -> (Vec<Error>, Option<(Facts, Vec<String>)>) {
    let points = points(scenario);
    let mut looked = None;
    if ground.globe.is_some() {
        looked = globe::exposures::exposures(&points, almanac, frame, ground, progress).err();
    }
    let (surface, centre) = (&ground.surface, ground.centre);
    let outcomes = match motion::outcomes(&points, almanac, frame, surface, centre) {
        Ok((outcomes, _)) => outcomes,
        Err(error) => return (vec![error], None),
    };
    let counts = |error: &Error| over_terrain || !matches!(error, Error::BelowGround { .. });
    let (exposures, failed): (Vec<_>, Vec<_>) = outcomes.into_iter().partition(Result::is_ok);
    let exposures: Vec<_> = exposures.into_iter().flatten().collect();
    let lights = auto::lights(&exposures);
    let refusal = scenario.shadows.method().and_then(|method| method.refusal(surface, &lights)).map(Error::from);
    let moves = sequence::check(scenario, &exposures).err().or(motion::band(scenario, &exposures).err());
    // It fails over what fails already.
    let looked = looked.filter(|_| failed.is_empty());
    let mut problems: Vec<Error> =
        failed.into_iter().filter_map(Result::err).filter(counts).chain(refusal).chain(moves).chain(looked).collect();
    if !problems.is_empty() || exposures.is_empty() {
        return (problems, None);
    }
    let choice = auto::choose(scenario, surface, &exposures);
    problems.extend(facts::check_memory(scenario, &surface.terrain, choice.method.as_ref()).err());
    progress.begin("looking at exposures", exposures.len(), "exposures");
    let known = Known { points: &points, exposures: &exposures, surface, models: &ground.models };
    match facts::gather(scenario, &known) {
        Ok(gathered) => (problems, Some(gathered)),
        Err(error) => {
            problems.push(error);
            (problems, None)
        }
    }
}
