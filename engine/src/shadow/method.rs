//! A shadow method, and how one is asked for.
//!
//! [`MethodOptions`] is what a scenario or a bench writes: it says what the method needs, where it does not apply and what it
//! costs, and prepares the method. [`ShadowMethod`] is the prepared method: it does not change any more, and is shared by
//! whoever renders. What it finds for given lights is kept by its user.

use std::fmt::Debug;
use std::path::Path;
use std::sync::Arc;

use super::device::{DeviceError, DevicePart};
use super::interpolated::InterpolatedSkylines;
use super::light::QuantizedLight;
use super::near::Near;
use super::site::{BoundedShadow, Shadow};
use super::skylines::{SkylineSource, Skylines, UnpreparedLight};
use crate::gpu::{Gpu, GpuError};
use crate::horizon::{self, Encoding, HorizonMap};
use crate::photometry::SolarDisk;
use crate::terrain::{Surface, Terrain};

/// A method of casting shadows, ready for a surface.
pub trait ShadowMethod: Debug + Send + Sync {
    /// What the method is called in reports.
    fn name(&self) -> &'static str;

    /// Horizon maps by face and level that it evaluates.
    fn maps(&self) -> Option<&[Vec<HorizonMap>]> {
        None
    }

    /// What finds skylines of all nodes while the lights stand still.
    fn skylines(&self) -> Option<&dyn SkylineSource> {
        None
    }

    /// The terrain that those skylines leave out, and that is looked at from every sample.
    fn near(&self) -> Near {
        Near::NONE
    }

    /// The part for the host: shadows of lights, with whatever it finds for them in advance and `known` does not hold. `None`:
    /// only a facet's own plane shades it.
    fn shadow<'a>(
        &'a self,
        surface: &'a Surface,
        _disk: &SolarDisk,
        lights: &[QuantizedLight],
        known: &Skylines,
    ) -> Result<Option<Box<dyn Shadow + 'a>>, UnpreparedLight> {
        let Some(source) = self.skylines() else { return Ok(None) };
        let skylines = known.towards(surface, source, lights)?;
        Ok(Some(Box::new(InterpolatedSkylines { surface, skylines, near: self.near() })))
    }

    /// The part for a device.
    fn device(&self, gpu: &Gpu, surface: &Surface, _disk: &SolarDisk) -> Result<DevicePart, DeviceError> {
        match self.skylines() {
            Some(source) => Ok(DevicePart::of_skylines(source.on_device(gpu, surface)?, self.near().postings)),
            None => Ok(DevicePart::open()),
        }
    }

    /// Whether it has a part for devices.
    fn runs_on_device(&self) -> bool {
        true
    }

    /// Shadows of its maps with what is known of their errors.
    fn bounded<'a>(&'a self, _surface: &'a Surface) -> Option<Box<dyn BoundedShadow + 'a>> {
        None
    }

    /// Whether its shadows are the reference that others are held to.
    fn is_exact(&self) -> bool {
        false
    }

    /// Bytes that a device holds for it.
    fn device_bytes(&self, nodes: usize) -> f64 {
        if self.skylines().is_some() { FIELD_BYTES * nodes as f64 } else { 0.0 }
    }
}

/// An elevation and a slope for each node.
pub const FIELD_BYTES: f64 = 8.0;

/// How a method is asked for.
pub trait MethodOptions: Debug + Send + Sync {
    /// As a scenario writes it.
    fn spelling(&self) -> String;

    /// Whether horizon maps are made for it.
    fn needs_maps(&self) -> bool {
        false
    }

    /// The encoding of its maps, given the scenario's.
    fn encoding(&self, of_scenario: Encoding) -> Encoding {
        of_scenario
    }

    /// Whether what its maps leave open is known.
    fn has_bounds(&self) -> bool {
        false
    }

    /// Whether it has a part for devices.
    fn runs_on_device(&self) -> bool {
        true
    }

    /// Whether it works on the tiles of a globe, beyond whose sides no light is followed.
    fn serves_globe(&self) -> bool {
        self.needs_maps()
    }

    /// Whether what is prepared holds for the given lights alone.
    fn is_for_given_lights(&self) -> bool {
        false
    }

    /// What is wrong with the options, for maps of an encoding.
    fn flaw(&self, _encoding: Encoding) -> Option<Flaw> {
        None
    }

    /// What a user should know of the shadows on a surface, where it can be had.
    fn warning(&self, _surface: Option<&Surface>) -> Option<String> {
        None
    }

    /// Why it cannot do these exposures' lights.
    fn refusal(&self, _surface: &Surface, _lights: &[Vec<QuantizedLight>]) -> Option<PrepareError> {
        None
    }

    /// Where it applies.
    fn domain(&self) -> Domain {
        Domain { reach_postings: f64::INFINITY, penumbrae: true }
    }

    /// What it costs, where `Auto` may choose it.
    fn cost(&self, _work: &Workload) -> Option<Cost> {
        None
    }

    /// Whether an adapter can hold what it needs for a terrain under so many lights: asked before hours go into it.
    fn check_device(&self, _: &Gpu, _: &Terrain, _lights: usize, _: Encoding) -> Result<(), GpuError> {
        Ok(())
    }

    /// The method, ready for a surface.
    fn prepare(&self, ingredients: Ingredients) -> Result<Arc<dyn ShadowMethod>, PrepareError>;
}

/// What methods are prepared from.
#[derive(Clone)]
pub struct Ingredients<'a> {
    pub surface: &'a Surface,
    pub settings: horizon::Settings,
    /// All lights of each exposure.
    pub lights: &'a [Vec<QuantizedLight>],
    /// Horizon maps by face and level, where the method needs them.
    pub maps: Vec<Vec<HorizonMap>>,
    /// Where tiles are kept.
    pub folder: &'a Path,
    /// Is told what is made, how much of it is done, and of how much.
    pub progress: &'a (dyn Fn(&str, usize, usize) + Sync),
}

impl Debug for Ingredients<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Ingredients")
            .field("settings", &self.settings)
            .field("folder", &self.folder)
            .finish_non_exhaustive()
    }
}

/// Why a method cannot be prepared.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    #[error(transparent)]
    Horizon(#[from] horizon::Error),
    #[error(
        "shadows: {method}: in these exposures the lights span {got} azimuths that are azimuth_step_deg = {step_deg} apart, \
         at most {allowed} are allowed; use horizon maps, fewer exposures or a wider step"
    )]
    TooManyAzimuths { method: &'static str, got: usize, step_deg: f64, allowed: usize },
}

impl PrepareError {
    /// Whether the method is fine, but not for these exposures.
    pub fn is_outside_domain(&self) -> bool {
        matches!(self, Self::TooManyAzimuths { .. })
    }
}

/// What is wrong with the value of an option.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Flaw {
    /// The option.
    pub key: &'static str,
    /// Its value, where that alone is wrong.
    pub got: Option<String>,
    pub rule: String,
}

/// Where a method applies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Domain {
    /// Postings of the terrain that it looks far.
    pub reach_postings: f64,
    /// Whether a disc may be seen in part.
    pub penumbrae: bool,
}

/// What the choice of a method rests on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Workload {
    /// Of horizon maps.
    pub encoding: Encoding,
    /// Of horizon maps.
    pub azimuths: usize,
    /// Horizon maps are made anyway.
    pub maps_are_made: bool,
    /// Azimuths, [`super::fan::STEP_DEG`] apart, that lights span in all exposures.
    pub spanned: usize,
    /// Azimuths that they span in one exposure, summed over those with lights of their own.
    pub swept: usize,
    pub images: usize,
    pub samples: f64,
    pub nodes: f64,
    /// Lights that differ from the exposure before.
    pub lights: usize,
}

/// What a method costs, in sweeps of one azimuth over all nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Azimuths that are swept.
    pub azimuths: usize,
    /// Of azimuths at most.
    pub most: usize,
    /// All images.
    pub images: f64,
    /// RMS error of the irradiance in full Suns.
    pub error: f64,
}

/// A method's options under a name for benches.
#[derive(Debug, Clone, Copy)]
pub struct NamedMethod {
    pub name: &'static str,
    pub bench: Bench,
    /// Whether hard cases are tried with it.
    pub hard_cases: bool,
    /// Whether `Auto` may choose it; of equal ones the first.
    pub auto: bool,
    pub options: fn() -> Box<dyn MethodOptions>,
}

/// When benches compare a method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bench {
    /// Where nobody asks for more.
    Usual,
    /// Asked for by name: minutes a frame on large terrain.
    Slow,
    /// Not listed.
    Unlisted,
}

/// Methods that share a folder.
#[derive(Debug)]
pub struct Family {
    pub named: &'static [NamedMethod],
    /// Names with a parameter, for people.
    pub patterns: &'static [&'static str],
    pub parse: fn(&str) -> Option<Box<dyn MethodOptions>>,
}

/// A method as a scenario writes it, with those of its options that are not left out.
pub fn spelled(name: &str, options: impl IntoIterator<Item = Option<String>>) -> String {
    let options: Vec<String> = options.into_iter().flatten().collect();
    format!("{name}({})", options.join(", "))
}

/// An option as a scenario writes it, unless it has its default.
pub fn unless_default<T: PartialEq + Default>(key: &str, value: &T, text: impl std::fmt::Display) -> Option<String> {
    (*value != T::default()).then(|| format!("{key}: {text}"))
}
