//! Elevation models as heights above a body's reference spheroid.
//!
//! Any raster that GDAL opens, in any projected or geographic CRS of the body. Stored values become
//! metres by the band's scale, offset and unit; a mask, a nodata value, NaN and ±∞ become NaN, and so do missing blocks,
//! −32768 in a 16-bit band that declares no nodata value and the special pixels of ISIS. What the body cannot have is refused.
//!
//! # Assumptions
//! Heights refer to the body's reference spheroid, or to the sphere of their CRS where body and CRS are spheres. Those of Mars usually refer to the areoid, which
//! differs from it by up to some km over a hemisphere, but by metres over a scene. Radii have no such doubt.

use std::fmt;
use std::path::{Path, PathBuf};

use glam::DVec2;

use super::access::open_dataset;
use super::look::look;
use super::options::Options;
use super::placed::georeference;
use super::reading::Reading;
use super::survey::Survey;
use super::{Error, Georeference};
use crate::geometry::{Body, BodyFixed, Geodetic, Position};

/// Heights on the pixels of a map.
#[derive(Clone, PartialEq)]
pub struct Dem {
    pub path: PathBuf,
    pub georeference: Georeference,
    pub columns: usize,
    pub rows: usize,
    /// Metres above the body's reference spheroid, NaN where there is no data; row 0 first in the file.
    pub heights_m: Vec<f32>,
    /// What was found while it was read.
    pub survey: Survey,
    pub(super) seams: Seams,
}

/// Where the raster's edges meet each other.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Seams {
    /// Columns once around the body, if the raster holds them all.
    pub period: Option<usize>,
    /// The poles, if its first or last row touches them.
    pub poles: [Option<Pole>; 2],
}

/// A pole at a pixel row, on whose other side the map goes on half a turn away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pole {
    /// Twice the row: −1 for a pole on the first row's outer edge, 0 for one on its centre.
    pub twice_row: i64,
    /// Mean height of the row next to it.
    pub mean_m: f64,
}

impl Dem {
    pub fn open(path: &Path, body: &Body, options: &Options) -> Result<Self, Error> {
        let mut heights_m = Vec::new();
        let found = look(path, body, options, Some(&mut heights_m))?;
        let (georeference, columns, rows) = (found.georeference, found.columns, found.rows);
        let survey = found.survey;
        let mut dem =
            Self { path: path.into(), georeference, columns, rows, heights_m, survey, seams: Seams::default() };
        dem.seams = dem.find_seams()?;
        Ok(dem)
    }

    /// Looks through a file, which is not kept.
    pub fn survey(path: &Path, body: &Body, options: &Options) -> Result<Survey, Error> {
        Ok(look(path, body, options, None)?.survey)
    }

    /// How a file lies on its body, and its columns and rows. Its heights are not read.
    pub fn lies(path: &Path, reading: &Reading) -> Result<(Georeference, [usize; 2]), Error> {
        let dataset = open_dataset(path)?;
        Ok((georeference(path, &dataset, reading.crs.as_deref())?, dataset.raster_size().into()))
    }

    /// The place in the middle of a file's pixels. Its heights are not read.
    pub fn middle(path: &Path, reading: &Reading) -> Result<Geodetic, Error> {
        let (georeference, [columns, rows]) = Self::lies(path, reading)?;
        let pixel = (DVec2::new(columns as f64, rows as f64) - 1.0) / 2.0;
        Ok(Geodetic { height_m: 0.0, ..georeference.projector()?.geodetics(&[pixel])[0] })
    }

    /// Distance of a file's pixels, along a meridian where they are angles.
    pub fn posting_m(path: &Path, reading: &Reading) -> Result<f64, Error> {
        Ok(Self::lies(path, reading)?.0.posting_m())
    }

    /// Points of the surface at pixel coordinates; at the mean height where there is no data.
    pub fn points(&self, body: &Body, pixels: &[DVec2]) -> Result<Vec<Position<BodyFixed>>, Error> {
        let mean_m = self.mean_m();
        let height_m = |&pixel| Some(self.height_m(pixel)).filter(|height_m| height_m.is_finite()).unwrap_or(mean_m);
        let heights_m: Vec<f64> = pixels.iter().map(height_m).collect();
        Ok(self.georeference.projector()?.positions(body, pixels, &heights_m))
    }

    /// Mean of the heights that are known.
    pub fn mean_m(&self) -> f64 {
        let known = self.heights_m.iter().filter(|height| !height.is_nan());
        let (count, sum) = known.fold((0.0, 0.0), |(count, sum), &height| (count + 1.0, sum + f64::from(height)));
        sum / count
    }

    fn find_seams(&self) -> Result<Seams, Error> {
        let Some(period) = self.georeference.period_columns else { return Ok(Seams::default()) };
        if !whole_turn(self.columns, period) {
            return Ok(Seams::default());
        }
        let figure = &self.georeference.figure;
        let poles = [90.0, -90.0].map(|latitude_deg| Geodetic::from_degrees(latitude_deg, 0.0, 0.0));
        let points = poles.map(|pole| figure.position_from_geodetic(pole));
        let pixels = self.georeference.projector()?.pixels(&points);
        let poles: Vec<Pole> = pixels.into_iter().filter_map(|pixel| self.pole(pixel.y)).collect();
        let at = |first: bool| poles.iter().copied().find(|pole| (pole.twice_row <= 0) == first);
        Ok(Seams { period: Some(period.round() as usize), poles: [at(true), at(false)] })
    }

    fn pole(&self, row: f64) -> Option<Pole> {
        let twice_row = (2.0 * row).round() as i64;
        let last = 2 * (self.rows as i64 - 1);
        let near = (2.0 * row - twice_row as f64).abs() < 0.02;
        if !near || ![-1, 0, last, last + 1].contains(&twice_row) {
            return None;
        }
        Some(Pole { twice_row, mean_m: self.row_mean_m(if twice_row <= 0 { 0 } else { self.rows - 1 }) })
    }

    fn row_mean_m(&self, row: usize) -> f64 {
        let heights = &self.heights_m[row * self.columns..(row + 1) * self.columns];
        heights.iter().map(|&height| f64::from(height)).sum::<f64>() / self.columns as f64
    }

    /// Other heights on the same pixels.
    pub fn with_heights(&self, heights_m: Vec<f32>) -> Self {
        let mut dem = Self { heights_m, ..self.clone() };
        let means_m = [0, self.rows - 1].map(|row| dem.row_mean_m(row));
        for (pole, mean_m) in dem.seams.poles.iter_mut().zip(means_m) {
            *pole = pole.map(|pole| Pole { mean_m, ..pole });
        }
        dem
    }
}

impl fmt::Debug for Dem {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { path, columns, rows, georeference, .. } = self;
        write!(f, "Dem {{ {path:?}, {columns} x {rows}, {georeference:?}, .. }}")
    }
}

/// Whether columns run once around the body and meet.
fn whole_turn(columns: usize, period: f64) -> bool {
    (period - period.round()).abs() < 0.01 && columns as f64 > period - 0.5
}
