//! What `sim inspect` says of each kind of file.

use std::path::Path;
use std::process::Command;

use perilune_engine::dataset::{Existing, Exposure, ExposureMetadata, Run, Settings, White, Writer};
use perilune_engine::render::{Image, Plane, Quantity};
use serde_json::Value;
use tempfile::TempDir;

/// A dataset of two exposures of 4 × 2 pixels with the values 0, 2, … 14.
fn dataset() -> TempDir {
    let folder = TempDir::new().unwrap();
    let run = Run { title: "a test".into(), name: "test".into(), ..Run::default() };
    let settings = Settings { tiff: true, animation: true, overlay: false, white: White::Auto, formats: Vec::new() };
    let mut writer = Writer::open(folder.path(), run, vec![Value::Null; 2], settings, Existing::default()).unwrap();
    for index in 0..2 {
        let values = (0..8).map(|pixel| 2.0 * pixel as f32).collect();
        let planes = vec![Plane { quantity: Quantity::Radiance, name: "RADIANCE", values }];
        let facts = ExposureMetadata { frame_id: format!("test/{index:04}"), ..ExposureMetadata::default() };
        writer
            .submit(Exposure {
                index,
                image: Image { columns: 4, rows: 2, planes },
                facts,
                landmarks: None,
                orthoimage: None,
            })
            .unwrap();
    }
    writer.finish().unwrap();
    folder
}

fn inspect(path: &Path) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_sim")).args(["inspect", "--json"]).arg(path).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn an_image_shows_its_channels_units_and_values() {
    let folder = dataset();
    let found = inspect(&folder.path().join("exposure_0001.exr"));
    assert_eq!(
        (found["kind"].as_str(), found["columns"].as_u64(), found["rows"].as_u64()),
        (Some("OpenEXR"), Some(4), Some(2))
    );
    let channel = &found["channels"][0];
    assert_eq!((channel["channel"].as_str(), channel["unit"].as_str()), (Some("RADIANCE"), Some("W m-2 sr-1")));
    assert_eq!(
        (channel["statistics"]["minimum"].as_f64(), channel["statistics"]["maximum"].as_f64()),
        (Some(0.0), Some(14.0))
    );
    assert_eq!(found["metadata"]["facts"]["frame_id"], "test/0001");
}

#[test]
fn a_preview_states_its_scale_and_a_tiff_its_pages() {
    let folder = dataset();
    let preview = inspect(&folder.path().join("exposure_0000.png"));
    assert_eq!(preview["comment"], "RADIANCE [W m-2 sr-1], sRGB: white is 1.4e1 W m-2 sr-1");
    assert_eq!(preview["statistics_16_bit"]["maximum"], 65535.0);
    let tiff = inspect(&folder.path().join("exposure_0000.tif"));
    assert_eq!(tiff["pages"][0]["description"], "RADIANCE [W m-2 sr-1]");
    assert_eq!(inspect(&folder.path().join("exposure_0000.json"))["kind"], "record");
    assert_eq!(inspect(&folder.path().join("manifest.json"))["kind"], "manifest");
}

#[test]
fn a_dataset_tells_which_of_its_files_are_missing_or_changed() {
    let folder = dataset();
    assert_eq!(inspect(folder.path())["missing_or_changed"], Value::Array(Vec::new()));
    std::fs::write(folder.path().join("poses.csv"), "edited").unwrap();
    std::fs::remove_file(folder.path().join("exposure_0001.png")).unwrap();
    let found = inspect(folder.path());
    assert_eq!(found["missing_or_changed"], serde_json::json!(["exposure_0001.png", "poses.csv"]));
    assert_eq!((found["exposures"].as_u64(), found["files"].as_u64()), (Some(2), Some(12)));
}

#[test]
fn what_is_no_image_and_no_dataset_is_named() {
    let folder = TempDir::new().unwrap();
    let text = folder.path().join("notes.txt");
    std::fs::write(&text, "hello").unwrap();
    let cut = folder.path().join("cut.exr");
    std::fs::write(&cut, [0x76, 0x2f, 0x31, 0x01, 2, 0]).unwrap();
    for (path, said) in [
        (text.as_path(), "is none of OpenEXR, PNG, TIFF, NPZ, COCO, a record, a manifest"),
        (cut.as_path(), "as OpenEXR: "),
        (folder.path(), "holds no manifest.json, so it is no dataset"),
        (Path::new("/nowhere.exr"), "cannot read /nowhere.exr: "),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_sim")).arg("inspect").arg(path).output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1));
        assert!(error.contains(said), "{error}");
    }
}
