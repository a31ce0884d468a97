//! A globe in tiles of several levels of detail over the corner of a cube: no cracks, and shadows as on the ground itself.

use std::collections::BTreeSet;
use std::path::Path;

use glam::{DVec2, DVec3};
use perilune_engine::geometry::{Body, Geodetic, Position};
use perilune_engine::horizon::Encoding;
use perilune_engine::pipeline::globe::{Globe, Options};
use perilune_engine::pipeline::{self, Prepared, Silent};
use perilune_engine::raster::{self, Dem};
use perilune_engine::render::{Quantity, Renderer, Scene, View};
use perilune_engine::scenario::{self, Scenario, SearchPath};
use perilune_engine::shadow::registry;
use perilune_engine::terrain::{Cut, Face, Ground, Surface, TileId, build_tile, drawn_tile};
use tempfile::TempDir;

use crate::{conformance, fixtures};

use super::globe::{body, options, run, write_globe};

const RADIUS_M: f64 = 1_737_400.0;

/// Hills of 3 km, 270 km from crest to crest: slopes of up to 6° that ten nodes of 27 km tell.
fn height_m(towards: DVec3) -> f64 {
    let [x, y, z] = (40.0 * towards).to_array();
    3000.0 * ((x + 1.0).sin() * (y + 2.0).sin() + (z - 0.6 * x).sin())
}

/// Where three of the cube's faces meet.
fn corner() -> Geodetic {
    Geodetic::from_degrees((1.0_f64 / 3.0).sqrt().asin().to_degrees(), 45.0, 0.0)
}

/// Steps between tiles' sides in radius, where another level of detail lies beside: along the sides, also between nodes.
fn steps_m(globe: &Globe, cut: &Cut, face: impl Fn(TileId) -> Face) -> Vec<f64> {
    let (tree, tiles) = (&globe.tree, cut.tiles().collect::<Vec<_>>());
    let faces: Vec<Face> = tiles.iter().map(|tile| face(*tile)).collect();
    let radius_m = |index: usize, towards: Position<_>| {
        let Face { map, levels } = &faces[index];
        let p = map.map_vector(towards);
        let at_m = p.truncate() * (map.radius_m / p.z);
        let height_m = levels[0].bilinear_m(levels[0].grid_from_map(at_m)).unwrap();
        map.unlift(at_m.extend(height_m)).length()
    };
    let mut steps_m = Vec::new();
    for (index, tile) in tiles.iter().enumerate() {
        let cells = tree.cells as f64;
        for half_nodes in 0..=2 * tree.cells {
            let along = 0.5 * half_nodes as f64;
            for (node, outwards) in [
                (DVec2::new(0.0, along), -DVec2::X),
                (DVec2::new(cells, along), DVec2::X),
                (DVec2::new(along, 0.0), -DVec2::Y),
                (DVec2::new(along, cells), DVec2::Y),
            ] {
                let beyond = tree.on_sphere(*tile, node + 1e-3 * outwards);
                let other = tiles.iter().position(|other| tree.find(other.level, beyond).0 == *other).unwrap();
                if tiles[other].level != tile.level || tiles[other].face != tile.face {
                    let on_side = tree.on_sphere(*tile, node);
                    steps_m.push((radius_m(index, on_side) - radius_m(other, on_side)).abs());
                }
            }
        }
    }
    steps_m
}

#[test]
fn tiles_of_different_detail_meet_without_a_step() {
    let folder = tempfile::tempdir().unwrap();
    let globe = Globe::open(&body(), &options(&folder, "steps"), &Silent).unwrap();
    let fine = globe.tree.find(2, globe.tree.body.position_from_geodetic(corner())).0;
    let cut = Cut::new(&globe.tree, [fine], |_| true);
    let levels: BTreeSet<usize> = cut.tiles().map(|tile| tile.level).collect();
    assert_eq!(levels.len(), 3);
    let largest = |steps_m: Vec<f64>| steps_m.into_iter().fold(0.0, f64::max);
    let drawn = steps_m(&globe, &cut, |tile| drawn_tile(&globe.tree, &cut, tile, &globe.dem).unwrap());
    assert!(drawn.len() > 2000, "{}", drawn.len());
    // At a cube's corner lifted heights are -1 270 000 m, of which f32 rounds an eighth of a metre.
    let step_m = largest(drawn);
    assert!(step_m < 0.3, "{step_m}");
    // Tiles as they are made, without turning into each other.
    let own_m = largest(steps_m(&globe, &cut, |tile| build_tile(&globe.tree, tile, &globe.dem, 8).unwrap()));
    assert!(own_m > 100.0, "{own_m}: nothing was to be closed");
}

/// 800 km above the corner, with horizons of the first face given and others made.
fn scenario(folder: &TempDir) -> Scenario {
    write_globe(&folder.path().join("globe.tif"), &height_m);
    let made = Options {
        settings: perilune_engine::horizon::Settings { azimuths: 64, ..Default::default() },
        encoding: Encoding::F16,
        margin: 24,
        tiles: vec!["0/1-2".parse().unwrap()],
        ..options(folder, "given")
    };
    run(&made);
    let Geodetic { latitude_rad, longitude_east_rad, .. } = corner();
    let place = [latitude_rad.to_degrees(), longitude_east_rad.to_degrees(), 800_000.0];
    let terrain = r#"path: "globe.tif", values: Height, tiles: "given", posting_px: 1.2"#;
    let camera = "columns: 72, rows: 72, field_of_view_deg: 75, samples_per_pixel: 1";
    resolved(folder, place, terrain, "azimuths: 64, encoding: F16", camera)
}

/// Straight down from a place, with what stands in the parentheses of its keys.
fn resolved(folder: &TempDir, place: [f64; 3], terrain: &str, horizon: &str, camera: &str) -> Scenario {
    let [latitude_deg, longitude_deg, height_m] = place;
    let text = format!(
        r#"(
            title: "Tiles from above",
            terrain: (dems: [Globe({terrain})]),
            horizon: Settings({horizon}),
            shadows: HorizonMaps(),
            trajectory: Waypoints(points: [
                (t_s: 0, latitude_deg: {latitude_deg}, longitude_deg: {longitude_deg}, height_m: {height_m}),
            ]),
            pointing: (towards: Nadir),
            camera: ({camera}),
            exposures: List(["2026-11-06T00:00:00 UTC"]),
            outputs: (planes: [radiance, height]),
        )"#
    );
    let path = folder.path().join("scenario.ron");
    std::fs::write(&path, &text).unwrap();
    scenario::resolve(&path, &text, &SearchPath::of(&path, &[fixtures::data_folder()]), &|_| None).unwrap()
}

fn ready(scenario: &Scenario, cache: &Path) -> (Prepared, Scene) {
    let mut prepared = pipeline::prepare(scenario, cache, &Silent).unwrap();
    let scene = pipeline::build_scene(scenario, &mut prepared, cache, &Silent).unwrap();
    (prepared, scene)
}

/// How far the Sun's centre stands above the skyline, on the ground itself: along a great circle, without map or grid.
fn clearance_rad(height_m: &dyn Fn(DVec3) -> f64, point: DVec3, sun: DVec3, step_rad: f64) -> f64 {
    let up = point.normalize();
    let (sin, across) = (up.dot(sun), (sun - up * up.dot(sun)).normalize());
    let from_m = RADIUS_M + height_m(up);
    let elevation_rad = |step: i32| {
        let (sin, cos) = (f64::from(step) * step_rad).sin_cos();
        let to_m = RADIUS_M + height_m(up * cos + across * sin);
        (to_m * cos - from_m).atan2(to_m * sin)
    };
    // 20 km of relief reach 9° far.
    let steps = (9.0_f64.to_radians() / step_rad) as i32;
    let skyline_rad = (1..steps).map(elevation_rad).fold(f64::NEG_INFINITY, f64::max);
    sin.asin() - skyline_rad
}

/// The ground, and what is too near to its skyline to be told.
struct Truth<'a> {
    height_m: &'a dyn Fn(DVec3) -> f64,
    step_rad: f64,
    clear_rad: f64,
}

/// Ground where light and shadow are clear, and the share of it on which an image says the same.
#[derive(Debug)]
struct Agreement {
    pixels: usize,
    in_cast_shadow: usize,
    share: f64,
    share_beside_borders: f64,
}

/// The exposure's view under a Sun at an elevation above the ground below the camera, and the direction of that.
fn lit(prepared: &Prepared, elevation_deg: f64) -> (View, DVec3) {
    let mut view = prepared.exposures[0].view.clone();
    let up = view.camera_position.vector_m().normalize();
    let (east, _) = up.any_orthonormal_pair();
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    let sun = up * sin + east * cos;
    view.lights.truncate(1);
    view.lights[0].position = Position::from_m(sun * 1.5e11);
    (view, sun)
}

/// Under a Sun at an elevation above the ground below the camera.
fn agreement(truth: &Truth, prepared: &Prepared, scene: &Scene, elevation_deg: f64) -> Agreement {
    let (view, sun) = lit(prepared, elevation_deg);
    let samples = Renderer::Reference.samples(scene, &view).unwrap();
    let (mut same, mut beside, mut cast) = (Vec::new(), Vec::new(), 0);
    for (pixel, hit) in samples.pixels.iter().zip(&samples.centres) {
        let Some(hit) = hit else { continue };
        let Ground::Dem { face, lifted, .. } = hit.ground else { panic!("only tiles are seen: {hit:?}") };
        let clearance_rad = clearance_rad(truth.height_m, hit.position.vector_m(), sun, truth.step_rad);
        if clearance_rad.abs() < truth.clear_rad {
            continue;
        }
        let agrees = (pixel.sun_fraction > 0.5) == (clearance_rad > 0.0);
        same.push(agrees);
        let sun_rad = hit.position.vector_m().normalize().dot(sun).asin();
        cast += usize::from(clearance_rad < 0.0 && sun_rad > 0.0);
        let level = &scene.surface.terrain.faces[face].levels[0];
        let grid = level.grid_from_map(lifted.truncate());
        let from_side = grid.min(DVec2::splat((level.columns - 1) as f64) - grid).min_element() - level.margin as f64;
        if from_side < 4.0 {
            beside.push(agrees);
        }
    }
    let share = |agree: &[bool]| agree.iter().filter(|agrees| **agrees).count() as f64 / agree.len() as f64;
    assert!(beside.len() > 100, "{}", beside.len());
    let (share, share_beside_borders) = (share(&same), share(&beside));
    Agreement { pixels: same.len(), in_cast_shadow: cast, share, share_beside_borders }
}

#[test]
fn shadows_fall_across_tiles_and_faces_as_on_the_ground_itself() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenario(&folder);
    let cache = folder.path().join("cache");
    let (prepared, mut scene) = ready(&scenario, &cache);
    let globe = prepared.ground.globe.as_ref().unwrap();
    let (faces, levels): (BTreeSet<_>, BTreeSet<_>) = globe.cut.tiles().map(|tile| (tile.face, tile.level)).unzip();
    assert!(faces.len() >= 3 && levels.len() >= 2, "{}", globe.summary());
    assert!(prepared.exposures[0].view.quantities.contains(&Quantity::Height), "whose rays tell where pixels are");
    // The Sun's radius, and as much again for series of 16 harmonics of a 27 km grid.
    let truth = Truth { height_m: &height_m, step_rad: 5e-4, clear_rad: 0.55_f64.to_radians() };
    for elevation_deg in [0.0, 3.0] {
        let found = agreement(&truth, &prepared, &scene, elevation_deg);
        println!("{elevation_deg}: {found:?}");
        assert!(found.pixels > 2000 && found.in_cast_shadow > 100);
        assert!(found.share > 0.999 && found.share_beside_borders > 0.999, "{found:?}");
    }
    if let Some(gpu) = conformance::gpu() {
        let (view, _) = lit(&prepared, 3.0);
        let view = view.with_quantities([Quantity::Radiance, Quantity::Range]);
        let reference = Renderer::Reference.samples(&scene, &view).unwrap();
        let pass = Renderer::on(gpu).samples(&scene, &view).unwrap();
        let found = conformance::render::compare(&view, &reference, &pass);
        println!("{found:?}");
        assert!(found.radiance >= 0.999 && found.range < 1e-4, "{found:?}");
    }
    // Without horizons only the ground's own slope shades it.
    scene = scene.with_shadows(registry::no_shadows());
    let unshadowed = agreement(&truth, &prepared, &scene, 0.0);
    assert!(unshadowed.share < 0.99, "{unshadowed:?}");
}

/// The far side's highlands about the edge of two faces at 135° east, against shadows over the raster's own pixels: with detail
/// by screen size and with all of it.
#[test]
fn shadows_of_the_real_moon_are_as_right_beside_borders_as_elsewhere() {
    let Some(path) = fixtures::data("dem/moon_gld100_16ppd_global.tif") else { return };
    let dem = Dem::open(&path, &Body::moon(), &raster::Options::default()).unwrap();
    // 16 pixels a degree from 0° east and the north pole on.
    let height_m = |p: DVec3| {
        let (latitude_deg, longitude_deg) = (p.z.asin().to_degrees(), p.y.atan2(p.x).to_degrees());
        dem.height_m(DVec2::new(16.0 * longitude_deg.rem_euclid(360.0) - 0.5, 16.0 * (90.0 - latitude_deg) - 0.5))
    };
    let folder = tempfile::tempdir().unwrap();
    let made = Options {
        dem: path.clone(),
        posting_m: None,
        cells: 64,
        margin: 64,
        settings: perilune_engine::horizon::Settings { azimuths: 128, ..Default::default() },
        encoding: Encoding::Fm16,
        tiles: vec!["0/0".parse().unwrap()],
        ..options(&folder, "given")
    };
    run(&made);
    let truth = Truth { height_m: &height_m, step_rad: 5e-4, clear_rad: 1.5_f64.to_radians() };
    // Measured: 0.996 and 0.989, beside borders 0.996 and 0.992; without horizons 0.90 and 0.89.
    for (posting_px, least) in [(1.0, 0.99), (3.0, 0.98)] {
        let camera = "columns: 128, rows: 128, field_of_view_deg: 110, samples_per_pixel: 1";
        let terrain = format!(r#"path: "{}", tiles: "given", posting_px: {posting_px}"#, path.display());
        let scenario = resolved(&folder, [-8.0, 135.0, 60_000.0], &terrain, "azimuths: 128", camera);
        let (prepared, mut scene) = ready(&scenario, &folder.path().join("cache"));
        let found = agreement(&truth, &prepared, &scene, 6.0);
        println!("{}: {found:?}", prepared.ground.globe.as_ref().unwrap().summary());
        scene = scene.with_shadows(registry::no_shadows());
        let unshadowed = agreement(&truth, &prepared, &scene, 6.0);
        println!("{unshadowed:?}");
        assert!(found.pixels > 10_000 && found.in_cast_shadow > 3000, "{found:?}");
        assert!(found.share > least && found.share_beside_borders > found.share - 0.005, "{found:?}");
        assert!(unshadowed.share < 0.93, "{unshadowed:?}");
    }
}

/// The same place at one pixel and at ten: fewer nodes, and everything that is seen is still there.
#[test]
fn detail_follows_the_size_of_pixels_and_the_number_of_tiles_that_are_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let mut scenario = scenario(&folder);
    scenario.shadows = scenario::Shadows::Off;
    let mut tiles = Vec::new();
    for (posting_px, most_tiles) in [(1.2, 96), (20.0, 96), (1.2, 7)] {
        let scenario::Dem::Globe(globe) = &mut scenario.terrain.as_mut().unwrap().dems[0] else { panic!("a globe") };
        (globe.posting_px, globe.most_tiles) = (posting_px, most_tiles);
        let (prepared, scene) = ready(&scenario, folder.path());
        let surface: &Surface = &scene.surface;
        let samples = Renderer::Reference.samples(&scene, &prepared.exposures[0].view).unwrap();
        let bare = samples.centres.iter().flatten().filter(|hit| !matches!(hit.ground, Ground::Dem { .. })).count();
        assert_eq!(bare, 0, "{}", prepared.ground.globe.as_ref().unwrap().summary());
        tiles.push((surface.terrain.faces.len(), prepared.ground.globe.unwrap().posting_px));
    }
    let [(fine, fine_px), (coarse, _), (few, few_px)] = tiles[..] else { panic!("three") };
    assert!(coarse < fine && few <= 7 && few < fine, "{tiles:?}");
    assert!(fine_px == 1.2 && few_px > 1.2, "{tiles:?}");
}
