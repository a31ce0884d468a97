//! Where made terrain and horizons are kept, and how they are listed and cleaned.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use super::run::{Run, SMALL};

/// `sim` in a folder, with a home of its own and nothing else that names a folder for caches.
fn sim(run: &Run, arguments: &[&str], home: Option<&Path>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sim"));
    for variable in ["XDG_CACHE_HOME", "SIM_CACHE", "SIM_CACHE_GB", "HOME"] {
        command.env_remove(variable);
    }
    if let Some(home) = home {
        command.env("HOME", home);
    }
    command.args(arguments).current_dir(run.folder.path()).output().unwrap()
}

fn told(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

const ONE: [&str; 6] = ["run", "small.ron", "--adapter", "cpu", "--frames", "0"];

#[test]
#[cfg(target_os = "linux")]
fn the_cache_lies_in_the_users_folder_whichever_folder_a_command_runs_in() {
    let run = Run::of(SMALL);
    let home = run.path("home");
    told(&sim(&run, &ONE, Some(&home)));
    let cache = home.join(".cache/perilune");
    assert!(!run.path("output/cache").exists() && cache.join("horizon").exists());
    assert_eq!(told(&sim(&run, &["cache", "path"], Some(&home))).trim_end(), cache.to_str().unwrap());
    let mut elsewhere = Command::new(env!("CARGO_BIN_EXE_sim"));
    let output =
        elsewhere.args(["cache", "path"]).env("XDG_CACHE_HOME", "/some/where").env_remove("SIM_CACHE").output();
    assert_eq!(told(&output.unwrap()).trim_end(), "/some/where/perilune");
    let output = Command::new(env!("CARGO_BIN_EXE_sim")).args(["cache", "path"]).env("SIM_CACHE", "mine").output();
    assert_eq!(told(&output.unwrap()).trim_end(), "mine");
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_usable_home_the_cache_lies_beside_the_outputs_and_that_is_said() {
    for home in [None, Some(Path::new("/dev/null"))] {
        let run = Run::of(SMALL);
        let output = sim(&run, &ONE, home);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && said.contains("kept in output/cache: "), "{said}");
        assert!(said.contains(if home.is_some() { "/dev/null" } else { "HOME" }), "{said}");
        assert!(run.path("output/cache/horizon").exists());
    }
}

#[test]
fn what_is_kept_is_listed_cleaned_and_bounded() {
    let run = Run::of(SMALL);
    run.succeed(&["--frames", "0"]);
    let cache = run.path("cache");
    let cache = ["--cache", cache.to_str().unwrap()];
    let json = |arguments: &[&str]| -> Value {
        let output = sim(&run, &[arguments, &cache[..], &["--json"]].concat(), None);
        serde_json::from_str(&told(&output)).unwrap()
    };
    let kinds = |listed: &Value| {
        let entries = listed["entries"].as_array().unwrap();
        let mut kinds: Vec<String> = entries.iter().map(|entry| entry["kind"].as_str().unwrap().into()).collect();
        kinds.sort();
        kinds
    };
    let listed = json(&["cache", "ls"]);
    assert_eq!(kinds(&listed), ["horizon tile", "terrain", "terrain"]);
    let text = told(&sim(&run, &[&["cache", "ls"][..], &cache].concat(), None));
    assert!(text.contains("terrain/highland-") && text.contains("of at most 10.00 GB in"), "{text}");
    let kept = json(&["cache", "clean", "--keep", "1"]);
    assert_eq!((&kept["removed_files"], &kept["bytes"]), (&0.into(), &listed["bytes"]));
    // A run may leave what the limit allows, and no more.
    let mut command = run.command(&["--resume", "--frames", "1"]);
    assert!(command.env("SIM_CACHE_GB", "0").output().unwrap().status.success());
    assert_eq!(json(&["cache", "ls"])["bytes"], 0);
    run.succeed(&["--resume", "--frames", "2"]);
    assert_eq!(json(&["cache", "clean"])["removed_files"], 3);
    let refused = run.command(&[]).env("SIM_CACHE_GB", "much").output().unwrap();
    assert!(String::from_utf8_lossy(&refused.stderr).contains("SIM_CACHE_GB = \"much\" is no size"));
}

#[test]
fn skylines_of_single_azimuths_are_gone_when_the_run_is() {
    let run = Run::of(&SMALL.replace("HorizonMaps()", "TowardsSun(by: Swath())"));
    run.succeed(&["--frames", "0"]);
    let left: Vec<_> =
        std::fs::read_dir(run.path("cache/horizon")).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert!(left.is_empty(), "{left:?}");
}
