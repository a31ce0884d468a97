//! The exact search and its intervals against the trace.

use std::time::Instant;

use glam::DVec2;
use perilune_engine::horizon::axis::Major;
use perilune_engine::horizon::exact::{Exact, Interval};
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::horizon::{ErrorStatistics, Settings};
use perilune_engine::terrain::Face;

use super::scene::{Random, cratered, face, level, lunar_map, nested};

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
        let nodes = &face.levels[level];
        let known = |&(u, v): &(usize, usize)| {
            let (column, row) = if major == Major::Row { (v, u) } else { (u, v) };
            !nodes.gap[nodes.index(column + nodes.margin, row + nodes.margin)]
        };
        let sample: Vec<_> = (0..pixels).map(|_| (node(r.majors), node(r.minors))).filter(known).collect();
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
const ROUNDING_RAD: f64 = 3e-6;

/// `NODES` and `AZIMUTHS` make it a benchmark.
#[test]
fn the_exact_search_meets_the_trace_on_cratered_terrain() {
    let settings = Settings { azimuths: number("AZIMUTHS", 24), ..Settings::default() };
    let found = compare(&cratered(number("NODES", 320), 20.0, 1), 0, &settings, 512);
    assert_exact("cratered", &found, ROUNDING_RAD);
}

/// Every node at one of two heights by chance: nothing but cliffs, and saddles of the steepest twist.
#[test]
fn cliffs_are_exact() {
    let mut random = Random(5);
    let map = lunar_map();
    let mut cliffs = level(&map, 161, 10.0, DVec2::ZERO, |_| 0.0);
    cliffs.heights_m.iter_mut().for_each(|height_m| *height_m += if random.next() < 0.02 { 300.0 } else { 0.0 });
    let found = compare(&face(map, vec![cliffs]), 0, &Settings { azimuths: 64, ..Settings::default() }, 200);
    // Slopes of 30 round thirty times as coarsely as those of 1.
    assert_exact("cliffs", &found, 10.0 * ROUNDING_RAD);
}

#[test]
fn gaps_are_exact() {
    let mut random = Random(6);
    let mut holed = cratered(200, 20.0, 6);
    let level = &mut holed.levels[0];
    for _ in 0..300 {
        let (column, row) = ((random.next() * 195.0) as usize, (random.next() * 195.0) as usize);
        for i in 0..4 {
            let node = level.index(column + i % 2, row + i / 2);
            (level.gap[node], level.heights_m[node]) = (true, 4000.0);
        }
    }
    for observer_height_m in [0.0, 3.0] {
        let settings = Settings { azimuths: 48, observer_height_m, ..Settings::default() };
        assert_exact("gaps", &compare(&holed, 0, &settings, 200), 2.0 * ROUNDING_RAD);
    }
}

#[test]
fn masts_and_search_distances_are_exact() {
    let face = cratered(256, 20.0, 2);
    for (observer_height_m, search_m) in [(10.0, None), (0.5, Some(700.0)), (0.0, Some(1500.0)), (0.0, Some(15.0))] {
        let settings = Settings { azimuths: 24, observer_height_m, search_m, ..Settings::default() };
        // A mast's height is rounded to 6e-5 m, 20 m away.
        assert_exact("masts", &compare(&face, 0, &settings, 128), 4.0 * ROUNDING_RAD);
    }
}

/// Coarser levels around, beyond and beside the searched one, which has a margin.
#[test]
fn nested_levels_are_exact() {
    let face = nested([101, 121, 151]);
    for (level, search_m) in [(0, None), (1, None), (0, Some(9000.0))] {
        let settings = Settings { azimuths: 72, search_m, ..Settings::default() };
        assert_exact("nested", &compare(&face, level, &settings, 256), 2.0 * ROUNDING_RAD);
    }
}

/// What lies beside them is left out.
#[test]
fn nodes_searched_alone_have_the_same_skylines() {
    let face = nested([101, 121, 151]);
    let (settings, nodes) = (Settings::default(), [[0, 0], [17, 40], [40, 17], [70, 70]]);
    for azimuth in [0, 45, 100, 222] {
        let direction = settings.direction(azimuth);
        let major = Major::of(direction);
        let [all, alone] = [false, true].map(|only| {
            let exact = Exact::new(&face, 0, major, &settings);
            let exact = if only { exact.only(&nodes) } else { exact };
            let intervals = exact.intervals_rad(direction);
            nodes.map(|node| intervals[exact.receivers.index(major, node)])
        });
        for (all, alone) in all.into_iter().zip(alone) {
            // A neighbour's find is where the next one looks first: the last bit of a slope.
            assert!((all.low_rad - alone.low_rad).abs() < 5e-7 && alone.low_rad > -1.0, "{azimuth}: {all:?} {alone:?}");
        }
    }
}

/// Below the horizontal nothing but the sphere and its chords is in sight.
#[test]
fn a_bare_sphere_is_exact() {
    let map = lunar_map();
    for (posting_m, observer_height_m) in [(20.0, 2.0), (1000.0, 1000.0)] {
        let face = face(map.clone(), vec![level(&map, 129, posting_m, DVec2::ZERO, |_| 0.0)]);
        let settings = Settings { azimuths: 32, observer_height_m, ..Settings::default() };
        assert_exact("sphere", &compare(&face, 0, &settings, 128), 2.0 * ROUNDING_RAD);
    }
}

#[test]
fn the_connecting_ridge_within_the_cap_is_exact() {
    let Some(mut scene) = super::scene::connecting_ridge() else { return };
    // Receivers in the middle; the terrain around them stays.
    scene.face.levels[0].margin = number("MARGIN", 650);
    let settings = Settings { azimuths: number("AZIMUTHS", 6), ..Settings::default() };
    assert_exact("connecting ridge", &compare(&scene.face, 0, &settings, 512), 5.0 * ROUNDING_RAD);
}

/// The checker fails: a bound that misses a single node's last metre lets traced elevations escape.
#[test]
fn an_interval_of_other_ground_misses_the_trace() {
    let ground = cratered(128, 20.0, 4);
    let settings = Settings { azimuths: 72, ..Settings::default() };
    assert_eq!(compare(&ground, 0, &settings, 128).outside, 0);
    let mut raised = ground.clone();
    let top = (0..128 * 128).max_by(|a, b| ground.levels[0].heights_m[*a].total_cmp(&ground.levels[0].heights_m[*b]));
    raised.levels[0].heights_m[top.unwrap()] += 1.0;
    assert!(compare_with(&ground, &raised, 0, &settings, 128).outside > 0);
    // And so does one that is shifted by less than a hundredth of a degree.
    let mut lowered = ground.clone();
    lowered.levels[0].heights_m.iter_mut().for_each(|height_m| *height_m *= 1.001);
    assert!(compare_with(&ground, &lowered, 0, &settings, 128).outside > 100);
}

#[test]
fn exact_horizons_do_not_depend_on_the_tiling() {
    let whole = cratered(200, 20.0, 5);
    let mut inner = whole.clone();
    inner.levels[0].margin = 40;
    let settings = Settings::default();
    for azimuth in [0, 33, 45, 90, 117, 290] {
        let direction = settings.direction(azimuth);
        let major = Major::of(direction);
        let [a, b] = [&whole, &inner].map(|face| {
            let exact = Exact::new(face, 0, major, &settings);
            (exact.elevations_rad(direction), exact.receivers.stride)
        });
        for u in 0..120 {
            let rows = (&a.0[(u + 40) * a.1 + 40..][..120], &b.0[u * b.1..][..120]);
            // Bulges are looked into where a neighbour needs it: the last bit of a slope.
            let largest = rows.0.iter().zip(rows.1).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(largest < 5e-7, "{azimuth}: {largest}");
        }
    }
}
