//! Small tiles whose skylines are known, read by this program and by one that shares no line with it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use glam::DVec2;
use perilune_engine::geometry::{Body, Geodetic};
use perilune_engine::horizon::{Encoding, HorizonMap, Request, Settings, build, store};
use perilune_engine::terrain::{Face, Gnomonic, Level};

/// Points of a CSV file, in nodes; fractions lie between texels of every scale.
const POINTS: [[f64; 2]; 9] =
    [[0.0, 0.0], [10.0, 0.0], [0.0, 8.0], [10.0, 8.0], [5.0, 4.0], [3.0, 7.0], [0.25, 3.5], [7.75, 6.5], [9.5, 0.125]];
/// Degrees: cardinal, swept, and between.
const AZIMUTHS_DEG: [f64; 6] = [0.0, 90.0, 123.0, 201.7, 270.0, 359.0];
const HEADER: &str = "x,y,azimuth_deg,elevation_rad,bound_rad";

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors")
}

fn vectors() -> Vec<PathBuf> {
    let entries = fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let mut tiles: Vec<_> =
        entries.filter(|path| path.extension().is_some_and(|extension| extension == "tif")).collect();
    tiles.sort();
    assert!(tiles.len() >= 5, "{tiles:?}");
    tiles
}

/// One row a point and azimuth, as numbers; the bound is missing where nothing is known.
fn rows(map: &HorizonMap) -> Vec<([f64; 4], Option<f64>)> {
    let row = |[x, y]: [f64; 2], azimuth_deg: f64| {
        let at = DVec2::new(x, y);
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        let elevation_rad = map.horizon(at).evaluate_towards(DVec2::new(sin, cos)).0;
        ([x, y, azimuth_deg, elevation_rad], map.bound_rad(at))
    };
    POINTS.into_iter().flat_map(|point| AZIMUTHS_DEG.map(|azimuth_deg| row(point, azimuth_deg))).collect()
}

#[test]
fn committed_tiles_decode_to_the_skylines_beside_them() {
    for tile in vectors() {
        let (_, map) = store::read(&tile).unwrap();
        let text = fs::read_to_string(tile.with_extension("csv")).unwrap();
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some(HEADER));
        for ((numbers, bound_rad), line) in rows(&map).into_iter().zip(lines.by_ref()) {
            let expected: Vec<Option<f64>> = line.split(',').map(|number| number.parse().ok()).collect();
            let expected_numbers: Vec<f64> = expected[..4].iter().map(|number| number.unwrap()).collect();
            assert_eq!(numbers[..3], expected_numbers[..3], "{}", tile.display());
            // Double precision, other orders of summation.
            assert!((numbers[3] - expected_numbers[3]).abs() < 1e-9, "{}: {line} not {numbers:?}", tile.display());
            assert!(bound_rad.zip(expected[4]).is_none_or(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{line}");
            assert_eq!(bound_rad.is_some(), expected[4].is_some(), "{line}");
        }
        assert_eq!(lines.next(), None);
    }
}

/// `decode.py` was written from the specification and knows none of this program's code.
#[test]
fn a_stranger_reads_the_same_skylines() {
    let decode = |tile: &Path, expected: &Path| {
        Command::new("python3").arg(folder().join("decode.py")).args([tile, expected]).output()
    };
    let tiles = vectors();
    if Command::new("python3").arg("--version").output().is_err() {
        println!("skipped: no python3");
        return;
    }
    for tile in &tiles {
        let output = decode(tile, &tile.with_extension("csv")).unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    // Another tile's skylines are refused.
    assert!(!decode(&tiles[0], &tiles[1].with_extension("csv")).unwrap().status.success());
}

/// After a change of the format: `cargo test --release make_vectors -- --ignored`.
#[test]
#[ignore = "writes tests/vectors"]
fn make_vectors() {
    let encodings = [Encoding::Fm16, Encoding::F8, Encoding::Raw8, Encoding::W16, Encoding::Q];
    let (body, face) = (Body::moon(), bumps());
    let tiles = tempfile::tempdir().unwrap();
    for encoding in encodings {
        // Twice the 47th harmonic and more.
        let settings = Settings { azimuths: 96, ..Settings::default() };
        let request = Request { body: &body, face: &face, level: 0, settings, encoding };
        let map = build(&request, tiles.path(), &|_, _| ()).unwrap();
        let name = folder().join(format!("{encoding:?}.tif").to_lowercase());
        fs::copy(store::path_for(tiles.path(), &request.key()), &name).unwrap();
        let mut text = format!("{HEADER}\n");
        for ([x, y, azimuth_deg, elevation_rad], bound_rad) in rows(&map) {
            let bound_rad = bound_rad.map_or(String::new(), |bound_rad| bound_rad.to_string());
            text += &format!("{x},{y},{azimuth_deg},{elevation_rad},{bound_rad}\n");
        }
        fs::write(name.with_extension("csv"), text).unwrap();
    }
}

/// Hills of some 100 m about 45° north, with a gap at one corner.
fn bumps() -> Face {
    let map = Gnomonic::about(&Body::moon(), Geodetic::from_degrees(45.0, 30.0, 0.0));
    let (columns, rows, posting_m) = (11, 9, 100.0);
    let heights_m = vec![0.0; columns * rows];
    let gap = (0..columns * rows).map(|node| node == columns * rows - 1).collect();
    let mut level = Level { columns, rows, posting_m, west_m: -300.0, south_m: -500.0, heights_m, gap, margin: 0 };
    for node in 0..columns * rows {
        let (x, y) = ((node % columns) as f64, (node / columns) as f64);
        let height_m = 60.0 * (1.3 * x).sin() * (0.9 * y + 0.4).cos() + 40.0 * (2.1 * y - 0.7 * x).sin();
        let at_m = level.node_m(node % columns, node / columns);
        level.heights_m[node] = map.lifted_height_m(at_m, map.radius_m + height_m) as f32;
    }
    Face { map, levels: vec![level] }
}
