//! The light that [`Bounce`] carries under the Sun of a view.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::bounce::{Bounce, Gather, Ray, SECTORS};
use super::direct::irradiance_w_m2;
use super::facet::{albedo, hit_at, normal};
use super::{Scene, View};
use crate::geometry::{BodyFixed, Direction};
use crate::grid::{Cell, Grid2};
use crate::shadow::Shadow;
use crate::terrain::{Ground, Hit};

/// The vectors `Σ L Ω ω` of each sector, in the axes of a point's map.
type Sectors = [[f32; 3]; SECTORS];

/// What the points of all levels receive from other ground.
#[derive(Debug, Clone)]
pub struct BouncedLight<'a> {
    bounce: &'a Bounce,
    /// By face, level and point.
    points: Vec<Vec<Vec<Sectors>>>,
}

impl Bounce {
    /// Bounced light of a view's first light.
    pub fn light(&self, scene: &Scene, view: &View, shadow: Option<&dyn Shadow>) -> BouncedLight<'_> {
        let of_level =
            |face: usize, level: usize| sunlight(&self.gathers[face][level], scene, view, shadow, [face, level]);
        let sunlit = self.by_level(of_level);
        let from_sun = |ray: &Ray, seen: &Seen| {
            let [face, level] = ray.place();
            let cell = self.gathers[face][level].cell(&scene.surface.terrain.faces[face].levels[level], ray.grid());
            let lit_w_m2 = Grid2::new(&sunlit[face][level], self.gathers[face][level].size()).bilinear(cell);
            let sun = view.lights.first().filter(|_| lit_w_m2 > 0.0)?;
            let to_sun = seen.hit.position.direction_to(sun.position)?.unit();
            let normal = normal(scene, &seen.hit).unit();
            let [mu0, mu] = [to_sun, seen.to_here].map(|direction| normal.dot(direction).max(0.0));
            let albedo = albedo(scene, &view.reflectance, &seen.hit);
            Some(scene.brdf_sr(&view.reflectance, albedo, mu0, mu, to_sun.dot(seen.to_here)) * lit_w_m2)
        };
        let mut sum = self.gathered(scene, from_sun);
        let mut last = sum.clone();
        for _ in 1..self.orders {
            let from_ground =
                |_: &Ray, seen: &Seen| Direction::new(seen.to_here).map(|to| last.radiance(scene, view, &seen.hit, to));
            last = self.gathered(scene, from_ground);
            sum.add(&last);
        }
        sum
    }

    /// Of each level, in the order of faces and levels: where its numbers begin in [`BouncedLight::table`], and nodes from one point
    /// to the next.
    pub fn places(&self) -> Vec<[u32; 2]> {
        let mut first = 0;
        let mut place = |gather: &Gather| {
            let place = [first, gather.step as u32];
            first += (3 * SECTORS * gather.rays.len()) as u32;
            place
        };
        self.gathers.iter().flatten().map(&mut place).collect()
    }

    fn by_level<T>(&self, of_level: impl Fn(usize, usize) -> T) -> Vec<Vec<T>> {
        let of_face = |face: usize| (0..self.gathers[face].len()).map(|level| of_level(face, level)).collect();
        (0..self.gathers.len()).map(of_face).collect()
    }

    /// What points gather from ground that shines as `radiance` says.
    fn gathered(&self, scene: &Scene, radiance: impl Fn(&Ray, &Seen) -> Option<f64> + Sync) -> BouncedLight<'_> {
        let of_level = |face: usize, level: usize| {
            let gather = &self.gathers[face][level];
            let points = (0..gather.rays.len()).into_par_iter();
            points.map(|point| gather.sectors(scene, [face, level], point, &radiance)).collect()
        };
        BouncedLight { bounce: self, points: self.by_level(of_level) }
    }
}

/// The ground at a ray's end, and the unit vector back to where the ray starts.
struct Seen {
    hit: Hit,
    to_here: DVec3,
}

impl Ray {
    fn place(&self) -> [usize; 2] {
        [usize::from(self.face), usize::from(self.level)]
    }

    fn grid(&self) -> DVec2 {
        DVec2::from(self.grid.map(f64::from))
    }
}

impl Gather {
    fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// What a point gathers from its rays.
    fn sectors(
        &self,
        scene: &Scene,
        [face, level]: [usize; 2],
        point: usize,
        radiance: &impl Fn(&Ray, &Seen) -> Option<f64>,
    ) -> Sectors {
        let map = &scene.surface.terrain.faces[face].map;
        let mut sums = [DVec3::ZERO; SECTORS];
        if let Some(here) = hit_at(scene, [face, level], self.node(&scene.surface, [face, level], point)) {
            for ray in &self.rays[point] {
                let Some(hit) = hit_at(scene, ray.place(), ray.grid()) else { continue };
                let Some(to_here) = hit.position.direction_to(here.position) else { continue };
                let seen = Seen { hit, to_here: to_here.unit() };
                let Some(light) = radiance(ray, &seen).filter(|light| light.is_finite()) else { continue };
                let from = map.map_from_body.turn(-seen.to_here);
                sums[sector(from)] += light * f64::from(ray.solid_angle_sr) * from;
            }
        }
        sums.map(|sum| sum.as_vec3().to_array())
    }
}

/// The sector of a direction in map axes.
fn sector(from: DVec3) -> usize {
    let turns = from.x.atan2(from.y).rem_euclid(TAU) / TAU;
    ((turns * SECTORS as f64) as usize).min(SECTORS - 1)
}

impl BouncedLight<'_> {
    fn add(&mut self, other: &Self) {
        let own = self.points.iter_mut().flatten().flatten().flatten().flatten();
        own.zip(other.points.iter().flatten().flatten().flatten().flatten()).for_each(|(sum, term)| *sum += term);
    }

    /// The light vectors at a hit, in map axes; none where no map has heights.
    fn vectors(&self, scene: &Scene, hit: &Hit) -> [DVec3; SECTORS] {
        let Ground::Dem { face, level, lifted } = hit.ground else { return [DVec3::ZERO; SECTORS] };
        let nodes = &scene.surface.terrain.faces[face].levels[level];
        let gather = &self.bounce.gathers[face][level];
        let cell: Cell = gather.cell(nodes, nodes.grid_from_map(lifted.truncate()));
        let points = &self.points[face][level];
        let of_sector = |index: usize, column: usize, row: usize| {
            DVec3::from(points[row * gather.columns + column][index].map(f64::from))
        };
        std::array::from_fn(|index| cell.mix(|column, row| of_sector(index, column, row)))
    }

    /// Irradiance of the ground at a hit.
    pub fn irradiance_w_m2(&self, scene: &Scene, hit: &Hit) -> f64 {
        let Some(normal) = map_normal(scene, hit) else { return 0.0 };
        self.vectors(scene, hit).into_iter().map(|vector| normal.dot(vector).max(0.0)).sum()
    }

    /// Radiance of the ground at a hit towards a direction.
    pub fn radiance(&self, scene: &Scene, view: &View, hit: &Hit, towards: Direction<BodyFixed>) -> f64 {
        let (Ground::Dem { face, .. }, Some(normal)) = (hit.ground, map_normal(scene, hit)) else { return 0.0 };
        let towards = scene.surface.terrain.faces[face].map.map_from_body.turn(towards.unit());
        let (law, albedo) = (&view.reflectance, albedo(scene, &view.reflectance, hit));
        let mu = normal.dot(towards).max(0.0);
        let of_sector = |vector: DVec3| {
            let (irradiance_w_m2, length) = (normal.dot(vector), vector.length());
            if irradiance_w_m2 <= 0.0 {
                return 0.0;
            }
            let mu0 = (irradiance_w_m2 / length).min(1.0);
            scene.brdf_sr(law, albedo, mu0, mu, vector.dot(towards) / length) * irradiance_w_m2
        };
        self.vectors(scene, hit).into_iter().map(of_sector).sum()
    }

    /// The numbers of all points as the shader reads them, by face, level, point and sector.
    pub fn table(&self) -> Vec<f32> {
        self.points.iter().flatten().flatten().flatten().flatten().copied().collect()
    }
}

/// The normal of terrain in the axes of its map.
fn map_normal(scene: &Scene, hit: &Hit) -> Option<DVec3> {
    let Ground::Dem { face, .. } = hit.ground else { return None };
    Some(scene.surface.terrain.faces[face].map.map_from_body.turn(normal(scene, hit).unit()))
}

/// Sunlight on the facet at each point.
fn sunlight(gather: &Gather, scene: &Scene, view: &View, shadow: Option<&dyn Shadow>, place: [usize; 2]) -> Vec<f32> {
    let Some(sun) = view.lights.first() else { return vec![0.0; gather.rays.len()] };
    let lit = |point: usize| {
        let hit = hit_at(scene, place, gather.node(&scene.surface, place, point));
        hit.map_or(0.0, |hit| irradiance_w_m2(scene, shadow, &hit, (0, sun)) as f32)
    };
    (0..gather.rays.len()).into_par_iter().map(lit).collect()
}
