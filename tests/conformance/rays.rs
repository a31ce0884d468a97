//! Many rays a pixel: a device whose loops end by themselves gives what few rays at a time give, and an image that was cut
//! short is an error.

use std::path::Path;
use std::sync::Arc;

use perilune_engine::camera::Camera as Optics;
use perilune_engine::gpu::{CUT_SHORT_TURNS, CUT_SHORT_WGSL, Gpu};
use perilune_engine::horizon::{self, Encoding, Memory, Request, Settings};
use perilune_engine::render::{Quantity, Renderer, Samples, Scene, View};
use perilune_engine::shadow::method::NamedMethod;
use perilune_engine::shadow::{Ingredients, ShadowMethod, registry};

use super::render::scenes;

/// Few pixels of a wide view.
fn small(view: &View, samples_per_side: usize) -> View {
    let (columns, rows) = (4, 3);
    let optics =
        Optics::pinhole(columns, rows, view.optics.focal_px * f64::from(columns) / f64::from(view.optics.columns));
    view.clone()
        .with_optics(optics.unwrap())
        .with_samples_per_side(samples_per_side)
        .with_quantities([Quantity::Radiance])
}

fn prepared(named: &NamedMethod, scene: &Scene, view: &View, folder: &Path) -> Arc<dyn ShadowMethod> {
    let (options, terrain) = ((named.options)(), &scene.surface.terrain);
    let settings = Settings { azimuths: 120, ..Settings::default() };
    let encoding = options.encoding(Encoding::W21);
    let map = |level| {
        let request = Request { body: &terrain.body, face: &terrain.faces[0], level, settings, encoding };
        horizon::open_or_build(&request, folder, Memory::default(), &|_, _| ()).unwrap()
    };
    let maps = if options.needs_maps() { vec![(0..2).map(map).collect()] } else { Vec::new() };
    let lights = &[view.quantized_lights()];
    options
        .prepare(Ingredients { surface: &scene.surface, settings, lights, maps, folder, progress: &|_, _, _| () })
        .unwrap()
}

/// Mean of radiance, and share of rays that met ground.
fn means(samples: &Samples) -> [f64; 2] {
    let count = samples.pixels.len() as f64;
    let radiance: f64 =
        samples.pixels.iter().map(|pixel| f64::from(pixel.radiance_w_m2_sr)).filter(|x| x.is_finite()).sum();
    let hit: f64 = samples.pixels.iter().map(|pixel| f64::from(pixel.hit)).sum();
    [radiance / count, hit / count]
}

fn assert_near(what: &str, got: [f64; 2], expected: [f64; 2]) {
    let off = [0, 1].map(|i| (got[i] - expected[i]).abs());
    assert!(off[0] <= 2e-3 * expected[0] && off[1] <= 1e-3, "{what}: {got:?}, not {expected:?}");
}

/// Grazing and from above, by every method that runs on a device. At 1024 rays a grazing view of this takes over a million turns
/// of loops a pixel.
#[test]
fn any_number_of_rays_gives_what_the_reference_gives() {
    let Some(gpu) = super::gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let methods = registry::all().filter(|named| named.hard_cases && (named.options)().runs_on_device());
    for named in methods {
        for (place, scene, view) in scenes().into_iter().skip(1).take(2) {
            let shadows = prepared(named, &scene, &view, folder.path());
            let scene = scene.with_shadows(shadows);
            for samples_per_side in [1, 4, 10, 32] {
                let view = small(&view, samples_per_side);
                let what = format!("{} {place} {samples_per_side}²", named.name);
                let expected = means(&Renderer::Reference.samples(&scene, &view).unwrap());
                assert!(expected[0] > 0.0, "{what} is black");
                assert_near(&what, means(&Renderer::on(gpu).samples(&scene, &view).unwrap()), expected);
            }
        }
    }
}

/// As many turns of a loop in 64 invocations, and whether they were all made.
fn turned(gpu: &Gpu, turns: u32) -> Vec<[u32; 2]> {
    let source = [
        "@group(0) @binding(0) var<storage, read> asked: array<u32>;
         @group(0) @binding(1) var<storage, read_write> done: array<vec2u>;
         @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {
             var turn = 0u;
             loop {
                 if turn >= asked[1] { break; }
                 turn += 1u + (done[id.x].x & 2u);
             }
             done[id.x] = vec2u(turn, u32(cut_short(asked[0])));
         }",
        CUT_SHORT_WGSL,
    ];
    let pipeline = gpu.compute("turns", &source.concat(), "main", &[]).unwrap();
    let asked = gpu.storage("asked", &[CUT_SHORT_TURNS, turns]);
    let done = gpu.output("done", 64 * 8);
    gpu.run(&pipeline, &[&asked, &done], [1, 1, 1]);
    gpu.read(&done).unwrap()
}

/// Software Vulkan makes 65 535 turns; whoever makes them all says so.
#[test]
fn loops_that_are_cut_short_are_noticed() {
    let Some(gpu) = super::gpu() else { return };
    assert!(turned(gpu, 50_000).iter().all(|done| *done == [50_000, 0]));
    let long = turned(gpu, 200_000);
    assert!(long.iter().all(|[turns, cut]| (*turns == 200_000) == (*cut == 0)), "{long:?}");
}
