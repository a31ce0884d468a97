//! The surface as height fields over gnomonic maps, on which every line of sight is straight.

pub mod gnomonic;
pub mod level;

pub use gnomonic::Gnomonic;
pub use level::{Face, Level, Terrain};
