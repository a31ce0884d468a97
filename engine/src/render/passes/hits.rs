//! What the centres of a device's pixels see, in f64.

use glam::DVec2;
use rayon::prelude::*;

use super::upload::{DeviceGround, PackedLevel};
use crate::camera::Camera as Optics;
use crate::geometry::{BodyFixed, Position};
use crate::render::layout::CentreOut;
use crate::render::{Scene, View};
use crate::terrain::{Ground, Hit};

/// The centres' hits in f64: the device says where on which cell, the host computes the point.
pub fn of_centres(
    ground: &DeviceGround,
    scene: &Scene,
    optics: &Optics,
    view: &View,
    centres: &[CentreOut],
) -> Vec<Option<Hit>> {
    let columns = optics.columns as usize;
    let pixel = |index: usize| DVec2::new((index % columns) as f64, (index / columns) as f64);
    let of_pixel = |(index, centre): (usize, &CentreOut)| hit(ground, scene, optics, view, pixel(index), centre);
    centres.par_iter().enumerate().map(of_pixel).collect()
}

fn hit(
    device: &DeviceGround,
    scene: &Scene,
    optics: &Optics,
    view: &View,
    pixel: DVec2,
    centre: &CentreOut,
) -> Option<Hit> {
    let terrain = &scene.surface.terrain;
    match centre.ground {
        CentreOut::DEM => {
            let &PackedLevel { face, level, ref shader } = &device.levels[centre.level as usize];
            let grid_level = &terrain.faces[face].levels[level];
            let cell = DVec2::new(f64::from(centre.cell % shader.columns), f64::from(centre.cell / shader.columns));
            let grid = cell + DVec2::from(centre.fraction.map(f64::from)) + grid_level.margin as f64;
            let lifted = grid_level.map_from_grid(grid).extend(grid_level.bilinear_m(grid)?);
            let position = terrain.faces[face].map.body_from_lifted(lifted);
            let distance_m = position.distance_m(view.camera_position);
            Some(Hit { ground: Ground::Dem { face, level, lifted }, position, distance_m })
        }
        CentreOut::MISS => None,
        ground => {
            let direction = view.camera_from_body.inverse() * optics.direction(pixel)?;
            let distance_m = f64::from(centre.distance_m);
            let ground = if ground == CentreOut::GAP { Ground::Gap } else { Ground::Bare };
            let position: Position<BodyFixed> =
                Position::from_m(view.camera_position.vector_m() + distance_m * direction.unit());
            Some(Hit { ground, position, distance_m })
        }
    }
}
