//! Skylines below the horizontal, with jumps, and of needles.

use glam::DVec2;

use super::super::Case;
use super::super::scenes::{Grid, Row, flat_body, map, nadir, pinhole, scene, sun};
use super::{Passage, WEST_RAD, against_traced, moon, passage_case, shares};
use perilune_engine::geometry::Body;

pub fn cases() -> Vec<Case> {
    let small = Body { name: "small".into(), naif_id: 0, equatorial_radius_m: 2e4, polar_radius_m: 2e4 };
    vec![
        peak(9, "peak of 1 km on the Moon, Sun 1.5° below", moon(), [1000.0, 30.0], -1.5, [20.0, 2000.0]),
        peak(10, "peak of 4 km on a body of 20 km, Sun 20° below", small, [4000.0, 45.0], -20.0, [50.0, 5000.0]),
        ringing(),
        needles(),
    ]
}

/// A cone of some height and slope on a sphere, the Sun below the horizontal: its sunward flank is lit where the dip of
/// the horizon is deeper than the Sun,
///
/// ```text
/// acos(R/(R + h(x))) = −(e + atan(x/R))      x: map distance from the axis towards the Sun
/// ```
fn peak(
    number: u8,
    name: &'static str,
    body: Body,
    [height_m, slope_deg]: [f64; 2],
    elevation_deg: f64,
    [posting_m, half_m]: [f64; 2],
) -> Case {
    let (radius_m, slope) = (body.equatorial_radius_m, slope_deg.to_radians().tan());
    let elevation_rad = elevation_deg.to_radians();
    let flank_m = move |x_m: f64| (height_m - x_m * slope).max(0.0);
    let above = |x_m: f64| (radius_m / (radius_m + flank_m(x_m))).acos() + elevation_rad + (x_m / radius_m).atan();
    let [mut lit_m, mut dark_m] = [0.0, height_m / slope];
    for _ in 0..60 {
        let middle_m = (lit_m + dark_m) / 2.0;
        *(if above(middle_m) > 0.0 { &mut lit_m } else { &mut dark_m }) = middle_m;
    }
    let terrain = Grid::square(half_m, posting_m).terrain(&body, move |at: DVec2| flank_m(at.length()));
    let passage = Passage {
        row: Row { west_m: -height_m / slope, east_m: -0.05 * height_m },
        light: sun(&map(&body), WEST_RAD, elevation_rad),
        expected_m: vec![-lit_m],
    };
    passage_case(number, name, terrain, posting_m, half_m, vec![passage])
}

/// A box 0.2 rad high and 1 rad wide on a level horizon: no false shadow beside it, no light through it.
fn ringing() -> Case {
    const AZIMUTHS_DEG: [f64; 8] = [0.0, 15.0, -20.0, 40.0, -45.0, 60.0, 90.0, 180.0];
    let wall = |at: DVec2| {
        let inside = at.x.atan2(at.y).abs() < 0.5 && (800.0..900.0).contains(&at.length());
        if inside { 162.2 } else { 0.0 }
    };
    let terrain = Grid::square(1000.0, 20.0).terrain(&flat_body(), wall);
    let map = map(&flat_body());
    let view =
        |azimuth_deg: f64| nadir(&map, DVec2::ZERO, 20.0, sun(&map, azimuth_deg.to_radians(), 1.5f64.to_radians()));
    Case {
        number: 11,
        name: "ringing beside a box, Sun 1.5° high",
        error_of: "share of the disc",
        limit: 0.01,
        scene: scene(terrain),
        views: AZIMUTHS_DEG.map(|azimuth_deg| view(azimuth_deg).with_optics(pinhole(8, 8, 16.0))).into(),
        reach_m: 800.0,
        soft: false,
        error: shares(|view, _| Some(f64::from(AZIMUTHS_DEG[view].abs() > 28.6))),
    }
}

/// Needles one node wide and 80 m high every 200 m, against traced shadows.
fn needles() -> Case {
    let needle = |at: DVec2| {
        let to_next = at - 200.0 * (at / 200.0).round();
        if to_next.length() < 1.0 { 80.0 } else { 0.0 }
    };
    let map = map(&flat_body());
    let view = nadir(&map, DVec2::new(7.0, -3.0), 1000.0, sun(&map, 0.577, 10f64.to_radians()))
        .with_optics(pinhole(48, 48, 60.0));
    let mut scene = scene(Grid::square(600.0, 20.0).terrain(&flat_body(), needle));
    let error = against_traced(&mut scene, &view);
    Case {
        number: 19,
        name: "needles one node wide",
        error_of: "mean share of the disc against traced",
        limit: 0.02,
        scene,
        views: vec![view],
        reach_m: 454.0,
        soft: false,
        error,
    }
}
