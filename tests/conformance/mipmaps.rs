//! Runs over maximum mipmaps and light from the sky: the pass against the reference.

use perilune_engine::photometry::{Hapke, Reflectance, SkyReflectance};
use perilune_engine::render::{AlbedoRole, Ambient, Renderer, Scene};
use perilune_engine::shadow::mipmaps::Mipmaps;
use perilune_engine::shadow::multiscale::Multiscale;
use perilune_engine::shadow::sky::{Harmonic, shares};
use std::sync::Arc;

use super::render::{compare, scenes};
use crate::scenes as plain;

/// The published runs, and those that reach the terrain's end.
fn methods(scene: &Scene) -> Vec<Mipmaps> {
    let published = [Mipmaps::of(&[5, 5, 5, 3]), Mipmaps::of(&[1]), Mipmaps::uniform(100, 1.0)];
    published.into_iter().chain([Mipmaps::reaching(&scene.surface.terrain)]).collect()
}

/// Where two blocks cost the same to rounding, f32 may choose the other one: more pixels differ than without shadows.
#[test]
fn the_pass_searches_the_runs_that_the_reference_searches() {
    let Some(gpu) = super::gpu() else { return };
    for (name, mut scene, view) in scenes() {
        if scene.surface.terrain.faces.is_empty() {
            continue;
        }
        for method in methods(&scene) {
            let called = format!("{name}, {method:?}");
            scene = scene.with_shadows(Arc::new(method));
            let reference = Renderer::Reference.samples(&scene, &view).unwrap();
            let pass = Renderer::on(gpu).samples(&scene, &view).unwrap();
            let agreement = compare(&view, &reference, &pass);
            println!("{called}: {agreement:?}");
            assert!(agreement.radiance >= 0.999, "{called}: {agreement:?}");
        }
    }
}

#[test]
fn one_mip_less_is_noticed() {
    let Some(gpu) = super::gpu() else { return };
    let (_, mut scene, view) = scenes().swap_remove(0);
    scene = scene.with_shadows(Arc::new(Mipmaps::of(&[5, 5, 5])));
    let reference = Renderer::Reference.samples(&scene, &view).unwrap();
    scene = scene.with_shadows(Arc::new(Mipmaps::of(&[5, 4, 5])));
    let other = Renderer::on(gpu).samples(&scene, &view).unwrap();
    assert!(compare(&view, &reference, &other).radiance < 0.995);
}

#[test]
fn the_pass_lights_from_the_sky_as_the_reference_does() {
    let Some(gpu) = super::gpu() else { return };
    let few = ["nested, low", "spheroid"];
    for (name, mut scene, view) in scenes().into_iter().filter(|(name, ..)| few.contains(name)) {
        let surface = &scene.surface;
        let sky = Harmonic::new(Multiscale::new(&surface.terrain, 1, 1.0, 0.0), 4);
        let of_face = |(face, levels): (usize, &perilune_engine::terrain::Face)| {
            (0..levels.levels.len()).map(|level| shares(surface, [face, level], &sky)).collect()
        };
        let shares = surface.terrain.faces.iter().enumerate().map(of_face).collect();
        scene = scene.with_ambient(Ambient { radiance_w_m2_sr: 100.0, shares });
        let reference = Renderer::Reference.samples(&scene, &view).unwrap();
        let pass = Renderer::on(gpu).samples(&scene, &view).unwrap();
        let agreement = compare(&view, &reference, &pass);
        assert!(agreement.radiance >= 0.999, "{name}: {agreement:?}");
        scene.ambient = None;
        let dark = Renderer::on(gpu).samples(&scene, &view).unwrap();
        assert!(compare(&view, &reference, &dark).radiance < 0.9, "{name}: the sky gives no light");
    }
}

/// Flat ground under a sky, the Sun down, sees all of it: its light is that of the hemisphere, here Hapke's with `w` from a map.
#[test]
fn the_sky_is_reflected_from_all_sides() {
    let Some(gpu) = super::gpu() else { return };
    let terrain = plain::Grid::square(2000.0, 100.0).terrain(&plain::flat_body(), |_| 0.0);
    let nodes = terrain.faces[0].levels[0].heights_m.len();
    let map = plain::map(&plain::flat_body());
    let shares = vec![vec![vec![1.0; nodes]]];
    let dark = plain::scene(terrain).with_ambient(Ambient { radiance_w_m2_sr: 100.0, shares });
    let mapped = dark.clone().with_albedo(vec![vec![vec![0.4; nodes]]], AlbedoRole::SingleScattering);
    let sun = plain::sun(&map, 0.0, -20_f64.to_radians());
    let view = plain::nadir(&map, glam::DVec2::ZERO, 1000.0, sun).with_optics(plain::pinhole(33, 1, 12.0));
    for (scene, law) in [(&dark, Hapke::moon()), (&mapped, Hapke { single_scattering_albedo: 0.4, ..Hapke::moon() })] {
        let view = view.clone().with_reflectance(Reflectance::Hapke(law));
        let sky = SkyReflectance::new(&view.reflectance);
        for renderer in [Renderer::Reference, Renderer::on(gpu)] {
            let samples = renderer.samples(scene, &view).unwrap();
            for (column, pixel) in samples.pixels.iter().enumerate() {
                let mu = 12.0 / (column as f64 - 16.0).hypot(12.0);
                let expected = sky.sr(1.0, mu) * std::f64::consts::PI * 100.0;
                let off = f64::from(pixel.radiance_w_m2_sr) / expected - 1.0;
                assert!(off.abs() < 2e-3, "{renderer:?}, {column}: {off}, {pixel:?}");
            }
        }
    }
}
