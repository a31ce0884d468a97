//! From a scenario's text to a [`Scenario`]: structure, files, ranges, degrees to radians.

use std::path::Path;

use super::check::{Check, FileHint};
use super::error::{Problem, ScenarioError};
use super::files::SearchPath;
use super::resolved::Scenario;
use super::spec::Spec;
use super::{camera, light, motion, presets, structure, sweep, text, tree, world};
use crate::dataset::Format;

/// Resolves a scenario's text; `path` names it in messages. Reports all problems at once.
pub fn resolve(path: &Path, text: &str, places: &SearchPath, about: FileHint) -> Result<Scenario, ScenarioError> {
    let text = &*crate::text::plain(text);
    let problems = |mut problems: Vec<Problem>| {
        problems.sort_by_key(|problem| problem.place);
        ScenarioError::Problems { path: path.to_path_buf(), problems }
    };
    let tree = tree::parse(text);
    let structural = tree.as_ref().map(structure::check).unwrap_or_default();
    let spec = match text::parse(text) {
        Ok(spec) => spec,
        Err(_) if !structural.is_empty() => return Err(problems(structural)),
        Err(syntax) => return Err(problems(vec![syntax])),
    };
    let mut check = Check { tree: tree.as_ref(), problems: structural, notes: Vec::new(), places, about };
    let scenario = scenario(path, text, &spec, &mut check);
    if check.problems.is_empty() { Ok(scenario) } else { Err(problems(check.problems)) }
}

fn scenario(path: &Path, text: &str, spec: &Spec, check: &mut Check) -> Scenario {
    let spec = &presets::completed(spec);
    check.rule(!spec.title.trim().is_empty(), "title", "\"\"", "must say what the sequence shows");
    let (camera, detector) = camera::camera(spec, check);
    let exposures = motion::exposures(spec, &camera, check);
    let landmarks = camera::landmarks(spec, &camera, check);
    let terrain = spec.terrain.as_ref().map(|terrain| world::terrain(terrain, check));
    let has_terrain = terrain.is_some();
    check.needs(
        !spec.refine || spec.shadows.method().is_none_or(|method| method.has_bounds()),
        "refine",
        "needs shadows from horizon maps with all their coefficients and no visibility, whose errors are known",
    );
    world::lights_of_globe(spec, check);
    let horizon = world::horizon(&spec.horizon, check);
    let photometry = world::photometry(spec, check);
    let (sun, band) = light::light(spec, has_terrain, check);
    let mut scenario = Scenario {
        path: path.to_path_buf(),
        name: path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default(),
        text: text.into(),
        spec: spec.clone(),
        title: spec.title.trim().into(),
        body: world::body(&spec.body),
        frame: world::frame(spec, check),
        kernels: spec.kernels.as_ref().map(|kernels| world::kernels(kernels, check)),
        terrain,
        shadows: world::shadows(&spec.shadows, horizon.encoding, check),
        notes: spec.shadows.note().into_iter().chain(without_exr(spec)).collect(),
        horizon,
        refine: spec.refine,
        view_rays: spec.view_rays,
        albedo: world::albedo(&spec.surface, &photometry, check),
        photometry,
        sun,
        band,
        earthshine_albedo: spec.earthshine.map(|earthshine| earthshine.albedo),
        ambient: spec.ambient,
        bounce: spec.bounce,
        trajectory: motion::trajectory(spec, &exposures, check),
        pointing: motion::pointing(spec, &exposures, check),
        outputs: camera::outputs(spec, &camera, detector.is_some(), check),
        camera,
        detector,
        exposures,
        landmarks,
        sweep: None,
        split: spec.split.inspect(|split| sweep::check_split(split, check)),
        hazards: camera::hazards(&spec.hazards),
        seed: spec.seed,
        draft: false,
    };
    scenario.notes.append(&mut check.notes);
    scenario.sweep = spec.sweep.as_ref().and_then(|written| sweep::sweep(written, &scenario, check));
    scenario
}

/// What may surprise.
fn without_exr(spec: &Spec) -> Option<String> {
    let note = "outputs.formats names another format of all planes and not Exr: no OpenEXR is written";
    (!Format::writes_exr(&spec.outputs.formats)).then(|| note.into())
}
