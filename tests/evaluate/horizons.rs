//! Profiles of a small terrain, and the comparators on them.

use perilune::evaluate::horizons::{errors, shadows, swept, traced};
use perilune::evaluate::scenes::Scene;
use perilune::horizon::trace::Tracer;
use perilune::horizon::{Settings, measure::Sample};

#[test]
fn swept_profiles_are_those_of_the_same_pixels_and_azimuths() {
    let scene = Scene::synthetic(192, 3).unwrap();
    let settings = Settings { azimuths: 72, ..Settings::default() };
    let pixels = Sample::of(&scene.face.levels[0], 64, settings.azimuths).pixels;
    let (truth, mut tried) = (traced(&scene, &settings, &pixels), swept(&scene, &settings, &pixels));
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

#[test]
fn a_skyline_looked_for_up_to_an_elevation_is_the_whole_one_below_it_and_not_lower_above() {
    let scene = Scene::synthetic(128, 4).unwrap();
    let (settings, level) = (Settings::default(), &scene.face.levels[0]);
    let tracer = Tracer::new(&scene.face, &settings);
    let mut stopped = 0;
    for pixel in Sample::of(level, 40, settings.azimuths).pixels {
        let foot = level.lifted_node(pixel[0], pixel[1]);
        for azimuth in 0..settings.azimuths {
            let direction = settings.direction(azimuth);
            let whole_rad = tracer.skyline(foot, direction).elevation_rad;
            let enough_rad = 6f64.to_radians();
            let found_rad = tracer.skyline_up_to(foot, direction, enough_rad).elevation_rad;
            // A slope compared instead of an angle: rounding only.
            if whole_rad < enough_rad - 1e-12 {
                assert_eq!(found_rad, whole_rad);
            } else {
                assert!(found_rad <= whole_rad && found_rad > enough_rad - 1e-12);
                stopped += usize::from(found_rad < whole_rad);
            }
        }
    }
    assert!(stopped > 100, "{stopped}");
}
