//! A band of elevations at every node of a level.

use super::axis::Major;
use super::band::ElevationBand;
use super::elevation_plane::ElevationPlane;
use crate::terrain::{Gnomonic, Level};

/// The limits of a band at all seen nodes of a level, laid out as the planes of one orientation.
#[derive(Debug)]
pub struct BandLimits {
    width: usize,
    limits_rad: Vec<[f32; 2]>,
}

impl BandLimits {
    pub fn of(band: &ElevationBand, map: &Gnomonic, level: &Level, major: Major) -> Self {
        let [columns, rows] = level.seen_size();
        let (width, height) = match major {
            Major::Row => (columns, rows),
            Major::Column => (rows, columns),
        };
        let at = |index: usize| {
            let (along, across) = (index % width, index / width);
            let (column, row) = match major {
                Major::Row => (along, across),
                Major::Column => (across, along),
            };
            let at_m = level.node_m(column + level.margin, row + level.margin);
            band.ends_rad(map, at_m).map(|end_rad| end_rad as f32)
        };
        Self { width, limits_rad: (0..width * height).map(at).collect() }
    }

    /// An elevation at a node, counted along the planes' rows.
    pub fn clamped(&self, node: usize, elevation_rad: f32) -> f32 {
        let [low_rad, high_rad] = self.limits_rad[node];
        elevation_rad.max(low_rad).min(high_rad)
    }

    /// Clamps a plane of the same orientation.
    pub fn clamp(&self, plane: &mut ElevationPlane) {
        let rows = plane.elevations_rad.chunks_mut(plane.stride);
        for (elevations_rad, limits_rad) in rows.zip(self.limits_rad.chunks(self.width)) {
            for (elevation_rad, [low_rad, high_rad]) in elevations_rad.iter_mut().zip(limits_rad) {
                *elevation_rad = elevation_rad.max(*low_rad).min(*high_rad);
            }
        }
    }
}
