use super::*;
use crate::dataset::png_file;
use crate::dataset::preview;
use crate::render::{Plane, Quantity};
use std::collections::BTreeMap;
use std::fs;
use tempfile::TempDir;

fn run() -> Run {
    Run { title: "a test".into(), name: "test".into(), made_from: serde_json::json!({ "seed": 1 }), ..Run::default() }
}

/// What so many exposures have of their own.
fn own(count: usize) -> Vec<Json> {
    (0..count).map(|index| serde_json::json!({ "epoch": 10 * index })).collect()
}

const RESUME: Existing = Existing { resume: true, overwrite: false };
const OVERWRITE: Existing = Existing { resume: false, overwrite: true };

const SETTINGS: Settings =
    Settings { tiff: true, animation: true, overlay: true, white: White::Auto, formats: Vec::new() };

fn open(folder: &Path) -> Writer {
    Writer::open(folder, run(), own(4), SETTINGS, Existing::default()).unwrap()
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
    let record = fs::read_to_string(folder.path().join("exposure_0000.json")).unwrap();
    let preview = Record::parse(&record).unwrap().preview.unwrap();
    assert_eq!((preview.white, preview.unit.as_str()), (188.0, "W m-2 sr-1"));
    let png = fs::read(folder.path().join("exposure_0000.png")).unwrap();
    let comment = png_file::comment(&png).unwrap();
    assert_eq!(comment, "RADIANCE [W m-2 sr-1], sRGB: white is 1.88e2 W m-2 sr-1");
    let grey = image::load_from_memory(&png).unwrap().into_luma8();
    // Exposure 0 reaches a quarter of white, grey 137 in sRGB; pixel 5 has no value.
    assert_eq!((grey.as_raw()[47], grey.as_raw()[5]), (137, 0));
}

/// The brightest exposure comes last: earlier ones were shown brighter until then.
#[test]
fn a_preview_is_there_with_its_exposure_and_is_made_again_on_the_scale_of_the_sequence() {
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut writer = open(folder.path());
    writer.submit(exposure(0)).unwrap();
    writer.join().unwrap();
    let early = fs::read(path("exposure_0000.png")).unwrap();
    assert!(png_file::comment(&early).unwrap().contains("white is 4.7e1 W m-2 sr-1; white may rise"));
    assert!(!path("contact_sheet.png").exists());
    drop(writer);
    write(folder.path(), [3]);
    let late = fs::read(path("exposure_0000.png")).unwrap();
    assert!(png_file::comment(&late).unwrap().ends_with("white is 1.88e2 W m-2 sr-1"));
    let other = TempDir::new().unwrap();
    write(other.path(), [0, 3]);
    assert_eq!(files(other.path()), files(folder.path()));
}

/// IEC 61966-2-1: the same light in preview, contact sheet and film, and 16 bits linear on the same scale.
#[test]
fn preview_sheet_film_and_linear_preview_show_the_same() {
    let folder = TempDir::new().unwrap();
    let settings = Settings { formats: vec![Format::Png16], ..SETTINGS };
    let mut writer = Writer::open(folder.path(), run(), own(4), settings, RESUME).unwrap();
    writer.submit(exposure(1)).unwrap();
    writer.finish().unwrap();
    let image = |name: &str| image::open(folder.path().join(name)).unwrap();
    let grey = image("exposure_0001.png").into_luma8();
    let sheet = image("contact_sheet.png").into_luma8();
    assert_eq!(sheet.get_pixel(4 + 7, 4 + 14 + 5), grey.get_pixel(7, 5));
    assert_eq!(image("preview.gif").into_luma8().as_raw(), grey.as_raw());
    let linear = image("exposure_0001.linear.png").into_luma16();
    let shown = |pixel: usize| preview::srgb(f64::from(linear.as_raw()[pixel]) / 65535.0);
    assert!((0..48).all(|pixel| shown(pixel).abs_diff(grey.as_raw()[pixel]) <= 1));
    let manifest = fs::read_to_string(folder.path().join(MANIFEST)).unwrap();
    assert!(manifest.contains("exposure_0001.linear.png"));
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
    assert_eq!([0, 3].map(|index| writer.state(index)), [State::Done, State::Missing]);
    let changed = State::Damaged("exposure_0001.exr has not the SHA-256 that its record states".into());
    assert_eq!(writer.state(1), changed);
    assert!(matches!(writer.state(2), State::Damaged(why) if why.starts_with("exposure_0002.json is damaged: ")));
    drop(writer);
    // A changed number, in a record that reads well.
    let json = fs::read_to_string(path("exposure_0000.json")).unwrap();
    fs::write(path("exposure_0000.json"), json.replace("\"count\": 47", "\"count\": 46")).unwrap();
    let writer = open(folder.path());
    let changed = "exposure_0000.json is damaged: it has not the SHA-256 that it states";
    assert_eq!(writer.state(0), State::Damaged(changed.into()));
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
    let missing: Vec<usize> = (0..4).filter(|index| writer.state(*index) != State::Done).collect();
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
    let mut before = files(folder.path());
    open(folder.path());
    let mut after = files(folder.path());
    before.remove(MANIFEST);
    after.remove(MANIFEST);
    assert_eq!(after, before);
    writing.commit().unwrap();
}

fn other_run() -> Run {
    Run { made_from: serde_json::json!({ "seed": 7 }), ..run() }
}

#[test]
fn exposures_of_another_run_stay_unless_they_may_be_lost() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), 0..4);
    fs::write(folder.path().join("exposure_0001.notes"), "mine").unwrap();
    let before = files(folder.path());
    for existing in [Existing::default(), RESUME] {
        let error = Writer::open(folder.path(), other_run(), own(4), SETTINGS, existing).unwrap_err().to_string();
        assert!(error.contains("holds 4 exposures of another run: seed was 1, is 7; choose another output"), "{error}");
        assert_eq!(files(folder.path()), before);
    }
    let writer = Writer::open(folder.path(), other_run(), own(4), SETTINGS, OVERWRITE).unwrap();
    assert!((0..4).all(|index| writer.state(index) == State::Missing));
    let left: Vec<String> = files(folder.path()).into_keys().collect();
    assert_eq!(left, ["exposure_0001.notes", "manifest.json"]);
}

#[test]
fn an_exposure_of_another_epoch_is_named_and_the_others_may_stay() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), 0..4);
    let mut changed = own(4);
    changed[2] = serde_json::json!({ "epoch": 21 });
    let open = |existing| Writer::open(folder.path(), run(), changed.clone(), SETTINGS, existing);
    let error = open(RESUME).unwrap_err().to_string();
    assert!(error.contains("exposures[2].epoch was 20, is 21"), "{error}");
    let writer = open(Existing { resume: true, overwrite: true }).unwrap();
    let states = [0, 1, 2, 3].map(|index| writer.state(index));
    assert_eq!(states, [State::Done, State::Done, State::Missing, State::Done]);
}

#[test]
fn a_sequence_may_grow_and_what_is_beyond_the_end_of_a_shorter_one_stays() {
    let [grown, whole] = [TempDir::new().unwrap(), TempDir::new().unwrap()];
    let write = |folder: &TempDir, count: usize, indices: &[usize]| {
        let mut writer = Writer::open(folder.path(), run(), own(count), SETTINGS, RESUME).unwrap();
        let todo: Vec<usize> = indices.iter().copied().filter(|index| writer.state(*index) != State::Done).collect();
        todo.iter().for_each(|index| writer.submit(exposure(*index)).unwrap());
        (todo.len(), writer.finish().unwrap())
    };
    write(&whole, 6, &[0, 1, 2, 3, 4, 5]);
    write(&grown, 4, &[0, 1, 2, 3]);
    assert_eq!(write(&grown, 6, &[0, 1, 2, 3, 4, 5]).0, 2);
    assert_eq!(files(grown.path()), files(whole.path()));
    let (rendered, summary) = write(&grown, 4, &[0, 1, 2, 3]);
    assert_eq!((rendered, summary.exposures, summary.planned), (0, 6, 6));
    assert_eq!(files(grown.path()), files(whole.path()));
}

#[test]
fn files_of_other_programs_stay() {
    let folder = TempDir::new().unwrap();
    for name in ["notes.txt", "exposure_notes.txt", "a.partial"] {
        fs::write(folder.path().join(name), "mine").unwrap();
    }
    fs::write(folder.path().join(left_by_killed("manifest.json")), "half").unwrap();
    let open = |existing| Writer::open(folder.path(), run(), own(4), SETTINGS, existing);
    let error = open(Existing::default()).unwrap_err().to_string();
    assert!(error.contains("holds files that no run has made (a.partial, exposure_notes.txt, notes.txt)"), "{error}");
    open(RESUME).unwrap().finish().unwrap();
    let names: Vec<String> = files(folder.path()).into_keys().collect();
    assert_eq!(
        names,
        ["a.partial", "dataset_card.md", "exposure_notes.txt", "manifest.json", "notes.txt", "poses.csv"]
    );
}

/// Names of the sequence that somebody else has used: never written over, nor taken for finished.
#[test]
fn files_of_the_same_names_are_refused_and_stay() {
    for name in ["exposure_0003.exr", "exposure_0000.json", "contact_sheet.png", "manifest.json"] {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join(name), "{\"mine\": 1}").unwrap();
        for existing in [Existing::default(), RESUME] {
            let error = Writer::open(folder.path(), run(), own(4), SETTINGS, existing).unwrap_err().to_string();
            assert!(error.contains(&format!("no run has made ({name})")), "{error}");
        }
        assert_eq!(fs::read(folder.path().join(name)).unwrap(), b"{\"mine\": 1}");
        Writer::open(folder.path(), run(), own(4), SETTINGS, OVERWRITE).unwrap();
    }
    // Beyond the end of the sequence a name is free.
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("exposure_0004.exr"), "mine").unwrap();
    Writer::open(folder.path(), run(), own(4), SETTINGS, RESUME).unwrap();
    let error = Writer::open(folder.path(), run(), own(5), SETTINGS, RESUME).unwrap_err().to_string();
    assert!(error.contains("no run has made (exposure_0004.exr)"), "{error}");
}

#[test]
fn a_damaged_manifest_is_told_and_made_anew() {
    let folder = TempDir::new().unwrap();
    write(folder.path(), 0..4);
    let before = files(folder.path());
    let manifest = String::from_utf8(before[MANIFEST].clone()).unwrap();
    fs::write(folder.path().join(MANIFEST), manifest.replace("\"exposures_planned\": 4", "\"exposures_planned\": 3"))
        .unwrap();
    let writer = Writer::open(folder.path(), run(), own(4), SETTINGS, RESUME).unwrap();
    assert!(writer.notes()[0].contains("manifest.json is damaged: it has not the SHA-256 that it states"));
    writer.finish().unwrap();
    assert_eq!(files(folder.path()), before);
    fs::write(folder.path().join(MANIFEST), "{").unwrap();
    let error = Writer::open(folder.path(), other_run(), own(4), SETTINGS, RESUME).unwrap_err().to_string();
    assert!(error.contains("4 exposures of another run") && error.contains("manifest.json is damaged"), "{error}");
}

/// Of two runs at once the last to end lists the exposures of both, whoever began first.
#[test]
fn two_runs_at_once_end_in_one_whole_dataset() {
    let [both, whole] = [TempDir::new().unwrap(), TempDir::new().unwrap()];
    write(whole.path(), 0..4);
    let resumed = || Writer::open(both.path(), run(), own(4), SETTINGS, RESUME).unwrap();
    let [mut first, mut second] = [resumed(), resumed()];
    first.submit(exposure(0)).unwrap();
    second.submit(exposure(3)).unwrap();
    second.submit(exposure(1)).unwrap();
    second.finish().unwrap();
    first.submit(exposure(2)).unwrap();
    first.finish().unwrap();
    assert_eq!(files(both.path()), files(whole.path()));
}

#[test]
fn an_output_that_is_a_file_is_refused() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("file");
    fs::write(&path, "").unwrap();
    let error = Writer::open(&path, run(), own(1), SETTINGS, RESUME).unwrap_err();
    assert_eq!(error.to_string(), format!("the output {} is a file, not a directory", path.display()));
}

#[test]
fn an_output_below_a_file_cannot_be_created() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    let error = Writer::open(&folder.path().join("file/inside"), run(), own(1), SETTINGS, RESUME).unwrap_err();
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
