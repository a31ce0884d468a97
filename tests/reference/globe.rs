//! Horizons of a whole body, out of core, on a synthetic globe of 1 pixel per degree.

use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};
use perilune_engine::geometry::{Body, Direction, Position};
use perilune_engine::horizon::settings::direction;
use perilune_engine::horizon::{Encoding, ErrorStatistics, HorizonMap, Memory, Settings, store};
use perilune_engine::pipeline::globe::{Globe, Options, Report, build, index};
use perilune_engine::pipeline::{Error, Silent};
use perilune_engine::raster::{GeoTiff, GeoTiffBand, Values};
use perilune_engine::terrain::quadtree::TileId;
use tempfile::TempDir;

const PIXELS_PER_DEGREE: usize = 1;

/// Mountains of some ten degrees, 30 km from foot to top: far ground matters, and it is smooth at 27 km.
fn height_m(towards: DVec3) -> f64 {
    let [x, y, z] = towards.to_array();
    8000.0 * (7.0 * x + 1.0).sin() * (6.0 * y + 2.0).sin() + 7000.0 * (8.0 * z - 5.0 * x + 0.5).sin()
}

/// The globe turned by an angle about its axis.
fn write(path: &Path, turned_rad: f64) {
    let (sin, cos) = turned_rad.sin_cos();
    write_globe(path, &|p| height_m(DVec3::new(cos * p.x + sin * p.y, cos * p.y - sin * p.x, p.z)));
}

/// A globe of heights by direction.
pub(super) fn write_globe(path: &Path, height_m: &dyn Fn(DVec3) -> f64) {
    let (columns, rows) = (360 * PIXELS_PER_DEGREE, 180 * PIXELS_PER_DEGREE);
    let pixel_rad = PI / rows as f64;
    let value = |index: usize| {
        let longitude_rad = (index % columns) as f64 * pixel_rad + 0.5 * pixel_rad - PI;
        let latitude_rad = PI / 2.0 - ((index / columns) as f64 + 0.5) * pixel_rad;
        let (sin, cos) = longitude_rad.sin_cos();
        height_m(DVec3::new(latitude_rad.cos() * cos, latitude_rad.cos() * sin, latitude_rad.sin())) as f32
    };
    let values: Vec<f32> = (0..columns * rows).map(value).collect();
    let radius_m = Body::moon().equatorial_radius_m;
    let (half_m, pixel_m) = (PI * radius_m, pixel_rad * radius_m);
    let geotransform = [-half_m, pixel_m, 0.0, half_m / 2.0, 0.0, -pixel_m];
    let bands = vec![GeoTiffBand { name: "height", unit: "m", values: &values }];
    let crs = "+proj=eqc +R=1737400 +units=m +no_defs";
    GeoTiff { columns, rows, bands, crs, geotransform }.write(path).unwrap();
}

pub(super) fn options(folder: &TempDir, name: &str) -> Options {
    let dem = folder.path().join("globe.tif");
    if !dem.exists() {
        write(&dem, 0.0);
    }
    Options {
        dem,
        values: Values::Height,
        posting_m: Some(28_000.0),
        cells: 32,
        margin: 8,
        settings: Settings { azimuths: 40, ..Settings::default() },
        encoding: Encoding::F16,
        directory: folder.path().join(name),
        memory: Memory::default(),
        tiles: Vec::new(),
        checks: 0,
    }
}

/// Of the Moon's size, with mountains that the Moon itself has not.
pub(super) fn body() -> Body {
    Body { naif_id: 0, ..Body::moon() }
}

pub(super) fn run(options: &Options) -> Report {
    build(&body(), options, &Silent).unwrap()
}

fn open(options: &Options) -> Globe {
    Globe::open(&body(), options, &Silent).unwrap()
}

fn files(options: &Options) -> Vec<PathBuf> {
    let index = index::Index::read(&options.directory.join(index::FILE)).unwrap().unwrap();
    index.tiles.iter().map(|tile| options.directory.join(&tile.file)).collect()
}

fn map(globe: &Globe, tile: TileId) -> HorizonMap {
    globe.read(tile).unwrap().1
}

/// Poles, cube edges and corners, the antimeridian and random places, against traces over the full resolution.
#[test]
fn the_whole_sphere_is_built_and_errs_as_far_as_it_says() {
    let folder = tempfile::tempdir().unwrap();
    let report = run(&Options { checks: 40, ..options(&folder, "whole") });
    assert_eq!((report.built, report.kept, report.index.tiles.len()), (126, 0, 126));
    assert_eq!(report.index.plan.levels, 3);
    // 30 km of relief: acos(1722/1752) of 10.6°.
    assert!((report.index.plan.reach_m - 320_000.0).abs() < 20_000.0, "{}", report.index.plan.reach_m);
    let checks = report.index.checks.unwrap();
    assert!(checks.places > 60, "{checks:?}");
    // Eight nodes of 27 km around a tile, then means of 54 km: half a degree of arc in mountains of ten degrees.
    assert!(checks.coarsening.p95_rad.to_degrees() < 0.05, "{checks:?}");
    assert!(checks.coarsening.max_rad > 0.0, "coarse levels make a difference, or none was tested");
    // 16 harmonics of smooth skylines.
    assert!(checks.decoded.p95_rad.to_degrees() < 0.3, "{checks:?}");
    for tile in &report.index.tiles {
        assert!(tile.errors.swept.p95_rad.to_degrees() < 0.03, "{tile:?}");
    }
}

/// Half a turn takes face 0 to face 5, whose middle is the antimeridian and the raster's seam.
#[test]
fn the_antimeridian_is_a_place_like_any_other() {
    let folder = tempfile::tempdir().unwrap();
    let here = Options { tiles: vec!["0/2".parse().unwrap()], ..options(&folder, "here") };
    run(&here);
    let there = Options { dem: folder.path().join("turned.tif"), tiles: vec!["5/2".parse().unwrap()], ..here.clone() };
    let there = Options { directory: folder.path().join("there"), ..there };
    write(&there.dem, PI);
    run(&there);
    let (here, there) = (open(&here), open(&there));
    for tile in here.tree.tiles().filter(|tile| tile.face == 0 && tile.level == 2) {
        let (a, b) = (map(&here, tile), map(&there, TileId { face: 5, ..tile }));
        for node in [DVec2::ZERO, DVec2::new(32.0, 5.0), DVec2::new(16.0, 32.0)] {
            for azimuth in [0.1, 1.7, 4.0] {
                let apart_rad = a.horizon(node).evaluate_towards(direction(azimuth)).0
                    - b.horizon(node).evaluate_towards(direction(azimuth)).0;
                // Half floats of rounded heights.
                assert!(apart_rad.abs() < 3e-4, "{tile} {node} {azimuth}: {apart_rad}");
            }
        }
    }
}

/// On the nodes that tiles share, within a face and across the cube's edges, in true directions.
#[test]
fn neighbours_agree_on_their_common_border_nodes() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options { tiles: vec!["*/2".parse().unwrap()], ..options(&folder, "borders") };
    run(&options);
    let globe = open(&options);
    let cells = globe.tree.cells as f64;
    let (mut within_rad, mut across_rad) = (Vec::new(), Vec::new());
    for tile in globe.tree.tiles().filter(|tile| tile.level == 2) {
        for (step, outwards) in [(4.0, DVec2::X), (11.0, DVec2::Y), (25.0, DVec2::X), (30.0, DVec2::Y)] {
            let node = outwards * cells + (DVec2::ONE - outwards) * step;
            let beyond = globe.tree.body.position_from_geodetic(globe.tree.place(tile, node + 1e-3 * outwards));
            let (other, _) = globe.tree.find(2, beyond);
            let place = globe.tree.body.position_from_geodetic(globe.tree.place(tile, node)).vector_m();
            for azimuth in 0..12 {
                let (sin, cos) = (f64::from(azimuth) * PI / 6.0).sin_cos();
                let (east, north) = place.normalize().any_orthonormal_pair();
                let towards = Direction::new(sin * east + cos * north).unwrap();
                let [a, b] = [tile, other].map(|tile| {
                    let face = &globe.tree.maps[tile.face];
                    let p = face.map_vector(Position::from_m(place));
                    let at_m = p.truncate() * (face.radius_m / p.z);
                    let corner_m = globe.tree.node_m(tile, DVec2::ZERO);
                    let grid = (at_m - corner_m) / globe.tree.posting_m(2);
                    let direction = face.map_direction(at_m, face.map_from_body * towards).normalize();
                    map(&globe, tile).horizon(grid.round()).evaluate_towards(direction).0
                });
                if tile.face == other.face { &mut within_rad } else { &mut across_rad }.push(a - b);
            }
        }
    }
    let (within, across) = (ErrorStatistics::of(within_rad), ErrorStatistics::of(across_rad));
    assert!(within.samples > 1000 && across.samples > 500, "{within:?} {across:?}");
    // On a face the ground within eight nodes is the same, and the series are: what is left are the far levels.
    assert!(within.p95_rad.to_degrees() < 0.03 && within.max_rad.to_degrees() < 0.5, "{within:?}");
    // Across an edge two lattices meet and azimuths are counted differently: resampling and truncation come on top.
    assert!(across.p95_rad.to_degrees() < 0.3, "{across:?}");
}

#[test]
fn a_tile_depends_neither_on_the_tiling_nor_on_the_tiles_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let alone = Options { tiles: vec!["2/2/1/2".parse().unwrap()], ..options(&folder, "alone") };
    let four =
        Options { tiles: vec!["2/2/0-1/2-3".parse().unwrap()], memory: Memory::mib(0), ..options(&folder, "four") };
    let wide = Options { cells: 64, tiles: vec!["2/1/0/1".parse().unwrap()], ..options(&folder, "wide") };
    for options in [&alone, &four, &wide] {
        run(options);
    }
    let tile = TileId { level: 2, face: 2, column: 1, row: 2 };
    let bytes = |options: &Options| fs::read(options.directory.join(index::file_of(tile))).unwrap();
    assert!(bytes(&alone) == bytes(&four), "not a byte differs, whatever else is built and with how little memory");

    // The same nodes in a tile of twice the width, which sees twice as far at the full resolution.
    let small = map(&open(&alone), tile);
    let large = map(&open(&wide), TileId { level: 1, face: 2, column: 0, row: 1 });
    let mut errors_rad = Vec::new();
    for node in (0..33 * 33).map(|i| DVec2::new(f64::from(i % 33), f64::from(i / 33))) {
        let [a, b] = [small.horizon(node), large.horizon(node + DVec2::new(32.0, 0.0))];
        errors_rad.extend(
            (0..8)
                .map(f64::from)
                .map(|azimuth| a.evaluate_towards(direction(azimuth)).0 - b.evaluate_towards(direction(azimuth)).0),
        );
    }
    let apart = ErrorStatistics::of(errors_rad);
    assert!(apart.p95_rad.to_degrees() < 0.05 && apart.max_rad.to_degrees() < 0.5, "{apart:?}");
}

#[test]
fn a_run_that_was_stopped_goes_on_and_another_plan_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options { tiles: vec!["1/0-1".parse().unwrap()], ..options(&folder, "stopped") };
    assert_eq!(run(&options).built, 5);
    let before: Vec<_> = files(&options).iter().map(|file| fs::read(file).unwrap()).collect();
    let all = files(&options);
    fs::remove_file(&all[1]).unwrap();
    fs::write(&all[3], &before[3][..before[3].len() / 2]).unwrap();
    let again = run(&options);
    assert_eq!((again.built, again.kept), (2, 3));
    assert!(files(&options).iter().zip(&before).all(|(file, before)| fs::read(file).unwrap() == *before));
    for file in &all {
        assert!(store::read(file).is_ok());
    }

    let other = Options { settings: Settings { azimuths: 48, ..options.settings }, ..options.clone() };
    let error = build(&body(), &other, &Silent).unwrap_err();
    assert!(matches!(error, Error::OtherGlobe { .. }) && error.to_string().contains("settings"), "{error}");
    let none = Options { tiles: vec!["0/9".parse().unwrap()], ..options };
    assert!(matches!(build(&body(), &none, &Silent), Err(Error::NoTiles { levels: 3 })));
}
