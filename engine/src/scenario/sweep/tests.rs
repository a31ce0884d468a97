use std::path::{Path, PathBuf};

use super::*;
use crate::geometry::Body;
use crate::scenario::{SearchPath, resolve};

const RANGE: Axis = Axis::Range { from: 0.0, to: 1.0 };

/// The points of nine axes from 0 to 1.
fn laid(design: Design) -> Vec<Vec<f64>> {
    use Varied::*;
    let all = [EpochS, SunAzimuthDeg, SunElevationDeg, NorthM, EastM, HeightFactor, RollDeg, Albedo, EpochS];
    let axes: Vec<(Varied, &Axis)> = all.iter().map(|varied| (*varied, &RANGE)).collect();
    let points = points(design, &axes, count(design, &axes));
    points.into_iter().map(|Point(values)| values.into_iter().map(|(_, value)| value).collect()).collect()
}

/// `scipy.stats.qmc.Sobol(9, scramble=False).random(16)` of SciPy 1.16, points 5 and 11 in 32nds, 13 in 64ths.
#[test]
fn sobols_sequence_is_scipys() {
    let points = laid(Design::Sobol { count: 16, seed: 0 });
    for (index, unit, expected) in [
        (5, 32.0, [28, 28, 4, 12, 28, 20, 28, 12, 12]),
        (11, 32.0, [14, 18, 6, 22, 26, 2, 22, 22, 22]),
        (13, 64.0, [52, 44, 52, 4, 28, 60, 36, 36, 36]),
    ] {
        assert_eq!(points[index], expected.map(|part| f64::from(part) / unit), "point {index}");
    }
}

/// What makes each a design: every stratum of every axis is met once; a Sobol sequence of 2ᵏ points shifted by bits does so too.
#[test]
fn every_stratum_is_met_once() {
    for design in [
        Design::LatinHypercube { count: 64, seed: 3 },
        Design::Sobol { count: 64, seed: 3 },
        Design::Sobol { count: 64, seed: 0 },
    ] {
        let points = laid(design);
        for axis in 0..9 {
            let mut strata: Vec<usize> = points.iter().map(|point| (point[axis] * 64.0) as usize).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..64).collect::<Vec<_>>(), "{design:?}, axis {axis}");
        }
    }
    let uniform = laid(Design::Uniform { count: 64, seed: 3 });
    let mut strata: Vec<usize> = uniform.iter().map(|point| (point[0] * 64.0) as usize).collect();
    strata.dedup();
    strata.sort_unstable();
    strata.dedup();
    // Of 64 independent draws (1 − 1/64)⁶⁴ = 37 % of the strata stay empty.
    assert!((30..52).contains(&strata.len()), "{}", strata.len());
}

#[test]
fn a_seed_repeats_and_another_differs() {
    for design in [
        |seed| Design::Uniform { count: 5, seed },
        |seed| Design::LatinHypercube { count: 5, seed },
        |seed| Design::Sobol { count: 5, seed },
    ] {
        assert_eq!(laid(design(1)), laid(design(1)));
        assert_ne!(laid(design(1)), laid(design(2)));
    }
}

#[test]
fn a_grid_has_all_combinations_the_last_axis_fastest() {
    let (a, b) = (Axis::Values(vec![7.0, -1.0]), Axis::Steps { from: 0.0, to: 1.0, count: 3 });
    let axes = [(Varied::NorthM, &a), (Varied::EastM, &b)];
    let points = points(Design::Grid, &axes, count(Design::Grid, &axes));
    let values: Vec<[f64; 2]> = points.iter().map(|Point(values)| [values[0].1, values[1].1]).collect();
    assert_eq!(values, [[7.0, 0.0], [7.0, 0.5], [7.0, 1.0], [-1.0, 0.0], [-1.0, 0.5], [-1.0, 1.0]]);
}

/// A path over the pole, with a Sun held still, swept as `sweep` says.
fn scenario(sweep: &str) -> Scenario {
    let text = format!(
        r#"(
    title: "a test",
    terrain: (dems: [Synthetic(columns: 64, rows: 64, posting_m: 100, latitude_deg: -90, longitude_deg: 0, seed: 1)]),
    sun: (fixed: (azimuth_deg: 10, elevation_deg: 5)),
    trajectory: Waypoints(points: [
        (t_s: 0, latitude_deg: -89, longitude_deg: 0, height_m: 2000),
        (t_s: 60, latitude_deg: -89, longitude_deg: 180, height_m: 1000),
    ]),
    pointing: (towards: At(latitude_deg: -90, longitude_deg: 0)),
    camera: (columns: 64, rows: 48, field_of_view_deg: 40),
    exposures: Series(start: "2026-08-01T00:00:00 UTC", step_s: 20, count: 4),
    sweep: ({sweep}),
)"#
    );
    let places = SearchPath { beside: PathBuf::new(), data: Vec::new() };
    resolve(Path::new("a.ron"), &text, &places, &|_| None).unwrap_or_else(|error| panic!("{error}"))
}

fn waypoints(scenario: &Scenario) -> Vec<Geodetic> {
    let Trajectory::Waypoints { points, .. } = &scenario.trajectory else { panic!() };
    points.iter().map(|waypoint| waypoint.point).collect()
}

#[test]
fn a_point_changes_what_it_names_and_nothing_else() {
    let swept = scenario(
        "design: Grid, sun_elevation_deg: Values([1, 2]), albedo: Values([0.1, 0.3]), height_factor: Values([0.5])",
    );
    assert_eq!((swept.points(), swept.images()), (4, 16));
    let last = swept.at_point(3);
    let sun = last.sun.fixed.unwrap();
    assert_eq!((sun.elevation_rad, sun.azimuth_rad), (2_f64.to_radians(), 10_f64.to_radians()));
    assert_eq!(last.albedo, Albedo::Constant(0.3));
    assert_eq!(waypoints(&last).iter().map(|point| point.height_m).collect::<Vec<_>>(), [1000.0, 500.0]);
    assert_eq!((last.points(), &last.exposures), (1, &swept.exposures));
}

/// 10 km of the Moon's circumference: the pole that is looked at moves along the meridian that is north there (longitude 0 on
/// the local axes of the south pole), the path keeps its shape.
#[test]
fn carrying_a_path_over_the_ground_moves_all_of_it_rigidly() {
    let swept = scenario("design: Grid, north_m: Values([0, 10000]), east_m: Values([0, 5000])");
    let body = Body::moon();
    let angle = |a: Geodetic, b: Geodetic| body.up(a).angle_to(body.up(b));
    let [still, moved] = [swept.at_point(0), swept.at_point(3)];
    assert_eq!(still.trajectory, swept.trajectory);
    let [before, after] = [&still, &moved].map(waypoints);
    let target = |scenario: &Scenario| match scenario.pointing.towards {
        Towards::At { point, .. } => point,
        _ => panic!(),
    };
    let expected_rad = 10_000_f64.hypot(5_000.0) / 1_737_400.0;
    assert!((angle(target(&still), target(&moved)) - expected_rad).abs() < 1e-12);
    assert!((angle(after[0], after[1]) - angle(before[0], before[1])).abs() < 1e-12);
    assert!((angle(after[0], target(&moved)) - angle(before[0], target(&still))).abs() < 1e-12);
    // As seen from where it was, it has gone 10 km north and 5 km east.
    let local = body.local_from_body(target(&still)) * body.up(target(&moved));
    let way = local.unit() / expected_rad.sin() * expected_rad * 1_737_400.0;
    assert!((way.x - 5_000.0).abs() < 1e-3 && (way.y - 10_000.0).abs() < 1e-3, "{way}");
    assert!(after.iter().zip(&before).all(|(a, b)| a.height_m == b.height_m));
}
