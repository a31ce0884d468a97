//! Rasters without a map: photographs as they come from archives (PNG, TIFF, ISIS cubes, PDS images).

use std::path::{Path, PathBuf};

use gdal::Metadata;
use gdal::raster::GdalDataType;

use super::Error;
use super::access::open_dataset;
use super::parts::check_memory;
use super::reading::choose_band;
use super::window::Window;

/// One band of a raster. Row 0 is the file's first.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    pub path: PathBuf,
    pub columns: usize,
    pub rows: usize,
    /// The file's numbers, scaled as it says; NaN where it says that there is none.
    pub values: Vec<f32>,
    /// True where the file holds whole numbers of at most eight bits.
    pub eight_bits: bool,
}

impl Picture {
    /// Reads a band, counted from 1; it must be named where there are several.
    pub fn open(path: &Path, band: Option<usize>) -> Result<Self, Error> {
        let dataset = open_dataset(path)?;
        let band = choose_band(path, &dataset, band)?;
        let (columns, rows) = dataset.raster_size();
        check_memory(path, &band, Window { column: 0, row: 0, columns, rows }, 1)?;
        let damaged = |source| Error::Damaged { path: path.into(), source };
        let mut values = vec![0.0_f32; columns * rows];
        band.read_into_slice((0, 0), (columns, rows), (columns, rows), &mut values, None).map_err(damaged)?;
        let mut masked = vec![255_u8; values.len()];
        if !band.mask_flags().map_err(damaged)?.is_all_valid() {
            let mask = band.open_mask_band().map_err(damaged)?;
            mask.read_into_slice((0, 0), (columns, rows), (columns, rows), &mut masked, None).map_err(damaged)?;
        }
        let (scale, offset) = (band.scale().unwrap_or(1.0), band.offset().unwrap_or(0.0));
        // ISIS marks its special pixels (null, saturated) with the five lowest numbers of the type.
        let special = |value: f32| band.band_type() == GdalDataType::Float32 && value <= -3.402_822e38;
        for (value, mask) in values.iter_mut().zip(&masked) {
            let missing = *mask == 0 || special(*value) || !value.is_finite();
            *value = if missing { f32::NAN } else { (offset + scale * f64::from(*value)) as f32 };
        }
        if values.iter().all(|value| value.is_nan()) {
            return Err(Error::AllNodata { path: path.into() });
        }
        let eight_bits = matches!(band.band_type(), GdalDataType::UInt8);
        Ok(Self { path: path.into(), columns, rows, values, eight_bits })
    }
}

/// All that a raster says about itself in text, for instance which images it was made from.
pub fn notes(path: &Path) -> Result<Vec<String>, Error> {
    let dataset = open_dataset(path)?;
    let mut notes = vec![dataset.description().unwrap_or_default()];
    for domain in dataset.metadata_domains() {
        notes.extend(dataset.metadata_domain(&domain).unwrap_or_default());
    }
    for band in dataset.rasterbands().flatten() {
        notes.push(band.description().unwrap_or_default());
        notes.extend(band.metadata_domain("").unwrap_or_default());
    }
    Ok(notes)
}
