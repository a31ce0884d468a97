//! How two grey images differ: structure, what an eye sees, and where the edges of shadows lie.

pub mod edges;
pub mod flip;
pub mod scalar_image;
pub mod ssim;
pub mod statistics;

pub use scalar_image::ScalarImage;
