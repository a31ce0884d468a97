//! The list of a globe's tiles, as JSON beside them.

use std::path::Path;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::{Checks, Globe};
use crate::dataset::disk;
use crate::horizon::{Encoding, ErrorStatistics, Settings, TileErrors};
use crate::pipeline::Error;
use crate::terrain::GlobalDem;
use crate::terrain::quadtree::{QuadTree, TileId};

/// The index's name in a globe's folder.
pub const FILE: &str = "globe.json";

const FORMAT: &str = "perilune globe 1";

/// All that shapes the tiles: what is in one folder is made from one plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    pub format: String,
    pub body: String,
    pub equatorial_radius_m: f64,
    pub polar_radius_m: f64,
    pub dem: String,
    pub dem_sha256: String,
    /// Lowest and highest ground above the reference surface, and how far the one is seen from the other.
    pub relief_m: [f64; 2],
    pub reach_m: f64,
    /// Cells along a tile's side, levels of detail, posting of the finest in a face's middle.
    pub cells: usize,
    pub levels: usize,
    pub posting_m: f64,
    pub margin: usize,
    pub settings: Settings,
    pub encoding: Encoding,
}

impl Plan {
    pub fn new(
        tree: &QuadTree,
        dem: &GlobalDem,
        dem_sha256: String,
        margin: usize,
        settings: Settings,
        encoding: Encoding,
    ) -> Self {
        Self {
            format: FORMAT.into(),
            body: tree.body.name.clone(),
            equatorial_radius_m: tree.body.equatorial_radius_m,
            polar_radius_m: tree.body.polar_radius_m,
            dem: crate::pipeline::names::file_name(&dem.path),
            dem_sha256,
            relief_m: [dem.lowest_m, dem.highest_m],
            reach_m: (dem.reach_rad(&tree.body) * tree.body.equatorial_radius_m).round(),
            cells: tree.cells,
            levels: tree.levels,
            posting_m: tree.posting_m(tree.levels - 1),
            margin,
            settings,
            encoding,
        }
    }

    /// The first key in which two plans differ, with both values.
    pub fn difference(&self, other: &Self) -> String {
        let [mine, others] = [self, other].map(|plan| serde_json::to_value(plan).expect("plain data"));
        let object = mine.as_object().expect("a structure");
        let key = object.iter().find(|(key, value)| others[key.as_str()] != **value);
        key.map_or_else(String::new, |(key, value)| format!("{key} = {value}, not {}", others[key.as_str()]))
    }
}

/// A tile as the index lists it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    pub face: usize,
    pub level: usize,
    pub column: usize,
    pub row: usize,
    pub file: String,
    pub posting_m: f64,
    /// Map coordinates on the face: west, south, east, north.
    pub bounds_m: [f64; 4],
    /// Latitude and east longitude of the middle and of the corners, counter-clockwise from the bottom left.
    pub middle_deg: [f64; 2],
    pub corners_deg: [[f64; 2]; 4],
    pub bytes: u64,
    pub errors: TileErrors,
}

/// A globe's plan, the tiles that are there, and how they compare with the full resolution.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Index {
    #[serde(flatten)]
    pub plan: Plan,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checks: Option<Checks>,
    pub tiles: Vec<Entry>,
}

/// Errors of many tiles, each against traces at its own nodes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OverallErrors {
    pub samples: usize,
    /// Over all samples.
    pub rms_rad: f64,
    pub max_rad: f64,
    /// The tiles' 95th and 99th percentiles: of the tile in the middle, and of the worst one.
    pub p95_rad: [f64; 2],
    pub p99_rad: [f64; 2],
}

impl OverallErrors {
    /// `None` of nothing measured.
    pub fn of(tiles: &[ErrorStatistics]) -> Option<Self> {
        let samples: usize = tiles.iter().map(|errors| errors.samples).sum();
        if samples == 0 {
            return None;
        }
        let square = |errors: &ErrorStatistics| errors.samples as f64 * errors.rms_rad * errors.rms_rad;
        let middle_and_worst = |quantile: fn(&ErrorStatistics) -> f64| {
            let mut sizes_rad: Vec<f64> = tiles.iter().map(quantile).collect();
            sizes_rad.sort_by(f64::total_cmp);
            [sizes_rad[sizes_rad.len() / 2], sizes_rad[sizes_rad.len() - 1]]
        };
        Some(Self {
            samples,
            rms_rad: (tiles.iter().map(square).sum::<f64>() / samples as f64).sqrt(),
            max_rad: tiles.iter().fold(0.0, |worst, errors| worst.max(errors.max_rad)),
            p95_rad: middle_and_worst(|errors| errors.p95_rad),
            p99_rad: middle_and_worst(|errors| errors.p99_rad),
        })
    }
}

/// A tile's file below its globe's folder.
pub fn file_of(tile: TileId) -> String {
    format!("{}/{}_{}_{}.tif", tile.level, tile.face, tile.column, tile.row)
}

impl Index {
    /// All tiles that are there.
    pub fn of(globe: &Globe) -> Result<Self, Error> {
        let entries = globe.tree.tiles().filter_map(|tile| Entry::of(globe, tile));
        Ok(Self { plan: globe.plan.clone(), tiles: entries.collect(), checks: None })
    }

    /// Errors over all tiles: of what was swept, and of what the tiles decode to.
    pub fn errors(&self) -> [Option<OverallErrors>; 2] {
        let of = |errors: fn(&TileErrors) -> ErrorStatistics| {
            OverallErrors::of(&self.tiles.iter().map(|tile| errors(&tile.errors)).collect::<Vec<_>>())
        };
        [of(|errors| errors.swept), of(|errors| errors.decoded)]
    }

    /// `None` where there is no such file.
    pub fn read(path: &Path) -> Result<Option<Self>, Error> {
        if !path.exists() {
            return Ok(None);
        }
        let text = disk::read(path)?;
        let index = serde_json::from_slice(&text);
        Ok(Some(index.map_err(|source| Error::Index { path: path.into(), source })?))
    }

    pub fn write(&self, path: &Path) -> Result<(), Error> {
        super::make_room(path)?;
        let text = serde_json::to_string_pretty(self).expect("an index is plain data");
        Ok(disk::write(path, format!("{text}\n").as_bytes())?)
    }
}

impl Entry {
    fn of(globe: &Globe, tile: TileId) -> Option<Self> {
        let (header, _) = globe.read(tile)?;
        let cells = globe.tree.cells as f64;
        let place_deg = |x: f64, y: f64| {
            let place = globe.tree.place(tile, cells * DVec2::new(x, y));
            [place.latitude_rad, place.longitude_east_rad].map(f64::to_degrees)
        };
        let (low, high) = (globe.tree.node_m(tile, DVec2::ZERO), globe.tree.node_m(tile, DVec2::splat(cells)));
        Some(Self {
            face: tile.face,
            level: tile.level,
            column: tile.column,
            row: tile.row,
            file: file_of(tile),
            posting_m: header.map.posting_m,
            bounds_m: [low.x, low.y, high.x, high.y],
            middle_deg: place_deg(0.5, 0.5),
            corners_deg: [place_deg(0.0, 0.0), place_deg(1.0, 0.0), place_deg(1.0, 1.0), place_deg(0.0, 1.0)],
            bytes: std::fs::metadata(globe.path(tile)).ok()?.len(),
            errors: header.errors,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 100 samples of 3 and 300 of 1: a mean square of (900 + 300)/400.
    #[test]
    fn errors_of_tiles_are_pooled_by_their_samples() {
        let tile = |samples: usize, rms_rad: f64| ErrorStatistics {
            samples,
            rms_rad,
            p95_rad: 2.0 * rms_rad,
            p99_rad: 3.0 * rms_rad,
            max_rad: 4.0 * rms_rad,
            ..ErrorStatistics::default()
        };
        let found = OverallErrors::of(&[tile(100, 3.0), tile(300, 1.0)]).unwrap();
        assert!((found.rms_rad - 3f64.sqrt()).abs() < 1e-12);
        assert_eq!((found.samples, found.max_rad, found.p95_rad, found.p99_rad), (400, 12.0, [6.0; 2], [9.0; 2]));
        let found = OverallErrors::of(&[tile(1, 1.0), tile(1, 2.0), tile(1, 5.0)]).unwrap();
        assert_eq!(found.p99_rad, [6.0, 15.0]);
        assert_eq!(OverallErrors::of(&[]), None);
    }
}
