//! Training, validation and test by place.
//!
//! ```text
//! row = ⌊R (φ + π/2) / cell⌋      column = ⌊n λ / 2π⌋,  n = ⌈2π R cos φ_row / cell⌉
//! part = first whose share, added up, exceeds  SHA-256(seed, row, column) / 2²⁵⁶
//! ```
//!
//! Rows of cells run around the body, about as wide as high at every latitude, with no seam but longitude 0. The cell is that
//! of the ground under the boresight, or of the place below the camera where it looks past the body. Nothing else enters: the
//! same place is in the same part in every dataset with the same cells, seed and shares.
//!
//! # Assumptions
//! Images of neighbouring cells in different parts overlap where they show more than their cell: the dataset's card says how
//! large both are.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DVec2, DVec3};

use crate::camera::Camera as Optics;
use crate::dataset::SplitRecord;
use crate::digest::sha256_hex;
use crate::geometry::{Body, Geodetic};
use crate::render::{Scene, View};
use crate::scenario::Split;

/// The part of a view.
pub fn part(split: &Split, scene: &Scene, view: &View) -> SplitRecord {
    let surface = &scene.surface;
    let boresight = crate::geometry::Direction::new(view.camera_from_body.inverse().turn(DVec3::Z));
    let hit = boresight.and_then(|towards| surface.intersect(view.camera_position, towards));
    let place = hit.map_or(view.camera_position, |hit| hit.position);
    let body = &surface.terrain.body;
    let cell = cell(body, body.geodetic_from_position(place), split.cell_m);
    let shown_m = hit.map_or(0.0, |hit| 2.0 * hit.distance_m * (0.5 * diagonal_rad(&view.optics)).tan());
    SplitRecord { part: part_of(split, cell).into(), cell, shown_m }
}

/// Between the outer corners of the image.
fn diagonal_rad(optics: &Optics) -> f64 {
    let (columns, rows) = (f64::from(optics.columns), f64::from(optics.rows));
    let corner = |x: f64, y: f64| optics.direction(DVec2::new(x, y) - 0.5);
    corner(0.0, 0.0).zip(corner(columns, rows)).map_or(0.0, |(a, b)| a.angle_to(b))
}

fn cell(body: &Body, place: Geodetic, cell_m: f64) -> [u64; 2] {
    let radius_m = body.equatorial_radius_m;
    let row = (radius_m * (place.latitude_rad + FRAC_PI_2) / cell_m).floor().max(0.0);
    let middle_rad = (row + 0.5) * cell_m / radius_m - FRAC_PI_2;
    let columns = (TAU * radius_m * middle_rad.cos().max(0.0) / cell_m).ceil().max(1.0);
    let column = (columns * place.longitude_east_rad.rem_euclid(TAU) / TAU).floor().min(columns - 1.0);
    [row as u64, column as u64]
}

fn part_of(split: &Split, [row, column]: [u64; 2]) -> &'static str {
    let digest = sha256_hex(format!("{} {row} {column}", split.seed).as_bytes());
    // 52 bits: all that the mantissa of a number in [0, 1) holds.
    let drawn = u64::from_str_radix(&digest[..13], 16).expect("hexadecimal digits") as f64 / 2_f64.powi(52);
    match drawn {
        drawn if drawn < split.train => "train",
        drawn if drawn < split.train + split.validation => "validation",
        _ => "test",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPLIT: Split = Split { train: 0.7, validation: 0.2, test: 0.1, cell_m: 10_000.0, seed: 4 };

    fn cell_at(latitude_deg: f64, longitude_deg: f64) -> [u64; 2] {
        cell(&Body::moon(), Geodetic::from_degrees(latitude_deg, longitude_deg, 0.0), SPLIT.cell_m)
    }

    /// A degree of latitude is 30.3 km.
    #[test]
    fn cells_are_about_as_wide_as_high_everywhere() {
        for latitude_deg in [-89.0, -60.0, 0.0, 45.0, 89.5_f64] {
            let columns =
                (0..36_000).map(|i| cell_at(latitude_deg, f64::from(i) / 100.0)).fold(Vec::new(), |mut seen, cell| {
                    if !seen.contains(&cell) {
                        seen.push(cell);
                    }
                    seen
                });
            let around_m = TAU * 1_737_400.0 * latitude_deg.to_radians().cos();
            let width_m = around_m / columns.len() as f64;
            assert!((width_m / SPLIT.cell_m - 1.0).abs() < 0.3, "{width_m} m at {latitude_deg}°");
        }
        assert_eq!(cell_at(10.0, 359.99)[0], cell_at(10.0, -0.01)[0]);
        assert_eq!(cell_at(10.0, 359.99), cell_at(10.0, -0.01));
    }

    /// Of 10 000 cells each share is met within four standard deviations, √(0.7 · 0.3 · 10⁴) = 46 at most.
    #[test]
    fn parts_have_their_shares() {
        let count = |name: &str| (0..10_000).filter(|i| part_of(&SPLIT, [i / 100, i % 100]) == name).count() as f64;
        assert!((count("train") - 7000.0).abs() < 184.0, "{}", count("train"));
        assert!((count("validation") - 2000.0).abs() < 160.0);
        assert!((count("test") - 1000.0).abs() < 120.0);
    }

    #[test]
    fn another_seed_draws_anew() {
        let other = Split { seed: 5, ..SPLIT };
        let differ = (0..1000).filter(|i| part_of(&SPLIT, [*i, 0]) != part_of(&other, [*i, 0])).count();
        // 1 − 0.7² − 0.2² − 0.1² = 46 %.
        assert!((380..540).contains(&differ), "{differ}");
    }
}
