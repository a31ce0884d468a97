//! What `sim check` tells of a scenario, and what it and `sim run` warn of.

use std::process::{Command, Output};

use serde_json::Value as Json;

use super::run::{Run, SMALL};
use crate::fixtures;

fn check(run: &Run, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sim"));
    command.arg("check").arg(run.path("small.ron")).arg("--cache").arg(run.path("cache")).args(arguments);
    command.output().unwrap()
}

fn json(run: &Run) -> Json {
    let output = check(run, &["--json"]);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)))
}

fn warnings(report: &Json) -> String {
    report["warnings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|warning| warning.as_str().unwrap())
        .collect::<Vec<_>>()
        .join("\n")
}

fn pair(value: &Json) -> [f64; 2] {
    [value[0].as_f64().unwrap(), value[1].as_f64().unwrap()]
}

/// A sphere seen from above: a pixel is height/focal length, a waypoint is as high as it says.
#[test]
fn facts_of_a_flat_scene_are_those_of_its_geometry() {
    let run = Run::of(SMALL);
    let facts = &json(&run)["facts"];
    let [low_m, high_m] = pair(&facts["view"]["height_above_ground_m"]);
    assert!((low_m - 900.0).abs() < 1.0 && (high_m - 1500.0).abs() < 1.0, "{facts}");
    // 64 pixels of 40°: the middle one is height · 2 tan 20° / 64 wide; at θ from it a pixel that faces the camera is √cos θ as wide,
    // 0.94 in the corners.
    let [least_m, greatest_m] = pair(&facts["view"]["pixel_m"]);
    let middle_m = |height_m: f64| height_m * 2.0 * 20_f64.to_radians().tan() / 64.0;
    assert!((0.94..0.97).contains(&(least_m / middle_m(900.0))), "{least_m}");
    assert!((greatest_m / middle_m(1500.0) - 1.0).abs() < 0.01, "{greatest_m}");
    assert_eq!(pair(&facts["view"]["share_on_models"]), [1.0, 1.0]);
    let model = &facts["models"][0];
    let [south, north] = pair(&model["extent"]["latitude_deg"]);
    // 128 nodes of 20 m: 1280 m to each side of 89° S, 0.0422°.
    assert!((south + 89.0422).abs() < 2e-3 && (north + 88.9578).abs() < 2e-3, "{model}");
    assert_eq!((model["columns"].as_u64(), facts["cost"]["images"].as_u64()), (Some(128), Some(4)));
}

/// The Sun by `sim sun`, another path through the program; heights by the table of the made terrain.
#[test]
fn the_suns_place_and_the_terrains_heights_are_those_of_other_commands() {
    let run = Run::of(SMALL);
    run.succeed(&["--frames", "0..1"]);
    let facts = json(&run)["facts"].clone();
    let sun = Command::new(env!("CARGO_BIN_EXE_sim"))
        .args(["sun", "--at", "-89,0", "--epoch", "2026-11-06T00:00:00Z", "--json"])
        .output()
        .unwrap();
    let sun: Json = serde_json::from_slice(&sun.stdout).unwrap();
    let expected = sun["sun_elevation_deg"].as_f64().unwrap();
    let [low, high] = pair(&facts["sun"]["elevation_deg"]);
    assert!(low - 0.05 < expected && expected < high + 0.05, "{low} to {high}, sim sun has {expected}");
    let [low_m, high_m] = pair(&facts["models"][0]["heights_m"]);
    assert!(low_m < high_m && high_m < 2000.0, "{facts}");
    // The synthetic terrain is there now.
    let text = String::from_utf8(check(&run, &[]).stdout).unwrap();
    for part in ["elevation models", "heights ", "camera", "Sun", "shadows", "cost", "memory", "disk"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

/// How the small scenario is changed, and what is then warned of.
const WARNED: [(&str, &str, &str); 6] = [
    ("2026-11-06", "2026-06-01", "the Sun is below the horizon"),
    (
        "latitude_deg: -88.99, longitude_deg: 0",
        "latitude_deg: 45, longitude_deg: 20",
        "sees nothing of the elevation models",
    ),
    (
        "pointing: (towards: Nadir)",
        "pointing: (towards: At(latitude_deg: -88.9, longitude_deg: 0, height_m: 1000000))",
        "looks past the body",
    ),
    (
        "camera: (",
        "detector: (quantum_efficiency: 0.5, gain_e_per_dn: 1, full_well_e: 100, bits: 12), camera: (band_nm: (450, 850), exposure_s: 10, ",
        "of the pixels are saturated",
    ),
    (
        "camera: (",
        "detector: (quantum_efficiency: 0.5, full_well_e: 100000, gain_e_per_dn: 10000, bits: 12), camera: (band_nm: (450, 850), exposure_s: 1e-7, ",
        "less than a digital number",
    ),
    ("height_m: 1500", "height_m: 1500000000", "looks past the body"),
];

#[test]
fn what_leaves_little_to_see_is_warned_of_before_and_while_it_is_made() {
    for (written, odd, warned) in WARNED {
        let text = SMALL
            .replace(written, odd)
            .replace("field_of_view_deg: 40", "focal_length_mm: 5, pixel_pitch_um: 50")
            .replace("count: 4", "count: 1")
            .replace("        (t_s: 30, latitude_deg: -89, longitude_deg: 0, height_m: 900),\n", "");
        let run = Run::of(&text.replace("shadows: HorizonMaps()", "shadows: Off"));
        let output = check(&run, &[]);
        assert!(output.status.success(), "{odd}: {}", String::from_utf8_lossy(&output.stderr));
        let before = warnings(&json(&run));
        assert!(before.contains(warned) && before.contains("exposure 0"), "{odd}: {before}");
        let strict = check(&run, &["--strict"]);
        assert_eq!(strict.status.code(), Some(1), "{odd}");
        let made = run.sim(&["--json"]);
        let report: Json = serde_json::from_slice(&made.stdout).unwrap();
        let after = warnings(&report);
        assert!(after.contains(warned) || after.contains("black"), "{odd}: {after}");
        let manifest: Json = serde_json::from_slice(&run.files()["manifest.json"]).unwrap();
        assert!(!manifest["exposures"][0]["warnings"].as_array().unwrap().is_empty(), "{odd}");
        let card = String::from_utf8(run.files()["dataset_card.md"].clone()).unwrap();
        assert!(card.contains("1 of 1 images: "), "{odd}: {card}");
    }
}

#[test]
fn a_scenario_without_fault_has_no_warning() {
    let run = Run::of(SMALL);
    assert_eq!(warnings(&json(&run)), "");
    assert!(check(&run, &["--strict"]).status.success());
    let report: Json = serde_json::from_slice(&run.sim(&["--json"]).stdout).unwrap();
    assert_eq!(warnings(&report), "");
    let manifest: Json = serde_json::from_slice(&run.files()["manifest.json"]).unwrap();
    assert!(manifest["exposures"][0].get("warnings").is_none());
}

/// Inputs that people reported to other programs: a model, an albedo map, a pose that the image misses.
#[test]
fn what_the_camera_misses_is_told_with_both_places() {
    for (input, warned) in [
        ("17_dem_elsewhere", "sees nothing of the elevation models, which lie at latitude -80.064 to -79.936"),
        ("10_latts_plus90", "sees nothing of the elevation models"),
        ("49b_mars_sphere_heights", "sees nothing of the elevation models"),
        ("60j_oem_in_metres", "looks past the body"),
        ("30i_albedo_elsewhere", "the albedo map covers nothing of the ground in view and lies at latitude -61.387"),
    ] {
        let Some(path) = fixtures::data(&format!("inputs/{input}/scenario.ron")) else { return };
        let cache = tempfile::tempdir().unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_sim"))
            .arg("check")
            .arg(path)
            .arg("--cache")
            .arg(cache.path())
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        // Where it is refused instead nothing is drawn wrongly either.
        assert!(told.contains(warned) || !output.status.success(), "{input}: {told}");
    }
}
