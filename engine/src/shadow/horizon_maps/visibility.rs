//! The share of a disc above a skyline, from the skyline's elevations at a few azimuths.
//!
//! Four ways, of Max (1988), Fritsch et al. (2025) and this program. `a` is the elevation of the disc's centre, `r` its
//! angular radius, `α(x)` the skyline at the azimuth of the column `x` of the disc, `V(d)` the share of the disc above a
//! straight line `d` radii from its centre, `C(t)` the share of a column above `t` of its half height:
//!
//! ```text
//! middle value       V(d)                   d = (α(0) − a)/r                            a level skyline
//! circular segment   V(d/√(1 + m²))         d, m: mean and half difference of (α(±1) − a)/r     a secant
//! n boxes            Σ wᵢ C(tᵢ) / Σ wᵢ      tᵢ = (α(xᵢ) − a)/(r √(1 − xᵢ²)),   xᵢ = (2i + 1)/n − 1
//! line               V(d/√(1 + s²))         d, s: height and slope of the tangent at the centre ([`HorizonLine`])
//! ```
//!
//! For a uniform disc `V = ½ − (asin d + d √(1 − d²))/π`, `C = (1 − t)/2` clamped to 0 … 1, `wᵢ = √(1 − xᵢ²)`; a limb-darkened
//! disc has its own ([`SolarDisk`]) at the same cost.
//!
//! # What differs from the paper as printed
//! - Equation 10 sums boxes unclamped and with equal weights: a level skyline 0.8 radii above the centre hides 1.074 of the
//!   disc (exact: 0.948). Clamped and weighted by their heights, five boxes are right to 0.008.
//! - Equations 6 to 8 step the azimuth by `x r`. The column `x` of the disc lies `δ` off the centre's azimuth, `sin δ = sin
//!   x r / cos a`: the same at the horizon, twice as much at 60°.
//!
//! `visibility.wgsl` is the twin; `tests/conformance/visibility.rs` holds them together.
//!
//! # Assumptions
//! Heights are angles over `r`, as in the paper, not heights in the tangent plane: apart by `r²/6`, 4e-6 for the Sun.
//!
//! # References
//! Max (1988), *Horizon mapping: shadows for bump-mapped surfaces*, The Visual Computer 4, 109.
//! Fritsch et al. (2025), *Fast Planetary Shadows using Fourier-Compressed Horizon Maps*, section 3.3,
//! doi:10.2312/hpg.20251171.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::photometry::{HorizonLine, SolarDisk};

/// How the share of the Sun's disc above a skyline is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum Visibility {
    /// From the skyline at the disc's middle, taken as level (Max 1988).
    #[default]
    MiddleValue,
    /// From the secant between the skyline at both edges of the disc.
    CircularSegment,
    /// From the skyline at the middles of so many boxes that take the disc's place.
    Boxes(#[schemars(range(min = 1, max = 64))] u32),
    /// From height and slope of the skyline at the disc's middle.
    Line,
}

/// As a scenario writes it.
impl fmt::Display for Visibility {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::MiddleValue => write!(f, "MiddleValue"),
            Self::CircularSegment => write!(f, "CircularSegment"),
            Self::Boxes(count) => write!(f, "Boxes({count})"),
            Self::Line => write!(f, "Line"),
        }
    }
}

/// A disc above the local horizontal.
#[derive(Debug, Clone, Copy)]
pub struct DiscGeometry {
    pub elevation_rad: f64,
    pub angular_radius_rad: f64,
}

/// Least cosine of an elevation: nearer to the zenith the disc spans all azimuths.
const LEAST_COSINE: f64 = 1e-6;

impl Visibility {
    /// The share of a disc above a skyline, given as elevation and slope by azimuth, both in radians, against the sine of
    /// the azimuth clockwise from the disc's centre.
    pub fn share(self, disk: &SolarDisk, geometry: DiscGeometry, skyline: impl Fn(f64) -> (f64, f64)) -> f64 {
        // Heights in radii above the centre, at a column of the disc.
        let height =
            |x: f64| (skyline(geometry.offset_sine(x)).0 - geometry.elevation_rad) / geometry.angular_radius_rad;
        match self {
            Self::MiddleValue => disk.share_above(height(0.0)),
            Self::CircularSegment => {
                let [start, end] = [height(-1.0), height(1.0)];
                let (middle, slope) = (0.5 * (start + end), 0.5 * (end - start));
                disk.share_above(middle / 1f64.hypot(slope))
            }
            Self::Boxes(count) => {
                let middles = (0..count).map(|i| f64::from(2 * i + 1) / f64::from(count) - 1.0);
                disk.share_of_columns(&middles.map(|x| [x, height(x)]).collect::<Vec<_>>())
            }
            Self::Line => {
                let (elevation_rad, slope) = skyline(0.0);
                let DiscGeometry { elevation_rad: centre_rad, angular_radius_rad } = geometry;
                let line = HorizonLine::new(elevation_rad, slope, centre_rad, angular_radius_rad);
                disk.share_above(line.height / 1f64.hypot(line.slope))
            }
        }
    }

    /// Its number in `visibility.wgsl`, and how many boxes.
    pub fn constants(self) -> [(&'static str, f64); 2] {
        let (number, boxes) = match self {
            Self::MiddleValue => (0, 1),
            Self::CircularSegment => (1, 1),
            Self::Boxes(count) => (2, count),
            Self::Line => (3, 1),
        };
        [("VISIBILITY", f64::from(number)), ("BOXES", f64::from(boxes))]
    }
}

impl DiscGeometry {
    /// Sine of the azimuth from the disc's centre to a column.
    pub fn offset_sine(&self, x: f64) -> f64 {
        let level = self.elevation_rad.cos().max(LEAST_COSINE);
        ((x * self.angular_radius_rad).sin() / level).clamp(-1.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photometry::LimbDarkening;

    const RADIUS_RAD: f64 = 0.004_65;
    const ALL: [Visibility; 4] =
        [Visibility::MiddleValue, Visibility::CircularSegment, Visibility::Boxes(5), Visibility::Line];

    fn disk(law: LimbDarkening) -> SolarDisk {
        SolarDisk::new(law).unwrap()
    }

    fn geometry(elevation_deg: f64) -> DiscGeometry {
        DiscGeometry { elevation_rad: elevation_deg.to_radians(), angular_radius_rad: RADIUS_RAD }
    }

    /// A level skyline `height` radii above the centre.
    fn level(visibility: Visibility, disk: &SolarDisk, height: f64, elevation_deg: f64) -> f64 {
        let geometry = geometry(elevation_deg);
        visibility.share(disk, geometry, |_| (geometry.elevation_rad + height * RADIUS_RAD, 0.0))
    }

    /// Equation 10 as printed, `i` from 0.
    fn printed_boxes(count: u32, height: f64) -> f64 {
        let boxes = (0..count).map(|i| {
            let x = f64::from(2 * i + 1) / f64::from(count) - 1.0;
            height / (2.0 * (1.0 - x * x).sqrt())
        });
        1.0 - (boxes.sum::<f64>() / f64::from(count) + 0.5)
    }

    /// Shares above a level line, by two-dimensional quadrature: uniform, and darkened with the exponent 0.507909.
    const LEVEL: [(f64, f64, f64); 5] = [
        (-0.9, 0.981_307, 0.988_485),
        (-0.5, 0.804_499, 0.825_893),
        (0.0, 0.5, 0.5),
        (0.5, 0.195_501, 0.174_107),
        (0.75, 0.072_147, 0.055_286),
    ];

    #[test]
    fn a_level_skyline_hides_what_the_quadrature_says() {
        let (uniform, darkened) = (disk(LimbDarkening::Uniform), disk(LimbDarkening::Power { alpha: 0.507_909_09 }));
        for (height, of_uniform, of_darkened) in LEVEL {
            for visibility in ALL {
                // What boxes err is theirs: 0.0119 with three, 5.2e-3 with five, 8e-4 with twenty at 0.8 radii; elsewhere
                // no more.
                let allowed = if let Visibility::Boxes(_) = visibility { 8e-3 } else { 2e-5 };
                for elevation_deg in [0.0, 1.5, 60.0, 85.0] {
                    let got = level(visibility, &uniform, height, elevation_deg);
                    assert!((got - of_uniform).abs() < allowed, "{visibility:?} {height} {got} {of_uniform}");
                    let got = level(visibility, &darkened, height, elevation_deg);
                    assert!((got - of_darkened).abs() < allowed, "{visibility:?} {height} {got} {of_darkened}");
                }
            }
        }
    }

    #[test]
    fn boxes_as_corrected_meet_the_disc_and_as_printed_do_not() {
        let uniform = disk(LimbDarkening::Uniform);
        for (height, exact) in [(0.8, 0.052_04), (-0.8, 0.947_96)] {
            for (count, allowed) in [(3, 1.2e-2), (5, 8e-3), (20, 1e-3)] {
                let error = level(Visibility::Boxes(count), &uniform, height, 0.0) - exact;
                assert!(error.abs() < allowed, "{count} boxes at {height}: {error}");
            }
            let printed = printed_boxes(20, height);
            assert!(!(0.0..=1.0).contains(&printed) && (printed - exact).abs() > 0.1, "{printed}");
        }
        // The figure of the paper's equation for twenty boxes: 1.074 of the disc hidden.
        assert!((1.0 - printed_boxes(20, 0.8) - 1.074).abs() < 1e-3);
    }

    #[test]
    fn a_tilted_skyline_hides_what_a_line_of_its_distance_does() {
        let uniform = disk(LimbDarkening::Uniform);
        for elevation_deg in [0.0, 3.0, 60.0] {
            let geometry = geometry(elevation_deg);
            for (height, slope) in [(0.3, 1.0), (-0.4, 3.0), (0.0, -0.5)] {
                // A line of that height and slope in radii.
                let skyline = |sine: f64| {
                    let x = (sine * geometry.elevation_rad.cos()).asin() / RADIUS_RAD;
                    let by_azimuth = slope * geometry.elevation_rad.cos();
                    (geometry.elevation_rad + (height + slope * x) * RADIUS_RAD, by_azimuth)
                };
                let exact = uniform.visible_above(height / f64::hypot(1.0, slope));
                let error = |visibility: Visibility| (visibility.share(&uniform, geometry, skyline) - exact).abs();
                assert!(error(Visibility::CircularSegment) < 2e-5, "{}", error(Visibility::CircularSegment));
                // The slope is divided by the cosine of the skyline's elevation, half a radius off: by 0.4 % at 60°.
                assert!(error(Visibility::Line) < 2e-3, "{}", error(Visibility::Line));
                assert!(error(Visibility::Boxes(7)) < 2e-2, "{}", error(Visibility::Boxes(7)));
            }
        }
        // A level line at that height is something else.
        let geometry = geometry(0.0);
        let steep = |sine: f64| (0.3 * RADIUS_RAD + sine.asin(), 1.0);
        let exact = uniform.visible_above(0.3 / 2f64.sqrt());
        assert!((Visibility::MiddleValue.share(&uniform, geometry, steep) - exact).abs() > 0.04);
    }

    /// A peak narrower than the disc: only boxes see it.
    #[test]
    fn boxes_see_what_stands_inside_the_disc() {
        let uniform = disk(LimbDarkening::Uniform);
        let geometry = geometry(0.0);
        let peak = |sine: f64| (if sine.abs() < 0.3 * RADIUS_RAD { 1.0 } else { -1.0 }, 0.0);
        // The share of the columns within 0.3 radii: 1 − 2V(0.3).
        let exact = 2.0 * uniform.visible_above(0.3);
        let error = |visibility: Visibility| (visibility.share(&uniform, geometry, peak) - exact).abs();
        assert!(error(Visibility::Boxes(63)) < 0.02, "{}", error(Visibility::Boxes(63)));
        assert!(error(Visibility::MiddleValue) > 0.3 && error(Visibility::CircularSegment) > 0.3);
    }

    #[test]
    fn nothing_is_undefined_at_the_zenith_or_for_a_point() {
        let uniform = disk(LimbDarkening::Uniform);
        for visibility in ALL {
            for elevation_deg in [-90.0, 89.9, 90.0] {
                assert_eq!(level(visibility, &uniform, -3.0, elevation_deg), 1.0, "{visibility:?}");
                assert_eq!(level(visibility, &uniform, 3.0, elevation_deg), 0.0, "{visibility:?}");
            }
        }
    }
}
