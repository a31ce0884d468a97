//! The two axes of a map's grid, as a search along an azimuth tells them apart.

use glam::{DVec2, DVec3, Vec2Swizzles as _};

use crate::terrain::Level;

/// The axis along which a line of sight advances by whole nodes: the one it runs along more closely.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Major {
    Row,
    Column,
}

impl Major {
    pub fn of(direction: DVec2) -> Self {
        if direction.y.abs() >= direction.x.abs() { Self::Row } else { Self::Column }
    }

    /// (major, minor) components of a map vector, and back.
    pub fn split(self, vector: DVec2) -> DVec2 {
        match self {
            Self::Row => vector.yx(),
            Self::Column => vector,
        }
    }

    /// Where a plane along this axis, of rows with a stride, has a node of the seen part, (column, row).
    pub fn index(self, stride: usize, [column, row]: [usize; 2]) -> usize {
        match self {
            Self::Row => row * stride + column,
            Self::Column => column * stride + row,
        }
    }

    /// Lifted point of the ground at a seen node of a level, by major and minor index.
    pub fn foot(self, level: &Level, u: usize, v: usize) -> DVec3 {
        let (column, row) = match self {
            Self::Row => (v, u),
            Self::Column => (u, v),
        };
        level.lifted_node(column + level.margin, row + level.margin)
    }
}
