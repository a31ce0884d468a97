//! `sim horizon`.

use super::Outcome;

/// Build, verify and query horizon tiles.
#[derive(Debug, clap::Args)]
pub struct Args {}

pub fn run(_args: Args) -> Outcome {
    Err("not built yet".into())
}
