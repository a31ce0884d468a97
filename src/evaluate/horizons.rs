//! Speed and error of horizons: swept, compressed, and as shadows.
//!
//! A *sample* is the horizon of one node in one azimuth. Speed is samples over the seconds that a thread spends on a
//! core, so that other programs' work does not count; errors are against [`Tracer`], at pixels spread evenly over the
//! level, in all azimuths. Shadows are decided by the same horizons: a sample is lit where its horizon is below the
//! Sun's centre, and in the penumbra the share of a uniform disc above a level line at the horizon's elevation stands
//! for the irradiance.

use std::path::PathBuf;
use std::time::Instant;

use glam::DVec2;
use rayon::prelude::*;

use super::machine::{forget_peak_memory, peak_memory_mib, thread_seconds};
use super::plot::{Axis, Curve, Plot};
use super::scenes::Scene;
use super::statistics::{Errors, median};
use super::{Error, Machine, Report, Table, Value};
use crate::horizon::measure::Sample;
use crate::horizon::sweep::Sweep;
use crate::horizon::sweep::grid::Major;
use crate::horizon::trace::Tracer;
use crate::horizon::{self, Encoding, Settings};
use crate::photometry::{LimbDarkening, SolarDisk};
use crate::pipeline::Progress;
use crate::quantity::SOLAR_RADIUS_M;

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

const ENCODINGS: [Encoding; 3] = [Encoding::Fm16, Encoding::W16, Encoding::W21];
const SUN_ELEVATIONS_DEG: [f64; 4] = [1.5, 3.0, 6.0, 15.0];
const ASTRONOMICAL_UNIT_M: f64 = 149_597_870_700.0;

/// Horizons of some pixels, `[pixel][azimuth]`, in radians.
pub type Profiles = Vec<Vec<f64>>;

/// Measures all scenes.
pub fn run(options: &Options, progress: &dyn Progress) -> Result<Report, Error> {
    let machine = Machine::here();
    let mut tables = Tables::new();
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
        plots: tables.plots(),
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

impl Tables {
    fn new() -> Self {
        Self {
            speed: Table::new(
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
            ),
            errors: Table::new(
                "errors",
                "Horizons against traced ones",
                &[
                    ("scene", ""),
                    ("horizons", ""),
                    ("samples", ""),
                    ("mean", "deg"),
                    ("RMS", "deg"),
                    ("p50", "deg"),
                    ("p95", "deg"),
                    ("p99", "deg"),
                    ("max", "deg"),
                ],
            ),
            tiles: Table::new(
                "tiles",
                "Tiles: sweep, fit, measured error and file",
                &[
                    ("scene", ""),
                    ("encoding", ""),
                    ("time", "s"),
                    ("samples/s", "M/s"),
                    ("in memory", "B/pixel"),
                    ("on disk", "B/pixel"),
                    ("peak memory", "MiB"),
                ],
            ),
            shadows: Table::new(
                "shadows",
                "Shadows by the same horizons against traced ones",
                &[
                    ("scene", ""),
                    ("horizons", ""),
                    ("Sun elevation", "deg"),
                    ("pixel error rate", "%"),
                    ("penumbra mean", "share of the disc"),
                    ("penumbra RMS", "share of the disc"),
                    ("all RMS", "share of the disc"),
                ],
            ),
        }
    }

    /// The pixel error rate over the Sun's elevation, a plot a scene.
    fn plots(&self) -> Vec<Plot> {
        let text = |row: &[Value], column: usize| row[column].text();
        let number = |row: &[Value], column: usize| match row[column] {
            Value::Number(number) => number,
            _ => f64::NAN,
        };
        let mut plots: Vec<Plot> = Vec::new();
        for row in &self.shadows.rows {
            let title = text(row, 0);
            if plots.last().is_none_or(|plot| plot.title != title) {
                plots.push(Plot {
                    title,
                    x: Axis::linear("elevation of the Sun [deg]"),
                    y: Axis::logarithmic("pixel error rate [%]"),
                    curves: Vec::new(),
                });
            }
            let curves = &mut plots.last_mut().expect("pushed above").curves;
            let name = text(row, 1);
            if curves.last().is_none_or(|curve| curve.name != name) {
                curves.push(Curve { name, points: Vec::new(), joined: true });
            }
            curves.last_mut().expect("pushed above").points.push([number(row, 2), number(row, 3)]);
        }
        plots
    }
}

fn measure(scene: &Scene, options: &Options, tables: &mut Tables, progress: &dyn Progress) -> Result<(), Error> {
    let name = Value::Text(scene.name.clone());
    let settings = Settings { azimuths: options.azimuths, ..Settings::default() };
    let receivers = scene.receivers() as f64;

    let (runs, azimuths) = options.clock();
    let speeds: Vec<f64> = (0..runs).map(|run| speed(scene, &settings, azimuths, run)).collect();
    let [slowest, fastest] = [speeds.iter().copied().reduce(f64::min), speeds.iter().copied().reduce(f64::max)];
    let mut row = vec![name.clone(), receivers.into(), (azimuths as f64).into(), (runs as f64).into()];
    row.extend([median(speeds), slowest, fastest].map(Value::from));
    tables.speed.rows.push(row);

    progress.begin(&format!("tracing {}", scene.name), 1, "scene");
    let pixels = Sample::of(&scene.face.levels[0], options.pixels, options.azimuths).pixels;
    let truth = traced(scene, &settings, &pixels);
    let mut trials = vec![("swept".to_owned(), swept(scene, &settings, &pixels))];
    for encoding in ENCODINGS {
        let label = format!("{encoding:?}").to_lowercase();
        let (profiles, row) = tile(scene, &settings, encoding, &pixels, progress)?;
        tables.tiles.rows.push([vec![name.clone(), label.as_str().into()], row].concat());
        trials.push((label, profiles));
    }
    for (label, profiles) in &trials {
        let Errors { count, mean, rms, p50, p95, p99, max } = errors(&truth, profiles);
        let mut row = vec![name.clone(), label.as_str().into(), (count as f64).into()];
        row.extend([mean, rms, p50, p95, p99, max].map(|rad| Value::from(rad.to_degrees())));
        tables.errors.rows.push(row);
    }
    for (label, profiles) in &trials {
        for elevation_deg in SUN_ELEVATIONS_DEG {
            let found = shadows(&truth, profiles, elevation_deg.to_radians())?;
            let mut row = vec![name.clone(), label.as_str().into(), elevation_deg.into()];
            row.extend([100.0 * found.wrong, found.penumbra.mean, found.penumbra.rms, found.all.rms].map(Value::from));
            tables.shadows.rows.push(row);
        }
    }
    Ok(())
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

/// The truth.
pub fn traced(scene: &Scene, settings: &Settings, pixels: &[[usize; 2]]) -> Profiles {
    let (tracer, level) = (Tracer::new(&scene.face, settings), &scene.face.levels[0]);
    let profile = |[column, row]: &[usize; 2]| {
        let foot = level.lifted_node(column + level.margin, row + level.margin);
        (0..settings.azimuths).map(|azimuth| tracer.skyline(foot, settings.direction(azimuth)).elevation_rad).collect()
    };
    pixels.par_iter().map(profile).collect()
}

/// What the sweep says.
pub fn swept(scene: &Scene, settings: &Settings, pixels: &[[usize; 2]]) -> Profiles {
    let mut profiles = vec![vec![0.0; settings.azimuths]; pixels.len()];
    for major in [Major::Row, Major::Column] {
        let sweep = Sweep::new(&scene.face, 0, major, settings);
        let along: Vec<usize> =
            (0..settings.azimuths).filter(|azimuth| Major::of(settings.direction(*azimuth)) == major).collect();
        let stride = sweep.receivers.stride;
        let at = |[column, row]: &[usize; 2]| match major {
            Major::Row => row * stride + column,
            Major::Column => column * stride + row,
        };
        let columns: Vec<(usize, Vec<f32>)> = along
            .into_par_iter()
            .map(|azimuth| {
                let plane = sweep.elevations_rad(settings.direction(azimuth));
                (azimuth, pixels.iter().map(|pixel| plane[at(pixel)]).collect())
            })
            .collect();
        for (azimuth, values) in columns {
            profiles.iter_mut().zip(values).for_each(|(profile, value)| profile[azimuth] = f64::from(value));
        }
    }
    profiles
}

/// What a tile decodes to, and its row of the table.
fn tile(
    scene: &Scene,
    settings: &Settings,
    encoding: Encoding,
    pixels: &[[usize; 2]],
    progress: &dyn Progress,
) -> Result<(Profiles, Vec<Value>), Error> {
    let folder = Scratch::new()?;
    progress.begin(&format!("{encoding:?} of {}", scene.name), settings.azimuths, "azimuths");
    forget_peak_memory();
    let start = Instant::now();
    let heard = |done: usize, total: usize| progress.at(done, total);
    let map = horizon::build(&scene.body, &scene.face, 0, settings, encoding, &folder.path, &heard)?;
    let seconds = start.elapsed().as_secs_f64();
    let peak_mib = peak_memory_mib();

    let receivers = scene.receivers() as f64;
    let samples = receivers * settings.azimuths as f64;
    let in_memory = map.bytes() as f64 / receivers;
    let on_disk = folder.bytes() as f64 / receivers;
    let row =
        vec![seconds.into(), (samples / seconds * 1e-6).into(), in_memory.into(), on_disk.into(), peak_mib.into()];
    let profile = |[column, row]: &[usize; 2]| {
        let series = map.horizon(DVec2::new(*column as f64, *row as f64));
        (0..settings.azimuths).map(|azimuth| series.evaluate_towards(settings.direction(azimuth)).0).collect()
    };
    Ok((pixels.par_iter().map(profile).collect(), row))
}

/// A folder that is gone when it is no longer needed.
struct Scratch {
    path: PathBuf,
}

impl Scratch {
    fn new() -> Result<Self, Error> {
        let path = std::env::temp_dir().join(format!("perilune-bench-{}", std::process::id()));
        std::fs::create_dir_all(&path).map_err(|source| Error::Write { path: path.clone(), source })?;
        Ok(Self { path })
    }

    fn bytes(&self) -> u64 {
        let Ok(entries) = std::fs::read_dir(&self.path) else { return 0 };
        entries.filter_map(|entry| Some(entry.ok()?.metadata().ok()?.len())).sum()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What cannot be removed is the temporary folder's to clear.
        let _ = std::fs::remove_dir_all(&self.path);
    }
}

/// Errors of all azimuths of all pixels.
pub fn errors(truth: &Profiles, tried: &Profiles) -> Errors {
    Errors::of(truth.iter().flatten().zip(tried.iter().flatten()).map(|(truth, tried)| tried - truth))
}

/// Shadows of profiles against those of the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowErrors {
    /// Share of samples that are lit in one and dark in the other.
    pub wrong: f64,
    /// Of the visible share of the disc, where either sees a part of it.
    pub penumbra: Errors,
    pub all: Errors,
}

/// A Sun at 1 au and at the same elevation in every azimuth.
pub fn shadows(truth: &Profiles, tried: &Profiles, sun_rad: f64) -> Result<ShadowErrors, Error> {
    let disk = SolarDisk::new(LimbDarkening::Uniform)?;
    let radius_rad = (SOLAR_RADIUS_M / ASTRONOMICAL_UNIT_M).asin();
    let pairs: Vec<[f64; 2]> =
        truth.iter().flatten().zip(tried.iter().flatten()).map(|(truth, tried)| [*truth, *tried]).collect();
    let wrong = pairs.iter().filter(|pair| (pair[0] < sun_rad) != (pair[1] < sun_rad)).count();
    let seen = |horizon_rad: f64| disk.visible_above((horizon_rad - sun_rad) / radius_rad);
    let shares: Vec<[f64; 2]> = pairs.iter().map(|pair| pair.map(seen)).collect();
    let error = |[truth, tried]: &[f64; 2]| tried - truth;
    let partial = |pair: &&[f64; 2]| pair.iter().any(|share| *share > 0.0 && *share < 1.0);
    Ok(ShadowErrors {
        wrong: wrong as f64 / pairs.len().max(1) as f64,
        penumbra: Errors::of(shares.iter().filter(partial).map(error)),
        all: Errors::of(shares.iter().map(error)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_horizons_err_nowhere_and_raised_ones_by_what_they_are_raised() {
        let truth: Profiles = (0..10).map(|p| (0..100).map(|a| 0.001 * f64::from(p * 7 + a)).collect()).collect();
        let same = shadows(&truth, &truth, 0.05).unwrap();
        assert_eq!((same.wrong, same.all.max), (0.0, 0.0));
        let raised: Profiles = truth.iter().map(|profile| profile.iter().map(|h| h + 0.0105).collect()).collect();
        let found = errors(&truth, &raised);
        assert!((found.mean - 0.0105).abs() < 1e-12 && (found.max - 0.0105).abs() < 1e-12);
        // Horizons step by 0.001: those within 0.0105 below the Sun, ten or eleven of each profile's 100, go dark.
        let wrong = shadows(&truth, &raised, 0.0805).unwrap();
        assert!((wrong.wrong - 0.105).abs() < 0.006, "{wrong:?}");
        // Each profile loses the light of 10.5 of its 100 samples.
        assert!((wrong.all.mean + 0.105).abs() < 1e-3, "{wrong:?}");
        assert!(wrong.penumbra.mean < -0.3, "{wrong:?}");
    }
}
