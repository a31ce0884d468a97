//! Ellipses of an image, and the conics that say the same.
//!
//! A point `p = (u, v, 1)` of the image, in pixels, lies on the conic `A` where `pᵀ A p = 0`. Here `A` is symmetric and scaled
//! so that
//!
//! ```text
//! pᵀ A p = x²/a² + y²/b² − 1        x, y along the axes from the centre
//! ```
//!
//! : −1 in the centre, negative inside. The angle turns from +u (right) towards +v (down), as OpenCV's does.
//!
//! The unit circle of a plane whose point `(ξ, η, 1)` the camera sees at `H (ξ, η, 1)ᵀ` appears as
//!
//! ```text
//! A ∝ H⁻ᵀ diag(1, 1, −1) H⁻¹
//! ```
//!
//! # References
//! Christian, Derksen & Watkins (2021), J. Astronaut. Sci. 68, 1056, doi:10.1007/s40295-021-00287-8, equation 47 ff.

use std::f64::consts::PI;

use glam::{DMat2, DMat3, DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// A symmetric matrix, row by row, scaled as above.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Conic(pub [[f64; 3]; 3]);

/// An ellipse in pixels; the centre of the image's first pixel is (0, 0).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ellipse {
    pub centre_px: [f64; 2],
    /// The longer one first.
    pub semi_axes_px: [f64; 2],
    /// Of the longer one, from right towards down, 0 to π.
    pub angle_rad: f64,
}

impl Conic {
    fn matrix(&self) -> DMat3 {
        DMat3::from_cols_array_2d(&self.0)
    }

    /// Less than 0 inside, −1 in the centre.
    pub fn value(&self, pixel: DVec2) -> f64 {
        let p = pixel.extend(1.0);
        p.dot(self.matrix() * p)
    }

    /// The same in parameters; `None` where rounding has made it none, as of an ellipse that is all but a line.
    pub fn ellipse(&self) -> Option<Ellipse> {
        Ellipse::of(self.matrix())
    }
}

impl From<&Ellipse> for Conic {
    fn from(ellipse: &Ellipse) -> Self {
        let centre = DVec2::from(ellipse.centre_px);
        let along = DVec2::from_angle(ellipse.angle_rad) / ellipse.semi_axes_px[0];
        let across = DVec2::from_angle(ellipse.angle_rad).perp() / ellipse.semi_axes_px[1];
        // The sum of two squares of linear forms, less 1.
        let [along, across] = [along, across].map(|form| form.extend(-form.dot(centre)));
        let outer = |form: DVec3| DMat3::from_cols(form * form.x, form * form.y, form * form.z);
        let unit = DMat3::from_cols(DVec3::ZERO, DVec3::ZERO, DVec3::Z);
        Self((outer(along) + outer(across) - unit).to_cols_array_2d())
    }
}

impl Ellipse {
    /// How the unit circle of a plane appears. `None` where that is no ellipse, or the plane is seen from its side.
    pub fn of_circle(image_from_plane: DMat3) -> Option<Self> {
        // About the image of the plane's origin, far from which small ellipses would lose their digits.
        let origin = image_from_plane.z_axis.truncate() / image_from_plane.z_axis.z;
        let about = DMat3::from_cols(DVec3::X, DVec3::Y, (-origin).extend(1.0)) * image_from_plane;
        if about.determinant() == 0.0 {
            return None;
        }
        let inverse = about.inverse();
        let conic = inverse.transpose() * DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0)) * inverse;
        let ellipse = Self::of(conic)?;
        Some(Self { centre_px: (DVec2::from(ellipse.centre_px) + origin).into(), ..ellipse })
    }

    /// The ellipse of a conic of any scale; `None` where it is a parabola, a hyperbola, or empty.
    fn of(conic: DMat3) -> Option<Self> {
        let quadratic = DMat2::from_cols(conic.x_axis.truncate(), conic.y_axis.truncate());
        let linear = conic.z_axis.truncate();
        if quadratic.determinant() <= 0.0 {
            return None;
        }
        let centre = -(quadratic.inverse() * linear);
        // The value in the centre; about it the conic is (p − c)ᵀ Q (p − c) = −value.
        let value = linear.dot(centre) + conic.z_axis.z;
        let [xx, xy, yy] = [quadratic.x_axis.x, quadratic.x_axis.y, quadratic.y_axis.y].map(|element| -element / value);
        let (mean, half) = ((xx + yy) / 2.0, ((xx - yy) / 2.0).hypot(xy));
        let [longest, shortest] = [mean - half, mean + half];
        if !(longest > 0.0 && shortest.is_finite()) {
            return None;
        }
        // The axis of the smaller eigenvalue; of a circle any.
        let angle_rad = if half > 0.0 { 0.5 * (-2.0 * xy).atan2(yy - xx) } else { 0.0 };
        Some(Self {
            centre_px: centre.into(),
            semi_axes_px: [longest, shortest].map(|value| value.sqrt().recip()),
            angle_rad: angle_rad.rem_euclid(PI),
        })
    }

    /// What an affine map `linear p + offset` makes of it.
    pub fn moved(&self, linear: DMat2, offset: DVec2) -> Option<Self> {
        let centre_px = (linear * DVec2::from(self.centre_px) + offset).into();
        let about = Conic::from(&Self { centre_px: [0.0; 2], ..*self }).matrix();
        let back = DMat3::from_mat2(linear.inverse());
        Some(Self { centre_px, ..Self::of(back.transpose() * about * back)? })
    }

    /// The point at an angle of the circle that the ellipse is a squeezed one of.
    pub fn at(&self, turn_rad: f64) -> DVec2 {
        let [a, b] = self.semi_axes_px;
        let (sin, cos) = turn_rad.sin_cos();
        DVec2::from(self.centre_px) + DVec2::from_angle(self.angle_rad).rotate(DVec2::new(a * cos, b * sin))
    }

    /// The smallest upright rectangle that holds it.
    pub fn bounds_px(&self) -> [DVec2; 2] {
        let [a, b] = self.semi_axes_px;
        let (sin, cos) = self.angle_rad.sin_cos();
        let half = DVec2::new((a * cos).hypot(b * sin), (a * sin).hypot(b * cos));
        [DVec2::from(self.centre_px) - half, DVec2::from(self.centre_px) + half]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ELLIPSE: Ellipse = Ellipse { centre_px: [310.5, 87.25], semi_axes_px: [40.0, 12.5], angle_rad: 2.1 };

    #[test]
    fn an_ellipse_comes_back_from_its_conic() {
        let back = Conic::from(&ELLIPSE).ellipse().unwrap();
        assert!((DVec2::from(back.centre_px) - DVec2::from(ELLIPSE.centre_px)).length() < 1e-9, "{back:?}");
        assert!((back.semi_axes_px[0] - 40.0).abs() < 1e-9 && (back.semi_axes_px[1] - 12.5).abs() < 1e-9, "{back:?}");
        assert!((back.angle_rad - 2.1).abs() < 1e-12, "{back:?}");
    }

    /// The definition, with the axes turned by hand: from right towards down.
    #[test]
    fn the_conic_is_the_ellipses_equation() {
        let conic = Conic::from(&ELLIPSE);
        let (sin, cos) = 2.1f64.sin_cos();
        for (x, y, expected) in [(0.0, 0.0, -1.0), (40.0, 0.0, 0.0), (0.0, 12.5, 0.0), (80.0, 0.0, 3.0)] {
            let pixel = DVec2::new(310.5 + x * cos - y * sin, 87.25 + x * sin + y * cos);
            assert!((conic.value(pixel) - expected).abs() < 1e-9, "{x} {y}: {}", conic.value(pixel));
        }
    }

    /// A crater of 1 px in width and a thousandth of that in height, 10⁵ px off the image.
    #[test]
    fn thin_ellipses_far_away_keep_their_digits() {
        let shift = DVec2::new(1e5, -2e4);
        let plane = DMat3::from_cols(DVec3::new(0.5, 0.0, 0.0), DVec3::new(0.0, 5e-4, 0.0), shift.extend(1.0));
        let ellipse = Ellipse::of_circle(plane).unwrap();
        assert_eq!(ellipse.centre_px, [1e5, -2e4]);
        assert!((ellipse.semi_axes_px[0] - 0.5).abs() < 1e-9 && (ellipse.semi_axes_px[1] - 5e-4).abs() < 1e-9);
    }

    #[test]
    fn bounds_touch_the_ellipse() {
        let points: Vec<DVec2> = (0..3600).map(|k| ELLIPSE.at(f64::from(k) * PI / 1800.0)).collect();
        let low = points.iter().copied().reduce(DVec2::min).unwrap();
        let high = points.iter().copied().reduce(DVec2::max).unwrap();
        // A tenth of a degree on 40 px: 40 (0.1°)²/8.
        assert!((ELLIPSE.bounds_px()[0] - low).abs().max_element() < 2e-5);
        assert!((ELLIPSE.bounds_px()[1] - high).abs().max_element() < 2e-5);
    }

    #[test]
    fn a_plane_seen_from_its_side_has_no_ellipse() {
        let flat = DMat3::from_cols(DVec3::X, 2.0 * DVec3::X, DVec3::Z);
        assert_eq!(Ellipse::of_circle(flat), None);
        // The circle crosses the horizon of the image: a hyperbola.
        let steep = DMat3::from_cols(DVec3::X, DVec3::new(0.0, 0.0, 2.0), DVec3::new(0.0, 1.0, 1.0));
        assert_eq!(Ellipse::of_circle(steep), None);
    }
}
