//! Small terrains for the horizon tests.

use glam::DVec2;
use perilune_bench::scenes::Scene;
use perilune_engine::geometry::{Body, Geodetic};
use perilune_engine::horizon::Settings;
use perilune_engine::horizon::axis::Major;
use perilune_engine::horizon::sweep::Sweep;
use perilune_engine::terrain::{Face, Gnomonic, Level};

use crate::fixtures::data_folder;

/// A lunar map about the south pole.
pub fn lunar_map() -> Gnomonic {
    Gnomonic::about(&Body::moon(), Geodetic::from_degrees(-90.0, 0.0, 0.0))
}

/// A map so large that it is flat.
pub fn flat_map() -> Gnomonic {
    Gnomonic { radius_m: 1e12, ..lunar_map() }
}

/// A square level about `centre_m` whose heights above the sphere are `height_m(x, y)`.
pub fn level(map: &Gnomonic, nodes: usize, posting_m: f64, centre_m: DVec2, height_m: impl Fn(DVec2) -> f64) -> Level {
    let half_m = (nodes - 1) as f64 * posting_m / 2.0;
    let mut level = Level {
        columns: nodes,
        rows: nodes,
        posting_m,
        west_m: centre_m.x - half_m,
        south_m: centre_m.y - half_m,
        heights_m: Vec::new(),
        gap: vec![false; nodes * nodes],
        margin: 0,
    };
    for row in 0..nodes {
        for column in 0..nodes {
            let at_m = level.node_m(column, row);
            level.heights_m.push(map.lifted_height_m(at_m, map.radius_m + height_m(at_m)) as f32);
        }
    }
    level
}

pub fn face(map: Gnomonic, levels: Vec<Level>) -> Face {
    Face { map, levels }
}

/// Pseudo-random numbers in 0 … 1 (SplitMix64).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Heights of a cratered terrain: N(>D) ~ D^-1.83 on a long wave of 1 km.
pub fn craters(nodes: usize, posting_m: f64, seed: u64) -> Vec<f32> {
    let side_m = nodes as f64 * posting_m;
    let mut random = Random(seed);
    let mut heights_m: Vec<f32> = (0..nodes * nodes)
        .map(|i| {
            let (x, y) = ((i % nodes) as f64 / nodes as f64, (i / nodes) as f64 / nodes as f64);
            (1000.0 * (4.1 * x + 1.0).sin() * (3.3 * y + 0.4).cos() + 150.0 * (17.0 * x + 9.0 * y).sin()) as f32
        })
        .collect();
    let (smallest_m, largest_m) = (3.0 * posting_m, side_m / 6.0);
    let count = (0.06 * (side_m / smallest_m).powf(1.83)) as usize * 12;
    for _ in 0..count {
        let diameter_m = (smallest_m * random.next().powf(-1.0 / 1.83)).min(largest_m);
        let depth_m = 0.2 * diameter_m * random.next().sqrt();
        let (cx, cy) = (random.next() * nodes as f64, random.next() * nodes as f64);
        let radius = diameter_m / 2.0 / posting_m;
        let reach = 2.5 * radius;
        let range = |c: f64| ((c - reach).max(0.0) as usize)..((c + reach + 1.0).min(nodes as f64) as usize);
        for row in range(cy) {
            for column in range(cx) {
                let d = ((column as f64 - cx).powi(2) + (row as f64 - cy).powi(2)).sqrt() / radius;
                let rim_m = 0.2 * depth_m;
                let height_m = if d < 1.0 {
                    (depth_m + rim_m) * d * d - depth_m
                } else {
                    rim_m * d.powi(-3) * (1.0 - d / 2.5).max(0.0) / 0.6
                };
                heights_m[row * nodes + column] += height_m as f32;
            }
        }
    }
    heights_m
}

/// A cratered lunar face of one level.
pub fn cratered(nodes: usize, posting_m: f64, seed: u64) -> Face {
    let map = lunar_map();
    let heights_m = craters(nodes, posting_m, seed);
    let mut level = level(&map, nodes, posting_m, DVec2::ZERO, |_| 0.0);
    for (i, height_m) in heights_m.iter().enumerate() {
        let at_m = level.node_m(i % nodes, i / nodes);
        level.heights_m[i] = map.lifted_height_m(at_m, map.radius_m + f64::from(*height_m)) as f32;
    }
    face(map, vec![level])
}

/// Three rough levels of 20, 60 and 300 m with so many nodes a side, the second moved to one side of the first.
pub fn nested(nodes: [usize; 3]) -> Face {
    let map = lunar_map();
    let levels = [(20.0, 1.0), (60.0, 2.0), (300.0, 3.0)].into_iter().zip(nodes).map(|((posting_m, seed), nodes)| {
        let centre_m = DVec2::new(130.0, -70.0) * seed;
        let mut level =
            level(&map, nodes, posting_m, centre_m, |at| 700.0 * (at.x / 2300.0).sin() * (at.y / 1900.0).cos());
        let mut random = Random(seed as u64);
        level.heights_m.iter_mut().for_each(|height_m| *height_m += (posting_m * random.next()) as f32);
        level
    });
    let mut levels: Vec<Level> = levels.collect();
    levels[0].margin = 7;
    levels[1].west_m += 2500.0;
    face(map, levels)
}

/// The swept elevation of every seen node in one azimuth, `[row][column]`.
pub fn swept(face: &Face, level: usize, settings: &Settings, direction: DVec2) -> Vec<Vec<f64>> {
    let major = Major::of(direction);
    let sweep = Sweep::new(face, level, major, settings);
    let plane = sweep.elevations_rad(direction);
    let r = &sweep.receivers;
    let at = |u: usize, v: usize| f64::from(plane[u * r.stride + v]);
    match major {
        Major::Row => (0..r.majors).map(|row| (0..r.minors).map(|column| at(row, column)).collect()).collect(),
        Major::Column => (0..r.minors).map(|row| (0..r.majors).map(|column| at(column, row)).collect()).collect(),
    }
}

/// The connecting ridge within the polar cap, where its elevation models are.
pub fn connecting_ridge() -> Option<Scene> {
    let scene = Scene::connecting_ridge(&[data_folder()]).unwrap_or_else(|error| panic!("{error}"));
    if scene.is_none() {
        println!("skipped: the elevation models of the connecting ridge are absent");
    }
    scene
}
