//! The whole story: a scenario's terrain, horizons and views, its images, and the files of the dataset.
#![warn(missing_docs)]

use std::path::PathBuf;
use std::time::{Duration, Instant};

use serde::Serialize;

use super::device::{self, AdapterChoice};
use super::watch::Watch;
use super::{Error, Frames, Prepared, Progress, auto, build_scene, facts, images, output, prepare, record, scene};
use crate::dataset::{self, Existing, Run, Writer};
use crate::render::Renderer;
use crate::scenario::Scenario;

/// How to run a scenario.
#[derive(Debug, Clone)]
pub struct Options {
    /// Where the sequence goes.
    pub output: PathBuf,
    /// Where synthetic terrain and horizon tiles are kept for the next run.
    pub cache: PathBuf,
    /// Which exposures; `None`: all.
    pub exposures: Option<Frames>,
    /// What may become of exposures that an earlier run finished.
    pub existing: Existing,
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
    /// Finished exposures.
    pub exposures: usize,
    /// Exposures of the sequence.
    pub planned: usize,
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
    let chosen = options.exposures.clone().unwrap_or_default().indices(scenario.images())?;
    // The output's folder is tried before hours are spent on what shall go there.
    let shapes = scenario.shapes();
    let scenario = &output::checked(scenario, &shapes, &options.output, options.existing)?;
    let gpu = device::open(options.adapter, scenario, progress)?;

    let start = Instant::now();
    let mut prepared = prepare(scenario, &options.cache, progress)?;
    if scenario.draft {
        // Nobody goes on with a draft: it has what its own exposures need.
        let exposures: Vec<_> = chosen.iter().map(|index| prepared.exposures[*index].clone()).collect();
        prepared.shadows = auto::choose(scenario, &prepared.ground.surface, &exposures);
    }
    let Prepared { ground, shadows, exposures, .. } = &prepared;
    let (terrain, method) = (&ground.surface.terrain, shadows.method.as_ref());
    let renderer = device::renderer(gpu.as_ref(), options.adapter, scenario, terrain, method, exposures, progress)?;
    facts::check_memory(scenario, terrain, method)?;
    let seconds = Seconds { terrain: lap(start), ..Default::default() };

    let run = record::run(scenario, &prepared, &renderer.adapter())?;
    let writer = Writer::open(&options.output, run, shapes, settings(scenario), options.existing)?;
    writer.notes().iter().for_each(|note| progress.say(note));
    let todo = output::todo(&writer, &chosen, options.existing, progress);
    let images = Images { scenario, options, renderer, todo };
    images.finished(prepared, writer, seconds, progress)
}

/// What is left to do once all is prepared.
struct Images<'a> {
    scenario: &'a Scenario,
    options: &'a Options,
    renderer: Renderer,
    todo: Vec<usize>,
}

impl Images<'_> {
    fn finished(
        self,
        prepared: Prepared,
        mut writer: Writer,
        mut seconds: Seconds,
        progress: &dyn Progress,
    ) -> Result<Report, Error> {
        let earlier = writer.earlier_run().filter(|_| self.todo.is_empty());
        let mut warnings = Vec::new();
        let spent = match earlier.map(|run| (run.inputs.clone(), run.settings.clone())) {
            // Horizons that nothing is rendered with are not made.
            Some((inputs, settings)) => {
                let run = Run { inputs, settings, ..writer.run().clone() };
                writer.describe(run)?;
                images::Spent::default()
            }
            None => {
                let (spent, odd) = self.render(prepared, &mut writer, &mut seconds, progress)?;
                warnings = odd;
                spent
            }
        };
        let start = Instant::now();
        progress.begin("writing previews and lists", 1, "sequence");
        let summary = writer.finish()?;
        seconds.writing_after = lap(start);
        Ok(Report {
            output: summary.directory,
            adapter: self.renderer.adapter(),
            exposures: summary.exposures,
            planned: summary.planned,
            rendered: spent.exposures,
            warnings,
            seconds,
            device_seconds: (spent.device > Duration::ZERO).then_some(spent.device.as_secs_f64()),
            stages: Stages {
                samples: spent.samples.as_secs_f64(),
                planes: spent.planes.as_secs_f64(),
                encoding: summary.spent.encoding.as_secs_f64(),
                writing: summary.spent.writing.as_secs_f64(),
            },
        })
    }

    fn render(
        &self,
        mut prepared: Prepared,
        writer: &mut Writer,
        seconds: &mut Seconds,
        progress: &dyn Progress,
    ) -> Result<(images::Spent, Vec<String>), Error> {
        let (scenario, todo) = (self.scenario, &self.todo);
        let start = Instant::now();
        let scene = build_scene(scenario, &mut prepared, &self.options.cache, progress)?;
        seconds.horizons = lap(start);
        let imaging = scene::imaging(scenario)?;
        let session = self.renderer.session(&scene)?;
        writer.describe(record::run(scenario, &prepared, &self.renderer.adapter())?)?;
        let start = Instant::now();
        progress.begin("rendering", todo.len(), "exposures");
        let instrument = images::Instrument { imaging: &imaging, session };
        let watch = Watch::new(scenario, &prepared)?;
        let resume = self.options.existing.resume;
        let spent = images::render(&prepared, instrument, writer, todo, &watch, resume, progress)?;
        seconds.rendering = lap(start);
        let warnings = watch.summed(spent.exposures);
        Ok((spent, warnings))
    }
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
