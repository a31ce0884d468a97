//! GeoTIFFs of 32-bit floats, tiled and compressed without loss.
//!
//! A file appears under its name only when it is complete: it is written under a temporary name beside
//! it and then moved. NaN is declared as nodata. GDAL before 3.7 reports no error when a disk fills
//! while it closes a file, so the file is opened again before it is moved.

use std::path::{Path, PathBuf};

use gdal::raster::{Buffer, RasterCreationOptions};
use gdal::spatial_ref::SpatialRef;
use gdal::{Dataset, DriverManager, Metadata};

use gdal::errors::GdalError;

use super::{Error, keep_gdal_quiet};

/// One band: what it holds, and its values row by row from the top left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band<'a> {
    pub name: &'a str,
    pub unit: &'a str,
    pub values: &'a [f32],
}

/// A raster to write.
#[derive(Debug, Clone, PartialEq)]
pub struct GeoTiff<'a> {
    pub columns: usize,
    pub rows: usize,
    /// All of `columns × rows` values.
    pub bands: Vec<Band<'a>>,
    /// WKT, PROJ string or authority code.
    pub crs: &'a str,
    /// GDAL's affine map: from the first pixel's corner, see [`Georeference`](super::Georeference).
    pub geotransform: [f64; 6],
}

impl GeoTiff<'_> {
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        keep_gdal_quiet();
        let temporary = beside(path);
        let written = self.write_to(&temporary).map_err(|source| Error::Write { path: path.into(), source });
        let moved = written.and_then(|()| {
            std::fs::rename(&temporary, path).map_err(|source| {
                let (from, to) = (temporary.clone(), path.into());
                Error::Rename { from, to, source }
            })
        });
        if moved.is_err() {
            // What is left of a failed attempt; the error to report is the one before.
            let _ = std::fs::remove_file(&temporary);
        }
        moved
    }

    fn write_to(&self, path: &Path) -> Result<(), GdalError> {
        let options = ["TILED=YES", "COMPRESS=DEFLATE", "PREDICTOR=3", "BIGTIFF=IF_SAFER"];
        let driver = DriverManager::get_driver_by_name("GTiff")?;
        let size = (self.columns, self.rows);
        let options = RasterCreationOptions::from_iter(options);
        let mut file =
            driver.create_with_band_type_with_options::<f32, _>(path, size.0, size.1, self.bands.len(), &options)?;
        file.set_spatial_ref(&SpatialRef::from_definition(self.crs)?)?;
        file.set_geo_transform(&self.geotransform)?;
        for (index, band) in self.bands.iter().enumerate() {
            let mut target = file.rasterband(index + 1)?;
            target.set_no_data_value(Some(f64::NAN))?;
            target.set_description(band.name)?;
            target.set_metadata_item("UNIT", band.unit, "")?;
            target.write((0, 0), size, &mut Buffer::new(size, band.values.to_vec()))?;
        }
        file.flush_cache()?;
        file.close()?;
        // The last row of the last band is written last.
        let whole = Dataset::open(path)?;
        let last_row = (0, self.rows as isize - 1);
        whole.rasterband(self.bands.len())?.read_as::<f32>(last_row, (self.columns, 1), (self.columns, 1), None)?;
        Ok(())
    }
}

/// A name in the same folder, so that moving it is one step.
fn beside(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.{}.part", std::process::id()))
}
