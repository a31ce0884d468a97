//! Where the ground of one exposure is in another, and whether it is seen there.
//!
//! The ground `P` behind a pixel `p` of one camera falls on the pixel `q` of another one:
//!
//! ```text
//! flow = q(P) − p        q = lens(K R (P − c))
//! ```
//!
//! `P` is the hit of the ray through the pixel's centre, in f64, so the flow is exact: nothing is matched. It is told wherever
//! `q` exists, on the image or off it. `covisible` is 1 where `q` is on the image and a ray from the other camera to `P` meets no
//! ground more than [`NEARER_PIXELS`] pixels' width on the ground before it, else 0.
//!
//! # Assumptions
//! The ground stands still. Each exposure has one pose: its own, whatever its shutter.

use glam::DVec2;
use rayon::prelude::*;

use crate::geometry::Direction;
use crate::render::planes::pixel_angle_rad;
use crate::render::{Scene, View};
use crate::terrain::{Ground, Hit};

/// Ground this much nearer than what a pixel saw, in widths of the other image's pixel, hides it.
pub const NEARER_PIXELS: f64 = 1.0;

/// Row by row; NaN where the first exposure sees no ground, or no pixel of the other one looks its way.
#[derive(Debug, Clone, PartialEq)]
pub struct Flow {
    pub x_px: Vec<f32>,
    pub y_px: Vec<f32>,
    pub covisible: Vec<f32>,
}

impl Flow {
    /// Nothing was asked for.
    pub fn none() -> Self {
        Self { x_px: Vec::new(), y_px: Vec::new(), covisible: Vec::new() }
    }

    /// From a view whose centres hit the ground at `centres` to another; nowhere where there is none.
    pub fn to(scene: &Scene, view: &View, other: Option<&View>, centres: &[Option<Hit>]) -> Self {
        let columns = view.optics.columns as usize;
        let flow = |(index, hit): (usize, &Option<Hit>)| {
            let pixel = DVec2::new((index % columns) as f64, (index / columns) as f64);
            let ground = hit.as_ref().filter(|hit| hit.ground != Ground::Gap);
            let Some((hit, other)) = ground.zip(other) else { return [f32::NAN; 3] };
            let Some(found) = pixel_of(other, hit) else { return [f32::NAN, f32::NAN, 0.0] };
            let moved = found - pixel;
            let covisible = other.optics.contains(found) && is_seen(scene, other, hit, found);
            [moved.x as f32, moved.y as f32, f32::from(u8::from(covisible))]
        };
        let all: Vec<[f32; 3]> = centres.par_iter().enumerate().map(flow).collect();
        let channel = |channel: usize| all.iter().map(|values| values[channel]).collect();
        Self { x_px: channel(0), y_px: channel(1), covisible: channel(2) }
    }
}

/// The image point of a point of the ground.
fn pixel_of(view: &View, hit: &Hit) -> Option<DVec2> {
    let from_camera_m = hit.position.vector_m() - view.camera_position.vector_m();
    view.optics.pixel(Direction::new(view.camera_from_body.turn(from_camera_m))?)
}

fn is_seen(scene: &Scene, view: &View, hit: &Hit, pixel: DVec2) -> bool {
    let Some(towards) = view.camera_position.direction_to(hit.position) else { return false };
    let distance_m = view.camera_position.distance_m(hit.position);
    let nearer_m = NEARER_PIXELS * distance_m * pixel_angle_rad(&view.optics, pixel);
    let met = scene.surface.intersect(view.camera_position, towards);
    // A ray that slips past the very point it was aimed at met nothing before it.
    !met.is_some_and(|met| met.distance_m < distance_m - nearer_m)
}
