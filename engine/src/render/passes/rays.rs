//! Directions of rays, tabulated once for all exposures of a camera, distortion included.

use bytemuck::Zeroable;
use glam::{DVec2, UVec2, Vec2};
use rayon::prelude::*;
use wgpu::Buffer;

use crate::camera::Camera as Optics;
use crate::gpu::Gpu;
use crate::render::layout::RayWindow;

/// The shader takes rays beyond 1e20 for none.
const NO_RAY: f32 = 1e30;

/// Rays in one dispatch, at most: 32 MiB of directions.
const RAYS_AT_ONCE: usize = 4 << 20;

/// Whole rows of an image, with the directions of their rays.
#[derive(Debug)]
pub struct Band {
    pub pixels: usize,
    pub rays: Buffer,
}

impl Band {
    /// All bands of an image, each pixel with one ray through each of `points` (offsets from its centre), and the window
    /// that holds all rays.
    pub fn all(gpu: &Gpu, optics: &Optics, points: &[DVec2]) -> (Vec<Self>, RayWindow) {
        let (columns, rows) = (optics.columns as usize, optics.rows as usize);
        let rows_at_once = (RAYS_AT_ONCE / (points.len() * columns)).clamp(1, rows);
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        let bands = (0..rows)
            .step_by(rows_at_once)
            .map(|first| {
                let until = (first + rows_at_once).min(rows);
                let rays = directions(optics, first..until, points);
                for ray in rays.iter().filter(|ray| ray[0] < NO_RAY).map(|ray| Vec2::from(*ray)) {
                    (low, high) = (low.min(ray), high.max(ray));
                }
                Band { pixels: (until - first) * columns, rays: gpu.storage("rays", &rays) }
            })
            .collect();
        let allowed = gpu.device.limits().max_texture_dimension_2d;
        (bands, window([low, high], [optics.columns, optics.rows].map(|side| side.min(allowed))))
    }
}

/// A texel a pixel, the rays at its sides in the middle of the outermost ones.
fn window([low, high]: [Vec2; 2], [columns, rows]: [u32; 2]) -> RayWindow {
    let count = UVec2::new(columns, rows).as_vec2();
    let texel = (high - low).max(Vec2::splat(f32::MIN_POSITIVE)) / (count - 1.0).max(Vec2::ONE);
    RayWindow {
        low: (low - 0.5 * texel).to_array(),
        scale: texel.recip().to_array(),
        columns,
        rows,
        ..RayWindow::zeroed()
    }
}

/// `x/z, y/z` of each ray, pixel by pixel; `NO_RAY` where the optics see nothing.
fn directions(optics: &Optics, rows: std::ops::Range<usize>, points: &[DVec2]) -> Vec<[f32; 2]> {
    rows.into_par_iter()
        .flat_map_iter(|row| {
            (0..optics.columns).flat_map(move |column| {
                points.iter().map(move |offset| {
                    let pixel = DVec2::new(column as f64, row as f64) + *offset;
                    optics.direction(pixel).map_or([NO_RAY; 2], |direction| {
                        let d = direction.unit();
                        [(d.x / d.z) as f32, (d.y / d.z) as f32]
                    })
                })
            })
        })
        .collect()
}
