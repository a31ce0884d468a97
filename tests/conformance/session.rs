//! Views of one session come out as if each were rendered alone, on every renderer.

use std::collections::BTreeSet;
use std::process::Command;
use std::sync::Arc;

use glam::DQuat;
use perilune_engine::camera::{Camera as Optics, Detector};
use perilune_engine::geometry::Position;
use perilune_engine::horizon::Encoding;
use perilune_engine::photometry::{DiscFunction, Hapke, Reflectance};
use perilune_engine::render::{AlbedoRole, CacheSize, Image, Light, Quantity, Renderer, Scene, Session, View};
use perilune_engine::shadow::horizon_maps::HorizonMaps;
use perilune_engine::shadow::registry;

use super::skylines::nested;

/// Small, so that many are rendered.
const SIDE: u32 = 16;

/// The nested terrain with its skylines baked towards each light, and a map of Hapke's `w`.
fn scene() -> (Scene, View) {
    let (scene, view, maps) = nested(Encoding::Fm16);
    let even = |level: &perilune_engine::terrain::Level| {
        (0..level.heights_m.len()).map(|node| 0.2 + 0.03 * (node % 7) as f32).collect::<Vec<_>>()
    };
    let faces = &scene.surface.terrain.faces;
    let albedo = faces.iter().map(|face| face.levels.iter().map(even).collect()).collect();
    let scene =
        scene.with_shadows(Arc::new(HorizonMaps::at_nodes(maps))).with_albedo(albedo, AlbedoRole::SingleScattering);
    (scene, sized(view, SIDE))
}

fn sized(view: View, side: u32) -> View {
    let focal_px = view.optics.focal_px * f64::from(side) / f64::from(view.optics.columns);
    let optics = Optics::pinhole(side, side, focal_px).unwrap();
    view.with_optics(optics)
}

fn renderers() -> Vec<Renderer> {
    std::iter::once(Renderer::Reference).chain(super::gpu().map(Renderer::on)).collect()
}

fn turned(light: &Light, turn_rad: f64) -> Light {
    let position = Position::from_m(DQuat::from_rotation_z(turn_rad) * light.position.vector_m());
    Light { position, ..light.clone() }
}

fn detector() -> Detector {
    Detector {
        exposure_s: 1e-3,
        pixel_pitch_m: 5e-6,
        wavelength_m: 550e-9,
        quantum_efficiency: 0.6,
        dark_current_e_s: 5.0,
        read_noise_e: 8.0,
        full_well_e: 20_000.0,
        gain_dn_e: 0.2,
        offset_dn: 64.0,
        bits: 12,
        prnu: 0.01,
        dsnu_e: 3.0,
        blooming: false,
        seed: 4,
    }
}

/// Views that differ from the first in one thing each, and in several.
fn views(view: &View) -> Vec<View> {
    let lights = |count: usize| (0..count).map(|index| turned(&view.lights[0], 0.4 * index as f64)).collect();
    let hapke = |w: f64| Reflectance::Hapke(Hapke { single_scattering_albedo: w, ..Hapke::moon() });
    let lambert = |normal_albedo: f64| Reflectance::lambert(normal_albedo);
    vec![
        view.clone(),
        view.clone().with_reflectance(hapke(0.3)),
        view.clone().with_reflectance(lambert(0.2)),
        View { lights: lights(2), ..view.clone() },
        view.clone().with_reflectance(lambert(0.4)),
        View { lights: lights(3), ..view.clone() }.with_reflectance(hapke(0.6)),
        View { lights: vec![turned(&view.lights[0], 1.0)], ..view.clone() },
        view.clone().with_quantities([Quantity::Depth, Quantity::Normal, Quantity::SunFraction]),
        view.clone().with_detector(detector()).with_quantities([Quantity::DigitalNumber]),
        sized(view.clone(), 24).with_samples_per_side(3),
        view.clone().with_samples_per_side(1).with_quantities([Quantity::Radiance]),
    ]
}

fn bits(image: &Image) -> Vec<(&'static str, Vec<u32>)> {
    let values = |plane: &perilune_engine::render::Plane| plane.values.iter().map(|value| value.to_bits()).collect();
    image.planes.iter().map(|plane| (plane.name, values(plane))).collect()
}

#[test]
fn views_of_a_session_come_out_as_if_rendered_alone() {
    let (scene, view) = scene();
    let views = views(&view);
    for renderer in renderers() {
        let alone: Vec<_> = views.iter().map(|view| bits(&renderer.render(&scene, view).unwrap())).collect();
        let different: BTreeSet<_> = alone.iter().map(|image| format!("{image:?}")).collect();
        assert_eq!(different.len(), views.len(), "each view has an image of its own");
        let mut session = renderer.session(&scene).unwrap();
        // Forwards, backwards, and each after the first.
        let count = views.len();
        let order = (0..count).chain((0..count).rev()).chain((1..count).flat_map(|index| [0, index]));
        for index in order {
            let image = bits(&session.render(&views[index]).unwrap());
            assert!(image == alone[index], "{}: view {index} after others", renderer.adapter());
        }
    }
}

/// 45.3 instead of 54.8 W m-2 sr-1 was what a law gave that came after another.
#[test]
fn another_scene_in_another_session_of_a_renderer_is_another_scene() {
    let (scene, view) = scene();
    let bare = Scene { albedo: None, ..scene.clone() }.with_shadows(registry::no_shadows());
    for renderer in renderers() {
        let [mut first, mut second] = [&scene, &bare].map(|scene| renderer.session(scene).unwrap());
        let render = |session: &mut Session| bits(&session.render(&view).unwrap());
        let images = [render(&mut first), render(&mut second), render(&mut first), render(&mut second)];
        assert!(images[0] == images[2] && images[1] == images[3] && images[0] != images[1]);
    }
}

#[test]
fn two_threads_render_one_scene_in_a_session_each() {
    let (scene, view) = scene();
    let scene = std::sync::Arc::new(scene);
    let views = views(&view);
    for renderer in renderers() {
        let alone: Vec<_> = views.iter().map(|view| bits(&renderer.render(&scene, view).unwrap())).collect();
        let all = |backwards: bool| {
            let mut session = renderer.session(&scene).unwrap();
            let mut render = |index: usize| (index, bits(&session.render(&views[index]).unwrap()));
            let indices = 0..views.len();
            match backwards {
                false => indices.map(&mut render).collect::<Vec<_>>(),
                true => indices.rev().map(&mut render).collect(),
            }
        };
        let found = std::thread::scope(|scope| {
            let threads = [false, true].map(|backwards| scope.spawn(move || all(backwards)));
            threads.map(|thread| thread.join().unwrap())
        });
        assert!(found.iter().flatten().all(|(index, image)| *image == alone[*index]), "{}", renderer.adapter());
    }
}

const ALONE: &str = "PERILUNE_TEST_ALONE";

fn resident_mib() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    let pages: f64 = text.split_whitespace().nth(1)?.parse().ok()?;
    Some(pages * 4096.0 / 1_048_576.0)
}

/// In a process of its own: other tests' memory does not count.
#[test]
fn a_thousand_views_leave_a_session_as_large_as_a_hundred() {
    if std::env::var_os(ALONE).is_some() {
        return render_a_thousand();
    }
    let name = "conformance::session::a_thousand_views_leave_a_session_as_large_as_a_hundred";
    let status = Command::new(std::env::current_exe().unwrap())
        .args([name, "--exact", "--nocapture"])
        .env(ALONE, "1")
        .status()
        .unwrap();
    assert!(status.success());
}

fn render_a_thousand() {
    let (scene, view) = scene();
    let laws = [Reflectance::empirical(0.1, DiscFunction::LunarLambert), Reflectance::lambert(0.1)];
    // The reference renderer finds skylines anew for every view; ground without shadows is as good here.
    let plain = scene.clone().with_shadows(registry::no_shadows());
    for (renderer, scene) in renderers().into_iter().zip([&plain, &scene]) {
        let mut session = renderer.session(scene).unwrap();
        let mut kept = CacheSize::default();
        let mut before_mib = None;
        for index in 0..1000_usize {
            let sun = turned(&view.lights[0], 1e-3 * (index / 50) as f64);
            let lights = vec![sun; 1 + index % 2];
            // A camera that no view before had, in one of ten.
            let side = if index % 10 == 0 { 8 + (index / 10) as u32 % 40 } else { SIDE };
            let view = View { exposure: index as u64, lights, ..sized(view.clone(), side) };
            session.render(&view.with_reflectance(laws[index / 2 % 2])).unwrap();
            if index == 99 {
                before_mib = resident_mib();
            }
            if index >= 400 {
                let now = session.cache_size();
                assert!(index == 400 || now == kept, "{kept:?} became {now:?} at view {index}");
                kept = now;
            }
        }
        println!(
            "{}: {before_mib:?} MiB after 100 views, {:?} after 1000, {kept:?}",
            renderer.adapter(),
            resident_mib()
        );
        if let Some((before, after)) = before_mib.zip(resident_mib()) {
            assert!(after < before + 24.0, "{}: {before} MiB, then {after} MiB", renderer.adapter());
        }
    }
}
