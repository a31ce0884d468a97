//! The horizons of all nodes of a level, one azimuth at a time, on a graphics device.
//!
//! One invocation looks from one node along one line: it walks blocks of 2ᵏ × 2ᵏ cells, climbs to a longer block where
//! one begins and descends where a block's maximum `M` may hide something steeper than the slope `s` found so far,
//!
//! ```text
//! M − H₀ > min(s a, s b)
//! ```
//!
//! between the distances `a` and `b` at which the line enters and leaves it ([`super::exact`] has the same test for many nodes
//! at once). In a cell the slope is the bilinear surface's own. `gpu.wgsl` is in `f32`; its reference is
//! [`super::trace`], and `tests/reference/horizon/gpu.rs` holds the two together.
//!
//! # Assumptions
//! Levels finer than the searched one do not exist. A gap's neighbours count within
//! a thousandth of a posting. Elevations differ from traced ones by the rounding of places to 2⁻²⁴ of a grid: 0.002° at most
//! on grids of 2048².

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, IVec2, Vec2};

use super::axis::Major;
use super::error::Error;
use super::observer::ON_GROUND_M;
use super::receivers::Receivers;
use super::settings::Settings;
use super::sweep::grid::{HeightGrid, middle_m};
use crate::gpu::{CUT_SHORT_TURNS, Gpu, GpuError};
use crate::terrain::Face;

/// Nodes side by side that a workgroup looks from, as in the shader.
const GROUP: u32 = 64;
/// The elevation where loops were cut short, as in the shader.
const CUT_SHORT: f32 = 1e30;
/// Blocks are no longer than 2 to this power.
const MIPS: usize = 8;

/// An azimuth; see the shader.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Ray {
    direction: Vec2,
    first: Vec2,
    end: Vec2,
    spacing: f32,
    search_m: f32,
    radius_m: f32,
    datum_m: f32,
    majors: u32,
    minors: u32,
    stride: u32,
    on_ground: u32,
    levels: u32,
    turns: u32,
}

/// A level; see the shader.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Nodes {
    start: Vec2,
    spacing: f32,
    posting_m: f32,
    nodes: IVec2,
    stride: u32,
    first_height: u32,
    first_mip: u32,
    mips: u32,
    unused: [u32; 2],
}

/// A level's terrain on the device, and all that the azimuths along one major axis share.
#[derive(Debug)]
pub struct OnDevice<'a> {
    gpu: &'a Gpu,
    pipeline: wgpu::ComputePipeline,
    /// Levels, tables of maxima, heights, maxima, observers.
    buffers: [wgpu::Buffer; 5],
    major: Major,
    ray: Ray,
    /// Least and greatest map (major, minor) coordinates of the terrain, in map radii.
    ends: [DVec2; 2],
    pub receivers: Receivers,
}

impl<'a> OnDevice<'a> {
    /// Prepares one level of a face for the azimuths along `major` on an open device.
    pub fn new(gpu: &'a Gpu, face: &Face, level: usize, major: Major, settings: &Settings) -> Result<Self, Error> {
        let shader =
            concat!(include_str!("gpu.wgsl"), include_str!("arc_tangent.wgsl"), include_str!("../gpu/cut_short.wgsl"));
        let pipeline = gpu.compute("horizons", shader, "main", &[])?;
        let levels = &face.levels[level..];
        let datum_m = middle_m(&levels[0]);
        let grids: Vec<_> = levels.iter().map(|level| HeightGrid::new(level, major, 0, datum_m)).collect();
        let receivers = Receivers::new(face, &levels[0], major, datum_m, settings);
        let first_m = grids[0].origin_m + DVec2::splat(receivers.margin as f64 * grids[0].posting_m);

        let (mut nodes, mut tables, mut heights_m, mut maxima_m) = (vec![], vec![], vec![], vec![]);
        for grid in &grids {
            let mips = maxima(grid);
            nodes.push(Nodes {
                start: ((first_m - grid.origin_m) / grid.posting_m).as_vec2(),
                spacing: (grids[0].posting_m / grid.posting_m) as f32,
                posting_m: grid.posting_m as f32,
                nodes: IVec2::new(grid.majors as i32, grid.minors as i32),
                stride: grid.stride as u32,
                first_height: heights_m.len() as u32,
                first_mip: tables.len() as u32,
                mips: mips.len() as u32,
                unused: [0; 2],
            });
            heights_m.extend_from_slice(&grid.heights_m);
            for (stride, mip_m) in mips {
                tables.push([maxima_m.len() as u32, stride as u32]);
                maxima_m.extend(mip_m);
            }
        }
        let buffers = [
            gpu.storage("levels", &nodes),
            gpu.storage("tables of maxima", &tables),
            gpu.storage("heights", &heights_m),
            gpu.storage("maxima", &maxima_m),
            gpu.storage("observers", &receivers.observers_m),
        ];
        let radius_m = face.map.radius_m;
        let coarsest = grids.last().expect("a face has levels");
        let span_m = DVec2::new((coarsest.majors - 1) as f64, (coarsest.minors - 1) as f64) * coarsest.posting_m;
        let ray = Ray {
            first: (first_m / radius_m).as_vec2(),
            spacing: (grids[0].posting_m / radius_m) as f32,
            search_m: settings.search_limit_m().min(1e30) as f32,
            radius_m: radius_m as f32,
            datum_m: datum_m as f32,
            majors: receivers.majors as u32,
            minors: receivers.minors as u32,
            stride: receivers.stride as u32,
            on_ground: u32::from(settings.observer_height_m < ON_GROUND_M),
            levels: grids.len() as u32,
            turns: CUT_SHORT_TURNS,
            ..Ray::zeroed()
        };
        let ends = [coarsest.origin_m / radius_m, (coarsest.origin_m + span_m) / radius_m];
        Ok(Self { gpu, pipeline, buffers, major, ray, ends, receivers })
    }

    /// Elevations of the skyline in a unit map direction along this axis, as `receivers` are laid out, in radians, and
    /// the seconds that the device took where it tells them.
    pub fn timed_elevations_rad(&self, direction: DVec2) -> Result<(Vec<f32>, Option<f64>), GpuError> {
        let direction = self.major.split(direction);
        let [low, high] = self.ends;
        let end = DVec2::select(direction.cmpgt(DVec2::ZERO), high, low).as_vec2();
        let ray = self.gpu.uniform("ray", &Ray { direction: direction.as_vec2(), end, ..self.ray });
        let count = self.receivers.observers_m.len();
        let elevations_rad = self.gpu.output("elevations", (count * size_of::<f32>()) as u64);
        let [levels, tables, heights, maxima, observers] = &self.buffers;
        let buffers = [&ray, levels, tables, heights, maxima, observers, &elevations_rad];
        let groups = [self.ray.minors.div_ceil(GROUP), self.ray.majors, 1];
        let seconds = self.gpu.run(&self.pipeline, &buffers, groups);
        let elevations_rad = self.gpu.read(&elevations_rad)?;
        match elevations_rad.contains(&CUT_SHORT) {
            true => Err(GpuError::CutShort { what: "horizons" }),
            false => Ok((elevations_rad, seconds)),
        }
    }

    /// The elevations alone.
    pub fn elevations_rad(&self, direction: DVec2) -> Result<Vec<f32>, GpuError> {
        Ok(self.timed_elevations_rad(direction)?.0)
    }

    /// The device on one line.
    pub fn describe(&self) -> String {
        self.gpu.describe()
    }
}

/// Maxima of the nodes of blocks of 2, 4, 8 … cells, with their strides.
fn maxima(grid: &HeightGrid) -> Vec<(usize, Vec<f32>)> {
    let (mut majors, mut minors) = (grid.majors - 1, grid.minors - 1);
    let mut mips: Vec<(usize, Vec<f32>)> = Vec::new();
    while mips.len() < MIPS && majors.max(minors) > 1 {
        let (rows, columns) = (majors.div_ceil(2), minors.div_ceil(2));
        let top = |u: usize, v: usize| match mips.last() {
            // A block's last nodes are its neighbour's first.
            None => grid.heights_m[grid.at(u.min(grid.majors - 1), v.min(grid.minors - 1))],
            Some((stride, finer_m)) => finer_m[u.min(majors - 1) * stride + v.min(minors - 1)],
        };
        let reach = if mips.is_empty() { 2 } else { 1 };
        let highest_m = |u: usize, v: usize| {
            let nodes = (0..=reach).flat_map(|du| (0..=reach).map(move |dv| (2 * u + du, 2 * v + dv)));
            nodes.map(|(u, v)| top(u, v)).fold(f32::NEG_INFINITY, f32::max)
        };
        let mip_m = (0..rows * columns).map(|at| highest_m(at / columns, at % columns)).collect();
        mips.push((columns, mip_m));
        (majors, minors) = (rows, columns);
    }
    mips
}
