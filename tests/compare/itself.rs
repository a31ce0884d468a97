//! A render held against itself, and albedo maps that hold the photograph.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use perilune_engine::raster::{GeoTiff, GeoTiffBand};

use crate::cli::run::{Run, SMALL};

fn rendered() -> Run {
    let scenario = SMALL.replace("planes: [radiance, sun_fraction, depth, dem_gap]", "planes: [radiance], tiff: true");
    let run = Run::of(&scenario);
    run.succeed(&["--frames", "0..1"]);
    run
}

fn compare(run: &Run, photo: &Path, more: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sim"));
    command.arg("compare").arg(photo).arg("--geometry").arg(run.path("small.ron"));
    command.arg("--output").arg(run.path("report")).arg("--cache").arg(run.path("cache")).args(["--adapter", "cpu"]);
    command.args(more).output().unwrap()
}

fn tiff(run: &Run) -> PathBuf {
    let files = std::fs::read_dir(run.path("out")).unwrap().map(|entry| entry.unwrap().path());
    let tiffs =
        files.filter(|path| path.extension().is_some_and(|extension| extension == "tif" || extension == "tiff"));
    tiffs.into_iter().next().expect("the run wrote a TIFF")
}

/// An even map of 100 km about the pole that says `source`.
fn albedo_map(path: &Path, source: &str) {
    const SIDE: usize = 64;
    let (values, posting_m) = (vec![0.12; SIDE * SIDE], 100_000.0 / SIDE as f64);
    GeoTiff {
        columns: SIDE,
        rows: SIDE,
        bands: vec![GeoTiffBand { name: source, unit: "1", values: &values }],
        crs: "+proj=stere +lat_0=-90 +lon_0=0 +R=1737400 +units=m +no_defs",
        geotransform: [-50_000.0, posting_m, 0.0, 50_000.0, 0.0, -posting_m],
    }
    .write(path)
    .unwrap();
}

#[test]
fn a_render_compared_with_itself_differs_by_exactly_nothing() {
    let run = rendered();
    let output = compare(&run, &tiff(&run), &["--fit", "none", "--json", "--no-ablation"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for pointer in [
        "/numbers/rms",
        "/numbers/residual_sigma",
        "/numbers/flip",
        "/registration/motion/shift_px/0",
        "/registration/motion/shift_px/1",
        "/registration/motion/rotation_rad",
        "/registration/motion/scale",
        "/registration/sigma/scale",
    ] {
        assert_eq!(json.pointer(pointer).unwrap(), 0.0, "{pointer}");
    }
    assert_eq!(json.pointer("/fair").unwrap(), true);
    for file in ["compare.html", "compare.json", "compare.photograph.png", "compare.difference.png"] {
        assert!(run.path("report").join(file).is_file(), "{file}");
    }
}

/// The photograph itself as albedo, by content, is refused before any work; forced, the first line says so.
#[test]
fn an_albedo_map_that_is_the_photograph_is_refused() {
    let run = rendered();
    let copy = run.path("map.tif");
    std::fs::copy(tiff(&run), &copy).unwrap();
    let output = compare(&run, &tiff(&run), &["--albedo", copy.to_str().unwrap()]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        !output.status.success() && message.contains("it is the same file") && message.contains("--force"),
        "{message}"
    );
    assert!(!run.path("report").exists());
}

/// A map under another name that says in its metadata that it was made from the photograph.
#[test]
fn a_forced_albedo_map_is_said_in_the_first_line() {
    let run = rendered();
    let photo = run.path("M1234567.tif");
    std::fs::copy(tiff(&run), &photo).unwrap();
    let map = run.path("map.tif");
    albedo_map(&map, "mosaic of M1234567 and others");
    let arguments = ["--albedo", map.to_str().unwrap(), "--no-ablation"];
    let refused = compare(&run, &photo, &arguments);
    let message = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(!refused.status.success() && message.contains("names m1234567"), "{message}");
    let output = compare(&run, &photo, &[&arguments[..], &["--force"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let said = "NOT A FAIR COMPARISON (forced): the albedo map holds the compared photograph";
    assert!(text.lines().next().unwrap().starts_with(said), "{text}");
    let html = std::fs::read_to_string(run.path("report/compare.html")).unwrap();
    let first = html.split("<p>").nth(1).unwrap();
    assert!(first.starts_with(said), "{first}");
    let json = std::fs::read_to_string(run.path("report/compare.json")).unwrap();
    assert!(json.contains("\"fair\": false"));
}

#[test]
fn a_photograph_of_another_size_is_refused() {
    let run = rendered();
    let other = run.path("other.png");
    image::GrayImage::from_pixel(50, 40, image::Luma([9])).save(&other).unwrap();
    let output = compare(&run, &other, &[]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("has 50 x 40 pixels, its geometry is for 64 x 64"), "{message}");
    let output = compare(&run, &tiff(&run), &["--image", "9"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("--image 9 names no exposure") && message.contains("4, counted from 0"), "{message}");
}
