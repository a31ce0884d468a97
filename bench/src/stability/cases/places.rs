//! Places where maps are hard: holes, the ends of levels, the pole, seams of a cube, handedness.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::super::Case;
use super::super::scenes::{Grid, Row, cube, flat_body, level, light, map, nadir, pinhole, scene, sun, towards_centre};
use super::{Passage, WEST_RAD, against_traced, moon, passage_case, shares, step};
use perilune_engine::geometry::Geodetic;
use perilune_engine::render::Samples;
use perilune_engine::terrain::{Face, Gnomonic, Terrain};

pub fn cases() -> Vec<Case> {
    vec![hole(), beyond(), pole(), seam(), symmetric(), handed()]
}

/// A hole in a plain casts no shadow.
fn hole() -> Case {
    let mut terrain = Grid::square(500.0, 10.0).terrain(&flat_body(), |_| 0.0);
    let level = &mut terrain.faces[0].levels[0];
    for (column, row) in (30..36).flat_map(|column| (40..70).map(move |row| (column, row))) {
        let index = level.index(column, row);
        level.gap[index] = true;
    }
    let map = map(&flat_body());
    Case {
        number: 27,
        name: "hole in a plain, Sun 2° high behind it",
        error_of: "share of the disc",
        limit: 1e-3,
        scene: scene(terrain),
        views: vec![
            nadir(&map, DVec2::ZERO, 700.0, sun(&map, WEST_RAD, 2f64.to_radians())).with_optics(pinhole(24, 24, 24.0)),
        ],
        reach_m: 200.0,
        soft: false,
        error: shares(|_, _| Some(1.0)),
    }
}

/// A cliff of the coarse level, 2 km away, ends its shadow in the fine level.
fn beyond() -> Case {
    let map = map(&flat_body());
    let mut terrain = Grid::square(1000.0, 20.0).terrain(&flat_body(), |_| 0.0);
    let far = Grid::square(8000.0, 80.0).terrain(&flat_body(), |at_m| step(100.0)(at_m + DVec2::new(2000.0, 0.0)));
    terrain.faces[0].levels.extend(far.faces.into_iter().flat_map(|face| face.levels));
    let elevation_rad = (100.0f64 / 2200.0).atan();
    let passage = Passage {
        row: Row { west_m: 0.0, east_m: 400.0 },
        light: sun(&map, WEST_RAD, elevation_rad),
        expected_m: vec![200.0],
    };
    passage_case(28, "cliff beyond the end of a level", terrain, 20.0, 2200.0, vec![passage])
}

/// Waves that a quarter turn about the pole leaves as they are: a Sun a quarter turn on gives the image turned.
fn pole() -> Case {
    const SIDE: usize = 32;
    let map = Gnomonic::about(&moon(), Geodetic::from_degrees(-90.0, 0.0, 0.0));
    let waves = |up: DVec3| {
        let phase = TAU * 1_737_400.0 / 900.0 * up;
        40.0 * (phase.x.cos() + phase.y.cos())
    };
    let levels = vec![level(&map, 20.0, 60, 0, &waves)];
    let terrain = Terrain { body: moon(), faces: vec![Face { map: map.clone(), levels }] };
    let optics = pinhole(SIDE as u32, SIDE as u32, 40.0);
    let view = |azimuth_rad: f64| nadir(&map, DVec2::ZERO, 2000.0, sun(&map, azimuth_rad, 0.15));
    let views = [0.4, 0.4 + TAU / 4.0].map(|azimuth_rad| view(azimuth_rad).with_optics(optics.clone()));
    Case {
        number: 17,
        name: "pole, Sun a quarter turn on",
        error_of: "mean share of the disc between two images",
        limit: 1e-3,
        scene: scene(terrain),
        views: views.into(),
        reach_m: 530.0,
        soft: false,
        error: Box::new(|images: &[Samples]| {
            let share = |image: usize, column: usize, row: usize| {
                f64::from(images[image].pixels[row * SIDE + column].sun_fraction)
            };
            let pixels = (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (column, row)));
            let differences = pixels.map(|(c, r)| (share(0, c, r) - share(1, SIDE - 1 - r, c)).abs());
            differences.sum::<f64>() / (SIDE * SIDE) as f64
        }),
    }
}

/// Waves on the faces of a cube, one of its edges in the middle of the image, against traced shadows.
fn seam() -> Case {
    let terrain = cube(48);
    let [a, b] = [0, 2].map(|face| terrain.faces[face].map.map_from_body.inverse().turn(DVec3::Z));
    let up = (a + if a.dot(b).abs() < 0.5 { b } else { a.any_orthonormal_vector() }).normalize();
    let (sin, cos) = 2f64.to_radians().sin_cos();
    let along = (b - a).normalize();
    let view = towards_centre(2_700_000.0 * up, vec![light(cos * along + sin * up)]).with_optics(pinhole(32, 32, 60.0));
    let mut scene = scene(terrain);
    let error = against_traced(&mut scene, &view);
    Case {
        number: 16,
        name: "seam of two faces of a cube",
        error_of: "mean share of the disc against traced",
        limit: 0.02,
        scene,
        views: vec![view],
        reach_m: 90_000.0,
        soft: false,
        error,
    }
}

/// A round hill in the middle of its grid: a Sun half a turn on gives the image turned by half.
fn symmetric() -> Case {
    const SIDE: usize = 32;
    let map = map(&flat_body());
    let hill = |at: DVec2| 150.0 * (-at.length_squared() / (2.0 * 150.0 * 150.0)).exp();
    let optics = pinhole(SIDE as u32, SIDE as u32, 36.0);
    let view = |azimuth_rad: f64| nadir(&map, DVec2::ZERO, 1600.0, sun(&map, azimuth_rad, 0.2));
    let views = [0.7, 0.7 + TAU / 2.0].map(|azimuth_rad| view(azimuth_rad).with_optics(optics.clone()));
    Case {
        number: 25,
        name: "round hill, Sun half a turn on",
        error_of: "mean share of the disc between two images",
        limit: 1e-3,
        scene: scene(Grid::square(900.0, 20.0).terrain(&flat_body(), hill)),
        views: views.into(),
        reach_m: 800.0,
        soft: false,
        error: Box::new(|images: &[Samples]| {
            let turned = images[0].pixels.iter().zip(images[1].pixels.iter().rev());
            turned.map(|(a, b)| f64::from((a.sun_fraction - b.sun_fraction).abs())).sum::<f64>() / (SIDE * SIDE) as f64
        }),
    }
}

/// The shadow of a tower lies opposite the Sun, and in none of the seven other places that a turn or a mirror gives.
fn handed() -> Case {
    let tower = |at: DVec2| if at.abs().max_element() < 15.0 { 100.0 } else { 0.0 };
    let map = map(&flat_body());
    let places: Vec<DVec2> = [30.0f64, 150.0, 210.0, 330.0, 60.0, 120.0, 240.0, 300.0]
        .map(|azimuth_deg| DVec2::new(azimuth_deg.to_radians().sin(), azimuth_deg.to_radians().cos()))
        .into();
    let dark = places[2];
    Case {
        number: 52,
        name: "handedness of a tower's shadow",
        error_of: "share of the disc",
        limit: 0.05,
        scene: scene(Grid::square(400.0, 10.0).terrain(&flat_body(), tower)),
        views: vec![
            nadir(&map, DVec2::ZERO, 450.0, sun(&map, 30f64.to_radians(), 30f64.to_radians()))
                .with_optics(pinhole(64, 64, 96.0)),
        ],
        reach_m: 173.0,
        soft: false,
        error: shares(move |_, at_m| {
            let place = places.iter().find(|place| at_m.distance(100.0 * **place) < 12.0)?;
            Some(f64::from(*place != dark))
        }),
    }
}
