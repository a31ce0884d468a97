//! The surface as height fields over gnomonic maps, on which every line of sight is straight.

pub mod build;
pub mod gnomonic;
pub mod level;
mod march;
pub mod pyramid;
pub mod surface;
pub mod synthetic;

pub use build::{NestedDem, ResamplingError, build_cube, build_face};
pub use gnomonic::Gnomonic;
pub use level::{Face, Level, Terrain};
pub use pyramid::Pyramid;
pub use surface::{Ground, Hit, Surface};
