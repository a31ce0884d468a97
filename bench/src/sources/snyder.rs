//! Snyder & Nowrouzezahrai (2008): level step, level offset, swath and convergence (figures 3, 4, 6, 10), speed (table 1).
//!
//! Around a cone of height `H` and base radius `a`, at distance `d` from its axis, the skyline is
//!
//! ```text
//! tan h = (H/d) sin(t − |θ|)/sin t      |θ| ≤ t = asin(a/d)
//! ```
//!
//! The sharpness of a shadow is the angle about the cone's axis over which the shading rises from 10 to 90 % of what
//! it is in the open. The paper prints pictures, and numbers for table 1 only.
//!
//! # References
//! Snyder & Nowrouzezahrai (2008), Fast soft self-shadowing on dynamic height fields, Computer Graphics Forum 27(4).

use std::time::Instant;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::Options;
use crate::scenes::Scene;
use crate::stability::scenes::{Grid, flat_body, sun};
use crate::{Error, Table, Value};
use perilune_engine::gpu::Gpu;
use perilune_engine::horizon::Settings;
use perilune_engine::horizon::settings::direction;
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::pipeline::Progress;
use perilune_engine::render::{Light, RenderError};
use perilune_engine::shadow::multiscale::Multiscale;
use perilune_engine::shadow::multiscale::device::OnDevice;
use perilune_engine::shadow::sky::{Harmonics, Wedges};
use perilune_engine::shadow::skylines::Skyline;
use perilune_engine::shadow::{FieldMaker, QuantizedLight, SurfacePoints};
use perilune_engine::statistics::Errors;
use perilune_engine::terrain::{Level, Terrain};

/// A cone of 45° in the middle of 128² nodes of 1 m.
const HEIGHT_M: f64 = 20.0;
const BASE_M: f64 = 20.0;
/// Nodes a side, number of scales at k = 4, and frames per second of key light alone and with the environment.
const PRINTED: [(usize, f64, f64, f64); 3] =
    [(256, 33.0, 165.0, 57.2), (512, 37.0, 34.5, 11.5), (1024, 41.0, 7.05, 2.48)];
/// Level step and offset of figure 10, with the number of scales printed there.
const CONVERGING: [(u32, f64); 4] = [(1, 10.0), (2, 19.0), (4, 37.0), (8, 73.0)];
/// Azimuths of a key light and of an environment.
const AZIMUTHS: [usize; 2] = [3, 16];
/// Azimuths over a swath, and the light's elevation.
const IN_SWATH: usize = 32;
const LIGHT_DEG: f64 = 30.0;

/// All figures and the table.
pub fn tables(options: &Options, gpu: Option<&Gpu>, progress: &dyn Progress) -> Result<Vec<Table>, Error> {
    progress.begin("Snyder, figures 3, 4, 6, 10 and table 1", 3, "parts");
    let cone =
        Grid::square(64.0, 1.0).terrain(&flat_body(), |at_m| (HEIGHT_M * (1.0 - at_m.length() / BASE_M)).max(0.0));
    let figures = vec![settings(&cone), swaths(&cone)];
    progress.at(1, 3);
    let converging = converging(options);
    progress.at(2, 3);
    let speed = speed(options, gpu)?;
    progress.at(3, 3);
    Ok(figures.into_iter().chain([converging, speed]).collect())
}

/// Figures 3 and 4: errors of the cone's skyline for level steps and offsets.
fn settings(cone: &Terrain) -> Table {
    let mut table = Table::new(
        "snyder_3_4",
        "Snyder 2008, figures 3 (k at o = 2) and 4 (o at k = 4): skyline of a cone against its closed form",
        &[("figure", ""), ("k", ""), ("o", ""), ("RMS", "deg"), ("max", "deg"), ("roughness", "deg")],
    );
    let steps = [1, 2, 3, 4].map(|k| ("3", k, 2.0));
    let offsets = [0.0, 1.0, 2.0, 3.0, 4.0].map(|o| ("4", 4, o));
    for (figure, k, o) in steps.into_iter().chain(offsets) {
        let [all, rough] = cone_errors(cone, &Multiscale::new(cone, k, o, 0.0));
        let mut row = vec![figure.into(), f64::from(k).into(), o.into()];
        row.extend([all.rms, all.max, rough.rms].map(|rad| Value::from(rad.to_degrees())));
        table.rows.push(row);
    }
    table
}

/// Errors around the cone, and what they differ by from one receiver to the next along a line: aliasing.
fn cone_errors(cone: &Terrain, method: &Multiscale) -> [Errors; 2] {
    let map = &cone.faces[0].map;
    let distances_m: Vec<f64> = (0..64).map(|i| 1.5 * BASE_M + 0.5 * f64::from(i)).collect();
    let line = |azimuth_deg: f64| -> Vec<f64> {
        let away = direction(azimuth_deg.to_radians());
        let error = |&distance_m: &f64| {
            let found_rad = method.elevations_rad(map, [0, 0], distance_m * away, [-away])[0];
            found_rad - (HEIGHT_M / distance_m).atan()
        };
        distances_m.iter().map(error).collect()
    };
    let lines: Vec<Vec<f64>> = (0..12).into_par_iter().map(|i| line(30.0 * f64::from(i) + 7.0)).collect();
    let jumps = lines.iter().flat_map(|line| line.windows(3).map(|three| three[0] - 2.0 * three[1] + three[2]));
    [Errors::of(lines.iter().flatten().copied()), Errors::of(jumps)]
}

/// Figure 6: how sharp the cone's shadow is in the sharpest light of 16 harmonics.
fn swaths(cone: &Terrain) -> Table {
    let mut table = Table::new(
        "snyder_6",
        "Snyder 2008, figure 6: shadow of the cone by swath, k = 4, o = 2, 32 azimuths",
        &[("swath", "deg"), ("rise from 10 to 90 %", "deg"), ("ratio to 90 deg", ""), ("darkest", "of the open")],
    );
    let method = Multiscale::new(cone, 4, 2.0, 0.0);
    let map = &cone.faces[0].map;
    let light = Harmonics::towards(towards(0.0, LIGHT_DEG.to_radians()));
    let mut widest = f64::NAN;
    for swath_deg in [90.0f64, 45.0, 22.5, 11.25] {
        let step_rad = swath_deg.to_radians() / IN_SWATH as f64;
        let wedges = Wedges::new(step_rad);
        // The first azimuth is half a step inside: a swath's ends are wedges of half the width.
        let first_rad = -0.5 * swath_deg.to_radians() + 0.5 * step_rad;
        let azimuths = || (0..IN_SWATH).map(move |i| first_rad + i as f64 * step_rad);
        let open = wedges.swath(first_rad, &[0.0; IN_SWATH]).dot(&light);
        let shading = |turn_deg: f64| {
            let at_m = -1.8 * BASE_M * direction(turn_deg.to_radians());
            let elevations_rad = method.elevations_rad(map, [0, 0], at_m, azimuths().map(direction));
            wedges.swath(first_rad, &elevations_rad).dot(&light) / open
        };
        let shades: Vec<f64> = (0..=320).into_par_iter().map(|i| shading(0.25 * f64::from(i))).collect();
        let darkest = shades[0];
        let passes = |share: f64| {
            let level = darkest + share * (1.0 - darkest);
            0.25 * shades.iter().position(|shade| *shade >= level).unwrap_or(shades.len()) as f64
        };
        let rise_deg = passes(0.9) - passes(0.1);
        if widest.is_nan() {
            widest = rise_deg;
        }
        table.rows.push([swath_deg, rise_deg, rise_deg / widest, darkest].map(Value::from).to_vec());
    }
    table
}

/// A direction in the harmonics' axes: north, east, up.
fn towards(azimuth_rad: f64, elevation_rad: f64) -> DVec3 {
    let ((sin_a, cos_a), (sin_e, cos_e)) = (azimuth_rad.sin_cos(), elevation_rad.sin_cos());
    DVec3::new(cos_a * cos_e, sin_a * cos_e, sin_e)
}

/// Figure 10: skylines of hills converge to traced ones as step and offset grow together.
fn converging(options: &Options) -> Table {
    let mut table = Table::new(
        "snyder_10",
        "Snyder 2008, figure 10: convergence on hills, against traced skylines",
        &[
            ("k = o", ""),
            ("scales", ""),
            ("paper", ""),
            ("RMS", "deg"),
            ("p95", "deg"),
            ("ratio to k = 1", ""),
            ("time a skyline", "us"),
            ("pyramid", "MiB"),
        ],
    );
    let nodes = if options.quick { 256 } else { 512 };
    let scene = Scene::smooth(nodes, 3);
    let terrain = Terrain { body: scene.body.clone(), faces: vec![scene.face.clone()] };
    let (map, level) = (&scene.face.map, &scene.face.levels[0]);
    let tracer = Tracer::new(&scene.face, &Settings::default());
    let receivers: Vec<usize> = (0..nodes * nodes).step_by(if options.quick { 331 } else { 997 }).collect();
    let directions: Vec<DVec2> = (0..8).map(|i| direction(0.3 + 0.785 * f64::from(i))).collect();
    let foot = |index: usize| level.lifted_node(index % nodes, index / nodes);
    let traced = |index: usize| directions.iter().map(|d| tracer.skyline(foot(index), *d).elevation_rad).collect();
    let truth: Vec<Vec<f64>> = receivers.par_iter().map(|index| traced(*index)).collect();
    let mut coarsest = f64::NAN;
    for (k, paper) in CONVERGING {
        let method = Multiscale::new(&terrain, k, f64::from(k), 0.0);
        let start = Instant::now();
        let find = |index: &usize| method.elevations_rad(map, [0, 0], foot(*index).truncate(), directions.clone());
        let found: Vec<Vec<f64>> = receivers.par_iter().map(find).collect();
        let seconds = start.elapsed().as_secs_f64() / (receivers.len() * directions.len()) as f64;
        let errors = Errors::of(found.iter().flatten().zip(truth.iter().flatten()).map(|(found, truth)| found - truth));
        if coarsest.is_nan() {
            coarsest = errors.rms;
        }
        let mut row = vec![
            f64::from(k).into(),
            scales(level, k).into(),
            if options.quick { Value::Missing } else { paper.into() },
        ];
        let bytes = method.bytes() as f64 / 1048576.0;
        let degrees = [errors.rms, errors.p95].map(f64::to_degrees);
        row.extend([degrees[0], degrees[1], errors.rms / coarsest, 1e6 * seconds, bytes].map(Value::from));
        table.rows.push(row);
    }
    table
}

/// How many distances a skyline is looked for at: as far as the level's diagonal.
fn scales(level: &Level, level_step: u32) -> f64 {
    let reach = (level.columns as f64).hypot(level.rows as f64);
    (f64::from(level_step) * reach.log2()).floor() + 1.0
}

/// Table 1: time of all nodes for a key light and for that and an environment, from some of them; of all for a key light on the
/// device.
fn speed(options: &Options, gpu: Option<&Gpu>) -> Result<Table, Error> {
    let mut table = Table::new(
        "snyder_1",
        "Snyder 2008, table 1: k = 4, o = 2, on all cores of the host, and on the device (paper: Nvidia 8800 Ultra)",
        &[
            ("nodes", "a side"),
            ("scales", ""),
            ("paper's", ""),
            ("key", "Hz"),
            ("device's key", "Hz"),
            ("paper's key", "Hz"),
            ("key and environment", "Hz"),
            ("paper's both", "Hz"),
            ("key over both", ""),
            ("paper's ratio", ""),
        ],
    );
    let sizes = if options.quick { &PRINTED[..2] } else { &PRINTED[..] };
    for &(nodes, paper_scales, paper_key, paper_both) in sizes {
        let scene = Scene::fractal(nodes, 2)?;
        let terrain = Terrain { body: scene.body.clone(), faces: vec![scene.face.clone()] };
        let (map, level) = (&scene.face.map, &scene.face.levels[0]);
        let start = Instant::now();
        let method = Multiscale::new(&terrain, 4, 2.0, 0.0);
        let pyramid_s = start.elapsed().as_secs_f64();
        let wedges = Wedges::new(std::f64::consts::TAU / AZIMUTHS[1] as f64);
        let receivers: Vec<usize> = (0..nodes * nodes).step_by(nodes * nodes / 2000).collect();
        let timed_s = |azimuths: usize| {
            let start = Instant::now();
            let directions = || (0..azimuths).map(|i| direction(std::f64::consts::TAU * i as f64 / azimuths as f64));
            let light = |index: &usize| {
                let at_m = level.node_m(index % nodes, index / nodes);
                let elevations_rad = method.elevations_rad(map, [0, 0], at_m, directions());
                // A key light's three wedges cost no more than those of an environment's share.
                wedges.swath(0.0, &elevations_rad).dot(&Harmonics::clamped_cosine(DVec3::Z))
            };
            let sum: f64 = receivers.par_iter().map(light).sum();
            assert!(sum.is_finite(), "skylines are numbers");
            start.elapsed().as_secs_f64() * (nodes * nodes) as f64 / receivers.len() as f64
        };
        let [key_s, environment_s] = AZIMUTHS.map(timed_s);
        let device_s = gpu.map(|gpu| device_s(gpu, &terrain)).transpose()?.flatten();
        let device_hz = device_s.map_or(f64::NAN, |seconds| 1.0 / (seconds + pyramid_s));
        let [key_hz, both_hz] = [key_s + pyramid_s, key_s + environment_s + pyramid_s].map(|seconds| 1.0 / seconds);
        let cells = [
            nodes as f64,
            scales(level, 4),
            paper_scales,
            key_hz,
            device_hz,
            paper_key,
            both_hz,
            paper_both,
            key_hz / both_hz,
            paper_key / paper_both,
        ];
        table.rows.push(cells.map(Value::from).to_vec());
    }
    Ok(table)
}

/// Time of all nodes for a key light on a device that has the images; the pyramid is made on the host.
fn device_s(gpu: &Gpu, terrain: &Terrain) -> Result<Option<f64>, RenderError> {
    let face = &terrain.faces[0];
    let method = Multiscale::new(terrain, 4, 2.0, 2f64.to_radians());
    let Some(device) = OnDevice::new(gpu, &method, terrain)? else { return Ok(None) };
    let Light { position, angular_radius_rad, .. } = sun(&face.map, 0.6, LIGHT_DEG.to_radians());
    let light = QuantizedLight::new(position, angular_radius_rad);
    let fields = gpu.output("skylines", (SurfacePoints::of(&face.levels[0]).count() * size_of::<Skyline>()) as u64);
    // The driver compiles when it runs a shader for the first time.
    let mut seconds = f64::NAN;
    for _ in 0..2 {
        let start = Instant::now();
        device.field(gpu, &face.map, [0, 0], &light, &fields, 0);
        gpu.read::<Skyline>(&fields)?;
        seconds = start.elapsed().as_secs_f64();
    }
    Ok(Some(seconds))
}
