//! An ISD as it is written.

use std::fmt;

use glam::{DMat3, DQuat, DVec3};
use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde_json::Value as Json;

use crate::geometry::contradicted_step;

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
    #[serde(default, deserialize_with = "entries")]
    pub optical_distortion: Vec<(String, Json)>,
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
    pub num_lines_overlap: Option<f64>,
    pub interpolation_method: Option<String>,
    pub instrument_position: Positions,
    pub instrument_pointing: Turning,
    pub body_rotation: Turning,
    pub sun_position: Positions,
}

/// The keys of each block that ALE writes, the whole's first. Another one may change what these mean.
const KEYS: [(&str, &[&str]); 8] = [
    (
        "",
        &[
            "body_rotation",
            "center_ephemeris_time",
            "detector_center",
            "detector_line_summing",
            "detector_sample_summing",
            "dt_ephemeris",
            "dt_quaternion",
            "ending_ephemeris_time",
            "exposure_duration",
            "focal2pixel_lines",
            "focal2pixel_samples",
            "focal_length_model",
            "framelet_height",
            "framelet_order_reversed",
            "framelets_flipped",
            "image_identifier",
            "image_lines",
            "image_samples",
            "instrument_pointing",
            "instrument_position",
            "interframe_delay",
            "interpolation_method",
            "isis_camera_version",
            "kernels",
            "line_scan_rate",
            "naif_keywords",
            "name_model",
            "name_platform",
            "name_sensor",
            "num_lines_overlap",
            "optical_distortion",
            "radii",
            "reference_height",
            "starting_detector_line",
            "starting_detector_sample",
            "starting_ephemeris_time",
            "sun_position",
            "t0_ephemeris",
            "t0_quaternion",
        ],
    ),
    ("focal_length_model", &["focal_length", "focal_epsilon"]),
    ("detector_center", &["line", "sample"]),
    ("radii", &["semimajor", "semiminor", "unit"]),
    ("instrument_position", POSITION_KEYS),
    ("sun_position", POSITION_KEYS),
    ("instrument_pointing", TURNING_KEYS),
    ("body_rotation", TURNING_KEYS),
];
const POSITION_KEYS: &[&str] = &[
    "ephemeris_times",
    "positions",
    "reference_frame",
    "spk_table_end_time",
    "spk_table_original_size",
    "spk_table_start_time",
    "unit",
    "velocities",
];
const TURNING_KEYS: &[&str] = &[
    "angular_velocities",
    "ck_table_end_time",
    "ck_table_original_size",
    "ck_table_start_time",
    "constant_frames",
    "constant_rotation",
    "ephemeris_times",
    "quaternions",
    "reference_frame",
    "time_dependent_frames",
];

/// The first key that is not known, and those that are in its place.
pub fn unknown_key(json: &Json) -> Option<(String, &'static [&'static str])> {
    KEYS.iter().find_map(|(block, known)| {
        let written = if block.is_empty() { Some(json) } else { json.get(block) };
        let key = written?.as_object()?.keys().find(|key| !known.contains(&key.as_str()))?;
        Some((if block.is_empty() { key.clone() } else { format!("{block}.{key}") }, *known))
    })
}

/// All entries of a map, also those of one name.
fn entries<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<(String, Json)>, D::Error> {
    struct Entries;
    impl<'de> Visitor<'de> for Entries {
        type Value = Vec<(String, Json)>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("a map")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut all = Vec::new();
            while let Some(entry) = map.next_entry()? {
                all.push(entry);
            }
            Ok(all)
        }
    }
    deserializer.deserialize_map(Entries)
}

/// A distortion in the terms of its model, lengths in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distortion {
    Radial([f64; 3]),
    LroNac(f64),
    Kaguya { boresight: [f64; 2], x: [f64; 4], y: [f64; 4] },
}

impl Distortion {
    /// `None` for a model that is not known, with other keys or other counts than it has.
    pub fn of(model: &str, value: &Json) -> Option<Self> {
        let has_only =
            |known: &[&str]| value.as_object().is_some_and(|all| all.keys().all(|key| known.contains(&key.as_str())));
        match model {
            "radial" if has_only(&["coefficients"]) => Some(Self::Radial(numbers(&value["coefficients"])?)),
            "lrolrocnac" if has_only(&["coefficients"]) => {
                let [k] = numbers(&value["coefficients"])?;
                Some(Self::LroNac(k))
            }
            "kaguyalism" if has_only(&["x", "y", "boresight_x", "boresight_y"]) => {
                let number = |key: &str| value.get(key).map_or(Some(0.0), Json::as_f64);
                let boresight = [number("boresight_x")?, number("boresight_y")?];
                Some(Self::Kaguya { boresight, x: numbers(&value["x"])?, y: numbers(&value["y"])? })
            }
            _ => None,
        }
    }
}

fn numbers<const N: usize>(list: &Json) -> Option<[f64; N]> {
    let numbers: Vec<f64> = list.as_array()?.iter().map(Json::as_f64).collect::<Option<_>>()?;
    numbers.try_into().ok()
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
    /// In the unit of the positions a second; nothing is made of them, but they must agree.
    #[serde(default)]
    pub velocities: Vec<[f64; 3]>,
    #[serde(default)]
    pub ephemeris_times: Vec<f64>,
    #[serde(default = "kilometres")]
    pub unit: String,
    pub reference_frame: Option<i64>,
}

/// Rotations from J2000.
#[derive(Debug, Clone, Deserialize)]
pub struct Turning {
    pub quaternions: Vec<[f64; 4]>,
    #[serde(default)]
    pub ephemeris_times: Vec<f64>,
    /// Row by row, after the quaternion.
    pub constant_rotation: Option<[f64; 9]>,
    pub reference_frame: Option<i64>,
}

impl Positions {
    /// The row up to which positions move otherwise than their velocities say; velocities that are all zero say nothing.
    pub fn contradicted_row(&self) -> Option<usize> {
        let vectors = |rows: &[[f64; 3]]| rows.iter().map(|row| DVec3::from(*row)).collect::<Vec<_>>();
        let says = self.velocities.iter().flatten().any(|part| *part != 0.0);
        let [positions, velocities] = [vectors(&self.positions), vectors(&self.velocities)];
        contradicted_step(&self.ephemeris_times, &positions, &velocities).filter(|_| says)
    }

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
