//! Craters as lists give them.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use crate::geometry::{Body, Geodetic};

/// Two entries are one crater if their diameters are equal and their centres this near, in diameters: lists of nested
/// terrains repeat each other up to the rounding of their coordinates.
const SAME_PLACE: f64 = 0.01;

/// A crater: where its rim is on the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Crater {
    /// Unique within all lists of a run.
    pub id: String,
    /// Middle of the rim, at height 0.
    pub centre: Geodetic,
    /// Longest and shortest, along the ground.
    pub diameters_m: [f64; 2],
    /// Of the longest diameter, clockwise from north.
    pub azimuth_rad: f64,
    /// Rim to floor, where the list tells.
    pub depth_m: Option<f64>,
    /// `κt/R²`: 0 fresh, 0.6 all but gone; where the list tells.
    pub degradation: Option<f64>,
    /// True where a younger crater of at least its size holds its centre.
    pub buried: bool,
    pub origin: Origin,
}

/// How a crater came to be in the ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// Somebody measured it.
    Catalogue,
    /// All of the terrain is made up, and it with it.
    Synthetic,
    /// Made up below the posting of a measured terrain.
    #[serde(rename = "invented")]
    SyntheticDetail,
}

/// The craters of several lists, the first list's before the others', without those that an earlier list holds.
pub fn without_repeats(lists: impl IntoIterator<Item = Vec<Crater>>, body: &Body) -> Vec<Crater> {
    let mut kept: Vec<Crater> = Vec::new();
    let mut of_size: HashMap<[u64; 2], Vec<usize>> = HashMap::new();
    for list in lists {
        let earlier = kept.len();
        for crater in list {
            let same_size = of_size.entry(crater.diameters_m.map(f64::to_bits)).or_default();
            let place = body.position_from_geodetic(crater.centre);
            let is_same = |&index: &usize| {
                let apart_m = body.position_from_geodetic(kept[index].centre).distance_m(place);
                index < earlier && apart_m < SAME_PLACE * crater.diameters_m[0]
            };
            if !same_size.iter().any(is_same) {
                same_size.push(kept.len());
                kept.push(crater);
            }
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn crater(id: &str, latitude_deg: f64, diameter_m: f64) -> Crater {
        Crater {
            id: id.into(),
            centre: Geodetic::from_degrees(latitude_deg, 10.0, 0.0),
            diameters_m: [diameter_m; 2],
            azimuth_rad: 0.0,
            depth_m: None,
            degradation: None,
            buried: false,
            origin: Origin::Synthetic,
        }
    }

    #[test]
    fn a_crater_of_two_lists_is_kept_once() {
        // A billionth of a degree is 30 µm; a hundredth is 303 m.
        let fine = vec![crater("a", -80.0, 50.0), crater("b", -80.01, 50.0)];
        let coarse = vec![crater("c", -80.000_000_001, 50.0), crater("d", -80.0, 51.0), crater("e", -80.02, 50.0)];
        let ids: Vec<_> = without_repeats([fine, coarse], &Body::moon()).into_iter().map(|crater| crater.id).collect();
        assert_eq!(ids, ["a", "b", "d", "e"]);
    }
}
