//! `sim run` with labels: landmarks, flow, hazards, changing shadows.

use perilune_engine::dataset::{ExrFile, LandmarkFile, read_exr};

use super::run::{Run, SMALL};

fn plane<'a>(file: &'a ExrFile, channel: &str) -> &'a [f32] {
    let found = file.channels.iter().find(|(name, _)| name == channel);
    found.map(|(_, values)| values.as_slice()).unwrap_or_else(|| panic!("no {channel}"))
}

fn exposure(run: &Run, index: usize) -> ExrFile {
    read_exr(&run.path(&format!("out/exposure_{index:04}.exr"))).unwrap()
}

fn with(scenario: &str, key: &str) -> String {
    format!("{}    {key},\n)\n", scenario.trim_end().trim_end_matches(')'))
}

#[test]
fn craters_of_the_terrain_are_listed_and_drawn() {
    let run = Run::of(&with(SMALL, "landmarks: (smallest_px: 4, overlay: true)"));
    run.succeed(&["--frames", "0..2"]);
    let text = std::fs::read(run.path("out/exposure_0001.landmarks.json")).unwrap();
    let file: LandmarkFile = serde_json::from_slice(&text).unwrap();
    assert!((file.columns, file.rows) == (64, 64) && file.landmarks.len() > 5, "{}", file.landmarks.len());
    let overlay = image::open(run.path("out/exposure_0001.landmarks.png")).unwrap().into_rgb8();
    assert!(overlay.pixels().any(|pixel| pixel.0[0] != pixel.0[1]), "nothing is drawn");
    let record = std::fs::read_to_string(run.path("out/exposure_0001.json")).unwrap();
    assert!(record.contains("exposure_0001.landmarks.json") && record.contains("exposure_0001.landmarks.png"));
    // Finished exposures stay as they are.
    let before = run.files();
    run.succeed(&["--frames", "0..2", "--resume"]);
    assert!(before == run.files());
}

#[test]
fn a_catalogue_that_cannot_be_read_is_an_error_before_any_work() {
    let run = Run::of(&with(SMALL, r#"landmarks: (lists: [File(path: "list.csv")])"#));
    std::fs::write(run.path("list.csv"), "id,latitude_deg,longitude_deg,diameter_m\n1,-89,0,-5\n").unwrap();
    let output = run.sim(&[]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && said.contains("list.csv:2: diameter_m = \"-5\""), "{said}");
    assert!(!run.path("out/manifest.json").exists());
    std::fs::write(run.path("list.csv"), "id,latitude_deg,longitude_deg,diameter_m\nmine,-89,0,500\n").unwrap();
    run.succeed(&["--frames", "3..4"]);
    let text = std::fs::read_to_string(run.path("out/exposure_0003.landmarks.json")).unwrap();
    assert!(text.contains("\"id\": \"mine\"") && text.contains("\"catalogue\""), "{text}");
}

const PLANES: &str = "planes: [radiance, sun_fraction, flow, covisible, flow_back, covisible_back, hazard_slope, \
                      hazard_roughness, hazard_sunlit, hazard, slope, aspect, north_azimuth, sun_azimuth, \
                      subsolar_ground_azimuth, ellipsoid_incidence, ellipsoid_emission, sun_illumination_mask]";

#[test]
fn label_planes_are_written_and_those_at_the_ends_are_empty() {
    let scenario = SMALL.replace("planes: [radiance, sun_fraction, depth, dem_gap]", PLANES);
    let run = Run::of(&with(&scenario, "hazards: (footprint_m: 60, slope_deg: 12, roughness_m: 5, sunlit_share: 0.5)"));
    run.succeed(&[]);
    let middle = 64 * 32 + 32;
    let files: Vec<ExrFile> = (0..4).map(|index| exposure(&run, index)).collect();
    assert!(plane(&files[3], "FLOW.X").iter().all(|x| x.is_nan()));
    assert!(plane(&files[0], "FLOW_BACK.X").iter().all(|x| x.is_nan()));
    let [x, y] = ["FLOW.X", "FLOW.Y"].map(|name| plane(&files[1], name)[middle]);
    assert!(x.is_finite() && y.is_finite() && plane(&files[1], "COVISIBLE")[middle] == 1.0, "{x} {y}");
    // Back from where it went: the flow varies by less than a pixel over half of one.
    let there = ((32.0 + y).round() * 64.0 + (32.0 + x).round()) as usize;
    let back = plane(&files[2], "FLOW_BACK.X")[there];
    assert!((back + x).abs() < 1.0, "{x} {back}");
    // North is up in a nadir image whose top is north: from right towards down that is 270°.
    let north = plane(&files[1], "NORTHAZIMUTH")[middle];
    assert!((north - 270.0).abs() < 1.0, "{north}");
    // The Sun's azimuth on the ground and in an image with north up differ by those 270°.
    let [sun, ground] = ["SUNAZIMUTH", "SUBSOLARGROUNDAZIMUTH"].map(|name| plane(&files[1], name)[middle]);
    assert!(((sun - ground - north).rem_euclid(360.0) - 180.0).abs() > 178.0, "{sun} {ground} {north}");
    for (name, low, high) in [
        ("SLOPE", 0.0, 60.0),
        ("ASPECT", 0.0, 360.0),
        ("INCIDENCE", 80.0, 92.0),
        ("EMISSION", 0.0, 25.0),
        ("HAZARD_SLOPE", 0.0, 60.0),
        ("HAZARD_ROUGHNESS", 0.0, 50.0),
        ("HAZARD_SUNLIT", 0.0, 1.0),
        ("HAZARD", 0.0, 1.0),
        ("SUNILLUMINATIONMASK", 0.0, 1.0),
    ] {
        let value = plane(&files[1], name)[middle];
        assert!((low..=high).contains(&value), "{name} = {value}");
    }
}

#[test]
fn shadow_changes_are_those_of_the_sun_and_of_a_camera_that_stands_still() {
    let still = SMALL
        .replace("(t_s: 30, latitude_deg: -89, longitude_deg: 0, height_m: 900),", "")
        .replace("step_s: 10", "step_s: 36000")
        .replace("dem_gap]", "shadow_change]");
    let run = Run::of(&still);
    run.succeed(&[]);
    let files: Vec<ExrFile> = (0..4).map(|index| exposure(&run, index)).collect();
    assert!(plane(&files[0], "SHADOW_CHANGE").iter().all(|change| change.is_nan()));
    let mut changed = 0;
    for index in 1..4 {
        let [before, now] = [index - 1, index].map(|index| plane(&files[index], "SUN_FRACTION"));
        for (pixel, change) in plane(&files[index], "SHADOW_CHANGE").iter().enumerate() {
            let lit = |fraction: f32| f32::from(u8::from(fraction >= 0.5));
            assert_eq!(*change, lit(now[pixel]) - lit(before[pixel]), "exposure {index}, pixel {pixel}");
            changed += usize::from(*change != 0.0);
        }
    }
    assert!(changed > 50, "{changed}");
    // A part of the sequence has the same planes.
    let part = Run::of(&still);
    part.succeed(&["--frames", "2..3"]);
    assert!(plane(&exposure(&part, 2), "SHADOW_CHANGE") == plane(&files[2], "SHADOW_CHANGE"));

    let moving = Run::of(&SMALL.replace("dem_gap]", "shadow_change]"));
    let said = String::from_utf8(moving.sim(&[]).stderr).unwrap();
    assert!(said.contains("shadow_change needs a camera that stands still; before exposure 1 it moves by"), "{said}");
}

#[test]
fn ground_below_the_posting_of_a_file_is_made_listed_and_marked() {
    let run = Run::of("");
    let file = run.path("measured.tif");
    let terrain = std::process::Command::new(env!("CARGO_BIN_EXE_sim"))
        .args(["terrain", "--columns", "96", "--rows", "96", "--posting", "40", "--seed", "5", "-o"])
        .arg(&file)
        .output()
        .unwrap();
    assert!(terrain.status.success());
    let synthetic = "Synthetic(columns: 128, rows: 128, posting_m: 20, latitude_deg: -89, longitude_deg: 0, seed: 1),";
    let models = r#"Detail(posting_m: 10, extent_m: 900, seed: 2), File(path: "measured.tif"),"#;
    let scenario = SMALL.replace(synthetic, models).replace("dem_gap]", "invented_height, latitude]");
    std::fs::write(run.path("small.ron"), with(&scenario, "landmarks: (smallest_px: 1)")).unwrap();
    run.succeed(&["--frames", "3..4"]);
    let image = exposure(&run, 3);
    let invented = plane(&image, "INVENTED_HEIGHT");
    // 900 m below: 655 m across are seen, all of them made up; in the middle of it nothing fades.
    let rms_m = (invented.iter().map(|height_m| height_m * height_m).sum::<f32>() / invented.len() as f32).sqrt();
    assert!((0.05..20.0).contains(&rms_m), "{rms_m}");
    let text = std::fs::read_to_string(run.path("out/exposure_0003.landmarks.json")).unwrap();
    assert!(text.contains("\"origin\": \"invented\""), "{text}");
    let manifest = std::fs::read_to_string(run.path("out/manifest.json")).unwrap();
    assert!(manifest.contains("share_of_squared_slope"), "{manifest}");

    std::fs::write(run.path("small.ron"), scenario.replace(r#" File(path: "measured.tif"),"#, "")).unwrap();
    let said = String::from_utf8(run.sim(&[]).stderr).unwrap();
    assert!(said.contains("terrain.dems[0] must be the first model and be followed by the File"), "{said}");
}
