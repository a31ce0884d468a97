//! Photographs.
mod error;
pub mod edges;
pub mod flip;
pub mod geometry;
pub mod grid;
pub mod numbers;
pub mod photometric;
pub mod provenance;
pub mod register;
pub mod render;
pub mod statistics;
pub use error::Error;
pub use geometry::Geometry;
pub use grid::Grid;
