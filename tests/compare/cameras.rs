//! Frame, line-scan and push-frame cameras: ISDs of known cameras, photographs by a few independent lines.

use glam::DVec2;
use perilune::compare::{Comparison, Error, compare};
use perilune::pipeline::Silent;
use serde_json::{Value, json};

use super::scene::{Carrier, Case, FOCAL_MM, Flight, PITCH_MM, PIXELS, isd, photograph, sun};

const FRAME: &str = "USGS_ASTRO_FRAME_SENSOR_MODEL";
const LINES: &str = "USGS_ASTRO_LINE_SCANNER_SENSOR_MODEL";
const FRAMELETS: &str = "USGS_ASTRO_PUSH_FRAME_SENSOR_MODEL";
const MIDDLE: f64 = PIXELS as f64 / 2.0;

fn found(isd: &Value, photo: &[f64]) -> Comparison {
    compare(&Case::new(isd, photo).request(), &Silent).unwrap()
}

/// The program's bilinear ground and central differences of 20 m against slopes of hills of 120 m and more, and cast
/// shadows of slopes up to 25 degrees under a Sun at 35: a correlation of 0.99 and 0.1 pixels are left.
fn assert_meets(comparison: &Comparison) {
    let registration = &comparison.registration;
    let motion = registration.motion;
    assert!(comparison.numbers.high_pass_correlation > 0.99, "{:?}", comparison.numbers);
    assert!(DVec2::from(motion.shift_px).length() < 0.1, "{registration:?}");
    assert!(motion.rotation_rad.abs() < 1e-3 && motion.scale.abs() < 1e-3, "{registration:?}");
}

/// Frame: line and sample from the detector's centre, y along samples, x against lines.
fn frame_pixel(column: f64, row: f64) -> (f64, [f64; 2]) {
    (0.0, [-(row + 0.5 - MIDDLE) * PITCH_MM, (column + 0.5 - MIDDLE) * PITCH_MM])
}

fn frame_flight() -> Flight {
    Flight { speed_m_s: 0.0, twist_rad: 0.3 }
}

#[test]
fn a_frame_camera_sees_what_its_isd_says() {
    let sun = sun(290.0, 35.0);
    let photo = photograph(&frame_flight(), sun, frame_pixel);
    assert_meets(&found(&isd(FRAME, &frame_flight(), sun), &photo));
}

/// CSM's radial distortion: ideal = measured (1 − k₁ r²), 2 px at the image's edge.
#[test]
fn a_frame_cameras_distortion_is_taken_away() {
    let sun = sun(290.0, 35.0);
    let k1 = 2.0 / MIDDLE / (MIDDLE * PITCH_MM).powi(2);
    let photo = photograph(&frame_flight(), sun, |column, row| {
        let (time, [x, y]) = frame_pixel(column, row);
        let kept = 1.0 - k1 * (x * x + y * y);
        (time, [x * kept, y * kept])
    });
    let mut written = isd(FRAME, &frame_flight(), sun);
    let undistorted = found(&written, &photo);
    assert!(undistorted.registration.motion.scale.abs() > 5e-3, "a distortion that is not told is seen");
    written["optical_distortion"] = json!({ "radial": { "coefficients": [0.0, k1, 0.0] } });
    assert_meets(&found(&written, &photo));
}

/// A wall of a wrong focal length is found as a scale, with its uncertainty.
#[test]
fn a_field_of_view_wrong_by_half_a_percent_is_found() {
    let sun = sun(290.0, 35.0);
    let photo = photograph(&frame_flight(), sun, frame_pixel);
    let mut written = isd(FRAME, &frame_flight(), sun);
    written["focal_length_model"]["focal_length"] = (FOCAL_MM * 1.005).into();
    let registration = found(&written, &photo).registration;
    // The render is magnified: the photograph's pixels lie farther apart on it.
    assert!((registration.motion.scale - 0.005).abs() < 5e-4, "{registration:?}");
    assert!(registration.sigma.scale < 5e-4, "{registration:?}");
}

/// One row an instant, 20 m apart. Northwards, the image's rows run against the sensor's lines, as they do on half of
/// all orbits; southwards they run with them.
#[test]
fn a_line_scanner_has_a_pose_a_line() {
    for speed_m_s in [200.0, -200.0] {
        let (sun, flight) = (sun(70.0, 35.0), Flight { speed_m_s, twist_rad: 0.1 });
        let rate_s = 0.1;
        let start_s = -rate_s * MIDDLE;
        let photo = photograph(&flight, sun, |column, row| {
            (start_s + rate_s * (row + 0.5), [0.0, (column + 0.5 - MIDDLE) * PITCH_MM])
        });
        let mut written = isd(LINES, &flight, sun);
        written["detector_center"]["line"] = 0.0.into();
        written["line_scan_rate"] = json!([[0.5, start_s, rate_s]]);
        assert_meets(&found(&written, &photo));
    }
}

/// Eight rows an instant, one framelet below the other without overlap; also with the order reversed and the framelets
/// turned over.
#[test]
fn a_push_frame_camera_has_a_pose_a_framelet() {
    let height = 8.0;
    for reversed in [false, true] {
        // Southwards the lines of a framelet and the framelets run the same way.
        let speed_m_s = if reversed { 160.0 } else { -160.0 };
        let (sun, flight) = (sun(70.0, 35.0), Flight { speed_m_s, twist_rad: 0.0 });
        let (exposure_s, delay_s) = (0.02, 1.0);
        let count = PIXELS as f64 / height;
        let start_s = -0.5 * count * delay_s;
        let photo = photograph(&flight, sun, |column, row| {
            let framelet = (row / height).floor();
            let taken = if reversed { count - 1.0 - framelet } else { framelet };
            let line = row - framelet * height + 0.5;
            let y = (column + 0.5 - MIDDLE) * PITCH_MM;
            (start_s + 0.5 * exposure_s + taken * delay_s, [-(line - height / 2.0) * PITCH_MM, y])
        });
        let mut written = isd(FRAMELETS, &flight, sun);
        written["detector_center"]["line"] = (height / 2.0).into();
        written["starting_ephemeris_time"] = start_s.into();
        written["exposure_duration"] = exposure_s.into();
        written["interframe_delay"] = delay_s.into();
        written["framelet_height"] = 8.into();
        written["framelet_order_reversed"] = reversed.into();
        assert_meets(&found(&written, &photo));
    }
}

#[test]
fn an_isd_that_says_too_little_is_refused_by_key() {
    let written = isd(LINES, &frame_flight(), sun(0.0, 30.0));
    let case = Case::new(&written, &vec![0.5; PIXELS * PIXELS]);
    let error = compare(&case.request(), &Silent).unwrap_err();
    assert!(matches!(error, Error::Isd(_)) && error.to_string().contains("line_scan_rate = nothing"), "{error}");
    let mut shorter = written.clone();
    shorter["instrument_position"]["ephemeris_times"] = json!([0.0]);
    std::fs::write(case.path("isd.json"), shorter.to_string()).unwrap();
    let error = compare(&case.request(), &Silent).unwrap_err().to_string();
    assert!(error.contains("instrument_position = 41 rows and 1 times"), "{error}");
    let (position, _) = frame_flight().at(0.0);
    assert!(position.length() > 0.0);
}
