//! Illumination of areas and places as tables, plots, pictures and series.

mod pictures;
mod plots;
mod results;
pub mod series;
mod summary;

pub use results::{AreaResult, PlaceResult};
pub use summary::IlluminationReport;
