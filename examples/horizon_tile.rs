//! Horizons: built for a terrain, opened from their tile, asked for the skyline of a place.
//!
//! `cargo run --release --example horizon_tile -- FOLDER`

use std::path::PathBuf;

use perilune::{Error, HorizonSettings, HorizonTile, Scenario, Silent};

const TERRAIN: &str = r#"(
    title: "Bare ground to build horizons of",
    terrain: (dems: [
        Synthetic(columns: 257, rows: 257, posting_m: 20, latitude_deg: -89, longitude_deg: 0, seed: 1),
    ]),
    shadows: Off,
    trajectory: Waypoints(points: [(t_s: 0, latitude_deg: -89, longitude_deg: 0, height_m: 50000)]),
    pointing: (towards: Nadir),
    camera: (columns: 16, rows: 16, field_of_view_deg: 10),
    exposures: List(["2026-11-24T00:00:00 UTC"]),
)"#;

fn main() -> Result<(), Error> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "output/examples".into()));
    let sequence = Scenario::parse(TERRAIN, ".")?.prepare(folder.join("cache"), &Silent)?;
    let settings = HorizonSettings { azimuths: 120, ..HorizonSettings::default() };
    let paths = HorizonTile::build(sequence.scene(), &settings, folder.join("tiles"), &Silent)?;
    let tile = HorizonTile::open(&paths[0])?;
    let [columns, rows] = tile.nodes();
    println!("{}: {columns} × {rows} nodes at {} m", paths[0].display(), tile.posting_m());
    println!("error against traced skylines: {:.3}° RMS", tile.errors().rms_rad.to_degrees());
    let skyline = tile.skyline(-89.0, 0.0).expect("the middle of the tile");
    for azimuth_deg in (0..360).step_by(30) {
        let elevation_deg = skyline.elevation_rad(f64::from(azimuth_deg).to_radians()).to_degrees();
        println!("{azimuth_deg:3}°  {elevation_deg:7.3}°");
    }
    Ok(())
}
