//! `sim bench`.

use std::path::{Path, PathBuf};

use clap::Subcommand;
use perilune_bench::illumination as percentages;
use perilune_bench::shadows::matrix::{self, QUICK_DEG};
use perilune_bench::shadows::methods::{allowed, slow, usual};
use perilune_bench::{dataset, frame, horizons, radiometry, shadows, sources, stability};
use perilune_engine::report::Report;
use perilune_engine::shadow::registry;

use super::bars::Bars;
use super::common::{CacheArgs, Files};
use super::{Outcome, ranges};

/// Measure how fast and how right: horizons, images, shadows, light.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(subcommand)]
    bench: Bench,
}

#[derive(Debug, Subcommand)]
enum Bench {
    /// Speed, error and memory of horizons, and of the shadows they cast. Quick: one small scene, a third of the azimuths
    Horizon {
        #[command(flatten)]
        tables: Tables,
        /// A part to measure. Repeatable. [default: all]
        #[arg(long = "part", value_name = "NAME", value_parser = horizons::PARTS)]
        parts: Vec<String>,
    },
    /// Every encoding of horizon maps: bytes, horizons and shadows, beside the uncompressed ones. Quick: small patches of
    /// two scenes
    Encodings {
        #[command(flatten)]
        tables: Tables,
        /// A scene to try. Repeatable. [default: all]
        #[arg(long = "scene", value_name = "NAME", value_parser = horizons::ENCODED)]
        scenes: Vec<String>,
    },
    /// Illumination by each kind of skyline, and beside published percentages. Quick: some encodings, some places
    Illumination(Tables),
    /// Where the time of an image goes.
    Frame {
        #[command(flatten)]
        scene: Scene,
        /// Exposures A to B−1, counted from 0, written A..B [default: the first four]
        #[arg(long, value_parser = exposures)]
        frames: Option<std::ops::Range<usize>>,
        /// Times that each exposure is rendered
        #[arg(long, default_value_t = 3, value_parser = ranges::number(1_usize..=10_000, ""), allow_hyphen_values = true)]
        repeat: usize,
        #[command(flatten)]
        output: Output,
    },
    /// How fast a dataset is made beside how fast its images are rendered, with the time of each stage.
    Dataset {
        #[command(flatten)]
        scene: Scene,
        /// Exposures A to B−1, counted from 0, written A..B [default: the first six]
        #[arg(long, value_parser = exposures)]
        frames: Option<std::ops::Range<usize>>,
        #[command(flatten)]
        output: Output,
    },
    /// One exposure with every shadow method against traced shadows, under its own Sun or at several elevations.
    Shadows {
        #[command(flatten)]
        scene: Scene,
        /// Counted from 0
        #[arg(long, default_value_t = 0, value_parser = ranges::number(0_usize..=10_000_000, ""), allow_hyphen_values = true)]
        exposure: usize,
        /// Pixels along the longer side of the image
        #[arg(long, default_value_t = 512, value_parser = ranges::number(1_u32..=16_384, "pixels"), allow_hyphen_values = true)]
        size: u32,
        /// Elevations of a Sun that stands still instead, in degrees, written 0.5,1.5,3,6,15,35
        #[arg(long, value_delimiter = ',', value_parser = elevation, allow_hyphen_values = true)]
        elevations: Option<Vec<f64>>,
        /// Frames that are timed at each elevation
        #[arg(long, default_value_t = 3, value_parser = ranges::number(1_usize..=10_000, ""), allow_hyphen_values = true)]
        repeat: usize,
        /// 256 pixels, Sun at 1.5°, 6° and 15°
        #[arg(long, conflicts_with_all = ["size", "elevations"])]
        quick: bool,
        /// A method to try, or `all`. Repeatable. [default: all but those that take minutes a frame]
        #[arg(long = "method", value_name = "NAME", value_parser = method)]
        methods: Vec<String>,
        #[command(flatten)]
        output: Output,
    },
    /// The experiments of the sources that the shadow methods come from, beside the numbers that they print.
    Sources {
        /// Smaller patches and images
        #[arg(long)]
        quick: bool,
        /// Frames that are timed with each method
        #[arg(long, default_value_t = 5, value_parser = ranges::number(1_usize..=10_000, ""), allow_hyphen_values = true)]
        repeat: usize,
        #[command(flatten)]
        output: Output,
    },
    /// Light against published values: irradiance, limb, reflectance, disc integrals, eclipses.
    Radiometry {
        /// A folder with kernels in kernels/, before `SIM_DATA`: contacts of eclipses need one. Repeatable.
        #[arg(long)]
        data: Vec<PathBuf>,
        #[command(flatten)]
        output: Output,
    },
    /// Hard numerical cases with known answers, for every shadow method.
    Stability {
        #[command(flatten)]
        cache: CacheArgs,
        #[command(flatten)]
        output: Output,
    },
}

fn exposures(text: &str) -> Result<std::ops::Range<usize>, String> {
    let want = || format!("want A..B, as in 0..24, got {text}");
    let (from, until) = text.split_once("..").ok_or_else(want)?;
    let number = |part: &str| part.trim().parse::<usize>().map_err(|_| want());
    Ok(number(from)?..number(until)?)
}

/// What benchmarks over data have in common.
#[derive(Debug, clap::Args)]
struct Tables {
    /// Less of it, for a first look
    #[arg(long)]
    quick: bool,
    /// A folder with real elevation models in dem/, before `SIM_DATA`. Repeatable.
    #[arg(long)]
    data: Vec<PathBuf>,
    #[command(flatten)]
    output: Output,
}

impl Tables {
    fn folders(&self) -> Vec<PathBuf> {
        self.data.iter().cloned().chain(std::env::var_os("SIM_DATA").map(PathBuf::from)).collect()
    }
}

#[derive(Debug, clap::Args)]
struct Scene {
    /// The scenario; a bare name is also looked for in `scenarios/`.
    scenario: PathBuf,
    #[command(flatten)]
    files: Files,
}

#[derive(Debug, clap::Args)]
struct Output {
    /// Where the tables and the page go.
    #[arg(long, short, default_value = "output/benchmark")]
    output: PathBuf,
    /// Print the tables as JSON.
    #[arg(long)]
    json: bool,
}

impl Output {
    /// Writes reports that are not whole yet where the whole one will lie.
    #[allow(clippy::result_large_err)]
    fn publish(&self) -> impl Fn(&Report) -> Result<(), perilune_bench::Error> {
        |report| Ok(report.write(&self.output).map(drop)?)
    }
}

pub fn run(args: Args) -> Outcome {
    let bars = Bars::new();
    let (report, output) = match args.bench {
        Bench::Horizon { tables, parts } => {
            let program = std::env::current_exe().ok();
            let options =
                horizons::Options { parts, program, ..horizons::Options::new(tables.quick, tables.folders()) };
            let report = horizons::run(&options, &bars, &tables.output.publish())?;
            (report, tables.output)
        }
        Bench::Encodings { tables, scenes } => {
            let options = horizons::Options::new(tables.quick, tables.folders());
            let report = horizons::run_encodings(&options, &scenes, &bars, &tables.output.publish())?;
            (report, tables.output)
        }
        Bench::Illumination(tables) => {
            let options = percentages::Options { quick: tables.quick, folders: tables.folders() };
            (percentages::run(&options, &bars)?, tables.output)
        }
        Bench::Frame { scene, frames, repeat, output } => {
            let cache = scene.files.cache.open()?;
            let options = frame::Options { exposures: frames, repeat, cache: cache.to_path_buf() };
            (frame::run(&scene.files.scenario(&scene.scenario)?, &options, &bars)?, output)
        }
        Bench::Dataset { scene, frames, output } => {
            let cache = scene.files.cache.open()?;
            let options = dataset::Options { exposures: frames, cache: cache.to_path_buf() };
            (dataset::run(&scene.files.scenario(&scene.scenario)?, &options, &bars)?, output)
        }
        Bench::Shadows { scene, exposure, size, elevations, repeat, quick, methods, output } => {
            let (pixels, elevations) = if quick { (256, Some(QUICK_DEG.to_vec())) } else { (size, elevations) };
            let cache = scene.files.cache.open()?;
            let options = shadows::Options { exposure, pixels, methods: all_of(methods), cache: cache.to_path_buf() };
            let scenario = scene.files.scenario(&scene.scenario)?;
            let report = match elevations {
                None => shadows::run(&scenario, &options, &bars)?,
                Some(elevations_deg) => matrix::run(&scenario, &options, &elevations_deg, repeat, &bars)?,
            };
            (report, output)
        }
        Bench::Sources { quick, repeat, output } => (sources::run(&sources::Options { quick, repeat }, &bars)?, output),
        Bench::Radiometry { mut data, output } => {
            data.extend(std::env::var_os("SIM_DATA").map(PathBuf::from));
            (radiometry::run(&data)?, output)
        }
        Bench::Stability { cache, output } => (stability::run(&cache.open()?, &bars)?, output),
    };
    bars.clear();
    print(&report, &output.output, output.json)
}

fn print(report: &Report, directory: &Path, json: bool) -> Outcome {
    let files = report.write(directory)?;
    if json {
        println!("{}", serde_json::to_string_pretty(&report.json())?);
    } else {
        print!("{}", report.text());
        println!("\nwritten:");
        files.iter().for_each(|path| println!("{}", path.display()));
    }
    Ok(())
}

fn method(text: &str) -> Result<String, String> {
    match text == "all" || registry::named(text).is_some() {
        true => Ok(text.into()),
        false => Err(format!("want all, {}", allowed())),
    }
}

/// In degrees, within what a fixed Sun of a scenario may have.
fn elevation(text: &str) -> Result<f64, String> {
    let allowed = |degrees: &f64| (-90.0..=90.0).contains(degrees);
    text.parse().ok().filter(allowed).ok_or_else(|| "want degrees in [-90, 90]".into())
}

/// The methods meant by those named.
fn all_of(named: Vec<String>) -> Vec<String> {
    let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
    match &named[..] {
        [] => names(&usual()),
        _ if named.iter().any(|name| name == "all") => names(&[usual(), slow()].concat()),
        _ => named,
    }
}
