//! Pixels of a file as heights.

use std::path::Path;

use gdal::errors::GdalError;
use gdal::raster::{GdalDataType, GdalType, RasterBand};
use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::window::Window;
use super::{Error, Georeference, Projector};
use crate::geometry::{Body, Position};

/// What the numbers of an elevation model are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum Values {
    /// Heights, or radii where the numbers are near the body's radius.
    #[default]
    Auto,
    /// Heights above the file's own ellipsoid.
    Height,
    /// Distances from the body's centre.
    Radius,
}

/// Reads a window of a band that may go on past the last column with the first.
fn read_around<T: GdalType + Copy>(
    band: &RasterBand,
    (column, row): (isize, isize),
    (columns, rows): (usize, usize),
    values: &mut [T],
) -> Result<(), GdalError> {
    let before = columns.min((band.x_size() as isize - column) as usize);
    if before == columns {
        return band.read_into_slice((column, row), (columns, rows), (columns, rows), values, None);
    }
    for (column, from, columns_here) in [(column, 0, before), (0, before, columns - before)] {
        let size = (columns_here, rows);
        let part = band.read_as::<T>((column, row), size, size, None)?;
        for (row, part) in part.data().chunks(columns_here).enumerate() {
            values[row * columns + from..][..columns_here].copy_from_slice(part);
        }
    }
    Ok(())
}

/// Reads rows as heights, one call of GDAL a row of the result.
pub struct Reader<'a> {
    pub path: &'a Path,
    pub band: RasterBand<'a>,
    pub body: &'a Body,
    pub values: Values,
    pub window: Window,
    pub reduction: usize,
    pub whole: &'a Georeference,
    pub projector: Projector<'a>,
    pub masked: Vec<u8>,
}

impl Reader<'_> {
    /// Appends row `row` of the reduced window.
    pub fn read_row(&mut self, row: usize, heights_m: &mut Vec<f32>) -> Result<(), Error> {
        let n = self.reduction;
        let first_row = self.window.row + row * n;
        let mut values = self.read(first_row).map_err(|source| Error::Damaged { path: self.path.into(), source })?;
        self.settle_meaning(&values)?;
        if self.values == Values::Radius {
            self.heights_from_radii(first_row, &mut values);
        }
        let columns = self.window.columns;
        heights_m.extend((0..columns / n).map(|column| {
            let block = (0..n).flat_map(|r| &values[r * columns + column * n..][..n]);
            let (count, sum) = block.filter(|value| value.is_finite()).fold((0, 0.0), |(k, s), v| (k + 1, s + v));
            if count == 0 { f32::NAN } else { (sum / f64::from(count)) as f32 }
        }));
        Ok(())
    }

    /// `reduction` rows of scaled values, NaN where masked.
    fn read(&mut self, first_row: usize) -> Result<Vec<f64>, GdalError> {
        let size = (self.window.columns, self.reduction);
        let origin = (self.window.column as isize, first_row as isize);
        let mut values = vec![0.0; size.0 * size.1];
        let unmasked = self.band.mask_flags()?.is_all_valid();
        read_around(&self.band, origin, size, &mut values)?;
        if !unmasked {
            self.masked.resize(values.len(), 0);
            read_around(&self.band.open_mask_band()?, origin, size, &mut self.masked)?;
        }
        let (scale, offset) = (self.band.scale().unwrap_or(1.0), self.band.offset().unwrap_or(0.0));
        let sentinel = self.band.band_type() == GdalDataType::Int16 && unmasked;
        for (index, value) in values.iter_mut().enumerate() {
            let missing = !unmasked && self.masked[index] == 0 || sentinel && *value == f64::from(i16::MIN);
            *value = if missing || !value.is_finite() { f64::NAN } else { offset + scale * *value };
        }
        Ok(values)
    }

    /// Decides at the first valid value what [`Values::Auto`] means.
    fn settle_meaning(&mut self, values: &[f64]) -> Result<(), Error> {
        let Some(&value) = values.iter().find(|value| value.is_finite()) else { return Ok(()) };
        if self.values != Values::Auto {
            return Ok(());
        }
        let radius_m = self.body.equatorial_radius_m;
        // Within a twentieth of the body's radius.
        self.values = if (value / radius_m - 1.0).abs() < 0.05 {
            Values::Radius
        } else if (value / radius_m).abs() < 0.05 {
            Values::Height
        } else {
            let (path, body) = (self.path.into(), self.body.name.clone());
            return Err(Error::Implausible { path, body, value_m: value, radius_m });
        };
        Ok(())
    }

    fn heights_from_radii(&self, first_row: usize, values: &mut [f64]) {
        if self.body.is_sphere() {
            values.iter_mut().for_each(|value| *value -= self.body.equatorial_radius_m);
            return;
        }
        let columns = self.window.columns;
        let pixel = |index: usize| {
            DVec2::new((self.window.column + index % columns) as f64, (first_row + index / columns) as f64)
        };
        let pixels: Vec<DVec2> = (0..values.len()).map(pixel).collect();
        let figure = &self.whole.figure;
        for (value, on_figure) in values.iter_mut().zip(self.projector.geodetics(&pixels)) {
            let towards = figure.position_from_geodetic(on_figure).vector_m().normalize();
            let point = Position::from_m(towards * *value);
            *value = self.body.geodetic_from_position(point).height_m;
        }
    }
}
