//! Photographs as archives hold them: ISIS cube and PDS4 by GDAL's writers, PDS3 by hand.

use std::path::Path;
use std::process::Command;

use gdal::raster::RasterCreationOptions;
use gdal::{Dataset, DriverManager};
use perilune_engine::raster::Picture;

use super::scene::{Case, Flight, PITCH_MM, PIXELS, isd, photograph, sun};

const FLIGHT: Flight = Flight { speed_m_s: 0.0, twist_rad: 0.3 };

fn case() -> Case {
    let sun = sun(290.0, 35.0);
    let middle = PIXELS as f64 / 2.0;
    let photo = photograph(&FLIGHT, sun, |column, row| {
        (0.0, [-(row + 0.5 - middle) * PITCH_MM, (column + 0.5 - middle) * PITCH_MM])
    });
    Case::new(&isd("USGS_ASTRO_FRAME_SENSOR_MODEL", &FLIGHT, sun), &photo)
}

fn copied(png: &Path, driver: &str, path: &Path) {
    let driver = DriverManager::get_driver_by_name(driver).unwrap();
    let png = Dataset::open(png).unwrap();
    png.create_copy(&driver, path, &RasterCreationOptions::default()).unwrap().close().unwrap();
}

/// A label of whole records and the samples after it, the high byte first.
fn write_pds3(values: &[f32], path: &Path) {
    let record_bytes = 2 * PIXELS;
    let label_records = 2;
    let label = format!(
        "PDS_VERSION_ID = PDS3\r\nRECORD_TYPE = FIXED_LENGTH\r\nRECORD_BYTES = {record_bytes}\r\n\
         FILE_RECORDS = {}\r\nLABEL_RECORDS = {label_records}\r\n^IMAGE = {}\r\nOBJECT = IMAGE\r\n  LINES = {PIXELS}\r\n\
         \x20 LINE_SAMPLES = {PIXELS}\r\n  SAMPLE_TYPE = MSB_UNSIGNED_INTEGER\r\n  SAMPLE_BITS = 16\r\n\
         END_OBJECT = IMAGE\r\nEND\r\n",
        PIXELS + label_records,
        label_records + 1
    );
    let mut bytes = label.into_bytes();
    assert!(bytes.len() <= label_records * record_bytes);
    bytes.resize(label_records * record_bytes, b' ');
    bytes.extend(values.iter().flat_map(|value| (*value as u16).to_be_bytes()));
    std::fs::write(path, bytes).unwrap();
}

#[test]
fn isis_pds4_and_pds3_photographs_are_read_as_the_png_is() {
    let case = case();
    let png = case.path("photo.png");
    let expected = Picture::open(&png, None).unwrap();
    // PDS4 keeps its samples beside its label, in photo.img.
    let [cube, pds4, pds3] = ["photo.cub", "photo.xml", "pds3.img"].map(|name| case.path(name));
    copied(&png, "ISIS3", &cube);
    copied(&png, "PDS4", &pds4);
    write_pds3(&expected.values, &pds3);
    for path in [&cube, &pds4, &pds3] {
        let picture = Picture::open(path, None).unwrap();
        assert_eq!((picture.columns, picture.rows), (PIXELS, PIXELS), "{}", path.display());
        assert!(picture.values == expected.values, "{}", path.display());
    }
    // Through the program, as a user has them: the same numbers to the last digit.
    let of_png = numbers(&case, &png);
    assert!(of_png["high_pass_correlation"].as_f64().unwrap() > 0.99, "{of_png}");
    for path in [&cube, &pds4, &pds3] {
        assert_eq!(numbers(&case, path), of_png, "{}", path.display());
    }
}

/// What `sim compare` finds.
fn numbers(case: &Case, photo: &Path) -> serde_json::Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sim"));
    command
        .arg("compare")
        .arg(photo)
        .arg("--geometry")
        .arg(case.path("isd.json"))
        .arg("--dem")
        .arg(case.path("dem.tif"));
    command.arg("--output").arg(case.path("report")).arg("--cache").arg(case.path("cache"));
    command.args(["--photometry", "lommel-seeliger", "--no-ablation", "--adapter", "cpu", "--json"]);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    report["numbers"].clone()
}
