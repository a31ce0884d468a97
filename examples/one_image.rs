//! One image of a scenario that is written here: prints its planes, and writes it as OpenEXR.
//!
//! `cargo run --release --example one_image -- FOLDER`

use std::path::PathBuf;

use perilune::{Adapter, Error, Scenario, Silent, write_exr};

const SCENARIO: &str = r#"(
    title: "A cratered highland at 85° S",
    terrain: (dems: [
        Synthetic(columns: 257, rows: 257, posting_m: 20, latitude_deg: -85, longitude_deg: 0, seed: 3),
    ]),
    horizon: Settings(azimuths: 120),
    trajectory: Waypoints(height_above: Terrain, points: [
        (t_s: 0, latitude_deg: -85.05, longitude_deg: 0, height_m: 3000),
    ]),
    pointing: (towards: At(latitude_deg: -85, longitude_deg: 0, height_above: Terrain)),
    camera: (columns: 256, rows: 256, field_of_view_deg: 45),
    exposures: List(["2026-11-24T00:00:00 UTC"]),
    outputs: (planes: [radiance, sun_fraction, range]),
)"#;

fn main() -> Result<(), Error> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "output/examples".into()));
    let sequence = Scenario::parse(SCENARIO, ".")?.prepare(folder.join("cache"), &Silent)?;
    let mut session = sequence.scene().session(Adapter::Auto)?;
    let image = sequence.render(&mut session, 0)?;
    println!("{} by {}", sequence.epoch(0), session.adapter());
    for plane in &image.planes {
        let known: Vec<f32> = plane.values.iter().copied().filter(|value| value.is_finite()).collect();
        let mean = known.iter().sum::<f32>() / known.len() as f32;
        println!("{}: mean {mean:.4} {}", plane.name, plane.quantity.unit());
    }
    write_exr(folder.join("one_image.exr"), &image)
}
