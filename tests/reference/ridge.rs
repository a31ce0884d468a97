//! Where DEM points appear in an image, by hand: polar stereographic map, sphere, pinhole.

use std::path::Path;

use glam::{DVec2, DVec3};
use perilune_engine::geometry::Body;
use perilune_engine::pipeline::{self, Silent};
use perilune_engine::quantity::LUNAR_RADIUS_M;
use perilune_engine::raster::{Dem, Options};
use perilune_engine::render::{Image, Quantity, Renderer};
use perilune_engine::scenario::{self, Shadows};

/// South polar stereographic coordinates, true at the pole: ρ = 2 R tan((90° − |lat|)/2), x = ρ sin lon, y = ρ cos lon.
fn stereographic_m(latitude_deg: f64, longitude_deg: f64) -> DVec2 {
    let rho_m = 2.0 * LUNAR_RADIUS_M * ((90.0 + latitude_deg).to_radians() / 2.0).tan();
    let (sin, cos) = longitude_deg.to_radians().sin_cos();
    rho_m * DVec2::new(sin, cos)
}

/// The body-fixed point of stereographic coordinates and a height.
fn point_m(map_m: DVec2, height_m: f64) -> DVec3 {
    let from_pole_rad = 2.0 * (map_m.length() / (2.0 * LUNAR_RADIUS_M)).atan();
    let (sin, cos) = from_pole_rad.sin_cos();
    let across = map_m.normalize();
    // x = ρ sin lon, y = ρ cos lon: body +X is longitude 0, +Y longitude 90° E.
    (LUNAR_RADIUS_M + height_m) * DVec3::new(sin * across.y, sin * across.x, -cos)
}

/// What the image's planes say at a pixel: stereographic coordinates and height.
fn seen(image: &Image, column: usize, row: usize) -> (DVec2, f64) {
    let value = |quantity| f64::from(image.plane(quantity).unwrap().values[row * image.columns + column]);
    (stereographic_m(value(Quantity::Latitude), value(Quantity::Longitude)), value(Quantity::Height))
}

/// Five points of the DEM around the landing site. The planes are f32 degrees, 0.01 pixels here; resampling the DEM to the
/// map moves smooth ground by decimetres, 14 m are a pixel.
#[test]
fn dem_points_appear_where_a_pinhole_puts_them() {
    let Some(mut scenario) = crate::conformance::scenarios::load("connecting_ridge.ron") else { return };
    scenario.shadows = Shadows::Off;
    scenario.camera.samples_per_pixel = 1;
    scenario.outputs.planes = vec![Quantity::Latitude, Quantity::Longitude, Quantity::Height];
    let scenario::Dem::File { path, .. } = scenario.terrain.as_ref().unwrap().dems[0].clone() else { panic!("a file") };
    let cache = tempfile::tempdir().unwrap();
    let mut prepared = pipeline::prepare(&scenario, cache.path(), &Silent).unwrap();
    let scene = pipeline::build_scene(&scenario, &mut prepared, Path::new("unused"), &Silent).unwrap();
    let view = &prepared.exposures[0].view;
    let image = Renderer::Reference.render(&scene, view).unwrap();

    let dem = Dem::open(&path, &Body::moon(), &Options::default()).unwrap();
    let [west_m, step_x_m, _, north_m, _, step_y_m] = dem.georeference.geotransform;
    // 12 mm behind the pupil, pixels of 10 µm, the boresight through the middle of 1024 × 1024 pixels.
    let (focal_px, principal_px) = (12e-3 / 10e-6, DVec2::splat(511.5));
    let mut errors_px = Vec::new();
    for (column, row) in [(800, 800), (760, 840), (850, 790), (790, 730), (880, 870)] {
        let map_m = DVec2::new(west_m + step_x_m * (column as f64 + 0.5), north_m + step_y_m * (row as f64 + 0.5));
        let height_m = f64::from(dem.heights_m[row * dem.columns + column]);
        let from_camera_m = point_m(map_m, height_m) - view.camera_position.vector_m();
        let p = view.camera_from_body.quaternion() * from_camera_m;
        let predicted_px = principal_px + focal_px * DVec2::new(p.x, p.y) / p.z;
        // The image's own place of that point, from the planes about the nearest pixel.
        let near = predicted_px.round();
        let (c, r) = (near.x as usize, near.y as usize);
        let (here_m, here_height_m) = seen(&image, c, r);
        let across_m = (seen(&image, c + 1, r).0 - seen(&image, c - 1, r).0) / 2.0;
        let down_m = (seen(&image, c, r + 1).0 - seen(&image, c, r - 1).0) / 2.0;
        let found_px = near + glam::DMat2::from_cols(across_m, down_m).inverse() * (map_m - here_m);
        println!(
            "DEM pixel {column}, {row}: {found_px:.3} in the image, {predicted_px:.3} by hand, {height_m} m, image {here_height_m} m"
        );
        errors_px.push(found_px.distance(predicted_px));
        // Half a pixel away the ground is some metres higher or lower.
        assert!((here_height_m - height_m).abs() < 15.0, "{column} {row}: {here_height_m} m, DEM {height_m} m");
    }
    assert!(errors_px.iter().all(|error_px| *error_px < 0.05), "{errors_px:?}");
}
