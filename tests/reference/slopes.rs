//! Normals by which ground is shaded: against the bicubic surface, beside cliffs, at the edges of models.

use glam::{DVec2, DVec3};
use perilune_bench::scenes::Scene;
use perilune_engine::geometry::Body;
use perilune_engine::render::planes;
use perilune_engine::terrain::{Ground, Hit, Level, Surface};

use crate::fixtures;
use crate::scenes::{self, Grid, flat_body, map};

/// Weights of the heights at −1, 0, 1, 2 in Keys' surface, and their derivatives (Keys 1981, equation 8, a = −½).
fn keys(t: f64) -> [[f64; 4]; 2] {
    let far = |s: f64| [-0.5 * s.powi(3) + 2.5 * s * s - 4.0 * s + 2.0, -1.5 * s * s + 5.0 * s - 4.0];
    let near = |s: f64| [1.5 * s.powi(3) - 2.5 * s * s + 1.0, 4.5 * s * s - 5.0 * s];
    let [a, b, c, d] = [far(1.0 + t), near(t), near(1.0 - t), far(2.0 - t)];
    [[a[0], b[0], c[0], d[0]], [a[1], b[1], -c[1], -d[1]]]
}

/// The gradient of the bicubic surface through the sixteen nodes about a grid point.
fn bicubic(level: &Level, grid: DVec2) -> DVec2 {
    let (low, t) = (grid.floor(), grid - grid.floor());
    let ([wx, dx], [wy, dy]) = (keys(t.x), keys(t.y));
    let mut gradient = DVec2::ZERO;
    for row in 0..4 {
        for column in 0..4 {
            let height = level.height_m(low.x as usize + column - 1, low.y as usize + row - 1) / level.posting_m;
            gradient += height * DVec2::new(dx[column] * wy[row], wx[column] * dy[row]);
        }
    }
    gradient
}

/// The nodes' central differences, bilinear between them: what the program did before.
fn bilinear(level: &Level, grid: DVec2) -> DVec2 {
    let central = |column: usize, row: usize| {
        let across = level.height_m(column + 1, row) - level.height_m(column - 1, row);
        let up = level.height_m(column, row + 1) - level.height_m(column, row - 1);
        DVec2::new(across, up) / (2.0 * level.posting_m)
    };
    let (c, r, t) = (grid.x as usize, grid.y as usize, grid - grid.floor());
    central(c, r).lerp(central(c + 1, r), t.x).lerp(central(c, r + 1).lerp(central(c + 1, r + 1), t.x), t.y)
}

/// RMS of the difference of two irradiances by a Sun 2° high over the mean, on the real ridge.
#[test]
fn the_ridge_is_lit_as_its_bicubic_surface() {
    let Some(folder) = fixtures::data("dem") else { return };
    let folders = [folder.parent().unwrap().to_path_buf()];
    let Some(ridge) = Scene::connecting_ridge(&folders).unwrap() else { return };
    let (face, level) = (&ridge.face, &ridge.face.levels[0]);
    for azimuth_deg in [30.0_f64, 140.0, 250.0] {
        let ((sin_a, cos_a), (sin_e, cos_e)) = (azimuth_deg.to_radians().sin_cos(), 2_f64.to_radians().sin_cos());
        let lit = |at_m: DVec2, gradient: DVec2| {
            let up = face.map.up(at_m).unit();
            let level_sun = DVec3::new(sin_a, cos_a, 0.0).reject_from_normalized(up).normalize();
            let lifted = at_m.extend(level.bilinear_m(level.grid_from_map(at_m)).unwrap());
            face.map.normal(lifted, gradient).unit().dot(cos_e * level_sun + sin_e * up).max(0.0)
        };
        let (mut sum, mut squares, mut squares_before) = (0.0, 0.0, 0.0);
        let count = 100_000;
        for i in 0..count {
            let share = DVec2::new(f64::from(i) * 0.754_877_666, f64::from(i) * 0.569_840_291).fract_gl();
            let size = DVec2::new(level.columns as f64, level.rows as f64);
            let grid = 4.0 + share * (size - 9.0);
            let at_m = level.map_from_grid(grid);
            let expected = lit(at_m, bicubic(level, grid));
            sum += expected;
            squares += (lit(at_m, level.interpolated_gradient(at_m)) - expected).powi(2);
            squares_before += (lit(at_m, bilinear(level, grid)) - expected).powi(2);
        }
        let mean = sum / f64::from(count);
        let [now, before] = [squares, squares_before].map(|squares: f64| (squares / f64::from(count)).sqrt() / mean);
        println!("Sun from {azimuth_deg}°: RMS {:.2} % of the mean, bilinear {:.2} %", 100.0 * now, 100.0 * before);
        assert!(now < 0.015, "{azimuth_deg}°: {now}");
        assert!(before > 0.05, "{azimuth_deg}°: the bound notices nothing: {before}");
    }
}

/// A plain, and a block of 1 km on it, at postings of 10 m, seen from above by both renderers: all flat ground gets the
/// same light up to the last posting before the cliff.
#[test]
fn flat_ground_beside_a_cliff_stays_flat() {
    let is_high = |at_m: DVec2| (at_m.x > 5.0 && at_m.y > -5.0) || (at_m.x > 65.0 && at_m.y > -75.0);
    let terrain = Grid::square(200.0, 10.0).terrain(&flat_body(), |at_m| if is_high(at_m) { 1000.0 } else { 0.0 });
    let level = terrain.faces[0].levels[0].clone();
    let scene = scenes::scene(terrain);
    let map = map(&flat_body());
    let sun = scenes::sun(&map, 1.0, 20_f64.to_radians());
    let view = scenes::nadir(&map, DVec2::ZERO, 100_000.0, sun).with_optics(scenes::pinhole(97, 97, 25_000.0));
    let level_w_m2 = scenes::SOLAR_IRRADIANCE_W_M2 * 20_f64.to_radians().sin();
    for (renderer, samples) in scenes::samples(&scene, &view) {
        let mut flat = 0;
        for (hit, pixel) in samples.centres.iter().zip(&samples.pixels) {
            let Some(Hit { ground: Ground::Dem { lifted, .. }, .. }) = hit else { continue };
            let (column, row) = level.cell(level.grid_from_map(lifted.truncate())).unwrap();
            let corners = level.corners_m(column, row);
            if corners.iter().any(|height| (height - corners[0]).abs() > 1.0) {
                continue;
            }
            flat += 1;
            let off = f64::from(pixel.irradiance_w_m2) / level_w_m2 - 1.0;
            assert!(off.abs() < 1e-3, "{renderer}: {off} at {lifted}");
        }
        assert!(flat > 4000, "{renderer}: {flat} flat pixels");
    }
}

/// A model of the sphere itself with postings of 1 km: its normals point up, at its edges and corners too.
#[test]
fn the_edge_of_a_model_is_no_slope() {
    let terrain = Grid::square(10_000.0, 1000.0).terrain(&Body::moon(), |_| 0.0);
    let surface = Surface::new(terrain);
    let (face, scene) = (surface.terrain.faces[0].clone(), scenes::scene(surface.terrain.clone()));
    let level = &face.levels[0];
    for index in 0..level.columns * level.rows {
        let lifted = level.lifted_node(index % level.columns, index / level.columns);
        let position = face.map.body_from_lifted(lifted);
        let ground = Ground::Dem { face: 0, level: 0, lifted };
        let normal = planes::normal(&scene, &Hit { ground, position, distance_m: 0.0 }).unit();
        let off_rad = normal.cross(position.vector_m().normalize()).length();
        // Half a posting over the radius, 2.9e-4 rad, is what differences to one side give.
        assert!(off_rad < 3e-6, "{off_rad} rad at {lifted}");
    }
}
