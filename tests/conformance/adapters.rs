//! Adapters that cannot hold a scene: who renders is settled before any work.

use std::sync::Mutex;

use perilune_engine::gpu::{Adapter, Gpu};
use perilune_engine::pipeline::{self, AdapterChoice, Progress, Silent, device};
use perilune_engine::render::Renderer;
use perilune_engine::scenario::{self, SearchPath};

use crate::cli::run::SMALL;

#[derive(Default)]
struct Told(Mutex<String>);

impl Progress for Told {
    fn begin(&self, _: &str, _: usize, _: &str) {}
    fn at(&self, _: usize, _: usize) {}
    fn say(&self, line: &str) {
        self.0.lock().unwrap().push_str(line);
    }
}

/// 128 × 128 nodes have maxima of 85 KiB and fields of 128 KiB.
#[test]
fn the_reference_renderer_takes_over_from_an_adapter_that_is_too_small() {
    if super::gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small.ron");
    let unnamed = SMALL.replace("shadows: HorizonMaps(),", "");
    let scenario = scenario::resolve(&path, &unnamed, &SearchPath::of(&path, &[]), &|_| None).unwrap();
    let prepared = pipeline::prepare(&scenario, folder.path(), &Silent).unwrap();
    let (terrain, method) = (&prepared.ground.surface.terrain, prepared.shadows.method.as_ref());
    for (binding_bytes, holds) in [(128 << 10, true), (64 << 10, false)] {
        let gpu = Gpu::open_within(Adapter::Auto, binding_bytes).unwrap();
        let chosen = |choice: AdapterChoice, told: &Told| {
            device::renderer(Some(&gpu), choice, &scenario, terrain, method, &prepared.exposures, told)
        };
        let told = Told::default();
        let renderer = chosen(AdapterChoice::Auto, &told).unwrap();
        assert_eq!(matches!(renderer, Renderer::Reference), !holds, "{binding_bytes}");
        assert_eq!(told.0.into_inner().unwrap().contains("rendering with the reference renderer"), !holds);
        // Who asks for the adapter is told.
        let outcome = chosen(AdapterChoice::Gpu, &Told::default()).map(|_| ()).map_err(|error| error.to_string());
        assert_eq!(outcome.is_ok(), holds, "{outcome:?}");
        assert!(holds || outcome.unwrap_err().contains("the adapter allows"));
    }
}
