//! The ground as the device holds it: the seen parts of all levels, one after the other.
//!
//! Gradients are the largest array and may go over several bindings.

use rayon::prelude::*;
use wgpu::Buffer;

use crate::gpu::{Gpu, GpuError};
use crate::render::layout::{Ball, MapFace, MapLevel};
use crate::render::{Scene, View};
use crate::terrain::{Level, Pyramid, Surface, Terrain};

/// Gradients of nodes without heights; the shader takes slopes beyond 1e20 for gaps.
const GAP_SLOPE: f32 = 1e30;

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
    /// `override` values that go with the gradients.
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
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        let terrain = &scene.surface.terrain;
        let mut store = Store::default();
        for (face, levels) in terrain.faces.iter().enumerate() {
            for level in 0..levels.levels.len() {
                let albedo = scene.albedo.as_ref().map(|maps| maps[face][level].as_slice());
                let sky = scene.ambient.as_ref().map(|ambient| ambient.shares[face][level].as_slice());
                store.add(&scene.surface, face, level, [albedo, sky]);
            }
        }
        let gradient_bits = gpu.page_bits::<[f32; 2]>();
        let more_gradients = store.gradients.len() > 1 << gradient_bits;
        Ok(Self {
            heights: gpu.storage("lifted heights", checked(gpu, "lifted heights", &store.heights_m, 1)?),
            gradients: gpu.pages("gradients", &store.gradients)?,
            maxima: gpu.storage("maxima", checked(gpu, "maxima", &store.maxima_m, 1)?),
            albedos: gpu.storage("albedos", checked(gpu, "albedos", &store.albedos, 1)?),
            skies: gpu.storage("skies", checked(gpu, "skies", &store.skies, 1)?),
            constants: [
                ("GRADIENT_PAGE_BITS", f64::from(gradient_bits)),
                ("MORE_GRADIENTS", f64::from(u8::from(more_gradients))),
            ],
            levels: store.levels,
            balls: terrain.faces.par_iter().map(|face| Ball::about(&terrain.body, face)).collect(),
        })
    }

    /// Whether an adapter can hold a terrain: asked before hours go into its horizons.
    pub fn check(gpu: &Gpu, terrain: &Terrain) -> Result<(), GpuError> {
        let nodes = terrain.seen_nodes();
        // Mips add a third to the cells.
        gpu.fits::<f32>("maxima", nodes + nodes / 3, 1)?;
        gpu.fits::<[f32; 2]>("gradients", nodes, GRADIENT_PAGES)
    }
}

/// Buffers that are about to be uploaded.
#[derive(Debug, Default)]
struct Store {
    levels: Vec<PackedLevel>,
    heights_m: Vec<f32>,
    gradients: Vec<[f32; 2]>,
    maxima_m: Vec<f32>,
    albedos: Vec<f32>,
    skies: Vec<f32>,
}

impl Store {
    fn add(&mut self, surface: &Surface, face: usize, level: usize, at_nodes: [Option<&[f32]>; 2]) {
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
        self.levels.push(PackedLevel { shader, face, level });
    }
}

/// A number given at the nodes of a level, at its seen nodes.
fn seen_values<'a>(level: &'a Level, values: &'a [f32]) -> impl Iterator<Item = &'a f32> {
    let cut = |row: usize| level.index(level.margin, row)..level.index(level.columns - level.margin, row);
    (level.margin..level.rows - level.margin).flat_map(move |row| &values[cut(row)])
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

fn checked<'a, T>(gpu: &Gpu, what: &'static str, values: &'a [T], pages: usize) -> Result<&'a [T], GpuError> {
    gpu.fits::<T>(what, values.len(), pages).map(|()| values)
}
