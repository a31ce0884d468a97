//! The light that [`Bounce`] carries under the Sun of a view.

use glam::DVec2;
use rayon::prelude::*;

use super::bounce::{Bounce, Gather, Ray};
use super::facet::{at_nodes, normal};
use super::reference::irradiance_w_m2;
use super::{Scene, View};
use crate::shadow::Shadow;
use crate::terrain::{Ground, Hit};

impl Bounce {
    /// Irradiance by bounced light at the nodes of each face's levels, for the first light of a view.
    pub fn irradiance_w_m2(&self, scene: &Scene, view: &View, shadow: Option<&dyn Shadow>) -> Vec<Vec<Vec<f32>>> {
        let levels = || self.gathers.iter().enumerate().flat_map(|(f, g)| (0..g.len()).map(move |l| (f, l)));
        let mut sunlit: Vec<Vec<Vec<f32>>> = self.gathers.iter().map(|g| vec![Vec::new(); g.len()]).collect();
        for (face, level) in levels() {
            sunlit[face][level] = sunlight(&self.gathers[face][level], scene, view, shadow, [face, level]);
        }
        let of_level = |face: usize, level: usize| {
            let gather = &self.gathers[face][level];
            let points: Vec<f32> = (0..gather.rays.len())
                .into_par_iter()
                .map(|point| self.gathered(scene, view, &sunlit, [face, level], point) as f32)
                .collect();
            gather.at_all_nodes(&scene.surface.terrain.faces[face].levels[level], &points)
        };
        let of_face = |face: usize| (0..self.gathers[face].len()).map(|level| of_level(face, level)).collect();
        (0..self.gathers.len()).map(of_face).collect()
    }

    /// What a point gathers from its rays.
    fn gathered(
        &self,
        scene: &Scene,
        view: &View,
        sunlit: &[Vec<Vec<f32>>],
        [face, level]: [usize; 2],
        point: usize,
    ) -> f64 {
        let (Some(sun), law) = (view.lights.first(), &view.reflectance) else { return 0.0 };
        let gather = &self.gathers[face][level];
        let Some(receiver) = hit_at(scene, face, level, gather.node(&scene.surface, [face, level], point)) else {
            return 0.0;
        };
        let from = |ray: &Ray| {
            let (face, level) = (usize::from(ray.face), usize::from(ray.level));
            let grid = DVec2::from(ray.grid.map(f64::from));
            let nodes = &scene.surface.terrain.faces[face].levels[level];
            let lit_w_m2 = self.gathers[face][level].between_points(nodes, &sunlit[face][level], grid);
            let hit = hit_at(scene, face, level, grid).filter(|_| lit_w_m2 > 0.0)?;
            let [to_sun, to_here] = [sun.position, receiver.position].map(|place| hit.position.direction_to(place));
            let (to_sun, to_here) = (to_sun?.unit(), to_here?.unit());
            let normal = normal(scene, &hit).unit();
            let albedo = scene.albedo.as_ref().map_or(1.0, |maps| at_nodes(scene, maps, &hit, scene.bare_albedo(law)));
            let [mu0, mu] = [to_sun, to_here].map(|direction| normal.dot(direction).max(0.0));
            let brdf_sr = scene.brdf_sr(law, albedo, mu0, mu, to_sun.dot(to_here));
            Some(brdf_sr * lit_w_m2 * f64::from(ray.weight_sr))
        };
        gather.rays[point].iter().filter_map(from).filter(|light| light.is_finite()).sum()
    }
}

/// Sunlight on the facet at each point.
fn sunlight(gather: &Gather, scene: &Scene, view: &View, shadow: Option<&dyn Shadow>, place: [usize; 2]) -> Vec<f32> {
    let Some(sun) = view.lights.first() else { return vec![0.0; gather.rays.len()] };
    let lit = |point: usize| {
        let hit = hit_at(scene, place[0], place[1], gather.node(&scene.surface, place, point));
        hit.map_or(0.0, |hit| irradiance_w_m2(scene, shadow, &hit, (0, sun)) as f32)
    };
    (0..gather.rays.len()).into_par_iter().map(lit).collect()
}

/// The ground at grid coordinates of a level.
fn hit_at(scene: &Scene, face: usize, level: usize, grid: DVec2) -> Option<Hit> {
    let (map, nodes) = (&scene.surface.terrain.faces[face].map, &scene.surface.terrain.faces[face].levels[level]);
    let lifted = nodes.map_from_grid(grid).extend(nodes.bilinear_m(grid)?);
    let position = map.body_from_lifted(lifted);
    Some(Hit { ground: Ground::Dem { face, level, lifted }, position, distance_m: 0.0 })
}
