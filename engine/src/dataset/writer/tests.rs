use super::exposure_writer::read_record;
use super::*;
use crate::render::{Plane, Quantity};
use std::collections::BTreeMap;
use std::fs;
use tempfile::TempDir;

fn run() -> Run {
    Run { title: "a test".into(), name: "test".into(), ..Run::default() }
}

const SETTINGS: Settings =
    Settings { tiff: true, animation: true, overlay: true, white: White::Auto, formats: Vec::new() };

fn open(folder: &Path) -> Writer {
    Writer::open(folder, run(), 4, SETTINGS).unwrap()
}

fn exposure(index: usize) -> Exposure {
    let values = |scale: f32| (0..48).map(|pixel| if pixel == 5 { f32::NAN } else { scale * pixel as f32 }).collect();
    let planes = vec![
        Plane { quantity: Quantity::Radiance, name: "RADIANCE", values: values(1.0 + index as f32) },
        Plane { quantity: Quantity::Depth, name: "DEPTH", values: values(1e3) },
    ];
    let facts = ExposureMetadata { frame_id: format!("test/{index:04}"), ..ExposureMetadata::default() };
    let image = Image { columns: 8, rows: 6, planes };
    Exposure { index, image, facts, landmarks: None, orthoimage: None }
}

fn write(folder: &Path, indices: impl IntoIterator<Item = usize>) -> Summary {
    let mut writer = open(folder);
    for index in indices {
        writer.submit(exposure(index)).unwrap();
    }
    writer.finish().unwrap()
}

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries.map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap())).collect()
}

#[test]
fn a_sequence_has_all_its_files_and_no_others() {
    let folder = TempDir::new().unwrap();
    let summary = write(folder.path(), 0..4);
    assert_eq!(summary.exposures, 4);
    let names: Vec<String> = files(folder.path()).into_keys().collect();
    let mut expected: Vec<String> =
        ["contact_sheet.png", "dataset_card.md", "manifest.json", "poses.csv", "preview.gif"].map(String::from).into();
    for index in 0..4 {
        expected.extend(["exr", "json", "png", "tif"].map(|extension| format!("exposure_{index:04}.{extension}")));
    }
    expected.sort();
    assert_eq!(names, expected);
}

#[test]
fn the_same_run_makes_the_same_bytes_in_any_order_and_in_any_number_of_parts() {
    let [one, other] = [TempDir::new().unwrap(), TempDir::new().unwrap()];
    write(one.path(), 0..4);
    write(other.path(), [2, 0]);
    write(other.path(), [3, 1]);
    assert_eq!(files(one.path()), files(other.path()));
}

#[test]
fn white_is_the_brightest_exposures_quantile_and_stands_in_record_and_preview() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), 0..4);
    // 47 values; rank 0.995 · 46 = 45.77 rounds to the largest: 47 · 4.
    let record = read_record(&folder.path().join("exposure_0000.json")).unwrap();
    let preview = record.preview.unwrap();
    assert_eq!((preview.white, preview.unit.as_str()), (188.0, "W m-2 sr-1"));
    let png = fs::read(folder.path().join("exposure_0000.png")).unwrap();
    let comment = png_file::comment(&png).unwrap();
    assert_eq!(comment, "RADIANCE [W m-2 sr-1], linear: DN 65535 = 1.88e2 W m-2 sr-1");
    let dn = image::load_from_memory(&png).unwrap().into_luma16();
    // Exposure 0 reaches a quarter of white; pixel 5 has no value.
    assert_eq!((dn.as_raw()[47], dn.as_raw()[5]), (16384, 0));
}

#[test]
fn an_exposure_is_done_only_when_record_and_files_are_whole() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), [0, 1, 2]);
    let path = |name: &str| folder.path().join(name);
    let exr = fs::read(path("exposure_0001.exr")).unwrap();
    fs::write(path("exposure_0001.exr"), &exr[..exr.len() - 7]).unwrap();
    let json = fs::read(path("exposure_0002.json")).unwrap();
    fs::write(path("exposure_0002.json"), &json[..json.len() / 2]).unwrap();
    let writer = open(folder.path());
    let done: Vec<usize> = (0..4).filter(|index| writer.done(*index)).collect();
    assert_eq!(done, [0]);
}

#[test]
fn a_run_that_was_killed_is_finished_with_the_same_bytes() {
    let [whole, killed] = [TempDir::new().unwrap(), TempDir::new().unwrap()];
    write(whole.path(), 0..4);
    write(killed.path(), 0..4);
    // Killed while exposure 3 was written: no record, half of the planes under another name.
    for name in ["exposure_0003.json", "exposure_0003.png", "manifest.json", "preview.gif"] {
        fs::remove_file(killed.path().join(name)).unwrap();
    }
    fs::rename(killed.path().join("exposure_0003.exr"), killed.path().join(left_by_killed("exposure_0003.exr")))
        .unwrap();
    let mut writer = open(killed.path());
    let missing: Vec<usize> = (0..4).filter(|index| !writer.done(*index)).collect();
    assert_eq!(missing, [3]);
    writer.submit(exposure(3)).unwrap();
    writer.finish().unwrap();
    assert_eq!(files(whole.path()), files(killed.path()));
}

/// The temporary name of a process that is gone.
fn left_by_killed(name: &str) -> String {
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let host: String = host.trim().chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    // Above the largest number that Linux gives to a process.
    format!(".{name}.{}-4194305-0123456789abcdef.partial", &host[..host.len().min(32)])
}

/// Exposure 2 has its planes and not yet its record: another process of the run is writing it.
#[test]
fn files_that_another_process_is_writing_stay() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), 0..3);
    fs::remove_file(folder.path().join("exposure_0002.json")).unwrap();
    fs::remove_file(folder.path().join(MANIFEST)).unwrap();
    let writing = crate::files::NewFile::create(&folder.path().join("exposure_0003.exr")).unwrap();
    let before = files(folder.path());
    open(folder.path());
    assert_eq!(files(folder.path()), before);
    writing.commit().unwrap();
}

#[test]
fn exposures_of_another_run_are_not_taken_for_this_one() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), 0..4);
    let other = Run { seed: 7, ..run() };
    let writer = Writer::open(folder.path(), other, 4, SETTINGS).unwrap();
    assert!((0..4).all(|index| !writer.done(index)));
    assert_eq!(files(folder.path()).len(), 0);
}

#[test]
fn files_of_other_programs_stay() {
    let folder = TempDir::new().unwrap();
    for name in ["notes.txt", "exposure_notes.txt", "a.partial"] {
        fs::write(folder.path().join(name), "mine").unwrap();
    }
    fs::write(folder.path().join(left_by_killed("manifest.json")), "half").unwrap();
    open(folder.path()).finish().unwrap();
    let names: Vec<String> = files(folder.path()).into_keys().collect();
    assert_eq!(
        names,
        ["a.partial", "dataset_card.md", "exposure_notes.txt", "manifest.json", "notes.txt", "poses.csv"]
    );
}

#[test]
fn an_output_that_is_a_file_is_refused() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("file");
    fs::write(&path, "").unwrap();
    let error = Writer::open(&path, run(), 1, SETTINGS).unwrap_err();
    assert_eq!(error.to_string(), format!("the output {} is a file, not a directory", path.display()));
}

#[test]
fn an_output_below_a_file_cannot_be_created() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    let error = Writer::open(&folder.path().join("file/inside"), run(), 1, SETTINGS).unwrap_err();
    assert!(error.to_string().starts_with("cannot create the output directory "), "{error}");
}

#[test]
fn a_failed_write_stops_the_run_with_its_reason_and_leaves_no_remains() {
    let folder = TempDir::new().unwrap();
    let mut writer = open(folder.path());
    fs::create_dir_all(folder.path().join("exposure_0000.exr/inside")).unwrap();
    writer.submit(exposure(0)).unwrap();
    let error = (1..100).find_map(|index| writer.submit(exposure(index % 4)).err()).expect("the thread has ended");
    let said = error.to_string();
    assert!(said.contains("cannot write ") && said.contains("exposure_0000.exr: "), "{error}");
    let names = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert!(names.into_iter().all(|name| !name.ends_with(".partial")));
}

#[test]
fn a_plane_of_the_wrong_size_is_refused() {
    let folder = TempDir::new().unwrap();
    let mut writer = open(folder.path());
    let mut wrong = exposure(0);
    wrong.image.planes[1].values.pop();
    writer.submit(wrong).unwrap();
    let error = writer.finish().unwrap_err();
    assert_eq!(error.to_string(), "the plane DEPTH of exposure 0 has 47 values, allowed are 8 × 6");
}
