//! From a scenario to images on disk: the stories of the crate's document, in order.
//!
//! ```text
//! kernels -> Sun and frames      DEMs -> levels -> horizon tiles      trajectory, pointing -> views
//!                        all of them -> scene -> renderer -> planes -> dataset
//! ```
//!
//! Whatever can fail for the user's sake fails before the first exposure: kernels, epochs, poses and terrain are
//! ready when the horizons begin.

pub mod auto;
mod camera_record;
mod check;
mod craters;
mod domain;
pub(crate) mod error;
pub mod globe;
pub mod ground;
mod images;
pub mod lights;
pub mod motion;
mod ortho;
mod progress;
mod record;
pub mod scene;
mod sequence;
pub mod shot;
mod split;
pub mod swath;

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::Serialize;

pub use check::{Checked, check};
pub use error::Error;
pub use motion::Exposure;
pub use progress::{Progress, Silent};

use crate::dataset::{self, Writer};
use crate::ephemeris::{Almanac, BodyFrame, DEFAULT_KERNELS, default_kernel_folder};
use crate::gpu::{Adapter, Gpu};
use crate::horizon;
use crate::labels::{Crater, Rim};
use crate::raster;
use crate::render::passes::Passes;
use crate::render::reference::Reference;
use crate::render::{Bounce, DeviceGround, Renderer, Scene, Shadows};
use crate::scenario::{self, Albedo, Ambient, Scenario, Sky};
use crate::shadow::{Baked, Multiscale, SingleAzimuth, Swept};

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
    pub adapter: AdapterChoice,
}

/// Who renders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AdapterChoice {
    /// Any adapter; the reference renderer where there is none.
    #[default]
    Auto,
    /// A hardware adapter or nothing.
    Gpu,
    /// The reference renderer.
    Cpu,
}

/// What a run did.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    pub output: PathBuf,
    pub adapter: String,
    pub exposures: usize,
    /// Rendered in this run; the others were there.
    pub rendered: usize,
    pub seconds: Seconds,
    /// Of the device's passes, where it can tell.
    pub device_seconds: Option<f64>,
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
    pub writing: f64,
}

/// Where the time went.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Seconds {
    pub terrain: f64,
    pub horizons: f64,
    pub rendering: f64,
    pub writing_after: f64,
}

/// All that is settled before the first exposure.
#[derive(Debug)]
pub struct Prepared {
    pub almanac: Almanac,
    pub frame: BodyFrame,
    pub ground: ground::Ground,
    /// The scenario at each point of its sweep; one without a sweep.
    pub points: Vec<Scenario>,
    pub sweep: Option<scenario::Sweep>,
    pub exposures: Vec<Exposure>,
    /// Of each point of the sweep.
    pub motions: Vec<motion::Motion>,
    pub shadows: auto::Choice,
    /// With their rims; empty where the scenario asks for no landmarks.
    pub craters: Vec<(Crater, Rim)>,
}

/// Kernels, terrain and poses of a scenario.
pub fn prepare(scenario: &Scenario, cache: &Path, progress: &dyn Progress) -> Result<Prepared, Error> {
    let almanac = Almanac::load(&kernels(scenario))?;
    let frame = body_frame(scenario, &almanac)?;
    let mut ground = ground::surface(scenario.terrain.as_ref(), &frame.body, cache, progress)?;
    for (role, path) in other_inputs(scenario) {
        let sha256 = raster::digest(path)?;
        ground.inputs.push(dataset::Input { role: role.into(), name: ground::file_name(path), sha256 });
    }
    let points = points(scenario);
    for point in &points {
        scene::reflectance(point)?;
        scene::detector(point)?;
    }
    let (exposures, motions) = globe::look::exposures(&points, &almanac, &frame, &mut ground, progress)?;
    let craters = craters::of_lists(scenario, &mut ground, cache)?;
    sequence::check(scenario, &exposures)?;
    let shadows = auto::choose(scenario, &ground.surface, &exposures);
    if let Some(why) = &shadows.why {
        progress.say(why);
    }
    domain::warnings(scenario, Some(&ground.surface)).iter().for_each(|warning| progress.say(warning));
    Ok(Prepared { almanac, frame, ground, points, sweep: scenario.sweep.clone(), exposures, motions, shadows, craters })
}

/// The scenario at each point of its sweep.
fn points(scenario: &Scenario) -> Vec<Scenario> {
    (0..scenario.points()).map(|point| scenario.at_point(point)).collect()
}

/// The scenario's kernels, or the shipped ones, and the trajectory's.
fn kernels(scenario: &Scenario) -> Vec<PathBuf> {
    let shipped = || DEFAULT_KERNELS.map(|name| default_kernel_folder().join(name)).to_vec();
    let mut kernels = scenario.kernels.clone().unwrap_or_else(shipped);
    if let scenario::Trajectory::Spk { path: Some(path), .. } = &scenario.trajectory {
        kernels.push(path.clone());
    }
    kernels
}

/// The scenario's frame with the figure that its heights refer to.
fn body_frame(scenario: &Scenario, almanac: &Almanac) -> Result<BodyFrame, Error> {
    let named = almanac.body_frame(&scenario.body.name, scenario.frame.as_deref())?;
    Ok(BodyFrame { body: scenario.body.clone(), ..named })
}

/// Files that shape the images besides elevation models and kernels, with their role.
fn other_inputs(scenario: &Scenario) -> Vec<(&'static str, &Path)> {
    let mut inputs = Vec::new();
    if let Albedo::Map(path) | Albedo::SingleScattering(path) = &scenario.albedo {
        inputs.push(("albedo", path.as_path()));
    }
    if let scenario::Trajectory::Oem { path } = &scenario.trajectory {
        inputs.push(("trajectory", path.as_path()));
    }
    if let Some(isd) = &scenario.camera.isd {
        inputs.push(("camera", isd.path.as_path()));
    }
    if let Some(kernel) = &scenario.camera.kernel {
        inputs.push(("psf", kernel.as_path()));
    }
    let response = scenario.band.as_ref().and_then(|band| band.path.as_deref());
    inputs.extend(response.map(|path| ("response", path)));
    inputs.extend(scenario.sun.table.as_deref().map(|path| ("spectrum", path)));
    if let scenario::Towards::Aem { path } = &scenario.pointing.towards {
        inputs.push(("attitude", path.as_path()));
    }
    inputs
}

/// The scene that a renderer reads, with its shadows.
pub fn scene(
    scenario: &Scenario,
    prepared: &mut Prepared,
    cache: &Path,
    progress: &dyn Progress,
) -> Result<Scene, Error> {
    let Prepared { ground, exposures, shadows: choice, .. } = prepared;
    let albedo = match &scenario.albedo {
        Albedo::Constant(_) => None,
        Albedo::Map(path) | Albedo::SingleScattering(path) => {
            Some(ground::albedo(&mut ground.surface, path, scene::albedo_scale(scenario))?)
        }
    };
    let settings = scene::horizon_settings(scenario);
    let mut tiles = Vec::new();
    let mut maps = |settings: horizon::Settings| {
        let (folder, encoding) = (cache.join("horizon"), scenario.horizon.encoding);
        let settings = horizon::Settings { band: motion::band(scenario, exposures), ..settings };
        let listed = |tile: &ground::Tile| {
            tiles.push(tile.input());
            Ok::<_, Error>(())
        };
        if let Some(globe) = &ground.globe {
            return globe.horizons(settings, encoding, cache, progress, listed);
        }
        ground::horizons(&ground.surface, &settings, encoding, &folder, horizon::Memory::default(), progress, listed)
    };
    let terrain = &ground.surface.terrain;
    let shadows = match &choice.shadows {
        scenario::Shadows::Auto { .. } | scenario::Shadows::Preset(_) => unreachable!("the choice has been made"),
        scenario::Shadows::Off => Shadows::None,
        scenario::Shadows::Traced => Shadows::Traced(settings),
        scenario::Shadows::Fourier => Shadows::Fourier(maps(settings)?),
        scenario::Shadows::Baked => Shadows::Baked(Baked(maps(settings)?)),
        &scenario::Shadows::Series { visibility, coefficients, at } => {
            scene::series(maps(settings)?, visibility, coefficients, at)
        }
        &scenario::Shadows::Swath { azimuth_step_deg } => {
            let folder = cache.join("horizon");
            let swath = swath::swath(&ground.surface, exposures, azimuth_step_deg, &settings, &folder, progress)?;
            Shadows::Towards(Box::new(swath))
        }
        &scenario::Shadows::Sweep { azimuth_step_deg } => {
            Shadows::Towards(Box::new(Swept { settings, step_rad: azimuth_step_deg.to_radians() }))
        }
        &scenario::Shadows::SingleAzimuth { spacing, edge } => {
            Shadows::Towards(Box::new(SingleAzimuth { settings, spacing, edge }))
        }
        scenario::Shadows::MaximumMipmaps { runs } => Shadows::Mipmaps(scene::mipmaps(terrain, runs)),
        &scenario::Shadows::Multiscale { level_step, level_offset, swath_deg } => {
            Shadows::Towards(Box::new(Multiscale::new(terrain, level_step, level_offset, swath_deg.to_radians())))
        }
    };
    let from_maps = matches!(scenario.ambient, Some(Ambient { sky: Sky::Horizons, .. })) || scenario.bounce.is_some();
    let made = if from_maps && shadows.maps().is_none() { maps(settings)? } else { Vec::new() };
    let horizons = shadows.maps().unwrap_or(&made[..]);
    let ambient = scene::ambient(scenario, &ground.surface, horizons);
    let bounce = scenario
        .bounce
        .map(|bounce| Bounce::new(&ground.surface, horizons, bounce.azimuths as usize, bounce.elevations as usize));
    ground.inputs.extend(tiles);
    Ok(Scene {
        surface: ground.surface.clone(),
        view_rays: scenario.view_rays,
        shadows,
        refine: scenario.refine.then_some(settings),
        reflectance: scene::reflectance(scenario)?,
        albedo,
        albedo_role: scene::albedo_role(scenario),
        ambient,
        bounce,
        disk: scene::disk(scenario)?,
        band_width_nm: scenario.band.as_ref().map(|band| band.width_nm),
        optics: scene::optics(scenario)?,
        detector: scene::detector(scenario)?,
        samples_per_side: scenario.camera.samples_per_pixel.isqrt() as usize,
        quantities: scenario.outputs.planes.clone(),
    })
}

/// Runs a scenario from its kernels to its images.
pub fn run(scenario: &Scenario, options: &Options, progress: &dyn Progress) -> Result<Report, Error> {
    let mut seconds = Seconds::default();
    let chosen = chosen(scenario, options)?;
    // The output's folder is tried before hours are spent on what shall go there.
    dataset::check_writable(&options.output)?;
    let gpu = open_adapter(options.adapter, scenario, progress)?;
    let start = Instant::now();
    let mut prepared = prepare(scenario, &options.cache, progress)?;
    let gpu = gpu.filter(|_| options.adapter != AdapterChoice::Auto || !is_traced(&prepared.shadows.shadows));
    if let Some(gpu) = &gpu {
        let horizons = prepared.shadows.shadows.need_maps().then_some(scenario.horizon.encoding);
        DeviceGround::check(gpu, &prepared.ground.surface.terrain, horizons)?;
    }
    seconds.terrain = lap(start);
    let start = Instant::now();
    let mut scene = scene(scenario, &mut prepared, &options.cache, progress)?;
    seconds.horizons = lap(start);
    let imaging = scene::imaging(scenario)?;

    let mut passes = gpu.as_ref().map(Passes::new);
    let mut reference = Reference;
    let renderer: &mut dyn Renderer = match &mut passes {
        Some(passes) => passes,
        None => &mut reference,
    };
    let adapter = renderer.adapter();
    let run = record::run(scenario, &prepared, &scene, &adapter);
    let settings = dataset::Settings {
        tiff: scenario.outputs.tiff,
        animation: scenario.outputs.animation,
        overlay: scenario.landmarks.as_ref().is_some_and(|wanted| wanted.overlay),
        white: record::white(scenario),
        formats: scenario.outputs.formats.clone(),
    };
    let mut writer = Writer::open(&options.output, run.clone(), prepared.exposures.len(), settings)?;
    let todo: Vec<usize> = chosen.filter(|&index| !(options.resume && writer.done(index))).collect();

    let start = Instant::now();
    progress.begin("rendering", todo.len(), "exposures");
    let spent = images::render(
        &prepared,
        &mut scene,
        images::Instrument { imaging: &imaging, renderer },
        &run,
        &mut writer,
        &todo,
        progress,
    )?;
    seconds.rendering = lap(start);
    let start = Instant::now();
    progress.begin("writing previews", 1, "sequence");
    let summary = writer.finish()?;
    seconds.writing_after = lap(start);
    Ok(Report {
        output: summary.directory,
        adapter,
        exposures: summary.exposures,
        rendered: todo.len(),
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

fn is_traced(shadows: &scenario::Shadows) -> bool {
    *shadows == scenario::Shadows::Traced
}

/// The device that renders; `None`: the reference renderer does.
fn open_adapter(choice: AdapterChoice, scenario: &Scenario, progress: &dyn Progress) -> Result<Option<Gpu>, Error> {
    match choice {
        AdapterChoice::Cpu => Ok(None),
        AdapterChoice::Gpu => Ok(Some(Gpu::open(Adapter::Gpu)?)),
        AdapterChoice::Auto if is_traced(&scenario.shadows) => {
            progress.say("traced shadows: rendering with the reference renderer on the CPU");
            Ok(None)
        }
        AdapterChoice::Auto => match Gpu::open(Adapter::Auto) {
            Ok(gpu) => Ok(Some(gpu)),
            Err(error) => {
                progress.say(&format!("{error}; rendering with the reference renderer on the CPU"));
                Ok(None)
            }
        },
    }
}
