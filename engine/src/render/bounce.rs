//! Sunlight that terrain reflects onto terrain, once.
//!
//! A point of normal `n` sees ground between its own plane and its skyline. In azimuths `A` all round
//!
//! ```text
//! E = ∫∫ L (n·ω) dΩ ≈ n · Σ_A Σ_ε L(A, ε) Ω(A, ε) ω(A, ε)      Ω = ΔA (h − p) g_ε cos ε
//! ```
//!
//! with `h(A)` the skyline of the horizon map, `p(A)` the plane's elevation, `g_ε` the Gauss–Legendre weights of the elevations
//! between `p` and `h`: solid angles from the horizon map. A ray through the middle of each finds the ground that is seen
//! there, once for all Suns. Its radiance is `f_r E_sun`, with the irradiance of the exposure's Sun, shadows included.
//!
//! What a point receives is kept by [`SECTORS`] sectors of azimuth, each as the vector `V = Σ L Ω ω`: ground of normal `n` gets
//! the irradiance `n·V` from the direction of `V`, and reflects it as light from there.
//!
//! Rays start from at most [`POINTS`] × [`POINTS`] nodes of a level; between these nodes the vectors are bilinear, and so is the
//! sunlight that they come from.
//!
//! # Assumptions
//! - One bounce of the Sun's light, or as many as [`Bounce::with_orders`] says: in a bowl each next one is the share `A f` of the
//!   one before, `f = D/(2R)`, 2 % for lunar ground.
//! - A sector's light comes from one direction.
//!
//! Measured (`tests/reference/bounce.rs`): against the closed form of a bowl, depth a fifth of its diameter, at four
//! places; on waves of 60 m against 1024 rays a point over the hemisphere with traced shadows at their ends:
//!
//! | azimuths × elevations | bowl, Sun at 60° | 30° | 15° | waves, Sun at 25°: mean | RMS |
//! |---|---|---|---|---|---|
//! | 16 × 2 | 1.2 % | 3.0 % | 12 % | +5.9 % | 16 % |
//! | 32 × 4 (default) | 1.1 % | 2.3 % | 3.1 % | −0.03 % | 7 % |
//!
//! A second order adds 6.1 % to the light of Shackleton's floor within 4 km of its middle and 1.3 % to all of the shadow in it (LOLA
//! at 240 m, Hapke's Moon, Sun at 1.5°), the third 2.5 and 2 % of the second; in the bowl 2.7 % of the one before (closed form 2.8 %).
//!
//! # References
//! Ingersoll, Svitek & Murray (1992), Icarus 100, 40, doi:10.1016/0019-1035(92)90016-Z, for the bowl; Mazarico et al. (2018),
//! Adv. Space Res. 62, 3214, for bounces in lunar illumination.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::geometry::Direction;
use crate::grid::Cell;
use crate::horizon::HorizonMap;
use crate::photometry::quadrature::gauss_legendre;
use crate::shadow::sky::{directions, facet, tangent};
use crate::terrain::{Face, Ground, Hit, Level, Surface};

/// Most points along a side of a level that rays start from.
pub const POINTS: usize = 129;

/// Sectors of map azimuth, the first one from north on clockwise.
pub const SECTORS: usize = 8;

/// How far above its node a ray starts, in postings: clear of its own cells' rounding.
const LIFT: f64 = 1e-3;

/// Who sees whom in a terrain: the part of a bounce that no Sun changes.
#[derive(Debug)]
pub struct Bounce {
    pub(super) gathers: Vec<Vec<Gather>>,
    /// How often light is reflected before it is gathered.
    pub(super) orders: usize,
}

/// The points of a level, and the rays of each.
#[derive(Debug)]
pub(super) struct Gather {
    /// Nodes from one point to the next; the last point is the last seen node.
    pub(super) step: usize,
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) rays: Vec<Vec<Ray>>,
}

/// What a point sees in one direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ray {
    pub(super) face: u16,
    pub(super) level: u16,
    /// In nodes of that level.
    pub(super) grid: [f32; 2],
    /// `Ω`
    pub(super) solid_angle_sr: f32,
}

impl Bounce {
    /// Rays in even steps of map azimuth, at some elevations between a point's own plane and its skyline.
    pub fn new(surface: &Surface, maps: &[Vec<HorizonMap>], azimuths: usize, elevations: usize) -> Self {
        let rule = gauss_legendre(elevations);
        let of_level = |face: usize, level: usize| {
            let mut gather = Gather::over(&surface.terrain.faces[face].levels[level]);
            gather.rays = (0..gather.columns * gather.rows)
                .into_par_iter()
                .map(|point| gather.rays_of(surface, &maps[face][level], [face, level], point, azimuths, &rule))
                .collect();
            gather
        };
        let faces = surface.terrain.faces.iter().enumerate();
        let of_face =
            |(face, levels): (usize, &Face)| (0..levels.levels.len()).map(|level| of_level(face, level)).collect();
        Self { gathers: faces.map(of_face).collect(), orders: 1 }
    }

    /// With light that was reflected up to so many times.
    pub fn with_orders(self, orders: usize) -> Self {
        Self { orders, ..self }
    }
}

impl Gather {
    /// The points of a level, without rays.
    fn over(level: &Level) -> Self {
        let [columns, rows] = level.seen_size();
        let step = (columns.max(rows) - 1).div_ceil(POINTS - 1).max(1);
        let [columns, rows] = [columns, rows].map(|count| (count - 1).div_ceil(step) + 1);
        Self { step, columns, rows, rays: Vec::new() }
    }

    /// Column and row of a point among the seen nodes.
    fn seen_node(&self, level: &Level, point: usize) -> [usize; 2] {
        let last = level.seen_size().map(|count| count - 1);
        [(point % self.columns * self.step).min(last[0]), (point / self.columns * self.step).min(last[1])]
    }

    /// Grid coordinates of a point.
    pub(super) fn node(&self, surface: &Surface, [face, level]: [usize; 2], point: usize) -> DVec2 {
        let nodes = &surface.terrain.faces[face].levels[level];
        let [column, row] = self.seen_node(nodes, point).map(|at| (at + nodes.margin) as f64);
        DVec2::new(column, row)
    }

    fn rays_of(
        &self,
        surface: &Surface,
        map: &HorizonMap,
        [face, level]: [usize; 2],
        point: usize,
        azimuths: usize,
        rule: &[(f64, f64)],
    ) -> Vec<Ray> {
        let (gnomonic, nodes) = (&surface.terrain.faces[face].map, &surface.terrain.faces[face].levels[level]);
        let [column, row] = self.seen_node(nodes, point);
        if nodes.gap[nodes.index(column + nodes.margin, row + nodes.margin)] {
            return Vec::new();
        }
        let skyline = map.horizon(DVec2::new(column as f64, row as f64));
        let (at_m, normal) = facet(surface, [face, level], [column, row]);
        let up = gnomonic.up(at_m).unit();
        let lifted = nodes.lifted_node(column + nodes.margin, row + nodes.margin);
        let start = gnomonic.body_from_lifted(lifted + LIFT * nodes.posting_m * DVec3::Z);
        let mut rays = Vec::new();
        for towards in directions(azimuths) {
            let level_direction = tangent(gnomonic, at_m, towards);
            let (along, upwards) = (normal.dot(level_direction), normal.dot(up));
            let plane_rad = (-along).atan2(upwards);
            let above_rad = skyline.evaluate_towards(towards).0 - plane_rad;
            if above_rad <= 0.0 {
                continue;
            }
            let width_rad = std::f64::consts::TAU / azimuths as f64 / gnomonic.azimuth_ratio(at_m, towards);
            for &(node, share) in rule {
                let (sin, cos) = (plane_rad + node * above_rad).sin_cos();
                let solid_angle_sr = (width_rad * above_rad * share * cos) as f32;
                let direction = gnomonic.map_from_body.inverse().turn(level_direction * cos + up * sin);
                let met = Direction::new(direction).and_then(|direction| surface.intersect(start, direction));
                if let Some(Hit { ground: Ground::Dem { face, level, lifted }, .. }) = met {
                    let grid = surface.terrain.faces[face].levels[level].grid_from_map(lifted.truncate());
                    let grid = grid.as_vec2().to_array();
                    rays.push(Ray { face: face as u16, level: level as u16, grid, solid_angle_sr });
                }
            }
        }
        rays
    }

    /// The points about grid coordinates.
    pub(super) fn cell(&self, level: &Level, grid: DVec2) -> Cell {
        let seen = grid - level.margin as f64;
        let along = |at: f64, points: usize, nodes: usize| {
            let last = (nodes - 2 * level.margin - 1) as f64;
            let at = at.clamp(0.0, last);
            let low = ((at / self.step as f64) as usize).min(points.saturating_sub(2));
            let [from, until] = [low, low + 1].map(|point| ((point * self.step) as f64).min(last));
            (low, if until > from { (at - from) / (until - from) } else { 0.0 })
        };
        let (column, x) = along(seen.x, self.columns, level.columns);
        let (row, y) = along(seen.y, self.rows, level.rows);
        Cell::new([self.columns, self.rows], [column, row], DVec2::new(x, y))
    }
}
