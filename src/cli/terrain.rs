//! `sim terrain`.

use std::path::PathBuf;
use std::time::Duration;

use clap::ValueEnum;
use indicatif::{ProgressBar, ProgressStyle};

use perilune::geometry::{Body, Geodetic};
use perilune::raster;
use perilune::terrain::synthetic::{self, Parameters};

use super::Outcome;

/// Write a synthetic cratered terrain as a GeoTIFF, and its craters as a table beside it.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// GeoTIFF to write; the craters go to the same name with .craters.csv
    #[arg(short, long, value_name = "FILE.tif")]
    output: PathBuf,
    #[arg(long, default_value_t = 1024)]
    columns: usize,
    #[arg(long, default_value_t = 1024)]
    rows: usize,
    /// Distance of pixels, in metres
    #[arg(long, value_name = "M", default_value_t = 20.0)]
    posting: f64,
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Latitude and east longitude of the middle, in degrees
    #[arg(long, value_name = "LAT,LON", default_value = "-89,0", value_parser = place, allow_hyphen_values = true)]
    at: Geodetic,
    #[arg(long, value_enum, default_value_t = Projection::Gnomonic)]
    projection: Projection,
    /// Diameter of the largest crater, in metres [default: a quarter of the map, at most 12 km]
    #[arg(long, value_name = "M")]
    largest: Option<f64>,
    /// Diameter of the smallest crater, in metres [default: 4 pixels]
    #[arg(long, value_name = "M")]
    smallest: Option<f64>,
    /// Craters per area, in units of the equilibrium density
    #[arg(long, default_value_t = 1.0)]
    density: f64,
    /// Exponent of the cumulative size distribution
    #[arg(long, default_value_t = synthetic::EQUILIBRIUM_EXPONENT)]
    exponent: f64,
    /// Height of the massif, in metres [default: a twentieth of the map, at most 1500 m]
    #[arg(long, value_name = "M")]
    relief: Option<f64>,
    /// RMS slope of the fractal on pixels of 20 m
    #[arg(long)]
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

/// `LAT,LON` in degrees.
fn place(text: &str) -> Result<Geodetic, String> {
    let numbers: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    match numbers[..] {
        [latitude_deg, longitude_deg] if latitude_deg.abs() <= 90.0 && longitude_deg.abs() <= 360.0 => {
            Ok(Geodetic::from_degrees(latitude_deg, longitude_deg, 0.0))
        }
        _ => Err("want a latitude in [-90, 90] and a longitude in [-360, 360], as in -89.5,120".into()),
    }
}

pub fn run(args: Args) -> Outcome {
    let body = Body::moon();
    let parameters = parameters(&args);
    let bar = progress_bar();
    let terrain = synthetic::generate(&body, &parameters, &|done, all| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    })?;
    bar.finish_and_clear();
    terrain.write(&args.output)?;
    let table = args.output.with_extension("craters.csv");
    std::fs::write(&table, terrain.craters_csv())
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
        println!("{}", serde_json::to_string_pretty(&written)?);
    } else {
        println!("{}: {lowest_m:.0} to {highest_m:.0} m", args.output.display());
        println!("{}: {} craters", table.display(), terrain.craters.len());
    }
    Ok(())
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
