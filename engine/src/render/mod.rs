//! Radiance seen by a camera.
//!
//! [`Scene`] and [`View`] are all that a renderer reads. [`mod@reference`] renders them in f64, one ray at a time,
//! to be believed; [`passes`] renders them with compute shaders. Both give [`Samples`], from which
//! [`planes`] makes the image. [`imaging`] takes it with a lens that blurs and a shutter that takes its time.

pub mod bounce;
mod diffuse;
pub mod image;
pub mod imaging;
pub mod layout;
pub mod passes;
pub mod planes;
pub mod reference;
pub mod refine;
pub mod view;

pub use bounce::Bounce;
pub use diffuse::Diffuse;
pub use image::{Image, Plane, Quantity};
pub use imaging::{Imaging, Taken, Timing};
pub use passes::DeviceGround;
pub use planes::{LIT_SHARE, Samples};
pub use view::{AlbedoRole, Ambient, Light, Rays, Scene, Shadows, View, ViewRays};

use std::time::Duration;

use crate::gpu::GpuError;
use crate::horizon::Encoding;
use crate::shadow::{OutsideSwath, Skylines};

/// A way to render the views of one scene, one after the other. Whatever the scene holds may be kept from the first
/// view on: another scene, or another number of lights, wants another renderer. Only the parameters of its reflectance law
/// may change between views.
pub trait Renderer {
    /// The adapter on one line, for manifests.
    fn adapter(&self) -> String;

    /// What some rays from the view's pose see.
    fn follow(&mut self, scene: &Scene, rays: &Rays, view: &View) -> Result<Samples, RenderError>;

    fn samples(&mut self, scene: &Scene, view: &View) -> Result<Samples, RenderError> {
        self.follow(scene, &scene.rays(), view)
    }

    /// The skylines that the last view was rendered with, for whoever asks about its light again; none where this renderer keeps
    /// none.
    fn skylines(&mut self, _scene: &Scene) -> Result<Skylines, RenderError> {
        Ok(Skylines::default())
    }

    /// What the device spent on the last view in compute passes, where it can tell.
    fn device_time(&self) -> Option<Duration> {
        None
    }

    fn render(&mut self, scene: &Scene, view: &View) -> Result<Image, RenderError> {
        Ok(planes::image(scene, view, &self.samples(scene, view)?))
    }
}

/// What can go wrong while rendering.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(
        "{what} take {needed_mib} MiB, the adapter allows {allowed_mib} MiB; \
         use a coarser posting or a smaller extent, or --adapter cpu"
    )]
    BufferTooLarge { what: &'static str, needed_mib: u64, allowed_mib: u64 },
    #[error("traced shadows need the reference renderer; use --adapter cpu")]
    TracedOnGpu,
    #[error("horizon maps are encoded as {first} and as {other}, want one encoding")]
    Encodings { first: Encoding, other: Encoding },
    #[error("{got} lights, skylines that are found in advance are kept for at most {allowed}")]
    TooManyLights { got: usize, allowed: usize },
    #[error(transparent)]
    OutsideSwath(#[from] OutsideSwath),
}
