//! A value of each format, read by Python.

use std::path::PathBuf;
use std::sync::OnceLock;

use perilune_engine::dataset::{ExrFile, Record, read_exr};
use serde_json::Value;

use super::{python, told};
use crate::cli::run::{Run, SMALL};

/// The pixel that `read.py` reads.
const ROW: usize = 20;
const COLUMN: usize = 41;

/// A dataset in all formats, made once.
fn dataset() -> PathBuf {
    static RUN: OnceLock<Run> = OnceLock::new();
    let run = RUN.get_or_init(|| {
        let formats = "planes: [radiance, depth, latitude], formats: [Exr, Png16, Fits, Npz, Coco, CraterChallenge, GeoTiff, Kitti, Tum, Oem, Aem]";
        let scenario = SMALL.replace("planes: [radiance, sun_fraction, depth, dem_gap]", formats);
        let run = Run::of(&scenario.replace("outputs:", "landmarks: (), outputs:"));
        run.succeed(&[]);
        run
    });
    run.path("out")
}

/// What `modules` read of the dataset.
fn read(modules: &str, format: &str) -> Option<Value> {
    let python = python(modules)?;
    Some(told(&python, "read.py", &[format, &dataset().display().to_string()]))
}

fn record() -> Record {
    serde_json::from_slice(&std::fs::read(dataset().join("exposure_0001.json")).unwrap()).unwrap()
}

fn rendered(channel: &str) -> f64 {
    let ExrFile { columns, channels, .. } = read_exr(&dataset().join("exposure_0001.exr")).unwrap();
    let (_, values) = channels.into_iter().find(|(name, _)| name == channel).unwrap();
    f64::from(values[ROW * columns + COLUMN])
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(values) => values.iter().flat_map(numbers).collect(),
        value => vec![value.as_f64().unwrap()],
    }
}

#[test]
fn openexr_reads_depth_and_header() {
    let Some(told) = read("OpenEXR", "exr") else { return };
    assert_eq!(told["depth_m"], rendered("DEPTH"));
    assert_eq!(told["channels"], serde_json::json!(["DEPTH", "LATITUDE", "RADIANCE"]));
    assert_eq!(told["frame_id"], "small/0001");
}

#[test]
fn gdal_reads_previews_of_16_bits() {
    let Some(told) = read("rasterio", "png") else { return };
    let white = record().preview.unwrap().white;
    assert_eq!(told["dtype"], "uint16");
    let expected = (rendered("RADIANCE") / white * 65535.0).round().min(65535.0);
    assert_eq!(told["dn"].as_f64(), Some(expected));
}

#[test]
fn astropy_reads_and_verifies_fits() {
    let Some(told) = read("astropy", "fits") else { return };
    let record = record();
    assert_eq!(told["depth_m"], rendered("DEPTH"));
    assert_eq!((&told["unit"], &told["radiance_unit"]), (&"m".into(), &"W / (sr m2)".into()));
    // 2026-11-06T00:00:10 UTC; 2026-11-06 is MJD 61350.
    assert!((told["mjd_utc"].as_f64().unwrap() - (61350.0 + 10.0 / 86400.0)).abs() < 1e-9, "{told}");
    assert_eq!(told["exposure_s"], record.facts.sensor.exposure_s);
    assert_eq!(told["run_key"], record.run_key);
    assert_eq!(told["kernels"], serde_json::json!(record.facts.inputs.kernels));
}

#[test]
fn numpy_reads_npz() {
    let Some(told) = read("numpy", "npz") else { return };
    let facts = record().facts;
    assert_eq!(told["depth_m"], rendered("DEPTH"));
    assert_eq!(told["dtype"], "float32");
    assert_eq!(numbers(&told["k"]), facts.camera.k.as_flattened());
    assert_eq!(numbers(&told["q_wxyz"]), facts.pose.q_wxyz);
    assert_eq!(numbers(&told["r_body_fixed_m"]), facts.pose.r_body_fixed_m);
    assert_eq!(told["tdb_s"], facts.epoch.tdb_s_past_j2000);
}

/// The cell that GDAL finds below the camera, which looks straight down, shows the ground there: its latitude is the camera's
/// within a cell's diagonal, and its depth the camera's height above the ground within what one cell of ground rises.
#[test]
fn gdal_finds_the_ground_below_the_camera_on_the_map() {
    let Some(told) = read("rasterio", "geotiff") else { return };
    assert_eq!(told["bands"], serde_json::json!(["DEPTH", "LATITUDE", "RADIANCE"]));
    let (pose, cell_m) = (record().facts.pose, told["cell_m"].as_f64().unwrap());
    let off_m = (told["latitude_deg"].as_f64().unwrap() - pose.latitude_deg).to_radians() * 1_737_400.0;
    // The value is of the nearest pixel's centre: another half of a pixel, about as large as a cell.
    assert!(off_m.abs() < 1.5 * cell_m && cell_m < 30.0, "{off_m} m, cells of {cell_m} m");
    let middle = read_exr(&dataset().join("exposure_0001.exr")).unwrap();
    let (_, depth) = middle.channels.iter().find(|(name, _)| name == "DEPTH").unwrap();
    let depth_m = f64::from(depth[32 * 64 + 32]);
    assert!((told["depth_m"].as_f64().unwrap() - depth_m).abs() < 3.0 * cell_m, "{told}, middle {depth_m} m");
}

#[test]
fn numpy_reads_poses_of_kitti_and_tum() {
    let Some(told) = read("numpy", "poses") else { return };
    let pose = record().facts.pose;
    let tum = numbers(&told["tum"][1]);
    assert_eq!(tum[1..4], pose.r_body_fixed_m);
    assert_eq!([tum[7], -tum[4], -tum[5], -tum[6]], pose.q_wxyz);
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let first = numbers(&told["kitti"][0]);
    assert!(first.iter().zip(identity).all(|(got, wanted)| (got - wanted).abs() < 1e-14), "{first:?}");
    // From the first camera to the second it goes down, along +z, by 200 m in 10 s of 30.
    let second = numbers(&told["kitti"][1]);
    assert!((second[11] - 200.0).abs() < 60.0, "{second:?}");
    assert_eq!(numbers(&told["times_s"]).len(), 4);
}

/// Times pass through TDB in text: a nanosecond there, and what a double of seconds past J2000 holds, 1e-7 s.
#[test]
fn a_ccsds_reader_reads_the_trajectory() {
    let Some(told) = read("oem", "oem") else { return };
    let facts = record().facts;
    assert_eq!((&told["center"], &told["scale"]), (&"MOON".into(), &"TDB".into()));
    assert!((told["tdb_s"].as_f64().unwrap() - facts.epoch.tdb_s_past_j2000).abs() < 1e-4, "{told}");
    let km = |metres: [f64; 3]| metres.map(|m| m * 1e-3).to_vec();
    let near = |got: Vec<f64>, wanted: Vec<f64>| got.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9);
    assert!(near(numbers(&told["position_km"]), km(facts.pose.r_body_fixed_m)), "{told}");
    assert!(near(numbers(&told["velocity_km_s"]), km(facts.pose.v_body_fixed_m_s)), "{told}");
}

#[test]
fn a_ccsds_reader_reads_the_attitude() {
    let Some(told) = read("ccsds_ndm", "aem") else { return };
    let (written, read) = (record().facts.pose.q_wxyz, numbers(&told["q_wxyz"]));
    assert_eq!((&told["to"], &told["direction"]), (&"CAMERA".into(), &"A2B".into()));
    // The same turn, whichever sign its quaternion has.
    let along: f64 = written.iter().zip(&read).map(|(a, b)| a * b).sum();
    assert!((along.abs() - 1.0).abs() < 1e-12 && read.len() == 4, "{told}");
}

/// A run whose path and attitude are the messages that another run wrote is that run again. Positions pass through TDB in text
/// (see above): at 20 m/s along the path and under the Moon's turning of 4.6 m/s 1e-4 s are 2 mm.
#[test]
fn messages_that_were_written_lead_the_camera_the_same_way() {
    let source = dataset();
    let again = Run::of(
        &SMALL
            .replace(
                "trajectory: Waypoints(height_above: Terrain, points: [",
                "trajectory: Oem(path: \"sequence_0000.oem\"), /*",
            )
            .replace("]),\n    pointing: (towards: Nadir)", "*/ pointing: (towards: Aem(path: \"sequence_0000.aem\"))"),
    );
    for name in ["sequence_0000.oem", "sequence_0000.aem"] {
        std::fs::copy(source.join(name), again.path(name)).unwrap();
    }
    again.succeed(&["--frames", "1..3"]);
    let bytes = std::fs::read(again.path("out/exposure_0001.json")).unwrap();
    let (led, own) = (serde_json::from_slice::<Record>(&bytes).unwrap().facts.pose, record().facts.pose);
    let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart(&led.r_body_fixed_m, &own.r_body_fixed_m) < 2e-3, "{led:?} {own:?}");
    // A quaternion and its negative are one attitude.
    let dot: f64 = led.q_wxyz.iter().zip(own.q_wxyz).map(|(a, b)| a * b).sum();
    assert!(dot.abs() > 1.0 - 1e-12, "{led:?} {own:?}");
}

/// The pixels that pycocotools finds in a mask are those of the ellipse beside it: its area is πab within the pixels on its rim,
/// its centroid the ellipse's centre within a pixel.
#[test]
fn pycocotools_reads_masks_that_are_their_ellipses() {
    let Some(told) = read("pycocotools.coco, numpy", "coco") else { return };
    let craters = told.as_array().unwrap();
    assert!(craters.len() > 10, "{} craters", craters.len());
    for crater in craters {
        let [ellipse, centroid] = ["ellipse", "centroid"].map(|key| numbers(&crater[key]));
        assert_eq!(crater["area"], crater["stated_area"]);
        assert_eq!(numbers(&crater["box"]), numbers(&crater["bbox"]));
        if crater["truncated"] == false {
            let (area, rim) = (std::f64::consts::PI * ellipse[2] * ellipse[3], 4.0 * (ellipse[2] + ellipse[3]));
            assert!((crater["area"].as_f64().unwrap() - area).abs() < 0.5 * rim, "{crater}");
            assert!((0..2).all(|axis| (centroid[axis] - ellipse[axis]).abs() < 1.0), "{crater}");
        }
    }
    let csv = std::fs::read_to_string(dataset().join("craters.csv")).unwrap();
    let header = "ellipseCenterX(px),ellipseCenterY(px),ellipseSemimajor(px),ellipseSemiminor(px),ellipseRotation(deg),\
                  inputImage,crater_classification";
    assert_eq!(csv.lines().next(), Some(header));
    let image = |line: &str| line.split(',').nth(5).map(String::from);
    assert!(
        csv.lines().skip(1).all(|line| line.split(',').count() == 7 && image(line).unwrap().starts_with("exposure_"))
    );
    assert!(csv.lines().count() > craters.len());
}
