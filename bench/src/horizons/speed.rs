//! Samples a second on one core.

use std::hint::black_box;
use std::time::Instant;

use crate::scenes::Scene;
use crate::{Error, Table, Value};
use perilune_engine::horizon::axis::Major;
use perilune_engine::horizon::measure::Sample;
use perilune_engine::horizon::search::Search;
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::horizon::{Method, Settings};
use perilune_engine::report::machine::thread_seconds;
use perilune_engine::statistics::median;

/// Pixels that the trace is timed on: it is slow, and as slow for each of them.
const TRACED_PIXELS: usize = 24;

/// The table that [`rows`] fill.
pub fn table() -> Table {
    Table::new(
        "speed",
        "Speed on one core",
        &[
            ("scene", ""),
            ("horizons", ""),
            ("nodes", ""),
            ("azimuths", ""),
            ("runs", ""),
            ("median", "M samples/s/core"),
            ("slowest", "M samples/s/core"),
            ("fastest", "M samples/s/core"),
        ],
    )
}

/// Speeds of sweep, exact search and trace: each the median of `runs` of `azimuths` each, with the slowest and the
/// fastest. The methods take turns, so that a machine that slows down slows all of them.
pub fn rows(scene: &Scene, settings: &Settings, runs: usize, azimuths: usize) -> Result<Vec<Vec<Value>>, Error> {
    let labels = ["swept", "exact", "traced"];
    let mut speeds = labels.map(|_| Vec::new());
    for run in 0..runs {
        for (method, speeds) in [Method::Sweep, Method::Exact].into_iter().zip(&mut speeds) {
            speeds.push(searched(scene, &Settings { method, ..*settings }, azimuths, run)?);
        }
        speeds[2].push(traced(scene, settings, azimuths));
    }
    let row = |(label, speeds): (&str, Vec<f64>)| {
        let ends = [f64::min, f64::max].map(|end| speeds.iter().copied().reduce(end));
        let mut row = vec![scene.name.as_str().into(), label.into()];
        row.extend([scene.receivers(), azimuths, runs].map(|count| Value::from(count as f64)));
        row.extend([median(speeds), ends[0], ends[1]].map(Value::from));
        row
    };
    Ok(labels.into_iter().zip(speeds).map(row).collect())
}

/// Millions of samples a second on one core, over azimuths spread evenly, others in every run.
pub fn searched(scene: &Scene, settings: &Settings, azimuths: usize, run: usize) -> Result<f64, Error> {
    let step = settings.azimuths / azimuths.min(settings.azimuths);
    let chosen = |major: Major| {
        let all = (0..settings.azimuths).skip((7 * run + 3) % step).step_by(step);
        all.map(|azimuth| settings.direction(azimuth)).filter(move |direction| Major::of(*direction) == major)
    };
    let (mut seconds, mut samples) = (0.0, 0);
    for major in [Major::Row, Major::Column] {
        let search = Search::new(&scene.face, 0, major, settings, None)?;
        for direction in chosen(major) {
            let mut found = Ok(Vec::new());
            seconds += spent(|| found = black_box(search.elevations_rad(direction)));
            found?;
            samples += scene.receivers();
        }
    }
    Ok(samples as f64 / seconds * 1e-6)
}

/// The same of the trace, at a few pixels.
fn traced(scene: &Scene, settings: &Settings, azimuths: usize) -> f64 {
    let (tracer, level) = (Tracer::new(&scene.face, settings), &scene.face.levels[0]);
    let pixels = Sample::of(level, TRACED_PIXELS, settings.azimuths).pixels;
    let step = settings.azimuths / azimuths.min(settings.azimuths);
    let mut samples = 0;
    let seconds = spent(|| {
        for [column, row] in &pixels {
            let foot = level.lifted_node(column + level.margin, row + level.margin);
            for azimuth in (0..settings.azimuths).step_by(step) {
                black_box(tracer.skyline(foot, settings.direction(azimuth)));
                samples += 1;
            }
        }
    });
    samples as f64 / seconds * 1e-6
}

/// Seconds that this thread spends on a core, or that pass, where the system cannot tell.
pub fn spent(work: impl FnOnce()) -> f64 {
    let (start, before) = (Instant::now(), thread_seconds());
    work();
    let spent = thread_seconds().zip(before).map(|(end, start)| end - start);
    spent.unwrap_or_else(|| start.elapsed().as_secs_f64())
}
