//! The skyline around each surface point.
pub mod settings;
pub mod sphere;
pub mod sweep;
pub mod trace;

pub use settings::Settings;
