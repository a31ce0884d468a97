//! ISDs that say something twice, or something unknown.

use serde_json::{Value as Json, json};

use super::*;

/// A scanner that moves at 1 km/s.
const LINE_SCAN: &str = include_str!("../../../../fuzz/corpus/isd/line_scan.json");

/// What is said about the scanner with a value changed; nothing where it is read.
fn said(pointer: &str, value: Json) -> Option<String> {
    let mut isd: Json = serde_json::from_str(LINE_SCAN).unwrap();
    let (block, key) = pointer.rsplit_once('/').unwrap();
    isd.pointer_mut(block).unwrap()[key] = value;
    Isd::parse(Path::new("a.json"), &isd.to_string()).err().map(|error| error.to_string())
}

#[test]
fn all_that_ale_writes_is_read() {
    for (key, value) in [
        ("/kernels", json!({ "ck": ["a.bc"] })),
        ("/ending_ephemeris_time", json!(1.0)),
        ("/interpolation_method", json!("lagrange")),
        ("/naif_keywords", json!({ "BODY301_RADII": [1, 2, 3] })),
        ("/instrument_position/spk_table_original_size", json!(4)),
        ("/instrument_pointing/constant_frames", json!([-1, 1])),
    ] {
        assert_eq!(said(key, value), None, "{key}");
    }
}

#[test]
fn positions_and_velocities_agree() {
    let rows = |speed: f64| json!(vec![[speed, 0.0, 0.0]; 4]);
    let key = "/instrument_position/velocities";
    assert_eq!(said(key, rows(1.01)), None);
    assert_eq!(said(key, rows(0.0)), None);
    for wrong in [rows(1000.0), rows(-1.0), json!([[1, 0, 0]]), json!(vec![[0, 1, 0]; 4])] {
        let error = said(key, wrong.clone()).unwrap_or_else(|| panic!("{wrong}"));
        assert!(error.contains("instrument_position.velocities"), "{error}");
    }
}

#[test]
fn what_is_unknown_or_no_rotation_is_refused_by_name() {
    for (key, value, word) in [
        ("/detector_sample_suming", json!(2), "detector_sample_suming"),
        ("/instrument_position/velocity", json!([]), "instrument_position.velocity"),
        ("/focal_length_model/distance", json!(1), "focal_length_model.distance"),
        ("/interpolation_method", json!("spline"), "interpolation_method"),
        ("/num_lines_overlap", json!(8), "num_lines_overlap"),
        ("/sun_position/reference_frame", json!(17), "reference_frame"),
        ("/body_rotation/quaternions", json!([[0, 0, 0, 0]]), "body_rotation"),
        ("/instrument_pointing/constant_rotation", json!([2, 0, 0, 0, 1, 0, 0, 0, 1]), "constant_rotation"),
        ("/instrument_position/unit", json!("ft"), "unit"),
        ("/optical_distortion", json!({ "themisir": { "alpha0": 0.1 } }), "themisir"),
        ("/optical_distortion", json!({ "radial": { "coefficients": [0, "1", 0] } }), "radial"),
    ] {
        let error = said(key, value).unwrap_or_else(|| panic!("{key}"));
        assert!(error.contains(word), "{key}: {error}");
    }
}
