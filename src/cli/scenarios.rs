//! `sim scenarios`.

use perilune_engine::scenario::{SHIPPED, ShippedScenario};
use serde_json::json;

use super::{Outcome, print_line};

/// List the scenarios that come with the program, or print one of them.
///
/// `sim run NAME.ron` runs each of them as it is; a printed one is a copy to change.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: sim scenarios lunar_descent > mine.ron")]
pub struct Args {
    /// The scenario to print [default: list all]
    #[arg(value_name = "NAME", value_parser = named)]
    scenario: Option<ShippedScenario>,
    /// Print the list as JSON
    #[arg(long, conflicts_with = "scenario")]
    json: bool,
}

pub fn run(args: Args) -> Outcome {
    if let Some(scenario) = args.scenario {
        return Ok(print_line(scenario.text.trim_end())?);
    }
    if args.json {
        let entry = |scenario: ShippedScenario| json!({ "name": scenario.name, "title": scenario.title(), "needs": scenario.needs() });
        return Ok(print_line(format_args!("{:#}", SHIPPED.map(entry).into_iter().collect::<serde_json::Value>()))?);
    }
    let widest = SHIPPED.iter().map(|scenario| scenario.name.len()).max().unwrap_or(0);
    for scenario in SHIPPED {
        let needs = match &scenario.needs()[..] {
            [] => "needs no data".into(),
            files => format!("needs {}", files.join(", ")),
        };
        print_line(format_args!("{:<widest$}  {}; {needs}", scenario.name, scenario.title()))?;
    }
    Ok(())
}

fn named(text: &str) -> Result<ShippedScenario, String> {
    let names = || SHIPPED.map(|scenario| scenario.name).join(", ");
    ShippedScenario::named(text).ok_or_else(|| format!("want one of {}", names()))
}
