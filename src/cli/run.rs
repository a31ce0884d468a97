//! `sim run`.

use std::path::PathBuf;

use perilune_engine::dataset::{Existing, Folder, folder::plural};
use perilune_engine::pipeline::{self, AdapterChoice, Frames, Options, Report, Stages};

use super::bars::Bars;
use super::common::Files;
use super::{Outcome, interrupt, print_line, with_flag};

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
    /// Render these exposures only, counted from 0: 0,12,20 or 0..24 or every tenth of 0..200..10
    #[arg(long, value_name = "FRAMES")]
    frames: Option<Frames>,
    /// Go on: keep the exposures that are finished, whatever comments, title or number of exposures the scenario has by now.
    /// Where others would have other pixels, the run is refused and says what differs
    #[arg(long)]
    resume: bool,
    /// Let go of what the output holds of other runs, and write over files of the same names. With --resume, exposures that
    /// belong to the scenario stay. Nothing else ever removes or replaces what is finished
    #[arg(long)]
    overwrite: bool,
    /// A first look: a quarter of the size, one ray a pixel, only the horizons towards the Sun; into output/NAME-draft
    #[arg(long)]
    draft: bool,
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
  sim run lunar_descent.ron --draft --frames 0,12,23   a first look, into output/lunar_descent-draft
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

pub fn run(args: Args) -> Outcome {
    let scenario = args.files.scenario(&args.scenario)?;
    let (scenario, name) = match args.draft {
        true => (scenario.clone().draft(), format!("{}-draft", scenario.name)),
        false => (scenario.clone(), scenario.name),
    };
    let cache = args.files.cache.open()?;
    let options = Options {
        output: args.output.unwrap_or_else(|| PathBuf::from("output").join(name)),
        cache: cache.to_path_buf(),
        exposures: args.frames,
        existing: Existing { resume: args.resume, overwrite: args.overwrite },
        adapter: args.adapter.into(),
    };
    explain_interrupts(&options);
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

/// Ctrl-C tells what there is by then.
fn explain_interrupts(options: &Options) {
    let (output, cache) = (options.output.clone(), options.cache.display().to_string());
    interrupt::explain(move || {
        let again = interrupt::command(Some("--resume"), "--overwrite");
        let manifest = Folder::read_manifest(&output);
        let kept = manifest.and_then(|manifest| {
            let folder = Folder::read(&output).ok()?;
            let finished = folder.finished.values().filter(|finished| finished.run_key == manifest.run_key).count();
            Some(format!(
                "{finished} of {} kept in {}",
                plural(manifest.exposures_planned, "exposure"),
                output.display()
            ))
        });
        match kept {
            Some(kept) => format!("{kept}, and horizons that are half made in {cache}; go on with: {again}"),
            None => format!(
                "no exposure is begun; terrain and horizons that are half made are kept in {cache}; go on with: {again}"
            ),
        }
    });
}

fn print(report: &Report) -> Outcome {
    let Report { output, adapter, exposures, planned, rendered, seconds, .. } = report;
    let of = if exposures < planned { format!("{exposures} of ") } else { String::new() };
    print_line(format_args!("{of}{} in {}, {rendered} rendered now", plural(*planned, "exposure"), output.display()))?;
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
