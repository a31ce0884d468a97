//! The pyramid's images on a graphics device, and fields of skylines from them.
//!
//! `multiscale.wgsl` takes the steps of [`super::Multiscale`] in `f32`: which image serves a scale, distances and where
//! images lie to each other are settled here in `f64`. `tests/conformance/multiscale.rs` holds the two together.

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, IVec2, UVec2, Vec2, Vec3};
use wgpu::{Buffer, ComputePipeline};

use super::{EDGE, HeightPyramid, Multiscale};
use crate::gpu::{Gpu, GpuError, workgroups};
use crate::shadow::device::FieldMaker;
use crate::shadow::light::QuantizedLight;
use crate::shadow::skylines::SurfacePoints;
use crate::terrain::{Face, Gnomonic, Terrain};

/// The pass, as one text.
pub const SHADER: &str = concat!(include_str!("multiscale.wgsl"), include_str!("../../horizon/arc_tangent.wgsl"));

/// Nodes of a workgroup, as in the shader.
const GROUP: u32 = 64;
/// Rates of images are split at this share: products of its multiples with halves of less than 2¹⁵ are exact.
const EXACT_RATE: f64 = 1.0 / 512.0;

/// A level's seen nodes and a light; see the shader.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Nodes {
    pub light: Vec3,
    pub swath_rad: f32,
    pub turn: Vec2,
    pub first: Vec2,
    pub spacing: f32,
    pub radius_m: f32,
    pub seen: UVec2,
    pub margin: u32,
    pub offset: u32,
    pub levels: u32,
    pub scales: u32,
}

/// An image as seen from a level; see the shader.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct Image {
    pub whole: IVec2,
    pub rest: Vec2,
    pub texels: IVec2,
    pub rate: Vec2,
    pub per_m: f32,
    pub start: u32,
}

/// The method on a device, ready for a terrain.
#[derive(Debug)]
pub struct OnDevice {
    pipeline: ComputePipeline,
    /// By face and level.
    levels: Vec<Vec<OnLevel>>,
}

#[derive(Debug)]
struct OnLevel {
    nodes: Nodes,
    images: Buffer,
    distances_m: Buffer,
    /// Of all images of the face.
    heights_m: Buffer,
}

impl OnDevice {
    /// `None` where a face's images take more than a buffer may.
    pub fn new(gpu: &Gpu, method: &Multiscale, terrain: &Terrain) -> Result<Option<Self>, GpuError> {
        let bytes = |pyramids: &Vec<HeightPyramid>| pyramids.iter().map(HeightPyramid::bytes).sum::<usize>() as u64;
        let most = method.pyramids.iter().map(bytes).max().unwrap_or(0);
        if most > gpu.device.limits().max_storage_buffer_binding_size {
            return Ok(None);
        }
        let of_face = |(face, pyramids): (&Face, &Vec<HeightPyramid>)| {
            let images = pyramids.iter().flat_map(|pyramid| &pyramid.images);
            let heights_m: Vec<f32> = images.flat_map(|image| &image.heights_m).copied().collect();
            let heights_m = gpu.storage("images of heights", &heights_m);
            let levels = 0..face.levels.len();
            levels.map(|level| OnLevel::new(gpu, method, face, pyramids, level, heights_m.clone())).collect()
        };
        let levels = terrain.faces.iter().zip(&method.pyramids).map(of_face).collect();
        Ok(Some(Self { pipeline: gpu.compute("multiscale", SHADER, "main", &[("EDGE", EDGE)])?, levels }))
    }
}

impl FieldMaker for OnDevice {
    fn field(
        &self,
        gpu: &Gpu,
        map: &Gnomonic,
        [face, level]: [usize; 2],
        light: &QuantizedLight,
        fields: &Buffer,
        offset: usize,
    ) -> Option<f64> {
        let on_level = &self.levels[face][level];
        let light = map.map_vector(light.position).normalize().as_vec3();
        let nodes = gpu.storage("nodes", &[Nodes { light, offset: offset as u32, ..on_level.nodes }]);
        let groups = workgroups(on_level.nodes.seen.element_product().div_ceil(GROUP) as usize);
        let buffers = [&nodes, &on_level.images, &on_level.distances_m, &on_level.heights_m, fields];
        gpu.run(&self.pipeline, &buffers, groups)
    }
}

impl OnLevel {
    /// A level of a face whose pyramids' images lie one after the other in `heights_m`.
    fn new(
        gpu: &Gpu,
        method: &Multiscale,
        face: &Face,
        pyramids: &[HeightPyramid],
        level: usize,
        heights_m: Buffer,
    ) -> Self {
        let (own, points) = (&face.levels[level], SurfacePoints::of(&face.levels[level]));
        let scales: Vec<[f64; 2]> = method.scales(&pyramids[level..]).collect();
        let texels_m = std::iter::once(0.0).chain(scales.iter().map(|[_, texel_m]| *texel_m));
        let seen_from = &pyramids[level].images[0];
        let images: Vec<Image> = texels_m
            .flat_map(|texel_m| {
                (level..pyramids.len()).map(move |other| Image::new(pyramids, other, texel_m, seen_from))
            })
            .collect();
        let distances_m: Vec<f32> = scales.iter().map(|[distance_m, _]| *distance_m as f32).collect();
        let radius_m = face.map.radius_m;
        let nodes = Nodes {
            light: Vec3::ZERO,
            swath_rad: method.swath_rad as f32,
            turn: DVec2::from_angle(0.5 * method.swath_rad).as_vec2(),
            first: (own.node_m(own.margin, own.margin) / radius_m).as_vec2(),
            spacing: (own.posting_m / radius_m) as f32,
            radius_m: radius_m as f32,
            seen: UVec2::new(points.columns as u32, points.rows as u32),
            margin: own.margin as u32,
            offset: 0,
            levels: (pyramids.len() - level) as u32,
            scales: scales.len() as u32,
        };
        let (images, distances_m) = (gpu.storage("images", &images), gpu.storage("distances", &distances_m));
        Self { nodes, images, distances_m, heights_m }
    }
}

impl Image {
    /// The image of a level's pyramid whose texels are nearest to a size, as seen from the nodes of another level.
    fn new(pyramids: &[HeightPyramid], level: usize, texel_m: f64, seen_from: &super::Image) -> Self {
        let index = pyramids[level].image(texel_m);
        let image = &pyramids[level].images[index];
        let start = (seen_from.corner_m - image.corner_m) / image.texel_m;
        let rate = seen_from.texel_m / image.texel_m;
        let exact_rate = (rate / EXACT_RATE).round() * EXACT_RATE;
        let before =
            pyramids[..level].iter().flat_map(|pyramid| &pyramid.images).chain(&pyramids[level].images[..index]);
        Self {
            whole: start.floor().as_ivec2(),
            // A texel's middle is its place.
            rest: (start - start.floor() - 0.5).as_vec2(),
            texels: IVec2::new(image.columns as i32, image.rows as i32),
            rate: DVec2::new(exact_rate, rate - exact_rate).as_vec2(),
            per_m: (1.0 / image.texel_m) as f32,
            start: before.map(|image| image.heights_m.len()).sum::<usize>() as u32,
        }
    }
}
