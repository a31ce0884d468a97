//! A file read from one end to the other: all of its numbers are looked at, means of them are kept where asked for.

use std::path::Path;

use glam::DVec2;

use super::access::open_dataset;
use super::coverage::Knows;
use super::options::Options;
use super::parts::{Part, check_memory, parts};
use super::placed::{check_body, georeference};
use super::reader::Reader;
use super::reading::{Content, Numbers, Values, choose_band, readings, settle, sphere_above_m};
use super::survey::{Survey, Tally};
use super::window::{Window, check_window, needed, part, reduction};
use super::{Error, Georeference, Projector};
use crate::geometry::{Body, Position};

/// What was read: of the pixels that are kept, how they lie.
pub struct Found {
    pub georeference: Georeference,
    pub columns: usize,
    pub rows: usize,
    pub survey: Survey,
}

/// Numbers of a part by which an undecided reading is settled.
const ENOUGH: usize = 4096;

/// Looks at all pixels that the options ask for; `kept` takes the means of `n × n` of them, NaN where there are none.
pub fn look(path: &Path, body: &Body, options: &Options, mut kept: Option<&mut Vec<f32>>) -> Result<Found, Error> {
    let dataset = open_dataset(path)?;
    let band = choose_band(path, &dataset, options.reading.band.map(|band| band as usize))?;
    let window = check_window(path, dataset.raster_size(), options.window)?;
    let whole = georeference(path, &dataset, options.reading.crs.as_deref())?;
    check_body(path, &whole, body, options.any_body)?;

    let n = reduction(&whole, window, options.posting_m);
    let window = match options.around {
        Some(around) => needed(&whole, body, window, n, around)?,
        None => window,
    };
    check_side(path, &whole, window, n, options.most_side)?;
    check_memory(path, &band, window, if kept.is_some() { n } else { n.max(2) })?;
    let (columns, rows) = (window.columns / n, window.rows / n);
    let reduced = Georeference::new(&whole.wkt, part(whole.geotransform, window, n), columns)?;

    let asked = (options.content, options.values, &options.reading);
    let readings = readings(path, (&dataset, &band), &whole, body, asked, !options.any_body)?;
    if let Some(kept) = &mut kept {
        **kept = vec![f32::NAN; columns * rows];
    }
    let mut reader = Reader::new(path, &band, Knows::of(&dataset), options.reading.nodata);
    let settled = settle(path, &readings, &reader.sample(window)?)?;
    let mut pass = Pass { path, body, whole: &whole, settled, tally: Tally::default(), extremes: NOTHING };
    let projector = whole.projector()?;
    for part in parts(window, n, band.x_size(), band.block_size()) {
        let stored = reader.read(part.inside)?;
        if let Some(values) = pass.look(stored, &part, &readings, &projector)?
            && let Some(kept) = &mut kept
        {
            keep_means(&values, &part, n, columns, kept);
        }
    }
    let survey = pass.end(options, n, band.band_type().is_integer())?;
    Ok(Found { georeference: reduced, columns, rows, survey })
}

/// Least and greatest of nothing.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// One pass over a file.
struct Pass<'a> {
    path: &'a Path,
    body: &'a Body,
    whole: &'a Georeference,
    /// `None`: no number was met by which the reading could be settled.
    settled: Option<Numbers>,
    tally: Tally,
    extremes: [f64; 2],
}

impl Pass<'_> {
    /// Looks at the stored numbers of a part and makes values of them; `None` where there are none.
    fn look(
        &mut self,
        stored: Option<Vec<f64>>,
        part: &Part,
        readings: &[Numbers],
        projector: &Projector,
    ) -> Result<Option<Vec<f64>>, Error> {
        let stored = stored.unwrap_or_default();
        if self.settled.is_none() {
            let known = stored.iter().copied().filter(|value| !value.is_nan());
            self.settled = settle(self.path, readings, &known.take(ENOUGH).collect::<Vec<_>>())?;
        }
        let Some(numbers) = self.settled.filter(|_| !stored.is_empty()) else {
            self.tally.look_at_nothing(part.inside.columns * part.inside.rows);
            return Ok(None);
        };
        let at = [part.inside.column, part.inside.row];
        self.tally.look(&numbers, &stored, part.inside.columns, at);
        let mut values = stored;
        to_values(&numbers, &mut values, part, self.body, projector, self.whole);
        self.extremes = values.iter().fold(self.extremes, |[low, high], value| [low.min(*value), high.max(*value)]);
        Ok(Some(values))
    }

    /// What was found; an error where it cannot be right.
    fn end(self, options: &Options, n: usize, counts: bool) -> Result<Survey, Error> {
        let Self { path, body, whole, settled, tally, extremes } = self;
        let Some(numbers) = settled.filter(|_| extremes[0] <= extremes[1]) else {
            return Err(Error::AllNodata { path: path.into() });
        };
        tally.check(path, &body.name, &numbers, options.content, counts)?;
        let mut survey = tally.survey(&numbers, extremes, options.content, whole.posting_m() * n as f64, n);
        if options.content == Content::Elevation && numbers.values == Values::Height && !options.any_body {
            survey.findings.extend(other_figure(whole, body));
        }
        Ok(survey)
    }
}

/// Refuses what could never become a map, before it is read.
fn check_side(path: &Path, whole: &Georeference, window: Window, n: usize, most: Option<usize>) -> Result<(), Error> {
    let (columns, rows) = (window.columns, window.rows);
    let Some(most) = most.filter(|most| columns.max(rows) / n > *most) else { return Ok(()) };
    let posting_m = whole.posting_m();
    Err(Error::TooLarge {
        path: path.into(),
        columns,
        rows,
        posting_m,
        most,
        fitting_posting_m: posting_m * columns.max(rows).div_ceil(most / 2) as f64,
        fitting_extent_m: posting_m * (most / 2 - 1) as f64,
    })
}

/// Stored numbers become heights or shares.
fn to_values(
    numbers: &Numbers,
    stored: &mut [f64],
    part: &Part,
    body: &Body,
    projector: &Projector,
    whole: &Georeference,
) {
    stored.iter_mut().for_each(|value| *value = numbers.value(*value));
    if numbers.values != Values::Radius {
        return;
    }
    if body.is_sphere() {
        return stored.iter_mut().for_each(|value| *value -= body.equatorial_radius_m);
    }
    let figure = &whole.figure;
    for (row, values) in stored.chunks_mut(part.inside.columns).enumerate() {
        let pixel = |column: usize| DVec2::new((part.inside.column + column) as f64, (part.inside.row + row) as f64);
        let pixels: Vec<DVec2> = (0..values.len()).map(pixel).collect();
        for (value, on_figure) in values.iter_mut().zip(projector.geodetics(&pixels)) {
            let towards = figure.position_from_geodetic(on_figure).vector_m().normalize();
            let point = Position::from_m(towards * *value);
            *value = body.geodetic_from_position(point).height_m;
        }
    }
}

/// Means of `n × n` values that are known.
fn keep_means(values: &[f64], part: &Part, n: usize, columns: usize, kept: &mut [f32]) {
    let width = part.inside.columns;
    for (row, block_row) in values.chunks(width * n).enumerate() {
        let kept = &mut kept[(part.row / n + row) * columns + part.column / n..][..width / n];
        for (column, kept) in kept.iter_mut().enumerate() {
            let block = (0..n).flat_map(|r| &block_row[r * width + column * n..][..n]);
            let (count, sum) = block.filter(|value| value.is_finite()).fold((0, 0.0), |(k, s), v| (k + 1, s + v));
            *kept = if count == 0 { f32::NAN } else { (sum / f64::from(count)) as f32 };
        }
    }
}

/// What a user should know where heights stand on another figure than the body's.
fn other_figure(whole: &Georeference, body: &Body) -> Option<String> {
    let got_m = whole.figure.equatorial_radius_m;
    let above_m = sphere_above_m(whole, body);
    if above_m != 0.0 {
        return Some(format!(
            "its coordinate system has a sphere of {got_m} m, {} has {} m: {above_m} m are added to its heights; if they are heights \
             above the latter name a system of that radius with the key crs",
            body.name, body.equatorial_radius_m
        ));
    }
    let (least_m, most_m) = (body.polar_radius_m.min(body.equatorial_radius_m), body.equatorial_radius_m);
    let beside = !body.is_sphere() && !(least_m - 1.0..=most_m + 1.0).contains(&got_m);
    beside.then(|| {
        format!(
            "its coordinate system has a radius of {got_m} m, {} has {most_m} m at the equator: its heights are taken above the \
             latter's spheroid",
            body.name
        )
    })
}
