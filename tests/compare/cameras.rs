//! Frame, line-scan and push-frame cameras: ISDs of known cameras, photographs by a few independent lines.

use glam::{DMat3, DQuat, DVec2, DVec3};
use perilune_engine::compare::{Comparison, Error, Request, compare};
use perilune_engine::pipeline::Silent;
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

/// A flight whose camera is turned in its own axes.
struct Turned(Flight, DQuat);

impl Carrier for Turned {
    fn at(&self, time_s: f64) -> (DVec3, DMat3) {
        let (position, axes) = self.0.at(time_s);
        (position, axes * DMat3::from_quat(self.1))
    }
}

/// The photograph's camera is turned about its three axes and has a longer lens; its ISD does not know. The turns move
/// the image by 2.4, 1.8 and, at its corner, 0.5 pixels. What is found holds to the 0.1 pixels that terrain and
/// shading leave (`assert_meets`). Once the pose is taken no motion is left, and what was taken holds to three
/// of its stated deviations and 0.03 pixels.
#[test]
fn a_turned_camera_is_found_and_its_pose_explains_the_motion() {
    let sun = sun(290.0, 35.0);
    let (about_x, about_y, about_z, longer) = (3e-3, -4e-3, 5e-3, 0.004);
    // Sensor x runs against lines, y along samples: the image's right is y, its downward axis -x.
    let turn = DQuat::from_scaled_axis(DVec3::new(about_x, about_y, about_z));
    let photo = photograph(&Turned(frame_flight(), turn), sun, |column, row| {
        let (time, plane) = frame_pixel(column, row);
        (time, plane.map(|mm| mm / (1.0 + longer)))
    });
    let case = Case::new(&isd(FRAME, &frame_flight(), sun), &photo);
    let told = compare(&case.request(), &Silent).unwrap();
    let taken = compare(&Request { fit_pose: true, ..case.request() }, &Silent).unwrap();
    let pixel_rad = PITCH_MM / FOCAL_MM;
    let expected = [about_y, -about_x, about_z];
    for pose in [told.pose.unwrap(), taken.fitted_pose.unwrap()] {
        let allowed = [0.1 * pixel_rad, 0.1 * pixel_rad, 1e-3];
        for ((got, expected), allowed) in pose.turn_rad.iter().zip(expected).zip(allowed) {
            assert!((got - expected).abs() < allowed, "{pose:?}");
        }
        assert!((pose.focal - longer).abs() < 1e-3 && pose.left_px < 0.1, "{pose:?}");
        assert!(pose.turn_sigma_rad.iter().all(|sigma| (0.0..1e-3).contains(sigma)), "{pose:?}");
    }
    assert_meets(&taken);
    // The images lie on each other to a hundredth of a pixel of their corners.
    let left = taken.registration.motion;
    assert!(left.corner_px(PIXELS, PIXELS) < 0.01, "{left:?}");
    let pose = taken.fitted_pose.unwrap();
    // 0.03 pixels are the shading model's, which the deviations do not know: about the boresight, at the image's edge.
    let model_rad = [0.03 * pixel_rad, 0.03 * pixel_rad, 0.03 / MIDDLE];
    for axis in 0..3 {
        let allowed = 3.0 * pose.turn_sigma_rad[axis] + model_rad[axis];
        assert!((pose.turn_rad[axis] - expected[axis]).abs() < allowed, "axis {axis}: {pose:?}");
    }
    assert!((pose.focal - longer).abs() < 3.0 * pose.focal_sigma + 0.03 / MIDDLE, "{pose:?}");
    assert!(taken.fitted_line().contains("turn and focal length of the camera"));
    assert!(!told.fitted_line().contains("turn and focal length of the camera"));
}

/// One ground and one photograph; only the Sun that is told changes.
#[test]
fn another_sun_is_said() {
    let truth = sun(290.0, 35.0);
    let case = Case::new(&isd(FRAME, &frame_flight(), truth), &photograph(&frame_flight(), truth, frame_pixel));
    // Every other pixel: shading of hills of 120 m is seen at 40 m too.
    let request = Request { turn_sun: true, pixels: Some(PIXELS / 2), ..case.request() };
    let verdict = |told| {
        std::fs::write(case.path("isd.json"), isd(FRAME, &frame_flight(), told).to_string()).unwrap();
        let comparison = compare(&request, &Silent).unwrap();
        (comparison.sun.clone().unwrap(), comparison.text())
    };
    let (sun_found, text) = verdict(truth);
    assert!(sun_found.agrees && text.contains("agrees with the Sun"), "{sun_found:?}");
    // Slightly wrong, and from the other side, where registration finds no motion at all.
    for (told_deg, turn_deg) in [(275.0, 15.0), (110.0, 180.0)] {
        let (sun_found, text) = verdict(sun(told_deg, 35.0));
        assert!(!sun_found.agrees && text.contains("WANTS ANOTHER SUN"), "{sun_found:?}");
        // Samples 20 degrees apart, a bend that is no parabola.
        let off_deg = (sun_found.best_turn_deg[0].unwrap() - turn_deg + 180.0_f64).rem_euclid(360.0) - 180.0;
        assert!(off_deg.abs() < 10.0, "{sun_found:?}");
    }
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

/// Kaguya's cameras: ideal = measured + boresight + a₀ + a₁ r + a₂ r² + a₃ r³ (SEL_TC_V01.TI), here 6 px at the image's
/// edges, more along the lines on one side than on the other; x runs against the rows.
#[test]
fn kaguyas_distortion_is_taken_away() {
    let (sun, flight) = (sun(70.0, 35.0), Flight { speed_m_s: 200.0, twist_rad: 0.1 });
    let (rate_s, edge_mm) = (0.1, MIDDLE * PITCH_MM);
    let start_s = -rate_s * MIDDLE;
    // In mm at r = edge: 1.5, 2 and 1 pixels for x, 1, 1.5 and 2 for y, besides 1 and -2 for the boresight and 0.5 each.
    let [x, y] = [[0.5, 1.5, 2.0, 1.0], [0.5, 1.0, 1.5, 2.0]]
        .map(|px| std::array::from_fn::<f64, 4, _>(|k| px[k] * PITCH_MM / edge_mm.powi(k as i32)));
    let boresight = [1.0 * PITCH_MM, -2.0 * PITCH_MM];
    let photo = photograph(&flight, sun, |column, row| {
        let measured = (column + 0.5 - MIDDLE) * PITCH_MM;
        let r = measured.abs();
        let added = |a: [f64; 4]| a[0] + a[1] * r + a[2] * r * r + a[3] * r * r * r;
        (start_s + rate_s * (row + 0.5), [boresight[0] + added(x), measured + boresight[1] + added(y)])
    });
    let mut written = isd(LINES, &flight, sun);
    written["detector_center"]["line"] = 0.0.into();
    written["line_scan_rate"] = json!([[0.5, start_s, rate_s]]);
    let undistorted = found(&written, &photo);
    let shift = DVec2::from(undistorted.registration.motion.shift_px);
    assert!(shift.length() > 1.0, "a distortion that is not told is seen: {shift}");
    written["optical_distortion"] =
        json!({ "kaguyalism": { "x": x, "y": y, "boresight_x": boresight[0], "boresight_y": boresight[1] } });
    assert_meets(&found(&written, &photo));
    written["optical_distortion"] = json!({ "kaguyalism": { "x": [0.1] } });
    let error = compare(&Case::new(&written, &photo).request(), &Silent).unwrap_err().to_string();
    assert!(error.contains("optical_distortion = kaguyalism"), "{error}");
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
