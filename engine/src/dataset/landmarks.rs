//! The landmarks of an exposure as a file, and drawn over its preview.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use crate::labels::{Ellipse, Landmark};

/// `exposure_0007.landmarks.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LandmarkFile {
    pub schema_version: String,
    pub frame_id: String,
    pub columns: usize,
    pub rows: usize,
    /// How pixels, angles and conics are meant.
    pub conventions: String,
    pub landmarks: Vec<Landmark>,
}

pub const CONVENTIONS: &str = "the centre of the first pixel is (0, 0); angle_rad of the longer semi-axis from right towards \
down; a pixel p = (column, row, 1) lies on the conic A where p' A p = 0, inside where it is less, in the centre it is -1";

/// Red, green and blue of landmarks in the light, in shadow, and hidden.
const LIT: [u8; 3] = [60, 220, 60];
const DARK: [u8; 3] = [255, 170, 0];
const HIDDEN: [u8; 3] = [230, 60, 60];

/// A preview in colour with an ellipse for each landmark.
pub fn overlay(grey: &[u8], columns: usize, landmarks: &[Landmark]) -> Vec<u8> {
    let mut rgb: Vec<u8> = grey.iter().flat_map(|&grey| [grey; 3]).collect();
    for landmark in landmarks {
        let color = match landmark {
            Landmark { occluded: true, .. } => HIDDEN,
            Landmark { in_shadow: true, .. } => DARK,
            _ => LIT,
        };
        draw(&mut rgb, columns, &landmark.ellipse, color);
    }
    rgb
}

fn draw(rgb: &mut [u8], columns: usize, ellipse: &Ellipse, color: [u8; 3]) {
    let rows = rgb.len() / 3 / columns;
    // Two points a pixel of the longer axis' circle.
    let points = (4.0 * std::f64::consts::PI * ellipse.semi_axes_px[0]).clamp(16.0, 1e5).ceil();
    for k in 0..points as usize {
        let at = ellipse.at(std::f64::consts::TAU * k as f64 / points).round();
        if at.cmpge(DVec2::ZERO).all() && at.x < columns as f64 && at.y < rows as f64 {
            let pixel = 3 * (at.y as usize * columns + at.x as usize);
            rgb[pixel..pixel + 3].copy_from_slice(&color);
        }
    }
}
