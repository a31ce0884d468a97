//! Every shadow method at several elevations of the Sun: time, memory and error.
//!
//! The Sun stands still at one azimuth. For each elevation and method the first image gives the *preparation* (maps that
//! are not in the cache, skylines, upload of the terrain, less one frame), the next ones the time of a *frame*. Errors are
//! those of [`super::compare`]; images are compared as radiance, white at the truth's 99th percentile, sRGB for FLIP. A method
//! that cannot do an elevation has an empty row, and a note says why.
//!
//! ```text
//! frontier: methods that no other one beats in both time and RMS error
//! ```

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::methods::{MethodFactory, outside_domain};
use super::truth::{ERRORS, Truth};
use super::{Options, Trial, comparable, picture, traced_settings, trial};
use crate::step_cache::StepCache;
use crate::{Error, Machine, Report, Table, Value};
use perilune_engine::gpu::{Adapter, Gpu};
use perilune_engine::horizon::HorizonMap;
use perilune_engine::pipeline::{self, Prepared, Progress, motion};
use perilune_engine::quantity::ASTRONOMICAL_UNIT_M;
use perilune_engine::render::{Renderer, Scene, View};
use perilune_engine::report::Figure;
use perilune_engine::report::plot::{Axis, Curve, Plot};
use perilune_engine::scenario::{FixedSun, Scenario};
use perilune_engine::statistics::median;

/// Elevations of the Sun's centre in a quick run, in degrees.
pub const QUICK_DEG: [f64; 3] = [1.5, 6.0, 15.0];

/// Before [`ERRORS`].
const COLUMNS: [(&str, &str); 7] = [
    ("Sun", "deg"),
    ("method", ""),
    ("preparation", "s"),
    ("bytes per node", ""),
    ("frame", "s"),
    ("least", "s"),
    ("most", "s"),
];

/// Renders the exposure under a Sun at each elevation with every method and compares. What a run that was stopped has measured
/// is not measured again.
pub fn run(
    scenario: &Scenario,
    options: &Options,
    elevations_deg: &[f64],
    repeat: usize,
    progress: &dyn Progress,
) -> Result<Report, Error> {
    let mut bench = Bench::new(scenario, options, repeat, progress)?;
    let kept = StepCache::new(&options.cache, &(scenario, options, elevations_deg, repeat))?;
    let mut notes = bench.notes();
    let columns = [&COLUMNS[..], &ERRORS].concat();
    let mut table =
        Table::new("methods", "Time, memory and error against traced shadows; errors in shares of full Sun", &columns);
    let (mut plots, mut figures) = (Vec::new(), Vec::new());
    for (index, &elevation_deg) in elevations_deg.iter().enumerate() {
        let name = format!("sun_{elevation_deg}");
        let found = kept.step(&name, || bench.measure_all(elevation_deg, index == 0, progress))?;
        plots.push(pareto(elevation_deg, found.points));
        table.rows.extend(found.rows);
        figures.extend(found.pictures);
        notes.extend(found.notes);
    }
    kept.end()?;
    Ok(Report {
        name: "shadows",
        title: format!("Shadows of {} at {} elevations of the Sun", scenario.name, elevations_deg.len()),
        machine: Machine::here(),
        notes,
        tables: vec![table],
        plots,
        figures,
    })
}

/// What one elevation of the Sun shows.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Found {
    rows: Vec<Vec<Value>>,
    /// Methods with the time of a frame and the RMS error.
    points: Vec<(String, [f64; 2])>,
    pictures: Vec<Figure>,
    notes: Vec<String>,
}

/// An exposure that is rendered again and again.
struct Bench<'a> {
    options: &'a Options,
    repeat: usize,
    scenario: Scenario,
    prepared: Prepared,
    scene: Scene,
    maps: Vec<Vec<HorizonMap>>,
    azimuth_rad: f64,
    gpu: Option<Gpu>,
}

impl<'a> Bench<'a> {
    fn new(scenario: &Scenario, options: &'a Options, repeat: usize, progress: &dyn Progress) -> Result<Self, Error> {
        let mut scenario = comparable(scenario, options)?;
        // One map serves all elevations.
        scenario.horizon.band = false;
        let mut prepared = pipeline::prepare(&scenario, &options.cache, progress)?;
        let scene = pipeline::build_scene(&scenario, &mut prepared, &options.cache, progress)?;
        let maps = scene.shadows.maps().unwrap_or_default().to_vec();
        let sky = perilune_engine::ephemeris::horizontal(
            &prepared.frame.body,
            prepared.ground.centre,
            prepared.exposures[options.exposure].sun.direction,
        );
        let azimuth_rad = scenario.sun.fixed.map_or(sky.azimuth_rad, |fixed| fixed.azimuth_rad);
        let gpu = Gpu::open(Adapter::Auto).map_err(|error| progress.say(&format!("no GPU method: {error}"))).ok();
        Ok(Self { options, repeat, scenario, prepared, scene, maps, azimuth_rad, gpu })
    }

    fn notes(&self) -> Vec<String> {
        let (camera, repeat) = (&self.scenario.camera, self.repeat);
        let azimuth_deg = self.azimuth_rad.to_degrees();
        vec![
            "Truth: horizons traced over every grid line for 24 columns of the Sun's disc, reference renderer, f64."
                .into(),
            format!(
                "{}×{} pixels, Sun at azimuth {azimuth_deg:.1}°; frame: median of {repeat} with the Sun standing still, \
                 readback included.",
                camera.columns, camera.rows
            ),
            "Preparation counts no horizon maps that the cache had. FLIP stands in for LPIPS, whose trained weights \
             cannot be shipped."
                .into(),
        ]
    }

    /// All methods at one elevation.
    fn measure_all(
        &mut self,
        elevation_deg: f64,
        with_pictures: bool,
        progress: &dyn Progress,
    ) -> Result<Found, Error> {
        let view = self.turn_sun(elevation_deg)?;
        let Self { options, scenario, prepared, scene, gpu, .. } = self;
        let factory = MethodFactory {
            prepared,
            settings: traced_settings(scenario),
            maps: self.maps.clone(),
            cache: &options.cache,
        };
        progress.begin(&format!("traced, Sun at {elevation_deg}°"), 1, "image");
        let truth = Truth::of(scene, &view, &factory)?;
        let mut found = Found::default();
        for method in &options.methods {
            progress.begin(&format!("{method}, Sun at {elevation_deg}°"), 1, "image");
            let measured = match measure(method, scene, &view, &factory, (gpu.as_ref(), self.repeat), progress) {
                Ok(measured) => measured,
                Err(error) => {
                    let why = outside_domain(method, error)?;
                    found.rows.push(empty(elevation_deg, method));
                    found.notes.push(format!("Sun at {elevation_deg}°, {why}"));
                    continue;
                }
            };
            let [least_s, frame_s, most_s] = measured.frame_s;
            let mut row = vec![elevation_deg.into(), method.as_str().into()];
            row.extend([measured.preparation_s, measured.bytes_per_node, frame_s, least_s, most_s].map(Value::from));
            let light = truth.compared(&view, &measured.trial);
            row.extend(truth.errors(scenario, &light, &measured.trial, measured.horizon_rms_deg));
            found.rows.push(row);
            found.points.push((method.clone(), [frame_s, light.irradiance.rms]));
            if with_pictures {
                found.pictures.push(picture(scenario, &truth.trial, &measured.trial, &truth.ground)?);
            }
        }
        Ok(found)
    }

    /// The exposure under a Sun at an elevation; it alone remains: a swath needs no azimuths but its own.
    fn turn_sun(&mut self, elevation_deg: f64) -> Result<View, Error> {
        let (azimuth_rad, elevation_rad) = (self.azimuth_rad, elevation_deg.to_radians());
        self.scenario.sun.fixed = Some(FixedSun { azimuth_rad, elevation_rad, distance_m: ASTRONOMICAL_UNIT_M });
        let Prepared { almanac, frame, ground, .. } = &self.prepared;
        let points = std::slice::from_ref(&self.scenario);
        let (mut all, _) = motion::exposures(points, almanac, frame, &ground.surface, ground.centre)?;
        let exposure = all.swap_remove(self.options.exposure);
        let view = exposure.view.clone();
        self.prepared.exposures = vec![exposure];
        Ok(view)
    }
}

/// The row of a method that cannot do an elevation.
fn empty(elevation_deg: f64, method: &str) -> Vec<Value> {
    let mut row = vec![elevation_deg.into(), method.into()];
    row.resize(COLUMNS.len() + ERRORS.len(), Value::Missing);
    row
}

/// What a method takes, and its image.
struct Measured {
    trial: Trial,
    preparation_s: f64,
    /// Least, median, most.
    frame_s: [f64; 3],
    bytes_per_node: f64,
    horizon_rms_deg: Option<f64>,
}

/// The image of a method and its times.
fn measure(
    method: &str,
    scene: &mut Scene,
    view: &View,
    factory: &MethodFactory,
    (gpu, repeat): (Option<&Gpu>, usize),
    progress: &dyn Progress,
) -> Result<Measured, Error> {
    let start = Instant::now();
    *scene = scene.clone().with_shadows(factory.method(method, progress)?);
    let mut session = Renderer::on_any(gpu).session(scene)?;
    let first = trial(method.into(), &mut session, view)?;
    let all_s = start.elapsed().as_secs_f64();
    let mut frames = vec![first];
    for _ in 0..repeat {
        frames.push(trial(method.into(), &mut session, view)?);
    }
    let times: Vec<f64> = frames[1..].iter().map(|frame| frame.seconds).collect();
    let least_s = times.iter().copied().fold(f64::INFINITY, f64::min);
    let most_s = times.iter().copied().fold(0.0, f64::max);
    let frame_s = median(times).unwrap_or(f64::NAN);
    Ok(Measured {
        trial: frames.swap_remove(0),
        preparation_s: (all_s - frame_s).max(0.0),
        frame_s: [least_s, frame_s, most_s],
        bytes_per_node: factory.bytes_per_node(scene.shadows.as_ref()),
        horizon_rms_deg: scene.shadows.maps().and_then(horizon_rms_deg),
    })
}

/// What tiles have measured of their own error: of the one with the largest.
fn horizon_rms_deg(maps: &[Vec<HorizonMap>]) -> Option<f64> {
    let rms = |map: &HorizonMap| map.errors.decoded.rms_rad.to_degrees();
    maps.iter().flatten().map(rms).max_by(f64::total_cmp)
}

/// The frontier as a line, and points by name upon it.
fn pareto(elevation_deg: f64, points: Vec<(String, [f64; 2])>) -> Plot {
    let line = frontier(points.iter().map(|(_, point)| *point).collect());
    let mut curves = vec![Curve { name: "frontier".into(), points: line, joined: true }];
    curves.extend(points.into_iter().map(|(name, point)| Curve { name, points: vec![point], joined: false }));
    Plot {
        title: format!("Sun at {elevation_deg}°"),
        x: Axis::logarithmic("time of a frame [s]"),
        y: Axis::logarithmic("RMS error of irradiance [full Sun]"),
        curves,
    }
}

/// Those that no other point beats in one and equals in the other, by the first.
pub fn frontier(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut least = f64::INFINITY;
    points.retain(|point| {
        let better = point[1] < least;
        least = least.min(point[1]);
        better
    });
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frontier_keeps_what_nothing_beats() {
        let points = vec![[3.0, 1.0], [1.0, 5.0], [2.0, 6.0], [2.0, 4.0], [4.0, 1.0], [5.0, 0.5]];
        assert_eq!(frontier(points), [[1.0, 5.0], [2.0, 4.0], [3.0, 1.0], [5.0, 0.5]]);
    }
}
