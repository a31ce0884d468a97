//! What surfaces do to light, and how much of the Sun's disc they see.
//!
//! - [`SolarDisk`]: share and first moment of the limb-darkened disc above a horizon and a facet's own plane
//! - [`LimbDarkening`]: how it darkens towards its limb; [`eclipse`]: what another disc leaves of it
//! - [`SolarSpectrum`] and [`Curve`]: sunlight through a camera's band
//! - [`Reflectance`]: radiance per irradiance of the ground, of which empirical laws have a [`DiscFunction`] and a
//!   [`PhaseFunction`]; [`SkyReflectance`]: the same under an even sky
//! - [`quadrature`]: the Gauss–Legendre rule that both use
//!
//! The shaders [`SOLAR_DISK_WGSL`] and [`REFLECTANCE_WGSL`] do the same in `f32`; `tests/conformance` holds the
//! two together.

mod curve;
mod disc_function;
pub mod eclipse;
mod hapke;
mod limb_darkening;
mod parameter_sets;
mod phase_function;
pub mod quadrature;
mod reflectance;
mod sky_reflectance;
mod solar_disk;
mod spectrum;
mod tangent_plane;

pub use curve::Curve;
pub use disc_function::DiscFunction;
pub use hapke::{Hapke, MultipleScattering};
pub use limb_darkening::LimbDarkening;
pub use phase_function::{PhaseFunction, lunar_disc_reflectance};
pub use reflectance::{Reflectance, ReflectanceParameters};
pub use sky_reflectance::SkyReflectance;
pub use solar_disk::{DiskLight, SolarDisk};
pub use spectrum::{BandLight, SolarSpectrum};
pub use tangent_plane::{Facet, HorizonLine, SunAxes};

/// The middle of the visible light, for which limb darkening and photons stand where no band is named.
pub const VISIBLE_NM: f64 = 550.0;

/// Functions `horizon_line` and `disk_light`; wants a storage binding `disk_tables: array<f32>`.
pub const SOLAR_DISK_WGSL: &str = include_str!("solar_disk.wgsl");

/// Function `brdf_sr`; wants the override `REFLECTANCE_MODEL`.
pub const REFLECTANCE_WGSL: &str = include_str!("reflectance.wgsl");

/// A photometric parameter outside its domain, or a curve that is none.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PhotometryError {
    #[error("{parameter} = {got} is outside {allowed}")]
    OutOfRange { parameter: &'static str, got: f64, allowed: &'static str },
    #[error("no phase function fits this law")]
    NoPhaseFunction,
    #[error("line {line} is not two numbers, a wavelength in nm and a value")]
    CurveLine { line: usize },
    #[error(
        "line {line} has the names {got}; allowed are wavelength_nm, wavelength_um or wavelength_angstrom, and response, \
         transmission, quantum_efficiency, irradiance or value"
    )]
    CurveHeading { line: usize, got: String },
    #[error(transparent)]
    CurveTable(#[from] crate::text::TableError),
    #[error("point {point} {what}")]
    CurvePoint { point: usize, what: &'static str },
    #[error("has {got} points; allowed are 2 to 1 000 000 points")]
    CurveLength { got: usize },
    #[error("reaches from {from_nm} to {to_nm} nm; {spectrum} has {low_nm} to {high_nm} nm")]
    BeyondSpectrum { spectrum: String, low_nm: f64, high_nm: f64, from_nm: f64, to_nm: f64 },
    #[error("lets no sunlight through between {from_nm} and {to_nm} nm")]
    Dark { from_nm: f64, to_nm: f64 },
}
