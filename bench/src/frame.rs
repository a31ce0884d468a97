//! Where the time of an image goes, from the terrain to the file.

use std::path::PathBuf;
use std::time::Instant;

use super::shadows::reduced;
use super::{Error, Machine, Report, Table, Value};
use perilune_engine::dataset::write_exr;
use perilune_engine::gpu::{Adapter, Gpu};
use perilune_engine::pipeline::{self, Exposure, Progress};
use perilune_engine::render::{Quantity, Renderer, Samples, Scene, Session, View, ViewRays, planes};
use perilune_engine::scenario::Scenario;
use perilune_engine::statistics::median;

/// What to time.
#[derive(Debug, Clone)]
pub struct Options {
    /// The first exposure and the one after the last; `None`: the first four.
    pub exposures: Option<std::ops::Range<usize>>,
    /// Times that each exposure is rendered.
    pub repeat: usize,
    pub cache: PathBuf,
}

/// Pixels along the longer side.
const SIZES: [u32; 2] = [512, 1024];

/// Columns of images and their units.
const IMAGE_COLUMNS: [(&str, &str); 11] = [
    ("pixels", ""),
    ("rays per pixel", ""),
    ("planes", ""),
    ("all", "s"),
    ("device", "s"),
    ("readback", "s"),
    ("planes", "s"),
    ("writing", "s"),
    ("file", "MiB"),
    ("rendered", "images/s"),
    ("written too", "images/s"),
];
/// Columns of rays and their units.
const RAY_COLUMNS: [(&str, &str); 6] = [
    ("pixels", ""),
    ("rays", ""),
    ("all", "s"),
    ("to exact", ""),
    ("another radiance", "pixels"),
    ("another radiance", "%"),
];

/// Times a scenario's stages and images.
pub fn run(scenario: &Scenario, options: &Options, progress: &dyn Progress) -> Result<Report, Error> {
    let machine = Machine::here();
    let count = scenario.exposures.len();
    let chosen = options.exposures.clone().unwrap_or(0..count.min(4));
    if chosen.is_empty() || chosen.end > count {
        return Err(Error::Range { key: "exposures", got: chosen.end, allowed: [1, count] });
    }
    let mut stages = Table::new("stages", "Before the first image", &[("stage", ""), ("time", "s")]);
    let mut images = Table::new("images", "An image, medians", &IMAGE_COLUMNS);
    let gpu = Gpu::open(Adapter::Auto).map_err(|error| progress.say(&error.to_string())).ok();

    let (mut prepared, rows) = stages_of(scenario, options, progress)?;
    stages.rows = rows;

    let scene = pipeline::build_scene(scenario, &mut prepared, &options.cache, &pipeline::Silent)?;
    progress.begin("rendering", 2 * SIZES.len(), "series");
    for size in SIZES {
        let mut sized = reduced(scenario, size);
        sized.camera.samples_per_pixel = scenario.camera.samples_per_pixel;
        for quantities in [vec![Quantity::Radiance], scenario.outputs.planes.clone()] {
            sized.outputs.planes = quantities;
            let mut session = Renderer::on_any(gpu.as_ref()).session(&scene)?;
            let views = views(&sized, &prepared.exposures[chosen.clone()])?;
            images.rows.push(series(&mut session, &views, options.repeat)?);
            progress.at(images.rows.len(), 2 * SIZES.len());
        }
    }
    let mut rays = Table::new("rays", "Rays from the camera, medians of radiance alone", &RAY_COLUMNS);
    if let Some(gpu) = &gpu {
        for size in SIZES {
            let mut sized = reduced(scenario, size);
            sized.camera.samples_per_pixel = scenario.camera.samples_per_pixel;
            sized.outputs.planes = vec![Quantity::Radiance];
            let views = views(&sized, &prepared.exposures[chosen.clone()])?;
            rays.rows.extend(view_rays(gpu, &scene, &views, options.repeat)?);
        }
    }
    let adapter = Renderer::on_any(gpu.as_ref()).adapter();
    Ok(Report {
        name: "frame",
        title: format!("Images of {}, exposures {}..{}", scenario.name, chosen.start, chosen.end),
        machine,
        notes: notes(&adapter, options.repeat),
        tables: vec![stages, images, rays],
        plots: Vec::new(),
        figures: Vec::new(),
    })
}

/// The scenario prepared, and how long its stages take.
fn stages_of(
    scenario: &Scenario,
    options: &Options,
    progress: &dyn Progress,
) -> Result<(pipeline::Prepared, Vec<Vec<Value>>), Error> {
    let clock = Instant::now();
    let mut prepared = pipeline::prepare(scenario, &options.cache, progress)?;
    let mut rows = vec![vec!["kernels, terrain, poses".into(), lap(clock).into()]];
    for stage in ["horizons, built or read", "horizons, read again"] {
        let clock = Instant::now();
        pipeline::build_scene(scenario, &mut prepared, &options.cache, progress)?;
        rows.push(vec![stage.into(), lap(clock).into()]);
    }
    Ok((prepared, rows))
}

fn notes(adapter: &str, repeat: usize) -> Vec<String> {
    vec![
        format!("Rendered by {adapter}; {repeat} times each."),
        "Device: timestamps around the passes. Readback: the rest of the renderer's call, submission included."
            .into(),
        "Planes: ground truth in f64 on the CPU. Writing: one OpenEXR file, one image after the other; \
         `sim run` writes on another thread while the next image is rendered."
            .into(),
        "Rays: exact ones from the camera, those of Jung 2020 from a coarse mesh with squares of so many cells. Another \
         radiance: by more than a thousandth, over all exposures."
            .into(),
    ]
}

/// The views of some exposures by a scenario's own camera.
fn views(scenario: &Scenario, exposures: &[Exposure]) -> Result<Vec<View>, Error> {
    let view = |Exposure { view, .. }: &Exposure| {
        let sized = pipeline::scene::view(scenario, view.pose(), view.lights.clone())?;
        Ok(View { exposure: view.exposure, ..sized })
    };
    exposures.iter().map(view).collect()
}

fn pixels(view: &View) -> f64 {
    f64::from(view.optics.columns) * f64::from(view.optics.rows)
}

/// Ways to find the first ground along a ray, the exact one first.
const VIEW_RAYS: [(&str, ViewRays); 4] = [
    ("exact", ViewRays::Exact),
    ("hybrid, 4 cells", ViewRays::Hybrid { mesh_cells: 4, steps: 32 }),
    ("hybrid, 8 cells", ViewRays::Hybrid { mesh_cells: 8, steps: 32 }),
    ("hybrid, 32 cells", ViewRays::Hybrid { mesh_cells: 32, steps: 32 }),
];

/// Time of each way, in turns, and where its radiance is not that of the exact one.
fn view_rays(gpu: &Gpu, scene: &Scene, views: &[View], repeat: usize) -> Result<Vec<Vec<Value>>, Error> {
    let session = |(_, rays): &(&str, ViewRays)| Renderer::on(gpu).session(&scene.clone().with_view_rays(*rays));
    let mut sessions = VIEW_RAYS.iter().map(session).collect::<Result<Vec<_>, _>>()?;
    let mut laps: [Vec<f64>; VIEW_RAYS.len()] = Default::default();
    let mut other = [0; VIEW_RAYS.len()];
    for view in views {
        let mut exact = None;
        for (way, session) in sessions.iter_mut().enumerate() {
            let samples = session.samples(view)?;
            other[way] += others(exact.get_or_insert_with(|| samples.clone()), &samples);
        }
        for _ in 0..repeat {
            for (way, session) in sessions.iter_mut().enumerate() {
                let clock = Instant::now();
                session.samples(view)?;
                laps[way].push(lap(clock));
            }
        }
    }
    let pixels = views.first().map_or(0.0, pixels);
    let times = laps.map(|laps| median(laps).unwrap_or(f64::NAN));
    let rows = VIEW_RAYS.iter().zip(times).zip(other).map(|(((name, _), all), other)| {
        let share = other as f64 / (pixels * views.len() as f64);
        vec![
            pixels.into(),
            (*name).into(),
            all.into(),
            (all / times[0]).into(),
            (other as f64).into(),
            (100.0 * share).into(),
        ]
    });
    Ok(rows.collect())
}

/// Pixels whose radiances differ by more than a thousandth.
fn others(exact: &Samples, tried: &Samples) -> usize {
    let differs = |(a, b): &(f32, f32)| a.is_nan() != b.is_nan() || (a - b).abs() > 1e-3 * a.abs().max(b.abs());
    let radiances = exact.pixels.iter().zip(&tried.pixels).map(|(a, b)| (a.radiance_w_m2_sr, b.radiance_w_m2_sr));
    radiances.filter(differs).count()
}

/// Medians over some exposures, as a row of the table.
fn series(session: &mut Session, views: &[View], repeat: usize) -> Result<Vec<Value>, Error> {
    // The first image compiles the program.
    session.samples(&views[0])?;
    let path = std::env::temp_dir().join(format!("perilune-bench-{}.exr", std::process::id()));
    let mut laps: [Vec<f64>; 5] = Default::default();
    let mut bytes = 0;
    for view in views.iter().cycle().take(repeat * views.len()) {
        let clock = Instant::now();
        let samples = session.samples(view)?;
        let rendered = lap(clock);
        let device = session.device_time().map_or(f64::NAN, |time| time.as_secs_f64());
        let planes_clock = Instant::now();
        let image = planes::image(session.scene(), view, &samples);
        let planes = lap(planes_clock);
        let writing_clock = Instant::now();
        write_exr(&path, &image, &serde_json::Value::Null)?;
        let writing = lap(writing_clock);
        bytes = std::fs::metadata(&path).map_or(0, |file| file.len());
        let measured = [lap(clock), device, rendered - device, planes, writing];
        laps.iter_mut().zip(measured).for_each(|(laps, seconds)| laps.push(seconds));
    }
    // What cannot be removed is the temporary folder's to clear.
    let _ = std::fs::remove_file(&path);
    let [all, device, readback, planes, writing] = laps.map(|laps| median(laps).unwrap_or(f64::NAN));
    let view = &views[0];
    let pixels = pixels(view);
    let rays = (view.samples_per_side * view.samples_per_side) as f64;
    let mut row: Vec<Value> = [pixels, rays].map(Value::from).to_vec();
    row.push(if session.scene().needs_centres(view) { "with ground truth" } else { "radiance" }.into());
    let times = [all, device, readback, planes, writing, bytes as f64 / 1_048_576.0, 1.0 / (all - writing), 1.0 / all];
    row.extend(times.map(Value::from));
    Ok(row)
}

fn lap(start: Instant) -> f64 {
    start.elapsed().as_secs_f64()
}
