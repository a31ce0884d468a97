//! The search on a graphics device against the trace.

use perilune_engine::horizon::axis::Major;
use perilune_engine::horizon::gpu::OnDevice;
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::horizon::{ErrorStatistics, Settings};
use perilune_engine::terrain::Face;

use super::scene::{Random, cratered, nested};
use crate::conformance::gpu;

/// Heights are rounded to 1e-4 m, which is 5e-6 rad over a posting of 20 m; places to 1e-5 of a cell: over cells of 300 m and
/// slopes of 1, 3 mm on a crest 100 m away.
const BOUND_RAD: f64 = 3e-5;

/// What the device's horizons of one face differ by from those traced over another one, at some pixels in all azimuths.
fn compare(seen: &Face, traced: &Face, level: usize, settings: &Settings) -> ErrorStatistics {
    let tracer = Tracer::without_finer(traced, level, settings);
    let mut errors_rad = Vec::new();
    for major in [Major::Row, Major::Column] {
        let device = OnDevice::new(gpu().unwrap(), seen, level, major, settings).unwrap();
        let r = &device.receivers;
        let nodes = &seen.levels[level];
        let mut random = Random(11);
        let mut node = |nodes: usize| (random.next() * nodes as f64) as usize;
        let sample: Vec<_> = (0..100).map(|_| (node(r.majors), node(r.minors))).collect();
        for direction in (0..settings.azimuths).map(|i| settings.direction(i)).filter(|d| Major::of(*d) == major) {
            let plane = device.elevations_rad(direction).unwrap();
            for &(u, v) in &sample {
                let (column, row) = if major == Major::Row { (v, u) } else { (u, v) };
                if !nodes.gap[nodes.index(column + nodes.margin, row + nodes.margin)] {
                    let foot = major.foot(&traced.levels[level], u, v);
                    let traced_rad = tracer.skyline(foot, direction).elevation_rad;
                    errors_rad.push(f64::from(plane[u * r.stride + v]) - traced_rad);
                }
            }
        }
    }
    ErrorStatistics::of(errors_rad)
}

fn assert_traced(name: &str, errors: &ErrorStatistics) {
    println!("{name}: p95 {:.6} max {:.6} deg", errors.p95_rad.to_degrees(), errors.max_rad.to_degrees());
    assert!(errors.max_rad < BOUND_RAD, "{name}: {errors:?}");
}

#[test]
fn the_device_meets_the_trace_on_cratered_terrain() {
    if gpu().is_none() {
        return;
    }
    let mut ground = cratered(160, 20.0, 2);
    for (column, row) in [(40, 60), (41, 60), (120, 33), (80, 150)] {
        let level = &mut ground.levels[0];
        let node = level.index(column, row);
        (level.gap[node], level.heights_m[node]) = (true, 4000.0);
    }
    for (observer_height_m, search_m) in [(0.0, None), (3.0, None), (0.0, Some(700.0))] {
        let settings = Settings { azimuths: 24, observer_height_m, search_m, ..Settings::default() };
        assert_traced("cratered", &compare(&ground, &ground, 0, &settings));
    }
}

#[test]
fn the_device_meets_the_trace_on_nested_levels() {
    if gpu().is_none() {
        return;
    }
    let nested = nested([61, 81, 101]);
    let settings = Settings { azimuths: 24, ..Settings::default() };
    for level in [0, 1] {
        assert_traced("nested", &compare(&nested, &nested, level, &settings));
    }
}

#[test]
fn a_device_on_other_ground_does_not_meet_the_trace() {
    if gpu().is_none() {
        return;
    }
    let settings = Settings { azimuths: 4, ..Settings::default() };
    let errors = compare(&cratered(64, 20.0, 2), &cratered(64, 20.0, 3), 0, &settings);
    assert!(errors.p95_rad > 100.0 * BOUND_RAD, "{errors:?}");
}
