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
use gdal::errors::GdalError;
use gdal::raster::{GdalDataType, GdalType, RasterBand};

use super::{Error, Georeference, Projector, keep_gdal_quiet};
use crate::geometry::{Body, BodyFixed, Geodetic, Position};

/// What the pixels of a raster mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Values {
    /// Radii if the first valid one lies within 5 % of the body's radius, else heights.
    #[default]
    Auto,
    /// Metres above the body's reference spheroid.
    Height,
    /// Metres from the body's centre.
    Radius,
}

/// A rectangle of pixels. Where columns run all the way around the body it may go on past the last one with the first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    pub column: usize,
    pub row: usize,
    pub columns: usize,
    pub rows: usize,
}

/// The ground within a distance of a place, on the gnomonic map about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Around {
    pub centre: Geodetic,
    pub distance_m: f64,
}

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

fn check_window(path: &Path, (width, height): (usize, usize), window: Option<Window>) -> Result<Window, Error> {
    let Window { column, row, columns, rows } =
        window.unwrap_or(Window { column: 0, row: 0, columns: width, rows: height });
    let fits = |start: usize, count: usize, size: usize| start.checked_add(count).is_some_and(|end| end <= size);
    if !fits(column, columns, width) || !fits(row, rows, height) {
        return Err(Error::Window { path: path.into(), column, row, columns, rows, width, height });
    }
    if columns < 2 || rows < 2 {
        return Err(Error::TooSmall { path: path.into(), columns, rows });
    }
    Ok(Window { column, row, columns, rows })
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

/// Pixels to average along a side: as many as fit the posting. Where columns run around the body they
/// must divide the raster, so that its seams stay whole.
fn reduction(georeference: &Georeference, window: Window, posting_m: Option<f64>) -> usize {
    let pixel_m = georeference.pixel_size() * georeference.metres_per_unit();
    let most = window.columns.min(window.rows) / 2;
    let wanted = posting_m.map_or(1, |posting_m| ((posting_m / pixel_m * (1.0 + 1e-9)) as usize).clamp(1, most));
    let divides = |n: &usize| window.columns.is_multiple_of(*n) && window.rows.is_multiple_of(*n);
    match georeference.period_columns {
        Some(_) => (1..=wanted).rev().find(divides).unwrap_or(1),
        None => wanted,
    }
}

/// The part of a window that holds the ground around a place, in whole blocks of `reduction` pixels, so that
/// blocks are those of the window. Where columns run around the body the part may lie across the seam.
fn needed(
    whole: &Georeference,
    body: &Body,
    window: Window,
    reduction: usize,
    Around { centre, distance_m }: Around,
) -> Result<Window, Error> {
    const PROBES: i32 = 32;
    let middle_m = body.position_from_geodetic(centre).vector_m();
    // Any two directions across each other will do.
    let east_m = middle_m.normalize().any_orthonormal_vector() * distance_m;
    let north_m = middle_m.normalize().cross(east_m);
    let place = |index: i32| {
        let (x, y) = (index % (2 * PROBES + 1) - PROBES, index / (2 * PROBES + 1) - PROBES);
        (middle_m + (f64::from(x) * east_m + f64::from(y) * north_m) / f64::from(PROBES)).normalize()
            * middle_m.length()
    };
    let places: Vec<_> = (0..(2 * PROBES + 1).pow(2)).map(|index| Position::from_m(place(index))).collect();
    let seen = whole.projector()?.pixels(&places).into_iter().filter(|pixel| pixel.is_finite());
    let seen: Vec<DVec2> = seen.collect();
    let (low, high) = seen.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    // Edges bend between probes, and interpolation looks two blocks further.
    let margin = (high - low) * 0.01 + 3.0 * reduction as f64;
    let part = |low: f64, high: f64, start: usize, count: usize| {
        let blocks = (count / reduction) as f64;
        let first = ((low - start as f64) / reduction as f64).floor().clamp(0.0, blocks) as usize * reduction;
        let end = ((high - start as f64) / reduction as f64).ceil().clamp(0.0, blocks) as usize * reduction;
        (start + first, end.saturating_sub(first))
    };
    let (low, high) = (low - margin, high + margin);
    let (row, rows) = part(low.y, high.y, window.row, window.rows);
    let inside = row > window.row && row + rows < window.row + window.rows / reduction * reduction;
    let (column, columns) = match whole.period_columns {
        // Over a pole the map goes on half a turn away.
        Some(period) if inside && (window.columns as f64 - period).abs() < 0.01 => {
            around_the_body(&seen, window.columns, reduction)
        }
        Some(_) => (window.column, window.columns),
        None => part(low.x, high.x, window.column, window.columns),
    };
    // A place outside the file is an error of whoever needs heights there.
    let some = columns >= 2 * reduction && rows >= 2 * reduction;
    Ok(if some { Window { column, row, columns, rows } } else { window })
}

/// Whether columns run once around the body and meet.
fn whole_turn(columns: usize, period: f64) -> bool {
    (period - period.round()).abs() < 0.01 && columns as f64 > period - 0.5
}

/// The shortest run of columns around the body that holds all pixels seen, widened by a margin, in whole blocks; all
/// columns where that is most of them.
fn around_the_body(seen: &[DVec2], columns: usize, reduction: usize) -> (usize, usize) {
    let period = columns as f64;
    let mut at: Vec<f64> = seen.iter().map(|pixel| pixel.x.rem_euclid(period)).collect();
    at.sort_by(f64::total_cmp);
    // What is left out is the widest gap.
    let next = |i: usize| if i + 1 < at.len() { at[i + 1] } else { at[0] + period };
    let Some(end) = (0..at.len()).max_by(|a, b| (next(*a) - at[*a]).total_cmp(&(next(*b) - at[*b]))) else {
        return (0, columns);
    };
    let gap = next(end) - at[end];
    let margin = (period - gap) * 0.01 + 3.0 * reduction as f64;
    let blocks = ((period - gap + 2.0 * margin) / reduction as f64) as usize + 2;
    let first = ((next(end) - margin).rem_euclid(period) / reduction as f64) as usize * reduction;
    if gap < 0.5 * period || blocks * reduction >= columns { (0, columns) } else { (first, blocks * reduction) }
}

/// The affine map of the pixels of a window, averaged `reduction` × `reduction`.
fn part(g: [f64; 6], window: Window, reduction: usize) -> [f64; 6] {
    let (column, row, n) = (window.column as f64, window.row as f64, reduction as f64);
    [g[0] + column * g[1] + row * g[2], g[1] * n, g[2] * n, g[3] + column * g[4] + row * g[5], g[4] * n, g[5] * n]
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
struct Reader<'a> {
    path: &'a Path,
    band: RasterBand<'a>,
    body: &'a Body,
    values: Values,
    window: Window,
    reduction: usize,
    whole: &'a Georeference,
    projector: Projector<'a>,
    masked: Vec<u8>,
}

impl Reader<'_> {
    /// Appends row `row` of the reduced window.
    fn read_row(&mut self, row: usize, heights_m: &mut Vec<f32>) -> Result<(), Error> {
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
