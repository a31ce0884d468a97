//! Every shadow method at several elevations of the Sun: time, memory and error.
//!
//! The Sun stands still at one azimuth. For each elevation and method the first image gives the *preparation* (maps that
//! are not in the cache, skylines, upload of the terrain, less one frame), the next ones the time of a *frame*. Errors are
//! those of [`super::compare`]; images are compared as radiance, white at the truth's 99th percentile, sRGB for FLIP.
//!
//! ```text
//! frontier: methods that no other one beats in both time and RMS error
//! ```
//!
//! # Assumptions
//! A shadow's displacement is along the Sun's direction in the image, in metres of a pixel's width at the median range.

use std::time::Instant;

use glam::DVec2;

use super::methods::Workshop;
use super::{Options, Trial, compare, picture, reduced, traced_settings, trial};
use crate::evaluate::images::{Grid, edges, flip, ssim};
use crate::evaluate::plot::{Axis, Curve, Plot};
use crate::evaluate::statistics::{Errors, median};
use crate::evaluate::{Error, Machine, Report, Table, Value};
use crate::gpu::{Adapter, Gpu};
use crate::horizon::HorizonMap;
use crate::pipeline::{self, Progress, motion};
use crate::quantity::ASTRONOMICAL_UNIT_M;
use crate::render::passes::Passes;
use crate::render::reference::Reference;
use crate::render::{Quantity, Renderer, Scene, Shadows, View};
use crate::scenario::{self, FixedSun, Scenario};
use crate::terrain::Ground;

/// Elevations of the Sun's centre in a quick run, in degrees.
pub const QUICK_DEG: [f64; 3] = [1.5, 6.0, 15.0];

const COLUMNS: [(&str, &str); 15] = [
    ("Sun", "deg"),
    ("method", ""),
    ("preparation", "s"),
    ("bytes per node", ""),
    ("frame", "s"),
    ("least", "s"),
    ("most", "s"),
    ("agreement", "%"),
    ("RMS", ""),
    ("p99", ""),
    ("penumbra RMS", ""),
    ("horizon RMS", "deg"),
    ("SSIM", ""),
    ("FLIP", ""),
    ("edge displaced", "m"),
];

/// Renders the exposure under a Sun at each elevation with every method and compares.
pub fn run(
    scenario: &Scenario,
    options: &Options,
    elevations_deg: &[f64],
    repeat: usize,
    progress: &dyn Progress,
) -> Result<Report, Error> {
    let machine = Machine::here();
    let mut scenario = Scenario { shadows: scenario::Shadows::Fourier, ..reduced(scenario, options.pixels) };
    if scenario.terrain.is_none() {
        return Err(Error::NoTerrain);
    }
    if scenario.shows_globe() {
        return Err(Error::Globe);
    }
    // One map serves all elevations.
    scenario.horizon.band = false;
    let mut prepared = pipeline::prepare(&scenario, &options.cache, progress)?;
    let last = prepared.exposures.len() - 1;
    if options.exposure > last {
        return Err(Error::Range { key: "exposure", got: options.exposure, allowed: [0, last] });
    }
    let mut scene = pipeline::scene(&scenario, &mut prepared, &options.cache, progress)?;
    let maps = scene.shadows.maps().unwrap_or_default().to_vec();
    let sky = crate::ephemeris::horizontal(
        &prepared.frame.body,
        prepared.ground.centre,
        prepared.exposures[options.exposure].sun.direction,
    );
    let azimuth_rad = scenario.sun.fixed.map_or(sky.azimuth_rad, |fixed| fixed.azimuth_rad);
    let gpu = Gpu::open(Adapter::Auto).map_err(|error| progress.say(&format!("no GPU method: {error}"))).ok();

    let mut table =
        Table::new("methods", "Time, memory and error against traced shadows; errors in shares of full Sun", &COLUMNS);
    let (mut plots, mut pictures) = (Vec::new(), Vec::new());
    for (index, &elevation_deg) in elevations_deg.iter().enumerate() {
        let elevation_rad = elevation_deg.to_radians();
        scenario.sun.fixed = Some(FixedSun { azimuth_rad, elevation_rad, distance_m: ASTRONOMICAL_UNIT_M });
        let (surface, centre) = (&prepared.ground.surface, prepared.ground.centre);
        let (all, _) =
            motion::exposures(std::slice::from_ref(&scenario), &prepared.almanac, &prepared.frame, surface, centre)?;
        // A swath needs no azimuths but this one's.
        prepared.exposures = vec![all[options.exposure].clone()];
        let view = prepared.exposures[0].view.clone();
        let workshop = Workshop {
            prepared: &prepared,
            settings: traced_settings(&scenario),
            maps: maps.clone(),
            cache: &options.cache,
        };
        let truth = truth(&mut scene, &view, &workshop, elevation_deg, progress)?;
        let mut points = Vec::new();
        for method in &options.methods {
            progress.begin(&format!("{method}, Sun at {elevation_deg}°"), 1, "image");
            let measured = measure(method, gpu.as_ref(), &mut scene, &view, &workshop, repeat, progress)?;
            let row = truth.row(&scenario, &view, elevation_deg, &measured);
            points.push((method.clone(), [measured.frame_s[1], truth.compared(&view, &measured.trial).irradiance.rms]));
            table.rows.push(row);
            if index == 0 {
                pictures.push(picture(&scenario, &truth.trial, &measured.trial, &truth.ground)?);
            }
        }
        plots.push(pareto(elevation_deg, points));
    }
    Ok(Report {
        name: "shadows",
        title: format!("Shadows of {} at {} elevations of the Sun", scenario.name, elevations_deg.len()),
        machine,
        notes: vec![
            "Truth: horizons traced over every grid line for 24 columns of the Sun's disc, reference renderer, f64."
                .into(),
            format!(
                "{}×{} pixels, Sun at azimuth {:.1}°; frame: median of {repeat} with the Sun standing still, readback included.",
                scenario.camera.columns,
                scenario.camera.rows,
                azimuth_rad.to_degrees()
            ),
            "Preparation counts no horizon maps that the cache had. FLIP stands in for LPIPS, whose trained weights \
             cannot be shipped."
                .into(),
        ],
        tables: vec![table],
        plots,
        pictures,
    })
}

/// Truth of one elevation.
struct Truth {
    trial: Trial,
    ground: Vec<bool>,
    /// Radiance that is shown white.
    white: f64,
    /// Along which the ground of the image comes nearer to the Sun, and a pixel's width on it.
    towards_sun: Option<DVec2>,
    pixel_m: f64,
}

fn truth(
    scene: &mut Scene,
    view: &View,
    workshop: &Workshop,
    elevation_deg: f64,
    progress: &dyn Progress,
) -> Result<Truth, Error> {
    scene.shadows = Shadows::Traced(workshop.settings);
    let quantities = std::mem::replace(&mut scene.quantities, vec![Quantity::DemGap]);
    progress.begin(&format!("traced, Sun at {elevation_deg}°"), 1, "image");
    let trial = trial("traced, reference".into(), &mut Reference, scene, view)?;
    scene.quantities = quantities;
    let centres = &trial.samples.centres;
    let on_ground = |hit: &crate::terrain::Hit| matches!(hit.ground, Ground::Dem { .. });
    let ground: Vec<bool> = centres.iter().map(|hit| hit.as_ref().is_some_and(on_ground)).collect();
    if !ground.contains(&true) {
        return Err(Error::NoGround { exposure: 0 });
    }
    let radiances = trial.samples.pixels.iter().map(|pixel| f64::from(pixel.radiance_w_m2_sr));
    let white = Errors::of(radiances.filter(|radiance| radiance.is_finite())).p99.max(f64::MIN_POSITIVE);
    let range_m = median(centres.iter().flatten().map(|hit| hit.distance_m).collect()).unwrap_or(f64::NAN);
    let pixel_m = range_m / scene.optics.focal_px.x;
    Ok(Truth { towards_sun: towards_sun(scene, view, &trial), trial, ground, white, pixel_m })
}

/// The direction of the image in which the ground in its middle comes nearer to the Sun.
fn towards_sun(scene: &Scene, view: &View, trial: &Trial) -> Option<DVec2> {
    let centres = &trial.samples.centres;
    let middle = centres.len() / 2 + scene.optics.columns as usize / 2;
    let hit = centres.get(middle).copied().flatten().or_else(|| centres.iter().flatten().next().copied())?;
    let camera_m = view.camera_position.vector_m();
    let here = hit.position.vector_m();
    let ahead = (view.lights[0].position.vector_m() - here).reject_from(here.normalize()).try_normalize()?;
    let pixel = |point: glam::DVec3| {
        let seen = crate::geometry::Direction::new(point - camera_m)?;
        scene.optics.pixel(view.camera_from_body * seen)
    };
    (pixel(here + 1e-3 * hit.distance_m * ahead)? - pixel(here)?).try_normalize()
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

fn measure(
    method: &str,
    gpu: Option<&Gpu>,
    scene: &mut Scene,
    view: &View,
    workshop: &Workshop,
    repeat: usize,
    progress: &dyn Progress,
) -> Result<Measured, Error> {
    let mut renderer: Box<dyn Renderer> = match gpu {
        Some(gpu) => Box::new(Passes::new(gpu)),
        None => Box::new(Reference),
    };
    let start = Instant::now();
    scene.shadows = workshop.shadows(method, progress)?;
    let first = trial(method.into(), renderer.as_mut(), scene, view)?;
    let all_s = start.elapsed().as_secs_f64();
    let mut frames = vec![first];
    for _ in 0..repeat {
        frames.push(trial(method.into(), renderer.as_mut(), scene, view)?);
    }
    let times: Vec<f64> = frames[1..].iter().map(|frame| frame.seconds).collect();
    let least_s = times.iter().copied().fold(f64::INFINITY, f64::min);
    let most_s = times.iter().copied().fold(0.0, f64::max);
    let frame_s = median(times).unwrap_or(f64::NAN);
    Ok(Measured {
        trial: frames.swap_remove(0),
        preparation_s: (all_s - frame_s).max(0.0),
        frame_s: [least_s, frame_s, most_s],
        bytes_per_node: workshop.bytes_per_node(&scene.shadows),
        horizon_rms_deg: scene.shadows.maps().and_then(horizon_rms_deg),
    })
}

/// What tiles have measured of their own error: of the one with the largest.
fn horizon_rms_deg(maps: &[Vec<HorizonMap>]) -> Option<f64> {
    let rms = |map: &HorizonMap| map.errors.decoded.rms_rad.to_degrees();
    maps.iter().flatten().map(rms).max_by(f64::total_cmp)
}

impl Truth {
    fn compared(&self, view: &View, trial: &Trial) -> super::Comparison {
        let full_w_m2 = view.lights[0].irradiance_w_m2;
        compare(&self.trial.samples.pixels, &trial.samples.pixels, &self.ground, full_w_m2)
    }

    fn row(&self, scenario: &Scenario, view: &View, elevation_deg: f64, measured: &Measured) -> Vec<Value> {
        let found = self.compared(view, &measured.trial);
        let (columns, rows) = (scenario.camera.columns as usize, scenario.camera.rows as usize);
        let grid = |trial: &Trial, value: &dyn Fn(&crate::render::planes::Radiometry) -> f64| {
            let pixels = trial.samples.pixels.iter().zip(&self.ground);
            let values = pixels.map(|(pixel, ground)| if *ground { value(pixel) } else { f64::NAN }).collect();
            Grid::new(columns, rows, values)
        };
        let shown = |trial: &Trial| {
            grid(trial, &|pixel| (f64::from(pixel.radiance_w_m2_sr) / self.white).clamp(0.0, 1.0).powf(1.0 / 2.2))
        };
        let fraction = |trial: &Trial| grid(trial, &|pixel| f64::from(pixel.sun_fraction));
        let displaced_m = self.towards_sun.and_then(|towards| {
            let [tried, truth] = [fraction(&measured.trial), fraction(&self.trial)];
            let found = edges::displacement(&tried, &truth, 0.5, towards, self.pixel_m);
            (!found.displacements_px.is_empty()).then(|| {
                let squares = found.displacements_px.iter().map(|offset| offset * offset).sum::<f64>();
                (squares / found.displacements_px.len() as f64).sqrt() * self.pixel_m
            })
        });
        let [tried, truth] = [shown(&measured.trial), shown(&self.trial)];
        let [least_s, frame_s, most_s] = measured.frame_s;
        vec![
            elevation_deg.into(),
            measured.trial.method.as_str().into(),
            measured.preparation_s.into(),
            measured.bytes_per_node.into(),
            frame_s.into(),
            least_s.into(),
            most_s.into(),
            (100.0 * found.agreement).into(),
            found.irradiance.rms.into(),
            found.irradiance.p99.into(),
            found.penumbra.rms.into(),
            measured.horizon_rms_deg.into(),
            ssim::mean(&truth, &tried, 1.0).into(),
            flip::mean(&truth, &tried).into(),
            displaced_m.into(),
        ]
    }
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
