//! Image support data: camera, poses and Sun as USGS's ALE writes them for CSM programs.
//!
//! A point `(x, y)` of the focal plane, in mm, and the detector, from 0.5 at the first pixel's centre:
//!
//! ```text
//! sample = s₀ + S₀ + S₁ x + S₂ y,    line = l₀ + L₀ + L₁ x + L₂ y         focal2pixel_samples, focal2pixel_lines
//! look   = ± (x', y', f) in the sensor's axes,  (x', y') = (x, y) without distortion
//! body-fixed = B(t) · S(t)ᵀ · look,   B, S from J2000 (body_rotation, instrument_pointing, scalar-first quaternions)
//! ```
//!
//! The sign is the one with which the boresight meets the body. Line `r` of a scanner, counted from 0, is exposed about
//! `t = t₀ + rate (r + 1 − r₀)` (`line_scan_rate`, `t₀` from the centre time); framelet `k` of a push-frame camera about
//! `start + exposure/2 + k delay`. Positions go by Lagrange's polynomial through at most eight neighbours, attitudes by
//! slerp.
//!
//! # Assumptions
//! - Sample and line axes are perpendicular. Distortion is none, `radial`, `lrolrocnac` or `kaguyalism`.
//! - The Sun stands still during the image: at the centre time.
//!
//! # References
//! Laura, Mapel & Hare (2020), Earth and Space Science 7, doi:10.1029/2019EA000713; `usgscsm` for frame, line-scan and
//! push-frame sensors.

mod spec;

use std::path::{Path, PathBuf};

use glam::{DMat3, DVec2, DVec3};

use super::{Camera, CameraError, Correction, Pose, PosedCamera, Shutter};
use crate::geometry::{Body, BodyFixed, Position, Rotation};
use spec::{Distortion, IsdSpec, Radii};

/// What an ISD says, in our terms.
#[derive(Debug, Clone, PartialEq)]
pub struct Isd {
    pub path: PathBuf,
    /// `USGS_ASTRO_FRAME_SENSOR_MODEL` and its like.
    pub model: String,
    pub body: Body,
    pub camera: PosedCamera,
    /// When rows are exposed, as far as the ISD says it in our terms; the poses say it exactly.
    pub shutter: Shutter,
    /// Of the image, past J2000.
    pub centre_tdb_s: f64,
    /// Body-fixed, at the image's centre time.
    pub sun: Position<BodyFixed>,
}

/// What can be wrong with an ISD.
#[derive(Debug, thiserror::Error)]
pub enum IsdError {
    #[error("cannot read {path}: {source}")]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{path} is not an ISD as ALE writes it: {source}")]
    Json { path: PathBuf, source: serde_json::Error },
    #[error("{path}: {key} is not a key of an ISD here; allowed are {allowed}")]
    UnknownKey { path: PathBuf, key: String, allowed: String },
    #[error("{path}: {key} = {got}, allowed is {allowed}")]
    Value { path: PathBuf, key: &'static str, got: String, allowed: &'static str },
    #[error("{path}")]
    Camera { path: PathBuf, source: CameraError },
}

/// How far a quaternion's length may be from 1 before it is taken for a mistake.
const LENGTH_TOLERANCE: f64 = 1e-3;
/// How far a matrix may be from a rotation.
const MATRIX_TOLERANCE: f64 = 1e-6;
/// SPICE's id of the frame of all numbers.
const J2000: i64 = 1;
/// Cosine of sample and line axes up to which they are perpendicular.
const SKEW: f64 = 1e-6;

impl Isd {
    pub fn read(path: &Path) -> Result<Self, IsdError> {
        let text = crate::text::read(path).map_err(|source| IsdError::Read { path: path.into(), source })?;
        Self::parse(path, &text)
    }

    /// As [`Self::read`], of a file's text.
    pub fn parse(path: &Path, text: &str) -> Result<Self, IsdError> {
        let fault = |source| IsdError::Json { path: path.into(), source };
        let json: serde_json::Value = serde_json::from_str(text).map_err(fault)?;
        if let Some((key, allowed)) = spec::unknown_key(&json) {
            return Err(IsdError::UnknownKey { path: path.into(), key, allowed: allowed.join(", ") });
        }
        // From the text, so that an error names its line.
        let written: IsdSpec = serde_json::from_str(text).map_err(fault)?;
        Reader { path, isd: &written }.read()
    }
}

struct Reader<'a> {
    path: &'a Path,
    isd: &'a IsdSpec,
}

impl Reader<'_> {
    fn read(&self) -> Result<Isd, IsdError> {
        self.check_tables()?;
        self.check_rotations()?;
        self.check_motion()?;
        let times = self.times()?;
        let centre = self.isd.center_ephemeris_time;
        // The boresight looks towards the body.
        let middle = times[times.len() / 2];
        let sign = if self.position_m(middle)?.dot(self.body_from_sensor(middle).z_axis) < 0.0 { 1.0 } else { -1.0 };
        let (optics, sensor_axes) = self.optics(sign)?;
        let pose = |&time: &f64| {
            let axes = self.body_from_sensor(time) * sensor_axes;
            Ok(Pose {
                position: Position::from_m(self.position_m(time)?),
                camera_from_body: Rotation::from_axes(axes.x_axis, axes.y_axis, axes.z_axis),
            })
        };
        let poses = times.iter().map(pose).collect::<Result<_, _>>()?;
        let sun_m = self.isd.sun_position.at(centre) * self.unit_m("sun_position.unit", &self.isd.sun_position.unit)?;
        Ok(Isd {
            path: self.path.into(),
            model: self.isd.name_model.clone(),
            body: self.body()?,
            shutter: self.shutter(&times, optics.rows),
            camera: PosedCamera { optics, poses },
            centre_tdb_s: centre,
            sun: Position::from_m(self.isd.body_rotation.at(centre) * sun_m),
        })
    }

    fn value(&self, key: &'static str, got: impl ToString, allowed: &'static str) -> IsdError {
        IsdError::Value { path: self.path.into(), key, got: got.to_string(), allowed }
    }

    fn unit_m(&self, key: &'static str, unit: &str) -> Result<f64, IsdError> {
        match unit.to_lowercase().as_str() {
            "km" => Ok(1e3),
            "m" => Ok(1.0),
            _ => Err(self.value(key, unit, "m or km")),
        }
    }

    /// Each table has a time for each of its rows.
    fn check_tables(&self) -> Result<(), IsdError> {
        let IsdSpec { instrument_position, instrument_pointing, body_rotation, sun_position, .. } = self.isd;
        for (key, rows, times) in [
            ("instrument_position", instrument_position.positions.len(), &instrument_position.ephemeris_times),
            ("instrument_pointing", instrument_pointing.quaternions.len(), &instrument_pointing.ephemeris_times),
            ("body_rotation", body_rotation.quaternions.len(), &body_rotation.ephemeris_times),
            ("sun_position", sun_position.positions.len(), &sun_position.ephemeris_times),
        ] {
            let timed = times.len() == rows && times.windows(2).all(|pair| pair[0] < pair[1]);
            if rows == 0 || (rows > 1 && !timed) {
                let got = format!("{rows} rows and {} times", times.len());
                return Err(self.value(key, got, "at least one row, each with a later time than the one before"));
            }
        }
        Ok(())
    }

    /// Each rotation is one, and each table's numbers are of J2000.
    fn check_rotations(&self) -> Result<(), IsdError> {
        let IsdSpec { instrument_position, instrument_pointing, body_rotation, sun_position, .. } = self.isd;
        for (key, turning) in [("instrument_pointing", instrument_pointing), ("body_rotation", body_rotation)] {
            let is_unit = |wxyz: &&[f64; 4]| {
                let length = wxyz.iter().map(|part| part * part).sum::<f64>().sqrt();
                (length - 1.0).abs() <= LENGTH_TOLERANCE
            };
            if let Some(wxyz) = turning.quaternions.iter().find(|wxyz| !is_unit(wxyz)) {
                return Err(self.value(key, format!("the quaternion {wxyz:?}"), "quaternions of length 1, to 1e-3"));
            }
            let constant = turning.constant_rotation.map(|rows| DMat3::from_cols_array(&rows).transpose());
            let is_rotation = |matrix: DMat3| {
                (matrix * matrix.transpose()).abs_diff_eq(DMat3::IDENTITY, MATRIX_TOLERANCE)
                    && matrix.determinant() > 0.0
            };
            if let Some(matrix) = constant.filter(|matrix| !is_rotation(*matrix)) {
                return Err(self.value(key, format!("the constant_rotation {matrix}"), "rotations"));
            }
        }
        for (key, frame) in [
            ("instrument_position", &instrument_position.reference_frame),
            ("instrument_pointing", &instrument_pointing.reference_frame),
            ("body_rotation", &body_rotation.reference_frame),
            ("sun_position", &sun_position.reference_frame),
        ] {
            if let Some(frame) = frame.as_ref().filter(|frame| **frame != J2000) {
                return Err(self.value(key, format!("numbers in reference_frame {frame}"), "reference_frame 1, J2000"));
            }
        }
        match self.isd.num_lines_overlap.filter(|lines| *lines != 0.0) {
            Some(lines) => Err(self.value("num_lines_overlap", lines, "0")),
            None => Ok(()),
        }
    }

    /// Velocities are those of their positions, and nothing asks for another way between them.
    fn check_motion(&self) -> Result<(), IsdError> {
        for (key, table) in [
            ("instrument_position.velocities", &self.isd.instrument_position),
            ("sun_position.velocities", &self.isd.sun_position),
        ] {
            let [rows, velocities] = [table.positions.len(), table.velocities.len()];
            if velocities > 0 && velocities != rows {
                return Err(self.value(key, format!("{velocities} rows for {rows} positions"), "as many, or none"));
            }
            if let Some(row) = table.contradicted_row() {
                let got = format!("{:?} in row {row}", table.velocities[row]);
                return Err(self.value(key, got, "what the positions change by in a second, in their unit"));
            }
        }
        match self.isd.interpolation_method.as_deref().filter(|method| *method != "lagrange") {
            Some(other) => Err(self.value("interpolation_method", other, "lagrange")),
            None => Ok(()),
        }
    }

    /// Of the exposures, the image's top first.
    fn times(&self) -> Result<Vec<f64>, IsdError> {
        let isd = self.isd;
        match isd.name_model.as_str() {
            "USGS_ASTRO_FRAME_SENSOR_MODEL" => Ok(vec![isd.center_ephemeris_time]),
            "USGS_ASTRO_LINE_SCANNER_SENSOR_MODEL" => {
                let Some(&first) = isd.line_scan_rate.first() else {
                    return Err(self.value("line_scan_rate", "nothing", "at least one row"));
                };
                let time = |row: u32| {
                    // A line's middle, where the first line is 0.5 from the image's edge.
                    let line = f64::from(row) + 0.5;
                    let begun = isd.line_scan_rate.iter().rev().find(|part| part[0] <= line);
                    let [start_line, start_s, rate_s] = *begun.unwrap_or(&first);
                    isd.center_ephemeris_time + start_s + rate_s * (line + 0.5 - start_line)
                };
                Ok((0..isd.image_lines).map(time).collect())
            }
            "USGS_ASTRO_PUSH_FRAME_SENSOR_MODEL" => self.framelet_times(),
            model => Err(self.value(
                "name_model",
                model,
                "USGS_ASTRO_FRAME_SENSOR_MODEL, USGS_ASTRO_LINE_SCANNER_SENSOR_MODEL, USGS_ASTRO_PUSH_FRAME_SENSOR_MODEL",
            )),
        }
    }

    /// With the mean time from one exposure to the next.
    fn shutter(&self, times: &[f64], framelet_rows: u32) -> Shutter {
        let [first, .., last] = *times else { return Shutter::Global };
        let (step_s, upwards) = ((last - first).abs() / (times.len() - 1) as f64, last < first);
        if framelet_rows == 1 {
            Shutter::LineScan { line_time_s: step_s, upwards }
        } else {
            Shutter::PushFrame { interval_s: step_s, framelet_rows, upwards }
        }
    }

    fn framelet_times(&self) -> Result<Vec<f64>, IsdError> {
        let isd = self.isd;
        let needed = |key, got: Option<f64>| got.ok_or_else(|| self.value(key, "nothing", "a number, in s"));
        let start_s = needed("starting_ephemeris_time", isd.starting_ephemeris_time)?;
        let exposure_s = needed("exposure_duration", isd.exposure_duration)?;
        let delay_s = needed("interframe_delay", isd.interframe_delay)?;
        let count = isd.image_lines / self.rows()?;
        let time = |k: u32| start_s + 0.5 * exposure_s + f64::from(k) * delay_s;
        let mut times: Vec<f64> = (0..count).map(time).collect();
        if isd.framelet_order_reversed {
            times.reverse();
        }
        Ok(times)
    }

    /// Of one exposure.
    fn rows(&self) -> Result<u32, IsdError> {
        let isd = self.isd;
        match isd.name_model.as_str() {
            "USGS_ASTRO_FRAME_SENSOR_MODEL" => Ok(isd.image_lines),
            "USGS_ASTRO_LINE_SCANNER_SENSOR_MODEL" => Ok(1),
            _ => {
                let height = f64::from(isd.framelet_height.unwrap_or(0)) / isd.detector_line_summing;
                let whole = height >= 1.0 && height.fract() == 0.0 && isd.image_lines.is_multiple_of(height as u32);
                if whole {
                    Ok(height as u32)
                } else {
                    Err(self.value("framelet_height", height, "a divisor of image_lines"))
                }
            }
        }
    }

    /// The optics of one exposure, and its axes (right, down, boresight) in the sensor's.
    fn optics(&self, sign: f64) -> Result<(Camera, DMat3), IsdError> {
        let isd = self.isd;
        let [s0, s1, s2] = isd.focal2pixel_samples;
        let [l0, l1, l2] = isd.focal2pixel_lines;
        let (samples, lines) = (DVec2::new(s1, s2), DVec2::new(l1, l2));
        let skew = samples.normalize_or_zero().dot(lines.normalize_or_zero());
        if !(samples.length() > 0.0 && lines.length() > 0.0 && skew.abs() < SKEW) {
            let got = format!("{samples} and samples {lines}");
            return Err(self.value("focal2pixel_lines", got, "perpendicular to focal2pixel_samples"));
        }
        let (right, forward) = (sign * samples.normalize().extend(0.0), DVec3::Z * sign);
        let down = forward.cross(right);
        let focal_mm = isd.focal_length_model.focal_length.abs();
        let focal_px = focal_mm
            * DVec2::new(samples.length() / isd.detector_sample_summing, lines.length() / isd.detector_line_summing);
        let scanner = isd.name_model == "USGS_ASTRO_LINE_SCANNER_SENSOR_MODEL";
        let rows = self.rows()?;
        let mut row = (isd.detector_center.line + l0 - isd.starting_detector_line) / isd.detector_line_summing;
        // A scanner's only line looks where line 0 of its detector does.
        row -= if scanner { 0.0 } else { 0.5 };
        let column =
            (isd.detector_center.sample + s0 - isd.starting_detector_sample) / isd.detector_sample_summing - 0.5;
        let camera = |source| IsdError::Camera { path: self.path.into(), source };
        let mut optics = Camera::pinhole(isd.image_samples, rows, focal_px)
            .map_err(camera)?
            .with_principal_point(DVec2::new(column, row));
        if (sign * lines.extend(0.0)).dot(down) < 0.0 {
            optics = optics.with_lines_upwards();
        }
        if isd.framelets_flipped {
            optics = optics.with_rows_turned_over();
        }
        // Focal-plane coordinates along the image's right and down.
        let across = samples.normalize();
        let in_image = |plane: DVec2| DVec2::new(across.dot(plane), sign * across.perp_dot(plane));
        if let Some(correction) = self.correction(focal_mm, &in_image)? {
            optics = optics.with_correction(correction).map_err(camera)?;
        }
        Ok((optics, DMat3::from_cols(right, down, forward)))
    }

    /// On the plane at distance 1; `None` where nothing is to be corrected.
    fn correction(&self, focal_mm: f64, in_image: &dyn Fn(DVec2) -> DVec2) -> Result<Option<Correction>, IsdError> {
        let (model, value) = match &self.isd.optical_distortion[..] {
            [] => return Ok(None),
            [(model, value)] => (model, value),
            [(model, _), (second, _), ..] => {
                return Err(self.value("optical_distortion", format!("{model} and {second}"), "one model"));
            }
        };
        let f2 = focal_mm * focal_mm;
        let correction = match Distortion::of(model, value) {
            Some(Distortion::Radial([k0, k1, k2])) => Correction::Radial([-k0, -k1 * f2, -k2 * f2 * f2, 0.0]),
            Some(Distortion::LroNac(k)) => Correction::AcrossTrack(k * f2),
            Some(Distortion::Kaguya { boresight, x: [a0, a1, a2, a3], y: [b0, b1, b2, b3] }) => {
                let (x0, y0) = (a0 + boresight[0], b0 + boresight[1]);
                let mm = [(x0, y0), (a1, b1), (a2, b2), (a3, b3)].map(|(x, y)| in_image(DVec2::new(x, y)));
                // A power of r in mm over one in focal lengths.
                Correction::Added(std::array::from_fn(|k| mm[k] * focal_mm.powi(k as i32 - 1)))
            }
            None => {
                let allowed = "radial with 3 coefficients, lrolrocnac with 1, kaguyalism with 4 for x and y each and a \
                               boresight_x and boresight_y; and no other key";
                return Err(self.value("optical_distortion", format!("{model}: {value}"), allowed));
            }
        };
        let nothing = matches!(correction, Correction::Radial(k) if k == [0.0; 4]);
        Ok((!nothing).then_some(correction))
    }

    fn body(&self) -> Result<Body, IsdError> {
        let Radii { semimajor, semiminor, unit } = &self.isd.radii;
        let unit_m = self.unit_m("radii.unit", unit)?;
        let (equatorial_radius_m, polar_radius_m) = (semimajor * unit_m, semiminor * unit_m);
        if !(1.0..=1e9).contains(&equatorial_radius_m) || !(1.0..=1e9).contains(&polar_radius_m) {
            return Err(self.value("radii", format!("{equatorial_radius_m} m, {polar_radius_m} m"), "[1, 1e9] m"));
        }
        let moon = Body::moon();
        let is_moon = (equatorial_radius_m, polar_radius_m) == (moon.equatorial_radius_m, moon.polar_radius_m);
        Ok(if is_moon { moon } else { Body { name: "body".into(), naif_id: 0, equatorial_radius_m, polar_radius_m } })
    }

    /// Body-fixed.
    fn position_m(&self, time: f64) -> Result<DVec3, IsdError> {
        let positions = &self.isd.instrument_position;
        Ok(self.isd.body_rotation.at(time)
            * (positions.at(time) * self.unit_m("instrument_position.unit", &positions.unit)?))
    }

    fn body_from_sensor(&self, time: f64) -> DMat3 {
        self.isd.body_rotation.at(time) * self.isd.instrument_pointing.at(time).transpose()
    }
}

#[cfg(test)]
mod tests;
