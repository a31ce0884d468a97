//! `sim sun` and `sim kernels`: what they print and how they fail.

use std::process::{Command, Output};

fn sim(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sim"))
        .args(arguments)
        .env("SIM_KERNELS", concat!(env!("CARGO_MANIFEST_DIR"), "/kernels"))
        .output()
        .unwrap()
}

fn printed(arguments: &[&str]) -> String {
    let output = sim(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// One line on standard error and exit code 1.
fn failure(arguments: &[&str]) -> String {
    let output = sim(arguments);
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text.lines().count(), 1, "{text}");
    text
}

#[test]
fn sun_prints_one_json_object_an_epoch() {
    let series = ["--epoch", "2026-09-08Z", "--until", "2026-09-08T06:00:00Z", "--step", "2h", "--json"];
    let text = printed(&[&["sun", "--at", "-89.67,129.78"], &series[..]].concat());
    assert_eq!(text.lines().count(), 4);
    let first: serde_json::Value = serde_json::from_str(text.lines().next().unwrap()).unwrap();
    assert_eq!(first["epoch_utc"], "2026-09-08T00:00:00Z");
    assert_eq!(first["frame"], "MOON_ME_DE440_ME421");
    // JPL Horizons; the default kernels keep 2e-5 degrees of the Sun, 0.003 of the Earth, and 16 km.
    let horizons = [
        ("sun_elevation_deg", 0.430_758, 2e-5),
        ("sun_azimuth_deg", 93.626_956, 2e-5),
        ("sun_angular_diameter_arcsec", 1907.446, 0.05),
        ("sun_range_au", 1.005_775_451_73, 1.1e-7),
        ("sun_irradiance_w_m2", 1361.0 / 1.005_775_451_73_f64.powi(2), 1e-3),
        ("earth_azimuth_deg", 232.481_242, 0.006),
        ("earth_elevation_deg", 2.423_453, 0.006),
    ];
    for (key, expected, tolerance) in horizons {
        let number = first[key].as_f64().unwrap();
        assert!((number - expected).abs() < tolerance, "{key}: {number}");
    }
    assert!((356_000.0..407_000.0).contains(&first["earth_range_km"].as_f64().unwrap()));
}

#[test]
fn sun_prints_tables_and_csv() {
    let place = ["sun", "--at", "4.6,-7", "--epoch", "2026-09-08T12:00:00 TDB", "--body", "mars"];
    let table = printed(&place);
    assert!(table.starts_with("mars in IAU_MARS") && table.contains("2026-09-08T11:58:50.81"), "{table}");
    let csv = printed(&[&place[..], &["--csv"]].concat());
    let widths: Vec<usize> = csv.lines().map(|line| line.split(',').count()).collect();
    assert_eq!(widths, [16, 16], "{csv}");
}

#[test]
fn mistakes_are_told_in_one_line() {
    let at = |extra: &[&str]| failure(&[&["sun", "--at", "0,0"], extra].concat());
    assert!(at(&["--epoch", "tomorrow"]).contains("epoch `tomorrow`"));
    assert!(at(&["--epoch", "2019-01-01Z"]).contains("outside the loaded coverage: 2019-12-31T00:00:00Z to"));
    assert!(at(&["--epoch", "2026-01-01Z", "--body", "vulcan"]).contains("body `vulcan` is unknown"));
    assert!(at(&["--epoch", "2026-01-01Z", "--kernel", "de440s.bsp"]).contains("get it from NASA/JPL NAIF"));
    let backwards = ["--epoch", "2026-01-02Z", "--until", "2026-01-01Z", "--step", "1h"];
    assert!(at(&backwards).contains("gives -24 steps"));
}

#[test]
fn kernels_makes_and_lists() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().to_str().unwrap();
    let made = printed(&["kernels", "make", "--from", "2030-01-01Z", "--until", "2030-01-08Z", "-o", output]);
    assert_eq!(made.lines().count(), 4, "{made}");
    let path = folder.path().join("perilune_2020_2040.bsp");
    let listed = printed(&["kernels", "list", "--json", path.to_str().unwrap()]);
    let listed: serde_json::Value = serde_json::from_str(&listed).unwrap();
    assert_eq!(listed["segments"].as_array().unwrap().len(), 5);
    assert_eq!(listed["segments"][3]["target_id"], 301);
    let late = failure(&["kernels", "make", "--from", "2200-01-01Z", "--until", "2201-01-01Z", "-o", output]);
    assert!(late.contains("1900 to 2100"), "{late}");
}
