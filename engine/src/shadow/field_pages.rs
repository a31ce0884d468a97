//! Where the fields of nodes lie on a device: an adapter limits the size of a binding (128 MiB on software Vulkan), so that
//! they go over several, in pages of which none cuts a field.

use crate::gpu::{Gpu, GpuError};
use crate::shadow::device::BINDINGS;
use crate::shadow::skylines::{Skyline, SurfacePoints};
use crate::terrain::Terrain;

/// Fields begin at whole texels of so many nodes.
const PER_TEXEL: usize = 2;

/// Nodes of all pages are counted in 31 bits.
const MOST_PAGE_BITS: u32 = 29;

/// The page of a field and its first node there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FieldPlace {
    pub page: usize,
    pub start: usize,
}

/// Places of fields, light by light, of each the levels in the order of faces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldPages {
    places: Vec<FieldPlace>,
    levels: usize,
    /// Nodes in each page.
    filled: Vec<usize>,
    page_bits: u32,
}

/// Elements of a page as a power of two.
pub fn page_bits(gpu: &Gpu) -> u32 {
    gpu.page_bits::<Skyline>().min(MOST_PAGE_BITS)
}

impl FieldPages {
    /// The fields of a terrain towards so many lights, each in the first page with room for it.
    pub fn new(gpu: &Gpu, terrain: &Terrain, lights: usize) -> Result<Self, GpuError> {
        let levels = terrain.faces.iter().flat_map(|face| &face.levels);
        let nodes: Vec<usize> = levels.map(|level| SurfacePoints::of(level).count()).collect();
        Self::packed(&nodes, lights, page_bits(gpu)).ok_or_else(|| {
            let mib = |nodes: usize| ((nodes * size_of::<Skyline>()) >> 20) as u64;
            let needed_mib = mib(lights * nodes.iter().sum::<usize>());
            GpuError::TooLarge { what: "skylines", needed_mib, allowed_mib: mib(BINDINGS << page_bits(gpu)) }
        })
    }

    fn packed(nodes: &[usize], lights: usize, page_bits: u32) -> Option<Self> {
        let mut filled = [0; BINDINGS];
        let mut place = |nodes: &usize| {
            let nodes = nodes.next_multiple_of(PER_TEXEL);
            let page = filled.iter().position(|filled| filled + nodes <= 1 << page_bits)?;
            let start = filled[page];
            filled[page] += nodes;
            Some(FieldPlace { page, start })
        };
        let of_light = |_| nodes.iter().map(&mut place).collect::<Option<Vec<_>>>();
        let places = (0..lights).map(of_light).collect::<Option<Vec<_>>>()?.concat();
        Some(Self { places, levels: nodes.len(), filled: filled.to_vec(), page_bits })
    }

    pub fn place(&self, light: usize, level: usize) -> FieldPlace {
        self.places[light * self.levels + level]
    }

    /// As the shader counts it: the first texel, through all pages. Lights without a field have any.
    pub fn texel(&self, light: usize, level: usize) -> u32 {
        let place = self.places.get(light * self.levels + level);
        place.map_or(0, |place| (((place.page << self.page_bits) + place.start) / PER_TEXEL) as u32)
    }

    /// Nodes in each page; none of those behind the last that is used.
    pub fn filled(&self) -> &[usize] {
        &self.filled
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pages of 16 nodes: 9 and 5 share one, the 9 of the second light begins the next, its 5 goes there too.
    #[test]
    fn no_page_cuts_a_field() {
        let pages = FieldPages::packed(&[9, 5], 2, 4).unwrap();
        let places: Vec<_> = pages.places.iter().map(|place| [place.page, place.start]).collect();
        assert_eq!(places, [[0, 0], [0, 10], [1, 0], [1, 10]]);
        assert_eq!(pages.filled(), [16, 16, 0, 0]);
        assert_eq!(pages.texel(1, 1), (16 + 10) / 2);
    }

    #[test]
    fn what_no_page_has_room_for_is_refused() {
        assert_eq!(FieldPages::packed(&[17], 1, 4), None);
        assert!(FieldPages::packed(&[16], 4, 4).is_some());
        assert_eq!(FieldPages::packed(&[16], 5, 4), None);
        assert!(FieldPages::packed(&[12, 4], 4, 4).is_some(), "what is left of a page is used");
    }
}
