//! Profiles of a small terrain, and the comparators on them.

use perilune_bench::horizons::{curvature, errors, searched, shadows, traced};
use perilune_bench::scenes::Scene;
use perilune_engine::geometry::{Body, BodyFixed, Geodetic, Position};
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::horizon::{Settings, measure::Sample};
use perilune_engine::terrain::{Face, Pyramid};

#[test]
fn swept_profiles_are_those_of_the_same_pixels_and_azimuths() {
    let scene = Scene::synthetic(192, 3).unwrap();
    let settings = Settings { azimuths: 72, ..Settings::default() };
    let pixels = Sample::of(&scene.face.levels[0], 64, settings.azimuths).pixels;
    let (truth, mut tried) = (traced(&scene, &settings, &pixels), searched(&scene, &settings, &pixels).unwrap());
    let found = errors(&truth, &tried);
    assert!(found.p95.to_degrees() < 0.03, "{found:?}");
    assert!(shadows(&truth, &tried, 6f64.to_radians()).unwrap().wrong < 1e-3);

    // Profiles turned by one azimuth of 5°, or given to the next pixel, are found out.
    tried.iter_mut().for_each(|profile| profile.rotate_left(1));
    assert!(errors(&truth, &tried).p95.to_degrees() > 0.5);
    tried.iter_mut().for_each(|profile| profile.rotate_right(1));
    tried.rotate_left(1);
    assert!(errors(&truth, &tried).p95.to_degrees() > 3.0);
    assert!(shadows(&truth, &tried, 6f64.to_radians()).unwrap().wrong > 0.02);
}

/// Of slopes turned into angles and of distances to the same crossing along two grids.
const ROUNDING_RAD: f64 = 1e-12;

#[test]
fn a_skyline_looked_for_between_two_elevations_is_the_whole_one_between_them_and_on_the_same_side_beyond() {
    let scene = Scene::synthetic(128, 4).unwrap();
    let (settings, level) = (Settings::default(), &scene.face.levels[0]);
    let pyramids = [Pyramid::new(level)];
    let plain = Tracer::new(&scene.face, &settings);
    let bounded = plain.with_pyramids(&pyramids);
    let ends_rad = [4f64, 6.0].map(f64::to_radians);
    let (mut lower, mut higher) = (0, 0);
    for pixel in Sample::of(level, 40, settings.azimuths).pixels {
        let foot = level.lifted_node(pixel[0], pixel[1]);
        for azimuth in 0..settings.azimuths {
            let direction = settings.direction(azimuth);
            let whole_rad = plain.skyline(foot, direction).elevation_rad;
            let bounded_rad = bounded.skyline(foot, direction).elevation_rad;
            assert!((bounded_rad - whole_rad).abs() < ROUNDING_RAD, "{bounded_rad} {whole_rad}");
            let found_rad = bounded.skyline_within(foot, direction, ends_rad).elevation_rad;
            assert!(found_rad < whole_rad + ROUNDING_RAD);
            if whole_rad < ends_rad[0] - ROUNDING_RAD {
                lower += usize::from(found_rad < whole_rad - ROUNDING_RAD);
            } else if whole_rad < ends_rad[1] - ROUNDING_RAD {
                assert!((found_rad - whole_rad).abs() < ROUNDING_RAD, "{found_rad} {whole_rad}");
            } else {
                assert!(found_rad > ends_rad[1] - 2.0 * ROUNDING_RAD);
                higher += usize::from(found_rad < whole_rad - ROUNDING_RAD);
            }
        }
    }
    assert!(lower > 100 && higher > 100, "{lower} {higher}");
}

/// Within 250 km, from models in latitude and longitude, on the Moon and on Mars' spheroid.
#[test]
fn curvature_costs_less_than_the_posting_and_a_hundredth_of_a_degree() {
    let spheroid = Body::mars();
    for (body, latitude_deg) in [(Body::moon(), 30.0), (spheroid.clone(), 40.0)] {
        let mut face = curvature::equirectangular(&body, Geodetic::from_degrees(latitude_deg, 20.0, 0.0)).unwrap();
        let ground = |at: Position<BodyFixed>| curvature::waves_m(&body, body.geodetic_from_position(at));
        let errors = |face: &Face| curvature::errors(&body, face, &ground, 40, 24);
        let allowed_rad = 1000.0 / (2.0 * face.map.radius_m) + 0.01_f64.to_radians();
        let found = errors(&face);
        println!("{} {:?} of {}", body.name, found.p95.to_degrees(), allowed_rad.to_degrees());
        assert!(found.p95 < allowed_rad, "{found:?}");

        // The comparator fails: the same heights on a flat map.
        let (map, level) = (face.map.clone(), &mut face.levels[0]);
        for node in 0..level.heights_m.len() {
            let at_m = level.node_m(node % level.columns, node / level.columns);
            level.heights_m[node] += (at_m.length_squared() / (2.0 * map.radius_m)) as f32;
        }
        assert!(errors(&face).p95 > 10.0 * allowed_rad);
    }
}
