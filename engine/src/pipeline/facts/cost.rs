//! What a run takes, before it is begun: images, disk, memory, time. Rough, and said so.
//!
//! ```text
//! disk    = images · pixels · 4 B · channels · files that hold all planes     + previews of 2 B a pixel      (at most)
//! memory  = program + nodes · bytes + pixels · (samples + planes in flight) + horizon maps
//! time    = sweeps · nodes / (rate · threads) + rays / (rate · threads)
//! ```
//!
//! Rates are those of `docs/performance.md`, two cores of an AMD EPYC with software Vulkan. Bytes are fitted to peaks of runs: 222 MiB
//! with 256² pixels, 703 MiB with 2048² of one channel, 1223 MiB with 2048² of twelve.

use serde::Serialize;

use crate::dataset::Format;
use crate::pipeline::{Error, auto};
use crate::report::machine;
use crate::scenario::Scenario;
use crate::shadow::MethodOptions;
use crate::terrain::Terrain;

/// What a run takes: an estimate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostFacts {
    pub images: usize,
    pub columns: u32,
    pub rows: u32,
    pub channels: usize,
    /// Of the images' files at most.
    pub disk_bytes: f64,
    /// At the peak.
    pub memory_bytes: f64,
    /// `None`: the system does not say.
    pub memory_available_bytes: Option<f64>,
    pub threads: usize,
    /// Of horizons and skylines.
    pub horizons_s: Option<f64>,
    /// Of the images; `None` where a graphics card renders them, for which no rate is known.
    pub images_s: Option<f64>,
}

/// The program with its libraries and a device.
const PROGRAM_BYTES: f64 = 220e6;
/// Heights, gaps, gradients, maxima on the host and on a device that shares its memory.
const NODE_BYTES: f64 = 60.0;
/// Of a pixel: samples on both sides, hits, what encoders hold.
const PIXEL_BYTES: f64 = 100.0;
/// Of a channel of a pixel: the plane, two images that wait, the bytes of a file.
const CHANNEL_BYTES: f64 = 12.0;
/// Rays' directions that are kept.
const RAYS_BYTES: f64 = 512e6;
const RAY_BYTES: f64 = 16.0;

/// By how much an estimate of memory may be too high.
const SAFETY: f64 = 1.5;

/// Nodes swept for one azimuth, a second and thread.
const SWEPT_PER_S: f64 = 30e6;
/// Rays of the passes on a software adapter, and of the reference renderer, a second and thread.
const SOFTWARE_RAYS_PER_S: f64 = 0.5e6;
const REFERENCE_RAYS_PER_S: f64 = 0.15e6;

/// Who renders, as far as a time depends on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Renders {
    Card,
    Software,
    Reference,
}

/// Of a scenario over a terrain, by a method that sweeps as much as `cost` says.
pub fn cost(
    scenario: &Scenario,
    terrain: &Terrain,
    method: &dyn MethodOptions,
    effort: Option<auto::Effort>,
    renders: Renders,
) -> CostFacts {
    let threads = rayon::current_num_threads();
    let (images, nodes) = (scenario.images(), terrain.seen_nodes() as f64);
    let camera = &scenario.camera;
    let pixels = f64::from(camera.columns) * f64::from(camera.rows);
    let rays = images as f64 * pixels * f64::from(camera.samples_per_pixel * camera.moments.max(1));
    let rate = match renders {
        Renders::Card => None,
        Renders::Software => Some(SOFTWARE_RAYS_PER_S),
        Renders::Reference => Some(REFERENCE_RAYS_PER_S),
    };
    let sweeps = effort.map(|effort| effort.before + effort.images);
    CostFacts {
        images,
        columns: camera.columns,
        rows: camera.rows,
        channels: channels(scenario),
        disk_bytes: images as f64 * pixels * (4.0 * (channels(scenario) * copies(scenario)) as f64 + 2.0),
        memory_bytes: memory_bytes(scenario, terrain, method),
        memory_available_bytes: machine::available_memory_bytes(),
        threads,
        horizons_s: sweeps.map(|sweeps| sweeps * nodes / (SWEPT_PER_S * threads as f64)),
        images_s: rate.map(|rate| rays / (rate * threads as f64)),
    }
}

/// What a run takes at its peak.
pub fn memory_bytes(scenario: &Scenario, terrain: &Terrain, method: &dyn MethodOptions) -> f64 {
    let camera = &scenario.camera;
    let pixels = f64::from(camera.columns) * f64::from(camera.rows);
    let nodes = terrain.seen_nodes() as f64;
    let maps =
        if method.needs_maps() { 2.0 * method.encoding(scenario.horizon.encoding).bytes_per_pixel() } else { 0.0 };
    let rays = (RAY_BYTES * pixels * f64::from(camera.samples_per_pixel)).min(RAYS_BYTES);
    PROGRAM_BYTES
        + nodes * (NODE_BYTES + maps)
        + pixels * (PIXEL_BYTES + CHANNEL_BYTES * channels(scenario) as f64)
        + rays
}

/// Refuses what cannot fit: estimates err by a half.
pub fn check_memory(scenario: &Scenario, terrain: &Terrain, method: &dyn MethodOptions) -> Result<(), Error> {
    let needed_bytes = memory_bytes(scenario, terrain, method);
    match machine::available_memory_bytes() {
        Some(available_bytes) if needed_bytes / SAFETY > available_bytes => {
            Err(Error::TooLittleMemory { needed_gb: needed_bytes / 1e9, available_gb: available_bytes / 1e9 })
        }
        _ => Ok(()),
    }
}

fn channels(scenario: &Scenario) -> usize {
    scenario.outputs.planes.iter().map(|quantity| quantity.channels().len()).sum()
}

/// Files of an image that hold all planes.
fn copies(scenario: &Scenario) -> usize {
    let formats = &scenario.outputs.formats;
    let others = formats.iter().filter(|format| matches!(format, Format::Npz | Format::Fits)).count();
    usize::from(Format::writes_exr(formats)) + usize::from(scenario.outputs.tiff) + others
}
