//! Metres at the radius of a planet, and its curvature.

use super::super::Case;
use super::super::scenes::{Grid, Row, map, sun};
use super::{Passage, WEST_RAD, moon, passage_case, step};

pub fn cases() -> Vec<Case> {
    vec![metres(), curvature()]
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
