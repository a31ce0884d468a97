//! Lens distortion as missions publish it: from the measured point of the focal plane to the ideal one.
//!
//! With `(x, y)` the measured point over the focal length, `r² = x² + y²`:
//!
//! ```text
//! radial       ideal = (x, y) (1 + k₀ + k₁ r² + k₂ r⁴ + k₃ r⁶)
//! along one axis   y_ideal = y / (1 + k y²), x unchanged             (LROC NAC)
//! added        ideal = (x, y) + c₀ + c₁ r + c₂ r² + c₃ r³                (Kaguya TC, MI)
//! ```
//!
//! [`super::Distortion`] goes the other way. The inverse is found by fixed point: distortions are small.
//!
//! # References
//! ISIS camera models (`ApolloMetricDistortionMap`, `LroNarrowAngleDistortionMap`); CSM ISD keys `radial`, `lrolrocnac`,
//! `kaguyalism`; Kaguya's instrument kernels SEL_TC_V01.TI and SEL_MI_V01.TI.

use glam::DVec2;

/// From measured to ideal, on the plane at distance 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Correction {
    /// `k₀` to `k₃`.
    Radial([f64; 4]),
    /// `k`, along the image's columns (+x) only.
    AcrossTrack(f64),
    /// `c₀` to `c₃`.
    Added([DVec2; 4]),
}

/// Rounds of the fixed point; each gains the digits of the distortion's size, 1e-3 or better.
const ROUNDS: usize = 30;

/// How near the inverse has to come, in focal lengths.
const NEAR: f64 = 1e-12;

impl Correction {
    /// From coefficients in powers of mm⁻².
    pub fn radial_mm([k1, k2, k3]: [f64; 3], focal_mm: f64) -> Self {
        let f2 = focal_mm * focal_mm;
        Self::Radial([0.0, k1 * f2, k2 * f2 * f2, k3 * f2 * f2 * f2])
    }

    pub fn ideal(&self, measured: DVec2) -> DVec2 {
        match *self {
            Self::Radial([k0, k1, k2, k3]) => {
                let r2 = measured.length_squared();
                measured * (1.0 + k0 + r2 * (k1 + r2 * (k2 + r2 * k3)))
            }
            Self::AcrossTrack(k) => DVec2::new(measured.x / (1.0 + k * measured.x * measured.x), measured.y),
            Self::Added([c0, c1, c2, c3]) => {
                let r = measured.length();
                measured + c0 + r * (c1 + r * (c2 + r * c3))
            }
        }
    }

    /// `None` where the fixed point does not settle.
    pub fn measured(&self, ideal: DVec2) -> Option<DVec2> {
        let mut measured = ideal;
        for _ in 0..ROUNDS {
            let step = ideal - self.ideal(measured);
            measured += step;
            if step.length() < NEAR {
                return Some(measured);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corrections_round_trip() {
        let apollo = Correction::radial_mm([-0.13361854e-5, 0.52261757e-9, -0.50728336e-13], 76.054);
        let nac = Correction::AcrossTrack(1.81e-5 * 699.62 * 699.62);
        let kaguya = Correction::Added([[1e-3, -3e-4], [-1e-3, 1.4e-3], [7e-2, 1e-3], [4e-2, 1e-2]].map(DVec2::from));
        for correction in [apollo, nac, kaguya] {
            for (x, y) in [(0.0, 0.0), (0.02, -0.01), (-0.7, 0.7), (0.025, 0.3)] {
                let ideal = DVec2::new(x, y) * if correction == apollo { 1.0 } else { 0.03 };
                let back = correction.ideal(correction.measured(ideal).unwrap());
                assert!((back - ideal).length() < 1e-12, "{back} {ideal}");
            }
        }
    }

    /// At 40 mm: 1 − 1.336e-6·1600 + 5.226e-10·2.56e6 − 5.07e-14·4.096e9 = 1 − 2.138e-3 + 1.338e-3 − 2.08e-4.
    #[test]
    fn the_apollo_metric_camera_moves_a_point_at_40_mm_by_40_micrometres() {
        let apollo = Correction::radial_mm([-0.13361854e-5, 0.52261757e-9, -0.50728336e-13], 76.054);
        let moved_mm = (apollo.ideal(DVec2::new(40.0 / 76.054, 0.0)).x * 76.054) - 40.0;
        assert!((moved_mm + 0.0403).abs() < 2e-4, "{moved_mm}");
    }
}
