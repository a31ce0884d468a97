//! From scene to detector: where a pixel looks, and what it counts.
//!
//! - [`Camera`]: pixels and directions, solid angles, irradiance of the focal plane
//! - [`Isd`]: the geometry that CSM programs exchange
//! - [`PosedCamera`]: with the poses of an image: one, or one a line or framelet
//! - [`Shutter`]: which rows are exposed when
//! - [`Psf`]: how lens and focus spread the light
//! - [`Detector`]: electrons and digital numbers, with noise and without

mod correction;
mod detector;
mod distortion;
mod isd;
mod optics;
mod posed;
mod psf;
mod shutter;

pub use correction::Correction;
pub use detector::Detector;
pub use distortion::Distortion;
pub use isd::{Isd, IsdError};
pub use optics::{Camera, Vignetting};
pub use posed::{Pose, PosedCamera};
pub use psf::{Kernel, Psf, PsfComponent};
pub use shutter::{ExposedRows, Shutter};

/// A camera that cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CameraError {
    #[error("{parameter} = {got} is outside {allowed}")]
    OutOfRange { parameter: &'static str, got: f64, allowed: &'static str },
    #[error(
        "the distortion folds back at {largest_rad:.4} rad from the boresight, inside the image's corner at {corner_px:?} px"
    )]
    Folds { largest_rad: f64, corner_px: [f64; 2] },
    #[error("a psf kernel of {columns} x {rows} pixels, want odd sides up to 97, no negative number and a sum above 0")]
    Kernel { columns: usize, rows: usize },
    #[error("an image of {rows} rows is no whole number of framelets of {framelet_rows}")]
    Framelets { rows: u32, framelet_rows: u32 },
    #[error("the vignetting polynomial is {got:.4} at {corner_px:?} px, allowed is [0, 1.5] in the image")]
    Vignetting { got: f64, corner_px: [f64; 2] },
}

/// `Ok` where `got` is in `range`; `allowed` says the range in words, with its unit.
fn check(
    parameter: &'static str,
    got: f64,
    range: std::ops::RangeInclusive<f64>,
    allowed: &'static str,
) -> Result<(), CameraError> {
    if range.contains(&got) { Ok(()) } else { Err(CameraError::OutOfRange { parameter, got, allowed }) }
}
