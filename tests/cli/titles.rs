//! What titles and comments of the shipped scenarios say of the Sun is what is computed.

use std::process::Command;

use perilune_engine::scenario::SHIPPED;

use crate::fixtures;

/// Degrees in `Sun N° high` of a text.
fn elevations_deg(text: &str) -> Vec<f64> {
    let number = |rest: &str| rest.split("° high").next().and_then(|number| number.parse().ok());
    text.split("Sun ").skip(1).filter_map(number).collect()
}

/// To a tenth of a degree, over all exposures.
#[test]
fn the_sun_stands_as_high_as_the_shipped_texts_say() {
    assert_eq!(elevations_deg("a, Sun 3° high\n// Sun 2.5° high"), [3.0, 2.5]);
    let mut compared = 0;
    for scenario in SHIPPED {
        let told = elevations_deg(scenario.text);
        if told.is_empty() {
            continue;
        }
        let cache = tempfile::tempdir().unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_sim"))
            .args(["check", scenario.name, "--json", "--data"])
            .arg(fixtures::data_folder())
            .arg("--cache")
            .arg(cache.path())
            .current_dir(cache.path())
            .output()
            .unwrap();
        let Ok(report) = serde_json::from_slice::<serde_json::Value>(&output.stdout) else {
            println!("skipped: {}", String::from_utf8_lossy(&output.stderr));
            continue;
        };
        let Some(computed) = report["facts"]["sun"]["elevation_deg"].as_array() else {
            println!("skipped: {}: {}", scenario.name, report["problems"]);
            continue;
        };
        for end_deg in computed.iter().map(|end| end.as_f64().unwrap()) {
            for told_deg in &told {
                assert!((end_deg - told_deg).abs() <= 0.1, "{}: {told_deg}° in its text, {end_deg}°", scenario.name);
            }
        }
        compared += 1;
    }
    assert!(compared > 0);
}
