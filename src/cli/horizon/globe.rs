//! `sim horizon globe`.

use std::path::PathBuf;

use perilune_engine::horizon::{self, Encoding, Memory};
use perilune_engine::pipeline::globe::index::OverallErrors;
use perilune_engine::pipeline::globe::{self, Options, Selection};
use perilune_engine::report::machine::peak_memory_mib;
use serde_json::{Value as Json, json};

use super::build::{in_degrees, row};
use super::levels::{BodyArgs, Values};
use crate::cli::bars::Bars;
use crate::cli::{Outcome, print_line, ranges, with_flag};

/// Build the horizons of a whole body, tile by tile, from a model of any size.
///
/// The sphere is a quad-tree of square tiles over the six faces of a cube (0: latitude 0, longitude 0; 1: south pole; 2: north
/// pole; 3: 90° east; 4: 90° west; 5: 180°). Tiles that are there are kept: a run that was stopped goes on. The folder gets an
/// index, globe.json, of all tiles with their bounds and errors.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Elevation model of the whole body
    #[arg(value_name = "DEM")]
    dem: PathBuf,
    /// Folder of the tiles and their index
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Distance of the finest nodes in metres, at most [default: the model's own]
    #[arg(long, value_name = "M", value_parser = ranges::posting, allow_hyphen_values = true)]
    posting: Option<f64>,
    /// Cells along a tile's side
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = ranges::number(16_u16..=2048, ""), allow_hyphen_values = true)]
    cells: u16,
    /// Nodes around a tile at its own posting; each coarser level around it reaches as many of its own
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = ranges::number(40_u16..=2048, ""), allow_hyphen_values = true)]
    margin: u16,
    /// Make these tiles only: FACE/LEVEL/COLUMN/ROW, each a number, a range as 0-3, or *; or a box S,W,N,E in degrees
    #[arg(long, value_name = "TILES", allow_hyphen_values = true)]
    tiles: Vec<Selection>,
    /// Number of azimuths, evenly spaced
    #[arg(long, value_name = "N", default_value_t = 360, value_parser = ranges::azimuths, allow_hyphen_values = true)]
    azimuths: usize,
    /// Height of the observer above the ground, in metres
    #[arg(long, value_name = "M", default_value_t = 0.0, value_parser = ranges::height, allow_hyphen_values = true)]
    observer_height: f64,
    /// How skylines are stored: fm16, a Fourier pyramid of 16 coefficients; w21, a quantised one of as many bytes that errs
    /// less; q, quantised in equal steps, for small files
    #[arg(long, value_name = "NAME", default_value_t)]
    encoding: Encoding,
    /// Memory that the program may take, in MiB; with less than its sums need, a build keeps them on disk
    #[arg(long, value_name = "MIB", default_value_t = 2048, value_parser = ranges::memory, allow_hyphen_values = true)]
    memory: usize,
    /// Compare with traces over the full resolution at so many random places, the poles, the cube's edges and the
    /// antimeridian; 0 compares nothing
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = ranges::places, allow_hyphen_values = true)]
    check: usize,
    /// What pixels hold; auto tells heights from radii by their size
    #[arg(long, value_enum, default_value_t)]
    values: Values,
    #[command(flatten)]
    body: BodyArgs,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  sim horizon globe moon.tif -o moon                          all tiles of all levels
  sim horizon globe moon.tif -o moon --tiles 1/3              the south polar face at its finest
  sim horizon globe moon.tif -o moon --tiles=-10,170,10,-170  a box across the antimeridian";

pub fn run(args: Args) -> Outcome {
    let bars = Bars::new();
    let (body, json) = (args.body.body()?, args.json);
    let options = options(args);
    let start = std::time::Instant::now();
    let report = globe::build(&body, &options, &bars).map_err(with_flag)?;
    bars.clear();
    let seconds = start.elapsed().as_secs_f64();
    let index = &report.index;
    let path = options.directory.join(globe::index::FILE);
    let bytes: u64 = index.tiles.iter().map(|tile| tile.bytes).sum();
    let checks = index.checks.map(|checks| {
        json!({
            "places": checks.places,
            "coarsening_error_deg": in_degrees(&checks.coarsening),
            "decoded_error_deg": in_degrees(&checks.decoded),
        })
    });
    let [swept, decoded] = index.errors().map(|errors| errors.map(overall));
    let peak_mib = peak_memory_mib();
    if json {
        let facts = json!({
            "index": path, "tiles": index.tiles.len(), "built": report.built, "kept": report.kept,
            "seconds": seconds, "bytes": bytes, "peak_memory_mib": peak_mib,
            "swept_error_deg": swept, "decoded_error_deg": decoded, "checks": checks,
        });
        return Ok(print_line(format_args!("{facts:#}"))?);
    }
    print_line(format_args!(
        "{}: {} tiles, {:.1} MB, {} built in {seconds:.0} s, {} kept, peak memory {:.0} MiB",
        path.display(),
        index.tiles.len(),
        bytes as f64 / 1e6,
        report.built,
        report.kept,
        peak_mib.unwrap_or(f64::NAN)
    ))?;
    print_errors(swept.zip(decoded), checks)
}

fn options(args: Args) -> Options {
    let settings = horizon::Settings {
        azimuths: args.azimuths,
        observer_height_m: args.observer_height,
        ..horizon::Settings::default()
    };
    Options {
        dem: args.dem,
        values: args.values.into(),
        posting_m: args.posting,
        cells: args.cells.into(),
        margin: args.margin.into(),
        settings,
        encoding: args.encoding,
        directory: args.output,
        memory: Memory::mib(args.memory),
        tiles: args.tiles,
        checks: args.check,
    }
}

fn print_errors(of_tiles: Option<(Json, Json)>, checks: Option<Json>) -> Outcome {
    if let Some((swept, decoded)) = of_tiles {
        print_line(format_args!(
            "  error at {} traced samples of all tiles (degrees; percentiles of the middle and of the worst tile)\n    \
             {:18} rms       p95       worst     p99       worst     max\n    swept             {}\n    decoded           {}",
            swept["samples"],
            "",
            row_of_tiles(&swept),
            row_of_tiles(&decoded),
        ))?;
    }
    if let Some(checks) = checks {
        print_line(format_args!(
            "  error at {} places  rms       p95       p99       max (degrees)\n    of coarse levels  {}\n    decoded           {}",
            checks["places"],
            row(&checks["coarsening_error_deg"]),
            row(&checks["decoded_error_deg"]),
        ))?;
    }
    Ok(())
}

/// Errors of all tiles: percentiles of the middle and of the worst one.
fn row_of_tiles(errors: &Json) -> String {
    let cell = |[key, index]: [&str; 2]| {
        format!("{:10.5}", errors.pointer(&format!("/{key}{index}")).and_then(Json::as_f64).unwrap_or(f64::NAN))
    };
    [["rms", ""], ["p95", "/0"], ["p95", "/1"], ["p99", "/0"], ["p99", "/1"], ["max", ""]].map(cell).concat()
}

/// In degrees.
fn overall(errors: OverallErrors) -> Json {
    let pair = |angles_rad: [f64; 2]| angles_rad.map(f64::to_degrees);
    json!({
        "samples": errors.samples,
        "rms": errors.rms_rad.to_degrees(),
        "max": errors.max_rad.to_degrees(),
        "p95": pair(errors.p95_rad),
        "p99": pair(errors.p99_rad),
    })
}
