//! `sim terrain` as a user runs it.

use std::process::{Command, Output};

use perilune_engine::geometry::Body;
use perilune_engine::raster::{self, Dem, Options};

fn sim(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sim")).args(arguments).output().unwrap()
}

#[test]
fn a_terrain_is_written_with_its_craters_and_named_in_json() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.tif");
    let name = path.to_str().unwrap();
    for projection in ["gnomonic", "polar-stereographic", "equirectangular", "orthographic"] {
        let size = ["--columns", "200", "--rows", "120", "--posting", "10", "--at", "-60.5,20", "--json"];
        let output = sim(&[&["terrain", "-o", name, "--projection", projection][..], &size].concat());
        assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(json["sha256"], raster::digest(&path).unwrap());

        let dem = Dem::open(&path, &Body::moon(), &Options::default()).unwrap();
        assert_eq!((dem.columns, dem.rows), (200, 120));
        let middle = dem.georeference.projector().unwrap().geodetics(&[glam::DVec2::new(99.5, 59.5)])[0];
        assert!((middle.latitude_rad.to_degrees() + 60.5).abs() < 1e-6, "{projection} {middle:?}");
        assert!((middle.longitude_east_rad.to_degrees() - 20.0).abs() < 1e-6, "{projection} {middle:?}");
        let table = std::fs::read_to_string(path.with_extension("craters.csv")).unwrap();
        assert_eq!(table.lines().count() as u64, 1 + json["crater_count"].as_u64().unwrap());
    }
}

#[test]
fn bad_arguments_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("no/such/folder/t.tif");
    let output = sim(&["terrain", "-o", path.to_str().unwrap(), "--columns", "64", "--rows", "64"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && message.starts_with("error: ") && message.lines().count() == 1, "{message}");
    assert!(message.contains("no/such/folder"), "{message}");
    assert!(!sim(&["terrain", "-o", "t.tif", "--at", "91,0"]).status.success());
    assert!(!sim(&["terrain", "-o", "t.tif", "--columns", "1"]).status.success());
}
