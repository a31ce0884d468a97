//! The exact search and its intervals against the trace.

use std::time::Instant;

use glam::DVec2;
use perilune::horizon::exact::{Exact, Interval};
use perilune::horizon::sweep::grid::Major;
use perilune::horizon::trace::Tracer;
use perilune::horizon::{ErrorStatistics, Settings};
use perilune::terrain::Face;

use super::scene::{Random, cratered, face, level, lunar_map};

/// What exact horizons of random pixels differ by from traced ones, in all azimuths.
pub struct Found {
    pub errors: ErrorStatistics,
    /// Samples whose traced elevation lies outside their interval, and the widest interval.
    pub outside: usize,
    pub widest_rad: f64,
    pub samples_per_s: f64,
}

pub fn compare(face: &Face, level: usize, settings: &Settings, pixels: usize) -> Found {
    compare_with(face, face, level, settings, pixels)
}

/// The exact search of one face against the trace of another one.
fn compare_with(face: &Face, traced: &Face, level: usize, settings: &Settings, pixels: usize) -> Found {
    let tracer = Tracer::without_finer(traced, level, settings);
    let (mut errors_rad, mut outside, mut widest_rad) = (Vec::new(), 0, 0.0_f64);
    let (mut seconds, mut samples) = (0.0, 0);
    for major in [Major::Row, Major::Column] {
        let exact = Exact::new(face, level, major, settings);
        let r = &exact.receivers;
        let mut random = Random(11);
        let mut node = |nodes: usize| (random.next() * nodes as f64) as usize;
        let sample: Vec<_> = (0..pixels).map(|_| (node(r.majors), node(r.minors))).collect();
        for direction in (0..settings.azimuths).map(|i| settings.direction(i)).filter(|d| Major::of(*d) == major) {
            let start = Instant::now();
            let plane = exact.elevations_rad(direction);
            seconds += start.elapsed().as_secs_f64();
            samples += r.majors * r.minors;
            let intervals = exact.intervals_rad(direction);
            for &(u, v) in &sample {
                let traced_rad = tracer.skyline(exact.foot(u, v), direction).elevation_rad;
                let Interval { low_rad, high_rad } = intervals[u * r.stride + v];
                outside += usize::from(!intervals[u * r.stride + v].contains(traced_rad));
                widest_rad = widest_rad.max(f64::from(high_rad) - f64::from(low_rad));
                errors_rad.push(f64::from(plane[u * r.stride + v]) - traced_rad);
            }
        }
    }
    Found { errors: ErrorStatistics::of(errors_rad), outside, widest_rad, samples_per_s: samples as f64 / seconds }
}

fn number(name: &str, default: usize) -> usize {
    std::env::var(name).ok().and_then(|value| value.parse().ok()).unwrap_or(default)
}

/// No traced elevation outside its interval, and none further off than `bound_rad`.
fn assert_exact(name: &str, found: &Found, bound_rad: f64) {
    let Found { errors, outside, widest_rad, samples_per_s } = found;
    let [p50, p95, max, widest] = [errors.p50_rad, errors.p95_rad, errors.max_rad, *widest_rad].map(f64::to_degrees);
    println!(
        "{name}: {:.1} M samples/s, p50 {p50:.6} p95 {p95:.6} max {max:.6} widest {widest:.6} deg, {outside} outside",
        samples_per_s / 1e6
    );
    assert_eq!(*outside, 0, "{name}");
    assert!(errors.max_rad < bound_rad, "{name}: {errors:?}");
}

/// Heights are exact, slopes round in their seventh digit.
const ROUNDING_RAD: f64 = 2e-6;

/// `NODES` and `AZIMUTHS` make it a benchmark.
#[test]
fn the_exact_search_meets_the_trace_on_cratered_terrain() {
    let settings = Settings { azimuths: number("AZIMUTHS", 24), ..Settings::default() };
    let found = compare(&cratered(number("NODES", 512), 20.0, 1), 0, &settings, 512);
    assert_exact("cratered", &found, ROUNDING_RAD);
}
