//! What became of a model's own samples on a level's grid.

use glam::DVec2;

use super::{Error, FEATHER_POSTINGS};
use crate::geometry::Body;
use crate::raster::Dem;
use crate::terrain::{Gnomonic, Level};

/// Samples looked at, at most about so many.
const SAMPLES: f64 = 500_000.0;

/// The level's bilinear surface minus the model, at the model's pixel centres, along the ray from the
/// centre of projection. Pixels in the feathered border of a level or next to a gap do not count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResamplingError {
    pub rms_m: f64,
    pub max_m: f64,
    pub samples: usize,
}

impl std::fmt::Display for ResamplingError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "resampling: RMS {:.3} m, maximum {:.2} m over {} samples", self.rms_m, self.max_m, self.samples)
    }
}

impl ResamplingError {
    fn of(errors_m: impl Iterator<Item = f64>) -> Self {
        let (samples, sum, max_m) = errors_m.fold((0, 0.0, 0.0), |(samples, sum, max): (usize, f64, f64), error_m| {
            (samples + 1, sum + error_m * error_m, max.max(error_m.abs()))
        });
        Self { rms_m: (sum / samples.max(1) as f64).sqrt(), max_m, samples }
    }

    /// Several taken together.
    pub(super) fn of_all(parts: &[Self]) -> Self {
        let samples = parts.iter().map(|part| part.samples).sum::<usize>();
        let sum: f64 = parts.iter().map(|part| part.rms_m * part.rms_m * part.samples as f64).sum();
        let max_m = parts.iter().map(|part| part.max_m).fold(0.0, f64::max);
        Self { rms_m: (sum / samples.max(1) as f64).sqrt(), max_m, samples }
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
    let columns: Vec<usize> = (0..dem.columns).step_by(stride).collect();
    let projector = dem.georeference.projector()?;
    let mut errors_m = Vec::new();
    for row in (0..dem.rows).step_by(stride) {
        let pixels: Vec<DVec2> = columns.iter().map(|&column| DVec2::new(column as f64, row as f64)).collect();
        let height_m = |&column: &usize| f64::from(dem.heights_m[row * dem.columns + column]);
        let heights_m: Vec<f64> = columns.iter().map(height_m).collect();
        for point in projector.positions(body, &pixels, &heights_m) {
            errors_m.extend(error_m(map, level, border, map.map_vector(point)).filter(|error_m| !error_m.is_nan()));
        }
    }
    Ok(ResamplingError::of(errors_m.into_iter()))
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
