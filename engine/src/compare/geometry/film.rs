//! Frames of scanned film: a camera station with its axes, as JSON.
//!
//! ```text
//! v = (−p (s − s₀), p (l − l₀), −f)      towards the scene, in the camera's own axes, mm
//! direction = cam_to_moon_me · v
//! ```
//!
//! `s`, `l` count the samples and lines of the full scan, the first pixel's centre being 1; `p` is the scan's pitch,
//! `(s₀, l₀)` where the boresight meets it, `f` the focal length. The photograph is the whole scan reduced, or the part
//! of it that `alpha_cube_crop` describes, whichever has its size. A list holds many frames; the photograph's name
//! says which one is meant.
//!
//! `distortion` may quote an instrument kernel's polynomial, `OD_K=(k₁,k₂,k₃)`, from measured to ideal radius:
//! `r_ideal = r (1 + k₁ r² + k₂ r⁴ + k₃ r⁶)`, mm.
//!
//! # Assumptions
//! Principal-point offset and decentering of the kernel are left out: for the Apollo metric camera 0.006 mm and
//! 0.004 mm, 0.06 pixels of a scan of 1012.

use std::path::Path;

use glam::{DMat3, DVec2, DVec3};
use serde::Deserialize;

use super::{Geometry, sun};
use crate::camera::{Camera, Correction, Pose, PosedCamera};
use crate::compare::Error;
use crate::geometry::{Body, Position, Rotation};

/// A frame, as written.
#[derive(Debug, Clone, Deserialize)]
pub struct Frame {
    pub frame: String,
    #[serde(default)]
    pub image: Option<String>,
    pub image_size: [usize; 2],
    pub full_size: [f64; 2],
    pub camera_center_moon_me_m: [f64; 3],
    /// Row by row; its columns are the camera's axes in MOON_ME.
    pub cam_to_moon_me: [[f64; 3]; 3],
    pub sun_moon_me_m: [f64; 3],
    pub focal_mm: f64,
    pub pixel_pitch_mm: f64,
    pub boresight_sample_line: [f64; 2],
    #[serde(default)]
    pub distortion: Option<String>,
    #[serde(default)]
    pub alpha_cube_crop: Option<Crop>,
}

/// A part of the scan: edges in samples and lines of the whole, and the pixels it was reduced to.
#[derive(Debug, Clone, Deserialize)]
pub struct Crop {
    pub starting_sample: f64,
    pub starting_line: f64,
    pub ending_sample: f64,
    pub ending_line: f64,
    pub size: [usize; 2],
}

/// The geometry of a photograph of `size` pixels from one frame or the fitting one of a list.
pub fn geometry(path: &Path, json: serde_json::Value, photo: &Path, size: [usize; 2]) -> Result<Geometry, Error> {
    let written = if json.is_array() { json } else { serde_json::Value::Array(vec![json]) };
    let frames: Vec<Frame> =
        serde_json::from_value(written).map_err(|source| Error::Geometry { path: path.into(), source })?;
    let name = photo.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let is_meant = |frame: &&Frame| frame.image.as_ref() == Some(&name) || name.starts_with(&frame.frame);
    let alone = (frames.len() == 1).then(|| &frames[0]);
    let frame = frames.iter().find(is_meant).or(alone).ok_or_else(|| Error::NoSuchFrame {
        path: path.into(),
        photo: name.clone(),
        there: frames.iter().map(|frame| frame.frame.clone()).collect(),
    })?;
    frame.check(path)?;
    let body = Body::moon();
    let camera = PosedCamera { optics: frame.optics(photo, size)?, poses: vec![frame.pose()] };
    let source = format!("frame {} of {}", frame.frame, path.file_name().unwrap_or_default().to_string_lossy());
    Ok(Geometry { body, camera, lights: vec![sun(Position::from_m(frame.sun_moon_me_m.into()))], source })
}

impl Frame {
    fn check(&self, path: &Path) -> Result<(), Error> {
        let value = |key: &str, got: String, allowed| Error::Value { path: path.into(), key: key.into(), got, allowed };
        let axes = self.axes();
        let off =
            (axes * axes.transpose() - DMat3::IDENTITY).to_cols_array().iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        if !(off < 1e-6 && axes.determinant() > 0.0) {
            return Err(value("cam_to_moon_me", format!("{:?}", self.cam_to_moon_me), "a rotation, within 1e-6"));
        }
        let positive = [("focal_mm", self.focal_mm), ("pixel_pitch_mm", self.pixel_pitch_mm)];
        if let Some((key, got)) = positive.into_iter().find(|(_, got)| !(1e-4..=1e5).contains(got)) {
            return Err(value(key, got.to_string(), "[1e-4, 1e5] mm"));
        }
        let sun_m = DVec3::from(self.sun_moon_me_m).length();
        if !(1e9..=1e13).contains(&sun_m) {
            return Err(value("sun_moon_me_m", format!("{sun_m:e} m from the Moon"), "[1e9, 1e13] m"));
        }
        Ok(())
    }

    fn axes(&self) -> DMat3 {
        DMat3::from_cols_array_2d(&self.cam_to_moon_me).transpose()
    }

    fn pose(&self) -> Pose {
        let axes = self.axes();
        // Ours: right is −x, down is y, the boresight −z.
        let camera_from_body = Rotation::from_axes(-axes.x_axis, axes.y_axis, -axes.z_axis);
        Pose { position: Position::from_m(self.camera_center_moon_me_m.into()), camera_from_body }
    }

    fn optics(&self, photo: &Path, size: [usize; 2]) -> Result<Camera, Error> {
        let whole = (self.image_size == size).then(|| (DVec2::splat(0.5), DVec2::from(self.full_size)));
        let part = self.alpha_cube_crop.as_ref().filter(|crop| crop.size == size).map(|crop| {
            let start = DVec2::new(crop.starting_sample, crop.starting_line);
            (start, DVec2::new(crop.ending_sample, crop.ending_line) - start)
        });
        let Some((start, extent)) = whole.or(part) else {
            let sizes = std::iter::once(self.image_size).chain(self.alpha_cube_crop.iter().map(|crop| crop.size));
            let allowed = sizes.map(|[columns, rows]| format!("{columns} x {rows}")).collect();
            return Err(Error::Size { photo: photo.into(), columns: size[0], rows: size[1], allowed });
        };
        let pixels_per_sample = DVec2::new(size[0] as f64, size[1] as f64) / extent;
        let principal_px = (DVec2::from(self.boresight_sample_line) - start) * pixels_per_sample - 0.5;
        let focal_px = self.focal_mm / self.pixel_pitch_mm * pixels_per_sample;
        let optics = Camera::pinhole(size[0] as u32, size[1] as u32, focal_px)?.with_principal_point(principal_px);
        match self.distortion.as_deref().and_then(radial_mm) {
            Some(k) => Ok(optics.with_correction(Correction::radial_mm(k, self.focal_mm))?),
            None => Ok(optics),
        }
    }
}

/// `k₁, k₂, k₃` of `OD_K=(…)`, in powers of mm⁻².
fn radial_mm(text: &str) -> Option<[f64; 3]> {
    let (_, rest) = text.split_once("OD_K=(")?;
    let (inside, _) = rest.split_once(')')?;
    let numbers: Vec<f64> = inside.split(',').map_while(|number| number.trim().parse().ok()).collect();
    numbers.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kernels_polynomial_is_found_in_its_quotation() {
        let text = "IAK PP=(-0.006,-0.002) mm, OD_K=(-0.13361854e-5,0.52261757e-9,-0.50728336e-13), DECENTER=(1,2,3)";
        assert_eq!(radial_mm(text), Some([-0.13361854e-5, 0.52261757e-9, -0.50728336e-13]));
        assert_eq!(radial_mm("none"), None);
    }
}
