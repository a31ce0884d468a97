//! Arguments that several subcommands share.

use std::ops::Deref;
use std::path::{Path, PathBuf};

use perilune_engine::ephemeris::{Almanac, EphemerisError};
use perilune_engine::files::{cache, probe};
use perilune_engine::scenario::{self, Scenario, ScenarioError};

use super::{about, interrupt};

/// Where files are, and where what is made of them is kept.
#[derive(Debug, clap::Args)]
pub struct Files {
    /// Directory in which a scenario's files are looked for, before `SIM_DATA`; may be given several times
    #[arg(long, value_name = "DIR")]
    data: Vec<PathBuf>,
    #[command(flatten)]
    pub cache: CacheArgs,
}

impl Files {
    pub fn scenario(&self, path: &Path) -> Result<Scenario, ScenarioError> {
        scenario::load(path, &self.data, &about)
    }
}

/// Where made terrain and horizons are kept.
#[derive(Debug, clap::Args)]
pub struct CacheArgs {
    /// Directory in which made terrain and horizons are kept for the next run [default: SIM_CACHE, else perilune in the user's
    /// folder of caches; see sim cache]
    #[arg(long = "cache", value_name = "DIR")]
    folder: Option<PathBuf>,
}

/// Where the environment names no folder for caches.
const FALLBACK: &str = "output/cache";
/// What a cache may hold unless `SIM_CACHE_GB` says otherwise.
const LIMIT_GB: f64 = 10.0;

impl CacheArgs {
    /// The folder, which need not be there.
    pub fn place(&self) -> PathBuf {
        self.chosen().or_else(cache::of_user).unwrap_or_else(|| FALLBACK.into())
    }

    /// Who named the folder means it; nobody else does.
    fn chosen(&self) -> Option<PathBuf> {
        let from_environment = || std::env::var_os("SIM_CACHE").filter(|value| !value.is_empty()).map(PathBuf::from);
        self.folder.clone().or_else(from_environment)
    }

    /// The folder, for work: what is not needed is removed when the work is done.
    pub fn open(&self) -> Result<OpenCache, String> {
        let limit = limit_bytes()?;
        let folder = match self.chosen() {
            Some(folder) => folder,
            None => usable(cache::of_user()),
        };
        let made = !folder.exists();
        let in_use = cache::InUse::begin(&folder);
        let kept = folder.display().to_string();
        interrupt::explain(move || {
            let again = interrupt::command(None, "");
            format!("what is half made is kept in {kept}; go on with: {again}")
        });
        Ok(OpenCache { folder, limit, in_use, made })
    }
}

/// The user's folder, or one below here, with a word why.
fn usable(of_user: Option<PathBuf>) -> PathBuf {
    let why = match of_user {
        None => "neither HOME nor XDG_CACHE_HOME names a folder".to_owned(),
        Some(folder) => match std::fs::create_dir_all(&folder).and_then(|()| probe(&folder)) {
            Ok(()) => return folder,
            Err(error) => format!("cannot write {}: {error}", folder.display()),
        },
    };
    eprintln!("terrain and horizons are kept in {FALLBACK}: {why}");
    FALLBACK.into()
}

/// What a cache may hold.
pub fn limit_bytes() -> Result<u64, String> {
    let Ok(text) = std::env::var("SIM_CACHE_GB") else { return Ok((LIMIT_GB * 1e9) as u64) };
    match text.trim().parse::<f64>() {
        Ok(limit_gb) if limit_gb >= 0.0 && limit_gb.is_finite() => Ok((limit_gb * 1e9) as u64),
        _ => Err(format!("SIM_CACHE_GB = {text:?} is no size in GB, as in 10")),
    }
}

/// A cache at work: it is brought below its limit when this is dropped.
#[derive(Debug)]
pub struct OpenCache {
    folder: PathBuf,
    limit: u64,
    in_use: Option<cache::InUse>,
    /// Whether the folder was not there before.
    made: bool,
}

impl Deref for OpenCache {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.folder
    }
}

impl Drop for OpenCache {
    fn drop(&mut self) {
        self.in_use = None;
        cache::remove_planes(&self.folder);
        cache::trim(&self.folder, self.limit);
        if self.made {
            // Nothing was kept: it is empty.
            let _ = std::fs::remove_dir(&self.folder);
        }
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
