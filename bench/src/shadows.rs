//! One exposure with every shadow method, against traced shadows.
//!
//! Truth is the reference renderer with a horizon traced for each column of the Sun's disc: `f64`, every grid line
//! of every level. All methods see the same rays, one through the centre of each pixel. For a pixel on terrain with
//! share `V` of the disc and irradiance `E` of the ground, `E₀` that of a plane facing the whole Sun:
//!
//! ```text
//! agreement = share of pixels with (V ≥ ½) = (V_truth ≥ ½)        error = (E − E_truth)/E₀
//! ```
//!
//! # Assumptions
//! Truth sums the disc in 24 columns: `V` within 1e-3 where the skyline is smooth across the disc, within a column's
//! width where it has a step. Pixels on the bare spheroid and on gaps do not count.

pub mod matrix;
pub mod methods;
mod scene_table;
mod truth;

use std::path::PathBuf;
use std::time::Instant;

use super::{Error, Machine, Report, Table, Value};
use methods::{MethodFactory, outside_domain};
use perilune_engine::geometry::Position;
use perilune_engine::gpu::{Adapter, Gpu};
use perilune_engine::pipeline::{self, Prepared, Progress};
use perilune_engine::render::planes::Radiometry;
use perilune_engine::render::{Quantity, Renderer, Samples, Scene, Session, View};
use perilune_engine::report::Figure;
use perilune_engine::report::plot::{Axis, Curve, Plot};
use perilune_engine::scenario::{self, Scenario};
use perilune_engine::shadow::registry;
use perilune_engine::statistics::Errors;
use perilune_engine::terrain::{Ground, Hit};

/// What to compare.
#[derive(Debug, Clone)]
pub struct Options {
    pub exposure: usize,
    /// Pixels along the longer side of the image.
    pub pixels: u32,
    /// Names of [`methods`].
    pub methods: Vec<String>,
    pub cache: PathBuf,
}

/// Shares of the disc nearer than this to none or all of it are not penumbra: the error of the truth's columns.
const PENUMBRA: f64 = 1e-3;

/// How a method differs from the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// Pixels on terrain.
    pub ground: usize,
    /// Shares of them.
    pub agreement: f64,
    pub lit_in_the_dark: f64,
    pub dark_in_the_light: f64,
    /// Of the irradiance, in units of full Sun.
    pub irradiance: Errors,
    /// The same where the truth sees a part of the disc.
    pub penumbra: Errors,
    /// Mean irradiance of the truth's lit ground, in the same unit: under a Sun at 1.5° a fortieth.
    pub lit_ground: f64,
}

/// Compares shadows where `ground` says so; `full_w_m2` is the irradiance of a plane that faces the whole Sun.
pub fn compare(truth: &[Radiometry], tried: &[Radiometry], ground: &[bool], full_w_m2: f64) -> Comparison {
    let pairs: Vec<_> =
        truth.iter().zip(tried).zip(ground).filter(|(_, ground)| **ground).map(|(pair, _)| pair).collect();
    let share = |wrong: &dyn Fn(bool, bool) -> bool| {
        let found = pairs.iter().filter(|(truth, tried)| wrong(lit(truth), lit(tried))).count();
        found as f64 / pairs.len().max(1) as f64
    };
    let error = |(truth, tried): &(&Radiometry, &Radiometry)| {
        f64::from(tried.irradiance_w_m2 - truth.irradiance_w_m2) / full_w_m2
    };
    let partial =
        |(truth, _): &&(&Radiometry, &Radiometry)| (PENUMBRA..1.0 - PENUMBRA).contains(&f64::from(truth.sun_fraction));
    let lit_ground = pairs.iter().filter(|(truth, _)| lit(truth));
    Comparison {
        lit_ground: Errors::of(lit_ground.map(|(truth, _)| f64::from(truth.irradiance_w_m2) / full_w_m2)).mean,
        ground: pairs.len(),
        agreement: share(&|truth, tried| truth == tried),
        lit_in_the_dark: share(&|truth, tried| !truth && tried),
        dark_in_the_light: share(&|truth, tried| truth && !tried),
        irradiance: Errors::of(pairs.iter().map(error)),
        penumbra: Errors::of(pairs.iter().filter(partial).map(error)),
    }
}

/// Half the disc and more.
fn lit(pixel: &Radiometry) -> bool {
    pixel.sun_fraction >= 0.5
}

/// The scenario seen through a camera of `pixels` along its longer side, one ray a pixel.
pub fn reduced(scenario: &Scenario, pixels: u32) -> Scenario {
    let mut reduced = scenario.clone();
    let camera = &mut reduced.camera;
    let scale = f64::from(pixels) / f64::from(camera.columns.max(camera.rows));
    let side = |side: u32| ((f64::from(side) * scale).round() as u32).max(1);
    (camera.columns, camera.rows) = (side(camera.columns), side(camera.rows));
    camera.focal_length_px *= scale;
    camera.principal_point_px = camera.principal_point_px.map(|middle| middle * scale);
    camera.pixel_pitch_m = camera.pixel_pitch_m.map(|pitch_m| pitch_m / scale);
    camera.samples_per_pixel = 1;
    reduced.detector = None;
    reduced.outputs.planes = vec![Quantity::Radiance];
    reduced
}

/// The scenario as it is compared, with horizon maps; an error where there is nothing to compare with.
fn comparable(scenario: &Scenario, options: &Options) -> Result<Scenario, Error> {
    if scenario.terrain.is_none() {
        return Err(Error::NoTerrain);
    }
    if scenario.shows_globe() {
        return Err(Error::Globe);
    }
    let last = scenario.exposures.len() - 1;
    if options.exposure > last {
        return Err(Error::Range { key: "exposure", got: options.exposure, allowed: [0, last] });
    }
    Ok(Scenario { shadows: scenario::Shadows::HorizonMaps(Default::default()), ..reduced(scenario, options.pixels) })
}

/// Renders an exposure with every method and compares.
pub fn run(scenario: &Scenario, options: &Options, progress: &dyn Progress) -> Result<Report, Error> {
    let machine = Machine::here();
    let scenario = comparable(scenario, options)?;
    let mut prepared = pipeline::prepare(&scenario, &options.cache, progress)?;
    let scene = pipeline::build_scene(&scenario, &mut prepared, &options.cache, progress)?;
    let view = prepared.exposures[options.exposure].view.clone();
    let factory = MethodFactory {
        prepared: &prepared,
        settings: traced_settings(&scenario),
        maps: scene.shadows.maps().unwrap_or_default().to_vec(),
        cache: &options.cache,
    };
    let (truth, trials, left_out) = render_all(scene, &view, &factory, &options.methods, progress)?;
    let ground: Vec<bool> = truth.samples.centres.iter().map(|hit| level_of(hit).is_some()).collect();
    if !ground.contains(&true) {
        return Err(Error::NoGround { exposure: options.exposure });
    }
    let mut report = report(machine, &scenario, &prepared, options, &view, &truth, &trials, &ground)?;
    report.notes.extend(left_out);
    Ok(report)
}

/// Face and level of the ground that a pixel's centre meets; `None` where there is no terrain.
fn level_of(hit: &Option<Hit>) -> Option<(usize, usize)> {
    match hit.as_ref()?.ground {
        Ground::Dem { face, level, .. } => Some((face, level)),
        Ground::Gap | Ground::Bare => None,
    }
}

/// Errors where each level of the terrain is seen. What a method with skylines at the nodes errs beyond the one whose
/// nodes hold swept ones, its encoding does; the rest is interpolated between nodes.
fn levels(prepared: &Prepared, truth: &Trial, trials: &[Trial], full_w_m2: f64) -> Table {
    let columns = [
        ("posting", "m"),
        ("method", ""),
        ("pixels", "%"),
        ("agreement", "%"),
        ("RMS", ""),
        ("penumbra RMS", ""),
        ("RMS against swath", ""),
    ];
    let mut table = Table::new("levels", "The same by the terrain's levels; errors in shares of full Sun", &columns);
    let mut seen: Vec<_> = truth.samples.centres.iter().filter_map(level_of).collect();
    seen.sort_unstable();
    seen.dedup();
    let uncompressed = registry::uncompressed_at_nodes();
    let swept = trials.iter().find(|trial| uncompressed.is_some_and(|name| trial.method.starts_with(name)));
    for (face, level) in seen {
        let here: Vec<bool> = truth.samples.centres.iter().map(|hit| level_of(hit) == Some((face, level))).collect();
        let posting_m = prepared.ground.surface.terrain.faces[face].levels[level].posting_m;
        for trial in trials {
            let against = |truth: &Trial| compare(&truth.samples.pixels, &trial.samples.pixels, &here, full_w_m2);
            let found = against(truth);
            let mut row = vec![posting_m.into(), trial.method.as_str().into()];
            let shares = [found.ground as f64 / here.len() as f64, found.agreement].map(|share| 100.0 * share);
            row.extend(shares.into_iter().chain([found.irradiance.rms, found.penumbra.rms]).map(Value::from));
            row.push(swept.map(|swept| against(swept).irradiance.rms).into());
            table.rows.push(row);
        }
    }
    table
}

fn traced_settings(scenario: &Scenario) -> perilune_engine::horizon::Settings {
    perilune_engine::horizon::Settings {
        azimuths: scenario.horizon.azimuths as usize,
        search_m: scenario.horizon.search_m,
        observer_height_m: scenario.horizon.observer_height_m,
        ..Default::default()
    }
}

/// An image of one method.
struct Trial {
    method: String,
    samples: Samples,
    /// From the renderer's call to its samples in memory; buffers were uploaded before.
    seconds: f64,
    /// The same of the first image, which uploads the terrain and finds skylines.
    first_seconds: Option<f64>,
    device_seconds: Option<f64>,
}

/// The truth, all others, and why some are left out.
fn render_all(
    mut scene: Scene,
    view: &View,
    factory: &MethodFactory,
    methods: &[String],
    progress: &dyn Progress,
) -> Result<(Trial, Vec<Trial>, Vec<String>), Error> {
    let gpu = Gpu::open(Adapter::Auto).map_err(|error| progress.say(&format!("no GPU method: {error}"))).ok();
    let (mut trials, mut left_out) = (Vec::new(), Vec::new());
    for name in methods {
        scene = match factory.method(name, progress) {
            Ok(shadows) => scene.with_shadows(shadows),
            Err(error) => {
                left_out.push(outside_domain(name, error)?);
                continue;
            }
        };
        progress.begin(&format!("rendering, {name}"), 1, "image");
        trials.push(match &gpu {
            Some(gpu) => on_device(name, gpu, &scene, view)?,
            None => trial(format!("{name}, reference"), &mut Renderer::Reference.session(&scene)?, view)?,
        });
    }
    let scene = scene.with_shadows(registry::reference(factory.settings));
    // Asks for the hits of the pixels' centres.
    let view = &view.clone().with_quantities([Quantity::DemGap]);
    progress.begin("rendering, traced", 1, "image");
    let truth = trial("traced, reference".into(), &mut Renderer::Reference.session(&scene)?, view)?;
    Ok((truth, trials, left_out))
}

/// The second of two images; the first one, under a Sun a little off, uploads the terrain. Skylines are found anew for the
/// second.
fn on_device(method: &str, gpu: &Gpu, scene: &Scene, view: &View) -> Result<Trial, Error> {
    let start = Instant::now();
    let mut session = Renderer::on(gpu).session(scene)?;
    let uploaded_s = start.elapsed().as_secs_f64();
    let first = trial(String::new(), &mut session, &elsewhere(view))?;
    let second = trial(format!("{method}, device"), &mut session, view)?;
    Ok(Trial { first_seconds: Some(uploaded_s + first.seconds), ..second })
}

/// The view with its lights moved by more than the raster on which they are held still, and less than matters.
fn elsewhere(view: &View) -> View {
    let mut view = view.clone();
    for light in &mut view.lights {
        light.position = Position::from_m(glam::DQuat::from_rotation_z(2e-5) * light.position.vector_m());
    }
    view
}

fn trial(method: String, session: &mut Session, view: &View) -> Result<Trial, Error> {
    let start = Instant::now();
    let samples = session.samples(view)?;
    let device_seconds = session.device_time().map(|time| time.as_secs_f64());
    Ok(Trial { method, samples, seconds: start.elapsed().as_secs_f64(), first_seconds: None, device_seconds })
}

/// Columns of methods and their units.
const METHOD_COLUMNS: [(&str, &str); 16] = [
    ("method", ""),
    ("agreement", "%"),
    ("lit in the dark", "%"),
    ("dark in the light", "%"),
    ("mean", ""),
    ("RMS", ""),
    ("p99", ""),
    ("max", ""),
    ("penumbra mean", ""),
    ("penumbra RMS", ""),
    ("penumbra p99", ""),
    ("penumbra max", ""),
    ("time", "s"),
    ("device", "s"),
    ("first image", "s"),
    ("RMS of lit ground's light", "%"),
];
#[allow(clippy::too_many_arguments)]
fn report(
    machine: Machine,
    scenario: &Scenario,
    prepared: &Prepared,
    options: &Options,
    view: &View,
    truth: &Trial,
    trials: &[Trial],
    ground: &[bool],
) -> Result<Report, Error> {
    let full_w_m2 = view.lights[0].irradiance_w_m2;
    let mut methods =
        Table::new("methods", "Shadows against traced ones; errors in shares of full Sun", &METHOD_COLUMNS);
    let mut figures = Vec::new();
    let mut points = Vec::new();
    for trial in trials {
        let found = compare(&truth.samples.pixels, &trial.samples.pixels, ground, full_w_m2);
        let Comparison { irradiance: all, penumbra, .. } = found;
        let shares = [found.agreement, found.lit_in_the_dark, found.dark_in_the_light].map(|share| 100.0 * share);
        let errors = [all.mean, all.rms, all.p99, all.max, penumbra.mean, penumbra.rms, penumbra.p99, penumbra.max];
        let mut row = vec![Value::Text(trial.method.clone())];
        row.extend(shares.into_iter().chain(errors).chain([trial.seconds]).map(Value::from));
        row.extend([trial.device_seconds, trial.first_seconds].map(Value::from));
        row.push((100.0 * all.rms / found.lit_ground).into());
        methods.rows.push(row);
        points.push(Curve { name: trial.method.clone(), points: vec![[trial.seconds, all.rms]], joined: false });
        figures.push(picture(scenario, truth, trial, ground)?);
    }
    let mut row = vec![Value::Text(truth.method.clone()), 100.0.into()];
    row.extend([0.0; 10].map(Value::from));
    row.extend([truth.seconds.into(), Value::Missing, Value::Missing, 0.0.into()]);
    methods.rows.push(row);

    let scene = scene_table::scene_table(scenario, prepared, options.exposure, truth, ground);
    Ok(Report {
        name: "shadows",
        title: format!("Shadows of {}, exposure {}", scenario.name, options.exposure),
        machine,
        notes: vec![
            "Truth: horizons traced over every grid line for 24 columns of the Sun's disc, reference renderer, f64."
                .into(),
            "RMS of lit ground's light: the RMS of the irradiance over the mean irradiance of ground that is lit."
                .into(),
            "Agreement: both see half the disc or more, or both less. Only pixels on terrain count.".into(),
            "Times include readback, and finding skylines for methods that find them in advance; \
             on a shared machine they are upper bounds."
                .into(),
        ],
        tables: vec![scene, methods, levels(prepared, truth, trials, full_w_m2)],
        plots: vec![Plot {
            title: "Error against time".into(),
            x: Axis::logarithmic("time of an image [s]"),
            y: Axis::logarithmic("RMS error of irradiance [full Sun]"),
            curves: points,
        }],
        figures,
    })
}

/// Grey radiance of the truth; red where the truth is dark and the method lit, blue where it is the other way round.
fn picture(scenario: &Scenario, truth: &Trial, trial: &Trial, ground: &[bool]) -> Result<Figure, Error> {
    let radiances = || truth.samples.pixels.iter().map(|pixel| f64::from(pixel.radiance_w_m2_sr));
    let white = Errors::of(radiances().filter(|radiance| radiance.is_finite())).p99.max(f64::MIN_POSITIVE);
    let colour = |index: usize| {
        let (a, b) = (&truth.samples.pixels[index], &trial.samples.pixels[index]);
        match (ground[index], lit(a), lit(b)) {
            (true, false, true) => image::Rgb([255, 0, 0]),
            (true, true, false) => image::Rgb([0, 80, 255]),
            _ => {
                let share = (f64::from(a.radiance_w_m2_sr) / white).clamp(0.0, 1.0);
                image::Rgb([(255.0 * share.powf(1.0 / 2.2)) as u8; 3])
            }
        }
    };
    let (columns, rows) = (scenario.camera.columns, scenario.camera.rows);
    let image = image::RgbImage::from_fn(columns, rows, |column, row| colour((row * columns + column) as usize));
    let mut png = std::io::Cursor::new(Vec::new());
    let name = trial.method.replace(", ", "_");
    image
        .write_to(&mut png, image::ImageFormat::Png)
        .map_err(|source| perilune_engine::report::Error::Png { name: name.clone(), source })?;
    let caption = format!("{}: red is lit where the truth is dark, blue dark where the truth is lit", trial.method);
    Ok(Figure { name, caption, png: png.into_inner() })
}
