//! Where the time of an image goes, from the terrain to the file.

use std::path::PathBuf;
use std::time::Instant;

use super::shadows::reduced;
use super::{Error, Machine, Report, Table, Value};
use perilune_engine::dataset::write_exr;
use perilune_engine::gpu::{Adapter, Gpu};
use perilune_engine::pipeline::{self, Exposure, Progress};
use perilune_engine::render::passes::Passes;
use perilune_engine::render::reference::Reference;
use perilune_engine::render::{Quantity, Renderer, Samples, Scene, ViewRays, planes};
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
    progress.begin("rendering", 2 * SIZES.len(), "series");
    for size in SIZES {
        let mut sized = reduced(scenario, size);
        sized.camera.samples_per_pixel = scenario.camera.samples_per_pixel;
        for quantities in [vec![Quantity::Radiance], scenario.outputs.planes.clone()] {
            sized.outputs.planes = quantities;
            let scene = pipeline::scene(&sized, &mut prepared, &options.cache, &pipeline::Silent)?;
            let mut passes = gpu.as_ref().map(Passes::new);
            let mut reference = Reference;
            let renderer: &mut dyn Renderer = match &mut passes {
                Some(passes) => passes,
                None => &mut reference,
            };
            images.rows.push(series(renderer, &scene, &prepared.exposures[chosen.clone()], options.repeat)?);
            progress.at(images.rows.len(), 2 * SIZES.len());
        }
    }
    let mut rays = Table::new("rays", "Rays from the camera, medians of radiance alone", &RAY_COLUMNS);
    if let Some(gpu) = &gpu {
        for size in SIZES {
            let mut sized = reduced(scenario, size);
            sized.camera.samples_per_pixel = scenario.camera.samples_per_pixel;
            sized.outputs.planes = vec![Quantity::Radiance];
            let mut scene = pipeline::scene(&sized, &mut prepared, &options.cache, &pipeline::Silent)?;
            rays.rows.extend(view_rays(gpu, &mut scene, &prepared.exposures[chosen.clone()], options.repeat)?);
        }
    }
    let adapter = gpu.as_ref().map_or_else(|| Reference.adapter(), Gpu::describe);
    Ok(Report {
        name: "frame",
        title: format!("Images of {}, exposures {}..{}", scenario.name, chosen.start, chosen.end),
        machine,
        notes: notes(&adapter, options.repeat),
        tables: vec![stages, images, rays],
        plots: Vec::new(),
        pictures: Vec::new(),
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
        pipeline::scene(scenario, &mut prepared, &options.cache, progress)?;
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

/// Ways to find the first ground along a ray, the exact one first.
const VIEW_RAYS: [(&str, ViewRays); 4] = [
    ("exact", ViewRays::Exact),
    ("hybrid, 4 cells", ViewRays::Hybrid { mesh_cells: 4, steps: 32 }),
    ("hybrid, 8 cells", ViewRays::Hybrid { mesh_cells: 8, steps: 32 }),
    ("hybrid, 32 cells", ViewRays::Hybrid { mesh_cells: 32, steps: 32 }),
];

/// Time of each way, in turns, and where its radiance is not that of the exact one.
fn view_rays(gpu: &Gpu, scene: &mut Scene, exposures: &[Exposure], repeat: usize) -> Result<Vec<Vec<Value>>, Error> {
    let mut renderers = VIEW_RAYS.map(|_| Passes::new(gpu));
    let mut laps: [Vec<f64>; VIEW_RAYS.len()] = Default::default();
    let mut other = [0; VIEW_RAYS.len()];
    for exposure in exposures {
        let mut exact = None;
        for (way, (_, rays)) in VIEW_RAYS.into_iter().enumerate() {
            scene.view_rays = rays;
            // The first image uploads the terrain.
            let samples = renderers[way].samples(scene, &exposure.view)?;
            other[way] += others(exact.get_or_insert_with(|| samples.clone()), &samples);
        }
        for _ in 0..repeat {
            for (way, (_, rays)) in VIEW_RAYS.into_iter().enumerate() {
                scene.view_rays = rays;
                let clock = Instant::now();
                renderers[way].samples(scene, &exposure.view)?;
                laps[way].push(lap(clock));
            }
        }
    }
    let pixels = f64::from(scene.optics.columns) * f64::from(scene.optics.rows);
    let times = laps.map(|laps| median(laps).unwrap_or(f64::NAN));
    let rows = VIEW_RAYS.iter().zip(times).zip(other).map(|(((name, _), all), other)| {
        let share = other as f64 / (pixels * exposures.len() as f64);
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
fn series(
    renderer: &mut dyn Renderer,
    scene: &Scene,
    exposures: &[Exposure],
    repeat: usize,
) -> Result<Vec<Value>, Error> {
    // The first image uploads the terrain.
    renderer.samples(scene, &exposures[0].view)?;
    let path = std::env::temp_dir().join(format!("perilune-bench-{}.exr", std::process::id()));
    let mut laps: [Vec<f64>; 5] = Default::default();
    let mut bytes = 0;
    for exposure in exposures.iter().cycle().take(repeat * exposures.len()) {
        let clock = Instant::now();
        let samples = renderer.samples(scene, &exposure.view)?;
        let rendered = lap(clock);
        let device = renderer.device_time().map_or(f64::NAN, |time| time.as_secs_f64());
        let planes_clock = Instant::now();
        let image = planes::image(scene, &exposure.view, &samples);
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
    let pixels = f64::from(scene.optics.columns) * f64::from(scene.optics.rows);
    let rays = (scene.samples_per_side * scene.samples_per_side) as f64;
    let mut row: Vec<Value> = [pixels, rays].map(Value::from).to_vec();
    row.push(if scene.needs_centres() { "with ground truth" } else { "radiance" }.into());
    let times = [all, device, readback, planes, writing, bytes as f64 / 1_048_576.0, 1.0 / (all - writing), 1.0 / all];
    row.extend(times.map(Value::from));
    Ok(row)
}

fn lap(start: Instant) -> f64 {
    start.elapsed().as_secs_f64()
}
