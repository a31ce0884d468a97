//! Optical flow against closed forms, and against rays cast from the other image.

use glam::{DMat3, DVec2, DVec3};
use perilune_engine::geometry::{Body, Rotation};
use perilune_engine::labels::Flow;
use perilune_engine::render::{Quantity, Renderer, Scene, View};
use perilune_engine::terrain::{Ground, Hit, Terrain};

use crate::scenes::{Grid, flat_body, map, nadir, pinhole, scene, sun};

const FOCAL_PX: f64 = 150.0;
const SIDE: u32 = 100;

fn of(terrain: Terrain) -> Scene {
    scene(terrain)
}

fn above(body: &Body, at_m: DVec2, height_m: f64) -> View {
    let map = map(body);
    nadir(&map, at_m, height_m, sun(&map, 1.0, 0.6))
        .with_optics(pinhole(SIDE, SIDE, FOCAL_PX))
        .with_quantities([Quantity::Flow])
}

fn centres(scene: &Scene, view: &View) -> Vec<Option<Hit>> {
    Renderer::Reference.samples(scene, view).unwrap().centres
}

fn pixel(index: usize) -> DVec2 {
    let side = SIDE as usize;
    DVec2::new((index % side) as f64, (index / side) as f64)
}

fn hills(at_m: DVec2) -> f64 {
    200.0 * (at_m.x / 210.0).sin() * (at_m.y / 170.0).cos()
}

/// Slopes of up to 53°, which hide what is behind them from cameras this low.
fn bumps(at_m: DVec2) -> f64 {
    80.0 * (at_m.x / 60.0).sin() * (at_m.y / 75.0).cos()
}

/// Turning about the pupil moves pixels by `K R K⁻¹`, whatever the ground.
#[test]
fn a_camera_that_turns_moves_all_depths_alike() {
    let body = Body::moon();
    let scene = of(Grid::square(2500.0, 20.0).terrain(&body, hills));
    let view = above(&body, DVec2::ZERO, 2000.0);
    let turn = DMat3::from_axis_angle(DVec3::new(0.2, 0.9, 0.4).normalize(), 0.05);
    let next = View { camera_from_body: Rotation::from_matrix(turn * view.camera_from_body.matrix()), ..view.clone() };
    let flow = Flow::to(&scene, &view, Some(&next), &centres(&scene, &view));
    let middle = DVec2::splat(f64::from(SIDE - 1) / 2.0);
    for index in 0..flow.x_px.len() {
        let turned = turn * ((pixel(index) - middle) / FOCAL_PX).extend(1.0);
        let expected = middle + FOCAL_PX * turned.truncate() / turned.z - pixel(index);
        let got = DVec2::new(flow.x_px[index].into(), flow.y_px[index].into());
        // f32 of some ten pixels.
        assert!((got - expected).length() < 1e-5, "{index}: {got} {expected}");
    }
    assert!(flow.covisible.iter().filter(|seen| **seen == 1.0).count() > 7500);
}

/// Over a plain `Z` below, `t` sideways is `−f t/Z` everywhere; `d` downwards stretches the image about the nadir by `Z/(Z − d)`.
#[test]
fn a_camera_that_moves_over_a_plain_moves_it_by_closed_forms() {
    let body = flat_body();
    let scene = of(Grid::square(2500.0, 20.0).terrain(&body, |_| 0.0));
    let view = above(&body, DVec2::ZERO, 2000.0);
    let seen = centres(&scene, &view);
    let sideways = Flow::to(&scene, &view, Some(&above(&body, DVec2::new(100.0, -60.0), 2000.0)), &seen);
    let middle = DVec2::splat(f64::from(SIDE - 1) / 2.0);
    let down = Flow::to(&scene, &view, Some(&above(&body, DVec2::ZERO, 1600.0)), &seen);
    for index in 0..sideways.x_px.len() {
        let flow = |flow: &Flow| DVec2::new(flow.x_px[index].into(), flow.y_px[index].into());
        // Down in the image is south. A plain of radius 1e9 m falls by 1 mm, turns by 1e-7, and is f32: 1e-4 m.
        assert!((flow(&sideways) - DVec2::new(-7.5, -4.5)).length() < 1e-4, "{index}: {}", flow(&sideways));
        let expected = (pixel(index) - middle) * (2000.0 / 1600.0 - 1.0);
        assert!((flow(&down) - expected).length() < 1e-4, "{index}: {}", flow(&down));
        // A plain hides nothing: what is not seen is off the image.
        let expected = view.optics.contains(pixel(index) + expected);
        assert_eq!(down.covisible[index] == 1.0, expected, "{index}");
    }
}

/// The other image's own ray at the place that the flow tells meets the same ground where it is covisible, and other ground
/// nearer to it where it is not.
#[test]
fn the_next_image_sees_the_same_ground_where_the_flow_leads() {
    let body = Body::moon();
    let scene = of(Grid::square(2500.0, 20.0).terrain(&body, bumps));
    let [view, next] = [(DVec2::new(-700.0, 0.0), 340.0), (DVec2::new(600.0, 200.0), 300.0)].map(|(at_m, height_m)| {
        let view = above(&body, at_m, height_m);
        let forward = (map(&body).map_from_body.inverse().turn(DVec3::new(-at_m.x, 200.0, -150.0))).normalize();
        let right = forward.cross(view.camera_position.vector_m().normalize()).normalize();
        View { camera_from_body: Rotation::from_axes(right, forward.cross(right), forward), ..view }
    });
    let seen = centres(&scene, &view);
    let flow = Flow::to(&scene, &view, Some(&next), &seen);
    let (mut same, mut hidden) = (0, 0);
    for (index, hit) in seen.iter().enumerate() {
        let Some(hit) = hit.as_ref().filter(|hit| hit.ground != Ground::Gap) else { continue };
        let found = pixel(index) + DVec2::new(flow.x_px[index].into(), flow.y_px[index].into());
        if !(found.is_finite() && next.optics.contains(found)) {
            assert!(flow.covisible[index] == 0.0);
            continue;
        }
        let direction = next.camera_from_body.inverse() * next.optics.direction(found).unwrap();
        let met = scene.surface.intersect(next.camera_position, direction).unwrap();
        let apart_m = met.position.distance_m(hit.position);
        let pixel_m = met.distance_m / FOCAL_PX;
        if flow.covisible[index] == 1.0 {
            same += 1;
            // Along a grazing ray a pixel's width of depth is allowed, and f32 of the flow: 1e-5 px.
            assert!(apart_m < 1.5 * pixel_m + 0.01, "{index}: {apart_m} m");
        } else {
            hidden += 1;
            assert!(apart_m > 0.5 * pixel_m, "{index}: {apart_m} m");
            assert!(met.distance_m < next.camera_position.distance_m(hit.position));
        }
    }
    println!("{same} pixels see the same ground, {hidden} other ground");
    assert!(same > 300 && hidden > 300, "{same} {hidden}");
}

#[test]
fn a_wall_hides_what_is_behind_it_from_the_next_exposure() {
    let body = flat_body();
    let scene = of(Grid::square(2500.0, 20.0).terrain(&body, |at_m| if at_m.x.abs() < 15.0 { 300.0 } else { 0.0 }));
    // From above, the ground 400 m east of the wall; then from 1000 m west of the wall, 400 m up, looking east.
    let view = above(&body, DVec2::new(400.0, 0.0), 300.0);
    let low = above(&body, DVec2::new(-1000.0, 0.0), 400.0);
    let map = map(&body);
    let [right, down, forward] = [-DVec3::Y, -DVec3::Z, DVec3::X].map(|axis| map.map_from_body.inverse().turn(axis));
    let next = View { camera_from_body: Rotation::from_axes(right, down, forward), ..low };
    let flow = Flow::to(&scene, &view, Some(&next), &centres(&scene, &view));
    let centre = (SIDE * SIDE / 2 + SIDE / 2) as usize;
    assert!(flow.y_px[centre].is_finite() && flow.covisible[centre] == 0.0);
    // It would be seen if the wall were not there.
    let plain = of(Grid::square(2500.0, 20.0).terrain(&body, |_| 0.0));
    assert_eq!(Flow::to(&plain, &view, Some(&next), &centres(&plain, &view)).covisible[centre], 1.0);
    // The last exposure has no next one.
    assert!(Flow::to(&scene, &view, None, &centres(&scene, &view)).x_px.iter().all(|x| x.is_nan()));
}
