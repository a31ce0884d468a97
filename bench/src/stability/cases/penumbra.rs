//! The disc cut by a skyline: grazing Suns, small ones, and slopes that shade themselves.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::super::Case;
use super::super::scenes::{
    Grid, Row, SOLAR_IRRADIANCE_W_M2, SOLAR_RADIUS_RAD, disk, flat_body, map, nadir, pinhole, scene, sun,
};
use super::{Passage, WEST_RAD, passage_case, shares, step};
use perilune_engine::render::{Light, Samples};
use perilune_engine::terrain::Terrain;

pub fn cases() -> Vec<Case> {
    vec![tangent(), product(), darkened(), tiny(), large(), slope()]
}

/// A plateau 100 m high, its edge 8 km long.
fn plateau() -> Terrain {
    let grid = Grid { west_m: -400.0, south_m: -4000.0, columns: 141, rows: 401, posting_m: 20.0 };
    grid.terrain(&flat_body(), step(100.0))
}

/// V(h) of a uniform disc behind a straight edge `h` radii above its centre.
fn behind_edge(h: f64) -> f64 {
    let h = h.clamp(-1.0, 1.0);
    0.5 - (h.asin() + h * (1.0 - h * h).sqrt()) / PI
}

/// The whole penumbra of an edge, both tangents in it.
fn tangent() -> Case {
    let (map, elevation_rad) = (map(&flat_body()), 3f64.to_radians());
    let row = Row { west_m: 1700.0, east_m: 2150.0 };
    Case {
        number: 1,
        name: "Sun tangent to an edge",
        error_of: "share of the disc",
        limit: 0.05,
        scene: scene(plateau()),
        views: vec![row.view(&map, sun(&map, WEST_RAD, elevation_rad))],
        reach_m: 2150.0,
        soft: true,
        error: shares(move |_, at_m| Some(behind_edge(((100.0 / at_m.x).atan() - elevation_rad) / SOLAR_RADIUS_RAD))),
    }
}

/// Level ground under a Sun that is cut by its own horizon: the integral of the sine over the part of the disc above it,
///
/// ```text
/// E/E₀ = r [x (acos(−x) + x √(1 − x²))/π + 2 (1 − x²)^(3/2)/(3 π)]      x: elevation of the centre in radii
/// ```
///
/// and not the seen share times the sine of the centre.
fn product() -> Case {
    const HEIGHTS: [f64; 4] = [-0.5, 0.0, 0.5, 0.9];
    let terrain = Grid::square(500.0, 10.0).terrain(&flat_body(), |_| 0.0);
    let map = map(&flat_body());
    let at = |x: f64| nadir(&map, DVec2::ZERO, 200.0, sun(&map, 1.0, x * SOLAR_RADIUS_RAD));
    let views = HEIGHTS.map(|x| at(x).with_optics(pinhole(8, 8, 16.0)));
    let expected = |x: f64| {
        let root = (1.0 - x * x).sqrt();
        SOLAR_RADIUS_RAD * (x * ((-x).acos() + x * root) / PI + 2.0 * root.powi(3) / (3.0 * PI))
    };
    Case {
        number: 5,
        name: "Sun cut by level ground's own horizon",
        error_of: "irradiance, relative",
        limit: 0.02,
        scene: scene(terrain),
        views: views.into(),
        reach_m: 0.0,
        soft: true,
        error: Box::new(move |images: &[Samples]| {
            let of_image = |(image, x): (&Samples, f64)| {
                let error = |w_m2: f32| (f64::from(w_m2) / (SOLAR_IRRADIANCE_W_M2 * expected(x)) - 1.0).abs();
                image.pixels.iter().map(|pixel| error(pixel.irradiance_w_m2)).fold(0.0, f64::max)
            };
            images.iter().zip(HEIGHTS).map(of_image).fold(0.0, f64::max)
        }),
    }
}

/// The penumbra of a disc whose radiance falls to nothing at the limb as the cosine does: of strips of `1 − y²`,
///
/// ```text
/// V(h) = (2 − 3 h + h³)/4
/// ```
///
/// which near `h = 1` is a third and less of a uniform disc's.
fn darkened() -> Case {
    let (map, elevation_rad) = (map(&flat_body()), 3f64.to_radians());
    let row = Row { west_m: 1700.0, east_m: 2150.0 };
    let scene = scene(plateau()).with_disk(disk(1.0));
    Case {
        number: 6,
        name: "penumbra of a darkened disc",
        error_of: "share of the disc's light",
        limit: 0.05,
        scene,
        views: vec![row.view(&map, sun(&map, WEST_RAD, elevation_rad))],
        reach_m: 2150.0,
        soft: true,
        error: shares(move |_, at_m| {
            let h = (((100.0 / at_m.x).atan() - elevation_rad) / SOLAR_RADIUS_RAD).clamp(-1.0, 1.0);
            Some((2.0 - 3.0 * h + h * h * h) / 4.0)
        }),
    }
}

/// A light of 20° radius 40° high: the edge of a cliff is a great circle `d` from its centre, and of a cap of radius `r` it
/// leaves
///
/// ```text
/// ∫₀ʳ acos(tan d / tan θ)/π sin θ dθ / (1 − cos r)
/// ```
fn large() -> Case {
    const RADIUS_RAD: f64 = 20.0 * PI / 180.0;
    let (map, elevation_rad) = (map(&flat_body()), 40f64.to_radians());
    let seen = |above_rad: f64| {
        let ring = |index: u32| {
            let theta = RADIUS_RAD * (f64::from(index) + 0.5) / 1000.0;
            (above_rad.tan() / theta.tan()).clamp(-1.0, 1.0).acos() / PI * theta.sin()
        };
        (0..1000).map(ring).sum::<f64>() * RADIUS_RAD / 1000.0 / (1.0 - RADIUS_RAD.cos())
    };
    let row = Row { west_m: 60.0, east_m: 260.0 };
    Case {
        number: 8,
        name: "light of 20° radius over an edge",
        error_of: "share of the disc",
        limit: 0.05,
        scene: scene(plateau()),
        views: vec![row.view(&map, Light { angular_radius_rad: RADIUS_RAD, ..sun(&map, WEST_RAD, elevation_rad) })],
        reach_m: 260.0,
        soft: true,
        error: shares(move |_, at_m| Some(seen((100.0 / at_m.x).atan() - elevation_rad))),
    }
}

/// A Sun of a hundredth of a milliradian, and one without any size.
fn tiny() -> Case {
    let (map, elevation_rad) = (map(&flat_body()), 6f64.to_radians());
    let expected_m = 100.0 / elevation_rad.tan();
    let passage = |angular_radius_rad| Passage {
        row: Row { west_m: expected_m - 200.0, east_m: expected_m + 200.0 },
        light: Light { angular_radius_rad, ..sun(&map, WEST_RAD, elevation_rad) },
        expected_m: vec![expected_m],
    };
    passage_case(7, "Sun without size", plateau(), 20.0, expected_m, [1e-5, 0.0].map(passage).into())
}

/// A plane that slopes by 10° is lit wholly or not at all while the Sun stands a radius and more off it.
fn slope() -> Case {
    let slope = 10f64.to_radians().tan();
    let terrain = Grid::square(1000.0, 20.0).terrain(&flat_body(), |at_m| slope * at_m.x);
    let normal = DVec3::new(-slope, 0.0, 1.0).normalize();
    let map = map(&flat_body());
    let suns: Vec<Light> = [0.0f64, 45.0, 90.0, 180.0, 270.0]
        .into_iter()
        .flat_map(|a| [3f64, 10.5].map(|e| (a.to_radians(), e.to_radians())))
        .map(|(azimuth_rad, elevation_rad)| sun(&map, azimuth_rad, elevation_rad))
        .collect();
    let radii: Vec<f64> = suns
        .iter()
        .map(|light| {
            normal.dot(map.map_from_body.turn(light.position.vector_m()).normalize()).asin() / SOLAR_RADIUS_RAD
        })
        .collect();
    Case {
        number: 36,
        name: "acne on a constant slope",
        error_of: "share of the disc",
        limit: 1e-3,
        scene: scene(terrain),
        views: suns
            .into_iter()
            .map(|light| nadir(&map, DVec2::ZERO, 1500.0, light).with_optics(pinhole(12, 12, 24.0)))
            .collect(),
        reach_m: 0.0,
        soft: false,
        error: shares(move |view, _| match radii[view] {
            x if x > 1.02 => Some(1.0),
            x if x < -1.02 => Some(0.0),
            _ => None,
        }),
    }
}
