//! Scenarios that choose how shadows are cast and where the sky's light comes from.

use super::run::{Run, SMALL};

/// The small scenario, its first image alone, with other shadows and more keys.
fn with(keys: &str) -> Run {
    Run::of(&SMALL.replace("    horizon:", &format!("    {keys},\n    horizon:")))
}

/// What `sim check` prints, with the terrain that a run has made.
fn checked(run: &Run) -> String {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_sim"));
    let output =
        command.arg("check").arg(run.path("small.ron")).arg("--cache").arg(run.path("cache")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn settings(run: &Run) -> serde_json::Value {
    let text = std::fs::read_to_string(run.path("out").join("manifest.json")).unwrap();
    let manifest: serde_json::Value = serde_json::from_str(&text).unwrap();
    manifest["run"]["settings"].clone()
}

#[test]
fn every_method_runs_and_is_written_down() {
    let cases = [
        ("shadows: Preset(None), view_rays: Hybrid()", "Off"),
        ("shadows: MaximumMipmaps(runs: [5, 5, 5])", "MaximumMipmaps { runs: [5, 5, 5] }"),
        ("shadows: MaximumMipmaps()", "MaximumMipmaps { runs: [] }"),
        (
            "shadows: Series(visibility: Boxes(5), coefficients: 8, at: Nodes)",
            "Series { visibility: Boxes(5), coefficients: Some(8), at: Nodes }",
        ),
        ("shadows: Series()", "Series { visibility: MiddleValue, coefficients: None, at: Pixels }"),
        ("shadows: Series(visibility: Line)", "Series { visibility: Line, coefficients: None, at: Pixels }"),
        ("shadows: Preset(None)", "Off"),
        ("shadows: Preset(Low)", "Series { visibility: MiddleValue, coefficients: Some(8), at: Nodes }"),
        ("shadows: Preset(VeryHighX7)", "Series { visibility: Boxes(7), coefficients: Some(16), at: Pixels }"),
        ("shadows: Multiscale(level_step: 2)", "Multiscale { level_step: 2, level_offset: 2.0, swath_deg: 2.0 }"),
    ];
    for (keys, recorded) in cases {
        let run = with(keys);
        run.succeed(&["--frames", "0..1"]);
        assert_eq!(settings(&run)["shadows"], recorded, "{keys}");
    }
}

#[test]
fn a_method_outside_its_domain_is_warned_of() {
    let cases = [
        ("shadows: Multiscale()", "smooths skylines over degrees"),
        ("shadows: SingleAzimuth(edge: Hard)", "no penumbra"),
        ("shadows: MaximumMipmaps(runs: [2])", "looks 2 postings far"),
        ("shadows: MaximumMipmaps()", ""),
        ("shadows: Fourier", ""),
    ];
    for (keys, warned) in cases {
        let run = with(keys);
        run.succeed(&["--frames", "0..1"]);
        let told = checked(&run);
        assert_eq!(told.contains("warning"), !warned.is_empty(), "{keys}: {told}");
        assert!(told.contains(warned), "{keys}: {told}");
    }
}

#[test]
fn light_from_the_sky_runs_and_is_written_down() {
    for sky in ["Horizons", "Multiscale(level_step: 1, azimuths: 8)"] {
        let run = with(&format!("shadows: Off, ambient: (radiance_w_m2_sr: 2.5, sky: {sky})"));
        run.succeed(&["--frames", "0..1"]);
        assert_eq!(settings(&run)["ambient"]["radiance_w_m2_sr"], 2.5, "{sky}");
    }
}
