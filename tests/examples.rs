//! The programs of `examples/`, run as they are.

use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

/// What an example prints; it writes into `folder`.
fn run(name: &str, folder: &Path) -> String {
    // Cargo puts examples beside the folder of the tests.
    let tests = std::env::current_exe().unwrap();
    let program = tests.ancestors().nth(2).unwrap().join("examples").join(name);
    assert!(program.is_file(), "{} is not built: `cargo test` without --test builds it", program.display());
    let output = Command::new(program).arg(folder).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn every_example_is_run_here() {
    let here = include_str!("examples.rs");
    for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")).unwrap() {
        let name = PathBuf::from(entry.unwrap().file_name()).with_extension("");
        assert!(here.contains(&format!("run(\"{}\"", name.display())), "{}", name.display());
    }
}

#[test]
fn one_image_has_its_planes_and_is_written() {
    let folder = TempDir::new().unwrap();
    let told = run("one_image", folder.path());
    assert!(["RADIANCE: mean", "SUN_FRACTION: mean", "RANGE: mean"].iter().all(|plane| told.contains(plane)), "{told}");
    assert!(folder.path().join("one_image.exr").is_file());
}

#[test]
fn a_tile_of_horizons_is_built_and_asked() {
    let folder = TempDir::new().unwrap();
    let told = run("horizon_tile", folder.path());
    assert!(told.contains("257 × 257 nodes at 20 m") && told.lines().count() == 14, "{told}");
}

/// The Moon's axis leans by 1.54°: at 89.45° S the Sun stays between −2.1° and 2.1° and comes near both within a year.
#[test]
fn the_sun_over_a_year_stays_within_the_lean_of_the_axis() {
    let folder = TempDir::new().unwrap();
    let told = run("sun_over_a_year", folder.path());
    let elevation = |line: &str| line.split(',').nth(2).unwrap().parse::<f64>().unwrap();
    let elevations_deg: Vec<f64> = told.lines().skip(1).map(elevation).collect();
    assert_eq!(elevations_deg.len(), 365);
    let most = elevations_deg.iter().fold(0.0f64, |most, elevation| most.max(elevation.abs()));
    assert!((1.7..2.15).contains(&most), "{most}");
}

#[test]
fn a_moving_camera_comes_nearer() {
    let folder = TempDir::new().unwrap();
    let told = run("moving_camera", folder.path());
    let distance = |line: &str| line.split(' ').nth(2).unwrap().parse::<f64>().unwrap();
    let distances_m: Vec<f64> = told.lines().map(distance).collect();
    assert!(distances_m.len() == 8 && distances_m.windows(2).all(|pair| pair[1] < pair[0]), "{told}");
    assert!(folder.path().join("moving_camera_7.exr").is_file());
}
