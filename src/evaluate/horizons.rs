//! Speed and error of horizons: swept, compressed, and as shadows.
//!
//! A *sample* is the horizon of one node in one azimuth. Speed is samples over the seconds that a thread spends on a
//! core, so that other programs' work does not count; errors are against [`crate::horizon::trace`], at pixels spread evenly over the
//! level, in all azimuths. Shadows are decided by the same horizons: a sample is lit where its horizon is below the
//! Sun's centre, and in the penumbra the share of a uniform disc above a level line at the horizon's elevation stands
//! for the irradiance.

pub mod profiles;
pub mod shadows;
pub mod speed;
pub mod tiles;

use std::path::PathBuf;

use super::scenes::Scene;
use super::{Error, Machine, Report, Table};
use crate::horizon::Settings;
use crate::horizon::measure::Sample;
use crate::pipeline::Progress;

pub use profiles::{Profiles, errors, swept, traced};
pub use shadows::{ShadowErrors, shadows};

/// What to measure.
#[derive(Debug, Clone)]
pub struct Options {
    /// The smallest scene only, in fewer azimuths.
    pub quick: bool,
    /// Folders that may hold real models.
    pub data: Vec<PathBuf>,
    pub pixels: usize,
    pub azimuths: usize,
}

impl Options {
    pub fn new(quick: bool, data: Vec<PathBuf>) -> Self {
        Self { quick, data, pixels: 512, azimuths: if quick { 120 } else { 360 } }
    }

    /// Runs of the clock, and azimuths in each.
    fn clock(&self) -> (usize, usize) {
        if self.quick { (3, 12) } else { (5, 36) }
    }
}

/// Measures all scenes.
pub fn run(options: &Options, progress: &dyn Progress) -> Result<Report, Error> {
    let machine = Machine::here();
    let mut tables =
        Tables { speed: speed::table(), errors: profiles::table(), tiles: tiles::table(), shadows: shadows::table() };
    let mut notes = vec![
        format!("{} pixels of each scene, {} azimuths, no limit of the search.", options.pixels, options.azimuths),
        "Samples/s/core: of the time a thread spends on a core. Median of the runs; slowest and fastest beside it."
            .into(),
        "Peak memory: of the whole process, terrain included, while the tile was built.".into(),
        "Shadows: all azimuths of the same pixels; the penumbra is where truth or trial see a part of the disc.".into(),
    ];
    for scene in scenes(options, &mut notes)? {
        measure(&scene, options, &mut tables, progress)?;
    }
    Ok(Report {
        name: "horizon",
        title: "Horizons: speed and error".into(),
        machine,
        notes,
        plots: shadows::plots(&tables.shadows),
        tables: vec![tables.speed, tables.errors, tables.tiles, tables.shadows],
        pictures: Vec::new(),
    })
}

fn scenes(options: &Options, notes: &mut Vec<String>) -> Result<Vec<Scene>, Error> {
    let mut scenes = vec![Scene::synthetic(1024, 1)?];
    if options.quick {
        return Ok(scenes);
    }
    scenes.push(Scene::synthetic(2048, 1)?);
    match Scene::connecting_ridge(&options.data)? {
        Some(scene) => scenes.push(scene),
        None => notes.push("Connecting ridge: skipped, its elevation models are in none of the data folders.".into()),
    }
    Ok(scenes)
}

struct Tables {
    speed: Table,
    errors: Table,
    tiles: Table,
    shadows: Table,
}

fn measure(scene: &Scene, options: &Options, tables: &mut Tables, progress: &dyn Progress) -> Result<(), Error> {
    let settings = Settings { azimuths: options.azimuths, ..Settings::default() };
    let (runs, azimuths) = options.clock();
    tables.speed.rows.push(speed::row(scene, &settings, runs, azimuths));

    progress.begin(&format!("tracing {}", scene.name), 1, "scene");
    let pixels = Sample::of(&scene.face.levels[0], options.pixels, options.azimuths).pixels;
    let truth = traced(scene, &settings, &pixels);
    let mut trials = vec![("swept".to_owned(), swept(scene, &settings, &pixels))];
    for encoding in tiles::ENCODINGS {
        let (profiles, row) = tiles::tile(scene, &settings, encoding, &pixels, progress)?;
        tables.tiles.rows.push(row);
        trials.push((tiles::label(encoding), profiles));
    }
    for (label, tried) in &trials {
        tables.errors.rows.push(profiles::row(scene, label, &errors(&truth, tried)));
        tables.shadows.rows.extend(shadows::rows(scene, label, &truth, tried)?);
    }
    Ok(())
}
