//! Arrays that may be larger than one binding: an adapter limits its size (128 MiB on software Vulkan). They go over several
//! bindings, in pages of a power of two of elements.

use wgpu::Buffer;

use super::{Gpu, GpuError};

impl Gpu {
    /// Elements of a page, as a power of two, that the adapter takes in one binding.
    pub fn page_bits<T>(&self) -> u32 {
        (self.device.limits().max_storage_buffer_binding_size / size_of::<T>() as u64).ilog2().min(31)
    }

    /// Whether so many elements fit into so many pages; `what` names them in the error.
    pub fn fits<T>(&self, what: &'static str, elements: usize, pages: usize) -> Result<(), GpuError> {
        let allowed = pages << self.page_bits::<T>();
        let mib = |elements: usize| (elements as u64 * size_of::<T>() as u64) >> 20;
        if elements <= allowed {
            return Ok(());
        }
        Err(GpuError::TooLarge { what, needed_mib: mib(elements), allowed_mib: mib(allowed) })
    }

    /// Read-only storage buffers of a page each, filled with `values` one after the other.
    pub fn pages<T: bytemuck::Pod, const N: usize>(
        &self,
        what: &'static str,
        values: &[T],
    ) -> Result<[Buffer; N], GpuError> {
        self.fits::<T>(what, values.len(), N)?;
        let mut chunks = values.chunks(1 << self.page_bits::<T>());
        Ok(std::array::from_fn(|_| self.storage(what, chunks.next().unwrap_or(&[]))))
    }
}
