//! What a raster says of itself and holds, for people.

use std::path::Path;

use gdal::Dataset;
use serde::Serialize;

use super::keep_gdal_quiet;

/// A georeferenced raster in short.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// The coordinate reference system's name, and all of it for PROJ.
    pub crs: String,
    pub proj4: Option<String>,
    /// Of a pixel along columns and rows, in the system's units.
    pub pixel: [f64; 2],
    pub unit: String,
    /// West, south, east, north.
    pub bounds: [f64; 4],
    /// Value that stands for none.
    pub nodata: Option<f64>,
    pub bands: usize,
    /// Of the first band.
    pub least: f64,
    pub greatest: f64,
    pub band_unit: String,
}

/// The summary of a file; `None`: GDAL cannot open it, or it lies on no map.
pub fn summary(path: &Path) -> Option<Summary> {
    keep_gdal_quiet();
    let dataset = Dataset::open(path).ok()?;
    let crs = dataset.spatial_ref().ok()?;
    let [left, column_x, row_x, top, column_y, row_y] = dataset.geo_transform().ok()?;
    let (columns, rows) = dataset.raster_size();
    let corner =
        |column: f64, row: f64| [left + column * column_x + row * row_x, top + column * column_y + row * row_y];
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
    let corners = corners.map(|(x, y)| corner(x * columns as f64, y * rows as f64));
    let end = |axis: usize, choose: fn(f64, f64) -> f64| corners.map(|at| at[axis]).into_iter().reduce(choose);
    let band = dataset.rasterband(1).ok()?;
    let range = band.compute_raster_min_max(false).ok()?;
    Some(Summary {
        crs: crs.name().unwrap_or_else(|| "unnamed".into()),
        proj4: crs.to_proj4().ok(),
        pixel: [column_x.hypot(column_y), row_x.hypot(row_y)],
        unit: if crs.is_geographic() { "degree".into() } else { crs.linear_units_name().unwrap_or_default() },
        bounds: [end(0, f64::min)?, end(1, f64::min)?, end(0, f64::max)?, end(1, f64::max)?],
        nodata: band.no_data_value(),
        bands: dataset.raster_count(),
        least: range.min,
        greatest: range.max,
        band_unit: band.unit(),
    })
}
