//! `sim check`.

use std::path::PathBuf;

use perilune::scenario::{self, ScenarioError};
use serde_json::json;

use super::{Outcome, about, say};

/// Check a scenario without running it: report all that is wrong with it, each with line and column.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scenario; a bare name is also looked for in `scenarios/`.
    scenario: PathBuf,
    /// A directory in which files are looked for, before `SIM_DATA`. Repeatable.
    #[arg(long)]
    data: Vec<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

pub fn run(args: Args) -> Outcome {
    let checked = scenario::load(&args.scenario, &args.data, &about);
    if args.json {
        say(format_args!("{:#}", report(&checked)))?;
    } else if let Ok(scenario) = &checked {
        say(format_args!("{}: {} exposures, no problems", scenario.path.display(), scenario.exposures.len()))?;
    }
    match checked {
        Ok(_) => Ok(()),
        Err(error) => Err(error.into()),
    }
}

fn report(checked: &Result<scenario::Scenario, ScenarioError>) -> serde_json::Value {
    match checked {
        Ok(scenario) => json!({ "path": scenario.path, "exposures": scenario.exposures.len(), "problems": [] }),
        Err(ScenarioError::Problems { path, problems }) => json!({
            "path": path,
            "problems": problems.iter().map(|problem| json!({
                "line": problem.place.line,
                "column": problem.place.column,
                "key": problem.key,
                "message": problem.fault.to_string(),
            })).collect::<Vec<_>>(),
        }),
        Err(error) => json!({ "problems": [{ "message": error.to_string() }] }),
    }
}
