//! A camera that flies over one scene: a pose computed here for each image, all of them rendered in one session.
//!
//! `cargo run --release --example moving_camera -- FOLDER`

use std::path::PathBuf;

use perilune::{Adapter, Camera, Ephemeris, Error, Pose, Quantity, Scenario, Silent, View, parse_epoch, write_exr};

const TERRAIN: &str = r#"(
    title: "Ground to fly over",
    terrain: (dems: [
        Synthetic(columns: 257, rows: 257, posting_m: 20, latitude_deg: -85, longitude_deg: 0, seed: 3),
    ]),
    horizon: Settings(azimuths: 120),
    trajectory: Waypoints(points: [(t_s: 0, latitude_deg: -85, longitude_deg: 0, height_m: 50000)]),
    pointing: (towards: Nadir),
    camera: (columns: 16, rows: 16, field_of_view_deg: 10),
    exposures: List(["2026-11-24T00:00:00 UTC"]),
)"#;

fn main() -> Result<(), Error> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "output/examples".into()));
    let sequence = Scenario::parse(TERRAIN, ".")?.prepare(folder.join("cache"), &Silent)?;
    let scene = sequence.scene();
    let mut session = scene.session(Adapter::Auto)?;

    let moon = Ephemeris::of("moon")?;
    let target = scene.above_ground(-85.0, 0.0, 0.0);
    let sun = moon.sunlight(target, parse_epoch("2026-11-24T00:00:00 UTC")?)?;
    let camera = Camera::from_field_of_view(128, 128, 45f64.to_radians())?;
    for image in 0..8u32 {
        let place = scene.above_ground(-85.06 + 0.005 * f64::from(image), 0.0, 2500.0 - 200.0 * f64::from(image));
        let pose = Pose::looking_at(place, target, moon.north_at(place)).expect("north is not where the camera looks");
        let view = View::new(pose, camera.clone(), vec![sun.clone()]).with_quantities([Quantity::Radiance]);
        let frame = session.render(&view)?;
        let radiance = frame.plane(Quantity::Radiance).expect("asked for");
        let mean = radiance.values.iter().sum::<f32>() / radiance.values.len() as f32;
        println!(
            "image {image}: {:.0} m from the target, mean radiance {mean:.3} {}",
            place.distance_m(target),
            Quantity::Radiance.unit()
        );
        write_exr(folder.join(format!("moving_camera_{image}.exr")), &frame)?;
    }
    Ok(())
}
