//! Arguments that several subcommands share.

use std::path::{Path, PathBuf};

use perilune_engine::ephemeris::{Almanac, EphemerisError};
use perilune_engine::scenario::{self, Scenario, ScenarioError};

use super::about;

/// Where files are, and where what is made of them is kept.
#[derive(Debug, clap::Args)]
pub struct Files {
    /// Directory in which a scenario's files are looked for, before `SIM_DATA`; may be given several times
    #[arg(long, value_name = "DIR")]
    data: Vec<PathBuf>,
    /// Directory in which synthetic terrain and horizon tiles are kept for the next run
    #[arg(long, value_name = "DIR", default_value = "output/cache")]
    pub cache: PathBuf,
}

impl Files {
    pub fn scenario(&self, path: &Path) -> Result<Scenario, ScenarioError> {
        scenario::load(path, &self.data, &about)
    }
}

/// Ephemerides.
#[derive(Debug, clap::Args)]
pub struct Kernels {
    /// Kernel to load instead of the default ones; may be given several times
    #[arg(long = "kernel", value_name = "FILE")]
    kernels: Vec<PathBuf>,
}

impl Kernels {
    pub fn almanac(&self) -> Result<Almanac, EphemerisError> {
        match self.kernels[..] {
            [] => Almanac::default_kernels(),
            _ => Almanac::load(&self.kernels),
        }
    }
}
