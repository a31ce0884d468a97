//! Levels of lifted heights built from models in closed form.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use perilune_engine::geometry::{Body, Geodetic};
use perilune_engine::raster::{Around, Dem, Options};
use perilune_engine::terrain::build::MAX_NODES_PER_SIDE;
use perilune_engine::terrain::{Face, NestedDem, build_cube, build_face};

use super::models::*;

/// Hard cases 23 and 24: a smooth hill at 60 degrees is the same on every map of it.
#[test]
fn the_same_hill_at_60_degrees_is_the_same_from_every_projection() {
    let folder = tempfile::tempdir().unwrap();
    let (latitude_rad, longitude_rad) = (60f64.to_radians(), 25f64.to_radians());
    let summit = direction(latitude_rad, longitude_rad);
    // A cone of 30 degrees with a rounded tip, by distance along the ground.
    let height = |d: DVec3| {
        let ground_m = R * d.cross(summit).length().atan2(d.dot(summit));
        3000.0 - 30f64.to_radians().tan() * (ground_m * ground_m + 400.0 * 400.0).sqrt()
    };
    let projections = [
        (Projection::Equirectangular, 10.0),
        (Projection::PolarStereographic, 10.0),
        (Projection::Orthographic { latitude_rad: 1.03, longitude_rad: 0.44 }, 10.0),
        (Projection::Gnomonic { latitude_rad, longitude_rad }, 10.0),
    ];
    for (projection, pixel_m) in projections {
        let path = folder.path().join("cone.tif");
        Model::about(projection, projection.map(latitude_rad, longitude_rad), 300, pixel_m).write(&path, height);
        let dem = open(&path);
        let nested = NestedDem { dem: &dem, posting_m: Some(20.0), extent_m: Some(2400.0) };
        let centre = Geodetic { latitude_rad, longitude_east_rad: longitude_rad, height_m: 0.0 };
        let (face, _) = build_face(&Body::moon(), centre, &[nested], MAX_NODES_PER_SIDE).unwrap();
        let level = &face.levels[0];
        assert!(level.columns >= 119 && !level.gap.contains(&true), "{}", projection.proj4());
        for row in 0..level.rows {
            for column in 0..level.columns {
                let lifted = level.lifted_node(column, row);
                let direction = face.map.body_from_lifted(lifted).vector_m().normalize();
                let got = face.map.radius_from_lifted_m(lifted) - R;
                // Keys' interpolation errs by h³ times a third derivative: (20 m)³/(400 m)² here, a few mm.
                assert!((got - height(direction)).abs() < 0.01, "{} {got}", projection.proj4());
            }
        }
    }
}

/// Levels of a small part of a model are the same to the last bit when only that part is read.
#[test]
fn reading_only_what_an_extent_needs_changes_no_height() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rough.tif");
    let model = Model::about(Projection::PolarStereographic, DVec2::new(3000.0, -500.0), 400, 20.0);
    model.write(&path, |d| 500.0 * (d * 9e3).sin().x);
    // In the middle, and near a corner where the window is cut.
    for (x_m, y_m) in [(3000.0, -500.0), (10_700.0, 7_200.0)] {
        let point = Dem::open(&path, &Body::moon(), &Options::default()).unwrap();
        let pixel = DVec2::new((x_m - 3000.0) / 20.0 + 399.5, 399.5 - (y_m + 500.0) / 20.0);
        let centre = point.georeference.projector().unwrap().geodetics(&[pixel])[0];
        for posting_m in [None, Some(60.0)] {
            let around = Some(Around { centre, distance_m: 500.0 * 2f64.sqrt() });
            let [whole, part] = [None, around].map(|around| {
                Dem::open(&path, &Body::moon(), &Options { posting_m, around, ..Options::default() }).unwrap()
            });
            assert!(part.columns * 2 < whole.columns, "{} of {}", part.columns, whole.columns);
            let [whole, part] = [&whole, &part].map(|dem| {
                let nested = NestedDem { dem, posting_m, extent_m: Some(1000.0) };
                build_face(&Body::moon(), centre, &[nested], MAX_NODES_PER_SIDE).unwrap().0
            });
            assert_eq!(whole.levels[0].heights_m, part.levels[0].heights_m);
            assert_eq!(whole.levels[0].gap, part.levels[0].gap);
        }
    }
}

/// A model on the level's own grid is taken over to the last bit that `f32` leaves.
#[test]
fn a_gnomonic_model_about_the_centre_is_taken_over_sample_by_sample() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rough.tif");
    let (latitude_rad, longitude_rad) = ((-85f64).to_radians(), 0.6);
    let model = Model::about(Projection::Gnomonic { latitude_rad, longitude_rad }, DVec2::ZERO, 64, 20.0);
    model.write(&path, |d| 500.0 * (d * 9e4).sin().x);
    let dem = open(&path);
    let centre = Geodetic { latitude_rad, longitude_east_rad: longitude_rad, height_m: 0.0 };
    let (face, errors) = build_face(&Body::moon(), centre, &[NestedDem::whole(&dem)], MAX_NODES_PER_SIDE).unwrap();
    let level = &face.levels[0];
    assert_eq!((level.columns, level.rows, level.posting_m), (128, 128, 20.0));
    for (index, sample) in dem.heights_m.iter().enumerate() {
        let (column, row) = (index % 128, 127 - index / 128);
        let got = face.map.radius_from_lifted_m(level.lifted_node(column, row)) - R;
        assert!((got - f64::from(*sample)).abs() < 4e-5, "half a unit in the last place of 500 m: {got} {sample}");
    }
    assert!(errors[0].max_m < 4e-5 && errors[0].samples > 16_000, "{errors:?}");
    // Two such units over 20 m.
    assert!(errors[0].rms_slope_deg < 2e-4, "{errors:?}");
    // Waves of 121 m at postings of 40 m: the slopes that are left out are told.
    let coarse = NestedDem { posting_m: Some(40.0), ..NestedDem::whole(&dem) };
    let (_, errors) = build_face(&Body::moon(), centre, &[coarse], MAX_NODES_PER_SIDE).unwrap();
    assert!(errors[0].rms_slope_deg > 10.0, "{errors:?}");
}

#[test]
fn a_pole_inside_a_polar_raster_is_a_point_like_any_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("polar.tif");
    let plane = |d: DVec3| 1e5 * d.x - 5e4 * d.y;
    Model::about(Projection::PolarStereographic, DVec2::ZERO, 100, 100.0).write(&path, plane);
    let dem = open(&path);
    let centre = Geodetic::from_degrees(90.0, 0.0, 0.0);
    let (face, errors) = build_face(&Body::moon(), centre, &[NestedDem::whole(&dem)], 400).unwrap();
    let level = &face.levels[0];
    assert!(level.columns >= 198 && !level.gap.contains(&true));
    for (column, row) in [(0, 0), (100, 99), (99, 100), (level.columns - 1, 7)] {
        let point = face.map.body_from_lifted(level.lifted_node(column, row)).vector_m();
        assert!((point.length() - R - plane(point.normalize())).abs() < 1e-3);
    }
    // A grid of its own spacing, so that samples fall on nodes but for the stretch of the map.
    assert!(errors[0].rms_m < 1e-3, "{errors:?}");
}

/// Hard case 27: a hole is a gap with the heights around it, and far from it nothing changes.
#[test]
fn a_hole_is_a_gap_without_a_cliff() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hole.tif");
    let model = Model::about(Projection::Gnomonic { latitude_rad: 0.3, longitude_rad: 0.5 }, DVec2::ZERO, 50, 10.0);
    let hole = direction(0.3, 0.5);
    model.write(&path, |d| if R * d.distance(hole) < 100.0 { f64::NAN } else { 700.0 });
    let dem = open(&path);
    let centre = Geodetic { latitude_rad: 0.3, longitude_east_rad: 0.5, height_m: 0.0 };
    let (face, _) = build_face(&Body::moon(), centre, &[NestedDem::whole(&dem)], 400).unwrap();
    let level = &face.levels[0];
    let gaps = level.gap.iter().filter(|gap| **gap).count();
    assert!((gaps as f64 - PI * 100.0).abs() < 20.0, "area of the hole in nodes: {gaps}");
    for row in 0..level.rows {
        for column in 0..level.columns {
            let height = face.map.radius_from_lifted_m(level.lifted_node(column, row)) - R;
            assert!((height - 700.0).abs() < 1e-3, "{height}");
        }
    }
}

/// A fine model of another height and roughness than the coarse one under it.
#[test]
fn nested_levels_meet_without_a_crack() {
    let folder = tempfile::tempdir().unwrap();
    let (fine_path, coarse_path) = (folder.path().join("fine.tif"), folder.path().join("coarse.tif"));
    let (latitude_rad, longitude_rad) = (-1.5, 2.0);
    let waves = |d: DVec3| 300.0 * (d * 2e3).sin().x + 30.0 * (d * 2.3e4).sin().y;
    let stere = Projection::Gnomonic { latitude_rad: -1.49, longitude_rad: 2.1 };
    let middle = stere.map(latitude_rad, longitude_rad);
    Model::about(stere, middle, 200, 20.0).write(&fine_path, |d| waves(d) + 4.0);
    Model::about(stere, middle, 150, 240.0).write(&coarse_path, waves);
    let (fine, coarse) = (open(&fine_path), open(&coarse_path));
    let centre = Geodetic { latitude_rad, longitude_east_rad: longitude_rad, height_m: 0.0 };
    let dems = [NestedDem::whole(&fine), NestedDem::whole(&coarse)];
    let (face, _) = build_face(&Body::moon(), centre, &dems, MAX_NODES_PER_SIDE).unwrap();
    let [fine, coarse] = &face.levels[..] else { panic!("two levels") };
    assert_eq!(coarse.posting_m, 12.0 * fine.posting_m);
    let offset = (fine.node_m(0, 0) - coarse.node_m(0, 0)) / fine.posting_m;
    assert!((offset - offset.round()).length() < 1e-6, "one lattice");
    let mut inner: f64 = 0.0;
    for row in 0..fine.rows {
        for column in 0..fine.columns {
            let under = coarse.bilinear_m(coarse.grid_from_map(fine.node_m(column, row))).unwrap();
            let step = (fine.height_m(column, row) - under).abs();
            let border = column == 0 || row == 0 || column == fine.columns - 1 || row == fine.rows - 1;
            assert!(!border || step < 1e-3, "border stands {step} m off");
            inner = inner.max(step);
        }
    }
    assert!(inner > 4.0, "the fine level has its own heights inside: {inner}");
    assert!(!fine.gap.contains(&true), "corners outside the turned fine model rest on coarse data");
}

#[test]
fn a_level_too_large_says_what_would_fit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.tif");
    Model::about(Projection::PolarStereographic, DVec2::ZERO, 50, 10.0).write(&path, |_| 0.0);
    let dem = open(&path);
    let build = |nested| build_face(&Body::moon(), Geodetic::from_degrees(90.0, 0.0, 0.0), &[nested], 50);
    let message = build(NestedDem::whole(&dem)).unwrap_err().to_string();
    assert!(message.contains("posting_m = 20 or extent_m = 490 fits"), "{message}");
    // 100 pixels are 100 nodes at most.
    assert!(build_face(&Body::moon(), Geodetic::from_degrees(90.0, 0.0, 0.0), &[NestedDem::whole(&dem)], 100).is_ok());
    assert!(build(NestedDem { posting_m: Some(20.0), ..NestedDem::whole(&dem) }).is_ok());
    assert!(build(NestedDem { extent_m: Some(490.0), ..NestedDem::whole(&dem) }).is_ok());
}

#[test]
fn levels_out_of_step_or_apart_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dem.tif");
    Model::about(Projection::PolarStereographic, DVec2::ZERO, 50, 10.0).write(&path, |_| 0.0);
    let dem = open(&path);
    let whole = NestedDem::whole(&dem);
    let at_pole = Geodetic::from_degrees(90.0, 0.0, 0.0);
    let build = |centre, dems: &[NestedDem]| build_face(&Body::moon(), centre, dems, 400).map(|_| ());
    let message = |result: Result<(), _>| format!("{}", result.unwrap_err());
    assert!(message(build(at_pole, &[])).contains("at least one"));
    assert!(message(build(at_pole, &[whole, whole])).contains("whole multiple"));
    let uneven = NestedDem { posting_m: Some(25.0), ..whole };
    assert!(message(build(at_pole, &[whole, uneven])).contains("posting_m = 25 is not a whole multiple"));
    let negative = NestedDem { posting_m: Some(-1.0), ..whole };
    assert!(message(build(at_pole, &[negative])).contains("posting_m = -1"));
    let elsewhere = Geodetic::from_degrees(10.0, 0.0, 0.0);
    assert!(build(elsewhere, &[whole]).is_err());
}

/// Every pair of neighbouring faces has the same points along its edge.
#[test]
fn faces_of_a_cube_share_their_edges() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("global.tif");
    let (columns, pixel) = (720, PI * R / 360.0);
    let geotransform = [0.0, pixel, 0.0, PI / 2.0 * R, 0.0, -pixel];
    let bump = |d: DVec3| 2000.0 * (5.0 * d.x).sin() + 500.0 * d.y * d.z;
    Model { projection: Projection::Equirectangular, columns, rows: 360, geotransform }.write(&path, bump);
    let centre = Geodetic::from_degrees(20.0, 30.0, 0.0);
    let (faces, error) = build_cube(&Body::moon(), centre, &open(&path), 40_000.0, 300_000.0, 400).unwrap();
    let edge_points = |face: &Face| {
        let level = &face.levels[0];
        let (low, high) = (level.margin, level.columns - 1 - level.margin);
        let at = |column, row| face.map.body_from_lifted(level.lifted_node(column, row)).vector_m();
        (low..=high)
            .flat_map(|along| [at(along, low), at(along, high), at(low, along), at(high, along)])
            .collect::<Vec<DVec3>>()
    };
    let points: Vec<DVec3> = faces.iter().flat_map(edge_points).collect();
    for point in &points {
        let twins = points.iter().filter(|other| other.distance(*point) < 0.01).count();
        // Twelve edges are held by two faces; a corner by three, each of which lists it twice.
        assert!(twins == 2 || twins == 6, "{twins} points at {point}");
    }
    for face in &faces {
        let level = &face.levels[0];
        assert!(level.margin as f64 * level.posting_m >= 300_000.0 && !level.gap.contains(&true));
        let corner = face.map.body_from_lifted(level.lifted_node(level.margin, level.margin)).vector_m();
        // Keys on half-degree pixels, and a lifted height of −1272 km in f32 (0.06 m).
        assert!((corner.length() - R - bump(corner.normalize())).abs() < 0.2);
    }
    // Bilinear in H is not bilinear in radius: posting²/(8R) in each direction, 230 m at 40 km.
    assert!(error.samples > 200_000 && error.max_m < 240.0, "{error:?}");
}
