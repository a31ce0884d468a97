//! Where the Sun and the Earth stand in the sky of a surface point.
//!
//! Light that reaches the point `P` at the epoch `t` left the source `τ` earlier:
//!
//! ```text
//! s = r_source(t - τ) - r_P(t),    τ = |s| / c
//! ```
//!
//! with positions against the solar system barycentre. Stellar aberration then turns the unit vector `u = s/|s|`
//! towards the velocity `v = c β` of the point itself (the body's velocity and its rotation):
//!
//! ```text
//! u' = (u/γ + β + (u·β) β γ/(1 + γ)) / (1 + u·β),    γ = 1/√(1 - β²)
//! ```
//!
//! The body's orientation is that at `t`. Light time moves the Sun in the lunar sky by 0.01″, aberration by 20.5″
//! (2 % of its radius). The angular radius is `asin(R/|s|)`.
//!
//! # Assumptions
//! No deflection of light (Earth: below 0.01″ farther than 1° from the Sun), no refraction (airless).
//!
//! # References
//! Urban and Seidelmann (2013), Explanatory Supplement to the Astronomical Almanac, 3rd ed., chapter 7.

use std::f64::consts::TAU;

use glam::DVec3;
use hifitime::{Epoch, Unit};

use super::EphemerisError;
use super::almanac::{Almanac, BodyFrame};
use super::epoch::utc_text;
use super::names::{EARTH, SUN, body_name};
use crate::geometry::{Body, BodyFixed, Direction, Geodetic, Position};
use crate::quantity::{ASTRONOMICAL_UNIT_M, SOLAR_RADIUS_M, SPEED_OF_LIGHT_M_S};

/// Equatorial radius of the Earth. `pck00011.tpc`, BODY399_RADII.
pub const EARTH_RADIUS_M: f64 = 6_378_136.6;

/// The Sun or the Earth as a point sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// Towards the centre, as seen: with light time and aberration.
    pub direction: Direction<BodyFixed>,
    /// From the point to the centre when the light left it.
    pub distance_m: f64,
    pub angular_radius_rad: f64,
}

impl Source {
    /// Irradiance of a surface that faces the source, by that at 1 au.
    pub fn irradiance_w_m2(&self, at_1_au_w_m2: f64) -> f64 {
        at_1_au_w_m2 * (ASTRONOMICAL_UNIT_M / self.distance_m).powi(2)
    }
}

/// The Sun as seen from a point at rest on or near the body.
pub fn sun(
    almanac: &Almanac,
    frame: &BodyFrame,
    point: Position<BodyFixed>,
    epoch: Epoch,
) -> Result<Source, EphemerisError> {
    apparent(almanac, frame, SUN, SOLAR_RADIUS_M, point, epoch)
}

/// The Earth as seen from a point at rest on or near the body.
pub fn earth(
    almanac: &Almanac,
    frame: &BodyFrame,
    point: Position<BodyFixed>,
    epoch: Epoch,
) -> Result<Source, EphemerisError> {
    apparent(almanac, frame, EARTH, EARTH_RADIUS_M, point, epoch)
}

/// Any sphere as seen from a point at rest on or near the body.
pub fn apparent(
    almanac: &Almanac,
    frame: &BodyFrame,
    source_id: i32,
    source_radius_m: f64,
    point: Position<BodyFixed>,
    epoch: Epoch,
) -> Result<Source, EphemerisError> {
    let body = almanac.barycentric(frame.body.naif_id, epoch)?;
    let orientation = almanac.orientation(frame, epoch)?;
    let (offset_m, spin_m_s) = orientation.turn_state_back(point, DVec3::ZERO);
    let sight_m = light_path_m(almanac, source_id, body.position_m + offset_m, epoch)?;
    let velocity_m_s = body.velocity_m_s + spin_m_s;
    let coincident = || EphemerisError::Coincident { what: body_name(source_id), epoch_utc: utc_text(epoch) };
    let unit = sight_m.try_normalize().ok_or_else(coincident)?;
    let seen = orientation.body_from_icrf.turn(aberrate(unit, velocity_m_s / SPEED_OF_LIGHT_M_S));
    let distance_m = sight_m.length();
    Ok(Source {
        direction: Direction::new(seen).ok_or_else(coincident)?,
        distance_m,
        // Inside the sphere it fills half the sky.
        angular_radius_rad: (source_radius_m / distance_m).min(1.0).asin(),
    })
}

/// From the observer at `epoch` to where the source was when the light left.
fn light_path_m(almanac: &Almanac, source_id: i32, observer_m: DVec3, epoch: Epoch) -> Result<DVec3, EphemerisError> {
    let mut light_time_s = 0.0;
    let mut sight_m = DVec3::ZERO;
    // Each round gains the factor v/c of the source, 1e-4 at most: three reach rounding.
    for _ in 0..4 {
        let emitted = epoch - light_time_s * Unit::Second;
        sight_m = almanac.barycentric(source_id, emitted)?.position_m - observer_m;
        light_time_s = sight_m.length() / SPEED_OF_LIGHT_M_S;
    }
    Ok(sight_m)
}

/// Direction of a source for an observer who moves at `beta` times the speed of light.
fn aberrate(unit: DVec3, beta: DVec3) -> DVec3 {
    let gamma = 1.0 / (1.0 - beta.length_squared()).sqrt();
    let along = unit.dot(beta);
    (unit / gamma + beta + along * gamma / (1.0 + gamma) * beta) / (1.0 + along)
}

/// A direction by azimuth, clockwise from north, and elevation above the spheroid's tangent plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Horizontal {
    pub azimuth_rad: f64,
    pub elevation_rad: f64,
}

/// Azimuth in [0, 2π) and elevation of a direction at a point. At a pole the longitude given picks north.
pub fn horizontal(body: &Body, point: Geodetic, direction: Direction<BodyFixed>) -> Horizontal {
    let local = (body.local_from_body(point) * direction).unit();
    // A tiny negative azimuth rounds up to a whole turn.
    let azimuth_rad = local.x.atan2(local.y).rem_euclid(TAU) % TAU;
    Horizontal { azimuth_rad, elevation_rad: local.z.atan2(local.x.hypot(local.y)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The closed form for the angle to the velocity: tan(θ'/2) = √((1-β)/(1+β)) tan(θ/2).
    #[test]
    fn aberration_meets_its_closed_form_at_any_speed() {
        for beta in [1e-4, 0.1, 0.9] {
            for theta in [0.1_f64, 1.0, 2.0, 3.0] {
                let seen = aberrate(DVec3::new(theta.cos(), theta.sin(), 0.0), DVec3::X * beta);
                let expected = 2.0 * (((1.0 - beta) / (1.0 + beta)).sqrt() * (0.5 * theta).tan()).atan();
                assert!((seen.y.atan2(seen.x) - expected).abs() < 1e-14, "{beta} {theta}");
                assert!((seen.length() - 1.0).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn azimuth_runs_clockwise_from_north() {
        let body = Body::moon();
        let point = Geodetic::from_degrees(0.0, 0.0, 0.0);
        let towards = |vector| horizontal(&body, point, Direction::new(vector).unwrap());
        // At (0, 0) north is +z, east is +y, up is +x.
        assert!(towards(DVec3::Z).azimuth_rad.abs() < 1e-15);
        assert_eq!(towards(DVec3::new(0.0, -1e-20, 1.0)).azimuth_rad, 0.0);
        assert!((towards(DVec3::Y).azimuth_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        assert!((towards(-DVec3::Y).azimuth_rad - 1.5 * std::f64::consts::PI).abs() < 1e-15);
        assert!((towards(DVec3::X).elevation_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
    }
}
