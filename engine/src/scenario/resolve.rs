//! From a scenario's text to a [`Scenario`]: structure, files, ranges, degrees to radians.

use std::path::{Path, PathBuf};

use super::error::{Fault, Problem, ScenarioError};
use super::files::{Found, Places};
use super::resolved::Scenario;
use super::spec::Spec;
use super::tree::{self, Node, Place};
use super::{camera, light, motion, presets, structure, sweep, world};
use crate::ephemeris::KernelSource;

/// Says what a file is and where it can be had, by its name.
pub type About<'a> = &'a dyn Fn(&str) -> Option<String>;

/// Resolves a scenario's text; `path` names it in messages. Reports all problems at once.
pub fn resolve(path: &Path, text: &str, places: &Places, about: About) -> Result<Scenario, ScenarioError> {
    let problems = |mut problems: Vec<Problem>| {
        problems.sort_by_key(|problem| problem.place);
        ScenarioError::Problems { path: path.to_path_buf(), problems }
    };
    let tree = tree::parse(text);
    let structural = tree.as_ref().map(structure::check).unwrap_or_default();
    let spec = match parse(text) {
        Ok(spec) => spec,
        Err(_) if !structural.is_empty() => return Err(problems(structural)),
        Err(syntax) => return Err(problems(vec![syntax])),
    };
    let mut check = Check { tree: tree.as_ref(), problems: structural, places, about };
    let scenario = scenario(path, text, &spec, &mut check);
    if check.problems.is_empty() { Ok(scenario) } else { Err(problems(check.problems)) }
}

/// Reads the text with `ron`, with the extensions that make files plain.
fn parse(text: &str) -> Result<Spec, Problem> {
    read(text).map_err(|error| Problem {
        place: Place { line: error.span.start.line, column: error.span.start.col },
        key: String::new(),
        fault: Fault::Syntax(first_letter_lower(&error.code.to_string())),
    })
}

pub(super) fn read<T: serde::de::DeserializeOwned>(text: &str) -> Result<T, ron::error::SpannedError> {
    use ron::extensions::Extensions;
    let extensions = Extensions::IMPLICIT_SOME | Extensions::UNWRAP_NEWTYPES | Extensions::UNWRAP_VARIANT_NEWTYPES;
    ron::Options::default().with_default_extension(extensions).from_str(text)
}

fn first_letter_lower(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map(|first| first.to_lowercase().collect::<String>() + chars.as_str()).unwrap_or_default()
}

/// Collects problems while a [`Spec`] becomes a [`Scenario`]. Where a value is wrong, a harmless one takes its place,
/// so that the rest can be checked too; the scenario is then thrown away.
pub(super) struct Check<'a> {
    tree: Option<&'a Node>,
    problems: Vec<Problem>,
    places: &'a Places,
    about: About<'a>,
}

impl Check<'_> {
    pub fn report(&mut self, key: &str, fault: Fault) {
        let place = self.tree.map_or(Place { line: 1, column: 1 }, |tree| tree.locate(key));
        self.problems.push(Problem { place, key: key.into(), fault });
    }

    /// Reports `key = got rule` unless the rule holds.
    pub fn rule(&mut self, holds: bool, key: &str, got: impl ToString, rule: impl Into<String>) {
        if !holds {
            self.report(key, Fault::Breaks { got: got.to_string(), rule: rule.into() });
        }
    }

    /// Reports `key needs …` unless it has it.
    pub fn needs(&mut self, holds: bool, key: &str, needs: impl Into<String>) {
        if !holds {
            self.report(key, Fault::Needs(needs.into()));
        }
    }

    pub fn file(&mut self, key: &str, name: &str) -> PathBuf {
        let found = self.places.find(name);
        self.found(key, name, found)
    }

    pub fn folder(&mut self, key: &str, name: &str) -> PathBuf {
        match self.places.find(name) {
            Found::Directory(path) => path,
            Found::File(_) => {
                self.report(key, Fault::Needs("must be a folder".into()));
                PathBuf::new()
            }
            nowhere => self.found(key, name, nowhere),
        }
    }

    /// A kernel's file, or the kernel of that name that the program carries.
    pub fn kernel(&mut self, key: &str, name: &str) -> KernelSource {
        match (self.places.find(name), KernelSource::shipped(name)) {
            (Found::Nowhere(_), Some(shipped)) => shipped,
            (found, _) => KernelSource::File(self.found(key, name, found)),
        }
    }

    fn found(&mut self, key: &str, name: &str, found: Found) -> PathBuf {
        let got = name.to_string();
        match found {
            Found::File(path) => return path,
            Found::Directory(_) => self.report(key, Fault::IsADirectory { got }),
            Found::Nowhere(looked_in) => {
                let file_name = Path::new(name).file_name().map(|name| name.to_string_lossy().into_owned());
                let about = file_name.and_then(|name| (self.about)(&name));
                self.report(key, Fault::FileNotFound { got, looked_in, about });
            }
        }
        PathBuf::new()
    }

    pub fn epoch(&mut self, key: &str, text: &str) -> Option<hifitime::Epoch> {
        let epoch = crate::ephemeris::parse_epoch(text).ok();
        if epoch.is_none() {
            self.report(key, Fault::NotAnEpoch { got: text.into() });
        }
        epoch
    }
}

fn scenario(path: &Path, text: &str, spec: &Spec, check: &mut Check) -> Scenario {
    let spec = &presets::completed(spec);
    check.rule(!spec.title.trim().is_empty(), "title", "\"\"", "must say what the sequence shows");
    let (camera, detector) = camera::camera(spec, check);
    let exposures = motion::exposures(&spec.exposures, &camera, check);
    let landmarks = camera::landmarks(spec, &camera, check);
    let terrain = spec.terrain.as_ref().map(|terrain| world::terrain(terrain, check));
    let has_terrain = terrain.is_some();
    check.needs(
        !spec.refine || spec.shadows.method().is_some_and(|method| method.has_bounds()),
        "refine",
        "needs shadows from horizon maps with all their coefficients and no visibility, whose errors are known",
    );
    world::lights_of_globe(spec, check);
    let horizon = world::horizon(&spec.horizon, check);
    let (sun, band) = light::light(spec, has_terrain, check);
    let mut scenario = Scenario {
        path: path.to_path_buf(),
        name: path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default(),
        text: text.into(),
        title: spec.title.trim().into(),
        body: world::body(&spec.body),
        frame: world::frame(spec, check),
        kernels: spec.kernels.as_ref().map(|kernels| world::kernels(kernels, check)),
        terrain,
        shadows: world::shadows(&spec.shadows, horizon.encoding, check),
        notes: spec.shadows.note().into_iter().collect(),
        horizon,
        refine: spec.refine,
        view_rays: spec.view_rays,
        photometry: (&spec.surface.photometry).into(),
        albedo: world::albedo(&spec.surface, check),
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
    };
    scenario.sweep = spec.sweep.as_ref().and_then(|written| sweep::sweep(written, &scenario, check));
    scenario
}
