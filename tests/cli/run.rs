//! `sim run` killed, resumed, repeated, and what it prints.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::fixtures::left_by_killed;

/// Four images of 64 × 64 pixels over 128 × 128 nodes, with shadows from horizon tiles.
pub const SMALL: &str = r#"(
    title: "a small descent",
    terrain: (dems: [
        Synthetic(columns: 128, rows: 128, posting_m: 20, latitude_deg: -89, longitude_deg: 0, seed: 1),
    ]),
    shadows: HorizonMaps(),
    horizon: Settings(azimuths: 64),
    trajectory: Waypoints(height_above: Terrain, points: [
        (t_s: 0, latitude_deg: -88.99, longitude_deg: 0, height_m: 1500),
        (t_s: 30, latitude_deg: -89, longitude_deg: 0, height_m: 900),
    ]),
    pointing: (towards: Nadir),
    camera: (columns: 64, rows: 64, field_of_view_deg: 40),
    exposures: Series(start: "2026-11-06T00:00:00 UTC", step_s: 10, count: 4),
    outputs: (planes: [radiance, sun_fraction, depth, dem_gap]),
)
"#;

/// A folder with a scenario, its cache and its output.
pub struct Run {
    pub folder: TempDir,
}

impl Run {
    pub fn of(scenario: &str) -> Self {
        let folder = TempDir::new().unwrap();
        std::fs::write(folder.path().join("small.ron"), scenario).unwrap();
        Self { folder }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The reference renderer: the same on every machine, with a GPU or without.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sim"));
        command.arg("run").arg(self.path("small.ron")).arg("--output").arg(self.path("out"));
        command.arg("--cache").arg(self.path("cache")).args(["--adapter", "cpu"]).args(arguments);
        command
    }

    pub fn sim(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    pub fn succeed(&self, arguments: &[&str]) -> String {
        let output = self.sim(arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    /// All files of the output, by name.
    pub fn files(&self) -> BTreeMap<String, Vec<u8>> {
        files(&self.path("out"))
    }
}

pub fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap());
    entries.map(|entry| (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap())).collect()
}

/// Names whose bytes differ, or that only one side has.
fn differing(a: &BTreeMap<String, Vec<u8>>, b: &BTreeMap<String, Vec<u8>>) -> Vec<String> {
    let names: std::collections::BTreeSet<_> = a.keys().chain(b.keys()).collect();
    names.into_iter().filter(|name| a.get(*name) != b.get(*name)).cloned().collect()
}

#[test]
fn the_same_scenario_makes_the_same_bytes_elsewhere_with_or_without_a_cache() {
    let [once, again] = [Run::of(SMALL), Run::of(SMALL)];
    once.succeed(&[]);
    again.succeed(&[]);
    let first = once.files();
    assert_eq!(first.keys().filter(|name| name.ends_with(".exr")).count(), 4);
    assert_eq!(differing(&first, &again.files()), Vec::<String>::new());
    std::fs::remove_dir_all(once.path("out")).unwrap();
    once.succeed(&[]);
    assert_eq!(differing(&first, &once.files()), Vec::<String>::new());
}

#[test]
fn another_seed_is_another_run_and_loses_nothing_of_the_first() {
    let run = Run::of(SMALL);
    run.succeed(&["--frames", "0..2"]);
    let first = run.files();
    std::fs::write(run.path("small.ron"), SMALL.replace("seed: 1", "seed: 2")).unwrap();
    for arguments in [&["--resume"][..], &[], &["--frames", "3", "--resume"]] {
        let output = run.sim(arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("holds 2 exposures of another run"), "{said}");
        assert!(said.contains("scenario.terrain.dems[0].Synthetic.seed was 1, is 2"), "{said}");
        assert!(said.contains("--overwrite") && said.contains("-o"), "{said}");
        assert_eq!(differing(&first, &run.files()), Vec::<String>::new());
    }
    run.succeed(&["--overwrite", "--frames", "3"]);
    let left = run.files();
    assert!(left.contains_key("exposure_0003.exr") && !left.contains_key("exposure_0000.exr"));
}

/// Comments, title and count are no part of what shapes the pixels.
#[test]
fn finished_exposures_stay_where_the_pixels_would_be_the_same() {
    let run = Run::of(SMALL);
    run.succeed(&[]);
    let first = run.files();
    let changes = [
        ("title: \"a small descent\"", "/* a comment */ title: \"another title\""),
        ("count: 4", "count: 3"),
        ("count: 3", "count: 4"),
        ("outputs: (", "outputs: (animation: false, preview: White(radiance_w_m2_sr: 20), "),
    ];
    let mut text = SMALL.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from));
        text = text.replace(from, to);
        std::fs::write(run.path("small.ron"), &text).unwrap();
        let said = run.succeed(&["--resume"]);
        assert!(said.contains("4 exposures in") && said.contains(", 0 rendered now"), "{said}");
        let changed = differing(&first, &run.files());
        assert!(!changed.iter().any(|name| name.ends_with(".exr")), "{changed:?}");
    }
    let longer = Run::of(&SMALL.replace("count: 4", "count: 2"));
    longer.succeed(&[]);
    std::fs::write(longer.path("small.ron"), SMALL).unwrap();
    let said = longer.succeed(&["--resume", "--frames", "2..4"]);
    assert!(said.contains("4 exposures in") && said.contains(", 2 rendered now"), "{said}");
    assert_eq!(differing(&first, &longer.files()), Vec::<String>::new());
}

#[test]
fn a_folder_with_other_files_is_refused_before_the_work() {
    let run = Run::of(SMALL);
    std::fs::create_dir(run.path("out")).unwrap();
    for name in ["exposure_0000.exr", "contact_sheet.png"] {
        std::fs::write(run.path("out").join(name), "mine").unwrap();
    }
    for arguments in [&[][..], &["--resume"]] {
        let output = run.sim(arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains("(contact_sheet.png, exposure_0000.exr)") && said.contains("--overwrite"), "{said}");
        assert!(!run.path("cache").exists());
    }
    assert!(run.files().values().all(|bytes| bytes == b"mine"));
}

#[test]
fn damage_is_noticed_told_and_mended() {
    let run = Run::of(SMALL);
    run.succeed(&[]);
    let whole = run.files();
    for name in ["exposure_0001.exr", "exposure_0002.png", "exposure_0003.json", "manifest.json"] {
        let mut bytes = whole[name].clone();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(run.path("out").join(name), bytes).unwrap();
        let output = run.sim(&["--resume"]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success() && said.contains(name), "{name}: {said}");
        assert_eq!(differing(&whole, &run.files()), Vec::<String>::new(), "{name}");
    }
}

/// Eight processes at once, each with its part, on a cold cache and one folder.
#[test]
fn parts_that_run_at_once_make_the_whole() {
    let scenario = SMALL.replace("step_s: 10, count: 4", "step_s: 4, count: 8").replace("azimuths: 64", "azimuths: 32");
    let [run, whole] = [Run::of(&scenario), Run::of(&scenario)];
    whole.succeed(&[]);
    let parts: Vec<_> = (0..8)
        .map(|part| {
            let mut command = run.command(&["--resume", "--frames", &format!("{part}")]);
            command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
        })
        .collect();
    for part in parts {
        let output = part.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    assert_eq!(differing(&whole.files(), &run.files()), Vec::<String>::new());
    let tiles = files(&run.path("cache/horizon"));
    assert!(tiles.keys().all(|name| name.ends_with(".tif")), "{:?}", tiles.keys());
}

/// The same exposures by two processes: each finds the other's, or makes the same.
#[test]
fn two_runs_of_the_same_exposures_do_not_harm_each_other() {
    let [run, whole] = [Run::of(SMALL), Run::of(SMALL)];
    whole.succeed(&[]);
    let spawn = || run.command(&["--resume"]).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    for child in [spawn(), spawn()] {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    assert_eq!(differing(&whole.files(), &run.files()), Vec::<String>::new());
}

/// Kills at ten moments spread over the time that a whole run takes, then resumes.
#[test]
fn a_killed_run_resumes_to_the_bytes_of_an_uninterrupted_one() {
    let whole = Run::of(SMALL);
    let start = Instant::now();
    whole.succeed(&[]);
    let (took, expected) = (start.elapsed(), whole.files());
    let mut interrupted = 0;
    for moment in 0..10 {
        let run = Run::of(SMALL);
        let mut child = run.command(&[]).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(took.mul_f64((f64::from(moment) + 0.5) / 10.5));
        // SIGKILL: nothing can be tidied up.
        child.kill().unwrap();
        interrupted += usize::from(!child.wait().unwrap().success());
        run.succeed(&["--resume"]);
        assert_eq!(differing(&expected, &run.files()), Vec::<String>::new(), "killed at moment {moment}");
        let tiles = files(&run.path("cache/horizon"));
        assert!(tiles.keys().all(|name| name.ends_with(".tif")), "{:?}", tiles.keys());
    }
    assert!(interrupted >= 5, "only {interrupted} of 10 runs were killed before their end");
}

#[test]
fn what_is_finished_is_not_rendered_again() {
    let run = Run::of(SMALL);
    let report = |arguments: &[&str]| -> serde_json::Value {
        serde_json::from_str(&run.succeed(&[arguments, &["--json"]].concat())).expect("JSON")
    };
    let first = report(&["--frames", "1..3"]);
    assert_eq!((first["rendered"].as_u64(), first["exposures"].as_u64()), (Some(2), Some(2)));
    let second = report(&["--resume"]);
    assert_eq!((second["rendered"].as_u64(), second["exposures"].as_u64()), (Some(2), Some(4)));
    assert_eq!(report(&["--resume"])["rendered"], 0);
    let whole = Run::of(SMALL);
    whole.succeed(&[]);
    assert_eq!(differing(&whole.files(), &run.files()), Vec::<String>::new());
}

#[test]
fn a_temporary_file_is_never_taken_for_an_exposure() {
    let run = Run::of(SMALL);
    run.succeed(&[]);
    let whole = run.files();
    for name in ["exposure_0002.exr", "exposure_0002.json"] {
        std::fs::rename(run.path("out").join(name), run.path("out").join(left_by_killed(name))).unwrap();
    }
    run.succeed(&["--resume"]);
    assert_eq!(differing(&whole, &run.files()), Vec::<String>::new());
}

/// A tile of other heights under the right name, and a tile cut short: made anew, to the same bytes.
#[test]
fn a_tile_of_another_terrain_or_a_truncated_one_is_rebuilt() {
    let [run, other] = [Run::of(SMALL), Run::of(&SMALL.replace("seed: 1", "seed: 2"))];
    run.succeed(&[]);
    other.succeed(&[]);
    let (expected, tiles) = (run.files(), files(&run.path("cache/horizon")));
    let (name, tile) = tiles.first_key_value().unwrap();
    let others = files(&other.path("cache/horizon")).into_values().next().unwrap();
    assert_ne!(*tile, others);
    for bad in [others.as_slice(), &tile[..tile.len() / 2], &[]] {
        std::fs::write(run.path("cache/horizon").join(name), bad).unwrap();
        std::fs::remove_dir_all(run.path("out")).unwrap();
        run.succeed(&[]);
        assert_eq!(differing(&tiles, &files(&run.path("cache/horizon"))), Vec::<String>::new());
        assert_eq!(differing(&expected, &run.files()), Vec::<String>::new());
    }
}

#[test]
fn exit_codes_tell_success_error_and_wrong_usage_apart() {
    let run = Run::of(SMALL);
    let code = |arguments: &[&str]| run.sim(arguments).status.code();
    assert_eq!(code(&["--frames", "0..1"]), Some(0));
    assert_eq!(code(&["--frames", "9..12"]), Some(1));
    assert_eq!(code(&["--frames", "one"]), Some(2));
    assert_eq!(code(&["--no-such-option"]), Some(2));
    let alone = Command::new(env!("CARGO_BIN_EXE_sim")).output().unwrap();
    assert_eq!(alone.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&alone.stderr).contains("First steps:"));
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    for arguments in [
        &["sun", "--at", "0,0", "--epoch", "2026-01-01Z", "--until", "2026-03-01Z", "--step", "1h"][..],
        &["schema"],
        &["schema", "--json"],
    ] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_sim"))
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        std::thread::sleep(Duration::from_millis(20));
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn check_looks_at_kernels_and_poses_without_making_terrain() {
    let check = |run: &Run, arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sim"));
        command.arg("check").arg(run.path("small.ron")).arg("--cache").arg(run.path("cache"));
        command.args(arguments).output().unwrap()
    };
    let run = Run::of(SMALL);
    let output = check(&run, &[]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && said.contains("4 exposures, no problems (terrain not made yet"), "{said}");
    assert!(!run.path("cache").exists() && !run.path("out").exists());

    let low = Run::of(&SMALL.replace("height_m: 1500", "height_m: -900").replace("height_m: 900", "height_m: -900"));
    assert!(check(&low, &[]).status.success());
    run.succeed(&["--frames", "0..1"]);
    std::fs::rename(run.path("cache"), low.path("cache")).unwrap();
    let output = check(&low, &["--json"]);
    assert_eq!(output.status.code(), Some(1));
    let said: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
    let problems = said["problems"].as_array().unwrap();
    let above = |problem: &serde_json::Value| problem["message"].as_str().unwrap().contains("the camera must be above");
    assert!(problems.len() == 4 && problems.iter().all(above), "{said}");
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["problems"].as_array().unwrap().len(), 4);

    let late = Run::of(&SMALL.replace("2026-11-06", "2041-01-07").replace("step_s: 10", "step_s: 86400"));
    let late = Run::of(&std::fs::read_to_string(late.path("small.ron")).unwrap().replace("t_s: 30", "t_s: 300000"));
    let output = check(&late, &[]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.lines().count() > 1 && said.contains("is outside the loaded coverage"), "{said}");
}
