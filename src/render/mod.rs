//! Radiance seen by a camera.

pub mod image;

pub use image::{Image, Plane, Quantity};
