//! What the program says while it works, when it is interrupted and when it fails; drafts.

use std::io::Read as _;
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::Value;

use super::run::{Run, SMALL};

/// Eighty images, one after the other.
fn long() -> Run {
    Run::of(&SMALL.replace("step_s: 10, count: 4", "step_s: 0.3, count: 80").replace("columns: 64", "columns: 256"))
}

#[test]
#[cfg(unix)]
fn an_interrupted_run_says_what_is_kept_and_how_to_go_on() {
    let run = long();
    let mut child = run.command(&[]).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    while !run.path("out/exposure_0002.json").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it has ended before it was interrupted");
        std::thread::sleep(Duration::from_millis(20));
    }
    // Half way there is something to look at, and to ask about.
    assert!(run.path("out/exposure_0000.png").exists());
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{said}");
    let (_, interrupted) = said.split_once("interrupted: ").expect(&said);
    let kept: usize = interrupted.split(' ').next().unwrap().parse().expect(&said);
    assert!(kept >= 3 && interrupted.contains(&format!("{kept} of 80 exposures kept in ")), "{said}");
    assert!(interrupted.contains("go on with: sim run ") && interrupted.trim_end().ends_with("--resume"), "{said}");
    let output =
        Command::new(env!("CARGO_BIN_EXE_sim")).args(["inspect", "--json"]).arg(run.path("out")).output().unwrap();
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["exposures_planned"], 80);
}

#[test]
fn without_a_terminal_progress_is_told_in_lines() {
    let run = Run::of(SMALL);
    let output = run.sim(&["--frames", "0..2"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && said.contains("rendering: 2 exposures\n"), "{said}");
    assert!(!said.contains('\u{1b}'), "{said:?}");
}

#[test]
fn errors_are_objects_where_json_is_asked_for() {
    let error = |run: &Run, arguments: &[&str]| -> (Option<i32>, Value) {
        let output = run.sim(&[arguments, &["--json"]].concat());
        (output.status.code(), serde_json::from_slice(&output.stderr).expect("one object"))
    };
    let run = Run::of(&SMALL.replace("columns: 64", "columns: 0").replace("rows: 64", "row: 64"));
    let (code, told) = error(&run, &[]);
    assert_eq!((code, &told["kind"]), (Some(1), &"scenario".into()));
    let problems = told["problems"].as_array().unwrap();
    assert!(problems.len() >= 2 && problems.iter().all(|problem| problem["line"].as_u64() > Some(1)), "{told}");
    assert!(told["path"].as_str().unwrap().ends_with("small.ron") && told["key"].as_str().unwrap().contains("camera"));

    let run = Run::of(SMALL);
    let (code, told) = error(&run, &["--frames", "7"]);
    assert_eq!((code, &told["kind"]), (Some(1), &"exposures".into()));
    let (code, told) = error(&run, &["--frames", "seven"]);
    assert_eq!((code, &told["kind"]), (Some(2), &"arguments".into()));
    std::fs::create_dir(run.path("out")).unwrap();
    std::fs::write(run.path("out/notes.txt"), "mine").unwrap();
    let (code, told) = error(&run, &[]);
    assert_eq!((code, &told["kind"], &told["key"]), (Some(1), &"output".into(), &Value::Null));
    assert!(told["path"].as_str().unwrap().ends_with("out") && told["message"].as_str().unwrap().contains("notes.txt"));
}

#[test]
fn a_draft_is_a_quarter_of_the_size_in_a_folder_of_its_own_and_says_so() {
    let run = Run::of(&SMALL.replace("HorizonMaps()", "HorizonMaps(), bounce: ()"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_sim"));
    command.args(["run", "small.ron", "--draft", "--frames", "1", "--cache", "cache", "--adapter", "cpu"]);
    let output = command.current_dir(run.folder.path()).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && said.contains("a draft: ") && said.contains("without bounce"), "{said}");
    let out = run.path("output/small-draft");
    let read = |name: &str| std::fs::read_to_string(out.join(name)).unwrap();
    let record: Value = serde_json::from_str(&read("exposure_0001.json")).unwrap();
    assert_eq!((&record["draft"], &record["camera"]["width"]), (&true.into(), &16.into()));
    let manifest: Value = serde_json::from_str(&read("manifest.json")).unwrap();
    assert_eq!(manifest["run"]["draft"], true);
    assert!(manifest["run"]["settings"]["shadows"].as_str().unwrap().starts_with("TowardsSun("), "{manifest}");
    assert!(read("dataset_card.md").contains("**A draft**"));
    let tiles: Vec<_> = std::fs::read_dir(run.path("cache/horizon")).into_iter().flatten().collect();
    assert!(tiles.is_empty(), "horizons all around were made");
}

/// A strided choice is what its list is.
#[test]
fn frames_may_be_listed_and_strided() {
    let [listed, strided] = [Run::of(SMALL), Run::of(SMALL)];
    listed.succeed(&["--frames", "3,1"]);
    strided.succeed(&["--frames", "1..4..2"]);
    assert!(listed.files() == strided.files());
    assert!(listed.path("out/exposure_0003.exr").exists() && !listed.path("out/exposure_0002.exr").exists());
}
