//! Metres at the radius of a planet, and its curvature.

use super::super::Case;
use glam::DVec2;

use super::super::scenes::{Grid, Row, SOLAR_RADIUS_RAD, map, nadir, pinhole, scene, sun};
use super::{Passage, WEST_RAD, moon, passage_case, shares, step};

pub fn cases() -> Vec<Case> {
    vec![metres(), descent(), curvature(), aside()]
}

/// A step of 5 m on the Moon, whose radius single floats keep to 0.125 m.
fn metres() -> Case {
    let grid = Grid { west_m: -20.0, south_m: -200.0, columns: 141, rows: 401, posting_m: 1.0 };
    let elevation_rad = 4f64.to_radians();
    let passage = Passage {
        row: Row { west_m: 50.0, east_m: 95.0 },
        light: sun(&map(&moon()), WEST_RAD, elevation_rad),
        expected_m: vec![5.0 / elevation_rad.tan()],
    };
    passage_case(32, "step of 5 m at the Moon's radius", grid.terrain(&moon(), step(5.0)), 1.0, 72.0, vec![passage])
}

/// A point of a penumbra from 50 km to 50 m above it: its share of the Sun is one and the same.
fn descent() -> Case {
    const STEP_M: f64 = 100.0;
    let grid = Grid { west_m: -400.0, south_m: -2000.0, columns: 141, rows: 201, posting_m: 20.0 };
    let (map, elevation_rad) = (map(&moon()), 3f64.to_radians());
    let place = DVec2::new(STEP_M / elevation_rad.tan(), 0.0);
    let views = [50_000.0, 5000.0, 500.0, 50.0]
        .map(|height_m| nadir(&map, place, height_m, sun(&map, WEST_RAD, elevation_rad)))
        .map(|view| view.with_optics(pinhole(4, 4, 5000.0)));
    // Above a point the step rises by atan(H/x); on the way there the Moon falls away by half the angle between them.
    let above_rad = move |x_m: f64| (STEP_M / x_m).atan() - 0.5 * x_m / 1_737_400.0;
    Case {
        number: 33,
        name: "penumbra from 50 km to 50 m",
        error_of: "share of the disc",
        limit: 0.05,
        scene: scene(grid.terrain(&moon(), step(STEP_M))),
        views: views.into(),
        reach_m: 2000.0,
        soft: true,
        error: shares(move |_, at_m| {
            let elevation_rad = elevation_rad - (at_m.x / 1_737_400.0).atan();
            let h = ((above_rad(at_m.x) - elevation_rad) / SOLAR_RADIUS_RAD).clamp(-1.0, 1.0);
            Some(0.5 - (h.asin() + h * (1.0 - h * h).sqrt()) / std::f64::consts::PI)
        }),
    }
}

/// A ray over a step of 1 km lands at R (e − acos((1 + H/R) cos e)): at 2° after 46 330 m, not 28 636 m.
fn curvature() -> Case {
    let grid = Grid { west_m: -4000.0, south_m: -150_000.0, columns: 121, rows: 601, posting_m: 500.0 };
    let passage = |(elevation_deg, end_m): (f64, f64)| Passage {
        row: Row { west_m: end_m - 4000.0, east_m: end_m + 4000.0 },
        light: sun(&map(&moon()), WEST_RAD, elevation_deg.to_radians()),
        expected_m: vec![end_m],
    };
    let passages = [(2.0, 46_330.0), (3.0, 21_657.0), (5.0, 11_896.0)].map(passage);
    passage_case(
        35,
        "shadow 46 km long on the Moon",
        grid.terrain(&moon(), step(1000.0)),
        500.0,
        46_330.0,
        passages.into(),
    )
}

/// A step of 1 km that stands 8° from the map's centre, where a metre of ground is 1.02 m of map: its shadow ends at
///
/// ```text
/// R tan θ,   θ = e − acos((1 + H/R) cos(e − θ₀))      e: elevation of the Sun at the map's centre
/// ```
fn aside() -> Case {
    const RADIUS_M: f64 = 1_737_400.0;
    const STEP_M: f64 = 1000.0;
    let step_rad = 8f64.to_radians();
    let step_m = RADIUS_M * step_rad.tan();
    let sun_rad = step_rad + 5f64.to_radians();
    let end_rad = sun_rad - ((1.0 + STEP_M / RADIUS_M) * (sun_rad - step_rad).cos()).acos();
    let end_m = RADIUS_M * end_rad.tan();
    let grid = Grid { west_m: step_m - 3000.0, south_m: -30_000.0, columns: 161, rows: 401, posting_m: 150.0 };
    let terrain = grid.terrain(&moon(), move |at_m| if at_m.x <= step_m { STEP_M } else { 0.0 });
    let passage = Passage {
        row: Row { west_m: end_m - 4000.0, east_m: end_m + 4000.0 },
        light: sun(&map(&moon()), WEST_RAD, sun_rad),
        expected_m: vec![end_m],
    };
    passage_case(23, "shadow 8° from the map's centre", terrain, 150.0, 12_000.0, vec![passage])
}
