//! An ISD as it is written.

use glam::{DMat3, DQuat, DVec3};
use serde::Deserialize;

/// Neighbours that an interpolated position goes through.
const NEIGHBOURS: usize = 8;

#[derive(Debug, Clone, Deserialize)]
pub struct IsdSpec {
    pub name_model: String,
    pub image_lines: u32,
    pub image_samples: u32,
    pub focal2pixel_lines: [f64; 3],
    pub focal2pixel_samples: [f64; 3],
    pub focal_length_model: FocalLength,
    pub detector_center: DetectorCentre,
    #[serde(default)]
    pub starting_detector_line: f64,
    #[serde(default)]
    pub starting_detector_sample: f64,
    #[serde(default = "one")]
    pub detector_line_summing: f64,
    #[serde(default = "one")]
    pub detector_sample_summing: f64,
    #[serde(default)]
    pub optical_distortion: serde_json::Map<String, serde_json::Value>,
    pub radii: Radii,
    pub center_ephemeris_time: f64,
    pub starting_ephemeris_time: Option<f64>,
    /// Start line, start time from the centre time, seconds a line.
    #[serde(default)]
    pub line_scan_rate: Vec<[f64; 3]>,
    pub exposure_duration: Option<f64>,
    pub interframe_delay: Option<f64>,
    pub framelet_height: Option<u32>,
    #[serde(default)]
    pub framelet_order_reversed: bool,
    #[serde(default)]
    pub framelets_flipped: bool,
    pub instrument_position: Positions,
    pub instrument_pointing: Turning,
    pub body_rotation: Turning,
    pub sun_position: Positions,
}

fn one() -> f64 {
    1.0
}

#[derive(Debug, Clone, Deserialize)]
pub struct FocalLength {
    pub focal_length: f64,
}

#[derive(Debug, Clone, Deserialize)]
pub struct DetectorCentre {
    pub line: f64,
    pub sample: f64,
}

#[derive(Debug, Clone, Deserialize)]
pub struct Radii {
    pub semimajor: f64,
    pub semiminor: f64,
    #[serde(default = "kilometres")]
    pub unit: String,
}

fn kilometres() -> String {
    "km".into()
}

/// Positions in J2000 from the body's centre.
#[derive(Debug, Clone, Deserialize)]
pub struct Positions {
    pub positions: Vec<[f64; 3]>,
    #[serde(default)]
    pub ephemeris_times: Vec<f64>,
    #[serde(default = "kilometres")]
    pub unit: String,
}

/// Rotations from J2000.
#[derive(Debug, Clone, Deserialize)]
pub struct Turning {
    pub quaternions: Vec<[f64; 4]>,
    #[serde(default)]
    pub ephemeris_times: Vec<f64>,
    /// Row by row, after the quaternion.
    pub constant_rotation: Option<[f64; 9]>,
}

impl Positions {
    /// Lagrange's polynomial through the neighbours.
    pub fn at(&self, time: f64) -> DVec3 {
        let (times, count) = (&self.ephemeris_times, self.positions.len().min(NEIGHBOURS));
        if self.positions.len() == 1 {
            return self.positions[0].into();
        }
        let after = times.partition_point(|t| *t < time);
        let first = after.saturating_sub(count / 2).min(self.positions.len() - count);
        let chosen = first..first + count;
        let weight = |i: usize| {
            let others = chosen.clone().filter(|j| *j != i);
            others.map(|j| (time - times[j]) / (times[i] - times[j])).product::<f64>()
        };
        chosen.clone().map(|i| weight(i) * DVec3::from(self.positions[i])).sum()
    }
}

impl Turning {
    pub fn at(&self, time: f64) -> DMat3 {
        let quaternion = |i: usize| {
            let [w, x, y, z] = self.quaternions[i];
            DQuat::from_xyzw(x, y, z, w).normalize()
        };
        let turned = if self.quaternions.len() == 1 {
            quaternion(0)
        } else {
            let times = &self.ephemeris_times;
            let after = times.partition_point(|t| *t < time).clamp(1, times.len() - 1);
            let share = (time - times[after - 1]) / (times[after] - times[after - 1]);
            let (a, b) = (quaternion(after - 1), quaternion(after));
            a.slerp(if a.dot(b) < 0.0 { -b } else { b }, share).normalize()
        };
        let constant = self.constant_rotation.map_or(DMat3::IDENTITY, |rows| DMat3::from_cols_array(&rows).transpose());
        constant * DMat3::from_quat(turned)
    }
}
