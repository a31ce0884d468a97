//! Skylines of which samples look at the near part themselves: between nodes, against traced ones, and on a device.

use std::sync::Arc;

use glam::DVec2;
use perilune_bench::scenes::Scene as Terrains;
use perilune_bench::stability::scenes::{nadir, sun};
use perilune_engine::camera::Camera as Optics;
use perilune_engine::horizon::Settings;
use perilune_engine::render::{Quantity, Renderer, Samples, Scene, View};
use perilune_engine::shadow::towards_sun::Swept;
use perilune_engine::shadow::{ShadowMethod, registry};
use perilune_engine::terrain::{Face, Surface, Terrain};

use super::render::{compare, scenes};

const STEP_RAD: f64 = 0.15 * std::f64::consts::PI / 180.0;

fn swept(near: usize) -> Arc<dyn ShadowMethod> {
    Arc::new(Swept { settings: Settings { near, ..Settings::default() }, step_rad: STEP_RAD })
}

/// Of the samples of an image against traced ones: share whose half of the disc is wrong, and RMS of the irradiance over that of
/// level ground.
fn errors(truth: &Samples, tried: &Samples, level_w_m2: f64) -> [f64; 2] {
    let pairs: Vec<_> = truth.pixels.iter().zip(&tried.pixels).filter(|(a, _)| a.sun_fraction.is_finite()).collect();
    let wrong = pairs.iter().filter(|(a, b)| (a.sun_fraction >= 0.5) != (b.sun_fraction >= 0.5)).count() as f64;
    let square: f64 = pairs.iter().map(|(a, b)| f64::from(a.irradiance_w_m2 - b.irradiance_w_m2).powi(2)).sum();
    [wrong / pairs.len() as f64, (square / pairs.len() as f64).sqrt() / level_w_m2]
}

/// A square of ground from above, pixels of 0.7 postings beside nodes.
fn over(face: &Face, elevation_deg: f64) -> View {
    let (size, height_m) = (160, 20_000.0);
    let focal_px = height_m / (0.7 * face.levels[0].posting_m);
    let light = sun(&face.map, 2.1, elevation_deg.to_radians());
    nadir(&face.map, DVec2::new(317.0, -143.0), height_m, light)
        .with_optics(Optics::pinhole(size, size, DVec2::splat(focal_px)).unwrap())
        .with_samples_per_side(1)
        .with_quantities([Quantity::Radiance])
}

/// Between nodes of a cratered highland and of self-affine ground, at 1.5, 3 and 6° of Sun.
#[test]
fn near_terrain_seen_from_samples_takes_most_of_the_error_between_nodes() {
    for terrain in [Terrains::synthetic(384, 5).unwrap(), Terrains::fractal(384, 5).unwrap()] {
        let face = terrain.face.clone();
        let surface = Arc::new(Surface::new(Terrain { body: terrain.body.clone(), faces: vec![terrain.face] }));
        let mut sums = [[0.0; 2]; 4];
        for elevation_deg in [1.5_f64, 3.0, 6.0] {
            let view = over(&face, elevation_deg);
            let scene = Scene::new(surface.clone());
            let samples = |shadows| Renderer::Reference.samples(&scene.clone().with_shadows(shadows), &view).unwrap();
            let truth = samples(registry::reference(Settings::default()));
            let level_w_m2 = 1361.0 * elevation_deg.to_radians().sin();
            for (near, sum) in [0, 4, 8, 16].into_iter().zip(&mut sums) {
                let [wrong, rms] = errors(&truth, &samples(swept(near)), level_w_m2);
                println!("{} {elevation_deg}° near {near}: {:.4} % wrong, RMS {rms:.5}", terrain.name, 100.0 * wrong);
                *sum = [sum[0] + wrong, sum[1] + rms];
            }
        }
        let [whole, _, split, _] = sums;
        for sum in sums {
            println!("{}: {:.3} of the wrong, {:.3} of the RMS", terrain.name, sum[0] / whole[0], sum[1] / whole[1]);
        }
        assert!(whole[0] > 0.0 && split[0] <= 0.15 * whole[0] && split[1] <= 0.5 * whole[1], "{}", terrain.name);
    }
}

/// Over a border of levels, from the coarse one and from the fine one, beside a hole, and on ground without a margin.
#[test]
fn a_device_looks_at_near_terrain_as_the_reference_does() {
    let Some(gpu) = super::gpu() else { return };
    for (name, scene, view) in scenes().into_iter().take(3) {
        let scene = scene.with_shadows(swept(8));
        let reference = Renderer::Reference.samples(&scene, &view).unwrap();
        let agreement = compare(&view, &reference, &Renderer::on(gpu).samples(&scene, &view).unwrap());
        println!("{name}: {agreement:?}");
        assert!(agreement.radiance >= 0.9995, "{name}: {agreement:?}");
        let whole = Renderer::on(gpu).samples(&scene.with_shadows(swept(0)), &view).unwrap();
        let other = compare(&view, &reference, &whole);
        assert!(other.radiance < 0.9995, "{name}: whole skylines pass as well: {other:?}");
    }
}

/// The skyline of a sample does not hang on which side of a border of levels its neighbours lie.
#[test]
fn a_border_of_levels_leaves_no_strip() {
    let (_, scene, _) = scenes().swap_remove(2);
    let Terrain { body, faces } = scene.surface.terrain.clone();
    let face = &faces[0];
    let light = sun(&face.map, 0.7, 4_f64.to_radians());
    let edge_m = face.levels[0].node_m(0, face.levels[0].rows / 2);
    let view = nadir(&face.map, edge_m, 3000.0, light)
        .with_optics(Optics::pinhole(96, 96, DVec2::splat(150.0)).unwrap())
        .with_samples_per_side(1)
        .with_quantities([Quantity::Radiance]);
    let scene = Scene::new(Surface::new(Terrain { body, faces }));
    let samples = |shadows| Renderer::Reference.samples(&scene.clone().with_shadows(shadows), &view).unwrap();
    let truth = samples(registry::reference(Settings::default()));
    let level_w_m2 = 1361.0 * 4_f64.to_radians().sin();
    let [whole, split] = [0, 8].map(|near| errors(&truth, &samples(swept(near)), level_w_m2));
    println!("border: whole {whole:?}, split {split:?}");
    assert!(split[0] <= whole[0] && split[1] <= whole[1], "{split:?} {whole:?}");
}
