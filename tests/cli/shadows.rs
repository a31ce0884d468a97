//! `sim run` with methods that find skylines towards the Sun.

use super::run::{Run, SMALL};

fn with_shadows(shadows: &str) -> Run {
    Run::of(&SMALL.replace("shadows: HorizonMaps()", &format!("shadows: {shadows}")))
}

#[test]
fn every_method_runs_and_stands_in_the_manifest() {
    for (written, recorded) in [
        ("TowardsSun()", "TowardsSun(by: Swath())"),
        ("TowardsSun(by: Swath(azimuth_step_deg: 0.3))", "TowardsSun(by: Swath(azimuth_step_deg: 0.3))"),
        ("TowardsSun(by: Sweep())", "TowardsSun(by: Sweep())"),
        ("TowardsSun(by: SingleAzimuth())", "TowardsSun(by: SingleAzimuth())"),
        (
            "TowardsSun(by: SingleAzimuth(spacing: 2, edge: Hard))",
            "TowardsSun(by: SingleAzimuth(spacing: 2, edge: Hard))",
        ),
    ] {
        let run = with_shadows(written);
        run.succeed(&["--frames", "0..2"]);
        let manifest = String::from_utf8(run.files()["manifest.json"].clone()).unwrap();
        assert!(manifest.contains(recorded), "{written}: {manifest}");
    }
}

#[test]
fn auto_says_what_it_chose_and_why() {
    for (written, recorded) in [("Auto()", "TowardsSun(by: Swath())"), ("Auto(max_irradiance_error: 0)", "Traced")] {
        let run = with_shadows(written);
        let output = run.sim(&["--frames", "0..1"]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && said.contains(&format!("shadows: {recorded}")), "{written}: {said}");
        let manifest: serde_json::Value = serde_json::from_slice(&run.files()["manifest.json"]).unwrap();
        let settings = &manifest["run"]["settings"];
        assert_eq!(settings["shadows"], recorded);
        let why = settings["shadows_chosen"].as_str().unwrap();
        assert!(why.starts_with(&format!("shadows: {recorded}")) && said.contains(why), "{why}");
    }
}

/// `Auto` is what a scenario gets that names none; `refine` needs the errors of maps.
#[test]
fn shadows_that_are_not_named_are_chosen() {
    for (keys, recorded) in [("", "TowardsSun(by: Swath())"), ("refine: true,", "HorizonMaps()")] {
        let run = Run::of(&SMALL.replace("shadows: HorizonMaps(),", keys));
        run.succeed(&["--frames", "0..1"]);
        let manifest: serde_json::Value = serde_json::from_slice(&run.files()["manifest.json"]).unwrap();
        assert_eq!(manifest["run"]["settings"]["shadows"], recorded, "{keys}");
    }
}

/// The Sun goes around the Moon's sky once a month.
#[test]
fn a_swath_of_a_month_is_refused_before_anything_is_swept() {
    let run = with_shadows("TowardsSun(by: Swath())");
    let month = std::fs::read_to_string(run.path("small.ron")).unwrap().replace("step_s: 10", "step_s: 600000");
    std::fs::write(run.path("small.ron"), month.replace("(t_s: 30,", "(t_s: 2000000,")).unwrap();
    let output = run.sim(&[]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("azimuth_step_deg = 0.15 apart, at most 64 are allowed"), "{said}");
    assert!(!run.path("cache/horizon").exists(), "something was swept");
    let check = std::process::Command::new(env!("CARGO_BIN_EXE_sim"))
        .arg("check")
        .arg(run.path("small.ron"))
        .arg("--cache")
        .arg(run.path("cache"))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&check.stderr).into_owned() + &String::from_utf8_lossy(&check.stdout);
    assert!(!check.status.success() && said.contains("at most 64 are allowed"), "{said}");
}
