//! Illumination of areas and places as tables, plots, pictures and series.

pub mod findings;
mod pictures;
mod plots;
pub mod series;

pub use findings::{Findings, Lot, Named};
