//! The skyline around each surface point: searched, compressed, stored.
//!
//! ```text
//! Face --sweep--> elevations per azimuth --fit--> Fourier coefficients --pack--> HorizonMap --store--> tile
//!      --trace--> elevations of one point, the reference: every tile carries its errors against it
//! ```
//!
//! Elevations are angles above the plane perpendicular to the vector from the map's centre of projection, in radians,
//! negative where the skyline lies below it. Azimuths are *map azimuths*: clockwise from map up (+Y)
//! towards map right (+X), a frame that is smooth over a tile even at a pole.
//! [`crate::terrain::Gnomonic::map_direction`] gives the map direction of any direction in space.
//!
//! The surface is bilinear in lifted height between the nodes of the finest level that covers a point. Gaps do not occlude.
//! Beyond the last level lies the bare sphere, lowered to the feet of an observer who stands below it.

pub mod axis;
pub mod band;
pub mod band_limits;
pub mod bound;
pub mod build;
pub mod calibration;
pub mod checkpoint;
pub mod coefficients;
pub mod companding;
pub mod decode;
pub mod elevation_plane;
pub mod error;
pub mod exact;
pub mod fit;
pub mod georeference;
pub mod gpu;
pub mod header;
pub mod inspect;
pub mod key;
pub mod lanes;
pub mod measure;
pub mod memory;
pub mod observer;
pub mod pack;
pub mod pages;
pub mod planes;
pub mod receivers;
pub mod request;
pub mod resources;
pub mod search;
pub mod series;
pub mod settings;
pub mod sphere;
pub mod statistics;
pub mod store;
pub mod sweep;
pub mod texel_store;
pub mod trace;
pub mod verify;
pub mod wide;

pub use band::ElevationBand;
pub use bound::Bounds;
pub use build::{build, build_at, open_or_build};
pub use error::Error;
pub use key::Key;
pub use memory::Memory;
pub use pack::{Encoding, Horizon, HorizonMap, Texels};
pub use request::Request;
pub use resources::Resources;
pub use series::Series;
pub use settings::{Method, Settings};
pub use statistics::{BoundStatistics, ErrorStatistics, TileErrors};
