//! `sim horizon DEM… -o DIR`.

use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;

use clap::ValueEnum;
use perilune_engine::geometry::Geodetic;
use perilune_engine::gpu::{Adapter, Gpu};
use perilune_engine::horizon::{self, Encoding, ErrorStatistics, Memory, Resources};
use perilune_engine::pipeline::Progress;
use perilune_engine::pipeline::ground::{self, Ground, Tile};
use perilune_engine::report::machine::peak_memory_mib;
use serde_json::{Value as Json, json};

use super::levels;
use crate::cli::bars::Bars;
use crate::cli::{Outcome, place, print_line, ranges};

#[derive(Debug, clap::Args)]
#[group(id = "build")]
pub struct Args {
    /// Elevation models that GDAL reads, the finest first
    #[arg(required = true, value_name = "DEM")]
    dems: Vec<PathBuf>,
    /// Directory of the tiles; a tile that is there already is kept
    // Required, but not beside a subcommand.
    #[arg(short, long, value_name = "DIR", required = true)]
    output: Option<PathBuf>,
    /// Centre of the map, in degrees [default: the middle of the first DEM]
    #[arg(long, value_name = "LAT,LON", value_parser = place, allow_hyphen_values = true)]
    at: Option<Geodetic>,
    /// Number of azimuths, evenly spaced
    #[arg(long, value_name = "N", default_value_t = 360, value_parser = ranges::azimuths, allow_hyphen_values = true)]
    azimuths: usize,
    /// Terrain further away does not occlude, in metres [default: all terrain does]
    #[arg(long, value_name = "M", value_parser = ranges::metres, allow_hyphen_values = true)]
    search: Option<f64>,
    /// Height of the observer above the ground, in metres
    #[arg(long, value_name = "M", default_value_t = 0.0, value_parser = ranges::height, allow_hyphen_values = true)]
    observer_height: f64,
    /// How skylines are looked for: sweep, the fast one; exact, right to the last digit of f32; gpu, as right, on a
    /// graphics device
    #[arg(long, value_enum, default_value_t)]
    method: Method,
    /// How skylines are stored: fm16, a Fourier pyramid of 16 coefficients; w21, a quantised one of as many bytes that errs
    /// less; q, quantised in equal steps, for small files
    #[arg(long, value_name = "NAME", default_value_t)]
    encoding: Encoding,
    /// Memory that the program may take, in MiB; with less than its sums need, a build keeps them on disk
    #[arg(long, value_name = "MIB", default_value_t = 2048, value_parser = ranges::memory, allow_hyphen_values = true)]
    memory: usize,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    levels: levels::Args,
}

#[derive(Debug, Clone, Copy, Default, ValueEnum)]
enum Method {
    #[default]
    Sweep,
    Exact,
    Gpu,
}

impl From<Method> for horizon::Method {
    fn from(method: Method) -> Self {
        match method {
            Method::Sweep => Self::Sweep,
            Method::Exact => Self::Exact,
            Method::Gpu => Self::Gpu,
        }
    }
}

pub fn run(args: Args) -> Outcome {
    let output = args.output.ok_or("no directory for the tiles is given: --output DIR")?;
    let bars = Bars::new();
    let mut ground = args.levels.ground(&args.dems, args.at, &bars)?;
    // No rays are shot here.
    Arc::make_mut(&mut ground.surface).pyramids = Vec::new();
    ground.resampling.iter().for_each(|line| bars.say(line));
    let settings = horizon::Settings {
        azimuths: args.azimuths,
        search_m: args.search,
        observer_height_m: args.observer_height,
        method: args.method.into(),
        ..horizon::Settings::default()
    };
    let mut all = Vec::new();
    let finished = |tile: &Tile| -> Result<(), Box<dyn Error>> {
        bars.clear();
        let facts = facts(&ground, &settings, tile)?;
        if !args.json {
            print_line(text(&facts))?;
        }
        all.push(facts);
        Ok(())
    };
    let device = match args.method {
        Method::Gpu => Some(Gpu::open(Adapter::Auto)?),
        Method::Sweep | Method::Exact => None,
    };
    let resources = Resources { memory: Memory::mib(args.memory), device: device.as_ref() };
    ground::horizons(&ground.surface, &settings, args.encoding, &output, resources, &bars, finished)?;
    bars.clear();
    if args.json {
        print_line(format_args!("{:#}", Json::from(all)))?;
    }
    Ok(())
}

/// What is told of a tile.
fn facts(ground: &Ground, settings: &horizon::Settings, tile: &Tile) -> Result<Json, Box<dyn Error>> {
    let level = &ground.surface.terrain.faces[tile.face].levels[tile.level];
    let samples = (tile.map.columns * tile.map.rows * settings.azimuths) as f64;
    let errors = &tile.map.errors;
    Ok(json!({
        "tile": tile.path,
        "face": tile.face,
        "level": tile.level,
        "columns": tile.map.columns,
        "rows": tile.map.rows,
        "posting_m": level.posting_m,
        "azimuths": settings.azimuths,
        "encoding": tile.map.encoding,
        "bytes": std::fs::metadata(&tile.path)?.len(),
        "built_s": tile.built_s,
        "samples_per_s": tile.built_s.map(|seconds| samples / seconds),
        "peak_memory_mib": peak_memory_mib(),
        "measured_pixels": errors.pixels,
        "swept_error_deg": in_degrees(&errors.swept),
        "decoded_error_deg": in_degrees(&errors.decoded),
    }))
}

pub fn in_degrees(errors: &ErrorStatistics) -> Json {
    let deg = |angle_rad: f64| angle_rad.to_degrees();
    json!({
        "rms": deg(errors.rms_rad), "p95": deg(errors.p95_rad), "p99": deg(errors.p99_rad), "max": deg(errors.max_rad),
    })
}

fn text(facts: &Json) -> String {
    let number = |key: &str| facts[key].as_f64().unwrap_or(f64::NAN);
    let path = facts["tile"].as_str().unwrap_or_default();
    let time = match facts["built_s"].as_f64() {
        Some(seconds) => format!("built in {seconds:.1} s, {:.1} million samples/s", number("samples_per_s") / 1e6),
        None => "was there".into(),
    };
    format!(
        "{path}: face {}, level {}\n  {} × {} nodes at {:.2} m, {} azimuths, {}, {:.2} MB, {time}\n  \
         error of {} traced nodes  rms       p95       p99       max (degrees)\n    swept               {}\n    \
         decoded             {}",
        facts["face"],
        facts["level"],
        facts["columns"],
        facts["rows"],
        number("posting_m"),
        facts["azimuths"],
        facts["encoding"].as_str().unwrap_or_default(),
        number("bytes") / 1e6,
        facts["measured_pixels"],
        row(&facts["swept_error_deg"]),
        row(&facts["decoded_error_deg"]),
    )
}

/// RMS, 95 %, 99 % and largest error in columns.
pub fn row(errors_deg: &Json) -> String {
    let cell = |key: &str| format!("{:10.5}", errors_deg[key].as_f64().unwrap_or(f64::NAN));
    ["rms", "p95", "p99", "max"].map(cell).concat()
}
