//! The whole story: a scenario's terrain, horizons and views, its images, and the files of the dataset.
#![warn(missing_docs)]

use std::ops::Range;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use serde::Serialize;

use super::device::{self, AdapterChoice};
use super::watch::Watch;
use super::{Error, Prepared, Progress, build_scene, facts, images, prepare, record, scene};
use crate::dataset::{self, Writer};
use crate::scenario::Scenario;

/// How to run a scenario.
#[derive(Debug, Clone)]
pub struct Options {
    /// Where the sequence goes.
    pub output: PathBuf,
    /// Where synthetic terrain and horizon tiles are kept for the next run.
    pub cache: PathBuf,
    /// Which exposures; `None`: all.
    pub exposures: Option<Range<usize>>,
    /// Keep what an earlier run of the same scenario finished.
    pub resume: bool,
    /// Who renders.
    pub adapter: AdapterChoice,
}

/// What a run did.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// The folder of the images.
    pub output: PathBuf,
    /// Who rendered, on one line.
    pub adapter: String,
    /// Exposures of the sequence.
    pub exposures: usize,
    /// Rendered in this run; the others were there.
    pub rendered: usize,
    /// A line for each kind of what is odd about the images that were rendered.
    pub warnings: Vec<String>,
    /// Where the time went.
    pub seconds: Seconds,
    /// Of the device's passes, where it can tell.
    pub device_seconds: Option<f64>,
    /// How long the stages of the images took.
    pub stages: Stages,
}

/// How long the stages of the images took, in seconds: each on its own threads, beside the others.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Stages {
    /// Rays, on the device or the host, and their way back to the host.
    pub samples: f64,
    /// Planes from them, maps and records.
    pub planes: f64,
    /// Compression and hashes.
    pub encoding: f64,
    /// Writing files.
    pub writing: f64,
}

/// Where the time went.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Seconds {
    /// Kernels, terrain and poses.
    pub terrain: f64,
    /// Horizons.
    pub horizons: f64,
    /// All exposures, written.
    pub rendering: f64,
    /// Previews and the manifest.
    pub writing_after: f64,
}

/// Runs a scenario from its kernels to its images.
pub fn run(scenario: &Scenario, options: &Options, progress: &dyn Progress) -> Result<Report, Error> {
    let chosen = chosen(scenario, options)?;
    // The output's folder is tried before hours are spent on what shall go there.
    dataset::check_writable(&options.output)?;
    let gpu = device::open(options.adapter, scenario, progress)?;

    let start = Instant::now();
    let mut prepared = prepare(scenario, &options.cache, progress)?;
    let Prepared { ground, shadows, exposures, .. } = &prepared;
    let (terrain, method) = (&ground.surface.terrain, shadows.method.as_ref());
    let renderer = device::renderer(gpu.as_ref(), options.adapter, scenario, terrain, method, exposures, progress)?;
    facts::check_memory(scenario, terrain, method)?;
    let terrain = lap(start);

    let start = Instant::now();
    let scene = build_scene(scenario, &mut prepared, &options.cache, progress)?;
    let horizons = lap(start);

    let imaging = scene::imaging(scenario)?;
    let session = renderer.session(&scene)?;
    let adapter = session.adapter().to_owned();
    let run = record::run(scenario, &prepared, &scene, &adapter)?;
    let mut writer = Writer::open(&options.output, run.clone(), prepared.exposures.len(), settings(scenario))?;
    let todo: Vec<usize> = chosen.filter(|&index| !(options.resume && writer.done(index))).collect();

    let start = Instant::now();
    progress.begin("rendering", todo.len(), "exposures");
    let instrument = images::Instrument { imaging: &imaging, session };
    let watch = Watch::new(scenario, &prepared)?;
    let spent = images::render(&prepared, instrument, &run, &mut writer, &todo, &watch, progress)?;
    let rendering = lap(start);

    let start = Instant::now();
    progress.begin("writing previews", 1, "sequence");
    let summary = writer.finish()?;
    Ok(Report {
        output: summary.directory,
        adapter,
        exposures: summary.exposures,
        rendered: todo.len(),
        warnings: watch.summed(todo.len()),
        seconds: Seconds { terrain, horizons, rendering, writing_after: lap(start) },
        device_seconds: (spent.device > Duration::ZERO).then_some(spent.device.as_secs_f64()),
        stages: Stages {
            samples: spent.samples.as_secs_f64(),
            planes: spent.planes.as_secs_f64(),
            encoding: summary.spent.encoding.as_secs_f64(),
            writing: summary.spent.writing.as_secs_f64(),
        },
    })
}

/// What is written beside the images.
fn settings(scenario: &Scenario) -> dataset::Settings {
    dataset::Settings {
        tiff: scenario.outputs.tiff,
        animation: scenario.outputs.animation,
        overlay: scenario.landmarks.as_ref().is_some_and(|wanted| wanted.overlay),
        white: record::white(scenario),
        formats: scenario.outputs.formats.clone(),
    }
}

fn lap(start: Instant) -> f64 {
    start.elapsed().as_secs_f64()
}

fn chosen(scenario: &Scenario, options: &Options) -> Result<Range<usize>, Error> {
    let count = scenario.images();
    let range = options.exposures.clone().unwrap_or(0..count);
    if range.is_empty() || range.end > count {
        return Err(Error::NoSuchExposures { from: range.start, until: range.end, count });
    }
    Ok(range)
}
