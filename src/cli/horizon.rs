//! `sim horizon`.

mod build;
mod globe;
pub mod levels;
mod plot;
mod query;
mod verify;

use super::Outcome;

/// Build, verify and query horizon tiles.
///
/// A tile holds the skyline around every node of a map, as a Fourier series over azimuth. `sim run` builds the tiles
/// it needs by itself; build them here to look at them, or ahead of a run.
#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true, after_help = EXAMPLES)]
pub struct Args {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    build: build::Args,
}

const EXAMPLES: &str = "\
Examples:
  sim terrain -o ridge.tif --columns 256 --rows 256
  sim horizon ridge.tif -o tiles                        a tile of one DEM
  sim horizon fine.tif wide.tif -o tiles --extent 8000  8 km of the fine one, within the wide one
  sim horizon moon.tif -o tiles --cube --posting 4000   the whole body, on six maps
  sim horizon globe moon.tif -o moon                    the whole body out of core, as a quad-tree of tiles
  sim horizon verify tiles/horizon_0123456789abcdef.tif ridge.tif
  sim horizon query tiles/horizon_0123456789abcdef.tif --at -89,0 --plot skyline.svg ridge.tif";

#[derive(Debug, clap::Subcommand)]
enum Command {
    Globe(globe::Args),
    Verify(verify::Args),
    Query(query::Args),
}

pub fn run(args: Args) -> Outcome {
    match args.command {
        Some(Command::Globe(args)) => globe::run(args),
        Some(Command::Verify(args)) => verify::run(args),
        Some(Command::Query(args)) => query::run(args),
        None => build::run(args.build),
    }
}

/// A place in degrees, for messages.
fn degrees(point: perilune_engine::geometry::Geodetic) -> String {
    format!("{:.6},{:.6}", point.latitude_rad.to_degrees(), point.longitude_east_rad.to_degrees())
}
