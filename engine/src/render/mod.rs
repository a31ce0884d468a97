//! Radiance seen by a camera.
//!
//! [`Scene`] and [`View`] are all that a renderer reads: a [`Renderer`] opens a [`Session`] of a scene, which renders views.
//! [`mod@reference`] renders in f64, one ray at a time; [`passes`] renders with compute shaders. Both give
//! [`Samples`], from which [`planes`] makes the image. [`imaging`] takes it with a lens that blurs and a shutter that takes
//! its time.

pub mod bounce;
mod bounced_light;
mod diffuse;
pub mod direct;
mod error;
pub mod facet;
pub mod image;
pub mod imaging;
pub mod layout;
pub mod passes;
pub mod planes;
mod recent;
pub mod reference;
pub mod refine;
mod session;
pub mod view;

pub use bounce::Bounce;
pub use bounced_light::BouncedLight;
pub use diffuse::{Diffuse, sky_reflectance};
pub use error::RenderError;
pub use image::{Image, Plane, Quantity};
pub use imaging::{Capture, Imaging, Timing};
pub use passes::{CacheSize, DeviceGround};
pub use planes::{LIT_SHARE, Samples};
pub use session::{Renderer, Session};
pub use view::{AlbedoRole, Ambient, Light, Rays, Scene, View, ViewRays};
