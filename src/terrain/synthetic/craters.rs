//! Where craters are, how old, and how they are laid over each other.

use glam::DVec2;
use rand::Rng;
use rayon::prelude::*;

use super::profile::{self, MOST_DEGRADED, Profiles, REACH};
use super::{DENSITY_PER_KM2, Parameters, noise};
use crate::raster::{self, Georeference};

/// Diameter below which craters are in equilibrium, so that all states of decay are equally frequent.
/// Fassett & Thomson (2014): craters under 200–300 m do not survive 3 Ga.
const EQUILIBRIUM_M: f64 = 300.0;

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

/// A crater in pixels of the raster: centres at integers, rows down.
#[derive(Debug, Clone, Copy)]
struct Impact {
    at: DVec2,
    diameter_m: f64,
    degradation: f64,
    /// Time since it formed, over that of the oldest of its size.
    age: f64,
}

/// All craters of a terrain, oldest first.
pub(super) struct Field {
    impacts: Vec<Impact>,
    profiles: Profiles,
    columns: usize,
    rows: usize,
    posting_m: f64,
}

impl Field {
    /// Draws craters over the raster and as far around it as they reach.
    pub fn draw(parameters: &Parameters) -> Self {
        let Parameters { columns, rows, posting_m, largest_m, smallest_m, exponent, .. } = *parameters;
        let reach = largest_m / 2.0 * REACH / posting_m;
        let area = DVec2::new(columns as f64, rows as f64) + 2.0 * reach;
        let area_km2 = area.x * area.y * (posting_m / 1000.0).powi(2);
        let cumulative = |diameter_m: f64| DENSITY_PER_KM2 * (diameter_m / 1000.0).powf(-exponent);
        let share = 1.0 - (largest_m / smallest_m).powf(-exponent);
        let count = (parameters.density * area_km2 * cumulative(smallest_m) * share).round() as u64;
        let draw = |index: u64| {
            let mut random = noise::stream(parameters.seed, (1 << 32) + index);
            let at = DVec2::new(random.random(), random.random()) * area - reach;
            let diameter_m = smallest_m * (1.0 - random.random::<f64>() * share).powf(-1.0 / exponent);
            let age: f64 = random.random();
            Impact { at, diameter_m, degradation: age * most_degraded(diameter_m), age }
        };
        let touches = |impact: &Impact| {
            let reach = impact.diameter_m / 2.0 * REACH / posting_m;
            impact.at.cmpge(DVec2::splat(-reach)).all()
                && impact.at.cmple(DVec2::new(columns as f64, rows as f64) + reach).all()
        };
        let mut impacts: Vec<Impact> = (0..count).into_par_iter().map(draw).filter(touches).collect();
        impacts.sort_by(|a, b| b.age.total_cmp(&a.age).then(b.diameter_m.total_cmp(&a.diameter_m)));
        Self { impacts, profiles: Profiles::new(), columns, rows, posting_m }
    }

    /// Lays the craters into the heights, oldest first.
    pub fn stamp(&self, heights_m: &mut [f32], progress: &(dyn Fn(usize, usize) + Sync)) {
        for (done, impact) in self.impacts.iter().enumerate() {
            if done % 256 == 0 {
                progress(done, self.impacts.len());
            }
            self.stamp_one(heights_m, impact);
        }
        progress(self.impacts.len(), self.impacts.len());
    }

    fn stamp_one(&self, heights_m: &mut [f32], impact: &Impact) {
        let radius = impact.diameter_m / 2.0 / self.posting_m;
        let profile = self.profiles.at(impact.degradation);
        let ground = Plane::around(self, heights_m, impact.at, radius);
        // What a fresh crater erases has a sharp edge; it fades as the crater does.
        let erasing = 0.9 * profile::depth(&profile) / profile::DEPTH_TO_DIAMETER;
        let range = |centre: f64, count: usize| {
            let low = (centre - REACH * radius).ceil().max(0.0) as usize;
            let high = (centre + REACH * radius).floor().min(count as f64 - 1.0);
            if high < low as f64 { low..low } else { low..high as usize + 1 }
        };
        let (columns, rows) = (range(impact.at.x, self.columns), range(impact.at.y, self.rows));
        let stamp_row = |(row, line): (usize, &mut [f32])| {
            for column in columns.clone() {
                let offset = DVec2::new(column as f64, row as f64) - impact.at;
                let x = offset.length() / radius;
                if x >= REACH {
                    continue;
                }
                let old_m = f64::from(line[column]);
                // All inside the rim, nothing from 1.4 radii on.
                let t = ((1.4 - x) / 0.5).clamp(0.0, 1.0);
                let erased = erasing * t * t * (3.0 - 2.0 * t);
                let base_m = old_m + erased * (ground.height_m(offset) - old_m);
                line[column] = (base_m + impact.diameter_m * profile::height(&profile, x)) as f32;
            }
        };
        let lines = &mut heights_m[rows.start * self.columns..rows.end * self.columns];
        if columns.len() * rows.len() > 1 << 16 {
            lines.par_chunks_mut(self.columns).enumerate().map(|(k, line)| (rows.start + k, line)).for_each(stamp_row);
        } else {
            lines.chunks_mut(self.columns).enumerate().map(|(k, line)| (rows.start + k, line)).for_each(stamp_row);
        }
    }

    /// The craters whose centre lies on the raster, largest first, with their places on the body.
    pub fn listed(&self, crs: &str, geotransform: [f64; 6]) -> Result<Vec<Crater>, raster::Error> {
        let far = DVec2::new(self.columns as f64, self.rows as f64) - 0.5;
        let inside = |impact: &Impact| impact.at.cmpge(DVec2::splat(-0.5)).all() && impact.at.cmple(far).all();
        let buried = self.buried();
        let mut found: Vec<(&Impact, bool)> =
            self.impacts.iter().zip(buried).filter(|(impact, _)| inside(impact)).collect();
        found.sort_by(|(a, _), (b, _)| b.diameter_m.total_cmp(&a.diameter_m).then(a.at.x.total_cmp(&b.at.x)));
        let georeference = Georeference::new(crs, geotransform, self.columns)?;
        let pixels: Vec<DVec2> = found.iter().map(|(impact, _)| impact.at).collect();
        let places = georeference.projector()?.geodetics(&pixels);
        let crater = |(id, ((impact, buried), place)): (usize, ((&Impact, bool), crate::geometry::Geodetic))| Crater {
            id,
            longitude_deg: place.longitude_east_rad.to_degrees(),
            latitude_deg: place.latitude_rad.to_degrees(),
            x_m: geotransform[0] + (impact.at.x + 0.5) * geotransform[1],
            y_m: geotransform[3] + (impact.at.y + 0.5) * geotransform[5],
            diameter_m: impact.diameter_m,
            depth_m: impact.diameter_m * profile::depth(&self.profiles.at(impact.degradation)),
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
        let mut youngest = vec![0_u32; self.columns * self.rows];
        // From the largest down: each pixel knows the youngest of the larger craters that hold it.
        for index in by_size {
            let Impact { at, diameter_m, .. } = self.impacts[index];
            let radius = diameter_m / 2.0 / self.posting_m;
            let place = at.round();
            let on_raster =
                place.cmpge(DVec2::ZERO).all() && place.x < self.columns as f64 && place.y < self.rows as f64;
            buried[index] = on_raster && youngest[place.y as usize * self.columns + place.x as usize] > index as u32;
            let rows = (at.y - radius).ceil().max(0.0) as usize
                ..((at.y + radius).floor() + 1.0).clamp(0.0, self.rows as f64) as usize;
            for row in rows {
                let half = (radius * radius - (row as f64 - at.y).powi(2)).max(0.0).sqrt();
                let low = (at.x - half).ceil().max(0.0) as usize;
                let high = ((at.x + half).floor() + 1.0).clamp(0.0, self.columns as f64) as usize;
                for column in low..high.max(low) {
                    let pixel = &mut youngest[row * self.columns + column];
                    *pixel = (*pixel).max(index as u32);
                }
            }
        }
        buried
    }
}

/// The most that a crater of this size decays in the age of the surface. Small ones decay until they are
/// gone. Larger ones decay less: by constant diffusivity as `D⁻²`, but that is of the maria; on highlands
/// large craters are older and more subdued. `D^−¾` is chosen between the two by eye, not measured.
fn most_degraded(diameter_m: f64) -> f64 {
    MOST_DEGRADED * (EQUILIBRIUM_M / diameter_m).min(1.0).powf(0.75)
}

/// The ground that an impact meets, as a plane about its centre.
struct Plane {
    mean_m: f64,
    slope: DVec2,
}

impl Plane {
    /// Least squares through 24 points of the ring at the rim that lie on the raster.
    fn around(field: &Field, heights_m: &[f32], at: DVec2, radius: f64) -> Self {
        let far = DVec2::new((field.columns - 1) as f64, (field.rows - 1) as f64);
        let ring = (0..24).map(|k| radius * DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / 24.0));
        let points: Vec<(DVec2, f64)> = ring
            .map(|offset| {
                // Beyond the raster the nearest pixel stands in, at its true place.
                let pixel = (at + offset).clamp(DVec2::ZERO, far).round();
                let height_m = heights_m[pixel.y as usize * field.columns + pixel.x as usize];
                (offset, f64::from(height_m))
            })
            .collect();
        let mean_m = points.iter().map(|(_, height_m)| height_m).sum::<f64>() / points.len() as f64;
        // On a ring Σ offset = 0 and Σ x² = Σ y² = n r²/2.
        let moment: DVec2 = points.iter().map(|(offset, height_m)| *offset * (height_m - mean_m)).sum();
        Self { mean_m, slope: moment * (2.0 / (points.len() as f64 * radius * radius)) }
    }

    fn height_m(&self, offset: DVec2) -> f64 {
        self.mean_m + self.slope.dot(offset)
    }
}
