//! What can be wrong with a scenario.

use std::path::PathBuf;

use thiserror::Error;

use super::tree::TextPosition;

/// Why a scenario cannot run.
#[derive(Debug, Error)]
pub enum ScenarioError {
    #[error("cannot read the scenario {path}: {source}")]
    Read { path: PathBuf, source: std::io::Error },
    #[error("no scenario {name}: looked for {}; shipped are {}", looked_for.join(", "), shipped.join(", "))]
    NotFound { name: String, looked_for: Vec<String>, shipped: Vec<&'static str> },
    #[error("{}", lines(path, problems))]
    Problems { path: PathBuf, problems: Vec<Problem> },
}

impl ScenarioError {
    /// The problems of the file, in the order of its lines.
    pub fn problems(&self) -> &[Problem] {
        match self {
            Self::Problems { problems, .. } => problems,
            _ => &[],
        }
    }
}

/// One thing wrong at one place of the file.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{}:{}: {}{fault}", place.line, place.column, prefix(key))]
pub struct Problem {
    pub place: TextPosition,
    /// As in `trajectory.points[2].t_s`; empty for the whole file.
    pub key: String,
    pub fault: Fault,
}

/// What is wrong.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Fault {
    #[error("{0}")]
    Syntax(String),
    #[error("is not a key here{}; allowed: {}", did_you_mean(near), list(allowed))]
    UnknownKey { near: Option<String>, allowed: Vec<String> },
    #[error("is written twice")]
    WrittenTwice,
    #[error("is missing")]
    Missing,
    #[error("= {got} is not {expected}")]
    WrongType { got: String, expected: String },
    #[error("= {got} is not one of {}{}", list(allowed), did_you_mean(near))]
    NotOneOf { got: String, near: Option<String>, allowed: Vec<String> },
    #[error("= {got} is not finite")]
    NotFinite { got: String },
    #[error("= {got} is outside [{}, {}]{}", range_end(*minimum), range_end(*maximum), spaced(unit))]
    OutsideRange { got: String, minimum: f64, maximum: f64, unit: String },
    #[error("has {got} entries, allowed are {minimum} to {maximum}")]
    WrongCount { got: usize, minimum: u64, maximum: u64 },
    #[error("= {got} {rule}")]
    Breaks { got: String, rule: String },
    #[error("{0}")]
    Needs(String),
    #[error("= \"{got}\" is not an epoch with its scale, as in 2026-08-01T00:00:00 UTC or 2026-08-01T00:00:00 TDB")]
    NotAnEpoch { got: String },
    #[error("= \"{got}\" is not found{}{}", places(looked_in), spaced_after(about))]
    FileNotFound { got: String, looked_in: Vec<String>, about: Option<String> },
    #[error("and {count} more problems")]
    More { count: usize },
    #[error("= \"{got}\" is a directory, not a file")]
    IsADirectory { got: String },
}

fn prefix(key: &str) -> String {
    if key.is_empty() { String::new() } else { format!("{key} ") }
}

fn list(items: &[String]) -> String {
    items.join(", ")
}

fn places(looked_in: &[String]) -> String {
    if looked_in.is_empty() { String::new() } else { format!(" in {}", list(looked_in)) }
}

fn did_you_mean(near: &Option<String>) -> String {
    near.as_ref().map(|near| format!("; did you mean {near}?")).unwrap_or_default()
}

fn spaced(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

fn spaced_after(about: &Option<String>) -> String {
    about.as_ref().map(|about| format!("; {about}")).unwrap_or_default()
}

/// 1e9 rather than 1000000000, 1e-4 rather than 0.0001.
pub(super) fn range_end(number: f64) -> String {
    let size = number.abs();
    if number != 0.0 && !(1e-3..1e6).contains(&size) { format!("{number:e}") } else { number.to_string() }
}

fn lines(path: &std::path::Path, problems: &[Problem]) -> String {
    problems.iter().map(|problem| format!("{}:{problem}", path.display())).collect::<Vec<_>>().join("\n")
}
