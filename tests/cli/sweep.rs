//! One scenario under many Suns, over many places: one run, one manifest, the same bytes in any number of parts.

use std::process::Command;

use perilune_engine::dataset::{Manifest, Record, read_exr};

use super::run::{Run, SMALL};

fn swept(sweep: &str) -> Run {
    let exposures = SMALL.replace("count: 4", "count: 2");
    let sun = "sun: (fixed: (azimuth_deg: 0, elevation_deg: 30)), surface: (photometry: Lambert), ";
    Run::of(&exposures.replace("outputs:", &format!("{sun} {sweep}, outputs:")))
}

fn manifest(run: &Run) -> Manifest {
    serde_json::from_slice(&std::fs::read(run.path("out/manifest.json")).unwrap()).unwrap()
}

fn record(run: &Run, index: usize) -> Record {
    serde_json::from_slice(&std::fs::read(run.path(&format!("out/exposure_{index:04}.json"))).unwrap()).unwrap()
}

const SUNS: &str = "sweep: (design: LatinHypercube(count: 3, seed: 5), sun_azimuth_deg: Range(from: 0, to: 360), \
                    sun_elevation_deg: Range(from: 5, to: 35)), \
                    split: (train: 0.4, validation: 0.3, test: 0.3, cell_m: 500)";

#[test]
fn every_point_has_its_sun_and_the_manifest_has_the_design() {
    let run = swept(SUNS);
    run.succeed(&[]);
    let manifest = manifest(&run);
    let sweep = &manifest.run.settings["sweep"];
    assert_eq!(sweep["varied"], serde_json::json!(["sun_azimuth_deg", "sun_elevation_deg"]));
    assert_eq!(manifest.exposures.len(), 6);
    for (index, entry) in manifest.exposures.iter().enumerate() {
        let (facts, point) = (record(&run, index).facts, index / 2);
        let values = facts.sweep.unwrap();
        assert_eq!((entry.point, values.point), (Some(point), point));
        assert_eq!(sweep["points"][point][1], values.values["sun_elevation_deg"]);
        // What the sky of the terrain's centre shows, from the Sun's place in space.
        assert!((facts.sun.elevation_deg.unwrap() - values.values["sun_elevation_deg"]).abs() < 1e-9);
        assert!((facts.sun.azimuth_deg.unwrap() - values.values["sun_azimuth_deg"]).abs() < 1e-9);
        assert_eq!(entry.split, Some(facts.split.unwrap().part));
    }
    // The path is the same at every point: so is the ground, and with it the part.
    assert_eq!(manifest.exposures[0].split, manifest.exposures[2].split);
}

#[test]
fn a_sweep_in_parts_makes_the_bytes_of_a_whole_one() {
    let [whole, parts] = [swept(SUNS), swept(SUNS)];
    whole.succeed(&[]);
    parts.succeed(&["--frames", "4..6"]);
    parts.succeed(&["--frames", "0..1", "--resume"]);
    parts.succeed(&["--resume"]);
    assert!(whole.files() == parts.files());
}

/// Lambert's radiance is in proportion to the albedo, on every renderer; shadows do not depend on it.
#[test]
fn radiance_follows_a_swept_albedo() {
    for adapter in ["cpu", "auto"] {
        let run = swept("sweep: (design: Grid, albedo: Values([0.1, 0.2]))");
        let mut command = Command::new(env!("CARGO_BIN_EXE_sim"));
        command.arg("run").arg(run.path("small.ron")).arg("--output").arg(run.path("out"));
        let output = command.arg("--cache").arg(run.path("cache")).args(["--adapter", adapter]).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let radiance = |index: usize| {
            let file = read_exr(&run.path(&format!("out/exposure_{index:04}.exr"))).unwrap();
            file.channels.into_iter().find(|(name, _)| name == "RADIANCE").unwrap().1
        };
        let (dark, bright) = (radiance(0), radiance(2));
        assert!(dark.iter().any(|value| *value > 0.0));
        // Two roundings of f32.
        let doubled = dark.iter().zip(&bright).all(|(dark, bright)| (bright - 2.0 * dark).abs() <= 3e-7 * bright);
        assert!(doubled, "{adapter}");
    }
}

#[test]
fn the_card_tells_design_parts_inputs_and_limits() {
    let run = swept(SUNS);
    run.succeed(&[]);
    let card = std::fs::read_to_string(run.path("out/dataset_card.md")).unwrap();
    for line in [
        "# a small descent",
        "| epochs | 2026-11-06T00:00:00Z to 2026-11-06T00:00:10Z |",
        "| DEPTH | m |",
        "- sweep: {\"LatinHypercube\":{\"count\":3,\"seed\":5}}",
        "  - sun_elevation_deg: ",
        "Cells are 500 m wide",
        "**Images of neighbouring cells in different parts show the same ground**",
        "| made by this program | this scenario |",
        "MIT OR Apache-2.0",
        "- Largest error of a compressed horizon: ",
        "    title: \"a small descent\",",
    ] {
        assert!(card.contains(line), "no {line:?} in\n{card}");
    }
}
