//! Which tiles of a quad-tree: by their numbers, or by a box of latitudes and longitudes.
//!
//! ```text
//! FACE/LEVEL/COLUMN/ROW     each a number, a range as 2-5, or *; what is left out at the end is *
//! S,W,N,E                   degrees, eastwards from W to E; all levels
//! ```

use std::ops::RangeInclusive;
use std::str::FromStr;

use glam::DVec2;

use crate::terrain::quadtree::{QuadTree, TileId};

/// Points along a tile's side that are looked for in a box.
const PROBES: usize = 16;

/// Some tiles.
#[derive(Debug, Clone, PartialEq)]
pub enum Selection {
    /// Face, level, column, row.
    Numbers([RangeInclusive<usize>; 4]),
    /// Degrees: south, west, north, east.
    Box([f64; 4]),
}

impl FromStr for Selection {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const WANTED: &str = "want FACE/LEVEL/COLUMN/ROW, as 2/0-3/*/*, or S,W,N,E in degrees";
        if text.contains(',') {
            let numbers: Vec<f64> = text.split(',').map(str::parse).collect::<Result<_, _>>().map_err(|_| WANTED)?;
            let edges: [f64; 4] = numbers.try_into().map_err(|_| WANTED)?;
            let [south, west, north, east] = edges;
            let sound =
                -90.0 <= south && south <= north && north <= 90.0 && [west, east].iter().all(|l| l.abs() <= 360.0);
            return if sound { Ok(Self::Box(edges)) } else { Err("want -90 <= S <= N <= 90, |W|, |E| <= 360".into()) };
        }
        let mut ranges = [const { 0..=usize::MAX }; 4];
        let parts: Vec<&str> = text.split('/').collect();
        if parts.len() > ranges.len() {
            return Err(WANTED.into());
        }
        for (range, part) in ranges.iter_mut().zip(parts) {
            if part == "*" {
                continue;
            }
            let (low, high) = part.split_once('-').unwrap_or((part, part));
            let number = |text: &str| text.parse::<usize>().map_err(|_| WANTED);
            *range = number(low)?..=number(high)?;
        }
        Ok(Self::Numbers(ranges))
    }
}

impl Selection {
    pub fn holds(&self, tree: &QuadTree, tile: TileId) -> bool {
        match self {
            Self::Numbers(ranges) => {
                let numbers = [tile.face, tile.level, tile.column, tile.row];
                ranges.iter().zip(numbers).all(|(range, number)| range.contains(&number))
            }
            Self::Box([south, west, north, east]) => {
                let middle_deg = [0.5 * (south + north), west + 0.5 * (east - west).rem_euclid(360.0)];
                let middle = crate::geometry::Geodetic::from_degrees(middle_deg[0], middle_deg[1], 0.0);
                let (holder, _) = tree.find(tile.level, tree.body.position_from_geodetic(middle));
                let width = if east - west >= 360.0 { 360.0 } else { (east - west).rem_euclid(360.0) };
                let step = tree.cells as f64 / PROBES as f64;
                let mut nodes = (0..=PROBES * (PROBES + 2))
                    .map(|i| step * DVec2::new((i % (PROBES + 1)) as f64, (i / (PROBES + 1)) as f64));
                let inside = |node: DVec2| {
                    let place = tree.place(tile, node);
                    let latitude_deg = place.latitude_rad.to_degrees();
                    let beyond_west_deg = (place.longitude_east_rad.to_degrees() - west).rem_euclid(360.0);
                    (*south..=*north).contains(&latitude_deg) && beyond_west_deg <= width
                };
                holder == tile || nodes.any(inside)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Body;

    fn chosen(text: &str) -> Vec<String> {
        let tree = QuadTree::new(&Body::moon(), 16, 120_000.0);
        let selection: Selection = text.parse().unwrap();
        tree.tiles().filter(|tile| selection.holds(&tree, *tile)).map(|tile| tile.to_string()).collect()
    }

    #[test]
    fn tiles_are_named_by_numbers_and_ranges() {
        assert_eq!(chosen("2/1/0-1/1"), ["2/1/0/1", "2/1/1/1"]);
        assert_eq!(chosen("*/0"), ["0/0/0/0", "1/0/0/0", "2/0/0/0", "3/0/0/0", "4/0/0/0", "5/0/0/0"]);
        for wrong in ["", "a/b", "1/2/3/4/5", "1,2,3", "-100,0,0,10", "1/x-2"] {
            assert!(wrong.parse::<Selection>().is_err(), "{wrong}");
        }
    }

    /// The pole is in the middle of a face, so in the corner of four tiles from level 1 on; the antimeridian box lies on face 5.
    #[test]
    fn a_box_takes_all_tiles_that_it_touches() {
        assert_eq!(chosen("89.9,0,90,360"), ["2/0/0/0", "2/1/0/0", "2/1/1/0", "2/1/0/1", "2/1/1/1"]);
        assert_eq!(chosen("10,179,11,-179"), ["5/0/0/0", "5/1/0/1", "5/1/1/1"]);
        assert_eq!(chosen("10.01,10.01,10.02,10.02").len(), 2);
    }
}
