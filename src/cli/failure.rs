//! Errors on standard error: a line each, or with `--json` one object.
//!
//! ```text
//! { "kind": "output", "path": "output/a", "key": null, "message": "…", "problems": [] }
//! ```

use std::error::Error;
use std::path::Path;

use perilune_engine::dataset::DatasetError;
use perilune_engine::pipeline;
use perilune_engine::scenario::{Problem, ScenarioError};
use serde_json::{Value as Json, json};

use super::{Flagged, Problems, chain};

/// Prints an error.
pub fn report(error: &(dyn Error + 'static), as_json: bool) {
    if as_json {
        eprintln!("{}", object(error));
        return;
    }
    lines(error).iter().for_each(|line| eprintln!("error: {line}"));
}

/// Prints what is wrong with the arguments, as an object.
pub fn report_arguments(message: &str) {
    let message = message.trim().trim_start_matches("error: ");
    eprintln!("{}", json!({ "kind": "arguments", "path": null, "key": null, "message": message, "problems": [] }));
}

/// A line a problem where there may be several, else one.
fn lines(error: &(dyn Error + 'static)) -> Vec<String> {
    if error.is::<ScenarioError>() || error.is::<Problems>() {
        return error.to_string().lines().map(String::from).collect();
    }
    vec![chain(error)]
}

fn object(error: &(dyn Error + 'static)) -> Json {
    let told = lines(error);
    let message = told.join("\n");
    if let Some(ScenarioError::Problems { path, problems }) = error.downcast_ref() {
        let first = problems.first().map(|problem| &problem.key);
        let problems: Vec<Json> = problems.iter().map(problem).collect();
        return json!({ "kind": "scenario", "path": path, "key": first, "message": message, "problems": problems });
    }
    let of_pipeline = error.downcast_ref::<Flagged>().map(|flagged| &flagged.error).or(error.downcast_ref());
    let (kind, path) = match (of_pipeline, error.downcast_ref::<ScenarioError>()) {
        (Some(error), _) => of(error),
        (None, Some(ScenarioError::Read { path, .. })) => ("scenario", Some(path.as_path())),
        (None, Some(_)) => ("scenario", None),
        (None, None) if error.is::<Problems>() => ("problems", None),
        (None, None) => match error.downcast_ref::<DatasetError>() {
            Some(error) => ("output", error.path()),
            None => ("other", None),
        },
    };
    let problems: Vec<Json> = match error.is::<Problems>() {
        true => told.iter().map(|message| json!({ "message": message })).collect(),
        false => Vec::new(),
    };
    json!({ "kind": kind, "path": path, "key": null, "message": message, "problems": problems })
}

fn problem(problem: &Problem) -> Json {
    json!({
        "line": problem.place.line,
        "column": problem.place.column,
        "key": problem.key,
        "message": problem.fault.to_string(),
    })
}

/// What an error is about, and the file or folder.
fn of(error: &pipeline::Error) -> (&'static str, Option<&Path>) {
    use pipeline::Error as E;
    match error {
        E::Dataset(error) => ("output", error.path()),
        E::Ephemeris(_) => ("ephemeris", None),
        E::Trajectory(_) | E::Attitude(_) | E::Aem(_) => ("trajectory", None),
        E::Raster(_) => ("raster", None),
        E::Synthetic(_) | E::Terrain(_) | E::BelowGround { .. } => ("terrain", None),
        E::Horizon(_) | E::Shadows(_) => ("horizon", None),
        E::Camera(_) => ("camera", None),
        E::Photometry(_) => ("photometry", None),
        E::Gpu(_) => ("device", None),
        E::Render(_) => ("render", None),
        E::NoSuchExposures { .. } => ("exposures", None),
        E::Unwritable { path, .. } => ("output", Some(path)),
        _ => ("run", None),
    }
}
