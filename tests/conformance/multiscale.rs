//! Skylines from images of heights: the device against the host, and images lit by both.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use perilune_bench::stability::scenes::{Grid, flat_body};
use perilune_engine::geometry::{Body, Position};
use perilune_engine::gpu::Gpu;
use perilune_engine::render::{Light, Renderer};
use perilune_engine::shadow::multiscale::Multiscale;
use perilune_engine::shadow::multiscale::device::OnDevice;
use perilune_engine::shadow::skylines::Field;
use perilune_engine::shadow::{FieldMaker, QuantizedLight, SkylineSource, Skylines, SurfacePoints};
use perilune_engine::terrain::{Face, Surface, Terrain};

use super::render::{compare, cube, scenes};
use crate::reference::horizon::scene::{cratered, nested};

/// Differences of heights are rounded to 2⁻²⁴ of themselves, places to 1e-6 of a texel no longer than the distance, and so
/// are the 16 weights of a spline: some 1e-6 rad on slopes of 1.
const BOUND_RAD: f64 = 2e-6;

fn moon(face: Face) -> Surface {
    Surface::new(Terrain { body: Body::moon(), faces: vec![face] })
}

/// A light so far from a map's centre of projection, in map axes.
fn light(surface: &Surface, towards: DVec3, distance_m: f64) -> QuantizedLight {
    let vector_m = distance_m * surface.terrain.faces[0].map.map_from_body.inverse().turn(towards.normalize());
    QuantizedLight::new(Position::from_m(vector_m), 0.0047)
}

/// The device's field, behind five others.
fn on_device(
    gpu: &Gpu,
    method: &Multiscale,
    terrain: &Terrain,
    [face, level]: [usize; 2],
    light: &QuantizedLight,
) -> Field {
    let device = OnDevice::new(gpu, method, terrain).unwrap().expect("small images");
    let map = &terrain.faces[face].map;
    let count = SurfacePoints::of(&terrain.faces[face].levels[level]).count();
    let fields = gpu.output("fields", ((5 + count) * size_of::<[f32; 2]>()) as u64);
    device.field(gpu, map, [face, level], light, &fields, 5);
    gpu.read(&fields).unwrap()[5..][..count].to_vec()
}

/// What two fields differ by in the elevations that they are made of: of the middle, and of the outer two.
fn errors_rad(expected: &Field, found: &Field, swath_rad: f64) -> Vec<f64> {
    assert_eq!(expected.len(), found.len());
    let of_node = |(a, b): (&[f32; 2], &[f32; 2])| {
        let [middle, slope] = [0, 1].map(|i| f64::from(a[i]) - f64::from(b[i]));
        // NaN is no small error.
        if middle.is_finite() && slope.is_finite() { middle.abs().max(slope.abs() * swath_rad / 2.0) } else { TAU }
    };
    expected.iter().zip(found).map(of_node).collect()
}

/// Of all levels towards some lights; asserts the bound. A sample within 1e-7 of its distance of a level's edge may be found on
/// either side: one node in 10 000 may have one.
fn assert_agrees(name: &str, gpu: &Gpu, surface: &Surface, lights: &[QuantizedLight]) {
    let terrain = &surface.terrain;
    let (mut errors, mut below) = (Vec::new(), 0);
    for (k, o, swath_rad) in [(4, 2.0, 0.035), (1, 1.0, 0.03), (3, 1.5, 0.7)] {
        let method = Multiscale::new(terrain, k, o, swath_rad);
        for (face, levels) in terrain.faces.iter().enumerate() {
            for (level, light) in
                (0..levels.levels.len()).flat_map(|level| lights.iter().map(move |light| (level, light)))
            {
                let expected = method.field(surface, face, level, light).unwrap();
                let found = on_device(gpu, &method, terrain, [face, level], light);
                below += expected.iter().filter(|[elevation_rad, _]| *elevation_rad < -1e-3).count();
                errors.extend(errors_rad(&expected, &found, swath_rad));
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    let [worst, all] = [1, 1 + errors.len() / 10_000].map(|from_last| errors[errors.len() - from_last]);
    println!("{name}: {worst:.1e}, {all:.1e} rad without ties, {} nodes, {below} look down", errors.len());
    assert!(all < BOUND_RAD, "{name}: {all} rad");
    assert!(below > errors.len() / 100, "{name}: horizons below the horizontal are no test here");
}

#[test]
fn the_device_finds_the_hosts_skylines_on_cratered_ground_about_the_pole() {
    let Some(gpu) = super::gpu() else { return };
    let ground = moon(cratered(120, 5.0, 2));
    // Along a row, where samples lie on the level's edges; below the horizon; near.
    let lights = [(0.0, 0.0, 1e16), (2.0, -0.05, 1.5e11), (4.0, 0.7, 4e8)]
        .map(|(angle_rad, z, distance_m)| light(&ground, DVec2::from_angle(angle_rad).extend(z), distance_m));
    assert_agrees("cratered", gpu, &ground, &lights);
}

#[test]
fn the_device_finds_the_hosts_skylines_on_levels_in_levels_and_round_a_globe() {
    let Some(gpu) = super::gpu() else { return };
    for (name, ground) in [("nested", moon(nested([61, 81, 101]))), ("cube", Surface::new(cube(30)))] {
        assert_agrees(name, gpu, &ground, &[light(&ground, DVec3::new(0.4, 0.9, 0.1), 1.5e11)]);
    }
}

/// Waves 8 km above the sphere, 4000 nodes long, 300 km from the map's centre: what is large is subtracted before it is rounded.
#[test]
fn the_device_finds_the_hosts_skylines_high_up_and_far_out() {
    let Some(gpu) = super::gpu() else { return };
    let grid = Grid { west_m: 3e5, south_m: -2e5, columns: 4000, rows: 9, posting_m: 5.0 };
    let wave_m = |at: DVec2| 8000.0 + 9.0 * (at.x / 21.0).sin() * (at.y / 13.0).cos() + 150.0 * (at.x / 1700.0).sin();
    let ground = Surface::new(grid.terrain(&Body::moon(), wave_m));
    assert_agrees("far", gpu, &ground, &[light(&ground, DVec3::new(0.9, 0.01, -0.1), 1.5e11)]);
}

#[test]
fn a_device_on_other_ground_does_not_find_the_hosts_skylines() {
    let Some(gpu) = super::gpu() else { return };
    let [own, other] = [2, 3].map(|seed| moon(cratered(64, 5.0, seed)));
    let [own_method, other_method] = [&own, &other].map(|ground| Multiscale::new(&ground.terrain, 4, 2.0, 0.035));
    let light = light(&own, DVec3::new(0.4, 0.9, 0.1), 1.5e11);
    let expected = own_method.field(&own, 0, 0, &light).unwrap();
    let mut errors = errors_rad(&expected, &on_device(gpu, &other_method, &other.terrain, [0, 0], &light), 0.035);
    errors.sort_by(f64::total_cmp);
    assert!(errors[errors.len() / 2] > 100.0 * BOUND_RAD, "{}", errors[errors.len() / 2]);
}

/// Two lights, two levels: fields lie where the pass reads them.
#[test]
fn images_lit_through_the_devices_skylines_are_the_references() {
    let Some(gpu) = super::gpu() else { return };
    for (name, mut scene, mut view) in scenes().into_iter().take(2) {
        let swath_rad = 0.035;
        let method = Multiscale::new(&scene.surface.terrain, 4, 2.0, swath_rad);
        scene = scene.with_shadows(Arc::new(method));
        let shadows = scene.shadows.clone();
        let method = shadows.skylines().unwrap();
        assert!(method.on_device(gpu, &scene.surface).unwrap().is_some());
        let sun = view.lights[0].clone();
        let aside =
            glam::DQuat::from_axis_angle(view.camera_position.vector_m().normalize(), 1.0) * sun.position.vector_m();
        view.lights.push(Light { position: Position::from_m(aside), ..sun });
        let mut session = Renderer::on(gpu).session(&scene).unwrap();
        let agreement =
            compare(&view, &Renderer::Reference.samples(&scene, &view).unwrap(), &session.samples(&view).unwrap());
        assert!(agreement.radiance >= 0.999, "{name}: {agreement:?}");

        let lights = view.quantized_lights();
        let expected = Skylines::default().towards(&scene.surface, method, &lights).unwrap();
        let read = session.skylines().unwrap();
        for (light, level) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let fields = [&expected, &read].map(|skylines| skylines.field(light, 0, level));
            let worst_rad = errors_rad(fields[0], fields[1], swath_rad).into_iter().fold(0.0, f64::max);
            assert!(worst_rad < BOUND_RAD, "{name}, light {light}, level {level}: {worst_rad} rad");
        }
    }
}

/// Thirds of a metre have no last digit: on the edge of its level a node is still on it.
#[test]
fn a_level_holds_its_outermost_nodes_wherever_it_lies() {
    for third in [1.0 / 3.0, 0.7, 1.1] {
        let grid = Grid { west_m: -1234.567 * third, south_m: 98.765 * third, columns: 30, rows: 20, posting_m: third };
        let ground = Surface::new(grid.terrain(&flat_body(), |_| 0.0));
        let method = Multiscale::new(&ground.terrain, 4, 2.0, 0.035);
        let field = method.field(&ground, 0, 0, &light(&ground, DVec3::X, 1.5e11)).unwrap();
        assert!(field.iter().all(|[elevation_rad, _]| elevation_rad.abs() < 1e-5));
    }
}
