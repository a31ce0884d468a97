//! Horizons printed by other programs.

use std::path::Path;
use std::process::Command;

use glam::DVec2;
use perilune_engine::horizon::Settings;
use perilune_engine::horizon::settings::direction;
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::terrain::Level;

use super::scene::{face, flat_map, level, lunar_map};
use crate::fixtures::data;

/// A 1000 m wall everywhere beyond 5000 m, on a sphere of 6371 km: GRASS and the closed form of its distance.
#[test]
fn a_ring_wall_stands_as_high_as_grass_prints() {
    let Some(path) = data("horizon_reference/ring_with_curvature.csv") else { return };
    let table = std::fs::read_to_string(path).unwrap();
    let map = perilune_engine::terrain::Gnomonic { radius_m: 6_371_000.0, ..lunar_map() };
    let ring = |at: DVec2| if at.length() >= 5000.0 { 1000.0 } else { 0.0 };
    let face = face(map.clone(), vec![level(&map, 1101, 10.0, DVec2::ZERO, ring)]);
    let settings = Settings::default();
    let tracer = Tracer::new(&face, &settings);
    let rows: Vec<Vec<f64>> = (table.lines().skip_while(|line| !line.starts_with('0')))
        .map(|line| line.split(',').map(|word| word.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 9);
    for row in rows {
        let [azimuth_deg, horizon_rad, distance_m] = row[..] else { panic!("three columns") };
        // Counter-clockwise from east.
        let azimuth_rad = (90.0 - azimuth_deg).to_radians();
        let skyline = tracer.skyline(face.levels[0].lifted_node(550, 550), direction(azimuth_rad));
        // The wall's top edge lies up to a cell's diagonal beyond 5000 m: 1000 m · 14 m/(5000 m)²; GRASS takes the
        // nearest cell, half a diagonal off.
        assert!((skyline.elevation_rad - horizon_rad).abs() < 6e-4, "{azimuth_deg}: {skyline:?} {horizon_rad}");
        assert!((skyline.distance_m - distance_m).abs() < 14.2, "{azimuth_deg}: {skyline:?} {distance_m}");
        let d = skyline.distance_m;
        let closed_form_rad = ((1000.0 - d * d / (2.0 * 6_371_000.0)) / d).atan();
        // The closed form's own parabola: 1000 m h/R over 5 km.
        assert!((skyline.elevation_rad - closed_form_rad).abs() < 4e-5, "{azimuth_deg}: {skyline:?} {closed_form_rad}");
    }
}

/// The members of an .npz archive as little-endian bytes, unpacked by Python.
fn unpacked(path: &Path, member: &str) -> Option<Vec<u8>> {
    let script = "import sys, zipfile; sys.stdout.buffer.write(zipfile.ZipFile(sys.argv[1]).read(sys.argv[2]))";
    let output = Command::new("python3").args(["-c", script]).arg(path).arg(member).output().ok()?;
    // An .npy file: magic, version, header length, header, data.
    let header = usize::from(u16::from_le_bytes([*output.stdout.get(8)?, *output.stdout.get(9)?]));
    output.stdout.get(10 + header..).map(<[u8]>::to_vec)
}

/// IPW skips the adjacent cell: low by more than 0.05° on a third of the cells, never high. At azimuths other than these it skews
/// the grid by whole cells and is off both ways.
#[test]
fn the_lakes_horizons_are_those_of_ipw() {
    let Some(path) = data("horizon_reference/lakes_horizons_deg.npz") else { return };
    let members: Option<Vec<_>> =
        ["dem.npy", "az.npy", "hor.npy"].iter().map(|member| unpacked(&path, member)).collect();
    let Some(members) = members else {
        println!("skipped: python3 is needed to unpack {}", path.display());
        return;
    };
    let dem: Vec<f64> = members[0].chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    let azimuths_deg: Vec<i64> =
        members[1].chunks_exact(8).map(|b| i64::from_le_bytes(b.try_into().unwrap())).collect();
    let horizons: Vec<f32> = members[2].chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect();
    let (rows, columns) = (168, 156);
    let map = flat_map();
    let lakes = Level {
        columns,
        rows,
        posting_m: 50.0,
        west_m: 0.0,
        south_m: 0.0,
        heights_m: dem.iter().map(|h| *h as f32).collect(),
        gap: vec![false; rows * columns],
        margin: 0,
    };
    let face = face(map, vec![lakes]);
    let settings = Settings::default();
    let tracer = Tracer::new(&face, &settings);
    let mut errors_deg = Vec::new();
    for (i, azimuth_deg) in azimuths_deg.iter().enumerate().filter(|(_, azimuth_deg)| **azimuth_deg % 90 == 0) {
        // 0 is towards growing row, here up the map; +90 towards growing column.
        let towards = direction((*azimuth_deg as f64).to_radians());
        for row in (4..rows - 4).step_by(3) {
            for column in (4..columns - 4).step_by(3) {
                let theirs_deg = f64::from(horizons[(i * rows + row) * columns + column]);
                let ours_deg =
                    tracer.skyline(face.levels[0].lifted_node(column, row), towards).elevation_rad.to_degrees();
                // They clamp at the horizontal.
                errors_deg.push(theirs_deg - ours_deg.max(0.0));
            }
        }
    }
    errors_deg.sort_by(f64::total_cmp);
    let quantile = |share: f64| errors_deg[(errors_deg.len() as f64 * share) as usize];
    println!("median {} p99 {} max {}", quantile(0.5), quantile(0.99), errors_deg[errors_deg.len() - 1]);
    assert!(quantile(0.5).abs() < 2e-3, "median {}", quantile(0.5));
    assert!(quantile(0.99) < 0.02, "p99 {}", quantile(0.99));
}
