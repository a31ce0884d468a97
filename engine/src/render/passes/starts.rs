//! Where view rays start that are not cast from the camera: the depths of a coarse mesh, drawn once a view.
//!
//! Jung 2020's rays start at the fragments of a mesh whose vertices are displaced by the terrain. Here the mesh lies above
//! the terrain ([`Mesh`]) and is drawn alone; the rays of all samples look their start up, whatever the lens does to them,
//! step a cell at a time and narrow the last step. A ray that finds nothing in so many steps is cast exactly from where it
//! is. On software Vulkan all this takes 1.4 times as long as exact rays do (squares of 8 cells; `sim bench frame`): the
//! walk over maxima passes empty space in a few steps. What is lost is ground thinner than a step: 0.01 % of the pixels of
//! an oblique view of craters have another radiance.
//!
//! ```text
//! depth = NEAR_M / z,   distance = NEAR_M / depth · |(x, y, 1)|      the nearest has the largest depth; 0: no mesh
//! ```
//!
//! # References
//! Jung, Schrempp, Son (2020), Fast Soft Shadows on Curved Terrain with Dynamic Programming and Maximum Mipmaps, section 4.

use bytemuck::Zeroable;
use wgpu::{Buffer, RenderPipeline};

use crate::gpu::{Depths, Gpu};
use crate::render::layout::RayWindow;
use crate::render::{RenderError, Scene, View};
use crate::terrain::{Level, Mesh};

/// The drawing pass, as one text.
pub const SHADER: &str =
    concat!(include_str!("../mesh.wgsl"), include_str!("../ray_window.wgsl"), include_str!("../../terrain/maps.wgsl"));

/// Nothing nearer than this to the camera's plane is drawn.
const NEAR_M: f32 = 0.01;

/// The meshes of a scene's levels.
#[derive(Debug)]
pub struct DeviceMesh {
    pipeline: RenderPipeline,
    corners: Buffer,
    /// Corners of each level, and the level.
    draws: Vec<(std::ops::Range<u32>, u32)>,
    /// By face.
    meshes: Vec<Vec<Mesh>>,
}

/// What the rays of a view read.
#[derive(Debug)]
pub struct Starts {
    pub window: Buffer,
    pub depths: Buffer,
}

impl Starts {
    /// Rays are cast from the camera.
    pub fn at_the_camera(gpu: &Gpu) -> Self {
        let depths = gpu.storage::<f32>("depths", &[]);
        Self { window: gpu.storage("ray window", &[RayWindow::zeroed()]), depths }
    }
}

impl DeviceMesh {
    pub fn new(gpu: &Gpu, scene: &Scene, cells: usize) -> Result<Self, RenderError> {
        let terrain = &scene.surface.terrain;
        let of_face = |face: usize| {
            let seen: Vec<Level> = terrain.faces[face].levels.iter().map(Level::seen).collect();
            Mesh::of_face(&terrain.faces[face], &seen, cells)
        };
        let meshes: Vec<Vec<Mesh>> = (0..terrain.faces.len()).map(of_face).collect();
        let mut corners = Vec::new();
        let mut draws = Vec::new();
        for (level, mesh) in (0..).zip(meshes.iter().flatten()) {
            let first = corners.len() as u32;
            corners.extend_from_slice(&mesh.corners);
            draws.push((first..corners.len() as u32, level));
        }
        gpu.fits::<[f32; 3]>("corners of the coarse mesh", corners.len(), 1)?;
        let pipeline = gpu.depth_pipeline("coarse mesh", SHADER, "corner")?;
        Ok(Self { pipeline, corners: gpu.storage("corners", &corners), draws, meshes })
    }

    /// The starts of a view's rays, given its maps and their levels.
    pub fn starts(&self, gpu: &Gpu, scene: &Scene, view: &View, window: RayWindow, maps: [&Buffer; 2]) -> Starts {
        if self.is_above(scene, view) {
            return Starts::at_the_camera(gpu);
        }
        let window = RayWindow { near_m: NEAR_M, ..window };
        let drawn = gpu.storage("ray window", &[window]);
        let buffers = [&drawn, maps[0], maps[1], &self.corners];
        let Depths { buffer, pitch } =
            gpu.draw_depths(&self.pipeline, &buffers, &self.draws, [window.columns, window.rows]);
        Starts { window: gpu.storage("ray window", &[RayWindow { pitch, ..window }]), depths: buffer }
    }

    /// Whether the mesh is above the camera, so that rays leave it where they should enter.
    fn is_above(&self, scene: &Scene, view: &View) -> bool {
        scene.surface.terrain.faces.iter().zip(&self.meshes).any(|(face, meshes)| {
            let Some(camera) = face.map.lifted_from_body(view.camera_position) else { return false };
            face.levels.iter().zip(meshes).any(|(level, mesh)| {
                let grid = level.grid_from_map(camera.truncate()) - level.margin as f64;
                mesh.height_m(grid).is_some_and(|mesh_m| mesh_m >= camera.z)
            })
        })
    }
}
