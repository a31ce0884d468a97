//! The scenarios that ship, and the words of `sim check` and `sim schema`.

use std::path::Path;
use std::process::{Command, Output};

use perilune_engine::scenario::{Dem, HeightAbove, Scenario, SearchPath, Trajectory, resolve};

fn sim(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sim")).args(arguments).output().expect("sim runs")
}

/// A shipped scenario, resolved against a folder in which its files exist, if only by name.
fn shipped(name: &str) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios").join(name);
    let text = std::fs::read_to_string(&path).expect("the scenario ships");
    let data = tempfile::TempDir::new().expect("a folder");
    let ends = [".tif", ".IMG", ".LBL", ".bsp", ".bpc", ".tf", ".tpc", ".epa"];
    for quoted in text.split('"').filter(|quoted| ends.iter().any(|end| quoted.ends_with(end))) {
        let file = data.path().join(quoted);
        std::fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
        std::fs::write(file, "").expect("a file");
    }
    let places = SearchPath { beside: "nowhere".into(), data: vec![data.path().into()] };
    resolve(&path, &text, &places, &|_| None).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_shipped_scenario_is_without_a_problem() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).expect("scenarios/") {
        let name = entry.expect("an entry").file_name().into_string().expect("a plain name");
        // A picture may lie beside its scenario.
        if name.ends_with(".ron") {
            shipped(&name);
            names.push(name);
        }
    }
    for name in ["lunar_descent.ron", "connecting_ridge.ron", "orbit_pass.ron", "full_disc.ron", "mars_gale.ron"] {
        assert!(names.iter().any(|found| found == name), "{name} does not ship");
    }
}

#[test]
fn degrees_millimetres_and_steps_become_radians_metres_and_epochs() {
    let scenario = shipped("lunar_descent.ron");
    assert_eq!(scenario.name, "lunar_descent");
    assert_eq!(scenario.exposures.len(), 24);
    assert_eq!((scenario.exposures[23] - scenario.exposures[0]).to_seconds(), 276.0);
    assert_eq!(scenario.camera.focal_length_px, 1200.0);
    assert_eq!(scenario.camera.principal_point_px, [512.0, 512.0]);
    assert!((scenario.sun.limb_darkening.unwrap().wavelength_m - 550e-9).abs() < 1e-20);
    let Trajectory::Waypoints { points, height_above } = &scenario.trajectory else { panic!("no waypoints") };
    assert_eq!(*height_above, HeightAbove::Terrain);
    assert_eq!(points[5].point.latitude_rad, (-87.00428_f64).to_radians());
    assert_eq!(points[5].epoch, scenario.exposures[23]);
    assert!(matches!(scenario.terrain.unwrap().dems[0], Dem::Synthetic { columns: 513, .. }));
}

/// `½ · 1024 / tan(½ · 147°)`.
#[test]
fn a_field_of_view_sets_the_focal_length() {
    let focal_length_px = shipped("orbit_pass.ron").camera.focal_length_px;
    assert!((focal_length_px - 512.0 / 73.5_f64.to_radians().tan()).abs() < 1e-9, "{focal_length_px}");
}

#[test]
fn check_accepts_the_default_scenario_by_its_bare_name() {
    let output = sim(&["check", "lunar_descent.ron"]);
    assert!(output.status.success());
    assert!(String::from_utf8_lossy(&output.stdout).contains("24 exposures, no problems"));
}

#[test]
fn check_prints_every_problem_and_fails() {
    let folder = tempfile::TempDir::new().expect("a folder");
    let path = folder.path().join("bad.ron");
    std::fs::write(&path, "(\n    title: 3,\n    camra: (),\n)\n").expect("a file");
    let output = sim(&["check", path.to_str().expect("a plain path")]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1));
    for part in [
        "bad.ron:2:12: title = 3 is not text in quotes",
        "bad.ron:3:5: camra is not a key here; did you mean camera?",
        "bad.ron:1:1: trajectory is missing",
    ] {
        assert!(said.contains(part), "{said}");
    }
    let json = sim(&["check", "--json", path.to_str().expect("a plain path")]);
    let report: serde_json::Value = serde_json::from_slice(&json.stdout).expect("JSON");
    assert_eq!(report["problems"].as_array().expect("a list").len(), 5);
    assert_eq!(report["problems"][3]["key"], "title");
    assert_eq!(report["problems"][3]["line"], 2);
}

#[test]
fn a_scenario_that_is_not_there_is_named_with_where_it_was_looked_for() {
    let output = sim(&["check", "nothing.ron"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        said.starts_with("error: no scenario nothing.ron: looked for nothing.ron, scenarios/nothing.ron"),
        "{said}"
    );
}

#[test]
fn schema_prints_the_reference_and_valid_json() {
    assert!(String::from_utf8_lossy(&sim(&["schema"]).stdout).contains("focal_length_mm: number in [1, 10000] mm"));
    let json: serde_json::Value = serde_json::from_slice(&sim(&["schema", "--json"]).stdout).expect("JSON");
    assert_eq!(json["title"], "Spec");
}
