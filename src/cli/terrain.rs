//! `sim terrain`.

use super::Outcome;

/// Write a synthetic cratered terrain.
#[derive(Debug, clap::Args)]
pub struct Args {}

pub fn run(_args: Args) -> Outcome {
    Err("not built yet".into())
}
