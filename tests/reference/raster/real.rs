//! Measured elevation models, where they are present.

use glam::DVec2;
use perilune_engine::geometry::{Body, Geodetic, Position};
use perilune_engine::raster::{Dem, Options};
use perilune_engine::terrain::build::MAX_NODES_PER_SIDE;
use perilune_engine::terrain::{NestedDem, build_cube, build_face};

use super::models::*;
use crate::fixtures::data;

/// Against `gdallocationinfo`, which reads the pixel under a latitude and longitude.
#[test]
fn site01_heights_are_what_gdallocationinfo_reads() {
    let Some(path) = data("dem/site01_connecting_ridge_10m_1600.tif") else { return };
    let dem = open(&path);
    for (column, row) in [(10, 20), (800, 800), (333, 1444), (1590, 7), (1200, 640)] {
        let centre = DVec2::new(f64::from(column), f64::from(row));
        let (x, y) = (-19_000.0 + 10.0 * (centre.x + 0.5), -4_000.0 - 10.0 * (centre.y + 0.5));
        // South polar stereographic in closed form: x = ρ sin λ, y = ρ cos λ.
        let latitude_deg = -90.0 + 2.0 * (f64::hypot(x, y) / (2.0 * R)).atan().to_degrees();
        let longitude_deg = x.atan2(y).to_degrees();
        let by_map = ["-valonly", "-geoloc", path.to_str().unwrap(), &x.to_string(), &y.to_string()];
        let Some(expected) = gdal("gdallocationinfo", &by_map) else { return };
        let expected: f64 = expected.trim().parse().unwrap();
        let got = height_at(&dem, latitude_deg, longitude_deg);
        assert!((got - expected).abs() < 0.05, "{got} {expected}");
    }
}

#[test]
fn site01_nests_in_the_polar_cap_and_the_cap_in_the_globe() {
    let names = ["site01_connecting_ridge_10m_1600.tif", "southcap_240m_1536.tif", "moon_gld100_16ppd_global.tif"];
    let Some(paths) = names.into_iter().map(data).collect::<Option<Vec<_>>>() else { return };
    let dems: Vec<Dem> = paths.iter().map(|path| open(path)).collect();
    let nested: Vec<NestedDem> = dems.iter().map(NestedDem::whole).collect();
    let centre = Geodetic::from_degrees(-89.463, -137.49, 0.0);
    let (pair, errors) = build_face(&Body::moon(), centre, &nested[..2], MAX_NODES_PER_SIDE).unwrap();
    let [fine, cap] = &pair.levels[..] else { panic!("two levels") };
    assert!((fine.posting_m, cap.posting_m) == (10.0, 240.0));
    // The map is turned with the models' common grid: the cap keeps its own size, up to the stretch of the map
    // away from its centre and the half pixel that it lies off the fine one's lattice.
    assert!(cap.columns.abs_diff(1536) < 16 && cap.rows.abs_diff(1536) < 16, "{} × {}", cap.columns, cap.rows);
    assert!(!fine.gap.contains(&true));
    let sides = (0..fine.rows).map(|row| (row, 0)).chain((0..fine.columns).map(|column| (fine.rows - 1, column)));
    for (row, column) in sides {
        let under = cap.bilinear_m(cap.grid_from_map(fine.node_m(column, row))).unwrap();
        assert!((fine.height_m(column, row) - under).abs() < 1e-3);
    }
    println!("{errors:?}");
    assert!(errors[0].rms_m < 0.1 && errors[0].samples > 200_000, "{errors:?}");

    let (triple, _) = build_face(&Body::moon(), centre, &nested, MAX_NODES_PER_SIDE).unwrap();
    assert_eq!(triple.levels[2].posting_m, 1920.0);
    assert!(triple.levels.iter().all(|level| !level.gap.contains(&true)), "the globe fills the corners of the cap");
    let edge_m = triple.levels[2].node_m(0, 0);
    assert!(edge_m.x.min(edge_m.y) < -0.99 * R, "the map ends at 45 degrees");
}

#[test]
fn gale_builds_on_a_spheroid() {
    let Some(path) = data("dem/mars_gale_hirise_1m_348x337.tif") else { return };
    let dem = Dem::open(&path, &Body::mars(), &Options::default()).unwrap();
    let middle = DVec2::new(174.0, 168.0);
    let centre = Body::mars().geodetic_from_position(dem.points(&Body::mars(), &[middle]).unwrap()[0]);
    let (face, errors) = build_face(&Body::mars(), centre, &[NestedDem::whole(&dem)], MAX_NODES_PER_SIDE).unwrap();
    let level = &face.levels[0];
    eprintln!("{} x {} at {}, {errors:?}", level.columns, level.rows, level.posting_m);
    assert_eq!((level.columns, level.rows), (346, 335), "348 columns shrink by cos 4.67 deg");
    assert!(level.heights_m.iter().all(|height| (-5000.0..-4000.0).contains(height)));
    assert!(errors[0].rms_m < 0.1, "{errors:?}");
    let node = face.map.body_from_lifted(level.lifted_node(level.columns / 2, level.rows / 2));
    let there = Body::mars().geodetic_from_position(node);
    let pixel = dem.georeference.projector().unwrap().pixels(&[node])[0];
    assert!((there.height_m - dem.height_m(pixel)).abs() < 1e-3, "{there:?}");
}

#[test]
fn the_global_model_builds_a_cube() {
    let Some(path) = data("dem/moon_gld100_16ppd_global.tif") else { return };
    let options = Options { posting_m: Some(8000.0), ..Options::default() };
    let dem = Dem::open(&path, &Body::moon(), &options).unwrap();
    let centre = Geodetic::from_degrees(-89.0, 10.0, 0.0);
    let (faces, error) = build_cube(&Body::moon(), centre, &dem, 8000.0, 300_000.0, MAX_NODES_PER_SIDE).unwrap();
    // What the Moon's relief does within 8 km: bilinear nodes cannot hold it.
    assert!(error.rms_m < 200.0, "{error:?}");
    assert!(faces.iter().all(|face| !face.levels[0].gap.contains(&true)));
    // Heights of the Moon lie between −9.2 and 10.8 km.
    for face in &faces {
        let level = &face.levels[0];
        for index in (0..level.heights_m.len()).step_by(97) {
            let lifted = level.lifted_node(index % level.columns, index / level.columns);
            let point: Position<_> = face.map.body_from_lifted(lifted);
            assert!((-9_300.0..10_900.0).contains(&(point.vector_m().length() - R)));
        }
    }
}
