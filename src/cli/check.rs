//! `sim check`.

use std::path::PathBuf;

use perilune_engine::pipeline;
use perilune_engine::scenario::ScenarioError;
use serde_json::{Value as Json, json};

use super::bars::Bars;
use super::common::Files;
use super::{Outcome, Problems, chain, print_line};

/// More problems of one scenario than these are one problem, seen at many exposures.
const LISTED: usize = 20;

/// Check a scenario without running it: list all that is wrong with it.
///
/// Keys, types and ranges are named with line and column. Then kernels are loaded, elevation models opened, and the
/// camera is placed at every epoch: above the ground, where the terrain is a file or was made by a run.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: sim check lunar_descent.ron")]
pub struct Args {
    /// The scenario; a bare name is also looked for in `scenarios/`
    scenario: PathBuf,
    #[command(flatten)]
    files: Files,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub fn run(args: Args) -> Outcome {
    let scenario = match args.files.scenario(&args.scenario) {
        Ok(scenario) => scenario,
        Err(error) => {
            if args.json {
                print_line(format_args!("{:#}", written_wrongly(&error)))?;
            }
            return Err(error.into());
        }
    };
    let bars = Bars::new();
    let checked = pipeline::check(&scenario, &args.files.cache.place(), &bars);
    bars.clear();
    let path = scenario.path.display();
    let mut problems: Vec<String> = checked.problems.iter().map(|problem| chain(problem)).collect();
    let unlisted = problems.len().saturating_sub(LISTED);
    problems.truncate(LISTED);
    if unlisted > 0 {
        problems.push(format!("and {unlisted} more"));
    }
    if args.json {
        let messages: Vec<Json> = problems.iter().map(|message| json!({ "message": message })).collect();
        let report = json!({
            "path": scenario.path, "exposures": scenario.images(),
            "over_terrain": checked.over_terrain, "problems": messages, "warnings": checked.warnings,
            "notes": scenario.notes,
        });
        print_line(format_args!("{report:#}"))?;
    }
    if !args.json {
        scenario.notes.iter().try_for_each(|note| print_line(format_args!("{path}: note: {note}")))?;
        checked.warnings.iter().try_for_each(|warning| print_line(format_args!("{path}: warning: {warning}")))?;
    }
    if !problems.is_empty() {
        return Err(Problems(problems.into_iter().map(|problem| format!("{path}: {problem}")).collect()).into());
    }
    if !args.json {
        let unseen = if checked.over_terrain { "" } else { " (terrain not made yet: heights above it unchecked)" };
        print_line(format_args!("{path}: {} exposures, no problems{unseen}", scenario.images()))?;
    }
    Ok(())
}

fn written_wrongly(error: &ScenarioError) -> Json {
    match error {
        ScenarioError::Problems { path, problems } => json!({
            "path": path,
            "problems": problems.iter().map(|problem| json!({
                "line": problem.place.line,
                "column": problem.place.column,
                "key": problem.key,
                "message": problem.fault.to_string(),
            })).collect::<Vec<_>>(),
        }),
        error => json!({ "problems": [{ "message": error.to_string() }] }),
    }
}
