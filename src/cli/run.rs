//! `sim run`.

use std::ops::Range;
use std::path::PathBuf;

use perilune_engine::pipeline::{self, AdapterChoice, Options, Report, Stages};

use super::bars::Bars;
use super::common::Files;
use super::{Outcome, print_line, with_flag};

/// Render a scenario: terrain, horizons, then one image an exposure.
///
/// The images are OpenEXR files with a plane a quantity, each beside its preview and a record of poses, Sun and inputs.
/// A run that was stopped goes on with `--resume`; the same scenario makes the same bytes.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The scenario; a bare name is also looked for in `scenarios/`
    scenario: PathBuf,
    /// Directory of the images [default: output/NAME]
    #[arg(long, short, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    files: Files,
    /// Render exposures A to B−1 only, counted from 0
    #[arg(long, value_name = "A..B", value_parser = exposures)]
    frames: Option<Range<usize>>,
    /// Keep the exposures that an interrupted run of the same scenario finished
    #[arg(long)]
    resume: bool,
    /// Who renders
    #[arg(long, value_enum, default_value_t)]
    adapter: Adapter,
    /// Print what was done as JSON
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  sim run lunar_descent.ron                    all of it, into output/lunar_descent
  sim run lunar_descent.ron --frames 0..1      a first look
  sim run lunar_descent.ron --resume           what is missing
  sim run mine.ron --data ~/dems -o mine       files from ~/dems";

#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub enum Adapter {
    /// Any adapter; the reference renderer where there is none
    #[default]
    Auto,
    /// A hardware adapter or nothing
    Gpu,
    /// The f64 reference renderer on the CPU
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
    let scenario = args.files.scenario(&args.scenario)?;
    let options = Options {
        output: args.output.unwrap_or_else(|| PathBuf::from("output").join(&scenario.name)),
        cache: args.files.cache,
        exposures: args.frames,
        resume: args.resume,
        adapter: args.adapter.into(),
    };
    let bars = Bars::new();
    let report = pipeline::run(&scenario, &options, &bars).map_err(with_flag)?;
    bars.clear();
    if args.json {
        print_line(serde_json::to_string_pretty(&report)?)?;
    } else {
        print(&report)?;
    }
    Ok(())
}

fn print(report: &Report) -> Outcome {
    let Report { output, adapter, exposures, rendered, seconds, .. } = report;
    print_line(format_args!("{exposures} exposures in {}, {rendered} of them rendered now", output.display()))?;
    print_line(format_args!("rendered by {adapter}"))?;
    print_line(format_args!(
        "terrain {:.1} s, horizons {:.1} s, rendering {:.1} s ({:.2} s an exposure), previews {:.1} s",
        seconds.terrain,
        seconds.horizons,
        seconds.rendering,
        seconds.rendering / (*rendered).max(1) as f64,
        seconds.writing_after
    ))?;
    let Stages { samples, planes, encoding, writing } = report.stages;
    print_line(format_args!(
        "beside each other: samples {samples:.1} s, planes {planes:.1} s, encoding {encoding:.1} s, writing {writing:.1} s"
    ))?;
    report.warnings.iter().try_for_each(|warning| print_line(format_args!("warning: {warning}")))?;
    Ok(())
}
