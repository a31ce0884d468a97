//! A band's stored numbers, NaN where the file or the user says that there are none.

use std::path::Path;

use gdal::errors::GdalError;
use gdal::raster::{GdalDataType, RasterBand};

use super::Error;
use super::coverage::{Knows, Rectangle, holes};
use super::window::Window;

/// Places along a side at which numbers are sampled, and the side of a sample.
const PLACES: usize = 4;
const SIDE: usize = 32;

/// ISIS marks its special pixels (null, saturated) with the five lowest `f32`.
const SPECIAL: f64 = -3.402_822e38;

/// Reads rectangles of a band.
pub struct Reader<'a> {
    pub path: &'a Path,
    pub band: &'a RasterBand<'a>,
    /// Besides what the file declares.
    pub nodata: Option<f64>,
    knows: Knows,
    masked: Vec<u8>,
}

impl<'a> Reader<'a> {
    pub fn new(path: &'a Path, band: &'a RasterBand<'a>, knows: Knows, nodata: Option<f64>) -> Self {
        Self { path, band, nodata, knows, masked: Vec::new() }
    }

    /// The numbers of a rectangle, row by row; `None` where the file holds nothing for all of it.
    pub fn read(&mut self, rectangle: Rectangle) -> Result<Option<Vec<f64>>, Error> {
        let mut empty = Vec::new();
        holes(self.band, self.knows, rectangle, &mut |hole| empty.push(hole));
        let missing: usize = empty.iter().map(|hole| hole.columns * hole.rows).sum();
        if missing == rectangle.columns * rectangle.rows {
            return Ok(None);
        }
        let damaged = |source| Error::Damaged { path: self.path.into(), source };
        let is_whole = self.band.mask_flags().map_err(damaged)?.is_all_valid();
        let mut stored = self.stored(rectangle, is_whole).map_err(damaged)?;
        for hole in empty {
            for row in hole.row - rectangle.row..hole.row - rectangle.row + hole.rows {
                let first = row * rectangle.columns + hole.column - rectangle.column;
                stored[first..first + hole.columns].fill(f64::NAN);
            }
        }
        Ok(Some(stored))
    }

    fn stored(&mut self, rectangle: Rectangle, is_whole: bool) -> Result<Vec<f64>, GdalError> {
        let size = (rectangle.columns, rectangle.rows);
        let origin = (rectangle.column as isize, rectangle.row as isize);
        let mut stored = vec![0.0; size.0 * size.1];
        self.band.read_into_slice(origin, size, size, &mut stored, None)?;
        if !is_whole {
            self.masked.resize(stored.len(), 0);
            self.band.open_mask_band()?.read_into_slice(origin, size, size, &mut self.masked, None)?;
        }
        let band_type = self.band.band_type();
        let sentinel = is_whole && band_type == GdalDataType::Int16;
        let special = band_type == GdalDataType::Float32;
        for (index, value) in stored.iter_mut().enumerate() {
            let missing = !is_whole && self.masked[index] == 0
                || sentinel && *value == f64::from(i16::MIN)
                || special && *value <= SPECIAL
                || self.nodata.is_some_and(|nodata| same(*value, nodata));
            if missing || !value.is_finite() {
                *value = f64::NAN;
            }
        }
        Ok(stored)
    }

    /// Numbers from places all over a window.
    pub fn sample(&mut self, window: Window) -> Result<Vec<f64>, Error> {
        let mut sample = Vec::new();
        for index in 0..PLACES * PLACES {
            let at = |index: usize, count: usize| (2 * index + 1) * count / (2 * PLACES);
            let column = (window.column + at(index % PLACES, window.columns)) % self.band.x_size();
            let row = window.row + at(index / PLACES, window.rows);
            let columns = SIDE.min(self.band.x_size() - column);
            let rows = SIDE.min(window.row + window.rows - row);
            let stored = self.read(Rectangle { column, row, columns, rows })?;
            sample.extend(stored.into_iter().flatten().filter(|value| !value.is_nan()));
        }
        Ok(sample)
    }
}

/// As numbers are written: `-3.4e38` has fewer digits than the file.
fn same(stored: f64, written: f64) -> bool {
    stored == written || (stored - written).abs() <= 1e-6 * written.abs()
}
