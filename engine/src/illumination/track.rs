//! Where the Sun and the Earth stand, step by step.

use glam::DVec3;
use hifitime::{Duration, Epoch};

use crate::ephemeris::{Almanac, BodyFrame, EphemerisError, Source, earth, sun};
use crate::geometry::{BodyFixed, Position};
use crate::photometry::LimbDarkening;
use crate::photometry::eclipse::share_left_by_earth;

/// A disc in the sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Unit vector towards its centre, body-fixed.
    pub towards: DVec3,
    pub angular_radius_rad: f64,
}

/// The Sun and the Earth at evenly spaced epochs, as seen from one point.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    pub start: Epoch,
    pub step: Duration,
    pub sun: Vec<Seen>,
    pub earth: Vec<Seen>,
    /// Share of the Sun's light that the Earth leaves: 1 but in a lunar eclipse.
    pub sunlight: Vec<f64>,
}

impl Track {
    /// `steps` epochs from `start` on.
    pub fn new(
        almanac: &Almanac,
        frame: &BodyFrame,
        point: Position<BodyFixed>,
        start: Epoch,
        step: Duration,
        steps: usize,
    ) -> Result<Self, EphemerisError> {
        let seen =
            |source: Source| Seen { towards: source.direction.unit(), angular_radius_rad: source.angular_radius_rad };
        let (sun_track, earth_track) = (Vec::with_capacity(steps), Vec::with_capacity(steps));
        let mut track = Self { start, step, sun: sun_track, earth: earth_track, sunlight: vec![1.0; steps] };
        for index in 0..steps {
            let epoch = track.epoch(index);
            track.sun.push(seen(sun(almanac, frame, point, epoch)?));
            track.earth.push(seen(earth(almanac, frame, point, epoch)?));
        }
        Ok(track)
    }

    /// With the Earth hiding the Sun where it stands before it, as on the Moon alone.
    pub fn with_eclipses(mut self, law: LimbDarkening) -> Self {
        for ((sun, earth), left) in self.sun.iter().zip(&self.earth).zip(&mut self.sunlight) {
            let apart_rad = sun.towards.angle_between(earth.towards);
            *left = share_left_by_earth(law, sun.angular_radius_rad, earth.angular_radius_rad.sin(), apart_rad);
        }
        self
    }

    pub fn epoch(&self, index: usize) -> Epoch {
        self.start + self.step * index as i64
    }

    pub fn steps(&self) -> usize {
        self.sun.len()
    }

    pub fn step_h(&self) -> f64 {
        self.step.to_seconds() / 3600.0
    }
}
