//! `sim horizon query`.

use std::f64::consts::TAU;
use std::path::PathBuf;

use perilune_engine::files;
use perilune_engine::geometry::Geodetic;
use perilune_engine::horizon::inspect::TilePoint;
use perilune_engine::horizon::store;
use perilune_engine::horizon::trace::Tracer;
use serde_json::json;

use super::levels::{self, find};
use super::{degrees, plot};
use crate::cli::bars::Bars;
use crate::cli::{Outcome, place, print_line, ranges};

/// Print the skyline of a place as its tile holds it, and as traced where the DEMs are given.
#[derive(Debug, clap::Args)]
#[group(id = "query")]
pub struct Args {
    /// The tile
    tile: PathBuf,
    /// The DEMs it was built from, with the options it was built with
    #[arg(value_name = "DEM")]
    dems: Vec<PathBuf>,
    /// The place, in degrees
    #[arg(long, value_name = "LAT,LON", value_parser = place, allow_hyphen_values = true)]
    at: Geodetic,
    /// Centre of the tile's map where it was given to the build, in degrees
    #[arg(long, value_name = "LAT,LON", value_parser = place, allow_hyphen_values = true)]
    centre: Option<Geodetic>,
    /// Step of the azimuths, in degrees
    #[arg(long, value_name = "D", default_value_t = 5.0, value_parser = ranges::number(0.001..=120.0, "degrees"), allow_hyphen_values = true)]
    azimuth_step: f64,
    /// Draw the skyline
    #[arg(long, value_name = "FILE.svg", value_parser = svg)]
    plot: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    levels: levels::Args,
}

/// One azimuth, clockwise from north; angles in degrees.
pub struct Row {
    pub azimuth: f64,
    map_azimuth: f64,
    pub decoded: f64,
    pub traced: Option<f64>,
    distance_m: Option<f64>,
}

fn svg(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_svg = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("svg"));
    if is_svg { Ok(path) } else { Err("plots are drawn as .svg".into()) }
}

pub fn run(args: Args) -> Outcome {
    let (header, map) = store::read(&args.tile)?;
    let [latitude_deg, longitude_deg] = [args.at.latitude_rad, args.at.longitude_east_rad].map(f64::to_degrees);
    let place = TilePoint::on(&header, latitude_deg, longitude_deg)
        .ok_or_else(|| format!("--at {} lies outside {}", degrees(args.at), args.tile.display()))?;
    let ground = match args.dems[..] {
        [] => None,
        _ => {
            let bars = Bars::new();
            let ground = args.levels.ground(&args.dems, args.centre, &bars)?;
            bars.clear();
            Some((find(&ground, &args.tile, &header)?, ground))
        }
    };
    let tracer = ground.as_ref().map(|((face, level), ground)| {
        Tracer::without_finer(&ground.surface.terrain.faces[*face], *level, &header.settings)
    });

    let series = map.horizon(place.grid);
    // Of the elevations beyond its band a tile keeps nothing.
    let relevant = |elevation_rad| place.relevant_rad(&header, elevation_rad);
    let row = |azimuth: f64| {
        let direction = place.direction(&header, azimuth.to_radians());
        let skyline = tracer.as_ref().and_then(|tracer| place.traced(&header, tracer, azimuth.to_radians()));
        Row {
            azimuth,
            map_azimuth: direction.x.atan2(direction.y).rem_euclid(TAU).to_degrees(),
            decoded: relevant(series.evaluate_towards(direction).0).to_degrees(),
            traced: skyline.map(|skyline| relevant(skyline.elevation_rad).to_degrees()),
            distance_m: skyline.map(|skyline| skyline.distance_m),
        }
    };
    // The grace keeps 360 out where the step divides it but for rounding.
    let count = (360.0 / args.azimuth_step - 1e-9).ceil() as usize;
    let bound = map.bound_rad(place.grid).map(f64::to_degrees);
    let rows: Vec<Row> = (0..count).map(|index| row(index as f64 * args.azimuth_step)).collect();
    if let Some(path) = &args.plot {
        let title = format!("Skyline at {} (latitude, longitude east)", degrees(args.at));
        files::write(path, plot::svg(&title, &rows, bound).as_bytes())
            .map_err(|error| format!("cannot write {}: {error}", path.display()))?;
    }
    if args.json { print_json(&rows, bound) } else { print_table(&rows, bound) }
}

fn print_json(rows: &[Row], bound: Option<f64>) -> Outcome {
    let object = |row: &Row| {
        json!({
            "azimuth_deg": row.azimuth, "map_azimuth_deg": row.map_azimuth, "decoded_deg": row.decoded,
            "bound_deg": bound,
            "traced_deg": row.traced, "distance_m": row.distance_m,
        })
    };
    Ok(print_line(format_args!(
        "{:#}",
        rows.iter().map(object).collect::<Vec<_>>().into_iter().collect::<serde_json::Value>()
    ))?)
}

fn print_table(rows: &[Row], bound: Option<f64>) -> Outcome {
    match bound {
        Some(bound) => print_line(format_args!("decoded within {bound:.4} deg at every azimuth, at 19 nodes of 20"))?,
        None => print_line("no bound is known here")?,
    }
    let is_traced = rows.iter().any(|row| row.traced.is_some());
    print_line(format_args!(
        "azimuth  map azimuth    decoded{}",
        if is_traced { "     traced      error   distance" } else { "" }
    ))?;
    print_line(format_args!(
        "    deg          deg        deg{}",
        if is_traced { "        deg        deg          m" } else { "" }
    ))?;
    for Row { azimuth, map_azimuth, decoded, traced, distance_m } in rows {
        let traced = traced.zip(*distance_m).map_or(String::new(), |(traced, distance_m)| {
            format!("{traced:11.4}{:11.4}{distance_m:11.0}", decoded - traced)
        });
        print_line(format_args!("{azimuth:7.2}{map_azimuth:13.3}{decoded:11.4}{traced}"))?;
    }
    Ok(())
}
