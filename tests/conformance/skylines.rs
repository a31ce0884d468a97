//! Skylines found in advance: the pass against the reference, and both against series evaluated at every sample.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use perilune_engine::geometry::Position;
use perilune_engine::gpu::{Adapter, Gpu};
use perilune_engine::horizon::{Encoding, HorizonMap, Memory, Settings};
use perilune_engine::pipeline::{self, Silent, ground};
use perilune_engine::render::reference;
use perilune_engine::render::{Light, Renderer, Samples, Scene, View};
use perilune_engine::shadow::field_pages::FieldPages;
use perilune_engine::shadow::horizon_maps::HorizonMaps;
use perilune_engine::shadow::skylines::Field;
use perilune_engine::shadow::{QuantizedLight, ShadowMethod, SkylineSource, Skylines, UnpreparedLight, registry};
use perilune_engine::terrain::Surface;

use super::render::{compare, scenes};

fn maps(scene: &Scene, encoding: Encoding) -> Vec<Vec<HorizonMap>> {
    let folder = tempfile::tempdir().unwrap();
    let settings = Settings { azimuths: 48, ..Settings::default() };
    let finished = |_: &ground::Tile| Ok::<_, pipeline::Error>(());
    ground::horizons(&scene.surface, &settings, encoding, folder.path(), Memory::default(), &Silent, finished).unwrap()
}

/// The nested terrain seen obliquely, the Sun at 3°, with its horizon maps.
pub fn nested(encoding: Encoding) -> (Scene, View, Vec<Vec<HorizonMap>>) {
    let (_, scene, view) = scenes().swap_remove(0);
    let maps = maps(&scene, encoding);
    (scene, view, maps)
}

/// Largest and mean difference of the Sun's share.
fn differences(a: &Samples, b: &Samples) -> (f32, f32) {
    let pairs = a.pixels.iter().zip(&b.pixels).map(|(a, b)| (a.sun_fraction - b.sun_fraction).abs());
    let sizes: Vec<f32> = pairs.filter(|size| size.is_finite()).collect();
    (sizes.iter().copied().fold(0.0, f32::max), sizes.iter().sum::<f32>() / sizes.len() as f32)
}

/// Skylines of a method, found on the host.
#[derive(Debug)]
struct Sent(Arc<dyn ShadowMethod>);

impl ShadowMethod for Sent {
    fn name(&self) -> &'static str {
        "sent"
    }

    fn skylines(&self) -> Option<&dyn SkylineSource> {
        Some(self)
    }
}

impl SkylineSource for Sent {
    fn field(
        &self,
        surface: &Surface,
        face: usize,
        level: usize,
        light: &QuantizedLight,
    ) -> Result<Field, UnpreparedLight> {
        self.0.skylines().unwrap().field(surface, face, level, light)
    }
}

#[test]
fn skylines_baked_on_the_device_light_what_the_reference_lights() {
    let Some(gpu) = super::gpu() else { return };
    let (mut scene, view, maps) = nested(Encoding::Fm16);
    scene = scene.with_shadows(Arc::new(HorizonMaps::at_nodes(maps)));
    let reference = Renderer::Reference.samples(&scene, &view).unwrap();
    let pass = Renderer::on(gpu).samples(&scene, &view).unwrap();
    let agreement = compare(&view, &reference, &pass);
    assert!(agreement.radiance >= 0.999, "{agreement:?}");
    // The same fields found on the host and sent.
    let baked = scene.shadows.clone();
    scene = scene.with_shadows(Arc::new(Sent(baked)));
    let sent = Renderer::on(gpu).samples(&scene, &view).unwrap();
    assert!(compare(&view, &reference, &sent).radiance >= 0.999);
}

#[test]
fn baking_changes_no_share_of_the_sun_that_matters() {
    // Largest and mean change allowed. Across a cell of 160 m the Sun's azimuth turns by 5e-6 rad, and it is held still
    // to 7e-6 rad; slopes of the skyline by azimuth reach 1: 1.2e-5 rad are 0.26 % of the Sun's radius, 0.17 % of its
    // disc. Coefficients at reduced resolution are smoothed again: there the mean says that little changes.
    for (encoding, allowed) in [(Encoding::F16, (2e-3, 1e-4)), (Encoding::Fm16, (1.0, 3e-3))] {
        let (mut scene, view, maps) = nested(encoding);
        scene = scene.with_shadows(registry::of_maps(maps.clone()));
        let direct = Renderer::Reference.samples(&scene, &view).unwrap();
        scene = scene.with_shadows(Arc::new(HorizonMaps::at_nodes(maps)));
        let (largest, mean) = differences(&direct, &Renderer::Reference.samples(&scene, &view).unwrap());
        assert!(largest < allowed.0 && mean < allowed.1, "{encoding:?}: {largest} {mean}");
        scene = scene.with_shadows(registry::no_shadows());
        let (largest, mean) = differences(&direct, &Renderer::Reference.samples(&scene, &view).unwrap());
        assert!(largest > 0.9 && mean > 0.1, "the comparison sees no shadows at all: {largest} {mean}");
    }
}

#[test]
fn a_session_bakes_anew_when_the_sun_has_moved() {
    let Some(gpu) = super::gpu() else { return };
    let (mut scene, view, maps) = nested(Encoding::Fm16);
    scene = scene.with_shadows(Arc::new(HorizonMaps::at_nodes(maps)));
    let mut moved = view.clone();
    let sun_m = moved.lights[0].position.vector_m();
    moved.lights[0].position = perilune_engine::geometry::Position::from_m(glam::DQuat::from_rotation_z(0.1) * sun_m);
    let mut session = Renderer::on(gpu).session(&scene).unwrap();
    let first = session.samples(&view).unwrap();
    let second = session.samples(&moved).unwrap();
    let again = session.samples(&view).unwrap();
    let alone = Renderer::on(gpu).samples(&scene, &moved).unwrap();
    assert_eq!(differences(&first, &again), (0.0, 0.0));
    assert_eq!(differences(&second, &alone), (0.0, 0.0));
    assert!(differences(&first, &second).0 > 0.5);
}

/// Counts how often a level's skylines are found.
#[derive(Debug)]
struct Counted {
    baked: HorizonMaps,
    found: Arc<AtomicUsize>,
}

impl ShadowMethod for Counted {
    fn name(&self) -> &'static str {
        "counted"
    }

    fn skylines(&self) -> Option<&dyn SkylineSource> {
        Some(self)
    }
}

impl SkylineSource for Counted {
    fn field(
        &self,
        surface: &Surface,
        face: usize,
        level: usize,
        light: &QuantizedLight,
    ) -> Result<Field, UnpreparedLight> {
        self.found.fetch_add(1, Ordering::Relaxed);
        self.baked.field(surface, face, level, light)
    }
}

#[test]
fn labels_use_the_skylines_that_the_session_found() {
    let Some(gpu) = super::gpu() else { return };
    let (mut scene, view, maps) = nested(Encoding::Fm16);
    let found = Arc::new(AtomicUsize::new(0));
    let levels: usize = maps.iter().map(Vec::len).sum();
    scene = scene.with_shadows(Arc::new(Counted { baked: HorizonMaps::at_nodes(maps), found: found.clone() }));
    let mut session = Renderer::on(gpu).session(&scene).unwrap();
    session.samples(&view).unwrap();
    assert_eq!(found.load(Ordering::Relaxed), levels * view.lights.len());
    let known = session.skylines().unwrap();
    reference::shadow(&scene, &view, &known).unwrap();
    assert_eq!(found.load(Ordering::Relaxed), levels * view.lights.len());
    // Whoever knows nothing finds them again.
    reference::shadow(&scene, &view, &Skylines::default()).unwrap();
    assert_eq!(found.load(Ordering::Relaxed), 2 * levels * view.lights.len());
}

/// The device bakes in f32: horizons there are within 3e-5 rad of f64's, as its search holds.
#[test]
fn skylines_baked_on_the_device_are_read_back_where_they_belong() {
    let Some(gpu) = super::gpu() else { return };
    let (mut scene, view, maps) = nested(Encoding::Fm16);
    scene = scene.with_shadows(Arc::new(HorizonMaps::at_nodes(maps)));
    let mut session = Renderer::on(gpu).session(&scene).unwrap();
    session.samples(&view).unwrap();
    let read = session.skylines().unwrap();
    let shadows = scene.shadows.clone();
    let method = shadows.skylines().unwrap();
    let lights = view.quantized_lights();
    let expected = Skylines::default().towards(&scene.surface, method, &lights).unwrap();
    for light in 0..lights.len() {
        for (face, levels) in scene.surface.terrain.faces.iter().enumerate() {
            for level in 0..levels.levels.len() {
                let [read, expected] = [&read, &expected].map(|skylines| skylines.field(light, face, level));
                assert_eq!(read.len(), expected.len());
                let apart = read.iter().zip(expected).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f32::max);
                assert!(apart < 3e-5, "level {level}: {apart} rad");
            }
        }
    }
}

/// An adapter whose bindings hold less than the fields towards two lights, and just the ground: the fields go over several
/// pages, made there or sent, and the image is that of an adapter which holds them in one.
#[test]
fn fields_that_no_binding_holds_go_over_several_pages() {
    let Some(gpu) = super::gpu() else { return };
    let (mut scene, mut view, maps) = nested(Encoding::Fm4);
    let sun = view.lights[0].clone();
    let turned = Position::from_m(glam::DQuat::from_rotation_z(0.3) * sun.position.vector_m());
    view.lights.push(Light { position: turned, ..sun });
    let nodes = scene.surface.terrain.seen_nodes();
    // Maxima of heights in mips take 16/3 bytes a node, fields 16.
    let binding = (nodes as u64 * 16 / 3).next_power_of_two();
    assert!(binding < 16 * nodes as u64 && FieldPages::new(gpu, &scene.surface.terrain, 2).is_ok());
    let small = Gpu::open_within(Adapter::Auto, binding).unwrap();
    let pages = FieldPages::new(&small, &scene.surface.terrain, 2).unwrap();
    assert!(pages.filled().iter().filter(|nodes| **nodes > 0).count() > 1, "{pages:?}");
    let baked: Arc<dyn ShadowMethod> = Arc::new(HorizonMaps::at_nodes(maps));
    for method in [baked.clone(), Arc::new(Sent(baked))] {
        scene = scene.with_shadows(method);
        let [one, several] = [gpu, &small].map(|gpu| Renderer::on(gpu).samples(&scene, &view).unwrap());
        let radiances = |samples: &Samples| -> Vec<u32> {
            samples.pixels.iter().map(|pixel| pixel.radiance_w_m2_sr.to_bits()).collect()
        };
        assert!(one.pixels.iter().any(|pixel| pixel.sun_fraction > 0.5));
        assert_eq!(radiances(&one), radiances(&several));
    }
    // What goes into no four pages is known beforehand.
    let error = FieldPages::new(&small, &scene.surface.terrain, 12).unwrap_err().to_string();
    assert!(error.starts_with("skylines take") && error.contains("the adapter allows"), "{error}");
}
