//! `sim horizon` as a user runs it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use perilune_engine::horizon::store;
use serde_json::Value;
use tempfile::TempDir;

fn sim(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sim")).args(arguments).current_dir(folder).output().unwrap()
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let output = sim(folder, &[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// `ridge.tif` of 96 × 80 pixels at 89° south and its tile.
fn ridge() -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let size = ["--columns", "96", "--rows", "80", "--at", "-89,20"];
    assert!(sim(folder.path(), &[&["terrain", "-o", "ridge.tif"][..], &size].concat()).status.success());
    let built = json(folder.path(), &["horizon", "ridge.tif", "-o", "tiles", "--azimuths", "72"]);
    let tile = folder.path().join(built[0]["tile"].as_str().unwrap());
    assert_eq!((built[0]["columns"].as_u64(), built[0]["rows"].as_u64()), (Some(96), Some(80)));
    assert!(built[0]["samples_per_s"].as_f64().unwrap() > 0.0);
    let again = json(folder.path(), &["horizon", "ridge.tif", "-o", "tiles", "--azimuths", "72"]);
    assert_eq!((&again[0]["built_s"], &again[0]["decoded_error_deg"]), (&Value::Null, &built[0]["decoded_error_deg"]));
    (folder, tile)
}

/// The whole process, of which a full GDAL and what it keeps are 65 MiB.
#[test]
fn a_tile_of_1024_nodes_a_side_is_built_within_100_mib() {
    let folder = TempDir::new().unwrap();
    let size = ["--columns", "1024", "--rows", "1024", "--largest", "2000", "--smallest", "400"];
    assert!(sim(folder.path(), &[&["terrain", "-o", "wide.tif"][..], &size].concat()).status.success());
    let common = ["horizon", "wide.tif", "-o", "tiles", "--azimuths", "34", "--memory", "100"];
    let built = json(folder.path(), &[&common[..], &["--encoding", "fm16"]].concat());
    let peak_mib = built[0]["peak_memory_mib"].as_f64().unwrap();
    assert!(peak_mib <= 100.0, "{peak_mib} MiB");
}

#[test]
fn a_tile_is_verified_against_its_dem_and_no_other() {
    let (folder, tile) = ridge();
    let name = tile.to_str().unwrap();
    let verified = json(folder.path(), &["horizon", "verify", name, "ridge.tif", "--seed", "7"]);
    assert_eq!((&verified["repeats"], &verified["agrees"]), (&Value::Bool(true), &Value::Bool(true)), "{verified}");
    assert_eq!(verified["stated_error_deg"], verified["repeated_error_deg"]);

    sim(folder.path(), &["terrain", "-o", "other.tif", "--columns", "96", "--rows", "80", "--seed", "2"]);
    let output = sim(folder.path(), &["horizon", "verify", name, "other.tif"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(said.lines().count() == 1 && said.contains("was made from other heights"), "{said}");
}

/// A header that flatters its tile, and a tile whose coefficients were damaged.
#[test]
fn a_tile_that_does_not_err_as_it_says_fails() {
    let (folder, tile) = ridge();
    let (header, map) = store::read(&tile).unwrap();
    let fails = |header: &perilune_engine::horizon::header::Header,
                 map: &perilune_engine::horizon::HorizonMap,
                 figure: &str| {
        store::write(&tile, header, map).unwrap();
        let output = sim(folder.path(), &["horizon", "verify", tile.to_str().unwrap(), "ridge.tif"]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(said.lines().count() == 1 && said.contains("that its own nodes do not have"), "{said}");
        assert!(said.contains(figure), "{said}");
        output.status.code() == Some(1)
    };
    let mut flattering = header.clone();
    flattering.errors.decoded.rms_rad *= 0.9;
    assert!(fails(&flattering, &map, "rms is stated as"));
    let mut damaged = map.clone();
    damaged.levels[0].words.chunks_mut(4).for_each(|texel| texel[1] ^= 0x8000);
    assert!(fails(&header, &damaged, "rms is stated as"));
    let mut narrow = map.clone();
    narrow.bounds.codes.iter_mut().for_each(|code| *code -= 16);
    assert!(fails(&header, &narrow, "nodes beyond their bound is stated as"));
}

/// At 20° east on a polar map turned to the DEM the true and the map azimuth differ; the skyline is one.
#[test]
fn a_skyline_is_decoded_and_traced_at_true_azimuths() {
    let (folder, tile) = ridge();
    let name = tile.to_str().unwrap();
    let query = ["horizon", "query", name, "ridge.tif", "--at", "-89,20", "--azimuth-step", "30"];
    let rows = json(folder.path(), &[&query[..], &["--plot", "skyline.svg"]].concat());
    let rows = rows.as_array().unwrap();
    assert_eq!(rows.len(), 12);
    let number = |row: &Value, key: &str| row[key].as_f64().unwrap();
    for (index, row) in rows.iter().enumerate() {
        assert_eq!(number(row, "azimuth_deg"), 30.0 * index as f64);
        let error_deg = number(row, "decoded_deg") - number(row, "traced_deg");
        // Sixteen coefficients do not follow a cliff; a turned or mirrored skyline would be off by tens of degrees.
        assert!(error_deg.abs() < 5.0, "{row}");
        assert_eq!(row["bound_deg"], rows[0]["bound_deg"]);
    }
    // The map lies about the place itself, so both azimuths differ by one angle.
    let turn = |row: &Value| (number(row, "map_azimuth_deg") - number(row, "azimuth_deg")).rem_euclid(360.0);
    assert!(rows.iter().all(|row| (turn(row) - turn(&rows[0]) + 180.0).rem_euclid(360.0) - 180.0 < 0.1));
    let svg = std::fs::read_to_string(folder.path().join("skyline.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.matches("<polyline").count() == 2);

    // Without the DEM nothing is traced.
    let alone = json(folder.path(), &["horizon", "query", name, "--at", "-89,20", "--azimuth-step", "30"]);
    assert_eq!((&alone[3]["decoded_deg"], &alone[3]["traced_deg"]), (&rows[3]["decoded_deg"], &Value::Null));
    assert_eq!(svg.matches("<polygon").count(), 1, "the bound");

    let outside = sim(folder.path(), &["horizon", "query", name, "--at", "10,0"]);
    let said = String::from_utf8(outside.stderr).unwrap();
    assert!(outside.status.code() == Some(1) && said.contains("--at 10.000000,0.000000 lies outside"), "{said}");
}

#[test]
fn a_whole_body_becomes_six_tiles() {
    let folder = TempDir::new().unwrap();
    let heights: Vec<f32> = (0..72 * 36).map(|pixel| (pixel * 37 % 1000) as f32).collect();
    let bands = vec![perilune_engine::raster::GeoTiffBand { name: "height", unit: "m", values: &heights }];
    let metres = 1_737_400.0 * std::f64::consts::PI / 36.0;
    let crs = "+proj=eqc +R=1737400 +units=m +no_defs";
    let geotransform = [-36.0 * metres, metres, 0.0, 18.0 * metres, 0.0, -metres];
    let globe = perilune_engine::raster::GeoTiff { columns: 72, rows: 36, bands, crs, geotransform };
    globe.write(&folder.path().join("globe.tif")).unwrap();
    let built = json(
        folder.path(),
        &["horizon", "globe.tif", "-o", "tiles", "--cube", "--posting", "100000", "--azimuths", "64"],
    );
    let faces: Vec<_> = built.as_array().unwrap().iter().map(|tile| tile["face"].as_u64().unwrap()).collect();
    assert_eq!(faces, [0, 1, 2, 3, 4, 5]);
}

#[test]
fn wrong_arguments_are_refused() {
    let folder = TempDir::new().unwrap();
    let code = |arguments: &[&str]| sim(folder.path(), arguments).status.code();
    assert_eq!(code(&["horizon"]), Some(2));
    assert_eq!(code(&["horizon", "dem.tif"]), Some(2));
    assert_eq!(code(&["horizon", "verify"]), Some(2));
    assert_eq!(code(&["horizon", "query", "a.tif", "--at", "0,0", "--plot", "a.png"]), Some(2));
    assert_eq!(code(&["horizon", "dem.tif", "-o", "tiles"]), Some(1));
    assert_eq!(code(&["horizon", "query", "a.tif", "--at", "0,0"]), Some(1));
}
