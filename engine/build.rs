//! Tells the program which commit it is built from: `PERILUNE_COMMIT`, where git knows one.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=PERILUNE_COMMIT");
    // Unpacked inside another repository, that one's commit would say nothing.
    let is_repository = git(&["rev-parse", "--show-prefix"]).is_some_and(|prefix| prefix == "engine/");
    if std::env::var_os("PERILUNE_COMMIT").is_some() || !is_repository {
        return;
    }
    if let Some(commit) = git(&["rev-parse", "HEAD"]) {
        println!("cargo::rustc-env=PERILUNE_COMMIT={commit}");
    }
    // Git notes every move of HEAD in its log, that of the branch under it too.
    for name in ["HEAD", "logs/HEAD"] {
        // A path that is not there would make every build run this again.
        if let Some(path) = git(&["rev-parse", "--git-path", name]).filter(|path| Path::new(path).exists()) {
            println!("cargo::rerun-if-changed={path}");
        }
    }
}

/// What git prints; nothing outside a repository, without git, or where git refuses.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
