//! Illumination against what can be counted without a horizon map.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use hifitime::{Epoch, Unit};
use perilune::geometry::{Body, Geodetic};
use perilune::horizon::trace::Tracer;
use perilune::horizon::{self, Encoding, Request, Settings};
use perilune::illumination::place::Summary;
use perilune::illumination::{Lit, Maps, Place, Seen, Track, maps};
use perilune::photometry::{LimbDarkening, SolarDisk};
use perilune::terrain::{Face, Gnomonic, Level};

const RADIUS_RAD: f64 = 0.00465;

/// A pole's Sun: it goes round 13 times while its elevation swings once between ± 1.5°. The Earth stays.
fn track() -> Track {
    const STEPS: usize = 2000;
    let seen = |azimuth_rad: f64, elevation_rad: f64| {
        let (sin, cos) = elevation_rad.sin_cos();
        // At the south pole up is -z.
        let towards = DVec3::new(cos * azimuth_rad.cos(), cos * azimuth_rad.sin(), -sin);
        Seen { towards, angular_radius_rad: RADIUS_RAD }
    };
    let sun = |i: usize| {
        let turn = TAU * i as f64 / STEPS as f64;
        seen(13.0 * turn, 1.5_f64.to_radians() * turn.sin())
    };
    let earth = seen(0.3, 4.0_f64.to_radians());
    let start = Epoch::from_gregorian_utc_at_midnight(2026, 1, 1);
    Track { start, step: 1.0 * Unit::Hour, sun: (0..STEPS).map(sun).collect(), earth: vec![earth; STEPS] }
}

/// A face about the south pole with heights above the sphere.
fn face(nodes: usize, posting_m: f64, height_m: impl Fn(DVec2) -> f64) -> Face {
    let map = Gnomonic::about(&Body::moon(), Geodetic::from_degrees(-90.0, 0.0, 0.0));
    let low_m = -((nodes - 1) as f64) * posting_m / 2.0;
    let mut level = Level {
        columns: nodes,
        rows: nodes,
        posting_m,
        west_m: low_m,
        south_m: low_m,
        heights_m: Vec::new(),
        gap: vec![false; nodes * nodes],
        margin: 0,
    };
    for index in 0..nodes * nodes {
        let at_m = level.node_m(index % nodes, index / nodes);
        level.heights_m.push(map.lifted_height_m(at_m, map.radius_m + height_m(at_m)) as f32);
    }
    Face { map, levels: vec![level] }
}

/// Waves 2 km and 7 km long.
fn rough(at_m: DVec2) -> f64 {
    let k = TAU / 2000.0;
    40.0 * (k * at_m.x).sin() * (0.9 * k * at_m.y).cos() + 120.0 * (0.29 * k * (at_m.x + 0.4 * at_m.y)).sin()
}

fn mapped(face: &Face, encoding: Encoding, lit: Lit) -> Maps {
    let folder = tempfile::tempdir().unwrap();
    let (body, settings) = (Body::moon(), Settings::default());
    let request = Request { body: &body, face, level: 0, settings, encoding };
    let horizons = horizon::build(&request, folder.path(), &|_, _| {}).unwrap();
    maps(face, 0, &horizons, &track(), &disk(), lit, &|_, _| {})
}

fn disk() -> SolarDisk {
    SolarDisk::new(LimbDarkening::Power { alpha: 0.5 }).unwrap()
}

#[test]
fn on_a_bare_sphere_a_node_is_lit_while_the_sun_is_up() {
    // At a posting of 50 m a node sees the ground fall away by 8e-4°, a sixth of what the Sun climbs in a step.
    let face = face(70, 50.0, |_| 0.0);
    let track = track();
    for (lit, least) in [(Lit::AnyLimb, -RADIUS_RAD), (Lit::Centre, 0.0)] {
        let maps = mapped(&face, Encoding::F16, lit);
        for (column, row) in [(0, 0), (35, 40), (69, 1)] {
            let up = face.map.map_from_body.inverse().turn(face.map.up(face.levels[0].node_m(column, row)).unit());
            let elevations_rad: Vec<f64> = track.sun.iter().map(|sun| up.dot(sun.towards).asin()).collect();
            // A step in which the Sun crosses the limit may count either way.
            let counted = elevations_rad.iter().filter(|elevation| **elevation > least).count() as f64;
            let share = f64::from(maps.lit_share[row * 70 + column]) * track.steps() as f64;
            assert!((share - counted).abs() <= 2.0, "{lit:?} at {column} {row}: {share} {counted}");
            let night = elevations_rad.split(|elevation| *elevation > least).map(<[f64]>::len).max().unwrap();
            let longest = f64::from(maps.longest_night_h[row * 70 + column]);
            assert!((longest - night as f64).abs() <= 2.0, "{longest} {night}");
            let seen: f64 = elevations_rad.iter().map(|e| disk().visible_above(-e / RADIUS_RAD)).sum();
            let disc = f64::from(maps.disc_share[row * 70 + column]) * track.steps() as f64;
            // A thousandth of the disc a step.
            assert!((disc - seen).abs() < 1e-3 * track.steps() as f64, "{disc} {seen}");
            assert_eq!(maps.earth_share[row * 70 + column], 1.0);
        }
    }
}

#[test]
fn maps_agree_with_places_that_are_traced() {
    let face = face(160, 100.0, rough);
    let maps = mapped(&face, Encoding::F16, Lit::AnyLimb);
    let (track, settings) = (track(), Settings::default());
    let tracer = Tracer::new(&face, &settings);
    let mut differences = Vec::new();
    for (column, row) in (0..40).map(|i| (3 + 31 * i % 150, 7 + 47 * i % 150)) {
        let at_m = face.levels[0].node_m(column, row);
        let up = face.map.map_from_body.inverse().turn(face.map.up(at_m).unit());
        let at = Geodetic { latitude_rad: up.z.asin(), longitude_east_rad: up.y.atan2(up.x), height_m: 0.0 };
        let place = Place::new(&Body::moon(), &face.map, &tracer, at).unwrap();
        let summary = Summary::of(&place.moments(&track, &disk(), Lit::AnyLimb), 1.0);
        let index = row * 160 + column;
        differences.push((f64::from(maps.disc_share[index]) - summary.disc_share).abs());
        assert!((f64::from(maps.earth_share[index]) - summary.earth_share).abs() < 0.5, "{summary:?}");
    }
    differences.sort_by(f64::total_cmp);
    // 16 coefficients leave an RMS of 0.1°, a fifteenth of the Sun's swing, of either sign over the azimuths.
    assert!(differences[20] < 0.01 && differences[39] < 0.06, "{differences:?}");
    // The same terrain without its relief is another place altogether.
    let flat = Summary::of(
        &Place::new(
            &Body::moon(),
            &face.map,
            &Tracer::new(&self::face(160, 100.0, |_| 0.0), &settings),
            Geodetic::from_degrees(-89.9, 10.0, 0.0),
        )
        .unwrap()
        .moments(&track, &disk(), Lit::AnyLimb),
        1.0,
    );
    assert!(maps.disc_share.iter().any(|share| (f64::from(*share) - flat.disc_share).abs() > 0.1));
}

#[test]
fn gaps_have_no_illumination() {
    let mut face = face(40, 100.0, rough);
    face.levels[0].gap[41] = true;
    let maps = mapped(&face, Encoding::Fm16, Lit::Share(0.5));
    for plane in [&maps.lit_share, &maps.disc_share, &maps.longest_night_h, &maps.earth_share] {
        assert!(plane[41].is_nan() && plane.iter().filter(|value| value.is_nan()).count() == 1);
    }
}
