//! Scenarios that choose how shadows are cast and where the sky's light comes from.

use super::run::{Run, SMALL};

/// The small scenario, its first image alone, with other shadows and more keys.
fn with(keys: &str) -> Run {
    let named =
        if keys.contains("shadows:") { SMALL.replace("    shadows: HorizonMaps(),\n", "") } else { SMALL.into() };
    Run::of(&named.replace("    horizon:", &format!("    {keys},\n    horizon:")))
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
        ("shadows: Off, view_rays: Hybrid()", "Off"),
        ("shadows: MaximumMipmaps(runs: [5, 5, 5])", "MaximumMipmaps(runs: [5, 5, 5])"),
        ("shadows: MaximumMipmaps()", "MaximumMipmaps()"),
        (
            "shadows: HorizonMaps(visibility: Boxes(5), coefficients: 8, at: Nodes)",
            "HorizonMaps(at: Nodes, visibility: Boxes(5), coefficients: 8)",
        ),
        ("shadows: HorizonMaps(at: Pixels)", "HorizonMaps()"),
        ("shadows: HorizonMaps(visibility: Line)", "HorizonMaps(visibility: Line)"),
        ("shadows: Multiscale(level_step: 2)", "Multiscale(level_step: 2)"),
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
        ("shadows: TowardsSun(by: SingleAzimuth(edge: Hard))", "no penumbra"),
        ("shadows: MaximumMipmaps(runs: [2])", "looks 2 postings far"),
        ("shadows: MaximumMipmaps()", ""),
        ("shadows: HorizonMaps()", ""),
    ];
    for (keys, warned) in cases {
        let run = with(keys);
        run.succeed(&["--frames", "0..1"]);
        let told = checked(&run);
        assert_eq!(told.contains("warning"), !warned.is_empty(), "{keys}: {told}");
        assert!(told.contains(warned), "{keys}: {told}");
    }
}

/// As they were written before, and as they are written now.
const OLD: [(&str, &str); 13] = [
    ("Fourier", "HorizonMaps()"),
    ("Baked", "HorizonMaps(at: Nodes)"),
    ("Series()", "HorizonMaps(visibility: MiddleValue)"),
    ("Series(visibility: Line)", "HorizonMaps()"),
    ("Series(visibility: Line, at: Nodes)", "HorizonMaps(at: Nodes, visibility: Line)"),
    (
        "Series(visibility: Boxes(5), coefficients: 8, at: Nodes)",
        "HorizonMaps(at: Nodes, visibility: Boxes(5), coefficients: 8)",
    ),
    ("Preset(None)", "Off"),
    ("Preset(Low)", "HorizonMaps(at: Nodes, visibility: MiddleValue, coefficients: 8)"),
    ("Preset(VeryHighX7)", "HorizonMaps(visibility: Boxes(7), coefficients: 16)"),
    ("Swath()", "TowardsSun(by: Swath())"),
    ("Swath(azimuth_step_deg: 0.3)", "TowardsSun(by: Swath(azimuth_step_deg: 0.3))"),
    ("Sweep(azimuth_step_deg: 0.2)", "TowardsSun(by: Sweep(azimuth_step_deg: 0.2))"),
    ("SingleAzimuth(spacing: 2, edge: Hard)", "TowardsSun(by: SingleAzimuth(spacing: 2, edge: Hard))"),
];

#[test]
fn older_spellings_make_the_same_image_and_say_the_new_one() {
    for (old, new) in OLD {
        let [before, after] = [old, new].map(|spelling| with(&format!("shadows: {spelling}")));
        let output = before.sim(&["--frames", "0..1"]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && said.contains(&format!("write {new}")), "{old}: {said}");
        let told = checked(&before);
        assert!(told.contains("note: shadows: ") && told.contains(&format!("write {new}")), "{old}: {told}");
        assert_eq!(settings(&before)["shadows"], new, "{old}");
        let output = after.sim(&["--frames", "0..1"]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && !said.contains("older spelling"), "{new}: {said}");
        assert!(!checked(&after).contains("note: "), "{new}");
        assert_eq!(settings(&after)["shadows"], new, "{new}");
        // The header of the image itself names the scenario's text.
        let image = |run: &Run| run.files()["exposure_0000.png"].clone();
        assert!(image(&before) == image(&after), "{old} and {new} are two images");
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
