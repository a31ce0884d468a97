//! Illumination maps as a GeoTIFF.

use std::path::Path;

use glam::DVec2;

use super::maps::Maps;
use crate::horizon::georeference::proj4;
use crate::raster::{self, GeoTiff, GeoTiffBand};
use crate::terrain::{Gnomonic, Level};

impl Maps {
    /// Writes all maps of a level, in the gnomonic projection about the map's centre. A map that is turned against
    /// north has a turned affine map.
    pub fn write(&self, map: &Gnomonic, level: &Level, path: &Path) -> Result<(), raster::Error> {
        let planes = [
            ("lit_share", "1", &self.lit_share),
            ("disc_share", "1", &self.disc_share),
            ("longest_night", "h", &self.longest_night_h),
            ("earth_share", "1", &self.earth_share),
        ];
        let values = planes.map(|(.., plane)| self.rows_down(plane));
        let bands = planes.iter().zip(&values).map(|((name, unit, _), values)| GeoTiffBand { name, unit, values });
        let (crs, geotransform) = georeference(map, level, self.rows);
        let (columns, rows) = (self.columns, self.rows);
        GeoTiff { columns, rows, bands: bands.collect(), crs: &crs, geotransform }.write(path)
    }

    /// A plane with its rows from the top of the map down.
    pub fn rows_down(&self, plane: &[f32]) -> Vec<f32> {
        plane.chunks(self.columns).rev().flatten().copied().collect()
    }
}

/// PROJ string and GDAL's affine map of a level's seen part, `rows` of them.
fn georeference(map: &Gnomonic, level: &Level, rows: usize) -> (String, [f64; 6]) {
    let (centre, north_up) = map.north_up();
    // From the map's axes to east and north.
    let turn = north_up * map.map_from_body.matrix().transpose();
    let turned = |at: DVec2| (turn * at.extend(0.0)).truncate();
    let (right, down) = (turned(DVec2::X) * level.posting_m, turned(DVec2::NEG_Y) * level.posting_m);
    let margin = level.margin as f64;
    let first = turned(level.map_from_grid(DVec2::new(margin, margin + (rows - 1) as f64)));
    let corner = first - 0.5 * (right + down);
    let crs = proj4(map.radius_m, [centre.latitude_rad, centre.longitude_east_rad].map(f64::to_degrees));
    (crs, [corner.x, right.x, down.x, corner.y, right.y, down.y])
}
