//! How much slower a dataset is made than its images are rendered: what encoding and writing hold back.
//!
//! ```text
//! rendered   the renderer alone, samples of exposures one after the other
//! dataset    (run of n exposures − run of one) / (n − 1), by `sim run`'s own code: what is done once cancels
//! ```
//!
//! Beside rates stands the time of all cores, of the process alone: where the renderer is software the cores are one resource
//! that rendering and encoding share, and no overlap makes the rate larger than the share of rendering in it. Other programs
//! slow both rates down, but not that share.

use std::ops::Range;
use std::path::PathBuf;
use std::time::Instant;

use super::shadows::reduced;
use super::{Error, Machine, Report, Table, Value};
use perilune_engine::dataset::Existing;
use perilune_engine::gpu::{Adapter, Gpu};
use perilune_engine::pipeline::{self, AdapterChoice, Progress, Stages};
use perilune_engine::render::{Quantity, Renderer};
use perilune_engine::report::machine::process_seconds;
use perilune_engine::scenario::Scenario;

/// What to time.
#[derive(Debug, Clone)]
pub struct Options {
    /// At least two; `None`: the first six.
    pub exposures: Option<Range<usize>>,
    pub cache: PathBuf,
}

/// Pixels along the longer side.
const SIZES: [u32; 2] = [512, 1024];

/// Columns of the table and their units.
const COLUMNS: [(&str, &str); 12] = [
    ("pixels", ""),
    ("planes", ""),
    ("rendered", "images/s"),
    ("dataset", "images/s"),
    ("of the rendered rate", "%"),
    ("rendered, all cores", "s"),
    ("dataset, all cores", "s"),
    ("rendering's share", "%"),
    ("samples", "s"),
    ("planes", "s"),
    ("encoding", "s"),
    ("writing", "s"),
];

/// Wall and processor seconds an image.
#[derive(Debug, Clone, Copy)]
struct Cost {
    wall_s: f64,
    cpu_s: f64,
}

/// Times images of 512² and 1024² pixels, with and without ground truth.
pub fn run(scenario: &Scenario, options: &Options, progress: &dyn Progress) -> Result<Report, Error> {
    let machine = Machine::here();
    let count = scenario.images();
    let chosen = options.exposures.clone().unwrap_or(0..count.min(6));
    if chosen.len() < 2 || chosen.end > count {
        return Err(Error::Range { key: "exposures", got: chosen.end, allowed: [2, count] });
    }
    let mut table = Table::new("dataset", "An image, rendered alone and as part of a dataset", &COLUMNS);
    progress.begin("making datasets", 2 * SIZES.len(), "series");
    for size in SIZES {
        let mut sized = reduced(scenario, size);
        sized.camera.samples_per_pixel = scenario.camera.samples_per_pixel;
        for (name, planes) in
            [("radiance", vec![Quantity::Radiance]), ("with ground truth", scenario.outputs.planes.clone())]
        {
            sized.outputs.planes = planes;
            let rendered = rendered(&sized, &chosen, options)?;
            let (dataset, stages) = made(&sized, &chosen, options)?;
            let pixels = f64::from(sized.camera.columns) * f64::from(sized.camera.rows);
            let mut row: Vec<Value> = vec![pixels.into(), name.into()];
            row.extend(
                [1.0 / rendered.wall_s, 1.0 / dataset.wall_s, 100.0 * rendered.wall_s / dataset.wall_s]
                    .map(Value::from),
            );
            row.extend([rendered.cpu_s, dataset.cpu_s, 100.0 * rendered.cpu_s / dataset.cpu_s].map(Value::from));
            row.extend([stages.samples, stages.planes, stages.encoding, stages.writing].map(Value::from));
            table.rows.push(row);
            progress.at(table.rows.len(), 2 * SIZES.len());
        }
    }
    Ok(Report {
        name: "dataset",
        title: format!("A dataset of {}, exposures {}..{}", scenario.name, chosen.start, chosen.end),
        machine,
        notes: vec![
            "Rendered: the renderer's samples alone. Dataset: planes, records, OpenEXR, hashes, previews and all files too, by \
             the code of `sim run`; what is done once a run is not counted."
                .into(),
            "All cores: processor time of this program. Rendering's share of it is the most that the rate can reach where the \
             renderer runs on the same cores."
                .into(),
            "Stages: an image each, on threads of their own beside each other.".into(),
        ],
        tables: vec![table],
        plots: Vec::new(),
        figures: Vec::new(),
    })
}

/// The renderer alone.
fn rendered(scenario: &Scenario, chosen: &Range<usize>, options: &Options) -> Result<Cost, Error> {
    let gpu = Gpu::open(Adapter::Auto).ok();
    let mut prepared = pipeline::prepare(scenario, &options.cache, &pipeline::Silent)?;
    let scene = pipeline::build_scene(scenario, &mut prepared, &options.cache, &pipeline::Silent)?;
    let mut session = Renderer::on_any(gpu.as_ref()).session(&scene)?;
    // The first image uploads the terrain.
    session.samples(&prepared.exposures[chosen.start].view)?;
    let (clock, cpu_s) = (Instant::now(), process_seconds());
    for exposure in &prepared.exposures[chosen.start + 1..chosen.end] {
        session.samples(&exposure.view)?;
    }
    let images = (chosen.len() - 1) as f64;
    Ok(Cost { wall_s: clock.elapsed().as_secs_f64() / images, cpu_s: cpu_since(cpu_s) / images })
}

/// A dataset, and what its stages take.
fn made(scenario: &Scenario, chosen: &Range<usize>, options: &Options) -> Result<(Cost, Stages), Error> {
    let output = std::env::temp_dir().join(format!("perilune-bench-{}", std::process::id()));
    let timed = |exposures: Range<usize>| {
        let (clock, cpu_s) = (Instant::now(), process_seconds());
        let (cache, adapter) = (options.cache.clone(), AdapterChoice::Auto);
        let (exposures, output) = (Some(exposures.into()), output.clone());
        let options = pipeline::Options { output, cache, exposures, existing: Existing::default(), adapter };
        let stages = pipeline::run(scenario, &options, &pipeline::Silent)?.stages;
        Ok::<_, Error>((Cost { wall_s: clock.elapsed().as_secs_f64(), cpu_s: cpu_since(cpu_s) }, stages))
    };
    let (one, _) = timed(chosen.start..chosen.start + 1)?;
    let (all, stages) = timed(chosen.clone())?;
    // What cannot be removed is the temporary folder's to clear.
    let _ = std::fs::remove_dir_all(&output);
    let (images, more) = (chosen.len() as f64, (chosen.len() - 1) as f64);
    let cost = Cost { wall_s: (all.wall_s - one.wall_s) / more, cpu_s: (all.cpu_s - one.cpu_s) / more };
    let Stages { samples, planes, encoding, writing } = stages;
    let [samples, planes, encoding, writing] = [samples, planes, encoding, writing].map(|stage| stage / images);
    Ok((cost, Stages { samples, planes, encoding, writing }))
}

fn cpu_since(before: Option<f64>) -> f64 {
    process_seconds().zip(before).map_or(f64::NAN, |(now, before)| now - before)
}
