//! `sim horizon`.

use std::path::PathBuf;

use clap::Subcommand;
use perilune::horizon::inspect::Place;
use perilune::horizon::store;

use super::Outcome;

/// Build, verify and query horizon tiles.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Print what a tile says about itself, as JSON.
    Show { tile: PathBuf },
    /// Print the skyline of a place on a tile: azimuth clockwise from north and elevation, in degrees.
    Query {
        tile: PathBuf,
        /// Latitude and east longitude, in degrees.
        #[arg(long, value_parser = degrees, allow_hyphen_values = true, value_name = "LAT,LON")]
        at: (f64, f64),
        /// Azimuths to print, evenly spaced.
        #[arg(long, default_value_t = 72)]
        azimuths: usize,
        /// Draw the skyline beside the numbers.
        #[arg(long)]
        plot: bool,
    },
}

pub fn run(args: Args) -> Outcome {
    match args.command {
        Command::Show { tile } => {
            let (header, _) = store::read(&tile)?;
            println!("{}", serde_json::to_string_pretty(&header)?);
            Ok(())
        }
        Command::Query { tile, at, azimuths, plot } => query(&tile, at, azimuths, plot),
    }
}

fn query(tile: &std::path::Path, (latitude_deg, longitude_deg): (f64, f64), azimuths: usize, plot: bool) -> Outcome {
    let (header, map) = store::read(tile)?;
    let place = Place::on(&header, latitude_deg, longitude_deg)
        .ok_or_else(|| format!("--at = {latitude_deg},{longitude_deg} lies outside {}", tile.display()))?;
    println!("azimuth_deg,elevation_deg");
    for i in 0..azimuths {
        let azimuth_deg = 360.0 * i as f64 / azimuths as f64;
        let elevation_deg = place.decoded_rad(&header, &map, azimuth_deg.to_radians()).to_degrees();
        let bar = if plot {
            " ".to_owned() + &"#".repeat((2.0 * elevation_deg + 20.0).clamp(0.0, 100.0) as usize)
        } else {
            String::new()
        };
        println!("{azimuth_deg:.3},{elevation_deg:.4}{bar}");
    }
    Ok(())
}

fn degrees(text: &str) -> Result<(f64, f64), String> {
    let wrong = || format!("{text} is not LAT,LON in degrees");
    let (latitude, longitude) = text.split_once(',').ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|number| number.is_finite()).ok_or_else(wrong);
    Ok((number(latitude)?, number(longitude)?))
}
