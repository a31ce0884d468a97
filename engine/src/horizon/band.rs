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
//! It gains where cliffs ring and little elsewhere, so that it is not the default: `docs/experiments/horizon_band.md`.
//!
//! # Assumptions
//! A series of clamped elevations tells nothing outside the band. The cap of a sequence that follows the Sun
//! for hours grows with its arc, and the gain shrinks.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::geometry::{BodyFixed, Direction};
use crate::terrain::Gnomonic;

/// What is left above and below the discs, in their radii: less than 2 did harm (`docs/experiments/horizon_band.md`).
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
    fn clamping_keeps_the_skyline_on_its_side_of_a_disc() {
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
    fn one_light_has_a_band_and_opposite_lights_have_none() {
        let [low_rad, high_rad] = ElevationBand::about(&lights(&[[1.0, 0.1]])).unwrap().ends_rad(&map(), DVec2::ZERO);
        let reach_rad = (1.0 + MARGIN_RADII) * SUN_RADIUS_RAD;
        // Rounded to a microradian each.
        assert!((low_rad - (0.1 - reach_rad)).abs() < 3e-6 && (high_rad - (0.1 + reach_rad)).abs() < 3e-6);
        assert_eq!(ElevationBand::about(&lights(&[[0.0, 0.0], [TAU / 2.0, 0.0]])), None);
        assert_eq!(ElevationBand::about(&[]), None);
    }
}
