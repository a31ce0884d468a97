//! Ground below the posting of a measured model, made up so that it continues what was measured.
//!
//! ```text
//! h = measured + (fractal + craters + boulders) − its means over the measured posting
//! ```
//!
//! **Fractal.** The measured heights differ over a distance `L` by `s L^H` RMS; `s` and `H` are fitted at 1, 2, 4 and 8
//! postings about the place. Octaves of gradient noise from two postings down to four of the new ones go on with amplitudes
//! `c λ^H`, `c` such that all octaves together, longer ones too, would have that structure function.
//!
//! **Craters** under two postings have the equilibrium density of [`super`], boulders the density asked for over 1 m and a
//! cumulative exponent of −3; they are half buried spheres.
//!
//! **Means.** What was made up is taken off again as far as it changes the mean over a measured posting: interpolated means are
//! subtracted [`ROUNDS`] times. So a measurement of the new ground at the old posting finds the
//! old heights: 0.9 m RMS added to 20 m ground left 0.007 m in the means.
//!
//! # Assumptions
//! The structure function goes on below the posting with the same exponent: on lunar highlands it does to about 1 m
//! (Rosenburg et al. 2011 reach 17 m). A measured model that is smoother than its posting says makes the new ground too
//! smooth. Towards the border new ground fades within two measured postings; craters that would be cut by that are left
//! out.

use glam::DVec2;
use rand::Rng;
use rayon::prelude::*;

use super::craters::Field;
use super::noise::{self, Noise};
use super::{Crater, Error, Parameters, Projection, Raster, georeference};
use crate::geometry::{Body, Geodetic};
use crate::grid::{Cell, Grid2};
use crate::raster::{Dem, GeoTiff, GeoTiffBand, Georeference};

/// Times that means are taken off: what alternates from cell to cell loses a quarter each time.
const ROUNDS: usize = 10;

/// Lags of the structure function, in measured postings.
const LAGS: [usize; 4] = [1, 2, 4, 8];

/// Ratio of neighbouring wavelengths: not 2, so that lattices never coincide.
const LACUNARITY: f64 = 1.87;

/// Longest wavelength in measured postings, shortest in new ones.
const LONGEST: f64 = 2.0;
const SHORTEST: f64 = 4.0;

/// RMS of gradient noise of amplitude 1.
const NOISE_RMS: f64 = 0.25;

/// Largest boulder.
const LARGEST_BOULDER_M: f64 = 10.0;

/// What to make.
#[derive(Debug, Clone, PartialEq)]
pub struct Detail {
    pub posting_m: f64,
    /// Side of the square.
    pub extent_m: f64,
    pub centre: Geodetic,
    pub seed: u64,
    /// Craters per area, in units of the equilibrium density.
    pub craters: f64,
    /// Boulders of more than 1 m.
    pub boulders_per_km2: f64,
}

/// How measured heights differ over a distance: `rms_1m · L^hurst`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Structure {
    pub hurst: f64,
    pub rms_1m: f64,
}

/// New ground, and what of it is made up.
#[derive(Debug, Clone, PartialEq)]
pub struct Continued {
    pub columns: usize,
    pub rows: usize,
    /// Metres above the spheroid, row by row from the top left.
    pub heights_m: Vec<f32>,
    /// The measured model alone on the same pixels.
    pub measured_m: Vec<f32>,
    pub craters: Vec<Crater>,
    pub crs: String,
    pub geotransform: [f64; 6],
    pub structure: Structure,
}

impl Structure {
    /// Fitted to heights row by row, `posting_m` apart; rows and columns without heights are passed over.
    pub fn of(heights_m: &[f64], columns: usize, posting_m: f64) -> Self {
        let points: Vec<DVec2> = LAGS
            .iter()
            .filter(|&&lag| 2 * lag < columns)
            .map(|&lag| DVec2::new((lag as f64 * posting_m).ln(), rms_difference_m(heights_m, columns, lag).ln()))
            .filter(|point| point.is_finite())
            .collect();
        let mean = points.iter().copied().sum::<DVec2>() / points.len() as f64;
        let (xx, xy) = points.iter().fold((0.0, 0.0), |(xx, xy), p| {
            let d = *p - mean;
            (xx + d.x * d.x, xy + d.x * d.y)
        });
        let hurst = if xx > 0.0 { (xy / xx).clamp(0.1, 1.0) } else { 0.95 };
        let rms_1m = if points.is_empty() { 0.0 } else { (mean.y - hurst * mean.x).exp() };
        Self { hurst, rms_1m }
    }

    /// Amplitude of octaves, over `λ^H`, that together differ like this.
    fn amplitude(&self) -> f64 {
        // Squared difference of an octave of amplitude 1 over a distance of `x` wavelengths: as its slope says, up to twice
        // its variance.
        let most = 2.0 * NOISE_RMS * NOISE_RMS;
        let squared = |x: f64| most * (1.0 - (-(noise::RMS_SLOPE * x).powi(2) / most).exp());
        let octave = |k: i32| {
            let wavelength = LACUNARITY.powi(k);
            wavelength.powf(2.0 * self.hurst) * squared(1.0 / wavelength)
        };
        self.rms_1m / (-40..=40).map(octave).sum::<f64>().sqrt()
    }
}

/// RMS difference along rows and columns, the mean slope left out: it is no roughness.
fn rms_difference_m(heights_m: &[f64], columns: usize, lag: usize) -> f64 {
    let rows = heights_m.len() / columns;
    let mean = heights_m.iter().filter(|h| h.is_finite()).sum::<f64>() / heights_m.len() as f64;
    let at = |column: usize, row: usize| heights_m[row * columns + column] - mean;
    let (mut sum, mut sums, mut count) = (DVec2::ZERO, 0.0, 0.0);
    for row in 0..rows.saturating_sub(lag) {
        for column in 0..columns.saturating_sub(lag) {
            let d = DVec2::new(at(column + lag, row), at(column, row + lag)) - at(column, row);
            if d.is_finite() {
                (sum, sums, count) = (sum + d, sums + d.length_squared() / 2.0, count + 1.0);
            }
        }
    }
    let tilt = (sum / count).length_squared() / 2.0;
    (sums / count - tilt).max(0.0).sqrt()
}

/// Continues a measured model about a place.
pub fn continue_below(body: &Body, detail: &Detail, measured: &Dem) -> Result<Continued, Error> {
    let old_m = measured.georeference.posting_m();
    if detail.posting_m * SHORTEST > old_m * LONGEST {
        let allowed = "at most half of the posting that it continues";
        return Err(Error::Range { key: "posting_m", got: detail.posting_m, allowed });
    }
    let side = (detail.extent_m / detail.posting_m).round().max(2.0) as usize + 1;
    let parameters = Parameters {
        centre: detail.centre,
        projection: Projection::Gnomonic,
        largest_m: LONGEST * old_m,
        smallest_m: SHORTEST * detail.posting_m,
        density: detail.craters,
        relief_m: 0.0,
        roughness: 0.0,
        ..Parameters::highland(side, side, detail.posting_m, detail.seed)
    };
    let (crs, geotransform) = georeference(body, &parameters)?;
    let raster = Raster::of(&parameters);
    let measured_m = on_raster(body, &raster, &crs, geotransform, measured)?;
    let structure = about(body, detail, old_m, measured)?;

    let mut heights_m = measured_m.clone();
    let octaves = octaves(detail, &structure, old_m);
    super::add(&mut heights_m, &raster, |at_m| octaves.iter().map(|octave| octave(at_m)).sum());
    let around = Raster { posting_m: old_m, ..raster };
    let mut field = if detail.craters > 0.0 && parameters.largest_m > parameters.smallest_m {
        Field::draw_within(&parameters, &Field::empty(around))
    } else {
        Field::empty(raster)
    };
    field.stamp(&mut heights_m, &|_, _| ());
    boulders(detail, &raster, &mut heights_m);
    let cell = (old_m / detail.posting_m).round() as usize;
    (0..ROUNDS).for_each(|_| take_means_off(&mut heights_m, &measured_m, side, cell));
    let craters = field.listed(&crs, geotransform)?;
    Ok(Continued { columns: side, rows: side, heights_m, measured_m, craters, crs, geotransform, structure })
}

impl Continued {
    pub fn write(&self, path: &std::path::Path) -> Result<(), Error> {
        let bands = vec![GeoTiffBand { name: "height", unit: "m", values: &self.heights_m }];
        let Self { columns, rows, geotransform, .. } = *self;
        Ok(GeoTiff { columns, rows, bands, crs: &self.crs, geotransform }.write(path)?)
    }
}

/// The measured heights at the pixels of a new raster.
fn on_raster(
    body: &Body,
    raster: &Raster,
    crs: &str,
    geotransform: [f64; 6],
    measured: &Dem,
) -> Result<Vec<f32>, Error> {
    let new = Georeference::new(crs, geotransform, raster.columns)?;
    new.projector()?;
    measured.georeference.projector()?;
    let line = |row: usize| {
        let pixels: Vec<DVec2> = (0..raster.columns).map(|column| DVec2::new(column as f64, row as f64)).collect();
        let places = new.projector().expect("made once above").positions(body, &pixels, &vec![0.0; pixels.len()]);
        let found = measured.georeference.projector().expect("made once above").pixels(&places);
        found.into_iter().map(|pixel| measured.height_m(pixel) as f32).collect::<Vec<_>>()
    };
    Ok((0..raster.rows).into_par_iter().with_min_len(64).flat_map_iter(line).collect())
}

/// The structure of the measured heights about the place, over the new ground and as far around it.
fn about(body: &Body, detail: &Detail, old_m: f64, measured: &Dem) -> Result<Structure, Error> {
    let side = ((2.0 * detail.extent_m / old_m) as usize).clamp(33, 513);
    let parameters = Parameters { centre: detail.centre, ..Parameters::highland(side, side, old_m, detail.seed) };
    let (crs, geotransform) = georeference(body, &parameters)?;
    let heights_m = on_raster(body, &Raster::of(&parameters), &crs, geotransform, measured)?;
    Ok(Structure::of(&heights_m.into_iter().map(f64::from).collect::<Vec<_>>(), side, old_m))
}

type Octave = Box<dyn Fn(DVec2) -> f64 + Send + Sync>;

fn octaves(detail: &Detail, structure: &Structure, old_m: f64) -> Vec<Octave> {
    let amplitude = structure.amplitude();
    let wavelengths_m = (0..).map(|k| (k, LONGEST * old_m / LACUNARITY.powi(k)));
    let held = wavelengths_m.take_while(|&(_, wavelength_m)| wavelength_m >= SHORTEST * detail.posting_m);
    let octave = |(k, wavelength_m): (i32, f64)| -> Octave {
        let noise = Noise::new(detail.seed, 300 + k as u64);
        let turn = DVec2::from_angle(std::f64::consts::TAU * noise.offset().x);
        let amplitude_m = amplitude * wavelength_m.powf(structure.hurst);
        Box::new(move |at_m| amplitude_m * noise.value(turn.rotate(at_m / wavelength_m)))
    };
    held.map(octave).collect()
}

/// Half buried spheres; each raises the ground that it lies on.
fn boulders(detail: &Detail, raster: &Raster, heights_m: &mut [f32]) {
    let smallest_m = 2.0 * detail.posting_m;
    if detail.boulders_per_km2 <= 0.0 || smallest_m >= LARGEST_BOULDER_M {
        return;
    }
    let half_m = raster.half_m();
    let share = 1.0 - (LARGEST_BOULDER_M / smallest_m).powi(-3);
    let area_km2 = 4e-6 * half_m.x * half_m.y;
    let count = (detail.boulders_per_km2 * area_km2 * smallest_m.powi(-3) * share).round() as u64;
    for index in 0..count {
        let mut random = noise::stream(detail.seed, (1 << 40) + index);
        let at_m = (2.0 * DVec2::new(random.random(), random.random()) - 1.0) * half_m;
        let radius_m = 0.5 * smallest_m * (1.0 - random.random::<f64>() * share).powf(-1.0 / 3.0);
        let (at, reach) = (raster.pixel(at_m), radius_m / raster.posting_m);
        let last = DVec2::new((raster.columns - 1) as f64, (raster.rows - 1) as f64);
        let (low, high) = ((at - reach).ceil().max(DVec2::ZERO), (at + reach).floor().min(last));
        for row in low.y as usize..=high.y.max(0.0) as usize {
            for column in low.x as usize..=high.x.max(0.0) as usize {
                let apart_m = (DVec2::new(column as f64, row as f64) - at).length() * raster.posting_m;
                let above_m = (radius_m * radius_m - apart_m * apart_m).max(0.0).sqrt();
                heights_m[row * raster.columns + column] += above_m as f32;
            }
        }
    }
}

/// Subtracts from `heights − measured` its means over cells of `cell` pixels, bilinear between the cells' middles.
fn take_means_off(heights_m: &mut [f32], measured_m: &[f32], columns: usize, cell: usize) {
    let across = columns.div_ceil(cell);
    let rows = heights_m.len() / columns;
    let down = rows.div_ceil(cell);
    let mean = |index: usize| {
        let (left, top) = (index % across * cell, index / across * cell);
        let pixels = (top..(top + cell).min(rows))
            .flat_map(|row| (left..(left + cell).min(columns)).map(move |column| row * columns + column));
        let (count, sum) = pixels
            .map(|pixel| f64::from(heights_m[pixel] - measured_m[pixel]))
            .fold((0.0, 0.0), |(n, s), d| if d.is_nan() { (n, s) } else { (n + 1.0, s + d) });
        if count > 0.0 { sum / count } else { 0.0 }
    };
    let means: Vec<f64> = (0..across * down).map(mean).collect();
    let means = Grid2::new(&means, [across, down]);
    heights_m.par_chunks_mut(columns).enumerate().for_each(|(row, line)| {
        for (column, height_m) in line.iter_mut().enumerate() {
            let among_cells = (DVec2::new(column as f64, row as f64) + 0.5) / cell as f64 - 0.5;
            *height_m -= means.bilinear(Cell::clamped(means.size(), among_cells)) as f32;
        }
    });
}
