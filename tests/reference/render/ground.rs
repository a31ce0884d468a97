//! Radiance of level ground.

use std::f64::consts::PI;

use glam::DVec2;

use crate::scenes::{self, Grid, SOLAR_IRRADIANCE_W_M2, flat_body, map};

/// L = A E_n sin e/π, with and without shadows: one rounding of f32 in the reference, a few in the pass.
#[test]
fn level_ground_has_the_radiance_of_its_albedo() {
    let terrain = Grid::square(500.0, 10.0).terrain(&flat_body(), |_| 0.0);
    let optics = scenes::pinhole(8, 8, 16.0);
    let mapped = scenes::shadowed(terrain.clone()).swap_remove(1);
    let map = map(&flat_body());
    for scene in [scenes::scene(terrain), mapped] {
        for elevation_deg in [5.0f64, 30.0, 90.0] {
            let sun = scenes::sun(&map, 0.7, elevation_deg.to_radians());
            let expected = 0.2 * SOLAR_IRRADIANCE_W_M2 * elevation_deg.to_radians().sin() / PI;
            let view = scenes::nadir(&map, DVec2::new(30.0, -20.0), 800.0, sun).with_optics(optics.clone());
            for (renderer, samples) in scenes::samples(&scene, &view) {
                // 400 m on the large body tilt the ground by 4e-7 rad, 5e-6 of sin 5°.
                let bound = if renderer == "reference" { 6e-6 } else { 2e-5 };
                for pixel in &samples.pixels {
                    let error = f64::from(pixel.radiance_w_m2_sr) / expected - 1.0;
                    let name = scenes::name(&scene, renderer);
                    assert!(error.abs() < bound, "{name} {elevation_deg}°: {error}");
                    assert_eq!(pixel.sun_fraction, 1.0, "{name} {elevation_deg}°");
                }
            }
        }
    }
}
