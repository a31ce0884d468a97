//! What can be wrong with a raster.

use std::io;
use std::path::PathBuf;

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
    #[error("{path} names a database or a place on the network: what is read lies in local files; download it first")]
    Remote { path: PathBuf },
    #[error("{path} holds no raster band")]
    NoBand { path: PathBuf },
    #[error("{path} is a container of {} rasters: name one of them, as in path: {}", parts.len(), named(parts))]
    Container { path: PathBuf, parts: Vec<String> },
    #[error("{path} has {bands} bands: choose one with the key band: {}", names.join(", "))]
    ManyBands { path: PathBuf, bands: usize, names: Vec<String> },
    #[error("{path} holds indices of a palette's colours, which are neither heights nor albedos: expand them first")]
    Palette { path: PathBuf },
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
    #[error("{path} has no coordinate reference system: name it with the key crs")]
    NoCrs { path: PathBuf },
    #[error("{path} has {count} ground control points and no map: make one first, as in gdalwarp -tps {} map.tif", path.display())]
    ControlPoints { path: PathBuf, count: usize },
    #[error(
        "{path} has a local coordinate system, which has no place on a body: name its map projection with the key crs"
    )]
    LocalGrid { path: PathBuf },
    #[error(
        "{path} counts longitudes positive west in its label, which is not undone here: name its map projection with the key crs"
    )]
    West { path: PathBuf },
    #[error("the coordinate reference system {definition:?} cannot be used")]
    Crs { definition: String, source: GdalError },
    #[error(
        "{path} is referenced to a body of radius {got_m} m, {body} has {expected_m} m (allowed: 0.1 % apart); if its system is \
         another one name that with the key crs"
    )]
    OtherBody { path: PathBuf, body: String, got_m: f64, expected_m: f64 },
    #[error(
        "{path}: {}a {} of {body} lies between {low_m:.0} and {high_m:.0} m: {}{} comes {count} times, first at column \
         {column}, row {row}; if it marks missing data write nodata: {}, else see the keys unit, scale, offset and values",
        of_all(*wrong, *pixels), height_or_radius(*low_m), short(*stored), in_metres(*stored, *value_m), short(*stored)
    )]
    Implausible {
        path: PathBuf,
        body: Box<str>,
        stored: f64,
        value_m: f64,
        count: u64,
        column: u32,
        row: u32,
        wrong: u64,
        pixels: u64,
        low_m: f64,
        high_m: f64,
    },
    #[error(
        "{path}: numbers like {value} may be heights in m or radii in km: write values: Height, or values: Radius and unit: \"km\""
    )]
    Ambiguous { path: PathBuf, value: f64 },
    #[error(
        "{path}: {}an albedo lies between 0 and 1: {} comes {count} times, first at column {column}, row {row}; {hint}",
        of_all(*wrong, *pixels), short(*stored)
    )]
    NoAlbedo {
        path: PathBuf,
        stored: f64,
        count: u64,
        column: usize,
        row: usize,
        wrong: u64,
        pixels: u64,
        hint: String,
    },
    #[error("{path}: its unit {unit:?} is not known; write the unit of its values with the key unit: {allowed}")]
    Unit { path: PathBuf, unit: String, allowed: &'static str },
    #[error(
        "{path}: its band is in {unit}, its vertical coordinate system in units of {other_m} m; settle it with the key unit"
    )]
    Units { path: PathBuf, unit: String, other_m: f64 },
    #[error(
        "{path} is stored in blocks of {columns} x {rows} pixels, {} MiB each, at most {} MiB are read at a time: store it anew, as \
         in gdal_translate -co TILED=YES", bytes >> 20, most >> 20
    )]
    Block { path: PathBuf, columns: usize, rows: usize, bytes: usize, most: usize },
    #[error(
        "{path}: {columns} x {rows} pixels, averaged {n} x {n}, are more than the {most} that are read: ask for a part of it"
    )]
    TooMany { path: PathBuf, columns: usize, rows: usize, most: usize, n: usize },
    #[error("{path}: {n} x {n} pixels would be one, at most {most} x {most} are averaged: ask for a finer posting")]
    Averaged { path: PathBuf, n: usize, most: usize },
    #[error(
        "{path} has {columns} x {rows} pixels of {posting_m} m, more than the {most} a side that maps are made from: \
         posting_m = {fitting_posting_m} or extent_m = {fitting_extent_m} fits"
    )]
    TooLarge {
        path: PathBuf,
        columns: usize,
        rows: usize,
        posting_m: f64,
        most: usize,
        fitting_posting_m: f64,
        fitting_extent_m: f64,
    },
    #[error("cannot write {path}")]
    Write { path: PathBuf, source: GdalError },
    #[error("cannot write {path}")]
    Unwritable { path: PathBuf, source: io::Error },
}

/// The first few.
fn named(parts: &[String]) -> String {
    const SHOWN: usize = 8;
    let shown: Vec<_> = parts.iter().take(SHOWN).map(|part| format!("{part:?}")).collect();
    shown.join(", ") + if parts.len() > SHOWN { ", …" } else { "" }
}

fn of_all(wrong: u64, pixels: u64) -> String {
    format!("{wrong} of {pixels} values are wrong: ")
}

/// Ranges of radii begin far above all heights.
fn height_or_radius(low_m: f64) -> &'static str {
    if low_m > 0.0 { "radius" } else { "height" }
}

fn in_metres(stored: f64, value_m: f64) -> String {
    if stored == value_m { String::new() } else { format!(" ({value_m:.6} m)") }
}

/// A stored number with no more digits than tell it, as a scenario may write it.
pub(super) fn short(stored: f64) -> String {
    let single = stored as f32;
    match (f64::from(single) == stored, stored.abs() >= 1e9) {
        (true, true) => format!("{single:e}"),
        (true, false) => single.to_string(),
        (false, true) => format!("{stored:e}"),
        (false, false) => stored.to_string(),
    }
}
