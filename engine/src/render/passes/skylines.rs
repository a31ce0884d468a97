//! Fields of skylines or of lighting factors on the device: made there from horizon maps or images of heights, or found on the
//! host and sent.

use wgpu::{Buffer, ComputePipeline};

use super::upload::{DeviceGround, fits};
use crate::gpu::{Gpu, workgroups};
use crate::render::layout::{BakeParameters, MapLevel};
use crate::render::{RenderError, Scene, Shadows};
use crate::shadow::multiscale::device::OnDevice;
use crate::shadow::skylines::{Feet, Field};
use crate::shadow::{HeldLight, OutsideSwath, Skylines};

/// The baking pass, as one text.
pub const SHADER: &str = concat!(
    include_str!("../bake.wgsl"),
    include_str!("../texels.wgsl"),
    include_str!("../../shadow/visibility.wgsl"),
    include_str!("../../photometry/solar_disk.wgsl"),
);

/// Skylines in a texel.
const PER_TEXEL: usize = 2;
/// Invocations of one workgroup, as in the shader.
const GROUP: usize = 64;
/// Lights with fields of their own, as offsets in a level.
const LIGHTS: usize = 4;

/// How the device makes fields.
#[derive(Debug)]
enum Maker {
    /// From horizon maps.
    Bake(ComputePipeline),
    /// From images of heights.
    Multiscale(Box<OnDevice>),
}

/// The fields of a scene, and the lights that they hold for.
#[derive(Debug)]
pub struct DeviceSkylines {
    /// `None`: found on the host.
    maker: Option<Maker>,
    disk_tables: Buffer,
    /// Where a light's field of each level begins, in texels.
    starts: Vec<usize>,
    texels: usize,
    /// Found there, or read back.
    host: Skylines,
    made: Option<(Vec<HeldLight>, Buffer)>,
}

impl DeviceSkylines {
    pub fn new(gpu: &Gpu, scene: &Scene, ground: &DeviceGround) -> Result<Self, RenderError> {
        let mut texels = 0;
        let mut starts = Vec::new();
        for level in &ground.levels {
            starts.push(texels);
            texels += (level.shader.columns as usize * level.shader.rows as usize).div_ceil(PER_TEXEL);
        }
        fits::<[u32; 4]>(gpu, "skylines", texels, 1)?;
        let shader = [SHADER, &ground.encoding.wgsl()].concat();
        let mut constants = [&ground.pages[..], &ground.encoding.constants(), &scene.disk.constants()].concat();
        let factors = match scene.shadows.as_ref() {
            Shadows::Lighting(lighting) => Some(lighting.visibility),
            _ => None,
        };
        constants.push(("FACTORS", f64::from(u8::from(factors.is_some()))));
        constants.extend(factors.unwrap_or_default().constants());
        let maker = match scene.shadows.as_ref() {
            Shadows::Baked(_) | Shadows::Lighting(_) => {
                Some(Maker::Bake(gpu.compute("bake", &shader, "main", &constants)?))
            }
            Shadows::Towards(method) => {
                method.on_device(gpu, &scene.surface)?.map(|method| Maker::Multiscale(Box::new(method)))
            }
            _ => None,
        };
        let disk_tables = gpu.storage("disc tables", &scene.disk.tables());
        Ok(Self { maker, disk_tables, starts, texels, host: Skylines::default(), made: None })
    }

    /// The fields towards these lights and what making them took on the device.
    pub fn towards(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        ground: &DeviceGround,
        lights: &[HeldLight],
    ) -> Result<Option<f64>, RenderError> {
        if lights.len() > LIGHTS {
            return Err(RenderError::TooManyLights { got: lights.len(), allowed: LIGHTS });
        }
        if self.made.as_ref().is_some_and(|(held, _)| held == lights) {
            return Ok(Some(0.0));
        }
        fits::<[u32; 4]>(gpu, "skylines", lights.len() * self.texels, 1)?;
        let (seconds, buffer) = match &self.maker {
            Some(maker) => self.make(gpu, maker, scene, ground, lights),
            None => (Some(0.0), self.send(gpu, scene, lights)?),
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
        MapLevel { horizon: std::array::from_fn(offset), has_horizon: 1, ..level }
    }

    fn make(
        &self,
        gpu: &Gpu,
        maker: &Maker,
        scene: &Scene,
        ground: &DeviceGround,
        lights: &[HeldLight],
    ) -> (Option<f64>, Buffer) {
        let fields = gpu.output("skylines", (lights.len() * self.texels * size_of::<[u32; 4]>()) as u64);
        let mut seconds = Some(0.0);
        for (light, held) in lights.iter().enumerate() {
            for (start, level) in self.starts.iter().zip(&ground.levels) {
                let map = &scene.surface.terrain.faces[level.face].map;
                let offset = light * self.texels + start;
                let spent = match maker {
                    Maker::Bake(pipeline) => {
                        let parameters = BakeParameters::new(map, &level.shader, held, offset as u32);
                        self.bake(gpu, pipeline, ground, &parameters, &fields)
                    }
                    Maker::Multiscale(method) => {
                        method.field(gpu, map, [level.face, level.level], held, &fields, PER_TEXEL * offset)
                    }
                };
                seconds = seconds.zip(spent).map(|(sum, spent)| sum + spent);
            }
        }
        (seconds, fields)
    }

    fn bake(
        &self,
        gpu: &Gpu,
        pipeline: &ComputePipeline,
        ground: &DeviceGround,
        parameters: &BakeParameters,
        fields: &Buffer,
    ) -> Option<f64> {
        let [a, b, c, d] = &ground.texels;
        let groups = workgroups((parameters.columns as usize * parameters.rows as usize).div_ceil(PER_TEXEL * GROUP));
        let parameters = gpu.storage("bake", &[*parameters]);
        gpu.run(pipeline, &[a, b, c, d, &parameters, fields, &self.disk_tables], groups)
    }

    fn send(&mut self, gpu: &Gpu, scene: &Scene, lights: &[HeldLight]) -> Result<Buffer, OutsideSwath> {
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

    /// The fields towards these lights as the host finds them; baked ones are made elsewhere.
    pub fn found_on_host(&mut self, scene: &Scene, lights: &[HeldLight]) -> Result<Skylines, OutsideSwath> {
        if let Some(method) = scene.shadows.towards().filter(|_| !matches!(self.maker, Some(Maker::Bake(_)))) {
            self.host = self.host.towards(&scene.surface, method, lights)?;
        }
        Ok(self.host.clone())
    }

    /// The fields that the device holds, read back where it made them.
    pub fn on_host(&mut self, gpu: &Gpu, scene: &Scene) -> Result<Skylines, RenderError> {
        let Some((lights, buffer)) = self.made.as_ref().filter(|(lights, _)| *lights != self.host.lights) else {
            return Ok(self.host.clone());
        };
        let values: Vec<[f32; 2]> = gpu.read(buffer)?;
        let field = |held: &HeldLight, [face, level]: [usize; 2]| -> Result<Field, RenderError> {
            let light = lights.iter().position(|light| light == held).unwrap_or_default();
            let start = self.start(scene, light, [face, level]);
            Ok(values[start..][..Feet::of(&scene.surface.terrain.faces[face].levels[level]).count()].to_vec())
        };
        let read = Skylines::default().found(&scene.surface, field, lights)?;
        self.host = read.clone();
        Ok(read)
    }
}
