//! The skyline around each surface point.
pub mod build;
pub mod checkpoint;
pub mod error;
pub mod fit;
pub mod georeference;
pub mod inspect;
pub mod measure;
pub mod pack;
pub mod series;
pub mod settings;
pub mod sphere;
pub mod store;
pub mod sweep;
pub mod trace;

pub use build::{build, open_or_build};
pub use error::{Error, ErrorStatistics, TileErrors};
pub use pack::{Encoding, HorizonMap, Texels};
pub use series::Series;
pub use settings::Settings;
pub use store::Key;
