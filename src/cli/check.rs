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
/// camera is placed at every epoch: above the ground, where the terrain is a file or was made by a run. What it finds ends the
/// list: where the models lie, what the camera sees of them, where the Sun stands, how bright it gets, who casts shadows, what a
/// run takes.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: sim check lunar_descent.ron")]
pub struct Args {
    /// The scenario; a bare name is also looked for in `scenarios/`
    scenario: PathBuf,
    #[command(flatten)]
    files: Files,
    /// Count warnings as errors
    #[arg(long)]
    strict: bool,
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
            "notes": scenario.notes, "facts": checked.facts,
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
        let counted =
            if scenario.images() == 1 { "1 exposure".into() } else { format!("{} exposures", scenario.images()) };
        let warned = match checked.warnings.len() {
            0 => String::new(),
            1 => ", 1 warning".into(),
            count => format!(", {count} warnings"),
        };
        print_line(format_args!("{path}: {counted}, no problems{warned}{unseen}"))?;
        if let Some(facts) = &checked.facts {
            print_line(format_args!("\n{}", facts.text().trim_end()))?;
        }
    }
    if args.strict && !checked.warnings.is_empty() {
        return Err(format!("{path}: {} warnings, none is allowed (--strict)", checked.warnings.len()).into());
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
