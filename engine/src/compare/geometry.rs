//! Where a photograph was taken: camera, pose and Sun from the files that missions publish.
//!
//! Three sources, told apart by their contents:
//!
//! - a *frame*, our JSON ([`film`]): one camera station with its axes, focal length and Sun, or a list of them
//! - a CSM ISD ([`crate::camera::Isd`]): frame, line-scan and push-frame cameras as ALE writes them
//! - a scenario (`.ron`) and the number of an exposure
//!
//! Apparent Sun: an ISD and a frame hold the Sun's body-fixed position; its light time and aberration are the
//! publisher's.

pub mod film;

use std::path::Path;

use super::Error;
use crate::camera::{Isd, PosedCamera};
use crate::geometry::{Body, BodyFixed, Position};
use crate::quantity::{ASTRONOMICAL_UNIT_M, SOLAR_RADIUS_M, TOTAL_SOLAR_IRRADIANCE_W_M2};
use crate::render::Light;

/// A camera with its poses, the body it sees and the lights on it.
#[derive(Debug, Clone)]
pub struct Geometry {
    pub body: Body,
    pub camera: PosedCamera,
    /// The Sun first.
    pub lights: Vec<Light>,
    /// Where it comes from, in words.
    pub source: String,
}

impl Geometry {
    /// Reads the geometry of a photograph of `size` pixels from a frame or an ISD.
    pub fn read(path: &Path, photo: &Path, size: [usize; 2]) -> Result<Self, Error> {
        let text = crate::text::read(path).map_err(|source| Error::Read { path: path.into(), source })?;
        let json: serde_json::Value =
            serde_json::from_str(&text).map_err(|source| Error::Geometry { path: path.into(), source })?;
        if json.get("name_model").is_none() {
            return film::geometry(path, json, photo, size);
        }
        let isd = Isd::parse(path, &text)?;
        let camera = isd.camera;
        if size != [camera.columns(), camera.rows()] {
            let allowed = vec![format!("{} x {}", camera.columns(), camera.rows())];
            return Err(Error::Size { photo: photo.into(), columns: size[0], rows: size[1], allowed });
        }
        let (lights, source) = (vec![sun(isd.sun)], format!("CSM ISD, {}", isd.model));
        Ok(Self { body: isd.body, camera, lights, source })
    }
}

/// The Sun at a body-fixed position, with the whole spectrum's irradiance.
pub fn sun(position: Position<BodyFixed>) -> Light {
    let distance_m = position.vector_m().length();
    Light {
        position,
        angular_radius_rad: (SOLAR_RADIUS_M / distance_m).asin(),
        irradiance_w_m2: TOTAL_SOLAR_IRRADIANCE_W_M2 * (ASTRONOMICAL_UNIT_M / distance_m).powi(2),
    }
}
