//! `sim horizon verify`.

use std::io;
use std::path::{Path, PathBuf};

use perilune_engine::geometry::Geodetic;
use perilune_engine::horizon::header::Header;
use perilune_engine::horizon::store;
use perilune_engine::horizon::verify::{Verification, verify};
use perilune_engine::pipeline::Progress;
use serde_json::json;

use super::build::{in_degrees, row};
use super::levels::{self, find};
use crate::cli::bars::Bars;
use crate::cli::{Outcome, place, print_line, ranges};

/// Trace nodes of a tile anew and hold the errors that its header states against what is found.
///
/// The nodes that the builder measured must give the stated figures again; nodes drawn at random may differ by chance
/// only. Exit code 1 where they do not.
#[derive(Debug, clap::Args)]
#[group(id = "verify")]
pub struct Args {
    /// The tile
    tile: PathBuf,
    /// The DEMs it was built from, with the options it was built with
    #[arg(required = true, value_name = "DEM")]
    dems: Vec<PathBuf>,
    /// Centre of the map, in degrees [default: the middle of the first DEM]
    #[arg(long, value_name = "LAT,LON", value_parser = place, allow_hyphen_values = true)]
    at: Option<Geodetic>,
    /// Nodes to draw
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = ranges::number(8_u64..=100_000, ""), allow_hyphen_values = true)]
    count: u64,
    /// Seed of the draw
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    levels: levels::Args,
}

pub fn run(args: Args) -> Outcome {
    let (header, map) = store::read(&args.tile)?;
    let bars = Bars::new();
    let ground = args.levels.ground(&args.dems, args.at, &bars)?;
    let (face, level) = find(&ground, &args.tile, &header)?;
    bars.begin("tracing", 1, "sample");
    let face = &ground.surface.terrain.faces[face];
    let found = verify(face, level, &header, &map, args.count as usize, args.seed);
    bars.clear();

    if args.json {
        print_json(&args, &header, &found)?
    } else {
        print_table(&header, &found)?
    }
    agreement(&args.tile, &found)
}

fn print_json(args: &Args, header: &Header, found: &Verification) -> io::Result<()> {
    let [stated, repeated, drawn] = [&header.errors.decoded, &found.repeated, &found.drawn].map(in_degrees);
    print_line(format_args!(
        "{:#}",
        json!({
            "tile": args.tile,
            "stated_error_deg": stated,
            "repeated_error_deg": repeated, "repeated_nodes": found.repeated_pixels, "repeats": found.repeats(),
            "drawn_error_deg": drawn, "drawn_nodes": found.drawn_pixels, "seed": found.seed,
            "stated_beyond_bound": [header.errors.bound.nodes_beyond, header.errors.bound.samples_beyond],
            "repeated_beyond_bound": found.repeated_beyond, "drawn_beyond_bound": found.drawn_beyond,
            "allowed_beyond_bound": found.allowed_beyond(), "deviations": found.deviations, "agrees": found.agrees(),
        })
    ))?;
    Ok(())
}

fn print_table(header: &Header, found: &Verification) -> io::Result<()> {
    let [stated, repeated, drawn] = [&header.errors.decoded, &found.repeated, &found.drawn].map(in_degrees);
    print_line(format_args!("error of the decoded skyline (degrees)     rms       p95       p99       max"))?;
    print_line(format_args!("  {:<34}{}", "stated", row(&stated)))?;
    print_line(format_args!(
        "  {:<34}{}",
        format!("traced anew, the same {} nodes", found.repeated_pixels),
        row(&repeated)
    ))?;
    let drawn_name = format!("{} nodes drawn with seed {}", found.drawn_pixels, found.seed);
    print_line(format_args!("  {drawn_name:<34}{}", row(&drawn)))?;
    print_line(format_args!("nodes beyond their bound at any azimuth (samples)"))?;
    let beyond = |[nodes, samples]: [usize; 2]| format!("{nodes} ({samples})");
    let bound = &header.errors.bound;
    print_line(format_args!("  {:<34}{}", "stated", beyond([bound.nodes_beyond, bound.samples_beyond])))?;
    print_line(format_args!("  {:<34}{}", "traced anew", beyond(found.repeated_beyond)))?;
    print_line(format_args!(
        "  {drawn_name:<34}{}, {} nodes allowed",
        beyond(found.drawn_beyond),
        found.allowed_beyond()
    ))?;
    print_line(format_args!(
        "the draw's mean square error lies {:.1} standard deviations from the stated sample",
        found.deviations
    ))?;
    Ok(())
}

/// Whether a tile errs as it says.
fn agreement(tile: &Path, found: &Verification) -> Outcome {
    let tile = tile.display();
    if let Some((figure, stated, repeated)) = found.contradiction() {
        let figures = format!("{figure} is stated as {stated:.6}, found as {repeated:.6}");
        return Err(format!("{tile} states errors that its own nodes do not have: {figures}").into());
    }
    if found.drawn_beyond[0] > found.allowed_beyond() {
        let [nodes, _] = found.drawn_beyond;
        let (drawn, allowed) = (found.drawn_pixels, found.allowed_beyond());
        let counts = format!("{nodes} of {drawn} nodes lie beyond them, at most {allowed} may");
        return Err(format!("{tile} states bounds that other nodes do not keep: {counts}").into());
    }
    if !found.agrees() {
        return Err(format!("{tile} states errors that other nodes do not have: rms").into());
    }
    Ok(())
}
