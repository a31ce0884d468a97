//! `sim kernels`.

use super::Outcome;

/// Make the default kernels and list what a kernel covers.
#[derive(Debug, clap::Args)]
pub struct Args {}

pub fn run(_args: Args) -> Outcome {
    Err("not built yet".into())
}
