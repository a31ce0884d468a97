//! `sim run`.

use std::ops::Range;
use std::path::PathBuf;

use perilune::pipeline::{self, AdapterChoice, Options, Report};
use perilune::scenario;

use super::bars::Bars;
use super::{Outcome, about};

/// Render a scenario: terrain, horizons, then one image an exposure.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scenario; a bare name is also looked for in `scenarios/`.
    scenario: PathBuf,
    /// Where the images go [default: output/NAME].
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Where synthetic terrain and horizon tiles are kept for the next run.
    #[arg(long, default_value = "output/cache")]
    cache: PathBuf,
    /// A directory in which files are looked for, before `SIM_DATA`. Repeatable.
    #[arg(long)]
    data: Vec<PathBuf>,
    /// Render only exposures A to B−1, counted from 0, written A..B.
    #[arg(long, value_parser = exposures)]
    frames: Option<Range<usize>>,
    /// Keep the exposures that an interrupted run of the same scenario finished.
    #[arg(long)]
    resume: bool,
    /// Who renders: any adapter, a hardware one, or the f64 reference on the CPU.
    #[arg(long, value_enum, default_value_t)]
    adapter: Adapter,
    /// Print what was done as JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub enum Adapter {
    #[default]
    Auto,
    Gpu,
    Cpu,
}

impl From<Adapter> for AdapterChoice {
    fn from(adapter: Adapter) -> Self {
        match adapter {
            Adapter::Auto => Self::Auto,
            Adapter::Gpu => Self::Gpu,
            Adapter::Cpu => Self::Cpu,
        }
    }
}

pub fn exposures(text: &str) -> Result<Range<usize>, String> {
    let want = || format!("want A..B, as in 0..24, got {text}");
    let (from, until) = text.split_once("..").ok_or_else(want)?;
    let number = |part: &str| part.trim().parse::<usize>().map_err(|_| want());
    Ok(number(from)?..number(until)?)
}

pub fn run(args: Args) -> Outcome {
    let scenario = scenario::load(&args.scenario, &args.data, &about)?;
    let options = Options {
        output: args.output.unwrap_or_else(|| PathBuf::from("output").join(&scenario.name)),
        cache: args.cache,
        exposures: args.frames,
        resume: args.resume,
        adapter: args.adapter.into(),
    };
    let bars = Bars::new();
    let report = pipeline::run(&scenario, &options, &bars)?;
    bars.clear();
    if args.json {
        println!("{}", serde_json::to_string_pretty(&report)?);
    } else {
        print(&report);
    }
    Ok(())
}

fn print(report: &Report) {
    let Report { output, adapter, exposures, rendered, seconds, .. } = report;
    println!("{exposures} exposures in {}, {rendered} of them rendered now", output.display());
    println!("rendered by {adapter}");
    println!(
        "terrain {:.1} s, horizons {:.1} s, rendering {:.1} s ({:.2} s an exposure), previews {:.1} s",
        seconds.terrain,
        seconds.horizons,
        seconds.rendering,
        seconds.rendering / (*rendered).max(1) as f64,
        seconds.writing_after
    );
}
