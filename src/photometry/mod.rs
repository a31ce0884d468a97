//! What surfaces do to light, and how much of the Sun's disc they see.
//!
//! - [`SolarDisk`]: share and first moment of the limb-darkened disc above a horizon and a facet's own plane
//! - [`Reflectance`]: radiance per irradiance of the ground
//! - [`quadrature`]: the Gauss–Legendre rule that both use
//!
//! The shaders [`SOLAR_DISK_WGSL`] and [`REFLECTANCE_WGSL`] do the same in `f32`; `tests/conformance` holds the
//! two together.

mod hapke;
mod parameter_sets;
pub mod quadrature;
mod reflectance;
mod solar_disk;
mod tangent_plane;

pub use hapke::{Hapke, MultipleScattering};
pub use reflectance::{Reflectance, ReflectanceParameters};
pub use solar_disk::{DiskLight, LimbDarkening, SolarDisk};
pub use tangent_plane::{Facet, HorizonLine, SunAxes};

/// Functions `horizon_line` and `disk_light`; wants a storage binding `disk_tables: array<f32>`.
pub const SOLAR_DISK_WGSL: &str = include_str!("solar_disk.wgsl");

/// Function `brdf_sr`; wants the override `REFLECTANCE_MODEL`.
pub const REFLECTANCE_WGSL: &str = include_str!("reflectance.wgsl");

/// A photometric parameter outside its domain.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PhotometryError {
    #[error("{parameter} = {got} is outside {allowed}")]
    OutOfRange { parameter: &'static str, got: f64, allowed: &'static str },
}
