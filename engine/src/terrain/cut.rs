//! A cut through a quad-tree: the tiles that are drawn, each at its own level of detail.
//!
//! The tiles lie beside each other and none over another. Neighbours across a side differ by one level at most, so that a fine
//! tile can turn into its neighbour's surface along that side ([`super::drawn_tile`]).

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::quadtree::{QuadTree, TileId};
use crate::geometry::{BodyFixed, Position};

/// How far beyond a tile its neighbours are looked for, in nodes.
const BEYOND: f64 = 1e-3;

/// Sides and corners of a tile, as steps from its middle.
pub const NEIGHBOURS: [[i8; 2]; 8] = [[-1, 0], [1, 0], [0, -1], [0, 1], [-1, -1], [1, -1], [-1, 1], [1, 1]];

/// Some of the tiles that make up a sphere.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// Those in whose place their children stand.
    divided: BTreeSet<TileId>,
    tiles: BTreeSet<TileId>,
}

impl Cut {
    /// The coarsest tiles, all of them.
    pub fn coarsest(tree: &QuadTree) -> Self {
        Self { divided: BTreeSet::new(), tiles: tree.roots().collect() }
    }

    /// Tiles no coarser than those `wanted`, wherever these are; of all others those that are `needed`.
    pub fn new(tree: &QuadTree, wanted: impl IntoIterator<Item = TileId>, needed: impl Fn(TileId) -> bool) -> Self {
        let mut divided = BTreeSet::new();
        for tile in wanted {
            divide(&mut divided, tile.parent());
        }
        let mut known = BTreeMap::new();
        loop {
            let leaves: Vec<TileId> = leaves(tree, &divided);
            let needed = |leaf: &TileId| *known.entry(*leaf).or_insert_with(|| needed(*leaf));
            let cut = Self { tiles: leaves.into_iter().filter(needed).collect(), divided: divided.clone() };
            let sides = cut.tiles.iter().flat_map(|tile| NEIGHBOURS[..4].iter().map(move |side| (*tile, *side)));
            let too_coarse = |(tile, side): (TileId, _)| {
                cut.neighbour(tree, tile, side).filter(|other| other.level + 1 < tile.level)
            };
            let more: BTreeSet<TileId> = sides.filter_map(too_coarse).collect();
            if more.is_empty() {
                return cut;
            }
            more.into_iter().for_each(|tile| divide(&mut divided, Some(tile)));
        }
    }

    /// The coarsest first.
    pub fn tiles(&self) -> impl ExactSizeIterator<Item = TileId> + '_ {
        self.tiles.iter().copied()
    }

    /// Which of a tile's [`NEIGHBOURS`] are drawn more coarsely. The tile may stand above drawn ones.
    pub fn coarser_beside(&self, tree: &QuadTree, tile: TileId) -> [bool; 8] {
        NEIGHBOURS.map(|step| self.neighbour(tree, tile, step).is_some_and(|other| other.level < tile.level))
    }

    /// The tile that is drawn beyond a side or a corner of a tile.
    fn neighbour(&self, tree: &QuadTree, tile: TileId, step: [i8; 2]) -> Option<TileId> {
        let half = 0.5 * tree.cells as f64;
        let node = half + DVec2::new(f64::from(step[0]), f64::from(step[1])) * (half + BEYOND);
        let leaf = self.leaf(tree, tree.on_sphere(tile, node));
        self.tiles.contains(&leaf).then_some(leaf)
    }

    /// The undivided tile that holds a point, drawn or not.
    fn leaf(&self, tree: &QuadTree, point: Position<BodyFixed>) -> TileId {
        let mut level = 0;
        loop {
            let (tile, _) = tree.find(level, point);
            if !self.divided.contains(&tile) {
                return tile;
            }
            level += 1;
        }
    }
}

/// Divides a tile, and all that it is a part of.
fn divide(divided: &mut BTreeSet<TileId>, mut tile: Option<TileId>) {
    while let Some(whole) = tile.filter(|tile| divided.insert(*tile)) {
        tile = whole.parent();
    }
}

fn leaves(tree: &QuadTree, divided: &BTreeSet<TileId>) -> Vec<TileId> {
    let inner = divided.iter().flat_map(|tile| tile.children());
    tree.roots().chain(inner).filter(|tile| !divided.contains(tile)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Body, Geodetic};

    fn tree() -> QuadTree {
        QuadTree::new(&Body::moon(), 32, 4000.0)
    }

    fn finest_at(tree: &QuadTree, latitude_deg: f64, longitude_deg: f64) -> TileId {
        let place = Geodetic::from_degrees(latitude_deg, longitude_deg, 0.0);
        tree.find(tree.levels - 1, tree.body.position_from_geodetic(place)).0
    }

    /// Solid angles of a sphere's tiles: those of the cut add up to 4π, each point lies in one.
    #[test]
    fn the_tiles_cover_the_sphere_once() {
        let tree = tree();
        let cut = Cut::new(&tree, [finest_at(&tree, 44.9, 45.1), finest_at(&tree, -80.0, 170.0)], |_| true);
        let share: f64 = cut.tiles().map(|tile| 0.25_f64.powi(tile.level as i32)).sum();
        assert!((share - 6.0).abs() < 1e-12, "{share}");
        assert!(cut.tiles().any(|tile| tile.level == tree.levels - 1));
    }

    /// Around a single finest tile at the corner of the cube, where three faces meet.
    #[test]
    fn neighbours_differ_by_one_level_at_most() {
        let tree = tree();
        let fine = finest_at(&tree, 35.2, 44.9);
        let cut = Cut::new(&tree, [fine], |_| true);
        assert!(cut.tiles.contains(&fine));
        let faces: BTreeSet<usize> = cut.tiles().filter(|tile| tile.level + 2 > fine.level).map(|t| t.face).collect();
        assert!(faces.len() == 3, "detail goes on around the corner: {faces:?}");
        for tile in cut.tiles() {
            for side in &NEIGHBOURS[..4] {
                let other = cut.neighbour(&tree, tile, *side).unwrap();
                assert!(other.level + 1 >= tile.level, "{tile} beside {other}");
            }
        }
        // Unbalanced it would not be so: the children of a root beside a tile of the finest level.
        let alone = Cut { divided: [fine.parent().unwrap()].into(), tiles: BTreeSet::new() };
        assert!(alone.divided.len() < cut.divided.len());
    }

    #[test]
    fn what_nobody_needs_is_left_out_and_counts_as_no_neighbour() {
        let tree = tree();
        let fine = finest_at(&tree, 0.1, 0.1);
        let cut = Cut::new(&tree, [fine], |tile| tile.face == 0 && tile.level + 1 >= fine.level);
        assert!(cut.tiles().all(|tile| tile.level + 1 >= fine.level) && cut.tiles.contains(&fine));
        let coarser = |tile| cut.coarser_beside(&tree, tile).iter().filter(|coarser| **coarser).count();
        assert!(cut.tiles().filter(|tile| tile.level == fine.level).any(|tile| coarser(tile) > 0));
        assert!(cut.tiles().filter(|tile| tile.level < fine.level).all(|tile| coarser(tile) == 0));
    }
}
