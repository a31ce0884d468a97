//! The skyline around each surface point: searched, compressed, stored.
//!
//! ```text
//! Face --sweep--> elevations per azimuth --fit--> Fourier coefficients --pack--> HorizonMap --store--> tile
//!      --trace--> the same, one point at a time, believed; every tile carries its errors against it
//! ```
//!
//! Elevations are angles above the plane perpendicular to the vector from the map's centre of projection, in radians,
//! negative where the skyline lies below it. Azimuths are *map azimuths*: clockwise from map up (+Y)
//! towards map right (+X), a frame that is smooth over a tile even at a pole.
//! [`crate::terrain::Gnomonic::map_direction`] gives the map direction of any direction in space.
//!
//! The surface is bilinear in lifted height between the nodes of the finest level that covers a point. Gaps do not occlude.
//! Beyond the last level lies the bare sphere, lowered to the feet of an observer who stands below it.

pub mod band;
pub mod bound;
pub mod build;
pub mod checkpoint;
pub mod companding;
pub mod decode;
pub mod error;
pub mod exact;
pub mod fit;
pub mod georeference;
pub mod gpu;
pub mod inspect;
pub mod measure;
pub mod memory;
pub mod method;
pub mod numbers;
pub mod pack;
pub mod pages;
pub mod planes;
pub mod request;
pub mod series;
pub mod settings;
pub mod shelf;
pub mod sphere;
pub mod store;
pub mod sweep;
pub mod trace;
pub mod verify;

pub use band::Band;
pub use bound::{BoundStatistics, Bounds};
pub use build::{build, build_at, open_or_build};
pub use error::{Error, ErrorStatistics, TileErrors};
pub use memory::Memory;
pub use method::Method;
pub use pack::{Encoding, Horizon, HorizonMap, Texels};
pub use request::Request;
pub use series::Series;
pub use settings::Settings;
pub use store::Key;
