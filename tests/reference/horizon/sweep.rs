//! The sweep against the trace.

use std::time::Instant;

use glam::DVec2;
use perilune_engine::horizon::axis::Major;
use perilune_engine::horizon::sweep::Sweep;
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::horizon::{ErrorStatistics, Settings};
use perilune_engine::terrain::Face;

use super::scene::{Random, cratered, face, level, lunar_map};

/// Errors of the sweep at random pixels in all azimuths, and samples per second on one core.
pub fn errors(face: &Face, level: usize, settings: &Settings, pixels: usize) -> (ErrorStatistics, f64) {
    let tracer = Tracer::without_finer(face, level, settings);
    let (mut errors_rad, mut seconds, mut samples) = (Vec::new(), 0.0, 0);
    for major in [Major::Row, Major::Column] {
        let sweep = Sweep::new(face, level, major, settings);
        let r = &sweep.receivers;
        let mut random = Random(7);
        let mut node = |nodes: usize| (random.next() * nodes as f64) as usize;
        let sample: Vec<_> = (0..pixels).map(|_| (node(r.majors), node(r.minors))).collect();
        for direction in (0..settings.azimuths).map(|i| settings.direction(i)).filter(|d| Major::of(*d) == major) {
            let start = Instant::now();
            let plane = sweep.elevations_rad(direction);
            seconds += start.elapsed().as_secs_f64();
            samples += r.majors * r.minors;
            for &(u, v) in &sample {
                let traced_rad = tracer.skyline(sweep.foot(u, v), direction).elevation_rad;
                errors_rad.push(f64::from(plane[u * r.stride + v]) - traced_rad);
            }
        }
    }
    (ErrorStatistics::of(errors_rad), samples as f64 / seconds)
}

fn number(name: &str, default: usize) -> usize {
    std::env::var(name).ok().and_then(|value| value.parse().ok()).unwrap_or(default)
}

fn report(name: &str, (e, speed): (ErrorStatistics, f64)) -> ErrorStatistics {
    let [p50, p95, p99, max] = [e.p50_rad, e.p95_rad, e.p99_rad, e.max_rad].map(f64::to_degrees);
    println!("{name}: {:.1} M samples/s, p50 {p50:.5} p95 {p95:.5} p99 {p99:.5} max {max:.4} deg", speed / 1e6);
    e
}

/// `NODES` and `AZIMUTHS` make it a benchmark.
#[test]
fn the_sweep_meets_the_trace_on_cratered_terrain() {
    let settings = Settings { azimuths: number("AZIMUTHS", 24), ..Settings::default() };
    let e = report("cratered", errors(&cratered(number("NODES", 512), 20.0, 1), 0, &settings, 512));
    assert!(e.p95_rad.to_degrees() < 0.01 && e.p99_rad.to_degrees() < 0.03, "{e:?}");
}

/// A swept far field and a traced near one are the traced skyline.
#[test]
fn what_is_far_is_swept_as_it_is_traced() {
    let face = cratered(384, 20.0, 1);
    for near in [8, 16] {
        let settings = Settings { near, ..Settings::default() };
        let (tracer, whole) = (Tracer::new(&face, &settings).only_near(), Tracer::new(&face, &Settings::default()));
        let mut random = Random(7);
        let mut errors_rad = Vec::new();
        for azimuth in (0..360).step_by(15) {
            let direction = settings.direction(azimuth);
            let sweep = Sweep::new(&face, 0, Major::of(direction), &settings);
            let (r, plane) = (&sweep.receivers, sweep.elevations_rad(direction));
            for _ in 0..256 {
                let [u, v] = [r.majors, r.minors].map(|nodes| (random.next() * nodes as f64) as usize);
                let foot = sweep.foot(u, v);
                let [near_rad, expected] = [tracer, whole].map(|t| t.skyline(foot, direction).elevation_rad);
                errors_rad.push(f64::from(plane[u * r.stride + v]).max(near_rad) - expected);
            }
        }
        let e = report(&format!("beyond {near}"), (ErrorStatistics::of(errors_rad), 0.0));
        assert!(e.p95_rad.to_degrees() < 0.01 && e.p99_rad.to_degrees() < 0.05, "{near}: {e:?}");
    }
}

/// Near and far terrain make the whole skyline, wherever an observer stands and whatever lies around him.
#[test]
fn what_is_near_and_what_is_far_make_the_whole_skyline() {
    let whole = cratered(200, 20.0, 3);
    let ground = |at: DVec2| 300.0 * (at.x / 900.0).sin() * (at.y / 700.0).cos();
    let map = lunar_map();
    let (fine, coarse) = (level(&map, 61, 20.0, DVec2::ZERO, ground), level(&map, 101, 60.0, DVec2::ZERO, ground));
    let nested = face(map, vec![fine, coarse]);
    let mut random = Random(11);
    for face in [&whole, &nested] {
        let reach_m = 0.45 * (face.levels[0].columns as f64) * 20.0;
        for index in 0..2000 {
            let at_m = reach_m * DVec2::new(2.0 * random.next() - 1.0, 2.0 * random.next() - 1.0);
            let direction = Settings::default().direction((index * 7) % 360);
            let settings = Settings { near: 1 + index % 16, ..Settings::default() };
            let far = Tracer::new(face, &settings);
            let foot = far.foot(at_m).unwrap();
            let near = far.only_near();
            let [far, near] = [far, near].map(|tracer| tracer.skyline(foot, direction).elevation_rad);
            let expected = Tracer::new(face, &Settings::default()).skyline(foot, direction).elevation_rad;
            assert!((far.max(near) - expected).abs() < 1e-9, "{index}: {near} {far} {expected}");
            assert!(far <= expected && near <= expected);
        }
    }
}

#[test]
fn a_raised_observer_is_swept_as_well_as_traced() {
    let settings = Settings { azimuths: 24, observer_height_m: 10.0, ..Settings::default() };
    let e = report("10 m mast", errors(&cratered(384, 20.0, 2), 0, &settings, 256));
    assert!(e.p95_rad.to_degrees() < 0.01 && e.p99_rad.to_degrees() < 0.03, "{e:?}");
}

#[test]
fn a_search_distance_hides_the_same_terrain_from_both() {
    for search_m in [400.0, 1500.0] {
        let settings = Settings { azimuths: 16, search_m: Some(search_m), ..Settings::default() };
        let e = report("search", errors(&cratered(256, 20.0, 2), 0, &settings, 128));
        assert!(e.p95_rad.to_degrees() < 0.01 && e.p99_rad.to_degrees() < 0.03, "{e:?}");
    }
}

/// A fine level inside a coarse one sampled from the same ground: the sweep of the fine one sees the coarse one.
#[test]
fn nested_levels_are_swept_as_they_are_traced() {
    let map = lunar_map();
    let ground = |at: DVec2| {
        700.0 * (at.x / 2300.0).sin() * (at.y / 1900.0).cos() + 60.0 * (at.x / 310.0 + at.y / 450.0).sin() + at.y / 30.0
    };
    let coarse = level(&map, 401, 120.0, DVec2::ZERO, ground);
    let mut fine = level(&map, 241, 20.0, DVec2::new(1200.0, -2400.0), ground);
    for i in 0..fine.heights_m.len() {
        // On the fine level's edge the coarse one is the surface, so that they meet.
        let (column, row) = (i % 241, i / 241);
        if column == 0 || row == 0 || column == 240 || row == 240 {
            let at_m = fine.node_m(column, row);
            fine.heights_m[i] = coarse.bilinear_m(coarse.grid_from_map(at_m)).unwrap() as f32;
        }
    }
    let settings = Settings { azimuths: 36, ..Settings::default() };
    for margin in [0, 12] {
        fine.margin = margin;
        let nested = face(map.clone(), vec![fine.clone(), coarse.clone()]);
        let e = report("nested", errors(&nested, 0, &settings, 256));
        assert!(e.p95_rad.to_degrees() < 0.01 && e.p99_rad.to_degrees() < 0.03, "{e:?}");
    }
    // And the traced horizon is that of one fine level over all the ground.
    let nested = face(map.clone(), vec![fine.clone(), coarse]);
    let whole = face(map.clone(), vec![level(&map, 2401, 20.0, DVec2::ZERO, ground)]);
    let (tracer, reference) = (Tracer::new(&nested, &settings), Tracer::new(&whole, &settings));
    for azimuth in 0..36 {
        let direction = settings.direction(azimuth);
        let at_m = DVec2::new(1200.0, -2400.0);
        let [a, b] = [tracer, reference].map(|t| t.skyline(t.foot(at_m).unwrap(), direction).elevation_rad);
        // Coarse chords cut ridges by h'' p²/8 = 0.9 m, 2.4 km and more away.
        assert!((a - b).abs() < 1.2 / 2400.0, "{azimuth}: {a} {b}");
    }
}

#[test]
fn a_margin_casts_shadows_but_has_no_horizons() {
    let whole = cratered(200, 20.0, 5);
    let mut inner = whole.clone();
    inner.levels[0].margin = 40;
    let settings = Settings::default();
    for azimuth in [0, 33, 45, 117, 290] {
        let direction = settings.direction(azimuth);
        let a = super::scene::swept(&whole, 0, &settings, direction);
        let b = super::scene::swept(&inner, 0, &settings, direction);
        assert_eq!((b.len(), b[0].len()), (120, 120));
        for row in 0..120 {
            for column in 0..120 {
                // Lines lie elsewhere by up to half their spacing.
                assert!((a[row + 40][column + 40] - b[row][column]).abs() < 1e-2, "{azimuth}");
            }
        }
    }
}

/// On a diagonal every line runs through nodes and rounding decides beside which one: no receiver may be left out.
#[test]
fn no_receiver_falls_between_lines() {
    let map = lunar_map();
    let wall = |at: DVec2| if at.length() > 8000.0 { 1500.0 } else { 0.0 };
    let face = face(map.clone(), vec![level(&map, 901, 20.0, DVec2::ZERO, wall)]);
    let settings = Settings { azimuths: 72, ..Settings::default() };
    for azimuth in 0..72 {
        let plane = super::scene::swept(&face, 0, &settings, settings.direction(azimuth));
        // The wall is 3 to 13 km away from everyone within 5 km of the centre.
        for row in (270..630).step_by(3) {
            for elevation_rad in &plane[row][270..630] {
                assert!(*elevation_rad > 0.1, "{azimuth} {row}: {elevation_rad}");
            }
        }
    }
}
