//! Renders held against mission photographs.
//!
//! A photograph and its camera's true geometry come in; the same view is rendered with the true Sun, the two are
//! registered, and what is left is told in numbers, pictures and variants of the physics ([`study`]).
//!
//! What is fitted is what the report names, and nothing else: a motion of the image ([`mod@register`]) and one
//! photometric response ([`photometric`]). The pose that explains the motion is told, and taken where it is asked for
//! ([`pose`]). Terrain, Sun and reflectance are never touched. An albedo map made
//! from the photograph itself is refused ([`provenance`]).

pub mod ablation;
mod error;
mod figures;
pub mod geometry;
pub mod numbers;
pub mod photometric;
pub mod pose;
mod prepare;
pub mod profile;
pub mod provenance;
pub mod register;
pub mod render;
pub mod report;
pub mod request;
pub mod resolution;
pub mod scales;
pub mod study;

pub use crate::image_metrics::{ScalarImage, edges, flip, statistics};
pub use error::Error;
pub use geometry::Geometry;
pub use photometric::Model;
pub use register::{Freedom, Registration, register};
pub use request::{GeometrySource, Law, Request};
pub use study::{Comparison, compare};
