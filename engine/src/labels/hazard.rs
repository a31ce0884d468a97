//! Where a lander may stand: slope, roughness and light over its footprint, and a mask by thresholds.
//!
//! The footprint of diameter `D` about a point is a disc on the ground; a plane fits the ground's height over it by least
//! squares:
//!
//! ```text
//! slope       angle of the plane's normal with up
//! roughness   largest distance of the ground from the plane, perpendicular to it
//! sunlit      mean share of the Sun's disc that the ground of the disc sees
//! hazard      1 where slope > limit, or roughness > limit, or sunlit < limit; else 0
//! ```
//!
//! The disc is sampled on a square lattice of the terrain's posting, of `D/20` where that is coarser and `D/6` where it is
//! finer. In lifted coordinates planes are planes, so the fit is made there ([`footprint`]) and only its plane is taken to space;
//! [`footprint_in_space`] does it point by point, to be believed.
//!
//! # Assumptions
//! Obstacles narrower than the sampling, or than the terrain's posting, are not seen. Light is interpolated between nodes.

use std::collections::BTreeMap;

use glam::{DMat2, DMat3, DVec2, DVec3};
use rayon::prelude::*;

use crate::geometry::{Direction, Position};
use crate::grid::{Cell, Grid2};
use crate::render::{Scene, View, reference};
use crate::shadow::Shadow;
use crate::terrain::{Face, Ground, Hit, Level, Surface};

/// A lander and what it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    pub footprint_m: f64,
    pub slope_rad: f64,
    pub roughness_m: f64,
    /// 0: light does not matter, and is not computed for the mask.
    pub sunlit_share: f64,
}

/// Finest and coarsest sampling of a footprint, in its diameters.
const FINEST: f64 = 1.0 / 20.0;
const COARSEST: f64 = 1.0 / 6.0;

/// The ground under a lander.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Footprint {
    pub slope_rad: f64,
    pub roughness_m: f64,
}

/// Offsets of the lattice's points in the disc, in metres.
fn lattice(footprint_m: f64, posting_m: f64) -> Vec<DVec2> {
    let step_m = posting_m.clamp(FINEST * footprint_m, COARSEST * footprint_m);
    let half = (0.5 * footprint_m / step_m).floor() as i32;
    let point = |i: i32, j: i32| DVec2::new(f64::from(i), f64::from(j)) * step_m;
    let points = (-half..=half).flat_map(|j| (-half..=half).map(move |i| point(i, j)));
    points.filter(|offset_m| offset_m.length() <= 0.5 * footprint_m * (1.0 + 1e-9)).collect()
}

/// From metres on the ground about a lifted point to metres of the map: the map stretches `sec² c` away from its centre and
/// `sec c` across.
fn map_from_ground(face: &Face, lifted: DVec3) -> DMat2 {
    let at = lifted.truncate();
    let radius_m = face.map.radius_m;
    let stretch = 1.0 + at.length_squared() / (radius_m * radius_m);
    let away = at.normalize_or(DVec2::X);
    let outer = |v: DVec2| DMat2::from_cols(v * v.x, v * v.y);
    let shrink = radius_m / face.map.radius_from_lifted_m(lifted);
    (outer(away) * stretch + outer(away.perp()) * stretch.sqrt()) * shrink
}

/// The finest level that sees a map point, tried first where the middle of the footprint is.
fn level_at(face: &Face, first: usize, at_m: DVec2) -> Option<usize> {
    let finer_may = first > 0 && face.levels[..first].iter().any(|level| level.sees(at_m));
    if !finer_may && face.levels[first].sees(at_m) { Some(first) } else { face.level_at(at_m) }
}

/// Slope and roughness about a point of the terrain; `None` where the footprint leaves the heights.
pub fn footprint(surface: &Surface, hit: &Hit, footprint_m: f64) -> Option<Footprint> {
    let Ground::Dem { face, level, lifted } = hit.ground else { return None };
    let face = &surface.terrain.faces[face];
    let turn = map_from_ground(face, lifted);
    let offsets_m = lattice(footprint_m, face.levels[level].posting_m);
    let height_m = |offset_m: &DVec2| {
        let at_m = lifted.truncate() + turn * *offset_m;
        let level = &face.levels[level_at(face, level, at_m)?];
        height_without_gap_m(level, at_m)
    };
    let heights_m: Vec<f64> = offsets_m.iter().map(height_m).collect::<Option<_>>()?;
    // The lattice is symmetric: its mixed moments vanish.
    let mean_m = heights_m.iter().sum::<f64>() / heights_m.len() as f64;
    let moment: DVec2 = offsets_m.iter().zip(&heights_m).map(|(offset_m, height_m)| *offset_m * *height_m).sum();
    let gradient = moment / offsets_m.iter().map(|offset_m| offset_m.x * offset_m.x).sum::<f64>();
    let deviations = offsets_m.iter().zip(&heights_m).map(|(o, h)| (h - mean_m - gradient.dot(*o)).abs());
    let largest_m = deviations.fold(0.0, f64::max);

    let middle = lifted.truncate().extend(mean_m);
    let normal = face.map.normal(middle, turn.inverse().transpose() * gradient);
    let slope_rad = slope_rad(surface, hit, face.map.map_from_body.inverse() * normal);
    // A lifted metre is r/(R − H) metres.
    let metres = face.map.radius_from_lifted_m(middle) / (face.map.radius_m - mean_m);
    Some(Footprint { slope_rad, roughness_m: largest_m * metres * slope_rad.cos() })
}

fn height_without_gap_m(level: &Level, at_m: DVec2) -> Option<f64> {
    let grid = level.grid_from_map(at_m);
    let (column, row) = level.cell(grid)?;
    if level.cell_has_gap(column, row) { None } else { level.bilinear_m(grid) }
}

fn slope_rad(surface: &Surface, hit: &Hit, normal: Direction<crate::geometry::BodyFixed>) -> f64 {
    let body = &surface.terrain.body;
    normal.angle_to(body.up(body.geodetic_from_position(hit.position)))
}

/// The same, in space: the ground below points of the tangent plane, and a plane through them in east, north and up.
pub fn footprint_in_space(surface: &Surface, hit: &Hit, footprint_m: f64, step_m: f64) -> Option<Footprint> {
    let body = &surface.terrain.body;
    let local = body.local_from_body(body.geodetic_from_position(hit.position)).matrix();
    let half = (0.5 * footprint_m / step_m).floor() as i32;
    let offsets = (-half..=half).flat_map(|j| (-half..=half).map(move |i| DVec2::new(f64::from(i), f64::from(j))));
    let disc = offsets.map(|offset| offset * step_m).filter(|offset_m| offset_m.length() <= 0.5 * footprint_m);
    let ground = |offset_m: DVec2| {
        let above = Position::from_m(hit.position.vector_m() + local.transpose() * offset_m.extend(0.0));
        let found = surface.ground_below(above);
        matches!(found.ground, Ground::Dem { .. })
            .then(|| local * (found.position.vector_m() - hit.position.vector_m()))
    };
    let points: Vec<DVec3> = disc.map(ground).collect::<Option<_>>()?;
    let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for point in &points {
        let row = DVec3::new(1.0, point.x, point.y);
        normal += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
        right += row * point.z;
    }
    let plane = normal.inverse() * right;
    let slope_rad = plane.y.hypot(plane.z).atan();
    let vertical_m = points.iter().map(|p| (p.z - plane.x - plane.y * p.x - plane.z * p.y).abs()).fold(0.0, f64::max);
    Some(Footprint { slope_rad, roughness_m: vertical_m * slope_rad.cos() })
}

/// Shares of the Sun's disc at the nodes about what an image sees.
#[derive(Debug)]
struct SunField<'a> {
    scene: &'a Scene,
    view: &'a View,
    shadow: Option<&'a dyn Shadow>,
    patches: BTreeMap<(usize, usize), Patch>,
}

/// A rectangle of a level's nodes.
#[derive(Debug, Default)]
struct Patch {
    low: [usize; 2],
    columns: usize,
    shares: Vec<f32>,
}

impl<'a> SunField<'a> {
    fn new(
        scene: &'a Scene,
        view: &'a View,
        shadow: Option<&'a dyn Shadow>,
        centres: &[Option<Hit>],
        footprint_m: f64,
    ) -> Self {
        let mut bounds: BTreeMap<(usize, usize), [DVec2; 2]> = BTreeMap::new();
        for hit in centres.iter().flatten() {
            let Ground::Dem { face, level, lifted } = hit.ground else { continue };
            let grid = scene.surface.terrain.faces[face].levels[level].grid_from_map(lifted.truncate());
            let [low, high] = bounds.entry((face, level)).or_insert([grid; 2]);
            (*low, *high) = (low.min(grid), high.max(grid));
        }
        let patch = |(&(face, level), [low, high]): (&(usize, usize), &[DVec2; 2])| {
            let grid = &scene.surface.terrain.faces[face].levels[level];
            let far = DVec2::new((grid.columns - 1) as f64, (grid.rows - 1) as f64);
            let reach = footprint_m / grid.posting_m + 1.0;
            let [low, high] = [(*low - reach).floor(), (*high + reach).ceil()].map(|at| at.clamp(DVec2::ZERO, far));
            let (columns, rows) = ((high.x - low.x) as usize + 1, (high.y - low.y) as usize + 1);
            let low = [low.x as usize, low.y as usize];
            let share = |index: usize| {
                let lifted = grid.lifted_node(low[0] + index % columns, low[1] + index / columns);
                let ground = Ground::Dem { face, level, lifted };
                let position = scene.surface.terrain.faces[face].map.body_from_lifted(lifted);
                let hit = Hit { ground, position, distance_m: 0.0 };
                reference::sun_fraction(scene, view, shadow, &hit) as f32
            };
            let shares = (0..columns * rows).into_par_iter().map(share).collect();
            ((face, level), Patch { low, columns, shares })
        };
        let patches = bounds.iter().map(patch).collect();
        Self { scene, view, shadow, patches }
    }

    /// The share at a map point of a face: between nodes, or found anew where no node of the level was needed.
    fn share(&self, face: usize, level: usize, at_m: DVec2) -> f64 {
        let grid_level = &self.scene.surface.terrain.faces[face].levels[level];
        let grid = grid_level.grid_from_map(at_m);
        let between = || {
            let patch = self.patches.get(&(face, level))?;
            let shares = Grid2::new(&patch.shares, [patch.columns, patch.shares.len() / patch.columns]);
            let at = grid - DVec2::new(patch.low[0] as f64, patch.low[1] as f64);
            let inside =
                at.cmpge(DVec2::ZERO).all() && at.x + 1.0 < shares.columns as f64 && at.y + 1.0 < shares.rows as f64;
            inside.then(|| shares.bilinear(Cell::clamped(shares.size(), at)))
        };
        between().unwrap_or_else(|| {
            let lifted = at_m.extend(grid_level.bilinear_m(grid).unwrap_or(f64::NAN));
            let position = self.scene.surface.terrain.faces[face].map.body_from_lifted(lifted);
            let hit = Hit { ground: Ground::Dem { face, level, lifted }, position, distance_m: 0.0 };
            reference::sun_fraction(self.scene, self.view, self.shadow, &hit)
        })
    }

    /// Mean over the footprint.
    fn mean(&self, hit: &Hit, footprint_m: f64) -> Option<f64> {
        let Ground::Dem { face: index, level, lifted } = hit.ground else { return None };
        let face = &self.scene.surface.terrain.faces[index];
        let turn = map_from_ground(face, lifted);
        let offsets_m = lattice(footprint_m, face.levels[level].posting_m);
        let share = |offset_m: &DVec2| {
            let at_m = lifted.truncate() + turn * *offset_m;
            Some(self.share(index, level_at(face, level, at_m)?, at_m))
        };
        let sum: f64 = offsets_m.iter().map(share).sum::<Option<f64>>()?;
        Some(sum / offsets_m.len() as f64)
    }
}

/// The planes of an image, row by row; NaN where a footprint leaves the heights. Empty ones were not asked for.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Hazards {
    pub slope_deg: Vec<f32>,
    pub roughness_m: Vec<f32>,
    pub sunlit_share: Vec<f32>,
    pub hazard: Vec<f32>,
}

impl Hazards {
    /// `light`: whether shares of light are asked for, as a plane or by the mask ([`super::need_light`]); `shadow` decides them.
    pub fn of(
        scene: &Scene,
        view: &View,
        shadow: Option<&dyn Shadow>,
        centres: &[Option<Hit>],
        limits: &Limits,
        light: bool,
    ) -> Self {
        let size_m = limits.footprint_m;
        let found: Vec<Option<Footprint>> =
            centres.par_iter().map(|hit| footprint(&scene.surface, hit.as_ref()?, size_m)).collect();
        let sunlit: Vec<f32> = if light {
            let field = SunField::new(scene, view, shadow, centres, size_m);
            let mean =
                |hit: &Option<Hit>| hit.as_ref().and_then(|hit| field.mean(hit, size_m)).unwrap_or(f64::NAN) as f32;
            centres.par_iter().map(mean).collect()
        } else {
            Vec::new()
        };
        let hazard = found.iter().enumerate().map(|(index, found)| {
            let Some(found) = found else { return f32::NAN };
            let dark = sunlit.get(index).is_some_and(|share| f64::from(*share) < limits.sunlit_share);
            let bad = found.slope_rad > limits.slope_rad || found.roughness_m > limits.roughness_m || dark;
            f32::from(u8::from(bad))
        });
        let plane = |value: &dyn Fn(&Footprint) -> f64| {
            found.iter().map(|found| found.as_ref().map_or(f64::NAN, value) as f32).collect()
        };
        Self {
            slope_deg: plane(&|found| found.slope_rad.to_degrees()),
            roughness_m: plane(&|found| found.roughness_m),
            hazard: hazard.collect(),
            sunlit_share: sunlit,
        }
    }
}
