//! GeoTIFFs of 32-bit floats, tiled and compressed without loss.
//!
//! A file appears under its name only when it is complete ([`crate::files`]). NaN is declared as nodata. GDAL before 3.7
//! reports no error when a disk fills while it closes a file, so the file is opened again before it gets its name.

use std::path::Path;

use gdal::raster::{Buffer, RasterBand, RasterCreationOptions};
use gdal::spatial_ref::SpatialRef;
use gdal::{Dataset, DriverManager, Metadata};

use gdal::errors::GdalError;

use super::Error;
use super::access::keep_gdal_quiet;
use crate::files::NewFile;

/// One band: what it holds, and its values row by row from the top left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeoTiffBand<'a> {
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
    pub bands: Vec<GeoTiffBand<'a>>,
    /// WKT, PROJ string or authority code.
    pub crs: &'a str,
    /// GDAL's affine map: from the first pixel's corner, see [`Georeference`](super::Georeference).
    pub geotransform: [f64; 6],
}

impl GeoTiff<'_> {
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        keep_gdal_quiet();
        let unwritable = |source| Error::Unwritable { path: path.into(), source };
        let file = NewFile::create(path).map_err(unwritable)?;
        self.write_to(file.temporary()).map_err(|source| Error::Write { path: path.into(), source })?;
        file.commit().map(|_| ()).map_err(unwritable)
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
            set_unit(&target, band.unit)?;
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

/// GDAL's unit of a band, which the bindings can read only.
fn set_unit(band: &RasterBand, unit: &str) -> Result<(), GdalError> {
    let text = std::ffi::CString::new(unit)?;
    // SAFETY: the handle lives as long as the band, the text as long as the call, which copies it.
    let class = unsafe { gdal_sys::GDALSetRasterUnitType(band.c_rasterband(), text.as_ptr()) };
    if class == gdal_sys::CPLErr::CE_None {
        return Ok(());
    }
    Err(GdalError::CplError { class, number: 0, msg: format!("the unit {unit} of a band is not taken") })
}
