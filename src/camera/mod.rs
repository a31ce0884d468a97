//! From scene to detector: where a pixel looks, and what it counts.
//!
//! - [`Camera`]: pixels and directions, solid angles, irradiance of the focal plane
//! - [`Isd`]: the geometry that CSM programs exchange
//! - [`PosedCamera`]: with the poses of an image: one, or one a line or framelet
//! - [`Detector`]: electrons and digital numbers, with noise and without

mod correction;
mod detector;
mod distortion;
mod isd;
mod optics;
mod posed;

pub use correction::Correction;
pub use detector::Detector;
pub use distortion::Distortion;
pub use isd::{Isd, IsdError};
pub use optics::Camera;
pub use posed::{Pose, PosedCamera};

/// A camera that cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CameraError {
    #[error("{parameter} = {got} is outside {allowed}")]
    OutOfRange { parameter: &'static str, got: f64, allowed: &'static str },
    #[error(
        "the distortion folds back at {largest_rad:.4} rad from the boresight, inside the image's corner at {corner_px:?} px"
    )]
    Folds { largest_rad: f64, corner_px: [f64; 2] },
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
