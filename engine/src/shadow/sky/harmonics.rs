//! Real spherical harmonics of orders 0 to 3: 16 numbers that stand for a smooth function of direction.
//!
//! Orthonormal over the sphere; number `l² + l + m` belongs to degree `l` and order `m`.
//!
//! # References
//! Sloan, Kautz & Snyder (2002), Precomputed radiance transfer; Ramamoorthi & Hanrahan (2001), On the relationship
//! between radiance and irradiance, for the clamped cosine.

use std::f64::consts::{PI, TAU};
use std::ops::{Add, Mul};

use glam::DVec3;

use crate::photometry::quadrature::gauss_legendre;

/// Coefficients of the 16 harmonics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonics(pub [f64; 16]);

impl Harmonics {
    pub const ZERO: Self = Self([0.0; 16]);

    /// The harmonics in a unit direction: also the coefficients of the sharpest light from there.
    pub fn towards(d: DVec3) -> Self {
        let DVec3 { x, y, z } = d;
        let (xx, yy, zz) = (x * x, y * y, z * z);
        Self([
            0.282_094_791_773_878_14,
            0.488_602_511_902_919_9 * y,
            0.488_602_511_902_919_9 * z,
            0.488_602_511_902_919_9 * x,
            1.092_548_430_592_079_2 * x * y,
            1.092_548_430_592_079_2 * y * z,
            0.315_391_565_252_520_05 * (3.0 * zz - 1.0),
            1.092_548_430_592_079_2 * x * z,
            0.546_274_215_296_039_6 * (xx - yy),
            0.590_043_589_926_643_5 * y * (3.0 * xx - yy),
            2.890_611_442_640_554 * x * y * z,
            0.457_045_799_464_465_8 * y * (5.0 * zz - 1.0),
            0.373_176_332_590_115_4 * z * (5.0 * zz - 3.0),
            0.457_045_799_464_465_8 * x * (5.0 * zz - 1.0),
            1.445_305_721_320_277 * z * (xx - yy),
            0.590_043_589_926_643_5 * x * (xx - 3.0 * yy),
        ])
    }

    /// `max(n·d, 0)` of a facet of unit normal `n`.
    pub fn clamped_cosine(normal: DVec3) -> Self {
        // Zonal coefficients of the clamped cosine times √(4π/(2l + 1)).
        let of_degree = [PI, 2.0 * PI / 3.0, PI / 4.0, 0.0];
        let Self(mut values) = Self::towards(normal);
        values.iter_mut().zip(DEGREES).for_each(|(value, degree)| *value *= of_degree[degree]);
        Self(values)
    }

    /// The function turned about z by an angle from x towards y.
    pub fn turned(&self, angle_rad: f64) -> Self {
        let mut turned = *self;
        for degree in 1..4usize {
            for order in 1..=degree {
                let (middle, (sin, cos)) = (degree * degree + degree, (order as f64 * angle_rad).sin_cos());
                let [plus, minus] = [self.0[middle + order], self.0[middle - order]];
                turned.0[middle + order] = cos * plus - sin * minus;
                turned.0[middle - order] = sin * plus + cos * minus;
            }
        }
        turned
    }

    /// The integral of the product of two functions over the sphere.
    pub fn dot(&self, other: &Self) -> f64 {
        self.0.iter().zip(other.0).map(|(a, b)| a * b).sum()
    }

    /// The integral of the product of three functions over the sphere: of degree 9, met exactly.
    pub fn triple(a: &Self, b: &Self, c: &Self) -> f64 {
        let azimuths = 10;
        let at = |z: f64, azimuth: usize| {
            let (sin, cos) = (TAU * azimuth as f64 / azimuths as f64).sin_cos();
            let level = (1.0 - z * z).sqrt();
            let basis = Self::towards(DVec3::new(level * cos, level * sin, z));
            a.dot(&basis) * b.dot(&basis) * c.dot(&basis)
        };
        let ring = |(node, weight): (f64, f64)| {
            2.0 * weight * (0..azimuths).map(|azimuth| at(2.0 * node - 1.0, azimuth)).sum::<f64>()
        };
        TAU / azimuths as f64 * gauss_legendre(5).into_iter().map(ring).sum::<f64>()
    }
}

const DEGREES: [usize; 16] = [0, 1, 1, 1, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3, 3, 3];

impl Add for Harmonics {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl Mul<f64> for Harmonics {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|value| value * factor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(i: usize) -> Harmonics {
        Harmonics(std::array::from_fn(|j| f64::from(u8::from(i == j))))
    }

    #[test]
    fn harmonics_are_orthonormal() {
        let one =
            Harmonics([(4.0 * PI).sqrt(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        for i in 0..16 {
            for j in 0..16 {
                let expected = f64::from(u8::from(i == j));
                assert!((Harmonics::triple(&unit(i), &unit(j), &one) - expected).abs() < 1e-12, "{i} {j}");
            }
        }
    }

    /// The paper prints 0.886227, 1.02333, 0.495416, 0.
    #[test]
    fn the_clamped_cosine_has_the_published_zonal_coefficients() {
        let Harmonics(up) = Harmonics::clamped_cosine(DVec3::Z);
        for (index, expected) in [(0, 0.886227), (2, 1.02333), (6, 0.495416), (12, 0.0)] {
            assert!((up[index] - expected).abs() < 1e-5, "{}", up[index]);
        }
    }

    #[test]
    fn a_turned_function_is_that_of_the_turned_direction() {
        let (d, angle_rad) = (DVec3::new(0.48, -0.6, 0.64), 0.9f64);
        let turned = glam::DQuat::from_rotation_z(angle_rad) * d;
        let error = Harmonics::towards(d).turned(angle_rad) + Harmonics::towards(turned) * -1.0;
        assert!(error.dot(&error) < 1e-24);
    }
}
