//! Samples a second on one core.

use std::time::Instant;

use crate::evaluate::machine::thread_seconds;
use crate::evaluate::scenes::Scene;
use crate::evaluate::statistics::median;
use crate::evaluate::{Table, Value};
use crate::horizon::Settings;
use crate::horizon::sweep::Sweep;
use crate::horizon::sweep::grid::Major;

/// The table that [`row`] fills.
pub fn table() -> Table {
    Table::new(
        "speed",
        "Sweep on one core",
        &[
            ("scene", ""),
            ("nodes", ""),
            ("azimuths", ""),
            ("runs", ""),
            ("median", "M samples/s/core"),
            ("slowest", "M samples/s/core"),
            ("fastest", "M samples/s/core"),
        ],
    )
}

/// Speed of the sweep of a scene: the median of `runs` of `azimuths` each, with the slowest and the fastest.
pub fn row(scene: &Scene, settings: &Settings, runs: usize, azimuths: usize) -> Vec<Value> {
    let speeds: Vec<f64> = (0..runs).map(|run| speed(scene, settings, azimuths, run)).collect();
    let [slowest, fastest] = [speeds.iter().copied().reduce(f64::min), speeds.iter().copied().reduce(f64::max)];
    let mut row = vec![scene.name.as_str().into()];
    row.extend([scene.receivers(), azimuths, runs].map(|count| Value::from(count as f64)));
    row.extend([median(speeds), slowest, fastest].map(Value::from));
    row
}

/// Millions of samples a second on one core, over azimuths spread evenly, others in every run.
fn speed(scene: &Scene, settings: &Settings, azimuths: usize, run: usize) -> f64 {
    let step = settings.azimuths / azimuths.min(settings.azimuths);
    let chosen = |major: Major| {
        let all = (0..settings.azimuths).skip((7 * run + 3) % step).step_by(step);
        all.map(|azimuth| settings.direction(azimuth)).filter(move |direction| Major::of(*direction) == major)
    };
    let (mut seconds, mut samples) = (0.0, 0);
    for major in [Major::Row, Major::Column] {
        let sweep = Sweep::new(&scene.face, 0, major, settings);
        for direction in chosen(major) {
            let (start, spent) = (Instant::now(), thread_seconds());
            std::hint::black_box(sweep.elevations_rad(direction));
            let spent = thread_seconds().zip(spent).map(|(end, start)| end - start);
            seconds += spent.unwrap_or_else(|| start.elapsed().as_secs_f64());
            samples += scene.receivers();
        }
    }
    samples as f64 / seconds * 1e-6
}
