//! Fields of the shadow method on the device: made there, or found on the host and sent.

use wgpu::Buffer;

use super::upload::DeviceGround;
use crate::gpu::{Gpu, GpuError};
use crate::render::layout::MapLevel;
use crate::render::{RenderError, Scene};
use crate::shadow::field_pages::FieldPages;
use crate::shadow::skylines::{Field, Skyline};
use crate::shadow::{FieldMaker, Fields, QuantizedLight, Skylines, SurfacePoints, UnpreparedLight};

/// Lights with fields of their own, as offsets in a level.
const LIGHTS: usize = 4;

/// The fields of a scene, and the lights that they hold for.
#[derive(Debug)]
pub struct DeviceSkylines {
    fields: Fields,
    /// Found on the host.
    found: Skylines,
    /// Read back from the device.
    read: Skylines,
    made: Option<Made>,
}

/// Fields towards some lights.
#[derive(Debug)]
struct Made {
    lights: Vec<QuantizedLight>,
    pages: FieldPages,
    buffers: Vec<Buffer>,
}

impl DeviceSkylines {
    /// One light has room at least.
    pub fn new(gpu: &Gpu, fields: Fields, scene: &Scene) -> Result<Self, GpuError> {
        FieldPages::new(gpu, &scene.surface.terrain, 1)?;
        Ok(Self { fields, found: Skylines::default(), read: Skylines::default(), made: None })
    }

    /// The fields towards these lights and what making them took on the device.
    pub fn towards(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        ground: &DeviceGround,
        lights: &[QuantizedLight],
    ) -> Result<Option<f64>, RenderError> {
        if lights.len() > LIGHTS {
            return Err(RenderError::TooManyLights { got: lights.len(), allowed: LIGHTS });
        }
        if self.made.as_ref().is_some_and(|made| made.lights == lights) {
            return Ok(Some(0.0));
        }
        let pages = FieldPages::new(gpu, &scene.surface.terrain, lights.len())?;
        let (seconds, buffers) = match &self.fields {
            Fields::Device(maker) => make(gpu, maker.as_ref(), scene, ground, lights, &pages),
            Fields::Host => (Some(0.0), self.send(gpu, scene, lights, &pages)?),
        };
        self.made = Some(Made { lights: lights.to_vec(), pages, buffers });
        Ok(seconds)
    }

    /// Bindings of the pages.
    pub fn buffers(&self) -> &[Buffer] {
        self.made.as_ref().map_or(&[], |made| &made.buffers)
    }

    /// A level whose horizons are the fields of each light.
    pub fn placed(&self, level: MapLevel, index: usize) -> MapLevel {
        let texel = |light: usize| self.made.as_ref().map_or(0, |made| made.pages.texel(light, index));
        MapLevel { horizon: std::array::from_fn(texel), ..level }
    }

    fn send(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        lights: &[QuantizedLight],
        pages: &FieldPages,
    ) -> Result<Vec<Buffer>, UnpreparedLight> {
        let found = self.found_on_host(scene, lights)?;
        let mut values: Vec<Field> = pages.filled().iter().map(|&nodes| vec![[0.0; 2]; nodes]).collect();
        for light in 0..lights.len() {
            for (index, [face, level]) in levels(scene).enumerate() {
                let (place, field) = (pages.place(light, index), found.field(light, face, level));
                values[place.page][place.start..place.start + field.len()].copy_from_slice(field);
            }
        }
        Ok(values.iter().map(|values| gpu.storage("skylines", values)).collect())
    }

    /// The fields towards these lights as the host finds them.
    pub fn found_on_host(&mut self, scene: &Scene, lights: &[QuantizedLight]) -> Result<Skylines, UnpreparedLight> {
        if let Some(source) = scene.shadows.skylines() {
            self.found = self.found.towards(&scene.surface, source, lights)?;
        }
        Ok(self.found.clone())
    }

    /// The fields that the device holds, read back where it made them.
    pub fn on_host(&mut self, gpu: &Gpu, scene: &Scene) -> Result<Skylines, RenderError> {
        let (Fields::Device(_), Some(Made { lights, pages, buffers })) = (&self.fields, &self.made) else {
            return Ok(self.found.clone());
        };
        if *lights == self.read.lights {
            return Ok(self.read.clone());
        }
        let values = buffers.iter().map(|buffer| gpu.read(buffer)).collect::<Result<Vec<Field>, _>>()?;
        let field = |wanted: &QuantizedLight, at: [usize; 2]| -> Result<Field, RenderError> {
            let light = lights.iter().position(|light| light == wanted).unwrap_or_default();
            let index = levels(scene).position(|level| level == at).unwrap_or_default();
            let place = pages.place(light, index);
            let count = SurfacePoints::of(&scene.surface.terrain.faces[at[0]].levels[at[1]]).count();
            Ok(values[place.page][place.start..][..count].to_vec())
        };
        self.read = Skylines::default().found(&scene.surface, field, lights)?;
        Ok(self.read.clone())
    }
}

/// Faces and levels in the order of a [`DeviceGround`].
fn levels(scene: &Scene) -> impl Iterator<Item = [usize; 2]> {
    let faces = scene.surface.terrain.faces.iter().enumerate();
    faces.flat_map(|(face, levels)| (0..levels.levels.len()).map(move |level| [face, level]))
}

fn make(
    gpu: &Gpu,
    maker: &dyn FieldMaker,
    scene: &Scene,
    ground: &DeviceGround,
    lights: &[QuantizedLight],
    pages: &FieldPages,
) -> (Option<f64>, Vec<Buffer>) {
    let page = |nodes: &usize| gpu.output("skylines", (nodes * size_of::<Skyline>()) as u64);
    let buffers: Vec<Buffer> = pages.filled().iter().map(page).collect();
    let mut seconds = Some(0.0);
    for (index, light) in lights.iter().enumerate() {
        for (at, level) in ground.levels.iter().enumerate() {
            let map = &scene.surface.terrain.faces[level.face].map;
            let place = pages.place(index, at);
            let spent = maker.field(gpu, map, [level.face, level.level], light, &buffers[place.page], place.start);
            seconds = seconds.zip(spent).map(|(sum, spent)| sum + spent);
        }
    }
    (seconds, buffers)
}
