//! The Sun in the zenith, in the nadir, below the horizon, in the north.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::super::Case;
use super::super::scenes::{Grid, flat_body, level, light, map, nadir, pinhole, scene, sun, waves};
use super::{moon, shares};
use perilune_engine::render::{Samples, View};
use perilune_engine::terrain::Terrain;

pub fn cases() -> Vec<Case> {
    vec![zenith(), below(), wrap()]
}

/// From a bowl whose walls are less steep than 44° all of a Sun in the zenith is seen; its azimuth is none.
fn zenith() -> Case {
    let (rim_m, depth_m) = (1000.0f64, 400.0);
    let radius_m = (rim_m * rim_m + depth_m * depth_m) / (2.0 * depth_m);
    let bowl = move |at: DVec2| {
        let inside = radius_m * radius_m - at.length_squared();
        if at.length() < rim_m { radius_m - depth_m - inside.sqrt() } else { 0.0 }
    };
    let terrain = Grid::square(1200.0, 20.0).terrain(&flat_body(), bowl);
    let map = map(&flat_body());
    let views = [90f64, 89.9, 89.5]
        .map(|e| nadir(&map, DVec2::ZERO, 1000.0, sun(&map, 0.7, e.to_radians())))
        .map(|view| view.with_optics(pinhole(16, 16, 12.0)));
    Case {
        number: 3,
        name: "Sun in the zenith of a bowl",
        error_of: "share of the disc",
        limit: 1e-3,
        scene: scene(terrain),
        views: views.into(),
        reach_m: 0.0,
        soft: false,
        error: shares(|_, _| Some(1.0)),
    }
}

/// No share of a Sun that stands a radius and more below level ground, or under one's feet.
fn below() -> Case {
    let terrain = Grid::square(500.0, 10.0).terrain(&flat_body(), |_| 0.0);
    let map = map(&flat_body());
    let down = map.map_from_body.inverse().turn(-DVec3::Z);
    let low = [-0.3f64, -5.0, -60.0].map(|e| sun(&map, 2.0, e.to_radians()));
    let lights = low.into_iter().chain([light(down)]);
    Case {
        number: 2,
        name: "Sun below the horizon and in the nadir",
        error_of: "share of the disc",
        limit: 1e-3,
        scene: scene(terrain),
        views: lights.map(|light| nadir(&map, DVec2::ZERO, 800.0, light).with_optics(pinhole(12, 12, 24.0))).collect(),
        reach_m: 0.0,
        soft: false,
        error: shares(|_, _| Some(0.0)),
    }
}

/// A Sun a hair to the left of north and one a hair to the right, with azimuths of 0 and a whole turn.
fn wrap() -> Case {
    let map = map(&moon());
    let levels = vec![level(&map, 40.0, 60, 0, &waves(2300.0, 110.0))];
    let terrain = Terrain { body: moon(), faces: vec![perilune_engine::terrain::Face { map: map.clone(), levels }] };
    let view = |azimuth_rad: f64| -> View {
        nadir(&map, DVec2::ZERO, 3000.0, sun(&map, azimuth_rad, 0.1)).with_optics(pinhole(32, 32, 32.0))
    };
    Case {
        number: 22,
        name: "Sun in the north, azimuth 0 or 360°",
        error_of: "share of the disc between two images",
        limit: 1e-3,
        scene: scene(terrain),
        views: [0.0, 1e-9, TAU - 1e-9, TAU].map(view).into(),
        reach_m: 1100.0,
        soft: false,
        error: Box::new(|images: &[Samples]| {
            let pixels = |image: usize| images[image].pixels.iter().map(|pixel| f64::from(pixel.sun_fraction));
            (1..images.len()).flat_map(|i| pixels(0).zip(pixels(i))).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        }),
    }
}
