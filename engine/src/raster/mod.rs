//! Georeferenced rasters in and out: elevation models as heights, and GeoTIFFs. The only user of GDAL.
//!
//! GDAL's objects are not shared between threads: a file is opened for the length of one call, and each
//! thread makes its own [`Projector`]. GDAL's messages go into the errors of this module, never to the
//! terminal.

mod dem;
mod digest;
mod error;
mod georeference;
mod north_up;
mod picture;
mod reader;
mod sample;
mod summary;
mod window;
mod write;

pub use dem::{Dem, Options};
pub use digest::digest;
pub use error::Error;
use error::keep_gdal_quiet;
pub use georeference::{Georeference, Projector};
pub use north_up::cells_around;
pub use picture::{Picture, notes};
pub use reader::Values;
pub use summary::{Summary, summary};
pub use window::{Around, Window};
pub use write::{GeoTiff, GeoTiffBand};
