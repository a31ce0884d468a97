//! Craters in images, held against rims projected point by point and against closed forms.

use std::f64::consts::TAU;

use glam::{DMat3, DVec2, DVec3};
use perilune_engine::camera::{Camera as Optics, Distortion};
use perilune_engine::geometry::{Body, Direction, Geodetic, Rotation};
use perilune_engine::labels::{Crater, Ellipse, Landmark, Origin, Rim, Wanted, landmarks};
use perilune_engine::render::{Scene, View, reference};
use perilune_engine::shadow::{Skylines, registry};
use perilune_engine::terrain::Terrain;

use crate::scenes::{Grid, bare, flat_body, map, nadir, pinhole, scene, sun};

fn crater(centre: Geodetic, diameters_m: [f64; 2], azimuth_rad: f64) -> Crater {
    let (depth_m, degradation, buried) = (None, None, false);
    let origin = Origin::Catalogue;
    Crater { id: "c".into(), centre, diameters_m, azimuth_rad, depth_m, degradation, buried, origin }
}

fn seen(scene: &Scene, view: &View, crater: &Crater) -> Option<Landmark> {
    let rim = Rim::of(crater, &scene.surface);
    let shadow = reference::shadow(scene, view, &Skylines::default()).unwrap();
    let wanted = Wanted { smallest_px: 1.0, largest_px: f64::INFINITY, most_degraded: 1.0 };
    landmarks(scene, view, shadow.as_deref(), &[(crater.clone(), rim)], &wanted).pop()
}

/// Map point 0, 0 of the scenes' map.
fn middle() -> Geodetic {
    Geodetic::from_degrees(20.0, 30.0, 0.0)
}

/// The conic through image points: the smallest singular vector of their equations, by power iteration on the inverse of
/// the 6 × 6 normal matrix, with coordinates scaled to about 1. No code of the program but the pixels.
fn fitted(points: &[DVec2]) -> Ellipse {
    let mean = points.iter().copied().sum::<DVec2>() / points.len() as f64;
    let scale = points.iter().map(|p| (*p - mean).length()).fold(0.0, f64::max);
    let mut normal = [[0.0; 6]; 6];
    for point in points {
        let p = (*point - mean) / scale;
        let row = [p.x * p.x, p.x * p.y, p.y * p.y, p.x, p.y, 1.0];
        for i in 0..6 {
            for j in 0..6 {
                normal[i][j] += row[i] * row[j];
            }
        }
    }
    (0..6).for_each(|i| normal[i][i] += 1e-14 * points.len() as f64);
    let mut vector = [1.0, 0.1, 0.9, 0.05, 0.02, -1.0];
    for _ in 0..50 {
        vector = solved(normal, vector);
        let length = vector.iter().map(|v: &f64| v * v).sum::<f64>().sqrt();
        vector.iter_mut().for_each(|v| *v /= length);
    }
    let [a, b, c, d, e, f] = vector;
    // Centre where the gradient vanishes; axes from the eigenvalues.
    let determinant = 4.0 * a * c - b * b;
    let centre = DVec2::new(b * e - 2.0 * c * d, b * d - 2.0 * a * e) / determinant;
    let value = f + (d * centre.x + e * centre.y) / 2.0;
    let (mean_ac, half) = ((a + c) / 2.0, ((a - c) / 2.0).hypot(b / 2.0));
    let mut axes = [mean_ac - half, mean_ac + half].map(|eigenvalue| scale * (-value / eigenvalue).sqrt());
    let mut angle_rad = 0.5 * b.atan2(a - c);
    if axes[0] < axes[1] {
        axes.swap(0, 1);
    } else {
        angle_rad += TAU / 4.0;
    }
    // The eigenvector of the larger |eigenvalue| is the shorter axis.
    let along = |angle_rad: f64| {
        let p = DVec2::from_angle(angle_rad);
        (a * p.x * p.x + b * p.x * p.y + c * p.y * p.y) / -value
    };
    if along(angle_rad) > along(angle_rad + TAU / 4.0) {
        angle_rad += TAU / 4.0;
    }
    Ellipse {
        centre_px: (mean + scale * centre).into(),
        semi_axes_px: axes,
        angle_rad: angle_rad.rem_euclid(TAU / 2.0),
    }
}

/// Gauss with pivots.
fn solved(mut matrix: [[f64; 6]; 6], mut right: [f64; 6]) -> [f64; 6] {
    for i in 0..6 {
        let pivot = (i..6).max_by(|&a, &b| matrix[a][i].abs().total_cmp(&matrix[b][i].abs())).unwrap();
        matrix.swap(i, pivot);
        right.swap(i, pivot);
        let (above, below) = matrix.split_at_mut(i + 1);
        for (j, row) in (i + 1..6).zip(below) {
            let factor = row[i] / above[i][i];
            row.iter_mut().zip(above[i]).for_each(|(element, pivot)| *element -= factor * pivot);
            right[j] -= factor * right[i];
        }
    }
    for i in (0..6).rev() {
        right[i] = (right[i] - (i + 1..6).map(|k| matrix[i][k] * right[k]).sum::<f64>()) / matrix[i][i];
    }
    right
}

/// A camera at a place of the scenes' map, looking at a map point.
fn looking(body: &Body, from_m: DVec3, to_m: DVec2) -> View {
    let map = map(body);
    let place = |at_m: DVec3| {
        map.body_from_lifted(at_m.truncate().extend(map.lifted_height_m(at_m.truncate(), map.radius_m + at_m.z)))
    };
    let (camera, target) = (place(from_m), place(to_m.extend(0.0)));
    let forward = (target.vector_m() - camera.vector_m()).normalize();
    let right = forward.cross(camera.vector_m().normalize()).normalize();
    let view = nadir(&map, from_m.truncate(), from_m.z, sun(&map, 1.0, 0.6));
    View {
        camera_position: camera,
        camera_from_body: Rotation::from_axes(right, forward.cross(right), forward),
        ..view
    }
}

#[test]
fn a_crater_below_a_nadir_camera_is_a_circle_of_known_radius() {
    let body = flat_body();
    let level = Grid::square(1000.0, 20.0).terrain(&body, |_| 0.0);
    let scene = scene(level);
    let map = map(&body);
    // 100 m across 2000 m below: 500 · 50/2000 = 12.5 px; the camera is 160 m west of it: 40 px.
    let view = nadir(&map, DVec2::new(-160.0, 0.0), 2000.0, sun(&map, 1.0, 0.6)).with_optics(pinhole(400, 300, 500.0));
    let found = seen(&scene, &view, &crater(middle(), [100.0; 2], 0.3)).unwrap();
    let [u, v] = found.ellipse.centre_px;
    assert!((u - 239.5).abs() < 1e-3 && (v - 149.5).abs() < 1e-3, "{found:?}");
    // The ground falls away by 1 µm; heights are f32 of 1e9 m: 1e-5 of the height.
    assert!(found.ellipse.semi_axes_px.iter().all(|axis| (axis - 12.5).abs() < 1e-3), "{found:?}");
    assert!((found.diameter_px - 25.0).abs() < 2e-3);
    assert!(!found.truncated && !found.occluded && !found.in_shadow && found.occluded_share == 0.0);
    assert!((found.rim_lit_share - 1.0).abs() < 1e-9 && (found.floor_lit_share - 1.0).abs() < 1e-9);
    // The Sun is 0.6 rad above the horizon; from the side the camera is atan(160/2000) off the normal.
    assert!((found.incidence_deg - (TAU / 4.0 - 0.6).to_degrees()).abs() < 0.01, "{}", found.incidence_deg);
    assert!((found.emission_deg - (0.08f64).atan().to_degrees()).abs() < 0.01, "{}", found.emission_deg);
    assert!((found.conic.value(DVec2::new(239.5 + 12.5, 149.5))).abs() < 1e-3);
}

/// 360 points of the rim through the camera one by one, with and without a lens, and a conic through them. A lens of −20 % at
/// 45° bends rims of up to 50° of view off any ellipse: by what the landmark says.
#[test]
fn conics_go_through_rims_projected_point_by_point() {
    let body = Body::moon();
    // A slope of 0.2 to the east and 0.1 to the north, bent by the Moon.
    let terrain = Grid::square(3000.0, 20.0).terrain(&body, |at_m| 0.2 * at_m.x + 0.1 * at_m.y);
    let ideal = pinhole(800, 600, 700.0);
    let lens = Distortion { radial: [-0.2, 0.05, 0.0, 0.0, 0.0, 0.0], tangential: [1e-3, -5e-4] };
    let bent = ideal.clone().with_distortion(lens).unwrap();
    for (optics, largest_misfit_px) in [(ideal, 0.0), (bent, 0.7)] {
        let scene = scene(terrain.clone());
        for (diameters_m, from_m) in [
            ([600.0, 600.0], DVec3::new(-2500.0, -900.0, 2500.0)),
            ([900.0, 400.0], DVec3::new(300.0, -2800.0, 1500.0)),
            ([1500.0, 1200.0], DVec3::new(0.0, 1500.0, 2600.0)),
        ] {
            let view = looking(&body, from_m, DVec2::new(200.0, -100.0)).with_optics(optics.clone());
            let crater = crater(middle(), diameters_m, 0.7);
            let rim = Rim::of(&crater, &scene.surface);
            let pixel = |k: u32| {
                let p = rim.at(TAU * f64::from(k) / 360.0).vector_m() - view.camera_position.vector_m();
                view.optics.pixel(Direction::new(view.camera_from_body.turn(p)).unwrap()).unwrap()
            };
            let points: Vec<DVec2> = (0..360).map(pixel).collect();
            let found = seen(&scene, &view, &crater).unwrap();
            // Distance of a point from the conic, to first order: value · (semi-axis)/2 at most.
            let worst = points.iter().map(|p| found.conic.value(*p).abs() * found.ellipse.semi_axes_px[0] / 2.0);
            let worst = worst.fold(0.0, f64::max);
            let by_points = fitted(&points);
            let centre = DVec2::from(by_points.centre_px).distance(DVec2::from(found.ellipse.centre_px));
            let turned = (by_points.angle_rad - found.ellipse.angle_rad).sin().abs();
            println!(
                "{diameters_m:?}: off the conic {worst:.1e} px, centre {centre:.1e} px, turned {turned:.1e}; lens {:.3}",
                found.lens_misfit_px
            );
            // What is left over by the affine map bounds all that follows from it.
            let bound_px = 1e-6 + 1.5 * found.lens_misfit_px;
            assert!(worst < bound_px && centre < bound_px, "{worst} {centre}");
            assert!((by_points.semi_axes_px[0] - found.ellipse.semi_axes_px[0]).abs() < bound_px);
            assert!((by_points.semi_axes_px[1] - found.ellipse.semi_axes_px[1]).abs() < bound_px);
            assert!(turned < bound_px);
            assert!(found.lens_misfit_px <= largest_misfit_px);
            // The fit is not blind: a rim of 1 % more is seen to be another.
            let larger = seen(&scene, &view, &Crater { diameters_m: diameters_m.map(|d| 1.01 * d), ..crater }).unwrap();
            assert!((by_points.semi_axes_px[0] - larger.ellipse.semi_axes_px[0]).abs() > 0.5);
        }
    }
}

/// On a plane of slope s the rim's normal is the plane's, and its axes are longer by sec s along the slope.
#[test]
fn a_rim_lies_in_the_plane_of_the_ground() {
    let body = flat_body();
    let terrain = Grid::square(1000.0, 20.0).terrain(&body, |at_m| 0.3 * at_m.x);
    let scene = scene(terrain);
    let rim = Rim::of(&crater(middle(), [200.0; 2], TAU / 4.0), &scene.surface);
    let map = map(&body);
    let normal = map.map_from_body.turn(rim.normal.unit());
    assert!((normal - DVec3::new(-0.3, 0.0, 1.0).normalize()).length() < 1e-4, "{normal}");
    // f32 heights of a body of 1e9 m, 6e-5 m apart on the slope.
    assert!(rim.misfit_m < 1e-3, "{}", rim.misfit_m);
    let [along, across] = rim.axes_m.map(|axis_m| axis_m.length());
    assert!((along - 100.0 * 1.09f64.sqrt()).abs() < 0.01 && (across - 100.0).abs() < 0.01, "{along} {across}");
}

/// A wall of 200 m between the camera and one of two craters, whose shadow falls on the other.
fn walled() -> (Body, Terrain) {
    let body = flat_body();
    let terrain = Grid::square(3000.0, 20.0).terrain(&body, |at_m| if at_m.x.abs() < 15.0 { 200.0 } else { 0.0 });
    (body, terrain)
}

fn at(body: &Body, at_m: DVec2) -> Geodetic {
    let map = map(body);
    body.geodetic_from_position(map.body_from_lifted(at_m.extend(map.lifted_height_m(at_m, map.radius_m))))
}

#[test]
fn a_ridge_hides_the_crater_behind_it_and_shades_the_one_before_it() {
    let (body, terrain) = walled();
    let scene = scene(terrain).with_shadows(registry::reference(Default::default()));
    // The camera is west of the wall, 300 m high; the Sun is in the east, 20° high: shadows of 550 m to the west.
    let view = looking(&body, DVec3::new(-1000.0, 0.0, 300.0), DVec2::new(0.0, 0.0));
    let lights = vec![sun(&map(&body), TAU / 4.0, 20f64.to_radians())];
    let view = View { lights, optics: pinhole(400, 400, 150.0), ..view };
    let place = |x_m: f64| seen(&scene, &view, &crater(at(&body, DVec2::new(x_m, 0.0)), [100.0; 2], 0.0));
    // Hidden behind the wall: over its top the camera sees ground from 2000 m on.
    let hidden = place(400.0).unwrap();
    assert!(hidden.occluded && hidden.occluded_share == 1.0 && !hidden.in_shadow, "{hidden:?}");
    let shaded = place(-300.0).unwrap();
    assert!(!shaded.occluded && shaded.occluded_share == 0.0 && shaded.in_shadow, "{shaded:?}");
    assert!(shaded.rim_lit_share == 0.0 && shaded.floor_lit_share == 0.0);
    let free = place(-800.0).unwrap();
    assert!(!free.occluded && !free.in_shadow && free.rim_lit_share > 0.999, "{free:?}");
    // Ground 2500 m away is seen over the wall.
    let far = place(2500.0).unwrap();
    assert!(!far.occluded, "{far:?}");
}

#[test]
fn craters_beyond_the_limb_or_beside_the_image_are_not_landmarks() {
    let scene = scene(bare(Body::moon()));
    let camera_m = DVec3::new(4e6, 0.0, 0.0);
    let view = crate::scenes::towards_centre(camera_m, vec![crate::scenes::light(DVec3::X)])
        .with_optics(pinhole(600, 600, 300.0));
    let place = |longitude_deg: f64| {
        seen(&scene, &view, &crater(Geodetic::from_degrees(0.0, longitude_deg, 0.0), [100e3; 2], 0.0))
    };
    // The limb is acos(1737.4/4000) = 64.3° away.
    assert!(place(0.0).is_some_and(|near| !near.occluded));
    assert!(place(60.0).is_some());
    assert!(place(80.0).is_none() && place(180.0).is_none());
    let narrow = view.clone().with_optics(pinhole(600, 600, 3000.0));
    assert!(seen(&scene, &narrow, &crater(Geodetic::from_degrees(0.0, 30.0, 0.0), [50e3; 2], 0.0)).is_none());
    // A crater around the whole image is cut by its edges.
    let around = seen(&scene, &narrow, &crater(Geodetic::from_degrees(0.0, 0.0, 0.0), [1500e3; 2], 0.0)).unwrap();
    assert!(around.truncated);
    // It is larger than the image, and may be worn down further than asked for.
    let body = Body::moon();
    let crater = Crater { degradation: Some(0.4), ..crater(Geodetic::from_degrees(0.0, 0.0, 0.0), [1500e3; 2], 0.0) };
    let rim = Rim::of(&crater, &perilune_engine::terrain::Surface::new(bare(body)));
    let craters = [(crater, rim)];
    let listed = |wanted: Wanted| landmarks(&scene, &narrow, None, &craters, &wanted).len();
    let all = Wanted { smallest_px: 1.0, largest_px: around.diameter_px + 1.0, most_degraded: 0.5 };
    assert_eq!(listed(all), 1);
    assert_eq!(listed(Wanted { largest_px: around.diameter_px - 1.0, ..all }), 0);
    assert_eq!(listed(Wanted { most_degraded: 0.3, ..all }), 0);
}

/// Written from Christian et al. (2021) for one crater, with the matrices spelled out.
#[test]
fn the_conic_is_that_of_christian_et_al() {
    let body = Body::moon();
    let scene = scene(bare(body.clone()));
    let camera_m = DVec3::new(2.2e6, 1e5, -2e5);
    let view = crate::scenes::towards_centre(camera_m, vec![crate::scenes::light(DVec3::X)])
        .with_optics(pinhole(1024, 1024, 800.0));
    let centre = Geodetic::from_degrees(1.0, -2.0, 0.0);
    let found = seen(&scene, &view, &crater(centre, [40e3, 30e3], 0.4)).unwrap();

    // E: east, north, up at the crater; p its centre, below the sphere by the sagitta of the rim; T the map of (ξ, η, 1).
    let frame = body.local_from_body(centre).matrix().transpose();
    let arcs = [20e3, 15e3].map(|radius_m: f64| radius_m / 1_737_400.0);
    // The mean height of the rim's points: squares of radii are as often the longer as the shorter axis.
    let sagitta_m = arcs.map(|arc| 1_737_400.0 * (1.0 - arc.cos())).iter().sum::<f64>() / 2.0;
    let p = frame * DVec3::new(0.0, 0.0, 1_737_400.0 - sagitta_m);
    let [a, b] = arcs.map(|arc| (1_737_400.0 - sagitta_m) * arc.sin());
    let (sin, cos) = 0.4f64.sin_cos();
    let (along, across) = (frame * DVec3::new(sin, cos, 0.0), frame * DVec3::new(cos, -sin, 0.0));
    let to_camera = view.camera_from_body.matrix();
    let k = DMat3::from_cols(DVec3::new(800.0, 0.0, 0.0), DVec3::new(0.0, 800.0, 0.0), DVec3::new(511.5, 511.5, 1.0));
    let h = k * to_camera * DMat3::from_cols(along, across, p - camera_m);
    let circle = DMat3::from_diagonal(DVec3::new(1.0 / (a * a), 1.0 / (b * b), -1.0));
    let expected = h.inverse().transpose() * circle * h.inverse();
    // Both are known up to scale.
    let got = DMat3::from_cols_array_2d(&found.conic.0);
    let scale = got.z_axis.z / expected.z_axis.z;
    for (got, expected) in got.to_cols_array().iter().zip((expected * scale).to_cols_array()) {
        // The rim of an ellipse on a sphere is not quite flat: 1e-3 of its sagitta of 100 m, in 500 km.
        assert!((got - expected).abs() < 2e-4 * expected.abs().max(1e-4), "{got} {expected}");
    }
}

#[test]
fn distorted_cameras_state_what_their_lens_does_to_a_rim() {
    let body = flat_body();
    let terrain = Grid::square(1000.0, 20.0).terrain(&body, |_| 0.0);
    let lens = Distortion { radial: [-0.2, 0.0, 0.0, 0.0, 0.0, 0.0], ..Default::default() };
    let optics: Optics = pinhole(400, 400, 800.0).with_distortion(lens).unwrap();
    let scene = scene(terrain);
    let map = map(&body);
    let view = nadir(&map, DVec2::ZERO, 500.0, sun(&map, 1.0, 0.6)).with_optics(optics);
    // About the boresight the lens only shrinks: r (1 − 0.2 r²) with r = 50/500.
    let found = seen(&scene, &view, &crater(middle(), [100.0; 2], 0.0)).unwrap();
    let expected_px = 800.0 * 0.1 * (1.0 - 0.2 * 0.01);
    assert!(found.ellipse.semi_axes_px.iter().all(|axis| (axis - expected_px).abs() < 1e-3), "{found:?}");
    assert!(found.lens_misfit_px < 1e-3);
}
