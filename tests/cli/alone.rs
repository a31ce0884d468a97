//! The program alone: one file in an empty folder, without the tree that it was built from.

use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

/// The default scenario made small enough for a test.
const SMALLER: [(&str, &str); 6] = [
    ("columns: 513, rows: 513", "columns: 65, rows: 65"),
    ("columns: 641, rows: 641", "columns: 81, rows: 81"),
    ("columns: 961, rows: 961", "columns: 121, rows: 121"),
    ("columns: 1024", "columns: 64"),
    ("rows: 1024", "rows: 64"),
    ("count: 24", "count: 2"),
];

/// The program's file, copied to a folder that holds nothing else.
struct Alone(TempDir);

impl Alone {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        std::fs::copy(env!("CARGO_BIN_EXE_sim"), folder.path().join("sim")).unwrap();
        Self(folder)
    }

    fn sim(&self, arguments: &[&str]) -> Output {
        let mut program = Command::new(self.0.path().join("sim"));
        program.args(arguments).current_dir(self.0.path()).env_remove("SIM_DATA").env_remove("SIM_KERNELS");
        program.output().unwrap()
    }

    fn succeed(&self, arguments: &[&str]) -> String {
        let output = self.sim(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }
}

/// What the program does not name it does not read.
#[test]
fn the_program_names_no_folder_of_its_source_tree() {
    let tree = env!("CARGO_MANIFEST_DIR");
    let holds = |bytes: &[u8]| bytes.windows(tree.len()).any(|window| window == tree.as_bytes());
    assert!(holds(format!("in {tree}/kernels").as_bytes()));
    // A build with debug information names the folder that it was compiled in.
    if !cfg!(debug_assertions) {
        assert!(!holds(&std::fs::read(env!("CARGO_BIN_EXE_sim")).unwrap()), "the program names {tree}");
    }
}

#[test]
fn the_default_scenario_is_found_and_right_in_an_empty_folder() {
    let alone = Alone::new();
    let told = alone.succeed(&["check", "lunar_descent.ron"]);
    assert!(told.contains("no problems"), "{told}");
    assert!(alone.succeed(&["sun", "--at=-89.5,120", "--epoch", "2026-11-06T00:00:00 UTC"]).contains("elevation"));
}

#[test]
fn a_copy_of_a_shipped_scenario_renders_in_an_empty_folder() {
    let alone = Alone::new();
    let mut text = alone.succeed(&["scenarios", "shadowed_crater"]);
    assert_eq!(text, include_str!("../../scenarios/shadowed_crater.ron"));
    text = alone.succeed(&["scenarios", "lunar_descent.ron"]);
    for (whole, small) in SMALLER {
        assert!(text.contains(whole), "{whole}");
        text = text.replace(whole, small);
    }
    std::fs::write(alone.0.path().join("mine.ron"), text).unwrap();
    alone.succeed(&["run", "mine.ron", "--adapter", "cpu"]);
    let written = |name: &str| alone.0.path().join("output/mine").join(name).is_file();
    assert!(["manifest.json", "contact_sheet.png"].iter().all(|name| written(name)));
}

#[test]
fn the_shipped_scenarios_are_those_of_the_repository() {
    let alone = Alone::new();
    let told = alone.succeed(&["scenarios"]);
    let mut names: Vec<_> = told.lines().map(|line| line.split_whitespace().next().unwrap().to_owned()).collect();
    names.sort();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let ron = files.filter(|path| path.extension().is_some_and(|extension| extension == "ron"));
    let mut expected: Vec<_> = ron.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    expected.sort();
    assert_eq!(names, expected);
    assert!(told.contains("needs no data") && told.contains("needs WAC_GLD100_E000N1800_016P.IMG"), "{told}");
}

#[test]
fn an_unknown_scenario_is_told_with_the_shipped_ones() {
    let output = Alone::new().sim(&["run", "lunar_decent.ron"]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && told.contains("lunar_decent.ron") && told.contains("lunar_descent"), "{told}");
}
