//! Tiles of each encoding: what they cost and what they decode to.

use std::path::PathBuf;
use std::time::Instant;

use glam::DVec2;
use rayon::prelude::*;

use super::profiles::Profiles;
use crate::scenes::Scene;
use crate::{Error, Table, Value};
use perilune_engine::horizon::{self, Encoding, Request, Settings};
use perilune_engine::pipeline::Progress;
use perilune_engine::report::machine::{forget_peak_memory, peak_memory_mib};

pub const ENCODINGS: [Encoding; 3] = [Encoding::Fm16, Encoding::W16, Encoding::W21];

/// The table that [`tile`] fills.
pub fn table() -> Table {
    Table::new(
        "tiles",
        "Tiles: sweep, fit, measured error and file",
        &[
            ("scene", ""),
            ("encoding", ""),
            ("time", "s"),
            ("samples/s", "M/s"),
            ("in memory", "B/pixel"),
            ("on disk", "B/pixel"),
            ("peak memory", "MiB"),
        ],
    )
}

/// What a tile decodes to, and its row of the table.
pub fn tile(
    scene: &Scene,
    settings: &Settings,
    encoding: Encoding,
    pixels: &[[usize; 2]],
    progress: &dyn Progress,
) -> Result<(Profiles, Vec<Value>), Error> {
    let folder = Scratch::new()?;
    progress.begin(&format!("{encoding} of {}", scene.name), settings.azimuths, "azimuths");
    forget_peak_memory();
    let start = Instant::now();
    let on_progress = |done: usize, total: usize| progress.at(done, total);
    let request = Request { body: &scene.body, face: &scene.face, level: 0, settings: *settings, encoding };
    let map = horizon::build(&request, &folder.path, &on_progress)?;
    let seconds = start.elapsed().as_secs_f64();
    let peak_mib = peak_memory_mib();

    let receivers = scene.receivers() as f64;
    let samples = receivers * settings.azimuths as f64;
    let in_memory = map.bytes() as f64 / receivers;
    let on_disk = folder.bytes() as f64 / receivers;
    let row = vec![
        scene.name.as_str().into(),
        encoding.name().into(),
        seconds.into(),
        (samples / seconds * 1e-6).into(),
        in_memory.into(),
        on_disk.into(),
        peak_mib.into(),
    ];
    let profile = |[column, row]: &[usize; 2]| {
        let series = map.horizon(DVec2::new(*column as f64, *row as f64));
        (0..settings.azimuths).map(|azimuth| series.evaluate_towards(settings.direction(azimuth)).0).collect()
    };
    Ok((pixels.par_iter().map(profile).collect(), row))
}

/// A folder that is gone when it is no longer needed.
#[derive(Debug)]
pub(crate) struct Scratch {
    pub path: PathBuf,
}

impl Scratch {
    pub fn new() -> Result<Self, Error> {
        let path = std::env::temp_dir().join(format!("perilune-bench-{}", std::process::id()));
        std::fs::create_dir_all(&path).map_err(|source| Error::Write { path: path.clone(), source })?;
        Ok(Self { path })
    }

    pub fn bytes(&self) -> u64 {
        let Ok(entries) = std::fs::read_dir(&self.path) else { return 0 };
        entries.filter_map(|entry| Some(entry.ok()?.metadata().ok()?.len())).sum()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What cannot be removed is the temporary folder's to clear.
        let _ = std::fs::remove_dir_all(&self.path);
    }
}
