//! The ground at a hit: its normal, numbers given at its nodes, and a light's disc as it stands over it.

use glam::DVec2;

use super::{Light, Scene};
use crate::geometry::{BodyFixed, Direction, Position};
use crate::photometry::{Reflectance, SunAxes};
use crate::shadow::{Disc, Site};
use crate::terrain::{Face, Ground, Hit};

/// A number given at the nodes, bilinear at a hit; `beyond` outside the terrain.
pub fn at_nodes(scene: &Scene, maps: &[Vec<Vec<f32>>], hit: &Hit, beyond: f64) -> f64 {
    match hit.ground {
        Ground::Dem { face, level, lifted } => {
            let grid_level = &scene.surface.terrain.faces[face].levels[level];
            let grid = grid_level.grid_from_map(lifted.truncate());
            grid_level.bilinear_of(&maps[face][level], grid).unwrap_or(f64::NAN)
        }
        _ => beyond,
    }
}

/// What the map of albedos says at a hit.
pub fn albedo(scene: &Scene, law: &Reflectance, hit: &Hit) -> f64 {
    scene.albedo.as_ref().map_or(1.0, |maps| at_nodes(scene, maps, hit, scene.bare_albedo(law)))
}

/// The ground at grid coordinates of a level of a face.
pub fn hit_at(scene: &Scene, [face, level]: [usize; 2], grid: DVec2) -> Option<Hit> {
    let Face { map, levels } = &scene.surface.terrain.faces[face];
    let lifted = levels[level].map_from_grid(grid).extend(levels[level].bilinear_m(grid)?);
    let position = map.body_from_lifted(lifted);
    Some(Hit { ground: Ground::Dem { face, level, lifted }, position, distance_m: 0.0 })
}

/// A hit on terrain, and a light's disc as its facet sees it.
pub fn site<'a>(
    scene: &'a Scene,
    hit: &Hit,
    normal: Direction<BodyFixed>,
    (index, light): (usize, &Light),
) -> Option<(Site<'a>, Disc<'a>)> {
    let Ground::Dem { face, level, lifted } = hit.ground else { return None };
    let towards = hit.position.direction_to(light.position)?;
    let map = &scene.surface.terrain.faces[face].map;
    let axes = SunAxes::new(map.map_from_body * towards, map.up(lifted.truncate()));
    let angular_radius_rad = light.angular_radius_rad;
    let facet = axes.facet(map.map_from_body * normal, angular_radius_rad);
    let disc = Disc { light: index, disk: &scene.disk, axes, angular_radius_rad, facet };
    Some((Site { map, face, level, lifted }, disc))
}

/// The outward normal of the ground at a hit: that of the smooth surface through the nodes, see [`crate::terrain::patch`].
pub fn normal(scene: &Scene, hit: &Hit) -> Direction<BodyFixed> {
    let terrain = &scene.surface.terrain;
    match hit.ground {
        Ground::Dem { face, level, lifted } => {
            let face = &terrain.faces[face];
            let gradient = face.levels[level].interpolated_gradient(lifted.truncate());
            face.map.map_from_body.inverse() * face.map.normal(lifted, gradient)
        }
        Ground::Bare | Ground::Gap => bare_normal(scene, hit.position),
    }
}

/// The reference surface's outward normal at a place.
pub fn bare_normal(scene: &Scene, position: Position<BodyFixed>) -> Direction<BodyFixed> {
    let body = &scene.surface.terrain.body;
    body.up(body.geodetic_from_position(position))
}
