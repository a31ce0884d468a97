//! The lights of an exposure: the Sun, what the Earth leaves of it, and what the Earth sends back.
//!
//! ```text
//! sunlight     E = E_1au (1 au/d)² V       V: share of the disc that the Earth does not hide (eclipse)
//! earthshine   E = E_1au (1 au/d_E)² p (R/r)² Φ(a)      Φ(a) = [sin a + (π − a) cos a]/π
//! ```
//!
//! `d_E` is the Earth's distance from the Sun, `r` its distance from the ground, `a` the phase angle at the Earth.
//!
//! # Assumptions
//! - All of a scene sees the eclipse that the terrain's centre sees: the Moon's penumbra is 3600 km wide, so that `V` varies by
//!   up to 0.04 % a kilometre.
//! - While an image takes its time, its lights move in steps of a second: half of one is 0.25″, 1/3800 of the Sun's radius.
//! - An eclipsed Sun is dimmer, not smaller: its light keeps coming from the whole disc.
//! - The Earth is a Lambert sphere, whose Bond albedo is 3p/2: with that of CERES, 0.29, p is 0.196, and the ground gets
//!   0.073 W/m² at full Earth. What is measured there is 0.15 W/m², half of it thermal, and changes by 30 % as the Earth
//!   turns (Glenar et al. 2019).

use hifitime::{Epoch, Unit};

use super::{Error, scene};
use crate::ephemeris::{self, Almanac, BodyFrame, EARTH_RADIUS_M, EphemerisError, Source};
use crate::geometry::{BodyFixed, Direction, Geodetic, Position};
use crate::photometry::eclipse::{lambert_sphere, share_left_by_earth};
use crate::render::Light;
use crate::scenario::Scenario;

/// All that decides about the lights.
#[derive(Debug)]
pub struct Sky<'a> {
    pub scenario: &'a Scenario,
    pub almanac: &'a Almanac,
    pub frame: &'a BodyFrame,
    /// The point from which they are seen.
    pub centre: Geodetic,
}

/// The lights at an instant.
#[derive(Debug)]
pub struct Lit {
    pub sun: Source,
    /// `None`: nobody asked, or no kernel has the Earth.
    pub eclipse_share: Option<f64>,
    /// The Sun first.
    pub lights: Vec<Light>,
}

impl Sky<'_> {
    pub fn at(&self, epoch: Epoch) -> Result<Lit, Error> {
        let sun = self.sun(epoch)?;
        let at_1_au_w_m2 = self.scenario.sun.irradiance_w_m2;
        let eclipse_share = self.eclipse_share(epoch, &sun)?;
        let sunlight_w_m2 = sun.irradiance_w_m2(at_1_au_w_m2) * eclipse_share.unwrap_or(1.0);
        let mut lights = vec![self.light(&sun, sunlight_w_m2)];
        if let Some(albedo) = self.scenario.earthshine_albedo {
            let earth = ephemeris::earth(self.almanac, self.frame, self.reference(), epoch)?;
            lights.push(self.light(&earth, earthshine_w_m2(&sun, &earth, albedo, at_1_au_w_m2)));
        }
        Ok(Lit { sun, eclipse_share, lights })
    }

    /// The lights at times from an instant.
    pub fn during(&self, epoch: Epoch, times_s: &[f64]) -> Result<Vec<(f64, Vec<Light>)>, Error> {
        let at = |time_s: &f64| Ok((*time_s, self.at(epoch + *time_s * Unit::Second)?.lights));
        times_s.iter().map(at).collect()
    }

    fn reference(&self) -> Position<BodyFixed> {
        self.frame.body.position_from_geodetic(self.centre)
    }

    /// A source at its apparent place.
    fn light(&self, source: &Source, irradiance_w_m2: f64) -> Light {
        let position = Position::from_m(self.reference().vector_m() + source.distance_m * source.direction.unit());
        Light { position, angular_radius_rad: source.angular_radius_rad, irradiance_w_m2 }
    }

    fn sun(&self, epoch: Epoch) -> Result<Source, Error> {
        let Some(fixed) = self.scenario.sun.fixed else {
            return Ok(ephemeris::sun(self.almanac, self.frame, self.reference(), epoch)?);
        };
        let (sin_azimuth, cos_azimuth) = fixed.azimuth_rad.sin_cos();
        let (sin, cos) = fixed.elevation_rad.sin_cos();
        let local =
            Direction::new(glam::DVec3::new(cos * sin_azimuth, cos * cos_azimuth, sin)).expect("it has length 1");
        Ok(Source {
            direction: self.frame.body.local_from_body(self.centre).inverse() * local,
            distance_m: fixed.distance_m,
            angular_radius_rad: (crate::quantity::SOLAR_RADIUS_M / fixed.distance_m).asin(),
        })
    }

    /// The share of the Sun's light that the Earth leaves to the Moon.
    fn eclipse_share(&self, epoch: Epoch, sun: &Source) -> Result<Option<f64>, Error> {
        let asked = self.scenario.sun.eclipses && self.scenario.sun.fixed.is_none();
        if !asked || self.frame.body.naif_id != ephemeris::MOON {
            return Ok(None);
        }
        let earth = match ephemeris::earth(self.almanac, self.frame, self.reference(), epoch) {
            // Without an Earth nothing is known of its shadow, and a scene of the Moon needs none.
            Err(EphemerisError::NotLoaded { .. }) => return Ok(None),
            other => other?,
        };
        Ok(Some(sun_left_by_earth(scene::limb_darkening(self.scenario)?, sun, &earth)))
    }
}

/// The share of the Sun's light that the Earth with its atmosphere leaves where both are seen so.
pub fn sun_left_by_earth(law: crate::photometry::LimbDarkening, sun: &Source, earth: &Source) -> f64 {
    let apart_rad = sun.direction.angle_to(earth.direction);
    share_left_by_earth(law, sun.angular_radius_rad, EARTH_RADIUS_M / earth.distance_m, apart_rad)
}

/// Irradiance by the Earth as a Lambert sphere of geometric albedo `albedo`.
pub fn earthshine_w_m2(sun: &Source, earth: &Source, albedo: f64, at_1_au_w_m2: f64) -> f64 {
    let from_earth_to_sun = sun.distance_m * sun.direction.unit() - earth.distance_m * earth.direction.unit();
    let to_sun = Direction::<BodyFixed>::new(from_earth_to_sun);
    let to_here = Direction::new(-earth.direction.unit());
    let phase_rad = to_sun.zip(to_here).map_or(0.0, |(a, b)| a.angle_to(b));
    let at_earth = Source { distance_m: from_earth_to_sun.length(), ..*sun }.irradiance_w_m2(at_1_au_w_m2);
    at_earth * albedo * (EARTH_RADIUS_M / earth.distance_m).powi(2) * lambert_sphere(phase_rad)
}
