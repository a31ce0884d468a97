//! The skyline around each surface point.
pub mod error;
pub mod fit;
pub mod pack;
pub mod series;
pub mod settings;
pub mod sphere;
pub mod sweep;
pub mod trace;

pub use error::{Error, ErrorStatistics, TileErrors};
pub use pack::{Encoding, HorizonMap, Texels};
pub use series::Series;
pub use settings::Settings;
