//! Lengths of files and functions: what does not fit is split, or says here why not.

use std::path::Path;

use crate::architecture::rust_files;

const MOST_LINES: usize = 400;
const MOST_LINES_OF_A_FUNCTION: usize = 60;
/// Functions that may be longer than that: fewer than this.
const LONG_FUNCTIONS: usize = 5;
/// Folders of sources.
const SOURCES: [&str; 4] = ["src", "engine/src", "bench/src", "tests"];
/// Longer files, each with the reason.
const LONG_FILES: [(&str, &str); 3] = [
    ("tests/cli/bad_input.rs", "a table: one case a message of the program"),
    ("tests/conformance/photometry.rs", "a table: one shader with all comparisons of one pass"),
    ("tests/conformance/horizon.rs", "a table: one shader with all comparisons of one pass"),
];

/// Functions of a formatted file that are longer than allowed, with their lengths.
fn long_functions(source: &str) -> Vec<(String, usize)> {
    let lines: Vec<&str> = source.lines().collect();
    let length = |start: usize| {
        let indent = &lines[start][..lines[start].len() - lines[start].trim_start().len()];
        let ends = |line: &&str| line.strip_prefix(indent) == Some("}");
        lines[start..].iter().position(ends).map_or(0, |end| end + 1)
    };
    let starts = (0..lines.len()).filter_map(|start| Some((function_name(lines[start])?, length(start))));
    starts.filter(|(_, length)| *length > MOST_LINES_OF_A_FUNCTION).collect()
}

/// The name of a function whose body begins on a line or below it.
fn function_name(line: &str) -> Option<String> {
    let words = line.trim_start();
    if words.ends_with(['}', ';']) {
        return None;
    }
    let (before, after) = words.split_once("fn ")?;
    let qualifiers =
        before.split_whitespace().all(|word| ["const", "async", "unsafe"].contains(&word) || word.starts_with("pub"));
    let name: String = after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    (qualifiers && !name.is_empty()).then_some(name)
}

fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = SOURCES.iter().flat_map(|folder| rust_files(&root.join(folder)));
    let read = |file: std::path::PathBuf| {
        let name = file.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
        (name, std::fs::read_to_string(file).unwrap())
    };
    files.map(read).collect()
}

#[test]
fn no_file_is_long_without_a_reason() {
    let sources = sources();
    assert!(sources.len() > 400, "found {} files", sources.len());
    let reason = |name: &str| LONG_FILES.iter().any(|(long, _)| *long == name);
    let is_long = |(_, source): &&(String, String)| source.lines().count() > MOST_LINES;
    let long: Vec<&str> = sources.iter().filter(is_long).map(|(name, _)| name.as_str()).collect();
    let unexplained: Vec<_> = long.iter().filter(|name| !reason(name)).collect();
    assert!(unexplained.is_empty(), "more than {MOST_LINES} lines: {unexplained:?}");
    let needless: Vec<_> = LONG_FILES.iter().filter(|(name, _)| !long.contains(name)).collect();
    assert!(needless.is_empty(), "not long any more: {needless:?}");
}

#[test]
fn few_functions_are_long() {
    let long: Vec<_> = sources()
        .into_iter()
        .filter(|(name, _)| !LONG_FILES.iter().any(|(long, _)| long == name))
        .flat_map(|(name, source)| long_functions(&source).into_iter().map(move |function| (name.clone(), function)))
        .collect();
    for (name, (function, length)) in &long {
        println!("{name}: {function}, {length} lines");
    }
    assert!(long.len() < LONG_FUNCTIONS, "{long:#?}");
}

#[test]
fn a_long_function_is_found() {
    let body = "        let x = 1;\n".repeat(60);
    let source =
        format!("impl A {{\n    pub(crate) fn long(\n        &self,\n    ) {{\n{body}    }}\n}}\nfn short() {{\n}}\n");
    assert_eq!(long_functions(&source), [("long".to_string(), 64)]);
    assert_eq!(long_functions("fn one() -> usize { 1 }\nlet f = fn_of();\n"), []);
}
