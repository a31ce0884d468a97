//! The shipped scenarios, smaller, with both renderers.
//!
//! `SIM_FULL=DIR` renders them as they are, with `DIR` as the cache.

use std::path::{Path, PathBuf};

use perilune_engine::pipeline::{self, Silent};
use perilune_engine::render::{Quantity, Renderer};
use perilune_engine::scenario::{self, Dem, Scenario};

use super::render::compare;
use crate::fixtures;

const PIXELS: u32 = 256;

/// A shipped scenario; `None`, with the reason printed, where its data are not here.
pub fn load(name: &str) -> Option<Scenario> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    match scenario::load(&root.join("scenarios").join(name), &[fixtures::data_folder()], &|_| None) {
        Ok(scenario) => Some(scenario),
        Err(error) => {
            println!("skipped: {error}");
            None
        }
    }
}

/// The same view at 256 pixels, one sample each, over ground of a quarter of the posting.
fn smaller(scenario: Scenario) -> Scenario {
    let mut small = scenario;
    let shrink = f64::from(PIXELS) / f64::from(small.camera.columns);
    small.camera.rows = (f64::from(small.camera.rows) * shrink) as u32;
    small.camera.columns = PIXELS;
    small.camera.focal_length_px *= shrink;
    small.camera.principal_point_px = small.camera.principal_point_px.map(|px| px * shrink);
    small.camera.samples_per_pixel = 1;
    small.horizon.azimuths = 72;
    for dem in small.terrain.iter_mut().flat_map(|terrain| &mut terrain.dems) {
        match dem {
            Dem::File { path, posting_m, .. } => {
                let own_m = [("10m", 10.0), ("240m", 240.0), ("1m", 1.0)];
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                *posting_m = own_m.iter().find(|(part, _)| name.contains(part)).map(|(_, own_m)| 4.0 * own_m);
            }
            Dem::Synthetic { columns, rows, posting_m, .. } => {
                (*columns, *rows, *posting_m) = (*columns / 4, *rows / 4, 4.0 * *posting_m);
            }
            Dem::Detail { posting_m, .. } => *posting_m *= 4.0,
            Dem::Cube { posting_m, .. } => *posting_m = Some(15_000.0),
            Dem::Globe(globe) => globe.posting_m = Some(15_000.0),
        }
    }
    small
}

#[test]
fn the_pass_renders_the_shipped_scenarios_as_the_reference_does() {
    let Some(gpu) = super::gpu() else { return };
    let full = std::env::var_os("SIM_FULL").map(PathBuf::from);
    let temporary = tempfile::tempdir().unwrap();
    let cache = full.as_deref().unwrap_or(temporary.path());
    for name in ["lunar_descent", "connecting_ridge", "full_disc", "orbit_pass", "mars_gale", "shadowed_crater"] {
        let Some(scenario) = load(&format!("{name}.ron")) else { continue };
        let scenario = if full.is_some() { scenario } else { smaller(scenario) };
        let mut prepared = pipeline::prepare(&scenario, cache, &Silent).unwrap();
        let scene = pipeline::build_scene(&scenario, &mut prepared, cache, &Silent).unwrap();
        let view = prepared.exposures[prepared.exposures.len() / 2].view.clone();
        let view = view.with_quantities([Quantity::Radiance, Quantity::Range]);
        let reference = Renderer::Reference.samples(&scene, &view).unwrap();
        let pass = Renderer::on(gpu).samples(&scene, &view).unwrap();
        let agreement = compare(&view, &reference, &pass);
        println!("{name}: {agreement:?}");
        assert!(agreement.radiance >= 0.999, "{name}: {agreement:?}");
        assert!(agreement.range < 1e-4, "{name}: {agreement:?}");
    }
}
