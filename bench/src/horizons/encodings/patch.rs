//! A patch of a scene with the horizons of all its nodes, uncompressed and decoded.

use glam::DVec2;
use rayon::prelude::*;

use super::super::tiles::Scratch;
use super::{AZIMUTHS, SUNS};
use crate::scenes::Scene;
use crate::{Error, Value};
use perilune_engine::horizon::axis::Major;
use perilune_engine::horizon::bound::{self, Bounds};
use perilune_engine::horizon::decode::Decoder;
use perilune_engine::horizon::elevation_plane::ElevationPlane;
use perilune_engine::horizon::fit::Accumulator;
use perilune_engine::horizon::header::Header;
use perilune_engine::horizon::store;
use perilune_engine::horizon::sweep::Sweep;
use perilune_engine::horizon::{Encoding, HorizonMap, Request, Settings};
use perilune_engine::statistics::Errors;

/// Elevation of the Suns of the images whose similarity is measured, the first of them and every how many one is: between
/// the azimuths that the sampled encodings hold, multiples of 22.5°, 30° and 45°.
const SIMILARITY: (f64, usize, usize) = (6.0, 5, 15);

/// Elevations of all nodes towards the Suns, `[Sun][node]`.
pub type Suns = Vec<Vec<f32>>;

/// Uncompressed horizons of all nodes of a patch.
#[derive(Debug)]
pub struct Patch {
    pub columns: usize,
    pub rows: usize,
    /// In the order of their azimuths.
    pub planes: Vec<ElevationPlane>,
}

impl Patch {
    pub fn of(scene: &Scene, settings: &Settings) -> Self {
        let level = &scene.face.levels[0];
        let [columns, rows] = level.seen_size();
        let mut planes = Vec::new();
        for major in [Major::Row, Major::Column] {
            let sweep = Sweep::new(&scene.face, 0, major, settings);
            let stride = sweep.receivers.stride;
            let along = (0..settings.azimuths).filter(|azimuth| Major::of(settings.direction(*azimuth)) == major);
            let plane = |azimuth: usize| {
                let swept_rad = sweep.elevations_rad(settings.direction(azimuth));
                let at = |node: usize| match major {
                    Major::Row => node / columns * stride + node % columns,
                    Major::Column => node % columns * stride + node / columns,
                };
                let elevations_rad = (0..columns * rows).map(|node| swept_rad[at(node)]).collect();
                ElevationPlane { azimuth, stride: columns, elevations_rad }
            };
            planes.extend(along.collect::<Vec<_>>().into_par_iter().map(plane).collect::<Vec<_>>());
        }
        planes.sort_by_key(|plane| plane.azimuth);
        Self { columns, rows, planes }
    }

    pub fn nodes(&self) -> usize {
        self.columns * self.rows
    }

    /// At the azimuths of the Suns.
    pub fn suns(&self) -> Suns {
        self.planes.iter().step_by(AZIMUTHS / SUNS).map(|plane| plane.elevations_rad.clone()).collect()
    }

    /// Sums of what matters of the horizons.
    pub fn fitted(&self, encoding: Encoding, relevant: impl Fn(f32) -> f32 + Sync) -> Accumulator {
        let mut sums = Accumulator::new(encoding, self.columns, self.rows, self.planes.len());
        for planes in self.planes.chunks(16) {
            let clamped = |plane: &ElevationPlane| ElevationPlane {
                elevations_rad: plane.elevations_rad.iter().map(|elevation_rad| relevant(*elevation_rad)).collect(),
                ..*plane
            };
            sums.add(&planes.par_iter().map(clamped).collect::<Vec<_>>(), Major::Row);
        }
        sums
    }

    pub(super) fn horizon_row(
        &self,
        scene: &Scene,
        encoding: Encoding,
        sizes: [f64; 2],
        truth: &Suns,
        tried: &Suns,
    ) -> Vec<Value> {
        let pairs = truth.iter().flatten().zip(tried.iter().flatten());
        let errors = Errors::of(pairs.map(|(truth, tried)| f64::from(tried - truth)));
        let mut row = vec![scene.name.as_str().into(), encoding.name().into()];
        row.extend(sizes.map(|bytes| Value::from(bytes / self.nodes() as f64)));
        row.extend([errors.rms, errors.p95, errors.p99, errors.max].map(|rad| Value::from(rad.to_degrees())));
        row.push(self.similarity(truth, tried).into());
        row
    }

    /// Mean structural similarity of hard shadows.
    fn similarity(&self, truth: &Suns, tried: &Suns) -> f64 {
        let (sun_deg, first, every) = SIMILARITY;
        let sun_rad = sun_deg.to_radians() as f32;
        let image = |suns: &Suns, sun: usize| -> Vec<bool> { suns[sun].iter().map(|h| *h < sun_rad).collect() };
        let suns: Vec<usize> = (first..SUNS).step_by(every).collect();
        let all = suns.par_iter().map(|sun| similarity(self.columns, &image(truth, *sun), &image(tried, *sun)));
        all.sum::<f64>() / suns.len() as f64
    }
}

/// What a map decodes to at its nodes, towards the Suns.
pub fn decoded(map: &HorizonMap, settings: &Settings) -> Suns {
    let directions: Vec<DVec2> = (0..AZIMUTHS).step_by(AZIMUTHS / SUNS).map(|i| settings.direction(i)).collect();
    let decoder = Decoder::new(map, &directions);
    let rows: Vec<Vec<f32>> = (0..map.rows).into_par_iter().map(|row| decoder.row(row)).collect();
    let towards = |sun: usize| rows.iter().flat_map(|row| &row[sun * map.columns..][..map.columns]).copied().collect();
    (0..SUNS).into_par_iter().map(towards).collect()
}

/// Bounds of about the entropy that a tile's own have: the largest error of each node towards the Suns.
pub(super) fn bounds(map: &HorizonMap, truth: &Suns, tried: &Suns) -> Bounds {
    let largest_rad = |node: usize| {
        let errors_rad = truth.iter().zip(tried).map(|(truth, tried)| (tried[node] - truth[node]).abs());
        f64::from(errors_rad.fold(0.0, f32::max))
    };
    let codes = (0..map.columns * map.rows).into_par_iter().map(|node| bound::encode(largest_rad(node))).collect();
    Bounds { columns: map.columns, codes }
}

/// Size of the tile's file.
pub(super) fn stored_bytes(scene: &Scene, settings: Settings, map: &HorizonMap) -> Result<f64, Error> {
    let folder = Scratch::new()?;
    let request = Request { body: &scene.body, face: &scene.face, level: 0, settings, encoding: map.encoding };
    store::write(&folder.path.join("tile.tif"), &Header::new(&request, map), map)?;
    Ok(folder.bytes() as f64)
}

/// Structural similarity of two binary images, averaged over windows.
fn similarity(columns: usize, a: &[bool], b: &[bool]) -> f64 {
    const WINDOW: usize = 8;
    const APART: usize = 4;
    /// (0.01)² and (0.03)² for values from 0 to 1.
    const C: [f64; 2] = [1e-4, 9e-4];
    let rows = a.len() / columns;
    let (mut sum, mut windows) = (0.0, 0.0);
    for top in (0..=rows.saturating_sub(WINDOW)).step_by(APART) {
        for left in (0..=columns.saturating_sub(WINDOW)).step_by(APART) {
            let nodes =
                (top..top + WINDOW).flat_map(|row| (left..left + WINDOW).map(move |column| row * columns + column));
            let mut counts = [0.0; 3];
            for node in nodes {
                let lit = [a[node], b[node], a[node] && b[node]];
                counts.iter_mut().zip(lit).for_each(|(count, lit)| *count += f64::from(u8::from(lit)));
            }
            let [a, b, both] = counts.map(|count| count / (WINDOW * WINDOW) as f64);
            let (variances, covariance) = (a - a * a + b - b * b, both - a * b);
            let means = (2.0 * a * b + C[0]) / (a * a + b * b + C[0]);
            sum += means * (2.0 * covariance + C[1]) / (variances + C[1]);
            windows += 1.0;
        }
    }
    sum / windows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_images_are_similar_by_one_and_opposite_halves_by_less_than_nothing() {
        let left: Vec<bool> = (0..64).map(|node| node % 8 < 4).collect();
        let right: Vec<bool> = left.iter().map(|lit| !lit).collect();
        assert!((similarity(8, &left, &left) - 1.0).abs() < 1e-12);
        // Equal means, and a covariance of −1/4 beside variances of 1/4 each.
        assert!((similarity(8, &left, &right) + 0.4991 / 0.5009).abs() < 1e-9);
    }
}
