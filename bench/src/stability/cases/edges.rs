//! Shadows of cliffs, ridges and cones end where trigonometry says.

use std::f64::consts::TAU;

use glam::DVec2;

use super::super::Case;
use super::super::scenes::{Grid, Row, flat_body, map, sun};
use super::{Passage, WEST_RAD, passage_case, step};
use perilune_engine::render::Light;

pub fn cases() -> Vec<Case> {
    vec![foot(), oblique(), high(), ridges(), tip()]
}

/// Postings of 20 m; the cliff's edge is 4 km long.
fn cliff(height_m: f64) -> perilune_engine::terrain::Terrain {
    let grid = Grid { west_m: -400.0, south_m: -2000.0, columns: 141, rows: 201, posting_m: 20.0 };
    grid.terrain(&flat_body(), step(height_m))
}

/// H cot e cos(A − A_wall) under a Sun `turn_deg` off the cliff's normal.
fn passage(height_m: f64, elevation_deg: f64, turn_deg: f64, half_m: f64) -> Passage {
    let (elevation_rad, turn_rad) = (elevation_deg.to_radians(), turn_deg.to_radians());
    let end_m = height_m / elevation_rad.tan() * turn_rad.cos();
    Passage {
        row: Row { west_m: end_m - half_m, east_m: end_m + half_m },
        light: sun(&map(&flat_body()), WEST_RAD + turn_rad, elevation_rad),
        expected_m: vec![end_m],
    }
}

/// The cell that rises is 20 m wide, the shadow ends 58 m from it.
fn foot() -> Case {
    passage_case(20, "foot of a cliff, Sun 60° high", cliff(100.0), 20.0, 60.0, vec![passage(100.0, 60.0, 0.0, 30.0)])
}

fn oblique() -> Case {
    let passages = [0.0, 40.0, -40.0].map(|turn_deg| passage(100.0, 6.0, turn_deg, 200.0));
    passage_case(12, "endless wall under oblique Suns", cliff(100.0), 20.0, 952.0, passages.into())
}

/// The disc spans 6.1° in azimuth.
fn high() -> Case {
    passage_case(
        4,
        "Sun 85° high over a 2 km cliff",
        cliff(2000.0),
        20.0,
        175.0,
        vec![passage(2000.0, 85.0, 0.0, 90.0)],
    )
}

/// z = 100 m sin(2 π x/2 km): the shadow begins where the slope is the Sun's and ends on the next rise; by bisection.
fn ridges() -> Case {
    let map = map(&flat_body());
    let terrain = Grid::square(3000.0, 25.0).terrain(&flat_body(), |at: DVec2| 100.0 * (TAU * at.x / 2000.0).sin());
    let passages =
        [(5f64, [589.832, 1931.544]), (10.0, [689.686, 1657.863])].map(|(elevation_deg, expected_m)| Passage {
            row: Row { west_m: 450.0, east_m: 2100.0 },
            light: sun(&map, WEST_RAD, elevation_deg.to_radians()),
            expected_m: expected_m.into(),
        });
    passage_case(36, "ridges, from graze to landing", terrain, 25.0, 1342.0, passages.into())
}

/// A cone of 200 m over a base of 400 m radius under a Sun nearly a point: its tip's shadow lies at H cot e.
fn tip() -> Case {
    let map = map(&flat_body());
    let terrain = Grid::square(800.0, 10.0).terrain(&flat_body(), |at| (200.0 * (1.0 - at.length() / 400.0)).max(0.0));
    let elevation_rad = 20f64.to_radians();
    let passage = Passage {
        row: Row { west_m: 405.0, east_m: 700.0 },
        light: Light { angular_radius_rad: 1e-4, ..sun(&map, WEST_RAD, elevation_rad) },
        expected_m: vec![200.0 / elevation_rad.tan()],
    };
    passage_case(11, "tip of a cone's shadow", terrain, 10.0, 550.0, vec![passage])
}
