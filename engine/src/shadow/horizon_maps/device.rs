//! Horizon maps on a graphics device: read at every sample, or evaluated there once for each node.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;
use wgpu::{Buffer, ComputePipeline};

use super::visibility::Visibility;
use crate::gpu::{Gpu, GpuError, workgroups};
use crate::horizon::{Encoding, HorizonMap};
use crate::photometry::{SOLAR_DISK_WGSL, SolarDisk};
use crate::shadow::device::{
    BINDINGS, DeviceError, DevicePart, FIELDS_WGSL, FieldMaker, Fields, LevelTexels, SKYLINE_WGSL,
};
use crate::shadow::light::QuantizedLight;
use crate::terrain::{AZIMUTH_RATIO_WGSL, Gnomonic, Surface};

const TEXELS: &str = include_str!("texels.wgsl");
const VISIBILITY: &str = include_str!("visibility.wgsl");
const SAMPLES: &str = include_str!("samples.wgsl");
const SAMPLE_FACTORS: &str = include_str!("sample_factors.wgsl");
const NODE_FACTORS: &str = include_str!("node_factors.wgsl");
const SKYLINE_OF_NODE: &str = include_str!("skyline_of_node.wgsl");
const FACTOR_OF_NODE: &str = include_str!("factor_of_node.wgsl");

/// The pass over nodes without what it makes of a map.
pub const NODES: &str = concat!(include_str!("nodes.wgsl"), include_str!("texels.wgsl"));

/// Nodes in a texel of a field, and invocations of one workgroup, as in the shader.
const PER_TEXEL: usize = 2;
const GROUP: usize = 64;

/// Horizon maps in texels, and what decodes them.
#[derive(Debug, Clone)]
pub struct DeviceMaps {
    buffers: [Buffer; BINDINGS],
    levels: Vec<LevelTexels>,
    encoding: Encoding,
    pages: [(&'static str, f64); 2],
}

impl DeviceMaps {
    pub fn new(gpu: &Gpu, maps: &[Vec<HorizonMap>]) -> Result<Self, DeviceError> {
        let mut encodings = maps.iter().flatten().map(|map| map.encoding);
        let encoding = encodings.next().unwrap_or_default();
        if let Some(other) = encodings.find(|other| *other != encoding) {
            return Err(DeviceError::Encodings { first: encoding, other });
        }
        let mut texels = Vec::new();
        let mut of_level = |map: &HorizonMap| {
            let grid = map.append_to(&mut texels);
            LevelTexels { pages: [grid.offset_0, grid.offset_1, grid.offset_2, grid.offset_3], table: grid.table }
        };
        let levels = maps.iter().flatten().map(&mut of_level).collect();
        let bits = gpu.page_bits::<[u32; 4]>();
        let count = texels.len().div_ceil(1 << bits).max(1);
        let buffers = gpu.pages("horizon maps", &texels)?;
        Ok(Self { buffers, levels, encoding, pages: [("PAGES", count as f64), ("PAGE_BITS", f64::from(bits))] })
    }

    /// Whether an adapter can hold the maps of so many nodes.
    pub fn check(gpu: &Gpu, nodes: usize, encoding: Encoding) -> Result<(), GpuError> {
        let texels = (nodes as f64 * encoding.bytes_per_pixel() / 16.0) as usize;
        gpu.fits::<[u32; 4]>("horizon maps", texels, BINDINGS)
    }

    fn constants(&self) -> Vec<(&'static str, f64)> {
        [&self.pages[..], &self.encoding.constants()].concat()
    }

    /// Evaluated at every sample: the disc above the skyline, or a lighting factor.
    pub fn at_samples(self, factor: Option<Visibility>) -> DevicePart {
        let mut constants = self.constants();
        constants.extend(factor.iter().flat_map(|factor| factor.constants()));
        let method = match factor {
            None => [SKYLINE_WGSL, SAMPLES].concat(),
            Some(_) => [VISIBILITY, SAMPLE_FACTORS].concat(),
        };
        DevicePart {
            buffers: self.buffers.to_vec(),
            texels: self.levels,
            ..DevicePart::of([TEXELS, &self.encoding.wgsl(), &method].concat(), constants)
        }
    }

    /// Evaluated once for each node: skylines, or lighting factors.
    pub fn at_nodes(
        self,
        gpu: &Gpu,
        surface: &Surface,
        disk: &SolarDisk,
        factor: Option<Visibility>,
    ) -> Result<DevicePart, DeviceError> {
        let maker: Box<dyn FieldMaker> = Box::new(NodesPass::new(gpu, self, surface, disk, factor)?);
        Ok(match factor {
            None => DevicePart::of_skylines(Some(maker), 0),
            Some(_) => DevicePart {
                fields: Some(Fields::Device(maker)),
                ..DevicePart::of([FIELDS_WGSL, NODE_FACTORS].concat(), Vec::new())
            },
        })
    }
}

/// A level and a light; see the shader.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct NodesParameters {
    pub direction: [f32; 4],
    pub south_west_m: [f32; 2],
    pub posting_m: f32,
    pub radius_m: f32,
    pub offset: u32,
    pub columns: u32,
    pub rows: u32,
    pub horizon_table: u32,
    pub horizon: [u32; 4],
    pub radius_rad: f32,
    pub padding: [u32; 3],
}

/// Evaluates maps for each node.
#[derive(Debug)]
struct NodesPass {
    pipeline: ComputePipeline,
    buffers: [Buffer; BINDINGS],
    /// Of lighting factors.
    disk_tables: Option<Buffer>,
    /// By face and level, but for the light.
    levels: Vec<Vec<NodesParameters>>,
}

impl NodesPass {
    fn new(
        gpu: &Gpu,
        maps: DeviceMaps,
        surface: &Surface,
        disk: &SolarDisk,
        factor: Option<Visibility>,
    ) -> Result<Self, GpuError> {
        let mut constants = maps.constants();
        let value = match factor {
            None => SKYLINE_OF_NODE.to_owned(),
            Some(factor) => {
                constants.extend(disk.constants().into_iter().chain(factor.constants()));
                [FACTOR_OF_NODE, VISIBILITY, SOLAR_DISK_WGSL, AZIMUTH_RATIO_WGSL].concat()
            }
        };
        let shader = [NODES, &value, &maps.encoding.wgsl()].concat();
        let mut texels = maps.levels.iter();
        let mut of_level = |radius_m: f64, level: &crate::terrain::Level| {
            let texels = texels.next()?;
            let south_west_m = level.node_m(level.margin, level.margin);
            Some(NodesParameters {
                south_west_m: south_west_m.as_vec2().to_array(),
                posting_m: level.posting_m as f32,
                radius_m: radius_m as f32,
                columns: level.seen_size()[0] as u32,
                rows: level.seen_size()[1] as u32,
                horizon_table: texels.table,
                horizon: texels.pages,
                ..NodesParameters::zeroed()
            })
        };
        let faces = surface.terrain.faces.iter();
        let levels = faces
            .map(|face| face.levels.iter().filter_map(|level| of_level(face.map.radius_m, level)).collect())
            .collect();
        Ok(Self {
            pipeline: gpu.compute("horizon maps at nodes", &shader, "main", &constants)?,
            buffers: maps.buffers,
            disk_tables: factor.map(|_| gpu.storage("disc tables", &disk.tables())),
            levels,
        })
    }
}

impl FieldMaker for NodesPass {
    fn field(
        &self,
        gpu: &Gpu,
        map: &Gnomonic,
        [face, level]: [usize; 2],
        light: &QuantizedLight,
        fields: &Buffer,
        offset: usize,
    ) -> Option<f64> {
        let vector_m: DVec3 = map.map_vector(light.position);
        let distance_m = vector_m.length();
        let direction = (vector_m / distance_m).as_vec3().extend((1.0 / distance_m) as f32).to_array();
        let parameters = NodesParameters {
            direction,
            offset: (offset / PER_TEXEL) as u32,
            radius_rad: light.angular_radius_rad as f32,
            ..self.levels[face][level]
        };
        let nodes = parameters.columns as usize * parameters.rows as usize;
        let parameters = gpu.storage("nodes", &[parameters]);
        let mut buffers: Vec<(u32, &Buffer)> = (0..).zip(&self.buffers).collect();
        buffers.extend([(4, &parameters), (5, fields)]);
        buffers.extend(self.disk_tables.iter().map(|tables| (6, tables)));
        gpu.run_bound(&self.pipeline, &buffers, workgroups(nodes.div_ceil(PER_TEXEL * GROUP)))
    }
}
