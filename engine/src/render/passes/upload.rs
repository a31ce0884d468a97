//! The ground as the device holds it: the seen parts of all levels, one after the other.
//!
//! An adapter limits the size of one binding (128 MiB on software Vulkan). Gradients and horizon maps are the
//! largest arrays and may go over several bindings, in pages of a power of two of elements.

use rayon::prelude::*;
use wgpu::Buffer;

use crate::gpu::Gpu;
use crate::horizon::{Encoding, HorizonMap};
use crate::render::layout::{Ball, MapFace, MapLevel};
use crate::render::{RenderError, Scene, Shadows, View};
use crate::terrain::{Level, Pyramid, Surface, Terrain};

/// Gradients of nodes without heights; the shader takes slopes beyond 1e20 for gaps.
const GAP_SLOPE: f32 = 1e30;

/// Bindings of horizon maps, as in the shader.
const TEXEL_PAGES: usize = 4;

/// Bindings of gradients, as in the shader.
const GRADIENT_PAGES: usize = 2;

/// Buffers that stay on the device from view to view.
#[derive(Debug)]
pub struct DeviceGround {
    pub levels: Vec<PackedLevel>,
    /// Around each face's ground.
    pub balls: Vec<Ball>,
    pub heights: Buffer,
    pub gradients: [Buffer; GRADIENT_PAGES],
    pub maxima: Buffer,
    pub albedos: Buffer,
    pub skies: Buffer,
    pub texels: [Buffer; TEXEL_PAGES],
    /// That of all horizon maps: a pipeline decodes one.
    pub encoding: Encoding,
    /// `override` values that go with the texels, and with the gradients.
    pub pages: [(&'static str, f64); 2],
    pub constants: [(&'static str, f64); 2],
}

/// A level as the shader knows it, and where it comes from.
#[derive(Debug)]
pub struct PackedLevel {
    pub shader: MapLevel,
    pub face: usize,
    pub level: usize,
}

impl DeviceGround {
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, RenderError> {
        if let Shadows::Traced(_) = scene.shadows.as_ref() {
            return Err(RenderError::TracedOnGpu);
        }
        let (horizons, terrain) = (scene.shadows.maps(), &scene.surface.terrain);
        let mut store = Store::default();
        for (face, levels) in terrain.faces.iter().enumerate() {
            for level in 0..levels.levels.len() {
                let horizon = horizons.map(|maps| &maps[face][level]);
                let albedo = scene.albedo.as_ref().map(|maps| maps[face][level].as_slice());
                let sky = scene.ambient.as_ref().map(|ambient| ambient.shares[face][level].as_slice());
                store.add(&scene.surface, face, level, horizon, [albedo, sky]);
            }
        }
        let encodings = horizons.iter().flat_map(|maps| maps.iter().flatten()).map(|map| map.encoding);
        let encoding = encodings.clone().next().unwrap_or_default();
        if let Some(other) = encodings.clone().find(|other| *other != encoding) {
            return Err(RenderError::Encodings { first: encoding, other });
        }
        let (texel_bits, gradient_bits) = (page_bits::<[u32; 4]>(gpu), page_bits::<[f32; 2]>(gpu));
        let more_gradients = store.gradients.len() > 1 << gradient_bits;
        Ok(Self {
            heights: gpu.storage("lifted heights", checked(gpu, "lifted heights", &store.heights_m, 1)?),
            gradients: pages(gpu, "gradients", &store.gradients)?,
            maxima: gpu.storage("maxima", checked(gpu, "maxima", &store.maxima_m, 1)?),
            albedos: gpu.storage("albedos", checked(gpu, "albedos", &store.albedos, 1)?),
            skies: gpu.storage("skies", checked(gpu, "skies", &store.skies, 1)?),
            texels: pages(gpu, "horizon maps", &store.texels)?,
            encoding,
            pages: [
                ("PAGES", store.texels.len().div_ceil(1 << texel_bits).max(1) as f64),
                ("PAGE_BITS", f64::from(texel_bits)),
            ],
            constants: [
                ("GRADIENT_PAGE_BITS", f64::from(gradient_bits)),
                ("MORE_GRADIENTS", f64::from(u8::from(more_gradients))),
            ],
            levels: store.levels,
            balls: terrain.faces.par_iter().map(|face| Ball::about(&terrain.body, face)).collect(),
        })
    }

    /// Whether an adapter can hold a terrain, with horizon maps or without: asked before hours go into those.
    pub fn check(gpu: &Gpu, terrain: &Terrain, horizons: Option<Encoding>) -> Result<(), RenderError> {
        let seen = |level: &Level| level.seen_nodes();
        let nodes: usize = terrain.faces.iter().flat_map(|face| &face.levels).map(seen).sum();
        // Mips add a third to the cells.
        fits::<f32>(gpu, "maxima", nodes + nodes / 3, 1)?;
        fits::<[f32; 2]>(gpu, "gradients", nodes, GRADIENT_PAGES)?;
        let Some(encoding) = horizons else { return Ok(()) };
        let texels = (nodes as f64 * encoding.bytes_per_pixel() / 16.0) as usize;
        fits::<[u32; 4]>(gpu, "horizon maps", texels, TEXEL_PAGES)
    }
}

/// The same on the host.
#[derive(Debug, Default)]
struct Store {
    levels: Vec<PackedLevel>,
    heights_m: Vec<f32>,
    gradients: Vec<[f32; 2]>,
    maxima_m: Vec<f32>,
    texels: Vec<[u32; 4]>,
    albedos: Vec<f32>,
    skies: Vec<f32>,
}

impl Store {
    fn add(
        &mut self,
        surface: &Surface,
        face: usize,
        level: usize,
        horizon: Option<&HorizonMap>,
        at_nodes: [Option<&[f32]>; 2],
    ) {
        let full = &surface.terrain.faces[face].levels[level];
        let seen = full.seen();
        let pyramid = if full.margin == 0 { &surface.pyramids[face][level] } else { &Pyramid::new(&seen) };
        let mut shader = MapLevel::new(&seen, face);
        shader.heights_offset = self.heights_m.len() as u32;
        shader.maxima_offset = self.maxima_m.len() as u32;
        shader.mips = pyramid.mips.len() as u32;
        self.heights_m.extend(&seen.heights_m);
        self.gradients.extend(gradients(full));
        self.maxima_m.extend(pyramid.mips.iter().flat_map(|mip| &mip.maxima_m));
        for (stored, values) in [&mut self.albedos, &mut self.skies].into_iter().zip(at_nodes) {
            let Some(values) = values else { continue };
            stored.extend(seen_values(full, values));
        }
        if let Some(map) = horizon {
            shader.has_horizon = 1;
            let grid = map.append_to(&mut self.texels);
            shader.horizon = [grid.offset_0, grid.offset_1, grid.offset_2, grid.offset_3];
            shader.horizon_table = grid.table;
        }
        self.levels.push(PackedLevel { shader, face, level });
    }
}

/// A number given at the nodes of a level, at its seen nodes.
fn seen_values<'a>(level: &'a Level, values: &'a [f32]) -> impl Iterator<Item = &'a f32> {
    let cut = |row: usize| level.index(level.margin, row)..level.index(level.columns - level.margin, row);
    (level.margin..level.rows - level.margin).flat_map(move |row| &values[cut(row)])
}

/// A number given at the nodes of each face's levels, as the device keeps it.
pub fn seen(surface: &Surface, maps: &[Vec<Vec<f32>>]) -> Vec<f32> {
    let levels = surface.terrain.faces.iter().zip(maps).flat_map(|(face, maps)| face.levels.iter().zip(maps));
    levels.flat_map(|(level, values)| seen_values(level, values)).copied().collect()
}

impl PackedLevel {
    /// The level with its grid counted from the camera's cell.
    pub fn centred(&self, scene: &Scene, view: &View) -> MapLevel {
        let face = &scene.surface.terrain.faces[self.face];
        let Some(lifted) = MapFace::direct_start(&face.map, view.camera_position) else { return self.shader };
        let level = &face.levels[self.level];
        self.shader.about(level.grid_from_map(lifted.truncate()) - level.margin as f64)
    }
}

/// Gradients of the seen nodes; those without heights of their own are marked.
fn gradients(level: &Level) -> Vec<[f32; 2]> {
    let rows = level.margin..level.rows - level.margin;
    rows.into_par_iter()
        .flat_map_iter(|row| {
            (level.margin..level.columns - level.margin).map(move |column| {
                if level.gap[level.index(column, row)] {
                    [GAP_SLOPE; 2]
                } else {
                    level.gradient(column, row).as_vec2().to_array()
                }
            })
        })
        .collect()
}

/// Elements of a page, as a power of two, that the adapter takes in one binding.
fn page_bits<T>(gpu: &Gpu) -> u32 {
    (gpu.device.limits().max_storage_buffer_binding_size / size_of::<T>() as u64).ilog2().min(31)
}

pub fn fits<T>(gpu: &Gpu, what: &'static str, elements: usize, pages: usize) -> Result<(), RenderError> {
    let allowed = pages << page_bits::<T>(gpu);
    let mib = |elements: usize| (elements as u64 * size_of::<T>() as u64) >> 20;
    if elements <= allowed {
        return Ok(());
    }
    Err(RenderError::BufferTooLarge { what, needed_mib: mib(elements), allowed_mib: mib(allowed) })
}

fn checked<'a, T>(gpu: &Gpu, what: &'static str, values: &'a [T], pages: usize) -> Result<&'a [T], RenderError> {
    fits::<T>(gpu, what, values.len(), pages).map(|()| values)
}

fn pages<T: bytemuck::Pod, const N: usize>(
    gpu: &Gpu,
    what: &'static str,
    values: &[T],
) -> Result<[Buffer; N], RenderError> {
    let mut chunks = checked(gpu, what, values, N)?.chunks(1 << page_bits::<T>(gpu));
    Ok(std::array::from_fn(|_| gpu.storage(what, chunks.next().unwrap_or(&[]))))
}
