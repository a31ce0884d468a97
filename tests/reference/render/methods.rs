//! Maximum mipmaps and the multi-scale pyramid against closed forms, and on hard cases.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use perilune_engine::geometry::Body;
use perilune_engine::render::{Renderer, Scene};
use perilune_engine::shadow::ShadowMethod;
use perilune_engine::shadow::mipmaps::Mipmaps;
use perilune_engine::shadow::multiscale::Multiscale;
use perilune_engine::terrain::{Ground, Terrain};

use crate::conformance::render::scenes as conformance_scenes;
use crate::scenes::{self, Grid, Row, flat_body, map};

/// The Sun stands in the west, its light travels towards map +X.
const WEST_RAD: f64 = -FRAC_PI_2;

fn mipmaps(runs: &[u32]) -> Arc<dyn ShadowMethod> {
    Arc::new(Mipmaps::of(runs))
}

fn lit(terrain: &Terrain, shadows: Arc<dyn ShadowMethod>) -> Scene {
    scenes::scene(terrain.clone()).with_shadows(shadows)
}

/// A plateau 100 m high that ends at x = 0, over level ground. The posting is 20 m; three runs of five mips reach
/// 48 postings, 960 m, from each point.
fn step() -> Terrain {
    let grid = Grid { west_m: -400.0, south_m: -1000.0, columns: 121, rows: 101, posting_m: 20.0 };
    grid.terrain(&flat_body(), |at_m| if at_m.x <= 0.0 { 100.0 } else { 0.0 })
}

/// H cot e: where nothing changes across the ray, runs find the skyline of the surface. A tenth of the posting.
#[test]
fn mipmaps_end_the_shadow_of_a_step_where_trigonometry_says() {
    let (terrain, map) = (step(), map(&flat_body()));
    for (elevation_deg, runs) in [(8.0f64, vec![5, 5, 5]), (10.0, vec![5, 5, 5, 3]), (4.5, vec![5, 5, 6, 7])] {
        let expected_m = 100.0 / elevation_deg.to_radians().tan();
        let row = Row { west_m: expected_m - 150.0, east_m: expected_m + 150.0 };
        let view = row.view(&map, scenes::sun(&map, WEST_RAD, elevation_deg.to_radians()));
        for (renderer, samples) in scenes::samples(&lit(&terrain, mipmaps(&runs)), &view) {
            let edges_m = row.edges_m(&samples);
            println!("{elevation_deg}° {renderer}: {edges_m:?}, expected {expected_m:.1} m");
            assert_eq!(edges_m.len(), 1, "{elevation_deg}° {renderer}: {edges_m:?}");
            assert!((edges_m[0] - expected_m).abs() < 2.0, "{renderer}: {edges_m:?}, expected {expected_m} m");
        }
    }
}

/// At 4° the step's shadow is 1430 m long: beyond the reach of {5, 5, 5} its far part is missing.
#[test]
fn runs_see_no_further_than_they_reach() {
    let (terrain, map) = (step(), map(&flat_body()));
    let row = Row { west_m: 1100.0, east_m: 1300.0 };
    let view = row.view(&map, scenes::sun(&map, WEST_RAD, 4f64.to_radians()));
    let fractions = |runs: &[u32]| {
        let (_, samples) = scenes::samples(&lit(&terrain, mipmaps(runs)), &view).swap_remove(0);
        row.fractions(&samples)
    };
    assert!(fractions(&[5, 5, 5]).iter().all(|(_, fraction)| *fraction > 0.99));
    assert!(fractions(&[5, 5, 6, 7]).iter().all(|(_, fraction)| *fraction < 0.01));
}

/// A straight step of 1 km on the Moon shades 46 330 m at 2°, flat ground 28 636 m: lifted rays need no more steps for it.
#[test]
fn mipmaps_know_the_curvature_of_the_moon() {
    let grid = Grid { west_m: -4000.0, south_m: -10_000.0, columns: 121, rows: 41, posting_m: 500.0 };
    let terrain = grid.terrain(&Body::moon(), |at_m| if at_m.x <= 0.0 { 1000.0 } else { 0.0 });
    let map = map(&Body::moon());
    let method = Mipmaps::reaching(&terrain);
    for (elevation_deg, expected_m) in [(2.0f64, 46_330.0), (3.0, 21_657.0), (5.0, 11_896.0)] {
        let row = Row { west_m: expected_m - 4000.0, east_m: expected_m + 4000.0 };
        let view = row.view(&map, scenes::sun(&map, WEST_RAD, elevation_deg.to_radians()));
        for (renderer, samples) in scenes::samples(&lit(&terrain, Arc::new(method.clone())), &view) {
            let edges_m = row.edges_m(&samples);
            println!("{elevation_deg}° {renderer}: {edges_m:?}, expected {expected_m} m");
            assert_eq!(edges_m.len(), 1, "{renderer} {elevation_deg}");
            assert!((edges_m[0] - expected_m).abs() < 50.0, "{renderer}: {edges_m:?}, expected {expected_m} m");
        }
    }
}

/// V(h) of a uniform disc behind a straight edge, h radii above its centre: by one run or several.
#[test]
fn the_penumbra_behind_an_edge_is_the_share_of_the_disc() {
    let grid = Grid { west_m: -400.0, south_m: -300.0, columns: 321, rows: 61, posting_m: 10.0 };
    let terrain = grid.terrain(&flat_body(), |at_m| if at_m.x <= 0.0 { 20.0 } else { 0.0 });
    let (map, elevation_rad) = (map(&flat_body()), 2f64.to_radians());
    // Five, five and six mips reach 650 m.
    let row = Row { west_m: 480.0, east_m: 640.0 };
    let view = row.view(&map, scenes::sun(&map, WEST_RAD, elevation_rad));
    for runs in [&[5, 5, 6][..], &[8], &[5, 7]] {
        for (renderer, samples) in scenes::samples(&lit(&terrain, mipmaps(runs)), &view) {
            for (x_m, fraction) in row.fractions(&samples) {
                let h = ((20.0 / x_m).atan() - elevation_rad) / scenes::SOLAR_RADIUS_RAD;
                let h = h.clamp(-1.0, 1.0);
                let expected = 0.5 - (h.asin() + h * (1.0 - h * h).sqrt()) / std::f64::consts::PI;
                let error = (fraction - expected).abs();
                assert!(error < 5e-3, "{runs:?} {renderer} at {x_m} m: {fraction}, expected {expected}");
            }
        }
    }
}

/// tan ε = (H/d) cos(A − A_wall) of an endless ridge. What is left of it shrinks as the pyramid's steps and its offset grow
/// together: figure 10.
#[test]
fn the_multiscale_skyline_of_a_ridge_converges_as_published() {
    let ridge = |at: DVec2| 60.0 * (-(at.x / 80.0).powi(2)).exp();
    let terrain = Grid::square(2000.0, 10.0).terrain(&flat_body(), ridge);
    let face = &terrain.faces[0];
    let truth_rad = |x_m: f64, turn_rad: f64| {
        let highest = |t: f64| (ridge(DVec2::new(x_m - t, 0.0)) - ridge(DVec2::new(x_m, 0.0))) / t;
        let slope = (1..20_000).map(|i| highest(f64::from(i) * 0.1)).fold(0.0, f64::max);
        (slope * turn_rad.cos()).atan()
    };
    let rms_rad = |k: u32, o: f64| {
        let method = Multiscale::new(&terrain, k, o, 0.1);
        let mut squares = Vec::new();
        for x_m in [150.0, 250.0, 400.0, 700.0] {
            for turn_rad in [0.0, 0.6, -0.6] {
                let towards = DVec2::from_angle(turn_rad).rotate(DVec2::NEG_X);
                let at_m = DVec2::new(x_m, 35.0);
                let got = method.elevations_rad(&face.map, [0, 0], at_m, [towards])[0];
                squares.push((got - truth_rad(x_m, turn_rad)).powi(2));
            }
        }
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let errors: Vec<f64> = [(1, 1.0), (2, 2.0), (4, 4.0), (8, 8.0)].map(|(k, o)| rms_rad(k, o)).into();
    println!("RMS of ω for k = o = 1, 2, 4, 8: {errors:.5?} rad");
    assert!(errors.windows(2).all(|pair| pair[1] < pair[0]), "{errors:?}");
    assert!(errors[3] < 0.01 && errors[0] > 0.05, "{errors:?}");
}

/// Lifted slope 0 rises towards the edge of a map; a bare sphere has no skyline above the horizontal anywhere.
#[test]
fn a_bare_sphere_is_level_for_the_pyramid_wherever_on_the_map() {
    let terrain = Grid::square(120_000.0, 2000.0).terrain(&Body::moon(), |_| 0.0);
    let method = Multiscale::new(&terrain, 4, 2.0, 0.1);
    let face = &terrain.faces[0];
    for at_m in [DVec2::ZERO, DVec2::new(60_000.0, -50_000.0), DVec2::new(-100_000.0, 0.0)] {
        let directions = (0..8).map(|i| DVec2::from_angle(TAU * f64::from(i) / 8.0));
        for elevation_rad in method.elevations_rad(&face.map, [0, 0], at_m, directions) {
            // Half the arc to the first scales: a few km over R.
            assert!((-0.003..=1e-6).contains(&elevation_rad), "{elevation_rad} at {at_m}");
        }
    }
}

/// Sun in the zenith, in the nadir, on and below the horizon, behind the map: the pole with a gap and two levels, and faces of
/// a cube.
#[test]
fn no_hard_case_ends_in_nan() {
    let hard = ["nested, low", "cube from 5000 km"];
    for (name, scene, view) in conformance_scenes().into_iter().filter(|(name, ..)| hard.contains(name)) {
        let terrain = scene.surface.terrain.clone();
        let methods = [mipmaps(&[5, 5, 5]), mipmaps(&[1, 15]), Arc::new(Multiscale::new(&terrain, 1, 1.0, 0.03))];
        let up = terrain.faces[0].map.map_from_body.inverse().turn(DVec3::Z);
        let side = up.any_orthonormal_vector();
        let suns = [up, -up, side, (side - 0.01 * up).normalize()];
        let optics = scenes::pinhole(20, 15, view.optics.focal_px.x / 8.0);
        for shadows in methods {
            // Fields are found for one light; the reference renderer finds them for every image.
            let suns = if shadows.skylines().is_some() { &suns[2..] } else { &suns[..] };
            let scene = scenes::scene(terrain.clone()).with_shadows(shadows);
            for &sun in suns {
                let view = scenes::view(view.pose(), vec![scenes::light(sun)]).with_optics(optics.clone());
                let samples = Renderer::Reference.samples(&scene, &view).unwrap();
                for (pixel, centre) in samples.pixels.iter().zip(&samples.centres) {
                    let ground = centre.is_some_and(|hit| hit.ground != Ground::Gap);
                    let right = (0.0..=1.0).contains(&pixel.sun_fraction) && pixel.radiance_w_m2_sr >= 0.0;
                    assert!(!ground || right, "{name}, {}: {pixel:?}", scene.shadows.name());
                }
            }
        }
    }
}

/// Waves that a quarter turn leaves as they are, on so many cells: mean difference of the Sun's share after a quarter turn
/// of the Sun.
fn turned(half: usize) -> f64 {
    const SIDE: usize = 24;
    let map = perilune_engine::terrain::Gnomonic::about(
        &Body::moon(),
        perilune_engine::geometry::Geodetic::from_degrees(-90.0, 0.0, 0.0),
    );
    let waves =
        |up: DVec3| 40.0 * ((TAU * 1_737_400.0 / 900.0 * up.x).cos() + (TAU * 1_737_400.0 / 900.0 * up.y).cos());
    let levels = vec![scenes::level(&map, 20.0, half, 0, &waves)];
    let terrain =
        Terrain { body: Body::moon(), faces: vec![perilune_engine::terrain::Face { map: map.clone(), levels }] };
    let scene = scenes::scene(terrain).with_shadows(mipmaps(&[5, 5, 5]));
    let optics = scenes::pinhole(SIDE as u32, SIDE as u32, 40.0);
    let image = |azimuth_rad: f64| {
        let view = scenes::nadir(&map, DVec2::ZERO, 2000.0, scenes::sun(&map, azimuth_rad, 0.15));
        let view = view.with_optics(optics.clone());
        Renderer::Reference.samples(&scene, &view).unwrap().pixels
    };
    let [first, second] = [0.4, 0.4 + TAU / 4.0].map(image);
    let pixels = (0..SIDE * SIDE).map(|index| (index % SIDE, index / SIDE));
    let differences = pixels
        .map(|(c, r)| (first[r * SIDE + c].sun_fraction - second[(SIDE - 1 - r) + c * SIDE].sun_fraction).abs())
        .map(f64::from);
    differences.sum::<f64>() / (SIDE * SIDE) as f64
}

/// 128 cells fall into blocks that are the same after a quarter turn, 120 into others: 16, 16, …, 8. The search is without
/// fault, and sees what its blocks let it see.
#[test]
fn runs_turn_with_the_terrain_where_their_blocks_do() {
    let (alike, others) = (turned(64), turned(60));
    println!("128 cells {alike:.1e}, 120 cells {others:.1e}");
    assert!(alike < 1e-5, "{alike}");
    assert!(others > 1e-3, "{others}");
}
