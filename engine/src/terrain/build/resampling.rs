//! What became of a model's own samples on a level's grid.

use glam::DVec2;

use super::{Error, FEATHER_POSTINGS};
use crate::geometry::Body;
use crate::raster::Dem;
use crate::terrain::{Gnomonic, Level};

/// Samples looked at, at most about so many.
const SAMPLES: f64 = 500_000.0;

/// The level's bilinear surface minus the model, at the model's pixel centres, along the ray from the
/// centre of projection, and the slopes of the difference from each to the next of its row. Pixels in the feathered border of a level
/// or next to a gap do not count.
///
/// A slope tells what heights do not: a horizon is off by as much where the ground nearby makes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResamplingError {
    pub rms_m: f64,
    pub max_m: f64,
    pub rms_slope_deg: f64,
    pub samples: usize,
}

impl std::fmt::Display for ResamplingError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { rms_m, max_m, rms_slope_deg, samples } = self;
        write!(
            f,
            "resampling: RMS {rms_m:.3} m, maximum {max_m:.2} m, RMS of slopes {rms_slope_deg:.3}° over {samples} samples"
        )
    }
}

impl ResamplingError {
    /// Of errors and their slopes to the next samples.
    fn of(errors: &[(f64, Option<f64>)]) -> Self {
        let squares = |values: &mut dyn Iterator<Item = f64>| {
            let (count, sum) = values.fold((0, 0.0), |(count, sum), value| (count + 1, sum + value * value));
            (sum / f64::from(count.max(1))).sqrt()
        };
        Self {
            rms_m: squares(&mut errors.iter().map(|(error_m, _)| *error_m)),
            max_m: errors.iter().map(|(error_m, _)| error_m.abs()).fold(0.0, f64::max),
            rms_slope_deg: squares(&mut errors.iter().filter_map(|(_, slope)| *slope)).atan().to_degrees(),
            samples: errors.len(),
        }
    }

    /// Several taken together.
    pub(super) fn of_all(parts: &[Self]) -> Self {
        let samples = parts.iter().map(|part| part.samples).sum::<usize>();
        let rms = |value: &dyn Fn(&Self) -> f64| {
            let sum: f64 = parts.iter().map(|part| value(part).powi(2) * part.samples as f64).sum();
            (sum / samples.max(1) as f64).sqrt()
        };
        Self {
            rms_m: rms(&|part| part.rms_m),
            max_m: parts.iter().map(|part| part.max_m).fold(0.0, f64::max),
            rms_slope_deg: rms(&|part| part.rms_slope_deg),
            samples,
        }
    }
}

pub(super) fn measure(
    body: &Body,
    map: &Gnomonic,
    level: &Level,
    dem: &Dem,
    coarse: Option<&Level>,
) -> Result<ResamplingError, Error> {
    let feather = coarse.map_or(0.0, |coarse| FEATHER_POSTINGS * coarse.posting_m / level.posting_m);
    let border = feather + level.margin as f64;
    let stride = ((dem.heights_m.len() as f64 / SAMPLES).sqrt().ceil() as usize).max(1);
    let projector = dem.georeference.projector()?;
    let mut errors = Vec::new();
    for row in (0..dem.rows).step_by(stride) {
        // Each with the next one of the row.
        let points_of = |next: usize| {
            let columns = (0..dem.columns).step_by(stride).map(|column| (column + next).min(dem.columns - 1));
            let pixels: Vec<DVec2> = columns.map(|column| DVec2::new(column as f64, row as f64)).collect();
            let height_m = |pixel: &DVec2| f64::from(dem.heights_m[row * dem.columns + pixel.x as usize]);
            let heights_m: Vec<f64> = pixels.iter().map(height_m).collect();
            projector.positions(body, &pixels, &heights_m)
        };
        for (point, next) in points_of(0).into_iter().zip(points_of(1)) {
            let error = |point| error_m(map, level, border, map.map_vector(point)).filter(|error_m| !error_m.is_nan());
            let Some(here_m) = error(point) else { continue };
            let distance_m = point.distance_m(next);
            let slope = error(next).filter(|_| distance_m > 0.0).map(|next_m| (next_m - here_m) / distance_m);
            errors.push((here_m, slope));
        }
    }
    Ok(ResamplingError::of(&errors))
}

/// Radius of the level minus that of a point, in map axes from the centre of projection.
fn error_m(map: &Gnomonic, level: &Level, border: f64, point: glam::DVec3) -> Option<f64> {
    if point.is_nan() || point.z <= 0.0 {
        return None;
    }
    let at_m = point.truncate() * (map.radius_m / point.z);
    let grid = level.grid_from_map(at_m);
    let (column, row) = level.cell(grid)?;
    let far = DVec2::new((level.columns - 1) as f64, (level.rows - 1) as f64);
    if grid.min(far - grid).min_element() < border || level.cell_has_gap(column, row) {
        return None;
    }
    let lifted_m = level.bilinear_m(grid)?;
    Some(map.radius_from_lifted_m(at_m.extend(lifted_m)) - point.length())
}
