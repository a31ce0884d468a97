//! Small scenes with closed forms, and whoever can render them.

use std::sync::Arc;

pub use perilune_bench::stability::scenes::*;
use perilune_engine::horizon::{self, Encoding, Request, Settings};
use perilune_engine::render::View;
use perilune_engine::render::{Renderer, Samples, Scene};
use perilune_engine::shadow::towards_sun::{Edge, SingleAzimuth, Swept};
use perilune_engine::shadow::{ShadowMethod, registry};
use perilune_engine::terrain::{Face, Terrain};

use crate::conformance::gpu;

/// Horizon maps as the engine builds them.
pub fn fourier(terrain: &Terrain) -> Arc<dyn ShadowMethod> {
    let directory = tempfile::tempdir().unwrap();
    let settings = Settings { azimuths: 120, ..Settings::default() };
    let of_level = |face: &Face, level: usize| {
        let request = Request { body: &terrain.body, face, level, settings, encoding: Encoding::Fm16 };
        horizon::build(&request, directory.path(), &|_, _| ()).unwrap()
    };
    let of_face = |face: &Face| (0..face.levels.len()).map(|level| of_level(face, level)).collect();
    registry::of_maps(terrain.faces.iter().map(of_face).collect())
}

/// Methods that find skylines towards a light without horizon maps.
pub fn towards() -> [Arc<dyn ShadowMethod>; 2] {
    let settings = Settings::default();
    let sweep = Swept { settings, step_rad: 0.15_f64.to_radians() };
    [Arc::new(sweep), Arc::new(SingleAzimuth { settings, spacing: 1.0, edge: Edge::Sloped })]
}

/// The same scene with traced shadows, with horizon maps, and with skylines towards the light.
pub fn shadowed(terrain: Terrain) -> Vec<Scene> {
    let maps = fourier(&terrain);
    [registry::reference(Settings::default()), maps]
        .into_iter()
        .chain(towards())
        .map(|shadows| scene(terrain.clone()).with_shadows(shadows))
        .collect()
}

/// What each renderer that can gives, by its name. Without an adapter the compute pass is left out, and it says so. Skylines
/// that are found on the host are the same in both; `conformance` sees to that.
pub fn samples(scene: &Scene, view: &View) -> Vec<(&'static str, Samples)> {
    let mut all = vec![("reference", Renderer::Reference.samples(scene, view).unwrap())];
    if scene.shadows.runs_on_device()
        && scene.shadows.skylines().is_none()
        && let Some(gpu) = gpu()
    {
        all.push(("pass", Renderer::on(gpu).samples(scene, view).unwrap()));
    }
    all
}

/// How shadows and renderer are called together.
pub fn name(scene: &Scene, renderer: &str) -> String {
    format!("{renderer}, {} shadows", scene.shadows.name())
}
