//! Scenes whose horizon is known in closed form, traced and swept.

use std::f64::consts::{PI, TAU};

use glam::DVec2;
use perilune_engine::horizon::Settings;
use perilune_engine::horizon::settings::direction;
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::terrain::Face;

use super::scene::{face, flat_map, level, lunar_map, swept};

/// Traced and swept elevations at the node (column, row) of a face's finest level.
fn both(face: &Face, column: usize, row: usize, azimuth_rad: f64, settings: &Settings) -> [f64; 2] {
    let towards = direction(azimuth_rad);
    let traced = Tracer::new(face, settings).skyline(face.levels[0].lifted_node(column, row), towards);
    [traced.elevation_rad, swept(face, 0, settings, towards)[row][column]]
}

/// 37 azimuths with the cardinal and diagonal ones, and 360° apart from 0°.
fn azimuths_rad() -> impl Iterator<Item = f64> {
    (0..=36).map(|i| TAU * f64::from(i) / 36.0).chain((1..4).map(|i| PI / 4.0 + PI / 2.0 * f64::from(i)))
}

#[test]
fn a_constant_slope_is_its_own_horizon_in_every_azimuth() {
    for (tilt, uphill_rad) in [(0.3_f64, 0.0_f64), (0.7, 1.1), (0.05, 4.0)] {
        let up = direction(uphill_rad);
        let map = flat_map();
        let face = face(map.clone(), vec![level(&map, 129, 10.0, DVec2::ZERO, |at| tilt * at.dot(up))]);
        for azimuth_rad in azimuths_rad() {
            let expected_rad = (tilt * (azimuth_rad - uphill_rad).cos()).atan();
            for got_rad in both(&face, 64, 64, azimuth_rad, &Settings::default()) {
                // Downhill the edge of the plane ends against a level datum that is lower still: the plane's own
                // slope or the datum, whichever is higher.
                if (azimuth_rad - uphill_rad).cos() >= -1e-9 {
                    // f32 heights of ± 400 m, 3e-5 m, over 10 m.
                    assert!((got_rad - expected_rad).abs() < 5e-6, "{azimuth_rad}: {got_rad} {expected_rad}");
                }
            }
        }
    }
}

#[test]
fn a_full_turn_is_no_turn() {
    assert_eq!(direction(0.0), DVec2::Y);
    let settings = Settings::default();
    assert_eq!(settings.direction(90), DVec2::X);
    assert_eq!(settings.direction(180), -DVec2::Y);
    assert_eq!(settings.direction(360), settings.direction(0));
    assert_eq!(settings.direction(270), -DVec2::X);
}

/// Dip −acos(R/(R + h)) of a bare sphere, once beyond a small map and once on a map that holds the tangent point.
#[test]
fn a_bare_sphere_dips_below_the_horizontal() {
    let map = lunar_map();
    for (nodes, posting_m, height_m) in [(65, 20.0, 2.0), (65, 20.0, 1000.0), (257, 50.0, 10.0), (257, 1000.0, 1000.0)]
    {
        let face = face(map.clone(), vec![level(&map, nodes, posting_m, DVec2::ZERO, |_| 0.0)]);
        let settings = Settings { observer_height_m: height_m, ..Settings::default() };
        let expected_rad = -(map.radius_m / (map.radius_m + height_m)).acos();
        let middle = nodes / 2;
        // A chord between crossings at most √2 postings apart lies p²/4R below the sphere; the sphere is left at
        // distance √(2Rh), and heights are f32.
        let tangent_m = (2.0 * map.radius_m * height_m).sqrt();
        let bound_rad = posting_m * posting_m / (4.0 * map.radius_m * tangent_m) + 1e-6;
        for azimuth_rad in azimuths_rad() {
            for got_rad in both(&face, middle, middle, azimuth_rad, &settings) {
                assert!(
                    (got_rad - expected_rad).abs() < bound_rad,
                    "{height_m} m: {got_rad} {expected_rad} ± {bound_rad}"
                );
            }
        }
    }
}

/// Step of height H on a sphere: seen from the tip of its shadow at sun elevation e (at the step), R ψ away with ψ = e − acos((1 +
/// H/R) cos e), its top stands at e − ψ above the local horizontal.
#[test]
fn a_step_is_grazed_by_the_sun_from_the_tip_of_its_shadow() {
    let map = lunar_map();
    let height_m = 1000.0;
    for (sun_deg, arc_m) in [(2.0_f64, 46_330.0), (3.0, 21_657.0), (5.0, 11_896.0), (10.0, 5_725.0)] {
        let sun_rad = sun_deg.to_radians();
        let psi_rad = sun_rad - ((1.0 + height_m / map.radius_m) * sun_rad.cos()).acos();
        assert!((map.radius_m * psi_rad - arc_m).abs() < 0.6, "the published arc, rounded to 1 m");
        // The step's edge lies on a node line, the observer at the centre.
        let distance_m = map.radius_m * psi_rad.tan();
        let posting_m = distance_m / 100.0;
        let edge_m = distance_m - 1e-6 * posting_m;
        let step = |at: DVec2| if at.y >= edge_m { height_m } else { 0.0 };
        let face = face(map.clone(), vec![level(&map, 241, posting_m, DVec2::ZERO, step)]);
        for got_rad in both(&face, 120, 120, 0.0, &Settings::default()) {
            // f32 heights: 6e-5 m over 5 km.
            assert!((got_rad - (sun_rad - psi_rad)).abs() < 1e-6, "{sun_deg}: {got_rad} {}", sun_rad - psi_rad);
        }
    }
}

/// tan ε = (H/d) cos(A − Aₙ), and level ground elsewhere.
#[test]
fn an_infinite_wall_falls_off_with_the_cosine() {
    let map = flat_map();
    let (height_m, distance_m) = (200.0, 1000.0);
    let wall = |at: DVec2| if at.x >= distance_m - 1e-6 { height_m } else { 0.0 };
    let face = face(map.clone(), vec![level(&map, 513, 20.0, DVec2::ZERO, wall)]);
    for azimuth_rad in azimuths_rad().filter(|azimuth_rad| (azimuth_rad - PI / 2.0).cos() > 0.4) {
        let expected_rad = (height_m / distance_m * (azimuth_rad - PI / 2.0).cos()).atan();
        for got_rad in both(&face, 256, 256, azimuth_rad, &Settings::default()) {
            assert!((got_rad - expected_rad).abs() < 1e-6, "{azimuth_rad}: {got_rad} {expected_rad}");
        }
    }
    for got_rad in both(&face, 256, 256, 3.0 * PI / 2.0, &Settings::default()) {
        assert!(got_rad.abs() < 1e-8);
    }
}

/// tan ε = (H/d) sin(t − |θ|)/sin t within t = asin(a/d) of a cone with base radius a.
#[test]
fn a_cone_has_the_skyline_of_its_tangent_planes() {
    let map = flat_map();
    let (height_m, base_m, distance_m) = (500.0, 1500.0, 3000.0);
    let posting_m = 20.0;
    let apex_m = DVec2::new(0.0, distance_m);
    let cone = |at: DVec2| (height_m * (1.0 - at.distance(apex_m) / base_m)).max(0.0);
    let face = face(map.clone(), vec![level(&map, 401, posting_m, DVec2::ZERO, cone)]);
    let opening_rad = (base_m / distance_m).asin();
    for i in -8..=8 {
        let theta_rad = opening_rad * f64::from(i) / 8.0;
        let tangent = height_m / distance_m * (opening_rad - theta_rad.abs()).sin() / opening_rad.sin();
        for got_rad in both(&face, 200, 200, theta_rad, &Settings::default()) {
            // The bilinear cone cuts its apex by a quarter of the slope times the posting, and its sides by the sagitta
            // of a circle of the local radius.
            let bound_rad = height_m / base_m * posting_m / distance_m;
            assert!((got_rad.tan() - tangent).abs() < bound_rad, "{theta_rad}: {} {tangent}", got_rad.tan());
        }
    }
}

/// From the bottom of a spherical bowl the rim stands at β/2 all around, sin β = a/Rc.
#[test]
fn a_bowl_has_a_level_horizon_seen_from_its_bottom() {
    let map = flat_map();
    let (rim_m, depth_m) = (1000.0, 400.0);
    let sphere_m = (rim_m * rim_m + depth_m * depth_m) / (2.0 * depth_m);
    let bowl = |at: DVec2| -> f64 {
        if at.length() >= rim_m { 0.0 } else { sphere_m - depth_m - (sphere_m * sphere_m - at.length_squared()).sqrt() }
    };
    let posting_m = 5.0;
    let face = face(map.clone(), vec![level(&map, 601, posting_m, DVec2::ZERO, bowl)]);
    let expected_rad = (rim_m / sphere_m).asin() / 2.0;
    for azimuth_rad in azimuths_rad() {
        for got_rad in both(&face, 300, 300, azimuth_rad, &Settings::default()) {
            // The rim lies within a cell: its kink is missed by up to its slope times half a posting, at 1 km.
            assert!((got_rad - expected_rad).abs() < 2.5e-3 * 0.8, "{azimuth_rad}: {got_rad} {expected_rad}");
        }
    }
}

/// z = A sin kx: a point with shadow-edge at sun e sees the crest at e along x.
#[test]
fn sinusoidal_ridges_end_each_others_shadows() {
    let map = flat_map();
    let (amplitude_m, wave_m) = (100.0, 2000.0);
    let posting_m = 4.0;
    let k = TAU / wave_m;
    let ridges = |at: DVec2| amplitude_m * (k * at.x).sin();
    let face = face(map.clone(), vec![level(&map, 1501, posting_m, DVec2::ZERO, ridges)]);
    let tracer_settings = Settings::default();
    let tracer = Tracer::new(&face, &tracer_settings);
    for (sun_deg, graze_m, end_m) in
        [(5.0_f64, 589.832, 1931.544), (10.0, 689.686, 1657.863), (15.0, 825.164, 1355.305)]
    {
        // The Sun stands towards −x; a shadow that leaves the crest at graze ends at end.
        let foot = tracer.foot(DVec2::new(end_m - 2000.0, 0.0)).unwrap();
        let skyline = tracer.skyline(foot, -DVec2::X);
        // Chords cut the crest by A k² p²/8, and lift the ground as much, over the distance.
        let bound_rad = 2.0 * amplitude_m * k * k * posting_m * posting_m / 8.0 / (end_m - graze_m);
        assert!((skyline.elevation_rad - sun_deg.to_radians()).abs() < bound_rad, "{skyline:?}");
        assert!((skyline.distance_m - (end_m - graze_m)).abs() < 20.0, "{skyline:?}");
    }
}

/// A near and a far peak whose order curvature decides: flat, the far one would stand higher.
#[test]
fn curvature_hides_a_far_peak_behind_a_near_one() {
    let map = lunar_map();
    let posting_m = 500.0;
    let (near_m, far_m) = (30_000.0, 100_000.0);
    let peaks = |at: DVec2| match at.y {
        y if (y - near_m).abs() < 1.0 => 600.0,
        y if (y - far_m).abs() < 1.0 => 4000.0,
        _ => 0.0,
    };
    let face = face(map.clone(), vec![level(&map, 501, posting_m, DVec2::ZERO, peaks)]);
    let elevation = |map_m: f64, height_m: f64| {
        let arc = (map_m / map.radius_m).atan();
        let radius_m = map.radius_m + height_m;
        ((radius_m * arc.cos() - map.radius_m) / (radius_m * arc.sin())).atan()
    };
    let (near_rad, far_rad) = (elevation(near_m, 600.0), elevation(far_m, 4000.0));
    assert!(4000.0 / far_m > 600.0 / near_m && near_rad > far_rad - 0.02);
    for got_rad in both(&face, 250, 250, 0.0, &Settings::default()) {
        assert!((got_rad - near_rad.max(far_rad)).abs() < 1e-6, "{got_rad} {near_rad} {far_rad}");
    }
}

#[test]
fn a_hole_in_the_data_is_neither_a_cliff_nor_a_pit() {
    let map = lunar_map();
    let hill = |at: DVec2| 300.0 * (-(at - DVec2::new(0.0, 3000.0)).length_squared() / 1e6).exp();
    let whole = face(map.clone(), vec![level(&map, 257, 40.0, DVec2::ZERO, hill)]);
    for fill_m in [-32_768.0, 20_000.0, f32::NAN] {
        let mut holed = whole.clone();
        for row in 100..110 {
            for column in 60..80 {
                let node = holed.levels[0].index(column, row);
                holed.levels[0].gap[node] = true;
                holed.levels[0].heights_m[node] = fill_m;
            }
        }
        // Observers from whom the hole lies neither in front of the hill nor is their own ground.
        for azimuth_rad in azimuths_rad() {
            let (a, b) = (
                both(&whole, 128, 128, azimuth_rad, &Settings::default()),
                both(&holed, 128, 128, azimuth_rad, &Settings::default()),
            );
            for (a, b) in a.iter().zip(b) {
                // Level ground seen past the hole: the sphere's own chords.
                assert!((a - b).abs() < 2e-5, "{azimuth_rad}: {a} {b}");
            }
        }
    }
}

/// Turning the ground by a quarter turns the skyline by a quarter, bit for bit in the trace's geometry.
#[test]
fn turning_the_terrain_turns_the_skyline() {
    let face = super::scene::cratered(129, 20.0, 3);
    let mut turned = face.clone();
    let (from, to) = (&face.levels[0], &mut turned.levels[0]);
    for row in 0..129 {
        for column in 0..129 {
            // (x, y) goes to (y, −x): clockwise by 90°.
            let node = to.index(row, 128 - column);
            to.heights_m[node] = from.heights_m[from.index(column, row)];
        }
    }
    for azimuth_rad in azimuths_rad() {
        let a = both(&face, 40, 70, azimuth_rad, &Settings::default());
        let b = both(&turned, 70, 88, azimuth_rad + PI / 2.0, &Settings::default());
        assert!((a[0] - b[0]).abs() < 1e-9, "traced: {} {}", a[0], b[0]);
        assert!((a[1] - b[1]).abs() < 2e-6, "swept: {} {}", a[1], b[1]);
    }
}

/// The same ground on a map turned by an odd angle has the same horizons in the turned azimuth.
#[test]
fn turning_the_map_leaves_the_horizon() {
    let map = lunar_map();
    let waves = |at: DVec2| 200.0 * (at.x / 900.0).sin() * (at.y / 700.0).cos() + 0.05 * at.x;
    // Nothing but the sphere where the square maps differ.
    let ground = |at: DVec2| waves(at) * (1.0 - at.length_squared() / 1900.0_f64.powi(2)).max(0.0).powi(2);
    let turn_rad = 0.4;
    let straight = face(map.clone(), vec![level(&map, 401, 10.0, DVec2::ZERO, ground)]);
    let turn = DVec2::from_angle(turn_rad);
    let turned = face(map.clone(), vec![level(&map, 401, 10.0, DVec2::ZERO, |at| ground(turn.rotate(at)))]);
    for azimuth_rad in azimuths_rad() {
        // A direction at map azimuth A lies at A + turn on the turned map.
        let a = both(&straight, 200, 200, azimuth_rad, &Settings::default());
        let b = both(&turned, 200, 200, azimuth_rad + turn_rad, &Settings::default());
        for (a, b) in a.iter().zip(b) {
            // Chords of the smooth ground: h'' p²/8 = 3 mm over some 100 m.
            assert!((a - b).abs() < 1e-4, "{azimuth_rad}: {a} {b}");
        }
    }
}

/// A box: tan ε is its height over the distance to its front face, and level ground passes beside it.
#[test]
fn a_box_stands_as_high_as_its_front_face_is_near() {
    let map = flat_map();
    let (height_m, front_m, half_m) = (50.0, 500.0, 100.0);
    let inside = |at: DVec2| at.x.abs() <= half_m + 1e-6 && (front_m - 1e-6..=front_m + 100.0).contains(&at.y);
    let ground = |at: DVec2| if inside(at) { height_m } else { 0.0 };
    let face = face(map.clone(), vec![level(&map, 129, 20.0, DVec2::ZERO, ground)]);
    for i in -12..=12 {
        let azimuth_rad = f64::from(i) * 0.025;
        let across_m = front_m * azimuth_rad.tan().abs();
        // Between the edge and the next node the box slopes down.
        if (half_m..half_m + 25.0).contains(&across_m) {
            continue;
        }
        let expected_rad = if across_m < half_m { (height_m / front_m * azimuth_rad.cos()).atan() } else { 0.0 };
        for got_rad in both(&face, 64, 64, azimuth_rad, &Settings::default()) {
            assert!((got_rad - expected_rad).abs() < 1e-6, "{azimuth_rad}: {got_rad} {expected_rad}");
        }
    }
}
