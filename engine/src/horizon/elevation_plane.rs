//! The elevations of the skyline around all nodes of a level in one azimuth.

use std::ops::Range;

use super::axis::Major;

/// The skyline's elevations in one azimuth, row by row with a stride.
#[derive(Debug, Clone)]
pub struct ElevationPlane {
    /// Index of the azimuth.
    pub azimuth: usize,
    pub stride: usize,
    pub elevations_rad: Vec<f32>,
}

impl ElevationPlane {
    /// The elevation at a node of the map.
    pub fn at(&self, major: Major, column: usize, row: usize) -> f32 {
        self.elevations_rad[major.index(self.stride, [column, row])]
    }

    /// Rows of the map one after the other; `turned` where the plane's own rows run along the map's columns.
    pub(super) fn rows<'a>(
        &'a self,
        rows: Range<usize>,
        columns: usize,
        turned: bool,
        buffer: &'a mut Vec<f32>,
    ) -> (&'a [f32], usize) {
        if !turned {
            return (&self.elevations_rad[rows.start * self.stride..], self.stride);
        }
        buffer.resize(rows.len() * columns, 0.0);
        for (column, along) in self.elevations_rad.chunks(self.stride).take(columns).enumerate() {
            for (row, elevation_rad) in along[rows.clone()].iter().enumerate() {
                buffer[row * columns + column] = *elevation_rad;
            }
        }
        (buffer, columns)
    }
}
