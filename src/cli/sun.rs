//! `sim sun`.

use super::Outcome;

/// Where the Sun and the Earth stand in the sky of a place.
#[derive(Debug, clap::Args)]
pub struct Args {}

pub fn run(_args: Args) -> Outcome {
    Err("not built yet".into())
}
