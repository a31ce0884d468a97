//! What the host and `passes.wgsl` tell each other: structs with one layout on both sides.
//!
//! `tests/conformance/layout.rs` parses the shader and compares every member's name and offset.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::{DMat3, DVec2, DVec3};

use super::{Light, View};
use crate::geometry::{Body, BodyFixed, Camera, Position, Rotation};
use crate::gpu::CUT_SHORT_TURNS;
use crate::shadow::device::LevelTexels;
use crate::terrain::{Face, Gnomonic, Level};

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct ViewParameters {
    pub from_camera_x: [f32; 4],
    pub from_camera_y: [f32; 4],
    pub from_camera_z: [f32; 4],
    pub scaled_camera: [f32; 4],
    pub radii_m: [f32; 4],
    pub camera_m: [f32; 4],
    pub pixels: u32,
    pub first_ray: u32,
    pub until_ray: u32,
    pub turns: u32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct RayWindow {
    pub low: [f32; 2],
    pub scale: [f32; 2],
    pub columns: u32,
    pub rows: u32,
    pub pitch: u32,
    pub near_m: f32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct MapFace {
    pub from_camera_x: [f32; 4],
    pub from_camera_y: [f32; 4],
    pub from_camera_z: [f32; 4],
    pub camera_m: [f32; 4],
    pub quotient: [f32; 4],
    pub bounds_m: [f32; 4],
    pub cone: [f32; 4],
    pub first_level: u32,
    pub levels: u32,
    pub direct: u32,
    pub open_edge: u32,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct MapLevel {
    pub base: [i32; 2],
    pub camera: [f32; 2],
    pub south_west_m: [f32; 2],
    pub posting_m: f32,
    pub columns: u32,
    pub rows: u32,
    pub mips: u32,
    pub heights_offset: u32,
    pub maxima_offset: u32,
    pub horizon: [u32; 4],
    pub face: u32,
    pub horizon_table: u32,
    pub bounced: [u32; 2],
}

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct LightParameters {
    pub direction: [f32; 4],
    pub radius_rad: f32,
    pub irradiance_w_m2: f32,
    pub padding: [u32; 2],
}

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct PixelOut {
    pub radiance: f32,
    pub irradiance: f32,
    pub fraction: f32,
    pub hit: f32,
}

impl PixelOut {
    /// Value of `hit` where the device ended loops before they were done.
    pub const CUT_SHORT: f32 = -2.0;
}

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct CentreOut {
    pub ground: u32,
    pub level: u32,
    pub cell: u32,
    pub padding: u32,
    pub fraction: [f32; 2],
    pub distance_m: f32,
    pub padding_2: f32,
}

impl CentreOut {
    pub const MISS: u32 = 0;
    pub const DEM: u32 = 1;
    pub const GAP: u32 = 2;
}

fn rows(matrix: DMat3) -> [[f32; 4]; 3] {
    [0, 1, 2].map(|i| matrix.row(i).as_vec3().extend(0.0).to_array())
}

fn with_w(vector: DVec3, w: f64) -> [f32; 4] {
    vector.extend(w).as_vec4().to_array()
}

impl ViewParameters {
    /// Of the `rays` of each of so many pixels.
    pub fn new(body: &Body, view: &View, pixels: usize, rays: Range<usize>) -> Self {
        let body_from_camera: Rotation<BodyFixed, Camera> = view.camera_from_body.inverse();
        let [x, y, z] = rows(body_from_camera.matrix());
        let radii_m = DVec3::new(body.equatorial_radius_m, body.equatorial_radius_m, body.polar_radius_m);
        let camera_m = view.camera_position.vector_m();
        let scaled = camera_m / radii_m;
        Self {
            from_camera_x: x,
            from_camera_y: y,
            from_camera_z: z,
            scaled_camera: with_w(scaled, scaled.length_squared() - 1.0),
            radii_m: with_w(radii_m, 0.0),
            camera_m: with_w(camera_m, 0.0),
            pixels: pixels as u32,
            first_ray: rays.start as u32,
            until_ray: rays.end as u32,
            turns: CUT_SHORT_TURNS,
        }
    }
}

/// A camera this far above a map's plane, in radii, starts its rays there; others start where they enter
/// the map's pyramid.
const DIRECT_ABOVE_RADII: f64 = 0.1;

impl MapFace {
    pub fn new(view: &View, face: &Face, ball: &Ball, first_level: usize, open_edge: bool) -> Self {
        let map = &face.map;
        let [x, y, z] = rows((map.map_from_body * view.camera_from_body.inverse()).matrix());
        let camera_m = map.map_vector(view.camera_position);
        let start = Self::direct_start(map, view.camera_position);
        let (low, high) = face.levels.last().map_or((DVec2::ZERO, DVec2::ZERO), Level::seen_m);
        let quotient = DVec3::new(camera_m.x, camera_m.y, map.radius_m) / camera_m.z;
        Self {
            from_camera_x: x,
            from_camera_y: y,
            from_camera_z: z,
            camera_m: with_w(camera_m, map.radius_m),
            quotient: start.map_or([0.0; 4], |lifted| with_w(quotient, lifted.z)),
            bounds_m: [low.x as f32, low.y as f32, high.x as f32, high.y as f32],
            // Below an open edge the unknown is met outside the ball.
            cone: if open_edge { ALL_DIRECTIONS } else { ball.cone(view) },
            first_level: first_level as u32,
            levels: face.levels.len() as u32,
            direct: u32::from(start.is_some()),
            open_edge: u32::from(open_edge),
        }
    }

    /// The camera's lifted point, where rays over this map start at the camera.
    pub fn direct_start(map: &Gnomonic, camera: Position<BodyFixed>) -> Option<DVec3> {
        let high = map.map_vector(camera).z > DIRECT_ABOVE_RADII * map.radius_m;
        map.lifted_from_body(camera).filter(|_| high)
    }
}

/// A ball that holds a map's ground, which is one of the body's about its centre unless it stands alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    middle: Position<BodyFixed>,
    radius_m: f64,
}

/// Directions are `f32`.
const CONE_SLACK_RAD: f64 = 1e-3;

const ALL_DIRECTIONS: [f32; 4] = [0.0, 0.0, 0.0, -1.0];

impl Ball {
    /// Around what is seen of a face, and the bare body there: a box of lifted space is the hull of its corners in space too.
    pub fn about(body: &Body, face: &Face) -> Self {
        let heights_m = face.levels.iter().flat_map(|level| &level.heights_m).map(|height_m| f64::from(*height_m));
        let (lowest_m, highest_m) =
            heights_m.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)));
        let (low, high) = face.levels.last().map_or((DVec2::ZERO, DVec2::ZERO), Level::seen_m);
        let farthest = low.abs().max(high.abs());
        let lowest_m = lowest_m.min(face.map.lifted_height_m(farthest, body.polar_radius_m));
        let highest_m = highest_m.max(face.map.lifted_height_m(DVec2::ZERO.clamp(low, high), body.equatorial_radius_m));
        let corner = |i: usize| {
            let pick = |bit: usize, low: f64, high: f64| if i & bit == 0 { low } else { high };
            let lifted = DVec3::new(pick(1, low.x, high.x), pick(2, low.y, high.y), pick(4, lowest_m, highest_m));
            face.map.body_from_lifted(lifted).vector_m()
        };
        let corners: [DVec3; 8] = std::array::from_fn(corner);
        let middle_m = corners.iter().sum::<DVec3>() / 8.0;
        let radius_m = corners.iter().map(|corner| corner.distance(middle_m)).fold(0.0, f64::max);
        Self { middle: Position::from_m(middle_m), radius_m }
    }

    /// Directions towards it in camera axes: the middle one, and the least cosine with it.
    fn cone(&self, view: &View) -> [f32; 4] {
        let towards_m = view.camera_from_body.turn(self.middle.vector_m() - view.camera_position.vector_m());
        let distance_m = towards_m.length();
        if distance_m <= self.radius_m {
            return ALL_DIRECTIONS;
        }
        let half_rad = (self.radius_m / distance_m).asin() + CONE_SLACK_RAD;
        with_w(towards_m / distance_m, half_rad.cos())
    }
}

impl MapLevel {
    /// The seen part of a level of map `face`; offsets are the caller's.
    pub fn new(seen: &Level, face: usize) -> Self {
        Self {
            south_west_m: [seen.west_m as f32, seen.south_m as f32],
            posting_m: seen.posting_m as f32,
            columns: seen.columns as u32,
            rows: seen.rows as u32,
            face: face as u32,
            ..Self::zeroed()
        }
    }

    /// With a horizon map where its shadow method has put it.
    pub fn with_texels(self, texels: &LevelTexels) -> Self {
        Self { horizon: texels.pages, horizon_table: texels.table, ..self }
    }

    /// With points of bounced light: where their numbers begin, and nodes from one to the next.
    pub fn with_bounced(self, bounced: [u32; 2]) -> Self {
        Self { bounced, ..self }
    }

    /// Grid coordinates that count from the cell of the map point `camera_m`.
    pub fn about(&self, camera: DVec2) -> Self {
        let cell = camera.floor();
        Self { base: cell.as_ivec2().to_array(), camera: (camera - cell).as_vec2().to_array(), ..*self }
    }
}

impl LightParameters {
    /// A light at `vector_m` from a frame's origin.
    pub fn new(light: &Light, vector_m: DVec3) -> Self {
        let distance_m = vector_m.length();
        Self {
            direction: with_w(vector_m / distance_m, 1.0 / distance_m),
            radius_rad: light.angular_radius_rad as f32,
            irradiance_w_m2: light.irradiance_w_m2 as f32,
            padding: [0; 2],
        }
    }
}
