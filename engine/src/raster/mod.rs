//! Georeferenced rasters in and out: elevation models as heights, and GeoTIFFs. The only user of GDAL.
//!
//! GDAL's objects are not shared between threads: a file is opened for the length of one call, and each
//! thread makes its own [`Projector`]. GDAL's messages go into the errors of this module, never to the
//! terminal.

mod access;
mod coverage;
mod dem;
mod digest;
mod error;
mod georeference;
mod look;
mod north_up;
mod options;
mod parts;
mod picture;
mod placed;
mod reader;
mod reading;
mod sample;
mod summary;
mod survey;
mod unit;
mod window;
mod write;

pub use access::Within;
pub use dem::Dem;
pub use digest::digest;
pub use error::Error;
pub use georeference::{Georeference, Projector};
pub use north_up::cells_around;
pub use options::Options;
pub use picture::{Picture, notes};
pub use reading::{Content, Reading, Values};
pub use summary::{Summary, summary};
pub use survey::Survey;
pub use unit::{LENGTHS, SHARES, metres_in, shares_in};
pub use window::{Around, Window};
pub use write::{GeoTiff, GeoTiffBand};
