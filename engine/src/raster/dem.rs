//! Elevation models as heights above a body's reference spheroid.
//!
//! Any raster that GDAL opens, in any projected or geographic CRS of the body. Stored values become
//! metres by the band's scale and offset; a mask, a nodata value, NaN and ±∞ become NaN, and so does
//! −32768 in a 16-bit band that declares no nodata value.
//!
//! # Assumptions
//! Heights refer to the body's reference spheroid. Those of Mars usually refer to the areoid, which
//! differs from it by up to some km over a hemisphere, but by metres over a scene. Radii have no such doubt.

use std::fmt;
use std::path::{Path, PathBuf};

use glam::DVec2;

use gdal::Dataset;
use gdal::raster::{GdalDataType, RasterBand};

use super::reader::{Reader, Values};
use super::window::{Around, Window, check_window, needed, part, reduction};
use super::{Error, Georeference, keep_gdal_quiet};
use crate::geometry::{Body, BodyFixed, Geodetic, Position};

/// How to read an elevation model.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// Counted from 1; needed where there are several.
    pub band: Option<usize>,
    pub values: Values,
    /// Read these pixels only.
    pub window: Option<Window>,
    /// Of these, only those that are needed for the ground around a place.
    pub around: Option<Around>,
    /// The posting it will be used at. Pixels are averaged n × n while reading, n = ⌊posting/pixel⌋, so
    /// that a coarse grid holds means and not a random choice of samples.
    pub posting_m: Option<f64>,
    /// Accept a CRS whose body has another radius.
    pub any_body: bool,
}

/// Columns of a file that are looked through at a time.
const STRIP_COLUMNS: usize = 4096;

/// Heights on the pixels of a map.
#[derive(Clone, PartialEq)]
pub struct Dem {
    pub path: PathBuf,
    pub georeference: Georeference,
    pub columns: usize,
    pub rows: usize,
    /// Metres above the body's reference spheroid, NaN where there is no data; row 0 first in the file.
    pub heights_m: Vec<f32>,
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
        let (georeference, columns, rows) =
            Self::read_rows(path, body, options, |reader, row| reader.read_row(row, &mut heights_m))?;
        if heights_m.iter().all(|height| height.is_nan()) {
            return Err(Error::AllNodata { path: path.into() });
        }
        let mut dem = Self { path: path.into(), georeference, columns, rows, heights_m, seams: Seams::default() };
        dem.seams = dem.find_seams()?;
        Ok(dem)
    }

    /// Hands each row of what the options ask for to `read`; tells where it lies and its size.
    fn read_rows(
        path: &Path,
        body: &Body,
        options: &Options,
        mut read: impl FnMut(&mut Reader, usize) -> Result<(), Error>,
    ) -> Result<(Georeference, usize, usize), Error> {
        keep_gdal_quiet();
        let dataset = open_dataset(path)?;
        let band = choose_band(path, &dataset, options.band)?;
        let window = check_window(path, dataset.raster_size(), options.window)?;
        let whole = georeference(path, &dataset)?;
        check_body(path, &whole, body, options.any_body)?;

        let reduction = reduction(&whole, window, options.posting_m);
        let window = match options.around {
            Some(around) => needed(&whole, body, window, reduction, around)?,
            None => window,
        };
        let (columns, rows) = (window.columns / reduction, window.rows / reduction);
        let reduced = Georeference::new(&whole.wkt, part(whole.geotransform, window, reduction), columns)?;
        let projector = whole.projector()?;
        let (values, masked) = (options.values, Vec::new());
        let mut reader = Reader { path, band, body, values, window, reduction, whole: &whole, projector, masked };
        for row in 0..rows {
            read(&mut reader, row)?;
        }
        Ok((reduced, columns, rows))
    }

    /// Lowest and highest height of a file, which is looked through and not kept.
    pub fn extremes_m(path: &Path, body: &Body, options: &Options) -> Result<[f64; 2], Error> {
        let mut extremes_m = [f64::INFINITY, f64::NEG_INFINITY];
        let mut heights_m = Vec::new();
        keep_gdal_quiet();
        let (columns, rows) = open_dataset(path)?.raster_size();
        // Strips narrow enough that the blocks of a tiled file are read once.
        let strips = columns.div_ceil(STRIP_COLUMNS);
        for strip in 0..strips {
            let [column, end] = [strip, strip + 1].map(|strip| strip * columns / strips);
            let window = Some(Window { column, row: 0, columns: end - column, rows });
            Self::read_rows(path, body, &Options { window, ..options.clone() }, |reader, row| {
                heights_m.clear();
                reader.read_row(row, &mut heights_m)?;
                let known = heights_m.iter().map(|height_m| f64::from(*height_m)).filter(|height_m| !height_m.is_nan());
                extremes_m = known.fold(extremes_m, |[low, high], height_m| [low.min(height_m), high.max(height_m)]);
                Ok(())
            })?;
        }
        if extremes_m[0] > extremes_m[1] { Err(Error::AllNodata { path: path.into() }) } else { Ok(extremes_m) }
    }

    /// The place in the middle of a file's pixels. Its heights are not read.
    pub fn middle(path: &Path) -> Result<Geodetic, Error> {
        keep_gdal_quiet();
        let dataset = open_dataset(path)?;
        let (columns, rows) = dataset.raster_size();
        let pixel = (DVec2::new(columns as f64, rows as f64) - 1.0) / 2.0;
        Ok(Geodetic { height_m: 0.0, ..georeference(path, &dataset)?.projector()?.geodetics(&[pixel])[0] })
    }

    /// How a file lies on its body, and its columns and rows. Its heights are not read.
    pub fn lies(path: &Path) -> Result<(Georeference, [usize; 2]), Error> {
        keep_gdal_quiet();
        let dataset = open_dataset(path)?;
        Ok((georeference(path, &dataset)?, dataset.raster_size().into()))
    }

    /// Distance of a file's pixels, along a meridian where they are angles.
    pub fn posting_m(path: &Path) -> Result<f64, Error> {
        keep_gdal_quiet();
        let georeference = georeference(path, &open_dataset(path)?)?;
        Ok(georeference.pixel_size() * georeference.metres_per_unit())
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

pub(super) fn open_dataset(path: &Path) -> Result<Dataset, Error> {
    Dataset::open(path).map_err(|source| match std::fs::metadata(path) {
        Err(source) => Error::File { path: path.into(), source },
        Ok(found) if found.is_dir() => Error::Directory { path: path.into() },
        Ok(_) => Error::NotARaster { path: path.into(), source },
    })
}

pub(super) fn choose_band<'a>(
    path: &Path,
    dataset: &'a Dataset,
    wanted: Option<usize>,
) -> Result<RasterBand<'a>, Error> {
    let bands = dataset.raster_count();
    let band = match (bands, wanted) {
        (0, _) => return Err(Error::NoBand { path: path.into() }),
        (1, None) => 1,
        (_, None) => return Err(Error::ManyBands { path: path.into(), bands }),
        (_, Some(band)) if (1..=bands).contains(&band) => band,
        (_, Some(band)) => return Err(Error::NoSuchBand { path: path.into(), band, bands }),
    };
    let band = dataset.rasterband(band).map_err(|source| Error::Damaged { path: path.into(), source })?;
    // The bindings know the real types only.
    if band.band_type() == GdalDataType::Unknown {
        return Err(Error::NotReal { path: path.into() });
    }
    Ok(band)
}

fn georeference(path: &Path, dataset: &Dataset) -> Result<Georeference, Error> {
    let wkt = dataset.projection();
    if wkt.is_empty() {
        return Err(Error::NoCrs { path: path.into() });
    }
    let geotransform = dataset.geo_transform().map_err(|_| Error::NoGeotransform { path: path.into() })?;
    let [_, a, b, _, c, d] = geotransform;
    if !(a * d - b * c).is_normal() {
        return Err(Error::NoGeotransform { path: path.into() });
    }
    Georeference::new(&wkt, geotransform, dataset.raster_size().0)
}

fn check_body(path: &Path, georeference: &Georeference, body: &Body, any: bool) -> Result<(), Error> {
    let (got_m, expected_m) = (georeference.figure.equatorial_radius_m, body.equatorial_radius_m);
    if any || (got_m / expected_m - 1.0).abs() <= 1e-3 {
        return Ok(());
    }
    Err(Error::OtherBody { path: path.into(), body: body.name.clone(), got_m, expected_m })
}

/// Whether columns run once around the body and meet.
fn whole_turn(columns: usize, period: f64) -> bool {
    (period - period.round()).abs() < 0.01 && columns as f64 > period - 0.5
}
