//! What `sim run` writes, opened by somebody else's readers: `tests/python/read.py` prints a value of each format.
//!
//! Python is `SIM_PYTHON`, else the environment that `.ci/run` makes in `target/python` from
//! `tests/python/requirements.txt`, else `python3`. Where it lacks a reader the test is skipped with the reason;
//! `SIM_REQUIRE` with `python` in it turns that into a failure.

mod formats;
mod python;

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

const SOURCE: &str = env!("CARGO_MANIFEST_DIR");

/// An interpreter that can import `modules`; `None`, with the reason on the terminal, where there is none.
fn python(modules: &str) -> Option<PathBuf> {
    let own = Path::new(SOURCE).join("target/python/bin/python");
    let given = std::env::var_os("SIM_PYTHON").map(PathBuf::from);
    let python = given.unwrap_or_else(|| if own.exists() { own } else { "python3".into() });
    let reason = match Command::new(&python).args(["-c", &format!("import {modules}")]).output() {
        Ok(output) if output.status.success() => return Some(python),
        Ok(_) => format!("{} lacks one of {modules}; see tests/python/requirements.txt", python.display()),
        Err(error) => format!("{}: {error}", python.display()),
    };
    assert!(!crate::required("python"), "{reason}");
    println!("skipped: {reason}");
    None
}

/// What a script of `tests/python` prints as JSON.
fn told(python: &Path, script: &str, arguments: &[&str]) -> Value {
    let script = Path::new(SOURCE).join("tests/python").join(script);
    let output = Command::new(python).arg(script).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}
