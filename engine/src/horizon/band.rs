//! The elevations at which a skyline can hide a light.
//!
//! Lights move through a cap of directions about `s`, discs included. From a point with vertical `u`, a skyline
//! above all of the cap only needs to stay above it, one below only below:
//!
//! ```text
//! h' = clamp(h, asin(u·s) − reach, asin(u·s) + reach)
//! ```
//!
//! Fitted in place of `h`, a cliff's ringing shrinks from a fraction of its height to that fraction of the band. The vertical is the
//! point's own: over a map of 370 km the Sun's elevation changes by 12°.
//!
//! How much that gains depends on what else an encoding loses. On 64² nodes of cratered terrain under a Sun at 1.5° in all
//! azimuths, as fractions of what `fm16` without a band errs (numerical experiment, margins in radii beyond the disc):
//!
//! | series | pixel error rate | RMS | RMS in the penumbra |
//! |---|---|---|---|
//! | 15 harmonics, full resolution, exact: none; margin 4; 2; ½ | 0.68; 0.61; 0.54; 0.42 | 0.74; 0.76; 0.77; 0.99 | 0.76; 0.75; 0.70; 0.70 |
//! | 31 harmonics, the same | 0.30; 0.25; 0.25; 0.18 | 0.36; 0.34; 0.35; 0.49 | 0.39; 0.37; 0.37; 0.45 |
//! | `w21` of 31 harmonics: none; margin 4; 2; 1 | 0.39; 0.35; 0.32; 0.30 | 0.44; 0.40; 0.41; 0.46 | 0.47; 0.43; 0.42; 0.44 |
//!
//! Most of `fm16`'s error is lost resolution, which no band gives back. What clamping leaves is the ringing of the corners
//! that it makes itself. A series free to take any value beyond the band on the right side (twenty alternating projections)
//! has 0.41 and 0.19 of the wrong pixels with 15 and 31 exact harmonics at a margin of 3. In `w21`, at a margin of 2 and ten
//! projections, it has 0.32, as after clamping: there quantisation is what is left.
//!
//! On whole exposures with `fm16` it was no clear gain. Shadows against traced ones, without and with the band:
//!
//! | scene | Sun | agreement | RMS, full Sun | RMS in the penumbra |
//! |---|---|---|---|---|
//! | connecting ridge, 5 km within 100 km | 1.9° | 99.61, 99.60 % | 0.00132, 0.00124 | 0.0088, 0.0083 |
//! | cratered highland, six levels | 4.1° | 98.84, 98.83 % | 0.00282, 0.00312 | 0.0109, 0.0124 |
//!
//! Over seven scenes and Suns at 1.5° to 15° in all azimuths (`sim bench encodings`) the pixel error rate is, without and
//! with the band, 1 and 0.98 in `fm16` (1.3 on cratered highland and both real models), 0.37 and 0.28 in `w21`, 0.46 and
//! 0.34 in `w16`; the RMS in penumbras 0.56 and 0.47 in `w21`. It gains most where cliffs ring (blocks 0.47 and 0.15,
//! needles 0.72 and 0.55) and little on the connecting ridge (0.28 and 0.25). So it is not the default.
//!
//! # Assumptions
//! A series of clamped elevations tells nothing outside the band. The cap of a sequence that follows the Sun
//! for hours grows with its arc, and the gain shrinks.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::geometry::{BodyFixed, Direction};
use crate::terrain::Gnomonic;

/// What is left above and below the discs, in their radii. By Gibbs a cliff across the band rings by 0.107 of twice the
/// reach, so 0.27 radii would keep it off the disc, but less than 2 radii did harm: on one exposure of the connecting ridge
/// the RMS error of the irradiance (`fm16`) was 1.40, 1.20, 1.01, 0.93, 0.97, 1.10 of that without a band at 0.5, 1, 2, 4,
/// 8, 16 radii. What errs less asks for less: in penumbras `w21` has 0.51, 0.49, 0.48 of the RMS of `fm16` without a band
/// at 4, 3, 2 radii (seven scenes of 96² nodes).
pub const MARGIN_RADII: f64 = 3.0;

/// The middle and the reach are rounded to this, so that a header reads back as itself and other machines find the tile.
const STEPS_PER_RADIAN: f64 = 1e6;

/// All elevations within reach of a direction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElevationBand {
    /// Body-fixed unit vector of the cap's middle.
    pub towards: [f64; 3],
    /// From the middle to the band's edges.
    pub reach_rad: f64,
}

impl ElevationBand {
    /// The band about lights of an angular radius; `None` where they stand all around, so that every elevation matters.
    pub fn about(lights: &[(Direction<BodyFixed>, f64)]) -> Option<Self> {
        let units = || lights.iter().map(|(direction, _)| direction.unit());
        let low = units().reduce(DVec3::min)?;
        let high = units().reduce(DVec3::max)?;
        // The middle of the box about an arc lies on the arc's axis.
        let middle = Direction::new(low + high)?;
        let reach = |(light, radius_rad): &(_, f64)| middle.angle_to(*light) + (1.0 + MARGIN_RADII) * radius_rad;
        let reach_rad = lights.iter().map(reach).fold(0.0, f64::max);
        let rounded = |component: f64| (component * STEPS_PER_RADIAN).round() / STEPS_PER_RADIAN;
        let towards = middle.unit().to_array().map(rounded);
        let reach_rad = (reach_rad * STEPS_PER_RADIAN).ceil() / STEPS_PER_RADIAN;
        (reach_rad < FRAC_PI_2).then_some(Self { towards, reach_rad })
    }

    /// Lowest and highest elevation that matter at a map point.
    pub fn ends_rad(&self, map: &Gnomonic, at_m: DVec2) -> [f64; 2] {
        let towards = map.map_from_body.turn(DVec3::from_array(self.towards));
        let middle_rad = map.up(at_m).unit().dot(towards).clamp(-1.0, 1.0).asin();
        [middle_rad - self.reach_rad, middle_rad + self.reach_rad]
    }

    /// The elevation, or the end of the band that it lies beyond.
    pub fn clamp(&self, map: &Gnomonic, at_m: DVec2, elevation_rad: f64) -> f64 {
        let [low_rad, high_rad] = self.ends_rad(map, at_m);
        elevation_rad.clamp(low_rad, high_rad)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::geometry::{Body, Geodetic, Local};
    use crate::horizon::Series;

    const SUN_RADIUS_RAD: f64 = 0.004_65;

    fn map() -> Gnomonic {
        Gnomonic::about(&Body::moon(), Geodetic::from_degrees(-87.0, 40.0, 0.0))
    }

    /// Lights over the map's centre by azimuth and elevation.
    fn lights(at_rad: &[[f64; 2]]) -> Vec<(Direction<BodyFixed>, f64)> {
        let local = |[azimuth_rad, elevation_rad]: &[f64; 2]| {
            let (sin, cos) = azimuth_rad.sin_cos();
            let level = elevation_rad.cos();
            let towards = DVec3::new(level * sin, level * cos, elevation_rad.sin());
            let to_body = Body::moon().local_from_body(Geodetic::from_degrees(-87.0, 40.0, 0.0)).inverse();
            (to_body * Direction::<Local>::new(towards).unwrap(), SUN_RADIUS_RAD)
        };
        at_rad.iter().map(local).collect()
    }

    /// The box of `series.rs`, whose ringing is 0.0214 rad below at a height of 0.2 rad and proportional to it.
    #[test]
    fn a_cliff_rings_by_a_share_of_the_band_instead_of_its_height() {
        let sun_rad = 1.5_f64.to_radians();
        let band = ElevationBand::about(&lights(&[[0.3, sun_rad]])).unwrap();
        let cliff = |azimuth_rad: f64| if (azimuth_rad - 3.0).abs() < 0.5 { 0.2 } else { 0.0 };
        let lowest = |h: &dyn Fn(f64) -> f64| {
            let samples: Vec<_> = (0..7200).map(|i| h(TAU * f64::from(i) / 7200.0)).collect();
            let series = Series::fit(&samples, 15);
            (0..7200).map(|i| series.elevation_rad(TAU * f64::from(i) / 7200.0)).fold(f64::INFINITY, f64::min)
        };
        let [low_rad, high_rad] = band.ends_rad(&map(), DVec2::ZERO);
        let ringing_rad = low_rad - lowest(&|azimuth_rad| band.clamp(&map(), DVec2::ZERO, cliff(azimuth_rad)));
        // The published figure has three digits.
        assert!((ringing_rad / (0.0214 / 0.2 * (high_rad - low_rad)) - 1.0).abs() < 0.01, "{ringing_rad}");
        // Without the band the cliff's trough is more than four Sun's radii deep; with it, one and less than the margin.
        assert!(-lowest(&cliff) > 4.0 * SUN_RADIUS_RAD);
        assert!(ringing_rad < 1.1 * SUN_RADIUS_RAD);
    }

    #[test]
    fn clamping_never_changes_on_which_side_of_a_disc_the_skyline_is() {
        let lights = lights(&[[0.3, 0.02], [0.35, 0.03], [0.4, 0.01]]);
        let (band, map) = (ElevationBand::about(&lights).unwrap(), map());
        for at_m in [DVec2::ZERO, DVec2::new(180_000.0, -90_000.0), DVec2::new(-184_000.0, 184_000.0)] {
            for (light, radius_rad) in &lights {
                let towards = map.map_from_body * *light;
                let light_rad = map.up(at_m).unit().dot(towards.unit()).asin();
                for edge_rad in [light_rad - radius_rad, light_rad, light_rad + radius_rad] {
                    for skyline_rad in (-1500..1500).map(|step| f64::from(step) * 1e-3 + 5e-4) {
                        let clamped_rad = band.clamp(&map, at_m, skyline_rad);
                        assert_eq!(clamped_rad > edge_rad, skyline_rad > edge_rad, "{skyline_rad} at {at_m}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_band_of_one_light_is_its_disc_and_the_margin_and_of_opposite_ones_none() {
        let [low_rad, high_rad] = ElevationBand::about(&lights(&[[1.0, 0.1]])).unwrap().ends_rad(&map(), DVec2::ZERO);
        let reach_rad = (1.0 + MARGIN_RADII) * SUN_RADIUS_RAD;
        // Rounded to a microradian each.
        assert!((low_rad - (0.1 - reach_rad)).abs() < 3e-6 && (high_rad - (0.1 + reach_rad)).abs() < 3e-6);
        assert_eq!(ElevationBand::about(&lights(&[[0.0, 0.0], [TAU / 2.0, 0.0]])), None);
        assert_eq!(ElevationBand::about(&[]), None);
    }
}
