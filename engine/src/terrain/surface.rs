//! Where a ray meets the surface: exactly, cell by cell, in f64.
//!
//! In lifted coordinates the ray is a straight segment and a cell is a bilinear patch, so the height of
//! the ray above the patch is a quadratic in the ray's parameter; its first root is the hit. Over a map
//! the ray visits the levels from outside in and back out, each where it is the finest. Where no map
//! covers the ground the bare spheroid is the surface. A ray that passes an open edge of the terrain
//! below its ground has left what is known: a hit on a *gap*, never a wall.
//!
//! `surface.wgsl` meets the same surface with another traversal; `tests/conformance` holds them together.

use glam::DVec3;

use super::march::March;
use super::pyramid::Pyramid;
use super::segment::Segment;
use super::{Face, Level, Terrain};
use crate::geometry::{BodyFixed, Direction, Position, distance_to_spheroid_m};

/// A terrain ready for rays.
#[derive(Debug, Clone)]
pub struct Surface {
    pub terrain: Terrain,
    /// Pyramids by face and level.
    pub pyramids: Vec<Vec<Pyramid>>,
}

/// What a ray met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ground {
    /// A level of a face, at a lifted point.
    Dem { face: usize, level: usize, lifted: DVec3 },
    /// Ground without heights: a hole in the DEM, or beyond an open edge.
    Gap,
    /// The spheroid outside all maps.
    Bare,
}

/// A ray's first meeting with the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    pub ground: Ground,
    pub position: Position<BodyFixed>,
    pub distance_m: f64,
}

impl Surface {
    pub fn new(terrain: Terrain) -> Self {
        let of_face = |face: &Face| face.levels.iter().map(Pyramid::new).collect();
        let pyramids = terrain.faces.iter().map(of_face).collect();
        Self { terrain, pyramids }
    }

    /// The first point of the surface along a ray; `None` where it misses the body.
    pub fn intersect(&self, origin: Position<BodyFixed>, direction: Direction<BodyFixed>) -> Option<Hit> {
        let maps = (0..self.terrain.faces.len()).filter_map(|face| self.intersect_face(face, origin, direction));
        let bare = self.intersect_bare(origin, direction);
        maps.chain(bare).min_by(|a, b| a.distance_m.total_cmp(&b.distance_m))
    }

    /// The surface straight below (or above) a point: towards the centre of projection of its map.
    pub fn below(&self, point: Position<BodyFixed>) -> Position<BodyFixed> {
        self.ground_below(point).position
    }

    /// The same with what is there, as a ray from the point would meet it.
    pub fn ground_below(&self, point: Position<BodyFixed>) -> Hit {
        let hit = |ground, position: Position<BodyFixed>| {
            let distance_m = point.distance_m(position);
            Hit { ground, position, distance_m }
        };
        for (index, face) in self.terrain.faces.iter().enumerate() {
            let Some(lifted) = face.map.lifted_from_body(point) else { continue };
            let at_m = lifted.truncate();
            if let Some(level) = face.level_at(at_m) {
                let grid = face.levels[level].grid_from_map(at_m);
                let height_m = face.levels[level].bilinear_m(grid).expect("the level sees this point");
                let lifted = at_m.extend(height_m);
                let is_gap = face.levels[level].cell(grid).is_some_and(|(c, r)| face.levels[level].cell_has_gap(c, r));
                let ground = if is_gap { Ground::Gap } else { Ground::Dem { face: index, level, lifted } };
                return hit(ground, face.map.body_from_lifted(lifted));
            }
        }
        let body = &self.terrain.body;
        let ground = crate::geometry::Geodetic { height_m: 0.0, ..body.geodetic_from_position(point) };
        hit(Ground::Bare, body.position_from_geodetic(ground))
    }

    fn intersect_bare(&self, origin: Position<BodyFixed>, direction: Direction<BodyFixed>) -> Option<Hit> {
        let body = &self.terrain.body;
        let radii_m = DVec3::new(body.equatorial_radius_m, body.equatorial_radius_m, body.polar_radius_m);
        let distance_m = distance_to_spheroid_m(radii_m, origin, direction)?;
        let position = Position::from_m(origin.vector_m() + distance_m * direction.unit());
        let covered = self.terrain.faces.iter().any(|face| {
            face.map.lifted_from_body(position).is_some_and(|lifted| face.level_at(lifted.truncate()).is_some())
        });
        (!covered).then_some(Hit { ground: Ground::Bare, position, distance_m })
    }

    fn intersect_face(&self, face: usize, origin: Position<BodyFixed>, direction: Direction<BodyFixed>) -> Option<Hit> {
        let Face { map, levels } = &self.terrain.faces[face];
        let start = map.map_vector(origin);
        let towards = map.map_from_body.turn(direction.unit());
        let outermost = levels.last()?;
        let segment = Segment::clip(map, outermost, start, towards)?;
        let open_edge = self.terrain.faces.len() == 1;
        let (ground, lifted) = self.first_ground(face, &segment, open_edge)?;
        let distance_m = (map.unlift(lifted) - start).dot(towards);
        let position = map.body_from_lifted(lifted);
        Some(Hit { ground, position, distance_m })
    }

    fn first_ground(&self, face: usize, segment: &Segment, open_edge: bool) -> Option<(Ground, DVec3)> {
        let Face { map, levels } = &self.terrain.faces[face];
        let outermost = levels.last()?;
        let entry = segment.at(0.0);
        if open_edge && segment.enters_by_the_edge && outermost.is_below_m(entry) {
            return Some((Ground::Gap, entry));
        }
        for (level, from, until) in segment.visits(levels) {
            let mips = self.pyramids[face][level].mips.len();
            let march = March { level: &levels[level], pyramid: &self.pyramids[face][level], segment };
            if let Some((s, cell)) = march.first_hit(mips - 1, from, until) {
                let lifted = segment.at(s);
                let gap = levels[level].cell_has_gap(cell.0, cell.1);
                return Some((if gap { Ground::Gap } else { Ground::Dem { face, level, lifted } }, lifted));
            }
        }
        let exit = segment.at(1.0);
        let under_the_sphere = exit.z < map.lifted_height_m(exit.truncate(), map.radius_m);
        (open_edge && segment.leaves_by_the_edge && under_the_sphere).then_some((Ground::Gap, exit))
    }
}

impl Level {
    fn is_below_m(&self, lifted: DVec3) -> bool {
        self.bilinear_m(self.grid_from_map(lifted.truncate())).is_some_and(|ground_m| lifted.z < ground_m)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::geometry::{Body, Geodetic};
    use crate::terrain::Gnomonic;

    /// Levels of 100 m and 25 m postings with the heights of `height_m(map point)`, the fine one feathered
    /// by construction: its border is bilinear in the coarse one.
    fn nested(height_m: impl Fn(DVec2) -> f64) -> Face {
        let map = Gnomonic::about(&Body::moon(), Geodetic::from_degrees(-89.0, 40.0, 0.0));
        let level = |nodes: usize, posting_m: f64| {
            let south_m = -(nodes as f64 - 1.0) / 2.0 * posting_m;
            let mut level = Level {
                columns: nodes,
                rows: nodes,
                posting_m,
                west_m: south_m,
                south_m,
                heights_m: vec![0.0; nodes * nodes],
                gap: vec![false; nodes * nodes],
                margin: 0,
            };
            for row in 0..nodes {
                for column in 0..nodes {
                    let at_m = level.node_m(column, row);
                    let index = level.index(column, row);
                    level.heights_m[index] = map.lifted_height_m(at_m, map.radius_m + height_m(at_m)) as f32;
                }
            }
            level
        };
        let coarse = level(81, 100.0);
        let mut fine = level(161, 25.0);
        for row in 0..161 {
            for column in 0..161 {
                if [0, 160].contains(&row) || [0, 160].contains(&column) {
                    let grid = coarse.grid_from_map(fine.node_m(column, row));
                    let index = fine.index(column, row);
                    fine.heights_m[index] = coarse.bilinear_m(grid).unwrap() as f32;
                }
            }
        }
        Face { map, levels: vec![fine, coarse] }
    }

    fn hills(at_m: DVec2) -> f64 {
        120.0 * (at_m.x / 410.0).sin() * (at_m.y / 290.0).cos() + 15.0 * (at_m.x / 37.0).sin()
    }

    fn rays(face: &Face) -> Vec<(Position<BodyFixed>, Direction<BodyFixed>)> {
        let mut rays = Vec::new();
        for i in 0..400 {
            let turn = f64::from(i) * 2.399_963;
            let from = DVec3::new(3000.0 * turn.cos(), 3000.0 * turn.sin(), 200.0 + f64::from(i % 7) * 300.0);
            let to = DVec3::new(1700.0 * (3.1 * turn).cos(), 1900.0 * (1.7 * turn).sin(), 0.0);
            let (from, to) = (face.map.body_from_lifted(from), face.map.body_from_lifted(to));
            rays.push((from, from.direction_to(to).unwrap()));
        }
        rays
    }

    /// The finest height under a lifted point, by another way than the traversal.
    fn ground_m(face: &Face, lifted: DVec3) -> Option<f64> {
        let level = &face.levels[face.level_at(lifted.truncate())?];
        level.bilinear_m(level.grid_from_map(lifted.truncate()))
    }

    #[test]
    fn hits_lie_on_the_surface_and_nothing_lies_before_them() {
        let face = nested(hills);
        let surface = Surface::new(Terrain { body: Body::moon(), faces: vec![face.clone()] });
        let mut hits = 0;
        for (origin, direction) in rays(&face) {
            let Some(hit) = surface.intersect(origin, direction) else { continue };
            let Ground::Dem { lifted, .. } = hit.ground else { continue };
            hits += 1;
            assert!((ground_m(&face, lifted).unwrap() - lifted.z).abs() < 1e-6);
            // March in small steps of true distance: the ray stays above the surface up to the hit.
            for step in 1..2000 {
                let t_m = hit.distance_m * f64::from(step) / 2000.0;
                let point = Position::from_m(origin.vector_m() + t_m * direction.unit());
                let lifted = face.map.lifted_from_body(point).unwrap();
                if let Some(ground_m) = ground_m(&face, lifted) {
                    assert!(lifted.z > ground_m - 1e-6, "passed through the ground at {t_m} m of {}", hit.distance_m);
                }
            }
        }
        assert!(hits > 300, "only {hits} of 400 rays met the terrain");
    }

    #[test]
    fn no_ray_slips_between_nested_levels() {
        let face = nested(hills);
        let surface = Surface::new(Terrain { body: Body::moon(), faces: vec![face.clone()] });
        // Straight down on the border of the fine level and a hair beside it.
        for i in 0..1000 {
            for aside in [-1e-7, 0.0, 1e-7] {
                let at = DVec2::new(2000.0 + aside, -2000.0 + f64::from(i) * 4.0);
                let origin = face.map.body_from_lifted(at.extend(2000.0));
                let down = origin.direction_to(face.map.body_from_lifted(at.extend(0.0))).unwrap();
                let hit = surface.intersect(origin, down).unwrap();
                assert!(matches!(hit.ground, Ground::Dem { .. }), "{at} {hit:?}");
            }
        }
    }

    #[test]
    fn without_relief_the_terrain_is_the_sphere() {
        let face = nested(|_| 0.0);
        let surface = Surface::new(Terrain { body: Body::moon(), faces: vec![face.clone()] });
        let bare = Surface::new(Terrain { body: Body::moon(), faces: vec![] });
        for (origin, direction) in rays(&face) {
            let (a, b) = (surface.intersect(origin, direction), bare.intersect(origin, direction));
            let (Some(a), Some(b)) = (a, b) else { continue };
            // A bilinear chord lies at most posting²/(8R) = 0.7 mm below the sphere; f32 heights add 0.1 mm.
            let radius_m = a.position.vector_m().length();
            assert!((radius_m - 1_737_400.0).abs() < 1.5e-3, "{radius_m}");
            assert!((a.distance_m - b.distance_m).abs() < 0.1);
        }
    }

    #[test]
    fn leaving_the_terrain_below_the_sphere_is_a_gap_and_not_a_wall() {
        let face = nested(|_| -500.0);
        let surface = Surface::new(Terrain { body: Body::moon(), faces: vec![face.clone()] });
        let origin = face.map.body_from_lifted(DVec3::new(0.0, 0.0, -490.0));
        let ahead = face.map.body_from_lifted(DVec3::new(10_000.0, 0.0, -490.0));
        let hit = surface.intersect(origin, origin.direction_to(ahead).unwrap()).unwrap();
        assert_eq!(hit.ground, Ground::Gap);
    }
}
