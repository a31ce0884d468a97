//! What the user wrote, and what it means.
//!
//! A scenario is one RON file. [`Spec`] holds it exactly as written: degrees, millimetres, file names.
//! [`resolve()`] turns it into a [`Scenario`]: SI and radians, instants with their scale, files found. All
//! problems of a file are reported together, each with line, column, key, what was got and what is allowed.
//!
//! ```text
//! text --tree--> Tree (values with line and column) --structure--> keys, types, ranges
//! text --ron---> Spec --resolve--> Scenario
//! ```
//!
//! The allowed range of a number stands once, beside its field in [`spec`]: the JSON schema carries it to the
//! check (`structure.rs`) and to the printed reference (`reference.rs`).

mod camera;
mod check;
mod draft;
mod error;
mod files;
mod hints;
mod light;
mod load;
mod motion;
mod presets;
mod resolve;
mod resolved;
mod shape;
mod shipped;
mod structure;
mod sweep;
mod text;
mod tree;
mod varied;
mod world;

pub mod reference;
pub mod spec;

pub use check::FileHint;
pub use error::{Fault, Problem, ScenarioError};
pub use files::SearchPath;
pub use load::load;
pub use resolve::resolve;
pub use resolved::*;
pub use shipped::{SHIPPED, ShippedScenario};
pub use spec::Spec;
pub use structure::schema;
pub use text::parse_shadows;
pub use varied::{Point, Sweep, Varied};
