//! Whether what a tile says of itself can be true.
//!
//! A header is text from a file, and what uses it divides by its numbers and takes memory for its sizes: all of them are
//! checked here before any is used.

use std::f64::consts::FRAC_PI_2;

use glam::{DMat3, DVec3};

use super::{Header, MapHeader};
use crate::horizon::pages;
use crate::horizon::settings::Settings;

/// The largest of an axis' nodes; pixels of a TIFF are counted in 32 bits.
const NODES_AT_MOST: usize = 1 << 24;
/// Bodies and their maps, in m.
const RADII_M: [f64; 2] = [1.0, 1e9];
/// How far axes may be from perpendicular unit vectors: they are written with all their digits.
const AXES_TOLERANCE: f64 = 1e-9;
/// Azimuths of a search.
const AZIMUTHS_AT_MOST: usize = 1_000_000;
/// Heights of observers, in m, as a search has them.
const OBSERVER_AT_MOST_M: f64 = 1e6;

impl Header {
    /// What cannot be true of a tile whose file has room for so many texels of a page.
    pub fn check(&self, texels_at_most: usize) -> Result<(), String> {
        let sizes = 2..=NODES_AT_MOST;
        let [columns, rows] = [self.columns, self.rows];
        if !sizes.contains(&columns) || !sizes.contains(&rows) || columns * rows > texels_at_most {
            return Err(format!("it has no room for {columns} × {rows} nodes, of which there are at least 2 × 2"));
        }
        if pages::fields(&self.pages, self.encoding, columns, rows).is_none() {
            return Err(format!("its pages are not those of {}", self.encoding));
        }
        within("body.equatorial_radius_m", self.body.equatorial_radius_m, RADII_M)?;
        within("body.polar_radius_m", self.body.polar_radius_m, RADII_M)?;
        self.map.check()?;
        self.settings.check_stored()
    }
}

impl MapHeader {
    fn check(&self) -> Result<(), String> {
        let farthest_m = RADII_M[1];
        within("map.radius_m", self.radius_m, RADII_M)?;
        within("map.posting_m", self.posting_m, [f64::MIN_POSITIVE, farthest_m])?;
        let corner_m = [self.west_m, self.south_m];
        for component in self.origin_m.into_iter().chain(corner_m) {
            within("a component of map.origin_m, or map.west_m or map.south_m", component, [-farthest_m, farthest_m])?;
        }
        let axes = [self.right, self.up, self.outward].map(DVec3::from_array);
        let axes = DMat3::from_cols(axes[0], axes[1], axes[2]);
        let is_rotation =
            (axes.transpose() * axes).abs_diff_eq(DMat3::IDENTITY, AXES_TOLERANCE) && axes.determinant() > 0.0;
        if !is_rotation {
            return Err("map.right, map.up and map.outward are not the axes of a right-handed frame".into());
        }
        match self.centre_deg {
            Some([latitude_deg, longitude_deg]) => {
                within("latitude of map.centre_deg", latitude_deg, [-90.0, 90.0])?;
                within("longitude of map.centre_deg", longitude_deg, [-360.0, 360.0])
            }
            None => Ok(()),
        }
    }
}

impl Settings {
    fn check_stored(&self) -> Result<(), String> {
        if !(1..=AZIMUTHS_AT_MOST).contains(&self.azimuths) {
            return Err(format!("settings.azimuths = {} is outside [1, {AZIMUTHS_AT_MOST}]", self.azimuths));
        }
        within("settings.observer_height_m", self.observer_height_m, [0.0, OBSERVER_AT_MOST_M])?;
        if let Some(search_m) = self.search_m {
            within("settings.search_m", search_m, [f64::MIN_POSITIVE, f64::MAX])?;
        }
        let Some(band) = self.band else { return Ok(()) };
        within("settings.band.reach_rad", band.reach_rad, [0.0, FRAC_PI_2])?;
        within("length of settings.band.towards", DVec3::from_array(band.towards).length(), [0.5, 1.5])
    }
}

fn within(key: &str, got: f64, [low, high]: [f64; 2]) -> Result<(), String> {
    if (low..=high).contains(&got) { Ok(()) } else { Err(format!("{key} = {got} is outside [{low}, {high}]")) }
}
