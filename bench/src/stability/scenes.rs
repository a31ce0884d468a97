//! Small scenes with closed forms: bodies, grids of heights, Suns and cameras that look straight down.

use glam::{DVec2, DVec3};

use perilune_engine::camera::{Camera as Optics, Pose};
use perilune_engine::geometry::{Body, Geodetic, Position, Rotation};
use perilune_engine::photometry::{LimbDarkening, Reflectance, SolarDisk};
use perilune_engine::render::planes::Radiometry;
use perilune_engine::render::{Light, Quantity, Samples, Scene, View};
use perilune_engine::terrain::{Face, Gnomonic, Ground, Hit, Level, Surface, Terrain};

/// Angular radius of the Sun at 1 au, rounded as in the tables of expected values.
pub const SOLAR_RADIUS_RAD: f64 = 0.004_650_48;

pub const SOLAR_IRRADIANCE_W_M2: f64 = 1361.0;

/// A body so large that 3 km from a point it falls away by 5 mm.
pub fn flat_body() -> Body {
    Body { name: "flat".into(), naif_id: 0, equatorial_radius_m: 1e9, polar_radius_m: 1e9 }
}

/// A map about no special point.
pub fn map(body: &Body) -> Gnomonic {
    Gnomonic::about(body, Geodetic::from_degrees(20.0, 30.0, 0.0))
}

/// Where a level lies: its south-west node, its size, its posting.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    pub west_m: f64,
    pub south_m: f64,
    pub columns: usize,
    pub rows: usize,
    pub posting_m: f64,
}

impl Grid {
    /// Nodes from −half to +half in both directions.
    pub fn square(half_m: f64, posting_m: f64) -> Self {
        let nodes = 2 * (half_m / posting_m).round() as usize + 1;
        Self { west_m: -half_m, south_m: -half_m, columns: nodes, rows: nodes, posting_m }
    }

    /// One level of ground with heights above the sphere.
    pub fn terrain(&self, body: &Body, height_m: impl Fn(DVec2) -> f64) -> Terrain {
        let map = map(body);
        let &Self { west_m, south_m, columns, rows, posting_m } = self;
        let nodes = columns * rows;
        let gap = vec![false; nodes];
        let mut level =
            Level { columns, rows, posting_m, west_m, south_m, heights_m: vec![0.0; nodes], gap, margin: 0 };
        for index in 0..nodes {
            let at_m = level.node_m(index % columns, index / columns);
            level.heights_m[index] = map.lifted_height_m(at_m, map.radius_m + height_m(at_m)) as f32;
        }
        Terrain { body: body.clone(), faces: vec![Face { map, levels: vec![level] }] }
    }
}

pub fn bare(body: Body) -> Terrain {
    Terrain { body, faces: Vec::new() }
}

/// A terrain without shadows under a uniform Sun.
pub fn scene(terrain: Terrain) -> Scene {
    Scene::new(Surface::new(terrain)).with_disk(disk(0.0))
}

/// A view of Lambert ground of albedo 0.2 by a camera of one pixel, one sample a pixel.
pub fn view(pose: Pose, lights: Vec<Light>) -> View {
    View::new(pose, pinhole(1, 1, 1.0), lights)
        .with_reflectance(Reflectance::lambert(0.2))
        .with_quantities([Quantity::Radiance, Quantity::Range])
}

pub fn disk(alpha: f64) -> SolarDisk {
    SolarDisk::new(LimbDarkening::Power { alpha }).expect("a law in its domain")
}

pub fn pinhole(columns: u32, rows: u32, focal_px: f64) -> Optics {
    Optics::pinhole(columns, rows, DVec2::splat(focal_px)).expect("a camera in its domain")
}

/// A level with the radius `radius_m(map direction)`, margin included.
pub fn level(map: &Gnomonic, posting_m: f64, half: usize, margin: usize, height_m: &dyn Fn(DVec3) -> f64) -> Level {
    let nodes = 2 * (half + margin) + 1;
    let south_m = -((half + margin) as f64) * posting_m;
    let mut level = Level {
        columns: nodes,
        rows: nodes,
        posting_m,
        west_m: south_m,
        south_m,
        heights_m: vec![0.0; nodes * nodes],
        gap: vec![false; nodes * nodes],
        margin,
    };
    for row in 0..nodes {
        for column in 0..nodes {
            let at_m = level.node_m(column, row);
            let up = map.map_from_body.inverse() * map.up(at_m);
            let index = level.index(column, row);
            level.heights_m[index] = map.lifted_height_m(at_m, map.radius_m + height_m(up.unit())) as f32;
        }
    }
    level
}

/// Waves on the sphere: the same on every map.
pub fn waves(length_m: f64, height_m: f64) -> impl Fn(DVec3) -> f64 {
    move |up| {
        let k = 1_737_400.0 * std::f64::consts::TAU / length_m;
        height_m * ((k * up.x).sin() + (k * up.y).sin() * (0.7 * k * up.z).cos())
    }
}

/// Waves of 3 km on all six faces of a cube around the Moon.
pub fn cube(half: usize) -> Terrain {
    let body = Body::moon();
    let maps = Gnomonic::cube(&body, Geodetic::from_degrees(20.0, 30.0, 0.0));
    let heights = waves(300_000.0, 3000.0);
    let faces = maps.map(|map| {
        let levels = vec![level(&map, map.radius_m / half as f64, half, 5, &heights)];
        Face { map, levels }
    });
    Terrain { body, faces: faces.into() }
}

/// A light in a direction of the map's axes, given at the map's centre; so far away that its rays are parallel.
pub fn sun(map: &Gnomonic, azimuth_rad: f64, elevation_rad: f64) -> Light {
    let ((sin_a, cos_a), (sin_e, cos_e)) = (azimuth_rad.sin_cos(), elevation_rad.sin_cos());
    light(map.map_from_body.inverse().turn(DVec3::new(cos_e * sin_a, cos_e * cos_a, sin_e)))
}

/// A light in a body-fixed direction.
pub fn light(towards: DVec3) -> Light {
    Light {
        position: Position::from_m(1e16 * towards),
        angular_radius_rad: SOLAR_RADIUS_RAD,
        irradiance_w_m2: SOLAR_IRRADIANCE_W_M2,
    }
}

/// A camera above a map point that looks down, right in the image towards map +X, down towards map −Y.
pub fn nadir(map: &Gnomonic, at_m: DVec2, height_m: f64, sun: Light) -> View {
    let lifted = at_m.extend(map.lifted_height_m(at_m, map.radius_m + height_m));
    let [right, down, forward] = [DVec3::X, -DVec3::Y, -DVec3::Z].map(|axis| map.map_from_body.inverse().turn(axis));
    let camera_from_body = Rotation::from_axes(right, down, forward);
    view(Pose { position: map.body_from_lifted(lifted), camera_from_body }, vec![sun])
}

/// A camera at a body-fixed place that looks at the body's centre.
pub fn towards_centre(camera_m: DVec3, lights: Vec<Light>) -> View {
    let forward = -camera_m.normalize();
    let right = forward.any_orthonormal_vector();
    let camera_from_body = Rotation::from_axes(right, forward.cross(right), forward);
    view(Pose { position: Position::from_m(camera_m), camera_from_body }, lights)
}

/// Map point and Sun fraction of each pixel's centre, for one sample a pixel on ground with heights.
pub fn profile(samples: &Samples) -> Vec<(DVec2, f64)> {
    let point = |(hit, pixel): (&Option<Hit>, &Radiometry)| {
        let Ground::Dem { lifted, .. } = (*hit)?.ground else { return None };
        Some((lifted.truncate(), f64::from(pixel.sun_fraction)))
    };
    samples.centres.iter().zip(&samples.pixels).filter_map(point).collect()
}

/// A row of pixels along map +X from `west_m` to `east_m`, and where in it the Sun fraction passes one half.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    pub west_m: f64,
    pub east_m: f64,
}

impl Row {
    const PIXELS: u32 = 400;
    /// Camera height over the row's length.
    const HEIGHT: f64 = 2.0;

    pub fn optics() -> Optics {
        pinhole(Self::PIXELS, 1, Self::HEIGHT * f64::from(Self::PIXELS))
    }

    pub fn view(&self, map: &Gnomonic, sun: Light) -> View {
        let middle_m = DVec2::new((self.west_m + self.east_m) / 2.0, 0.0);
        nadir(map, middle_m, Self::HEIGHT * (self.east_m - self.west_m), sun).with_optics(Self::optics())
    }

    /// Sun fraction against map X.
    pub fn fractions(&self, samples: &Samples) -> Vec<(f64, f64)> {
        profile(samples).into_iter().map(|(at_m, fraction)| (at_m.x, fraction)).collect()
    }

    /// Map X of all passages through one half.
    pub fn edges_m(&self, samples: &Samples) -> Vec<f64> {
        let passage = |pair: &[(f64, f64)]| {
            let [(x0, f0), (x1, f1)] = [pair[0], pair[1]];
            ((f0 - 0.5) * (f1 - 0.5) < 0.0).then(|| x0 + (x1 - x0) * (0.5 - f0) / (f1 - f0))
        };
        self.fractions(samples).windows(2).filter_map(passage).collect()
    }
}
