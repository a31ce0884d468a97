//! The pages for people: the README's size, and links that lead somewhere.

use std::fs;
use std::path::{Path, PathBuf};

const README_BYTES: u64 = 6 * 1024;
/// Folders without pages of the project.
const SKIPPED: [&str; 3] = ["target", "output", ".git"];

/// All Markdown files below a folder.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut found: Vec<PathBuf> = entries
        .filter(|path| !SKIPPED.iter().any(|name| path.ends_with(name)))
        .flat_map(|path| match path.is_dir() {
            true => pages(&path),
            false => path.extension().is_some_and(|extension| extension == "md").then_some(path).into_iter().collect(),
        })
        .collect();
    found.sort();
    found
}

/// Targets of the links and pictures of a page; blocks and spans of code have none.
fn links(text: &str) -> Vec<String> {
    let prose: String = text.split("```").step_by(2).collect();
    let prose: String = prose.split('`').step_by(2).collect();
    let targets = prose.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.map(str::to_owned).collect()
}

/// Links of a page to files that are not there.
fn dead_links(page: &Path, text: &str) -> Vec<String> {
    let folder = page.parent().unwrap();
    let is_dead = |target: &String| {
        let path = target.split('#').next().unwrap_or_default();
        !target.contains("://") && !path.is_empty() && !folder.join(path).exists()
    };
    links(text).into_iter().filter(is_dead).map(|target| format!("{}: {target}", page.display())).collect()
}

#[test]
fn readme_is_short() {
    let bytes = fs::metadata(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap().len();
    assert!(bytes <= README_BYTES, "README.md has {bytes} bytes, at most {README_BYTES} are allowed");
}

#[test]
fn links_of_all_pages_lead_to_files() {
    let pages = pages(Path::new(env!("CARGO_MANIFEST_DIR")));
    assert!(pages.len() > 10, "{pages:?}");
    let dead: Vec<String> =
        pages.iter().flat_map(|page| dead_links(page, &fs::read_to_string(page).unwrap())).collect();
    assert!(dead.is_empty(), "{dead:#?}");
}

#[test]
fn dead_links_are_found() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let text = "[a](LICENSE-MIT#x) ![b](missing.png) [c](https://example.org) [`d`](docs/missing.md) `[e](f)` [g](#h)";
    let dead: Vec<String> = dead_links(&page, text);
    let names: Vec<&str> = dead.iter().filter_map(|line| line.rsplit(": ").next()).collect();
    assert_eq!(names, ["missing.png", "docs/missing.md"]);
}
