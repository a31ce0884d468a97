//! `sim terrain`.

use std::path::PathBuf;
use std::time::Duration;

use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};

use perilune_engine::files;
use perilune_engine::geometry::{Body, Geodetic};
use perilune_engine::raster;
use perilune_engine::report::machine::available_memory_bytes;
use perilune_engine::terrain::synthetic::{self, Parameters};

use super::{Outcome, place, print_line, ranges};

/// Write a synthetic cratered terrain as a GeoTIFF, and its craters as a table beside it.
///
/// Craters follow published size and depth statistics; the same seed makes the same bytes.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: sim terrain -o highland.tif --columns 2048 --rows 2048 --posting 15 --at -89.5,222")]
pub struct Args {
    /// GeoTIFF to write; the craters go to the same name with .craters.csv
    #[arg(short, long, value_name = "FILE.tif")]
    output: PathBuf,
    /// Pixels from west to east
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = ranges::number(8_usize..=32_768, "pixels"), allow_hyphen_values = true)]
    columns: usize,
    /// Pixels from north to south
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = ranges::number(8_usize..=32_768, "pixels"), allow_hyphen_values = true)]
    rows: usize,
    /// Distance of pixels, in metres
    #[arg(long, value_name = "M", default_value_t = 20.0, value_parser = ranges::posting, allow_hyphen_values = true)]
    posting: f64,
    /// Seed of craters and relief
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Latitude and east longitude of the middle, in degrees
    #[arg(long, value_name = "LAT,LON", default_value = "-89,0", value_parser = place, allow_hyphen_values = true)]
    at: Geodetic,
    /// Map projection of the file
    #[arg(long, value_enum, default_value_t = Projection::Gnomonic)]
    projection: Projection,
    /// Diameter of the largest crater, in metres [default: a quarter of the map, at most 12 km]
    #[arg(long, value_name = "M", value_parser = ranges::metres, allow_hyphen_values = true)]
    largest: Option<f64>,
    /// Diameter of the smallest crater, in metres [default: 4 pixels]
    #[arg(long, value_name = "M", value_parser = ranges::metres, allow_hyphen_values = true)]
    smallest: Option<f64>,
    /// Craters per area, in units of the equilibrium density
    #[arg(long, default_value_t = 1.0, value_parser = ranges::number(0.0..=100.0, ""), allow_hyphen_values = true)]
    density: f64,
    /// Exponent of the cumulative size distribution
    #[arg(long, default_value_t = synthetic::EQUILIBRIUM_EXPONENT, value_parser = ranges::number(0.1..=10.0, ""), allow_hyphen_values = true)]
    exponent: f64,
    /// Height of the massif, in metres [default: a twentieth of the map, at most 1500 m]
    #[arg(long, value_name = "M", value_parser = ranges::height, allow_hyphen_values = true)]
    relief: Option<f64>,
    /// RMS slope of the fractal on pixels of 20 m [default: 0.035]
    #[arg(long, value_parser = ranges::number(0.0..=10.0, ""), allow_hyphen_values = true)]
    roughness: Option<f64>,
    /// Print what was written as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Projection {
    Gnomonic,
    PolarStereographic,
    Equirectangular,
    Orthographic,
}

impl From<Projection> for synthetic::Projection {
    fn from(projection: Projection) -> Self {
        match projection {
            Projection::Gnomonic => Self::Gnomonic,
            Projection::PolarStereographic => Self::PolarStereographic,
            Projection::Equirectangular => Self::Equirectangular,
            Projection::Orthographic => Self::Orthographic,
        }
    }
}

pub fn run(args: Args) -> Outcome {
    let body = Body::moon();
    let parameters = parameters(&args);
    check_memory(&parameters)?;
    let bar = progress_bar();
    let terrain = synthetic::generate(&body, &parameters, &|done, all| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    })?;
    bar.finish_and_clear();
    terrain.write(&args.output)?;
    let table = args.output.with_extension("craters.csv");
    files::write(&table, terrain.craters_csv().as_bytes())
        .map_err(|error| format!("cannot write {}: {error}", table.display()))?;

    let (lowest_m, highest_m) =
        terrain.heights_m.iter().fold((f32::MAX, f32::MIN), |(low, high), &h| (low.min(h), high.max(h)));
    if args.json {
        let written = serde_json::json!({
            "terrain": args.output, "sha256": raster::digest(&args.output)?,
            "craters": table, "crater_count": terrain.craters.len(),
            "columns": terrain.columns, "rows": terrain.rows, "posting_m": parameters.posting_m,
            "lowest_m": lowest_m, "highest_m": highest_m,
            "crs": terrain.crs, "seed": parameters.seed,
        });
        print_line(serde_json::to_string_pretty(&written)?)?;
    } else {
        print_line(format_args!("{}: {lowest_m:.0} to {highest_m:.0} m", args.output.display()))?;
        print_line(format_args!("{}: {} craters", table.display(), terrain.craters.len()))?;
    }
    Ok(())
}

/// Heights in f32 and f64, the fractal, the file: in bytes a pixel.
const PIXEL_BYTES: f64 = 24.0;

fn check_memory(parameters: &Parameters) -> Result<(), String> {
    let needed_gb = PIXEL_BYTES * parameters.columns as f64 * parameters.rows as f64 / 1e9;
    let available_gb = available_memory_bytes().map(|bytes| bytes / 1e9);
    match available_gb {
        Some(available_gb) if needed_gb > available_gb => Err(format!(
            "memory: {} × {} pixels take about {needed_gb:.1} GB, {available_gb:.1} GB are available; ask for fewer --columns or --rows",
            parameters.columns, parameters.rows
        )),
        _ => Ok(()),
    }
}

fn parameters(args: &Args) -> Parameters {
    let usual = Parameters::highland(args.columns, args.rows, args.posting, args.seed);
    Parameters {
        centre: args.at,
        projection: args.projection.into(),
        largest_m: args.largest.unwrap_or(usual.largest_m),
        smallest_m: args.smallest.unwrap_or(usual.smallest_m),
        density: args.density,
        exponent: args.exponent,
        relief_m: args.relief.unwrap_or(usual.relief_m),
        roughness: args.roughness.unwrap_or(usual.roughness),
        ..usual
    }
}

/// Drawn on standard error where that is a terminal, nowhere else.
fn progress_bar() -> ProgressBar {
    let style = ProgressStyle::with_template("craters {bar:40} {pos}/{len} {eta}").expect("a valid template");
    let bar = ProgressBar::new(0).with_style(style);
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}
