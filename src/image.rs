//! Images on disk.

use std::path::Path;

use perilune_engine::dataset;
use perilune_engine::render::Image;

use crate::{Error, ErrorKind};

/// Writes an image as OpenEXR: float32 planes under their names, with their units in the header.
///
/// # Errors
/// [`ErrorKind::Run`] for a file that cannot be written; nothing is left of it then.
pub fn write_exr(path: impl AsRef<Path>, image: &Image) -> Result<(), Error> {
    dataset::write_exr(path.as_ref(), image, &serde_json::Value::Null)
        .map_err(|error| Error::new(ErrorKind::Run, error))
}
