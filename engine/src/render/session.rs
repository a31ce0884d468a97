//! Renderers, and their sessions: views of one scene, one after the other.
//!
//! ```text
//! Renderer + Scene -> Session + View -> samples -> image
//! ```
//!
//! A session keeps what does not change from view to view: on a device the ground, horizon maps, programs and tables of
//! rays. What it keeps depends on the scene alone, or is kept with all that it was made for: views may differ in all that
//! a [`View`] says, in any order, and each comes out as if it were rendered alone.

use std::sync::Arc;
use std::time::Duration;

use super::passes::{CacheSize, Passes};
use super::planes::{self, Samples};
use super::{Image, Rays, RenderError, Scene, View, reference};
use crate::gpu::Gpu;
use crate::shadow::Skylines;

/// Who renders.
#[derive(Debug, Clone)]
pub enum Renderer {
    /// The CPU, in f64, one ray at a time.
    Reference,
    /// Compute shaders on a device.
    Device(Arc<Gpu>),
}

/// Views of one scene. A scene may have many sessions, each in a thread of its own.
#[derive(Debug)]
pub struct Session {
    scene: Scene,
    /// `None`: the reference renderer, which keeps nothing.
    passes: Option<Box<Passes>>,
    adapter: String,
}

impl Renderer {
    pub fn on(gpu: &Gpu) -> Self {
        Self::Device(Arc::new(gpu.clone()))
    }

    /// The device where there is one, otherwise the reference renderer.
    pub fn on_any(gpu: Option<&Gpu>) -> Self {
        gpu.map_or(Self::Reference, Self::on)
    }

    /// The adapter on one line, for manifests.
    pub fn adapter(&self) -> String {
        match self {
            Self::Reference => reference::NAME.into(),
            Self::Device(gpu) => gpu.describe(),
        }
    }

    /// Puts a scene on the device.
    pub fn session(&self, scene: &Scene) -> Result<Session, RenderError> {
        let passes = match self {
            Self::Reference => None,
            Self::Device(gpu) => Some(Box::new(Passes::new(gpu, scene)?)),
        };
        Ok(Session { scene: scene.clone(), passes, adapter: self.adapter() })
    }

    /// What a single view of a scene samples.
    pub fn samples(&self, scene: &Scene, view: &View) -> Result<Samples, RenderError> {
        self.session(scene)?.samples(view)
    }

    /// A single image of a scene.
    pub fn render(&self, scene: &Scene, view: &View) -> Result<Image, RenderError> {
        self.session(scene)?.render(view)
    }
}

impl Session {
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The adapter on one line, for manifests.
    pub fn adapter(&self) -> &str {
        &self.adapter
    }

    /// The planes that a view asks for, but for those that need other views.
    pub fn render(&mut self, view: &View) -> Result<Image, RenderError> {
        let samples = self.samples(view)?;
        Ok(planes::image(&self.scene, view, &samples))
    }

    /// What the rays of a view's whole image see.
    pub fn samples(&mut self, view: &View) -> Result<Samples, RenderError> {
        self.follow(&self.scene.rays(view), view)
    }

    /// What some rays from a view's pose see.
    pub fn follow(&mut self, rays: &Rays, view: &View) -> Result<Samples, RenderError> {
        match &mut self.passes {
            Some(passes) => passes.follow(&self.scene, rays, view),
            None => reference::follow(&self.scene, rays, view),
        }
    }

    /// The skylines that the last view was rendered with, for whoever asks about its light again; none where none are kept.
    pub fn skylines(&mut self) -> Result<Skylines, RenderError> {
        match &mut self.passes {
            Some(passes) => passes.skylines(&self.scene),
            None => Ok(Skylines::default()),
        }
    }

    /// What the device spent on the last view in compute passes, where it can tell.
    pub fn device_time(&self) -> Option<Duration> {
        self.passes.as_ref().and_then(|passes| passes.device_time())
    }

    /// How much is kept from view to view besides the scene.
    pub fn cache_size(&self) -> CacheSize {
        self.passes.as_ref().map_or_else(CacheSize::default, |passes| passes.cache_size())
    }
}
