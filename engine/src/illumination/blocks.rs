//! Square blocks of a level's seen nodes.

use crate::terrain::Level;

/// Nodes along a block's side.
pub const BLOCK: usize = 32;
/// Nodes of a block.
pub const LANES: usize = BLOCK * BLOCK;

/// The seen nodes of a level, row by row up the map, in blocks; blocks beyond its edges are filled by repeating them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Blocks {
    pub columns: usize,
    pub rows: usize,
}

impl Blocks {
    pub fn of(level: &Level) -> Self {
        let [columns, rows] = level.seen_size();
        Self { columns, rows }
    }

    pub fn nodes(&self) -> usize {
        self.columns * self.rows
    }

    /// Blocks side by side.
    pub fn across(&self) -> usize {
        self.columns.div_ceil(BLOCK)
    }

    pub fn count(&self) -> usize {
        self.across() * self.rows.div_ceil(BLOCK)
    }

    /// Column and row of a block's first node.
    pub fn first(&self, block: usize) -> [usize; 2] {
        [block % self.across() * BLOCK, block / self.across() * BLOCK]
    }

    /// Column and row of the node whose skyline fills a lane.
    pub fn node(&self, block: usize, lane: usize) -> [usize; 2] {
        let [column, row] = self.first(block);
        [(column + lane % BLOCK).min(self.columns - 1), (row + lane / BLOCK).min(self.rows - 1)]
    }

    /// Block and lane of a node, by its index.
    pub fn lane(&self, node: usize) -> (usize, usize) {
        let (column, row) = (node % self.columns, node / self.columns);
        (row / BLOCK * self.across() + column / BLOCK, row % BLOCK * BLOCK + column % BLOCK)
    }

    /// The blocks that hold one of the nodes that count.
    pub fn holding(&self, counts: &[bool]) -> Vec<usize> {
        let mut holds = vec![false; self.count()];
        for (node, _) in counts.iter().enumerate().filter(|(_, counts)| **counts) {
            holds[self.lane(node).0] = true;
        }
        (0..self.count()).filter(|block| holds[*block]).collect()
    }
}
