//! Methods that answer how much of a light's disc is seen from a point of the terrain.
//!
//! A method knows the skyline across the disc; the disc integral ([`crate::photometry::SolarDisk`]) does the
//! rest. Each method is a folder: how it is asked for ([`MethodOptions`]), its part for the host and its part for a device
//! ([`ShadowMethod`]). [`registry`] is the only list of them.
//!
//! ```text
//! traced          exact, at every sample                     mipmaps       searched at every sample
//! horizon_maps    compressed horizons of all azimuths        multiscale    from an ever coarser image of the terrain
//! towards_sun     horizons in the azimuths of the light      off           none
//! ```

pub mod device;
pub mod fan;
pub mod field_pages;
pub mod horizon_maps;
pub mod interpolated;
pub mod light;
pub mod method;
pub mod mipmaps;
pub mod multiscale;
pub mod near;
pub mod off;
pub mod registry;
pub mod site;
pub mod sky;
pub mod skylines;
pub mod towards_sun;
pub mod traced;

pub use device::{DeviceError, DevicePart, FieldMaker, Fields};
pub use interpolated::InterpolatedSkylines;
pub use light::{Pointing, QuantizedLight};
pub use method::{Cost, Domain, Ingredients, MethodOptions, PrepareError, ShadowMethod, Workload};
pub use near::Near;
pub use site::{BoundedShadow, Disc, Shadow, Site};
pub use skylines::{SkylineSource, Skylines, SurfacePoints, UnpreparedLight};
