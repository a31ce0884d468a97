//! The sphere as a quad-tree of square tiles over the six faces of a cube.
//!
//! A face is the gnomonic map `|X|, |Y| ≤ R` about its middle ([`Gnomonic::cube`] about latitude 0, longitude 0: faces 1
//! and 2 hold the south and the north pole, no tile has a pole or the antimeridian at its edge only). At level `l` it is cut
//! into `2^l × 2^l` tiles of `cells × cells` cells, so that a tile has `cells + 1` nodes a side and shares the outermost ones
//! with its neighbours, across the cube's edges too. The posting on the map is
//!
//! ```text
//! 2R/(cells · 2^l)        on the ground: · cos²c along and · cos c across, cos c ≥ 1/√3
//! ```
//!
//! so that a parent has half the resolution of its four children (Fritsch et al. 2025), and the ground distance of nodes is the
//! posting in a face's middle, half of it across the middle of an edge.
//!
//! # References
//! Fritsch et al. (2025), *Fourier-compressed horizon maps*, section 4.1: 12 base patches and five levels.

use std::fmt;

use glam::{DVec2, DVec3};

use super::Gnomonic;
use crate::geometry::{Body, BodyFixed, Geodetic, Position};

/// Faces of a cube.
pub const FACES: usize = 6;

/// One tile: its face, its level, and its place on the face, counted from the bottom left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TileId {
    pub level: usize,
    pub face: usize,
    pub column: usize,
    pub row: usize,
}

impl TileId {
    /// The tile of half the resolution that this one is a quarter of.
    pub fn parent(self) -> Option<Self> {
        let level = self.level.checked_sub(1)?;
        Some(Self { level, column: self.column / 2, row: self.row / 2, ..self })
    }

    /// Its quarters, of twice the resolution.
    pub fn children(self) -> [Self; 4] {
        let Self { level, face, column, row } = self;
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(east, north)| Self {
            level: level + 1,
            face,
            column: 2 * column + east,
            row: 2 * row + north,
        })
    }
}

impl fmt::Display for TileId {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}/{}/{}", self.face, self.level, self.column, self.row)
    }
}

/// All tiles of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct QuadTree {
    pub body: Body,
    pub maps: [Gnomonic; FACES],
    /// Cells along a tile's side.
    pub cells: usize,
    /// Levels of detail; the last one is the finest.
    pub levels: usize,
}

impl QuadTree {
    /// The tree whose finest posting is the largest that is no coarser than `posting_m`.
    pub fn new(body: &Body, cells: usize, posting_m: f64) -> Self {
        let across = 2.0 * body.equatorial_radius_m / (posting_m * (1.0 + 1e-9) * cells as f64);
        let levels = 1 + across.log2().ceil().max(0.0) as usize;
        let maps = Gnomonic::cube(body, Geodetic::from_degrees(0.0, 0.0, 0.0));
        Self { body: body.clone(), maps, cells, levels }
    }

    /// Tiles along a face's side.
    pub fn across(&self, level: usize) -> usize {
        1 << level
    }

    /// Distance of nodes on the map.
    pub fn posting_m(&self, level: usize) -> f64 {
        2.0 * self.body.equatorial_radius_m / (self.cells * self.across(level)) as f64
    }

    /// All tiles, coarsest level first.
    pub fn tiles(&self) -> impl Iterator<Item = TileId> + '_ {
        (0..self.levels).flat_map(move |level| {
            let across = self.across(level);
            (0..FACES * across * across).map(move |i| TileId {
                level,
                face: i / (across * across),
                column: i % across,
                row: i / across % across,
            })
        })
    }

    /// Map coordinates of a node of a tile; nodes run on beyond its sides.
    pub fn node_m(&self, tile: TileId, node: DVec2) -> DVec2 {
        // One product: neighbours put their common nodes at the same bits.
        let index = DVec2::new(tile.column as f64, tile.row as f64) * self.cells as f64 + node;
        index * self.posting_m(tile.level) - self.body.equatorial_radius_m
    }

    /// The point of the sphere on which a node of a tile stands.
    pub fn on_sphere(&self, tile: TileId, node: DVec2) -> Position<BodyFixed> {
        let on_plane = self.node_m(tile, node).extend(self.body.equatorial_radius_m);
        let towards = self.maps[tile.face].map_from_body.inverse().turn(on_plane).normalize();
        Position::from_m(towards * self.body.equatorial_radius_m)
    }

    /// The place of a node of a tile on the body.
    pub fn place(&self, tile: TileId, node: DVec2) -> Geodetic {
        self.body.geodetic_from_position(self.on_sphere(tile, node))
    }

    /// The tiles of the coarsest level: one a face.
    pub fn roots(&self) -> impl Iterator<Item = TileId> + use<> {
        (0..FACES).map(|face| TileId { level: 0, face, column: 0, row: 0 })
    }

    /// The tile of a level that holds a point, and where in it, in nodes.
    pub fn find(&self, level: usize, point: Position<BodyFixed>) -> (TileId, DVec2) {
        let vectors = self.maps.iter().map(|map| map.map_vector(point));
        let inside = |p: &DVec3| p.z - p.x.abs().max(p.y.abs());
        let best = vectors.enumerate().max_by(|a, b| inside(&a.1).total_cmp(&inside(&b.1)));
        let (face, p) = best.expect("a cube has faces");
        let radius_m = self.body.equatorial_radius_m;
        let at = (p.truncate() * (radius_m / p.z) + radius_m) / self.posting_m(level);
        let last = (self.across(level) - 1) as f64;
        let tile = (at / self.cells as f64).floor().clamp(DVec2::ZERO, DVec2::splat(last));
        (TileId { level, face, column: tile.x as usize, row: tile.y as usize }, at - tile * self.cells as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree() -> QuadTree {
        QuadTree::new(&Body::moon(), 32, 30_000.0)
    }

    #[test]
    fn the_finest_posting_is_no_coarser_than_asked_for_and_levels_double() {
        let tree = tree();
        assert_eq!(tree.levels, 3);
        assert!(tree.posting_m(2) <= 30_000.0 && tree.posting_m(1) > 30_000.0);
        assert_eq!(tree.tiles().count(), 6 * (1 + 4 + 16));
        // 4 cells of 32 nodes: exactly the posting asked for needs no further level.
        let exact = 2.0 * Body::moon().equatorial_radius_m / 128.0;
        assert_eq!(QuadTree::new(&Body::moon(), 32, exact).levels, 3);
    }

    /// Every node on a tile's border is found again in the tile beside it, at the same place.
    #[test]
    fn tiles_share_the_nodes_of_their_borders_across_the_cubes_edges_too() {
        let tree = tree();
        let cells = tree.cells as f64;
        for tile in tree.tiles() {
            for step in [0.0, 7.0, cells] {
                for (node, outwards) in [
                    (DVec2::new(0.0, step), -DVec2::X),
                    (DVec2::new(cells, step), DVec2::X),
                    (DVec2::new(step, 0.0), -DVec2::Y),
                    (DVec2::new(step, cells), DVec2::Y),
                ] {
                    let beyond = tree.body.position_from_geodetic(tree.place(tile, node + 1e-3 * outwards));
                    let (other, _) = tree.find(tile.level, beyond);
                    assert_ne!(other, tile);
                    let here = tree.body.position_from_geodetic(tree.place(tile, node)).vector_m();
                    let p = tree.maps[other.face].map_vector(Position::from_m(here));
                    let radius_m = tree.body.equatorial_radius_m;
                    let grid = (p.truncate() * (radius_m / p.z) + radius_m) / tree.posting_m(tile.level);
                    assert!((grid - grid.round()).length() < 1e-6, "{tile} {node} in {other}: {grid}");
                }
            }
        }
    }

    #[test]
    fn a_place_is_found_in_the_tile_that_holds_it() {
        let tree = tree();
        for (latitude_deg, longitude_deg) in [(90.0, 0.0), (-90.0, 0.0), (12.0, 180.0), (-35.2, 44.9), (0.0, -179.99)] {
            let point = tree.body.position_from_geodetic(Geodetic::from_degrees(latitude_deg, longitude_deg, 0.0));
            for level in 0..tree.levels {
                let (tile, node) = tree.find(level, point);
                let found = tree.body.position_from_geodetic(tree.place(tile, node));
                assert!((found.vector_m() - point.vector_m()).length() < 1e-3);
                assert!(node.min_element() >= -1e-6 && node.max_element() <= tree.cells as f64 + 1e-6);
            }
        }
    }
}
