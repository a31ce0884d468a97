//! What can go wrong while rendering.

use crate::gpu::GpuError;
use crate::shadow::{DeviceError, UnpreparedLight};

/// What can go wrong while rendering.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error(transparent)]
    Device(#[from] DeviceError),
    #[error("{got} lights, skylines that are found in advance are kept for at most {allowed}")]
    TooManyLights { got: usize, allowed: usize },
    #[error(transparent)]
    UnpreparedLight(#[from] UnpreparedLight),
}
