//! The prepared method: which of its parts serves.

use super::device::DeviceMaps;
use super::factors::LightingFactors;
use super::maps::{At, HorizonMaps};
use super::samples::MapShadow;
use crate::gpu::Gpu;
use crate::horizon::HorizonMap;
use crate::photometry::SolarDisk;
use crate::shadow::device::{DeviceError, DevicePart};
use crate::shadow::interpolated::InterpolatedSkylines;
use crate::shadow::light::QuantizedLight;
use crate::shadow::method::{FIELD_BYTES, ShadowMethod};
use crate::shadow::near::Near;
use crate::shadow::site::{BoundedShadow, Shadow};
use crate::shadow::skylines::{SkylineSource, Skylines, UnpreparedLight};
use crate::terrain::Surface;

impl ShadowMethod for HorizonMaps {
    fn name(&self) -> &'static str {
        match (self.at, self.visibility) {
            (_, Some(_)) => "lighting factor",
            (At::Pixels, None) => "fourier",
            (At::Nodes, None) => "baked",
        }
    }

    fn maps(&self) -> Option<&[Vec<HorizonMap>]> {
        Some(&self.maps)
    }

    fn skylines(&self) -> Option<&dyn SkylineSource> {
        (self.at == At::Nodes && self.visibility.is_none()).then_some(self as &dyn SkylineSource)
    }

    fn shadow<'a>(
        &'a self,
        surface: &'a Surface,
        disk: &SolarDisk,
        lights: &[QuantizedLight],
        known: &Skylines,
    ) -> Result<Option<Box<dyn Shadow + 'a>>, UnpreparedLight> {
        Ok(Some(match (self.visibility, self.at) {
            (Some(visibility), _) => Box::new(LightingFactors::new(surface, self, visibility, disk, lights)),
            (None, At::Pixels) => Box::new(MapShadow { surface, maps: &self.maps }),
            (None, At::Nodes) => Box::new(InterpolatedSkylines {
                surface,
                skylines: known.towards(surface, self, lights)?,
                near: Near::NONE,
            }),
        }))
    }

    fn device(&self, gpu: &Gpu, surface: &Surface, disk: &SolarDisk) -> Result<DevicePart, DeviceError> {
        let maps = DeviceMaps::new(gpu, &self.maps)?;
        match self.at {
            At::Pixels => Ok(maps.at_samples(self.visibility)),
            At::Nodes => maps.at_nodes(gpu, surface, disk, self.visibility),
        }
    }

    fn bounded<'a>(&'a self, surface: &'a Surface) -> Option<Box<dyn BoundedShadow + 'a>> {
        Some(Box::new(MapShadow { surface, maps: &self.maps }))
    }

    fn device_bytes(&self, nodes: usize) -> f64 {
        let maps = self.maps.iter().flatten().map(HorizonMap::bytes).sum::<usize>() as f64;
        maps + if self.at == At::Nodes { FIELD_BYTES * nodes as f64 } else { 0.0 }
    }
}
