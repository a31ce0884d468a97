//! Where craters are, how old, and how they are laid over each other.

use std::ops::Range;

use glam::DVec2;
use rand::Rng;
use rayon::prelude::*;

use super::profile::{self, MOST_DEGRADED, Profiles, REACH};
use super::{DENSITY_PER_KM2, Parameters, Raster, noise};
use crate::raster::{self, Georeference};
use crate::terrain::build::FEATHER_POSTINGS;

/// Diameter below which craters are in equilibrium, so that all states of decay are equally frequent.
/// Fassett & Thomson (2014): craters under 200–300 m do not survive 3 Ga.
const EQUILIBRIUM_M: f64 = 300.0;

/// Radii from its centre beyond which a crater raises the ground by less than a hundredth of its rim's height.
const EJECTA_RADII: f64 = 3.0;

/// One crater.
#[derive(Debug, Clone, PartialEq)]
pub struct Crater {
    /// Place in the list, from 0.
    pub id: usize,
    pub longitude_deg: f64,
    pub latitude_deg: f64,
    /// Map coordinates of its centre.
    pub x_m: f64,
    pub y_m: f64,
    pub diameter_m: f64,
    /// Rim crest to floor of its own profile.
    pub depth_m: f64,
    /// `κt/R²`: 0 fresh, 0.6 all but gone.
    pub degradation: f64,
    /// True where its centre lies inside a younger crater of at least its size.
    pub buried: bool,
}

impl Crater {
    pub(super) fn csv_line(&self) -> String {
        let Self { id, longitude_deg, latitude_deg, x_m, y_m, diameter_m, depth_m, degradation, buried } = self;
        format!(
            "{id},{longitude_deg:.9},{latitude_deg:.9},{x_m:.3},{y_m:.3},{diameter_m:.3},{depth_m:.3},\
             {degradation:.5},{}\n",
            u8::from(*buried)
        )
    }
}

/// A crater in metres east and north of the raster's middle.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Impact {
    at_m: DVec2,
    diameter_m: f64,
    degradation: f64,
    /// Time since it formed, over that of the oldest of its size.
    age: f64,
    /// The ground that it met, once it is stamped. A finer terrain sees the same.
    ground: Option<Plane>,
}

/// All craters of a terrain, oldest first.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    impacts: Vec<Impact>,
    raster: Raster,
    /// Fields of coarser terrains below: each has its own random numbers.
    depth: u64,
}

impl Field {
    /// Ground without craters.
    pub fn empty(raster: Raster) -> Self {
        Self { impacts: Vec::new(), raster, depth: 0 }
    }

    /// Draws craters over the raster and as far around it as they reach.
    pub fn draw(parameters: &Parameters) -> Self {
        let reach_m = parameters.largest_m / 2.0 * REACH;
        let raster = Raster::of(parameters);
        Self { impacts: drawn(parameters, raster.half_m() + reach_m, 1), raster, depth: 1 }.sorted()
    }

    /// The craters of a coarser terrain that reach this one, and smaller ones that keep off its border: those
    /// that the coarser level would cut through are left out.
    pub fn draw_within(parameters: &Parameters, coarse: &Self) -> Self {
        let raster = Raster::of(parameters);
        let half_m = raster.half_m();
        let feather_m = FEATHER_POSTINGS * coarse.raster.posting_m;
        let mut impacts = drawn(parameters, half_m, coarse.depth + 1);
        impacts.retain(|impact| {
            let margin_m = feather_m + EJECTA_RADII * impact.diameter_m / 2.0;
            impact.at_m.abs().cmple(half_m - margin_m).all()
        });
        impacts.extend(&coarse.impacts);
        Self { impacts, raster, depth: coarse.depth + 1 }.sorted()
    }

    /// The craters that reach the raster, oldest first.
    fn sorted(mut self) -> Self {
        let half_m = self.raster.half_m();
        let reaches = |impact: &Impact| impact.at_m.abs().cmple(half_m + impact.diameter_m / 2.0 * REACH).all();
        self.impacts.retain(reaches);
        self.impacts.sort_by(|a, b| b.age.total_cmp(&a.age).then(b.diameter_m.total_cmp(&a.diameter_m)));
        self
    }

    /// Lays the craters into the heights, oldest first.
    pub fn stamp(&mut self, heights_m: &mut [f32], progress: &(dyn Fn(usize, usize) + Sync)) {
        let profiles = Profiles::new();
        let all = self.impacts.len();
        for (done, impact) in self.impacts.iter_mut().enumerate() {
            if done % 256 == 0 {
                progress(done, all);
            }
            let ground = impact.ground.unwrap_or_else(|| Plane::around(&self.raster, heights_m, impact));
            impact.ground = Some(ground);
            stamp_one(&self.raster, heights_m, impact, &profiles.at(impact.degradation), ground);
        }
        progress(all, all);
    }

    /// The craters whose centre lies on the raster, largest first, with their places on the body.
    pub fn listed(&self, crs: &str, geotransform: [f64; 6]) -> Result<Vec<Crater>, raster::Error> {
        let inside = |impact: &Impact| impact.at_m.abs().cmple(self.raster.half_m()).all();
        let profiles = Profiles::new();
        let buried = self.buried();
        let mut found: Vec<(&Impact, bool)> =
            self.impacts.iter().zip(buried).filter(|(impact, _)| inside(impact)).collect();
        found.sort_by(|(a, _), (b, _)| b.diameter_m.total_cmp(&a.diameter_m).then(a.at_m.x.total_cmp(&b.at_m.x)));
        let georeference = Georeference::new(crs, geotransform, self.raster.columns)?;
        let pixels: Vec<DVec2> = found.iter().map(|(impact, _)| self.raster.pixel(impact.at_m)).collect();
        let middle_m = DVec2::new(geotransform[0], geotransform[3]) + self.raster.half_m() * DVec2::new(1.0, -1.0);
        let places = georeference.projector()?.geodetics(&pixels);
        let crater = |(id, ((impact, buried), place)): (usize, ((&Impact, bool), crate::geometry::Geodetic))| Crater {
            id,
            longitude_deg: place.longitude_east_rad.to_degrees(),
            latitude_deg: place.latitude_rad.to_degrees(),
            x_m: middle_m.x + impact.at_m.x,
            y_m: middle_m.y + impact.at_m.y,
            diameter_m: impact.diameter_m,
            depth_m: impact.diameter_m * profile::depth(&profiles.at(impact.degradation)),
            degradation: impact.degradation,
            buried,
        };
        Ok(found.into_iter().zip(places).enumerate().map(crater).collect())
    }

    /// For each crater, whether a younger one of at least its size holds its centre.
    fn buried(&self) -> Vec<bool> {
        let mut by_size: Vec<usize> = (0..self.impacts.len()).collect();
        by_size.sort_by(|&a, &b| self.impacts[b].diameter_m.total_cmp(&self.impacts[a].diameter_m));
        let mut buried = vec![false; self.impacts.len()];
        let Raster { columns, rows, posting_m } = self.raster;
        let mut youngest = vec![0_u32; columns * rows];
        // From the largest down: each pixel knows the youngest of the larger craters that hold it.
        for index in by_size {
            let Impact { at_m, diameter_m, .. } = self.impacts[index];
            let (at, radius) = (self.raster.pixel(at_m), diameter_m / 2.0 / posting_m);
            let place = at.round();
            let on_raster = place.cmpge(DVec2::ZERO).all() && place.x < columns as f64 && place.y < rows as f64;
            buried[index] = on_raster && youngest[place.y as usize * columns + place.x as usize] > index as u32;
            for row in pixels_within(at.y, radius, rows) {
                let half = (radius * radius - (row as f64 - at.y).powi(2)).max(0.0).sqrt();
                for column in pixels_within(at.x, half, columns) {
                    let pixel = &mut youngest[row * columns + column];
                    *pixel = (*pixel).max(index as u32);
                }
            }
        }
        buried
    }
}

/// Craters of a terrain's own sizes within `half_m` of its middle, in the order of their random numbers.
fn drawn(parameters: &Parameters, half_m: DVec2, depth: u64) -> Vec<Impact> {
    let Parameters { largest_m, smallest_m, exponent, .. } = *parameters;
    let area_km2 = 4.0 * half_m.x * half_m.y * 1e-6;
    let over_smallest = DENSITY_PER_KM2 * (smallest_m / 1000.0).powf(-exponent);
    let share = 1.0 - (largest_m / smallest_m).powf(-exponent);
    let count = (parameters.density * area_km2 * over_smallest * share).round() as u64;
    let draw = |index: u64| {
        let mut random = noise::stream(parameters.seed, (depth << 32) + index);
        let at_m = (2.0 * DVec2::new(random.random(), random.random()) - 1.0) * half_m;
        let diameter_m = smallest_m * (1.0 - random.random::<f64>() * share).powf(-1.0 / exponent);
        let age: f64 = random.random();
        Impact { at_m, diameter_m, degradation: age * most_degraded(diameter_m), age, ground: None }
    };
    (0..count).into_par_iter().map(draw).collect()
}

fn stamp_one(raster: &Raster, heights_m: &mut [f32], impact: &Impact, profile: &[f64], ground: Plane) {
    let radius_m = impact.diameter_m / 2.0;
    let (at, reach) = (raster.pixel(impact.at_m), REACH * radius_m / raster.posting_m);
    // What a fresh crater erases has a sharp edge; it fades as the crater does.
    let erasing = 0.9 * profile::depth(profile) / profile::DEPTH_TO_DIAMETER;
    let (columns, rows) = (pixels_within(at.x, reach, raster.columns), pixels_within(at.y, reach, raster.rows));
    let stamp_row = |(row, line): (usize, &mut [f32])| {
        for column in columns.clone() {
            let offset_m = raster.at_m(column, row) - impact.at_m;
            let x = offset_m.length() / radius_m;
            if x >= REACH {
                continue;
            }
            let old_m = f64::from(line[column]);
            // All inside the rim, nothing from 1.4 radii on.
            let t = ((1.4 - x) / 0.5).clamp(0.0, 1.0);
            let erased = erasing * t * t * (3.0 - 2.0 * t);
            let base_m = old_m + erased * (ground.height_m(offset_m) - old_m);
            line[column] = (base_m + impact.diameter_m * profile::height(profile, x)) as f32;
        }
    };
    let lines = &mut heights_m[rows.start * raster.columns..rows.end * raster.columns];
    if columns.len() * rows.len() > 1 << 16 {
        lines.par_chunks_mut(raster.columns).enumerate().map(|(k, line)| (rows.start + k, line)).for_each(stamp_row);
    } else {
        lines.chunks_mut(raster.columns).enumerate().map(|(k, line)| (rows.start + k, line)).for_each(stamp_row);
    }
}

/// The pixels of a line of `count` no further than `reach` from a place on it.
fn pixels_within(centre: f64, reach: f64, count: usize) -> Range<usize> {
    let low = (centre - reach).ceil().clamp(0.0, count as f64) as usize;
    let high = ((centre + reach).floor() + 1.0).clamp(0.0, count as f64) as usize;
    low..high.max(low)
}

/// The most that a crater of this size decays in the age of the surface. Small ones decay until they are
/// gone. Larger ones decay less: by constant diffusivity as `D⁻²`, but that is of the maria; on highlands
/// large craters are older and more subdued. `D^−¾` is chosen between the two by eye, not measured.
fn most_degraded(diameter_m: f64) -> f64 {
    MOST_DEGRADED * (EQUILIBRIUM_M / diameter_m).min(1.0).powf(0.75)
}

/// The ground that an impact meets, as a plane about its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Plane {
    mean_m: f64,
    slope: DVec2,
}

impl Plane {
    /// Least squares through 24 points of the ring at the rim that lie on the raster.
    fn around(raster: &Raster, heights_m: &[f32], impact: &Impact) -> Self {
        let far = DVec2::new((raster.columns - 1) as f64, (raster.rows - 1) as f64);
        let radius_m = impact.diameter_m / 2.0;
        let ring = (0..24).map(|k| radius_m * DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / 24.0));
        let points: Vec<(DVec2, f64)> = ring
            .map(|offset_m| {
                // Beyond the raster the nearest pixel stands in, at its true place.
                let pixel = raster.pixel(impact.at_m + offset_m).clamp(DVec2::ZERO, far).round();
                let height_m = heights_m[pixel.y as usize * raster.columns + pixel.x as usize];
                (offset_m, f64::from(height_m))
            })
            .collect();
        let mean_m = points.iter().map(|(_, height_m)| height_m).sum::<f64>() / points.len() as f64;
        // On a ring Σ offset = 0 and Σ x² = Σ y² = n r²/2.
        let moment: DVec2 = points.iter().map(|(offset_m, height_m)| *offset_m * (height_m - mean_m)).sum();
        Self { mean_m, slope: moment * (2.0 / (points.len() as f64 * radius_m * radius_m)) }
    }

    fn height_m(&self, offset_m: DVec2) -> f64 {
        self.mean_m + self.slope.dot(offset_m)
    }
}
