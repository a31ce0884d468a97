//! What a build may use of the machine.

use super::memory::Memory;
use crate::gpu::Gpu;

/// Memory that a build may take, and the device that the caller has opened for it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Resources<'a> {
    pub memory: Memory,
    /// Needed by [`super::Method::Gpu`] alone.
    pub device: Option<&'a Gpu>,
}

impl From<Memory> for Resources<'_> {
    fn from(memory: Memory) -> Self {
        Self { memory, device: None }
    }
}
