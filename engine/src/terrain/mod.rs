//! The surface as height fields over gnomonic maps, on which every line of sight is straight.

pub mod build;
pub mod cut;
pub mod gnomonic;
pub mod level;
mod march;
pub mod mesh;
pub mod patch;
pub mod pyramid;
pub mod quadtree;
mod segment;
pub mod surface;
pub mod synthetic;

pub use build::{GlobalDem, NestedDem, ResamplingError, build_cube, build_face, build_tile, drawn_tile};
pub use cut::Cut;
pub use gnomonic::{AZIMUTH_RATIO_WGSL, Gnomonic};
pub use level::{Face, Level, Terrain};
pub use mesh::Mesh;
pub use pyramid::Pyramid;
pub use quadtree::{QuadTree, TileId};
pub use surface::{Ground, Hit, Surface};
