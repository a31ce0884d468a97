//! Who renders: a device that can hold the scene, or the reference renderer.
//!
//! Whether a device holds a terrain and its shadows hangs on the size of its bindings and is known before work starts. Where the
//! user leaves the choice of the adapter open, the reference renderer takes over from one that is too small.
#![warn(missing_docs)]

use super::{Error, Exposure, Progress};
use crate::gpu::{Adapter, Gpu, GpuError};
use crate::render::{DeviceGround, Renderer};
use crate::scenario::Scenario;
use crate::shadow::MethodOptions;
use crate::terrain::Terrain;

/// Who renders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AdapterChoice {
    /// Any adapter; the reference renderer where there is none, or none that holds the scene.
    #[default]
    Auto,
    /// A hardware adapter or nothing.
    Gpu,
    /// The reference renderer.
    Cpu,
}

/// The device that renders; `None`: the reference renderer does.
pub fn open(choice: AdapterChoice, scenario: &Scenario, progress: &dyn Progress) -> Result<Option<Gpu>, Error> {
    match choice {
        AdapterChoice::Cpu => Ok(None),
        AdapterChoice::Gpu => Ok(Some(Gpu::open(Adapter::Gpu)?)),
        AdapterChoice::Auto if is_for_host(scenario) => {
            progress.say("shadows that devices do not have: rendering with the reference renderer on the CPU");
            Ok(None)
        }
        AdapterChoice::Auto => match Gpu::open(Adapter::Auto) {
            Ok(gpu) => Ok(Some(gpu)),
            Err(error) => {
                progress.say(&format!("{error}; rendering with the reference renderer on the CPU"));
                Ok(None)
            }
        },
    }
}

/// Whether the scenario names a method that only the reference renderer has.
fn is_for_host(scenario: &Scenario) -> bool {
    scenario.shadows.method().is_some_and(|method| !method.runs_on_device())
}

/// Who renders, once it is known which shadows are cast over which terrain.
pub fn renderer(
    gpu: Option<&Gpu>,
    choice: AdapterChoice,
    scenario: &Scenario,
    terrain: &Terrain,
    method: &dyn MethodOptions,
    exposures: &[Exposure],
    progress: &dyn Progress,
) -> Result<Renderer, Error> {
    let Some(gpu) = gpu else { return Ok(Renderer::Reference) };
    if choice == AdapterChoice::Auto && !method.runs_on_device() {
        return Ok(Renderer::Reference);
    }
    match holds(gpu, scenario, terrain, method, exposures) {
        Ok(()) => Ok(Renderer::on(gpu)),
        Err(error) if choice == AdapterChoice::Auto => {
            progress.say(&format!(
                "{error}; rendering with the reference renderer on the CPU, which takes minutes an image"
            ));
            Ok(Renderer::Reference)
        }
        Err(error) => Err(error.into()),
    }
}

/// Whether a device holds a terrain and the shadows on it: asked before hours go into horizons.
pub fn holds(
    gpu: &Gpu,
    scenario: &Scenario,
    terrain: &Terrain,
    method: &dyn MethodOptions,
    exposures: &[Exposure],
) -> Result<(), GpuError> {
    DeviceGround::check(gpu, terrain)?;
    let lights = exposures.iter().map(|exposure| exposure.view.lights.len()).max().unwrap_or(1);
    method.check_device(gpu, terrain, lights, scenario.horizon.encoding)
}
