//! Where the Sun and the Earth stand.

use std::path::PathBuf;

use perilune_engine::ephemeris::{Almanac, BodyFrame, Epoch, Source, earth, horizontal, sun};
use perilune_engine::geometry::{Body, BodyFixed, Direction, Geodetic, Position};
use perilune_engine::quantity::TOTAL_SOLAR_IRRADIANCE_W_M2;
use perilune_engine::render::Light;

use crate::Error;

/// A body with its rotation, and the Sun and the Earth as they are seen from it.
#[derive(Debug, Clone)]
pub struct Ephemeris {
    almanac: Almanac,
    frame: BodyFrame,
}

/// The Sun or the Earth in the sky of a place, with light time and aberration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkySource {
    /// Azimuth of the centre, clockwise from north.
    pub azimuth_rad: f64,
    /// Elevation of the centre above the plane that touches the body's spheroid.
    pub elevation_rad: f64,
    /// From the place to the centre when the light left it.
    pub distance_m: f64,
    /// Half the angle that the disc spans.
    pub angular_radius_rad: f64,
}

impl Ephemeris {
    /// A body by its name, as in `moon` or `mars`, with the kernels that the program carries (2020 to 2040).
    ///
    /// # Errors
    /// [`ErrorKind::Ephemeris`](crate::ErrorKind::Ephemeris) for a body that the kernels have no constants of.
    pub fn of(body: &str) -> Result<Self, Error> {
        let almanac = Almanac::default_kernels()?;
        let frame = almanac.body_frame(body, None)?;
        Ok(Self { almanac, frame })
    }

    /// A body by its name, with SPICE kernels (`.bsp`, `.bpc`, `.tpc`, `.tf`, ANISE's `.pca` and `.epa`); where two cover the
    /// same, the later one wins. `frame` is its body-fixed frame by SPICE's name; `None` takes the best that the kernels have.
    ///
    /// # Errors
    /// [`ErrorKind::Ephemeris`](crate::ErrorKind::Ephemeris) for kernels that cannot be read or do not hold what is needed.
    pub fn from_kernels(kernels: &[PathBuf], body: &str, frame: Option<&str>) -> Result<Self, Error> {
        let almanac = Almanac::load(kernels)?;
        let frame = almanac.body_frame(body, frame)?;
        Ok(Self { almanac, frame })
    }

    /// The body with its spheroid.
    pub fn body(&self) -> &Body {
        &self.frame.body
    }

    /// The Sun in the sky of a place.
    ///
    /// # Errors
    /// [`ErrorKind::Ephemeris`](crate::ErrorKind::Ephemeris) for an epoch that the kernels do not cover.
    pub fn sun(&self, place: Geodetic, epoch: Epoch) -> Result<SkySource, Error> {
        let source = sun(&self.almanac, &self.frame, self.body().position_from_geodetic(place), epoch)?;
        Ok(self.in_sky(place, &source))
    }

    /// The Earth in the sky of a place.
    ///
    /// # Errors
    /// [`ErrorKind::Ephemeris`](crate::ErrorKind::Ephemeris) for an epoch that the kernels do not cover.
    pub fn earth(&self, place: Geodetic, epoch: Epoch) -> Result<SkySource, Error> {
        let source = earth(&self.almanac, &self.frame, self.body().position_from_geodetic(place), epoch)?;
        Ok(self.in_sky(place, &source))
    }

    /// The Sun as a light of a [`View`](crate::View), as it is seen from a position: 1361 W/m² at 1 au, all wavelengths.
    ///
    /// # Errors
    /// [`ErrorKind::Ephemeris`](crate::ErrorKind::Ephemeris) for an epoch that the kernels do not cover.
    pub fn sunlight(&self, position: Position<BodyFixed>, epoch: Epoch) -> Result<Light, Error> {
        let source = sun(&self.almanac, &self.frame, position, epoch)?;
        Ok(Light {
            position: Position::from_m(position.vector_m() + source.distance_m * source.direction.unit()),
            angular_radius_rad: source.angular_radius_rad,
            irradiance_w_m2: source.irradiance_w_m2(TOTAL_SOLAR_IRRADIANCE_W_M2),
        })
    }

    /// The direction of north at a position, level there; at a pole, as the meridian of longitude 0 has it.
    pub fn north_at(&self, position: Position<BodyFixed>) -> Direction<BodyFixed> {
        let body = self.body();
        let north = Direction::new(glam::DVec3::Y).expect("it has length 1");
        body.local_from_body(body.geodetic_from_position(position)).inverse() * north
    }

    fn in_sky(&self, place: Geodetic, source: &Source) -> SkySource {
        let seen = horizontal(self.body(), place, source.direction);
        SkySource {
            azimuth_rad: seen.azimuth_rad,
            elevation_rad: seen.elevation_rad,
            distance_m: source.distance_m,
            angular_radius_rad: source.angular_radius_rad,
        }
    }
}
