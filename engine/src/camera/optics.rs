//! Pixels and directions, solid angles, and the light on the focal plane.
//!
//! OpenCV's conventions: +x right, +y down, +z along the boresight; integer pixel coordinates are pixel centres,
//! so that the image reaches from −0.5 to `columns − 0.5`.
//!
//! ```text
//! (u, v) = principal + focal · distort(x/z, y/z)        E = π τ v L / (4 N²)
//! v = cos⁴θ,   or 1 + a₂ρ² + a₄ρ⁴ + a₆ρ⁶,  ρ = distance from the principal point over half the image's diagonal
//! ```
//!
//! # Assumptions
//! - No skew. Objects are far away, the stop is in the lens.
//! - A pixel's edges are great circles between its corners.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::{CameraError, Correction, Distortion, check};
use crate::geometry::{self, Direction};

/// A camera's geometry and lens.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    pub columns: u32,
    pub rows: u32,
    /// Focal length over pixel pitch.
    pub focal_px: DVec2,
    /// Where the boresight meets the image.
    pub principal_px: DVec2,
    pub f_number: f64,
    /// Share of the light that passes the lens.
    pub transmission: f64,
    vignetting: Vignetting,
    /// Half the image's diagonal when the vignetting was given: parts of an image darken as the whole does.
    half_diagonal_px: f64,
    lens: Lens,
    /// Radius on the plane z = 1 beyond which nothing is seen.
    largest_radius: f64,
}

/// How the focal plane darkens towards the image's edge.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Vignetting {
    /// By the fourth power of the cosine of the angle with the boresight.
    #[default]
    Cos4,
    /// Not at all: the lens, or a calibration, has evened it out.
    None,
    /// By a measured polynomial, in place of the fourth power: `a₂`, `a₄`, `a₆`.
    Polynomial([f64; 3]),
}

/// What the lens does to the image.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Lens {
    Ideal,
    /// From ideal to measured.
    Distorts(Distortion),
    /// From measured to ideal.
    Corrected(Correction),
}

impl Camera {
    /// A pinhole with the boresight in the image's centre, f-number 1, a lens that loses nothing.
    pub fn pinhole(columns: u32, rows: u32, focal_px: DVec2) -> Result<Self, CameraError> {
        for size in [columns, rows] {
            check("camera size", f64::from(size), 1.0..=65536.0, "[1, 65536] px")?;
        }
        for focal in [focal_px.x, focal_px.y] {
            check("camera focal length", focal, 1e-1..=1e8, "[0.1, 1e8] px")?;
        }
        let principal_px = (DVec2::new(f64::from(columns), f64::from(rows)) - 1.0) / 2.0;
        let largest_radius = f64::INFINITY;
        Ok(Self {
            columns,
            rows,
            focal_px,
            principal_px,
            f_number: 1.0,
            transmission: 1.0,
            vignetting: Vignetting::Cos4,
            half_diagonal_px: 0.5 * f64::from(columns).hypot(f64::from(rows)),
            lens: Lens::Ideal,
            largest_radius,
        })
    }

    pub fn from_focal_length(
        columns: u32,
        rows: u32,
        focal_length_m: f64,
        pixel_pitch_m: f64,
    ) -> Result<Self, CameraError> {
        check("camera focal length", focal_length_m, 1e-4..=1e3, "[1e-4, 1e3] m")?;
        check("camera pixel pitch", pixel_pitch_m, 1e-7..=1e-2, "[1e-7, 1e-2] m")?;
        Self::pinhole(columns, rows, DVec2::splat(focal_length_m / pixel_pitch_m))
    }

    /// With square pixels; `width_rad` is the angle from the left edge of the image to its right edge.
    pub fn from_field_of_view(columns: u32, rows: u32, width_rad: f64) -> Result<Self, CameraError> {
        check("camera field of view", width_rad.to_degrees(), 1e-6..=179.0, "[1e-6, 179] deg")?;
        Self::pinhole(columns, rows, DVec2::splat(f64::from(columns) / 2.0 / (width_rad / 2.0).tan()))
    }

    pub fn with_principal_point(self, principal_px: DVec2) -> Self {
        Self { principal_px, ..self }
    }

    pub fn with_lens(self, f_number: f64, transmission: f64) -> Result<Self, CameraError> {
        check("camera f-number", f_number, 0.5..=1e3, "[0.5, 1000]")?;
        check("camera transmission", transmission, 0.0..=1.0, "[0, 1]")?;
        Ok(Self { f_number, transmission, ..self })
    }

    /// Refuses a polynomial that brightens the image by half, or darkens it below nothing. Call it after
    /// [`Camera::with_principal_point`].
    pub fn with_vignetting(self, vignetting: Vignetting) -> Result<Self, CameraError> {
        let camera = Self { vignetting, ..self };
        let [right, bottom] = [camera.columns, camera.rows].map(|size| f64::from(size) - 0.5);
        for corner in [[-0.5, -0.5], [right, -0.5], [-0.5, bottom], [right, bottom]] {
            for share in (1..=32).map(|step| f64::from(step) / 32.0) {
                let pixel = camera.principal_px.lerp(corner.into(), share);
                if let Vignetting::Polynomial(_) = vignetting
                    && let got = camera.brightness(pixel, 1.0)
                    && !(0.0..=1.5).contains(&got)
                {
                    return Err(CameraError::Vignetting { got, corner_px: pixel.to_array() });
                }
            }
        }
        Ok(camera)
    }

    /// Refuses a distortion that folds back inside the image. Call it last: the image's corners are checked.
    pub fn with_distortion(self, distortion: Distortion) -> Result<Self, CameraError> {
        let camera = Self { lens: Lens::Distorts(distortion), largest_radius: distortion.largest_radius(), ..self };
        let [right, bottom] = [camera.columns, camera.rows].map(|size| f64::from(size) - 0.5);
        for corner in [[-0.5, -0.5], [right, -0.5], [-0.5, bottom], [right, bottom]] {
            if camera.direction(corner.into()).is_none() {
                let largest_rad = camera.largest_radius.atan();
                return Err(CameraError::Folds { largest_rad, corner_px: corner });
            }
        }
        Ok(camera)
    }

    /// With a distortion that is known from measured to ideal points. Refuses one without an inverse at the image's
    /// corners: call it last.
    pub fn with_correction(self, correction: Correction) -> Result<Self, CameraError> {
        let camera = Self { lens: Lens::Corrected(correction), ..self };
        let [right, bottom] = [camera.columns, camera.rows].map(|size| f64::from(size) - 0.5);
        for corner in [[-0.5, -0.5], [right, -0.5], [-0.5, bottom], [right, bottom]] {
            let ideal = correction.ideal((DVec2::from(corner) - camera.principal_px) / camera.focal_px);
            if correction.measured(ideal).is_none() {
                return Err(CameraError::Folds { largest_rad: ideal.length().atan(), corner_px: corner });
            }
        }
        Ok(camera)
    }

    /// The distortion that is known from measured to ideal points, where there is one.
    pub fn correction(&self) -> Option<Correction> {
        match self.lens {
            Lens::Corrected(correction) => Some(correction),
            Lens::Ideal | Lens::Distorts(_) => None,
        }
    }

    /// With rows counted towards −y of the same axes: scanners whose lines run against their motion.
    pub fn with_lines_upwards(self) -> Self {
        Self { focal_px: self.focal_px * DVec2::new(1.0, -1.0), ..self }
    }

    /// With the last row first.
    pub fn with_rows_turned_over(self) -> Self {
        let principal_px = DVec2::new(self.principal_px.x, f64::from(self.rows) - 1.0 - self.principal_px.y);
        Self { principal_px, ..self }.with_lines_upwards()
    }

    /// The same field of view in other pixels.
    pub fn resized(&self, columns: u32, rows: u32) -> Self {
        let scale = DVec2::new(f64::from(columns) / f64::from(self.columns), f64::from(rows) / f64::from(self.rows));
        let principal_px = (self.principal_px + 0.5) * scale - 0.5;
        let half_diagonal_px = self.half_diagonal_px * (scale.x * scale.y).sqrt();
        Self { columns, rows, focal_px: self.focal_px * scale, principal_px, half_diagonal_px, ..self.clone() }
    }

    /// The part of the focal plane with `columns` and `rows` from `[column, row]` on, which may lie beyond the image.
    pub fn part(&self, [column, row]: [i64; 2], columns: u32, rows: u32) -> Self {
        let principal_px = self.principal_px - DVec2::new(column as f64, row as f64);
        Self { columns, rows, principal_px, ..self.clone() }
    }

    /// Where a pixel coordinate looks; `None` where the distortion has no inverse.
    pub fn direction(&self, pixel: DVec2) -> Option<Direction<geometry::Camera>> {
        let distorted = (pixel - self.principal_px) / self.focal_px;
        let plane = match &self.lens {
            Lens::Ideal => distorted,
            Lens::Distorts(distortion) => distortion.undistort(distorted, self.largest_radius)?,
            Lens::Corrected(correction) => correction.ideal(distorted),
        };
        Direction::new(plane.extend(1.0))
    }

    /// Where a direction falls; `None` behind the camera and where the distortion would fold. May lie off the image.
    pub fn pixel(&self, direction: Direction<geometry::Camera>) -> Option<DVec2> {
        let d = direction.unit();
        let plane = d.truncate() / d.z;
        if d.z <= 0.0 || plane.length() > self.largest_radius {
            return None;
        }
        let distorted = match &self.lens {
            Lens::Ideal => plane,
            Lens::Distorts(distortion) => distortion.distort(plane),
            Lens::Corrected(correction) => correction.measured(plane)?,
        };
        Some(self.principal_px + self.focal_px * distorted)
    }

    /// Whether a pixel coordinate lies on the image, its outer edges included.
    pub fn contains(&self, pixel: DVec2) -> bool {
        let size = DVec2::new(f64::from(self.columns), f64::from(self.rows));
        pixel.cmpge(DVec2::splat(-0.5)).all() && pixel.cmple(size - 0.5).all()
    }

    /// Solid angle of the pixel about `pixel`, in steradians.
    pub fn solid_angle_sr(&self, pixel: DVec2) -> Option<f64> {
        let corner = |x: f64, y: f64| self.direction(pixel + DVec2::new(x, y)).map(Direction::unit);
        let (a, b) = (corner(-0.5, -0.5)?, corner(0.5, -0.5)?);
        let (c, d) = (corner(0.5, 0.5)?, corner(-0.5, 0.5)?);
        Some(triangle_sr(a, b, c) + triangle_sr(a, c, d))
    }

    /// Irradiance of the focal plane per radiance of the scene, in steradians.
    pub fn irradiance_per_radiance_sr(&self, pixel: DVec2) -> Option<f64> {
        let cosine = self.direction(pixel)?.unit().z;
        Some(PI * self.transmission * self.brightness(pixel, cosine) / (4.0 * self.f_number * self.f_number))
    }

    /// The focal plane's brightness over that at the boresight.
    fn brightness(&self, pixel: DVec2, cosine: f64) -> f64 {
        match self.vignetting {
            Vignetting::Cos4 => cosine.powi(4),
            Vignetting::None => 1.0,
            Vignetting::Polynomial([a2, a4, a6]) => {
                let square = (pixel - self.principal_px).length_squared() / self.half_diagonal_px.powi(2);
                1.0 + square * (a2 + square * (a4 + square * a6))
            }
        }
    }
}

/// Solid angle of a spherical triangle; from differences, since corners of a pixel share most of their digits.
///
/// # References
/// Van Oosterom & Strackee (1983), IEEE Trans. Biomed. Eng. 30, 125.
fn triangle_sr(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let volume = a.dot((b - a).cross(c - a)).abs();
    2.0 * volume.atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// OSIRIS-REx NavCam1, instrument kernel addendum v6, without its skew of 2e-5 px.
    fn navcam() -> Camera {
        let distortion =
            Distortion { radial: [-0.53766, 0.37526, -0.18368, 0.0, 0.0, 0.0], tangential: [2.3432e-4, 9.0875e-4] };
        Camera::pinhole(2592, 1944, DVec2::new(3473.260, 3473.321))
            .unwrap()
            .with_principal_point(DVec2::new(1269.083, 950.747))
            .with_distortion(distortion)
            .unwrap()
    }

    #[test]
    fn pixels_and_directions_round_trip_to_a_millionth_of_a_pixel() {
        let camera = navcam();
        for row in 0..=40 {
            for column in 0..=40 {
                let pixel = DVec2::new(f64::from(column) * 2592.0, f64::from(row) * 1944.0) / 40.0 - 0.5;
                let back = camera.pixel(camera.direction(pixel).unwrap()).unwrap();
                assert!((back - pixel).length() < 1e-6, "{pixel} {back}");
            }
        }
    }

    /// Written out once more from OpenCV's documentation, for one point.
    #[test]
    fn distortion_is_opencvs() {
        let (x, y): (f64, f64) = (0.2, -0.1);
        let r2 = x * x + y * y;
        let radial = 1.0 - 0.53766 * r2 + 0.37526 * r2 * r2 - 0.18368 * r2 * r2 * r2;
        let (p1, p2) = (2.3432e-4, 9.0875e-4);
        let u = 3473.260 * (x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)) + 1269.083;
        let v = 3473.321 * (y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y) + 950.747;
        let pixel = navcam().pixel(Direction::new(DVec3::new(x, y, 1.0)).unwrap()).unwrap();
        assert!((pixel - DVec2::new(u, v)).length() < 1e-9, "{pixel}");
    }

    #[test]
    fn what_is_behind_or_beyond_the_fold_is_not_seen() {
        let camera = navcam();
        assert_eq!(camera.pixel(Direction::new(DVec3::new(0.0, 0.0, -1.0)).unwrap()), None);
        assert_eq!(camera.pixel(Direction::new(DVec3::X).unwrap()), None);
        let fold = camera.largest_radius;
        assert!(camera.pixel(Direction::new(DVec3::new(0.999 * fold, 0.0, 1.0)).unwrap()).is_some());
        assert_eq!(camera.pixel(Direction::new(DVec3::new(1.001 * fold, 0.0, 1.0)).unwrap()), None);
    }

    #[test]
    fn a_distortion_that_folds_inside_the_image_is_refused() {
        let strong = Distortion { radial: [-2.0, 0.0, 0.0, 0.0, 0.0, 0.0], ..Default::default() };
        let wide = Camera::from_field_of_view(1024, 1024, 1.2).unwrap();
        assert!(matches!(wide.with_distortion(strong), Err(CameraError::Folds { .. })));
    }

    #[test]
    fn the_boresight_is_the_image_centre_and_plus_y_is_down() {
        let camera = Camera::from_field_of_view(1024, 768, 0.5).unwrap();
        let centre = camera.direction(DVec2::new(511.5, 383.5)).unwrap();
        assert_eq!(centre.unit(), DVec3::Z);
        assert!(camera.direction(DVec2::new(511.5, 500.0)).unwrap().unit().y > 0.0);
        let [left, right] = [-0.5, 1023.5].map(|x| camera.direction(DVec2::new(x, 383.5)).unwrap());
        assert!((left.angle_to(right) - 0.5).abs() < 1e-14);
    }

    /// A rectangular pyramid spans 4 asin(ab/√((1+a²)(1+b²))), a and b the tangents of its half-angles.
    #[test]
    fn solid_angles_of_all_pixels_add_up_to_the_field_of_view() {
        let camera = Camera::from_field_of_view(64, 48, 1.0).unwrap();
        let (a, b) = (0.5f64.tan(), 0.5f64.tan() * 48.0 / 64.0);
        let field_sr = 4.0 * (a * b / ((1.0 + a * a) * (1.0 + b * b)).sqrt()).asin();
        let pixels = (0..48).flat_map(|row| (0..64).map(move |column| DVec2::new(f64::from(column), f64::from(row))));
        let sum_sr: f64 = pixels.map(|pixel| camera.solid_angle_sr(pixel).unwrap()).sum();
        assert!((sum_sr / field_sr - 1.0).abs() < 1e-13, "{sum_sr} {field_sr}");
    }

    /// A pixel of 1e-5 rad keeps 10 digits of its 1e-10 sr.
    #[test]
    fn a_narrow_pixel_keeps_its_digits() {
        let camera = Camera::pinhole(101, 101, DVec2::splat(1e5)).unwrap();
        assert!((camera.solid_angle_sr(DVec2::splat(50.0)).unwrap() / 1e-10 - 1.0).abs() < 1e-10);
    }

    /// LROC NAC: f/3.577, 0.8 transmission, 9.68 W m⁻² sr⁻¹ give 0.475 W/m²; off axis cos⁴θ less.
    #[test]
    fn the_focal_plane_gets_what_the_lens_passes() {
        let camera = Camera::from_field_of_view(100, 100, 1.0).unwrap().with_lens(3.577, 0.8).unwrap();
        let centre = camera.irradiance_per_radiance_sr(DVec2::splat(49.5)).unwrap();
        assert!((9.68 * centre - 0.475).abs() < 5e-4, "{centre}");
        let edge = camera.irradiance_per_radiance_sr(DVec2::new(-0.5, 49.5)).unwrap();
        assert!((edge / centre - 0.5f64.cos().powi(4)).abs() < 1e-14);
    }

    /// The polynomial is written out once more for one point; a part of the image darkens as the whole does.
    #[test]
    fn a_measured_vignetting_takes_the_place_of_the_fourth_power() {
        let lens = Vignetting::Polynomial([-0.3, 0.1, -0.05]);
        let camera = Camera::from_field_of_view(80, 60, 1.0).unwrap().with_vignetting(lens).unwrap();
        let at = |camera: &Camera, x, y| camera.irradiance_per_radiance_sr(DVec2::new(x, y)).unwrap();
        let square = (39.5f64.powi(2) + 29.5f64.powi(2)) / 50.0f64.powi(2);
        let expected = PI / 4.0 * (1.0 - 0.3 * square + 0.1 * square.powi(2) - 0.05 * square.powi(3));
        assert!((at(&camera, 0.0, 0.0) - expected).abs() < 1e-14);
        assert_eq!(at(&camera.part([0, 40], 80, 1), 3.0, 0.0), at(&camera, 3.0, 40.0));
        assert!((at(&camera.resized(160, 120), 0.5, 0.5) - at(&camera, 0.0, 0.0)).abs() < 1e-14);
        let even = camera.clone().with_vignetting(Vignetting::None).unwrap();
        assert_eq!(at(&even, 0.0, 0.0), PI / 4.0);
        assert!(matches!(
            camera.with_vignetting(Vignetting::Polynomial([-1.2, 0.0, 0.0])),
            Err(CameraError::Vignetting { .. })
        ));
    }

    #[test]
    fn impossible_cameras_are_named() {
        let error = Camera::from_focal_length(10, 10, -0.05, 5e-6).unwrap_err();
        assert_eq!(error.to_string(), "camera focal length = -0.05 is outside [1e-4, 1e3] m");
        assert!(Camera::pinhole(0, 10, DVec2::ONE).is_err());
        assert!(Camera::pinhole(10, 10, DVec2::NAN).is_err());
        assert!(Camera::from_field_of_view(10, 10, 3.2).is_err());
    }
}
