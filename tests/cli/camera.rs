//! Cameras in scenarios: presets, ISDs, shutters, noise, exposure times, and what the records say of them.

use std::path::Path;

use glam::DVec3;
use perilune_engine::dataset::read_exr;
use perilune_engine::scenario::{Preset, Scenario, SearchPath, resolve};

use super::run::Run;
use crate::compare::scene::{Carrier, FOCAL_MM, Flight, PITCH_MM, PIXELS, isd};

/// Images of a bare sphere from 50 km, under a full Moon's Sun.
const BARE: &str = r#"(
    title: "a bare sphere",
    trajectory: Waypoints(points: [
        (t_s: -60, latitude_deg: -3, longitude_deg: 0, height_m: 50000),
        (t_s: 60, latitude_deg: 3, longitude_deg: 0, height_m: 50000),
    ]),
    pointing: (towards: Nadir),
    camera: (CAMERA),
    exposures: Series(start: "2026-11-24T15:00:00 UTC", step_s: 10, count: 3),
    outputs: (planes: [PLANES], animation: false),
)
"#;

fn scenario(camera: &str, planes: &str) -> String {
    BARE.replace("CAMERA", camera).replace("PLANES", planes)
}

fn resolved(text: &str) -> Scenario {
    let places = SearchPath { beside: ".".into(), data: Vec::new() };
    resolve(Path::new("x.ron"), text, &places, &|_| None).unwrap_or_else(|error| panic!("{error}"))
}

fn record(run: &Run, index: usize) -> serde_json::Value {
    let path = run.path("out").join(format!("exposure_{index:04}.json"));
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn plane(run: &Run, index: usize, name: &str) -> Vec<f32> {
    let file = read_exr(&run.path("out").join(format!("exposure_{index:04}.exr"))).unwrap();
    file.channels.into_iter().find(|(channel, _)| channel == name).unwrap().1
}

/// Angles and fields that the missions publish: IFOV of NAC-L 10.0042 µrad; 74.9 m from 50 km of the WAC; 10 m from 100 km of
/// the TC, by its name; 73.774° of the metric camera's frame; 0.28 mrad and 44° by 32° of the NavCam.
#[test]
fn presets_see_as_wide_as_their_papers_say() {
    let of = |preset: Preset| {
        let camera = resolved(&scenario(&format!("preset: {preset:?}, rows: 14"), "radiance")).camera;
        let width_rad = 2.0 * (f64::from(camera.columns) / 2.0 / camera.focal_length_px).atan();
        (1.0 / camera.focal_length_px, width_rad.to_degrees())
    };
    let close = |got: f64, expected: f64, share: f64| assert!((got / expected - 1.0).abs() < share, "{got} {expected}");
    close(of(Preset::LroNac).0, 10.0042e-6, 5e-4);
    close(of(Preset::LroWac).0, 74.9 / 50e3, 5e-3);
    close(of(Preset::KaguyaTc).0, 10.0 / 100e3, 0.04);
    // 114.3 mm of film; the kernel's field is that of 114.2.
    close(of(Preset::ApolloMetric).1, 73.774, 1.2e-3);
    close(of(Preset::OsirisRexNavCam).0, 0.28e-3, 0.03);
    // Along the ideal plane; barrel distortion packs 44° into it.
    close(of(Preset::OsirisRexNavCam).1, 41.0, 0.02);
    close(of(Preset::Descent).1, 45.0, 1e-4);
}

/// A small window of each, with its shutter, correction and detector.
#[test]
fn every_preset_takes_an_image() {
    for preset in Preset::ALL {
        let text = scenario(&format!("preset: {preset:?}, columns: 32, rows: 28, samples_per_pixel: 1"), "radiance");
        let run = Run::of(&text.replace("count: 3", "count: 1"));
        run.succeed(&[]);
        let radiance = plane(&run, 0, "RADIANCE");
        assert!(radiance.len() == 32 * 28 && radiance.iter().all(|value| *value > 0.0), "{preset:?}");
        let manifest: serde_json::Value =
            serde_json::from_slice(&std::fs::read(run.path("out/manifest.json")).unwrap()).unwrap();
        let said = manifest["run"]["settings"]["camera_preset"]["figures"].as_str().unwrap().to_string();
        assert_eq!(said, preset.text(), "the figures stand in the manifest with their sources");
    }
}

/// The window of a preset lies in the middle of its image.
#[test]
fn fewer_columns_of_a_preset_are_the_middle_ones() {
    let camera = resolved(&scenario("preset: OsirisRexNavCam, columns: 592, rows: 944", "radiance")).camera;
    assert_eq!(camera.principal_point_px, [1269.583 - 1000.0, 951.247 - 500.0]);
    let own = resolved(&scenario("preset: OsirisRexNavCam, field_of_view_deg: 10, f_number: 8", "radiance")).camera;
    assert!(own.distortion.is_none() && own.f_number == 8.0, "another lens has another distortion");
}

/// All that moves, blurs and counts at once: any image is the same alone as in its series.
#[test]
fn an_image_alone_is_the_same_as_in_its_series() {
    let text = scenario(
        "preset: Descent, columns: 48, rows: 40, moments: 3, auto_exposure: (longest_s: 0.01), \
         shutter: Rolling(line_time_s: 1e-3, rows_per_pose: 8), samples_per_pixel: 1",
        "radiance, digital_number, noise_free_digital_number",
    );
    let [series, alone] = [Run::of(&text), Run::of(&text)];
    series.succeed(&[]);
    alone.succeed(&["--frames", "2..3"]);
    assert!(series.files()["exposure_0002.exr"] == alone.files()["exposure_0002.exr"]);
    let [mut said, mut said_alone] = [&series, &alone].map(|run| record(run, 2));
    // A preview's white is the whole sequence's.
    for record in [&mut said, &mut said_alone] {
        record["preview"].take();
        record["sha256"].take();
    }
    assert_eq!(said, said_alone);
    assert_ne!(plane(&series, 1, "DN"), plane(&series, 2, "DN"), "noise is another's in another exposure");
}

/// DN = offset + level · capacity / gain at the quantile; 1 DN for rounding, none for noise in the noise-free twin.
#[test]
fn an_automatic_exposure_fills_the_detector_as_far_as_asked_and_says_so() {
    for level in [0.3, 0.8] {
        let camera = format!("preset: Descent, columns: 64, rows: 48, auto_exposure: (level: {level}, quantile: 0.9)");
        let run = Run::of(&scenario(&camera, "digital_number, noise_free_digital_number"));
        run.succeed(&["--frames", "0..1"]);
        let mut dn = plane(&run, 0, "DN_NOISE_FREE");
        dn.sort_by(f32::total_cmp);
        let got = dn[(0.9 * (dn.len() - 1) as f64).round() as usize];
        let expected = 40.0 + level * 13_500.0 / 3.4;
        assert!((f64::from(got) - expected).abs() <= 1.0, "{got} {expected}");
        let sensor = &record(&run, 0)["sensor"];
        let chosen_s = sensor["exposure_s"].as_f64().unwrap();
        assert!(chosen_s > 1e-6 && chosen_s < 1.0 && chosen_s != 0.5e-3, "{chosen_s}");
        assert!(sensor["auto_exposure"].as_str().unwrap().contains("0.9 quantile"), "{sensor}");
    }
}

/// EMVA 1288's photon transfer on even ground: at nadir of a sphere under a high Sun the noise-free twin is flat within a
/// DN, and σ² − σ_read² K² − 1/12 grows as K (μ − offset). 9 % of the variance is 4 σ of 4800 pixels.
#[test]
fn the_noise_of_an_even_field_grows_with_its_light() {
    for exposure_s in [2e-5, 2e-4] {
        let camera = format!(
            "columns: 80, rows: 60, field_of_view_deg: 0.5, pixel_pitch_um: 5.5, band_nm: (450, 750), f_number: 4, \
             exposure_s: {exposure_s}"
        );
        let detector = "detector: (quantum_efficiency: 0.5, full_well_e: 50000, read_noise_e: 10, gain_e_per_dn: 0.5, \
                        offset_dn: 100, bits: 16),\n    exposures";
        let text = scenario(&camera, "digital_number, noise_free_digital_number").replace("exposures", detector);
        let run = Run::of(&text);
        run.succeed(&["--frames", "0..1"]);
        let (noisy, mean) = (plane(&run, 0, "DN"), plane(&run, 0, "DN_NOISE_FREE"));
        let count = mean.len() as f64;
        let variance = noisy.iter().zip(&mean).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>() / count;
        let mu = mean.iter().map(|value| f64::from(*value)).sum::<f64>() / count;
        let (k, read_e) = (2.0, 10.0);
        let expected = k * k * read_e * read_e + 1.0 / 12.0 + k * (mu - 100.0);
        println!("mean {mu:.1} DN, variance {variance:.1} DN², expected {expected:.1}");
        assert!(mu > 200.0 && (variance / expected - 1.0).abs() < 0.09, "{mu} {variance} {expected}");
    }
}

#[test]
fn the_record_states_lens_and_shutter() {
    let camera = "columns: 32, rows: 24, focal_length_mm: 12, pixel_pitch_um: 10, band_nm: (500, 600), f_number: 8, \
                  psf: [Airy(), Defocus(diameter_px: 1.5)], vignetting: Polynomial(a2: -0.2), moments: 5, \
                  exposure_s: 0.01, shutter: Rolling(line_time_s: 1e-3, rows_per_pose: 4), samples_per_pixel: 1";
    let run = Run::of(&scenario(camera, "radiance, range"));
    run.succeed(&["--frames", "0..1"]);
    let record = record(&run, 0);
    let (camera, effects) = (&record["camera"], &record["camera"]["effects"]);
    let said = camera["shutter"].as_str().unwrap();
    assert_eq!(said, "rolling, 0.001 s a row from the top down, a pose for each 4, 5 moments of 0.002 s each");
    assert_eq!(effects["psf"][0], "Airy, wavelength times f-number 0.440000 px");
    assert_eq!(effects["moments"], 5);
    assert!(effects["vignetting"].as_str().unwrap().starts_with("1 + -0.2 r^2"), "{effects}");
    // 1.5 lines of 1 ms at 1.52 km/s (6° of 50 km more than the sphere's in 120 s), 41.7 m a pixel.
    let error_px = effects["shared_pose_error_px"].as_f64().unwrap();
    assert!((error_px - 1.5e-3 * 1516.0 / 41.7).abs() < 0.003, "{error_px}");
    assert_eq!(record["pose"]["rows"].as_array().unwrap().len(), 6);
    let plain = Run::of(&scenario("columns: 32, rows: 24, field_of_view_deg: 20", "radiance"));
    plain.succeed(&["--frames", "0..1"]);
    let plain = self::record(&plain, 0);
    assert!(plain["camera"].get("effects").is_none() && plain["pose"].get("rows").is_none(), "{plain}");
}

/// A kernel of a file: two equal neighbours in a row move the image by half a pixel.
#[test]
fn a_measured_kernel_is_read_from_numbers_and_from_images() {
    let run = |psf: &str| {
        let camera = format!("columns: 40, rows: 24, field_of_view_deg: 170, psf: [Kernel(path: \"{psf}\")]");
        let run = Run::of(&scenario(&camera, "radiance"));
        std::fs::write(run.path("kernel.csv"), "# measured\n0, 1, 1\n").unwrap();
        let image = image::GrayImage::from_raw(3, 1, vec![0, 200, 200]).unwrap();
        image.save(run.path("kernel.png")).unwrap();
        std::fs::write(run.path("bad.csv"), "1, 2, x\n").unwrap();
        std::fs::write(run.path("even.csv"), "1, 2\n").unwrap();
        run
    };
    let [text, picture] = ["kernel.csv", "kernel.png"].map(run);
    text.succeed(&["--frames", "0..1"]);
    picture.succeed(&["--frames", "0..1"]);
    assert_eq!(plane(&text, 0, "RADIANCE"), plane(&picture, 0, "RADIANCE"));
    let sharp = Run::of(&scenario("columns: 40, rows: 24, field_of_view_deg: 170", "radiance"));
    sharp.succeed(&["--frames", "0..1"]);
    let (sharp, blurred) = (plane(&sharp, 0, "RADIANCE"), plane(&text, 0, "RADIANCE"));
    let expected = 0.5 * (sharp[12 * 40 + 19] + sharp[12 * 40 + 20]);
    assert!((blurred[12 * 40 + 20] / expected - 1.0).abs() < 1e-5);
    for (name, said) in [("bad.csv", "line 1: \" x\" is no number"), ("even.csv", "a psf kernel of 2 x 1 pixels")] {
        let output = run(name).sim(&[]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && error.contains(said), "{error}");
    }
}

/// The scenario's camera is the ISD's: latitudes and longitudes of its pixels, by a ray and a sphere written here.
#[test]
fn a_scenario_takes_camera_and_poses_from_an_isd() {
    // When a row is exposed, and how far along the flight it looks, in mm of the focal plane.
    type Row = Box<dyn Fn(f64) -> (f64, f64)>;
    let flight = Flight { speed_m_s: 800.0, twist_rad: 0.2 };
    let middle = PIXELS as f64 / 2.0;
    let mut lines = isd("USGS_ASTRO_LINE_SCANNER_SENSOR_MODEL", &flight, DVec3::X);
    // One line looks straight down; its time is 25 ms, the first line's from the centre time.
    let rate_s = 0.025;
    lines["line_scan_rate"] = serde_json::json!([[1.0, -rate_s * middle, rate_s]]);
    lines["detector_center"]["line"] = 0.0.into();
    let of_line: Row = Box::new(move |row| ((row - middle) * rate_s, 0.0));
    let frame = isd("USGS_ASTRO_FRAME_SENSOR_MODEL", &flight, DVec3::X);
    let of_frame: Row = Box::new(move |row| (0.0, -(row + 0.5 - middle) * PITCH_MM));
    // Framelets of eight rows, half a second from each other; an exposure's middle is 10 ms after its start.
    let (height, delay_s, exposure_s) = (8.0, 0.5, 0.02);
    let start_s = -0.5 * delay_s * PIXELS as f64 / height;
    let mut framelets = isd("USGS_ASTRO_PUSH_FRAME_SENSOR_MODEL", &flight, DVec3::X);
    framelets["detector_center"]["line"] = (height / 2.0).into();
    framelets["starting_ephemeris_time"] = start_s.into();
    framelets["exposure_duration"] = exposure_s.into();
    framelets["interframe_delay"] = delay_s.into();
    framelets["framelet_height"] = 8.into();
    let of_framelet: Row = Box::new(move |row| {
        let framelet = (row / height).floor();
        let line = row - height * framelet;
        (start_s + exposure_s / 2.0 + framelet * delay_s, -(line + 0.5 - height / 2.0) * PITCH_MM)
    });
    let cameras = [("frame", frame, of_frame), ("lines", lines, of_line), ("framelets", framelets, of_framelet)];
    for (name, isd, exposed) in cameras {
        let text = scenario("isd: \"isd.json\", samples_per_pixel: 1", "latitude, longitude");
        let trajectory = text.find("trajectory:").unwrap()..text.find("camera:").unwrap();
        let text = text.replace(&text[trajectory], "trajectory: Isd,\n    ");
        let run = Run::of(&text);
        std::fs::write(run.path("isd.json"), isd.to_string()).unwrap();
        run.succeed(&["--frames", "0..1"]);
        let (latitude, longitude) = (plane(&run, 0, "LATITUDE"), plane(&run, 0, "LONGITUDE"));
        assert_eq!(latitude.len(), PIXELS * PIXELS);
        for index in (0..PIXELS * PIXELS).step_by(97) {
            let (column, row) = ((index % PIXELS) as f64, (index / PIXELS) as f64);
            let across_mm = (column + 0.5 - middle) * PITCH_MM;
            let (time_s, along_mm) = exposed(row);
            let (position, axes) = flight.at(time_s);
            let look = (axes * DVec3::new(along_mm, across_mm, FOCAL_MM)).normalize();
            let b = position.dot(look);
            let radius_m = 1_737_400.0_f64;
            let distance_m = -b - (b * b - position.length_squared() + radius_m * radius_m).sqrt();
            let at = position + distance_m * look;
            let expected = [(at.z / radius_m).asin().to_degrees(), at.y.atan2(at.x).to_degrees().rem_euclid(360.0)];
            let got = [latitude[index], longitude[index]].map(f64::from);
            // A pixel is 6.6e-4°; f32 keeps 3e-5° of 360.
            let off = (got[0] - expected[0]).hypot((got[1] - expected[1] + 180.0).rem_euclid(360.0) - 180.0);
            assert!(off < 5e-5, "{name}, ({column}, {row}): {got:?} {expected:?}");
        }
    }
}

/// What is wrong with a camera, and what is said of it.
#[test]
fn cameras_that_cannot_be_are_named_with_their_key() {
    let cases = [
        ("columns: 8, rows: 8, field_of_view_deg: 9, moments: 4", "camera.moments = 4 is not odd"),
        ("columns: 8, rows: 8, field_of_view_deg: 9, psf: [Airy()]", "camera.psf[0] needs camera.pixel_pitch_um"),
        (
            "columns: 8, rows: 8, field_of_view_deg: 9, shutter: PushFrame(interval_s: 1, framelet_rows: 3)",
            "camera.rows an image of 8 rows is no whole number of framelets of 3",
        ),
        ("preset: LroNac", "camera.rows is missing"),
        ("preset: LroNak, rows: 3", "camera.preset = LroNak is not one of LroNac, LroWac, KaguyaTc"),
        (
            "columns: 8, rows: 8, field_of_view_deg: 9, auto_exposure: ()",
            "camera.auto_exposure needs a detector, which it fills",
        ),
        (
            "columns: 8, rows: 8, field_of_view_deg: 9, correction: Radial(k1: 0.1)",
            "camera.correction needs pixel_pitch_um: it counts in millimetres",
        ),
        (
            "columns: 8, rows: 8, field_of_view_deg: 9, psf: [Gaussian(sigma_px: 40)]",
            "camera.psf[0].sigma_px = 40 is outside [0.05, 12] px",
        ),
        ("isd: \"nowhere.json\"", "camera.isd = \"nowhere.json\" is not found"),
    ];
    for (camera, said) in cases {
        let places = SearchPath { beside: "nowhere".into(), data: Vec::new() };
        let error = resolve(Path::new("x.ron"), &scenario(camera, "radiance"), &places, &|_| None).unwrap_err();
        assert!(error.to_string().contains(said), "{error}\nwanted: {said}");
    }
    let text = scenario("columns: 8, rows: 8, field_of_view_deg: 9", "digital_number");
    let places = SearchPath { beside: "nowhere".into(), data: Vec::new() };
    let error = resolve(Path::new("x.ron"), &text, &places, &|_| None).unwrap_err().to_string();
    assert!(error.contains("outputs.planes[0] = digital_number needs a detector"), "{error}");
}

/// Three framelets ten minutes apart, and three images at their times by the same camera, which stands still: each framelet has the
/// Sun of its own time. From first to last it goes on by 0.17°.
#[test]
fn each_framelet_is_lit_as_an_image_of_its_own_time() {
    let still = "(t_s: 0, latitude_deg: -3, longitude_deg: 0, height_m: 50000)";
    let text = scenario("columns: 6, rows: ROWS, field_of_view_deg: 9", "radiance, incidence");
    let (before, after) = (text.find("        (t_s: -60").unwrap(), text.find("    ]),\n    pointing").unwrap());
    let text = format!("{}        {still},\n{}", &text[..before], &text[after..]);
    let one =
        text.replace("ROWS", "12").replace("deg: 9", "deg: 9, shutter: PushFrame(interval_s: 600, framelet_rows: 4)");
    let one = Run::of(&one.replace("T15:00:00", "T15:10:00").replace("count: 3", "count: 1"));
    let three = Run::of(&text.replace("ROWS", "4").replace("step_s: 10", "step_s: 600"));
    one.succeed(&[]);
    three.succeed(&[]);
    let of_three: Vec<_> = (0..3).map(|index| plane(&three, index, "LOCALINCIDENCE")).collect();
    let of_one = plane(&one, 0, "LOCALINCIDENCE");
    for (band, expected_deg) in of_one.chunks(24).zip(&of_three) {
        assert!(band.iter().zip(expected_deg).all(|(a, b)| (a - b).abs() < 1e-4), "{band:?} {expected_deg:?}");
    }
    let moved_deg = (of_three[0][0] - of_three[2][0]).abs();
    assert!(moved_deg > 0.1, "{moved_deg}");
    let [light_of_one, light_of_three] = [plane(&one, 0, "RADIANCE"), plane(&three, 2, "RADIANCE")];
    assert!(light_of_one[48..].iter().zip(&light_of_three).all(|(a, b)| (a / b - 1.0).abs() < 1e-4));
}
