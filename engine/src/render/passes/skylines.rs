//! Fields of the shadow method on the device: made there, or found on the host and sent.

use wgpu::Buffer;

use super::upload::DeviceGround;
use crate::gpu::Gpu;
use crate::render::layout::MapLevel;
use crate::render::{RenderError, Scene};
use crate::shadow::skylines::Field;
use crate::shadow::{FieldMaker, Fields, QuantizedLight, Skylines, SurfacePoints, UnpreparedLight};

/// Skylines in a texel.
const PER_TEXEL: usize = 2;
/// Lights with fields of their own, as offsets in a level.
const LIGHTS: usize = 4;

/// The fields of a scene, and the lights that they hold for.
#[derive(Debug)]
pub struct DeviceSkylines {
    fields: Fields,
    /// Where a light's field of each level begins, in texels.
    starts: Vec<usize>,
    texels: usize,
    /// Found on the host.
    found: Skylines,
    /// Read back from the device.
    read: Skylines,
    made: Option<(Vec<QuantizedLight>, Buffer)>,
}

impl DeviceSkylines {
    pub fn new(gpu: &Gpu, fields: Fields, ground: &DeviceGround) -> Result<Self, RenderError> {
        let mut texels = 0;
        let mut starts = Vec::new();
        for level in &ground.levels {
            starts.push(texels);
            texels += (level.shader.columns as usize * level.shader.rows as usize).div_ceil(PER_TEXEL);
        }
        gpu.fits::<[u32; 4]>("skylines", texels, 1)?;
        Ok(Self { fields, starts, texels, found: Skylines::default(), read: Skylines::default(), made: None })
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
        if self.made.as_ref().is_some_and(|(made, _)| made == lights) {
            return Ok(Some(0.0));
        }
        gpu.fits::<[u32; 4]>("skylines", lights.len() * self.texels, 1)?;
        let (seconds, buffer) = match &self.fields {
            Fields::Device(maker) => self.make(gpu, maker.as_ref(), scene, ground, lights),
            Fields::Host => (Some(0.0), self.send(gpu, scene, lights)?),
        };
        self.made = Some((lights.to_vec(), buffer));
        Ok(seconds)
    }

    pub fn buffer(&self) -> Option<&Buffer> {
        self.made.as_ref().map(|(_, buffer)| buffer)
    }

    /// A level whose horizons are the fields of each light.
    pub fn placed(&self, level: MapLevel, index: usize) -> MapLevel {
        let offset = |light: usize| (light * self.texels + self.starts[index]) as u32;
        MapLevel { horizon: std::array::from_fn(offset), ..level }
    }

    fn make(
        &self,
        gpu: &Gpu,
        maker: &dyn FieldMaker,
        scene: &Scene,
        ground: &DeviceGround,
        lights: &[QuantizedLight],
    ) -> (Option<f64>, Buffer) {
        let fields = gpu.output("skylines", (lights.len() * self.texels * size_of::<[u32; 4]>()) as u64);
        let mut seconds = Some(0.0);
        for (index, light) in lights.iter().enumerate() {
            for (start, level) in self.starts.iter().zip(&ground.levels) {
                let map = &scene.surface.terrain.faces[level.face].map;
                let offset = PER_TEXEL * (index * self.texels + start);
                let spent = maker.field(gpu, map, [level.face, level.level], light, &fields, offset);
                seconds = seconds.zip(spent).map(|(sum, spent)| sum + spent);
            }
        }
        (seconds, fields)
    }

    fn send(&mut self, gpu: &Gpu, scene: &Scene, lights: &[QuantizedLight]) -> Result<Buffer, UnpreparedLight> {
        let found = self.found_on_host(scene, lights)?;
        let mut values = vec![[0.0; 2]; PER_TEXEL * lights.len() * self.texels];
        for light in 0..lights.len() {
            for (face, levels) in scene.surface.terrain.faces.iter().enumerate() {
                for level in 0..levels.levels.len() {
                    let (start, field) = (self.start(scene, light, [face, level]), found.field(light, face, level));
                    values[start..start + field.len()].copy_from_slice(field);
                }
            }
        }
        Ok(gpu.storage("skylines", &values))
    }

    /// Where a light's field of a level begins, in nodes.
    fn start(&self, scene: &Scene, light: usize, [face, level]: [usize; 2]) -> usize {
        let before: usize = scene.surface.terrain.faces[..face].iter().map(|face| face.levels.len()).sum();
        PER_TEXEL * (light * self.texels + self.starts[before + level])
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
        let (Fields::Device(_), Some((lights, buffer))) = (&self.fields, &self.made) else {
            return Ok(self.found.clone());
        };
        if *lights == self.read.lights {
            return Ok(self.read.clone());
        }
        let values: Vec<[f32; 2]> = gpu.read(buffer)?;
        let field = |wanted: &QuantizedLight, [face, level]: [usize; 2]| -> Result<Field, RenderError> {
            let light = lights.iter().position(|light| light == wanted).unwrap_or_default();
            let start = self.start(scene, light, [face, level]);
            Ok(values[start..][..SurfacePoints::of(&scene.surface.terrain.faces[face].levels[level]).count()].to_vec())
        };
        self.read = Skylines::default().found(&scene.surface, field, lights)?;
        Ok(self.read.clone())
    }
}
