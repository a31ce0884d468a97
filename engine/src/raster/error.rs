//! What can be wrong with a raster.

use std::io;
use std::path::PathBuf;
use std::sync::Once;

use gdal::errors::GdalError;

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("cannot read {path}")]
    File { path: PathBuf, source: io::Error },
    #[error("{path} is a directory, not a raster")]
    Directory { path: PathBuf },
    #[error("{path} is not a raster that GDAL can open")]
    NotARaster { path: PathBuf, source: GdalError },
    #[error("{path} cannot be read to its end: truncated or damaged")]
    Damaged { path: PathBuf, source: GdalError },
    #[error("{path} has {columns} x {rows} pixels, a height field needs at least 2 x 2")]
    TooSmall { path: PathBuf, columns: usize, rows: usize },
    #[error("{path} holds no raster band: a container needs the name of one of its subdatasets")]
    NoBand { path: PathBuf },
    #[error("{path} has {bands} bands: choose one of 1 to {bands}")]
    ManyBands { path: PathBuf, bands: usize },
    #[error("{path} has no band {band}, only 1 to {bands}")]
    NoSuchBand { path: PathBuf, band: usize, bands: usize },
    #[error("{path} holds complex numbers or an unknown type, heights are real")]
    NotReal { path: PathBuf },
    #[error("{path} holds no valid height: every pixel is nodata")]
    AllNodata { path: PathBuf },
    #[error("window of {columns} x {rows} pixels at ({column}, {row}) leaves {path}, which has {width} x {height}")]
    Window { path: PathBuf, column: usize, row: usize, columns: usize, rows: usize, width: usize, height: usize },
    #[error("{path} has no georeference: no affine map from pixels to its coordinate system")]
    NoGeotransform { path: PathBuf },
    #[error("{path} has no coordinate reference system")]
    NoCrs { path: PathBuf },
    #[error("the coordinate reference system {definition:?} cannot be used")]
    Crs { definition: String, source: GdalError },
    #[error("{path} is referenced to a body of radius {got_m} m, {body} has {expected_m} m (allowed: 0.1 % apart)")]
    OtherBody { path: PathBuf, body: String, got_m: f64, expected_m: f64 },
    #[error("{path}: a value of {value_m} m is neither a height above nor a radius of {body} (radius {radius_m} m)")]
    Implausible { path: PathBuf, body: String, value_m: f64, radius_m: f64 },
    #[error("cannot write {path}")]
    Write { path: PathBuf, source: GdalError },
    #[error("cannot write {path}")]
    Unwritable { path: PathBuf, source: io::Error },
}

/// Blocks of files that GDAL may keep in memory, in MiB; by itself it takes a twentieth of the machine's.
const CACHE_MIB: &str = "16";

/// GDAL's messages reach the user through our errors. By default it prints them to the terminal as well.
pub(super) fn keep_gdal_quiet() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        gdal::config::set_error_handler(|_, _, _| {});
        // Refused only for a name or a value with a NUL in it.
        let _ = gdal::config::set_config_option("GDAL_CACHEMAX", CACHE_MIB);
    });
}
