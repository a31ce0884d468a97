//! What the ray through a pixel's centre sees: each thing found once, for all planes that ask for it.

use std::cell::OnceCell;

use glam::{DVec2, DVec3};

use super::pixel_angle_rad;
use crate::camera::Camera as Optics;
use crate::geometry::{BodyFixed, Direction, Geodetic, Local, Rotation};
use crate::render::facet::{bare_normal, normal};
use crate::render::{Quantity, Scene, View, refine};
use crate::terrain::{Ground, Hit};

/// One pixel's view of the ground.
pub(super) struct Seen<'a> {
    pub scene: &'a Scene,
    pub optics: &'a Optics,
    pub view: &'a View,
    pub pixel: DVec2,
    pub hit: Option<&'a Hit>,
    pub found: Found,
}

/// What several planes share.
#[derive(Default)]
pub(super) struct Found {
    place: OnceCell<Geodetic>,
    local_from_body: OnceCell<Rotation<Local, BodyFixed>>,
    normal: OnceCell<Direction<BodyFixed>>,
    bare_normal: OnceCell<Direction<BodyFixed>>,
}

impl Seen<'_> {
    /// A plane's values, as many as it has channels; NaN without ground.
    pub fn values(&self, quantity: Quantity) -> [f32; 3] {
        let is_gap = self.hit.is_some_and(|hit| hit.ground == Ground::Gap);
        // Beside the models the spheroid is invented; where there is no model it is all there is.
        let has_models = !self.scene.surface.terrain.faces.is_empty();
        let is_invented = is_gap || has_models && self.hit.is_some_and(|hit| hit.ground == Ground::Bare);
        match (quantity, self.hit.filter(|_| !is_gap)) {
            (Quantity::DemGap, _) => [f32::from(u8::from(is_invented)), 0.0, 0.0],
            (_, None) => [f32::NAN; 3],
            (Quantity::Normal, Some(hit)) => self.normal(hit).unit().as_vec3().to_array(),
            (_, Some(hit)) => [self.value(quantity, hit) as f32, 0.0, 0.0],
        }
    }

    fn value(&self, quantity: Quantity, hit: &Hit) -> f64 {
        let Self { scene, optics, view, .. } = *self;
        let to_camera = || hit.position.direction_to(view.camera_position);
        let to_sun = || view.lights.first().and_then(|sun| hit.position.direction_to(sun.position));
        let angle_deg = |a: Option<Direction<BodyFixed>>, b: Option<Direction<BodyFixed>>| {
            a.zip(b).map_or(f64::NAN, |(a, b)| a.angle_to(b).to_degrees())
        };
        match quantity {
            Quantity::SunFractionSigma => refine::sun_fraction_sigma(scene, view, hit),
            Quantity::Range => hit.distance_m,
            Quantity::Depth => {
                let boresight = view.camera_from_body.inverse().turn(DVec3::Z);
                (hit.position.vector_m() - view.camera_position.vector_m()).dot(boresight)
            }
            Quantity::Latitude => self.place(hit).latitude_rad.to_degrees(),
            Quantity::Longitude => self.place(hit).longitude_east_rad.to_degrees().rem_euclid(360.0),
            Quantity::Height => self.place(hit).height_m,
            Quantity::Incidence => angle_deg(Some(self.normal(hit)), to_sun()),
            Quantity::Emission => angle_deg(Some(self.normal(hit)), to_camera()),
            Quantity::Phase => angle_deg(to_sun(), to_camera()),
            Quantity::EllipsoidIncidence => angle_deg(Some(self.bare_normal(hit)), to_sun()),
            Quantity::EllipsoidEmission => angle_deg(Some(self.bare_normal(hit)), to_camera()),
            Quantity::Slope => angle_deg(Some(self.bare_normal(hit)), Some(self.normal(hit))),
            Quantity::Aspect => azimuth_deg(self.local_from_body(hit).turn(self.normal(hit).unit())),
            Quantity::SubsolarGroundAzimuth => {
                to_sun().map_or(f64::NAN, |to_sun| azimuth_deg(self.local_from_body(hit).turn(to_sun.unit())))
            }
            Quantity::NorthAzimuth => self.image_azimuth_deg(hit, DVec3::Y),
            Quantity::SunAzimuth => to_sun().map_or(f64::NAN, |to_sun| {
                self.image_azimuth_deg(hit, self.local_from_body(hit).turn(to_sun.unit()).with_z(0.0))
            }),
            Quantity::GroundSampleDistance => hit.distance_m * pixel_angle_rad(optics, self.pixel),
            _ => unreachable!("{quantity:?} is radiometric, or has channels of its own"),
        }
    }

    fn place(&self, hit: &Hit) -> Geodetic {
        *self.found.place.get_or_init(|| self.scene.surface.terrain.body.geodetic_from_position(hit.position))
    }

    /// East, north and up.
    fn local_from_body(&self, hit: &Hit) -> Rotation<Local, BodyFixed> {
        *self.found.local_from_body.get_or_init(|| self.scene.surface.terrain.body.local_from_body(self.place(hit)))
    }

    fn normal(&self, hit: &Hit) -> Direction<BodyFixed> {
        *self.found.normal.get_or_init(|| normal(self.scene, hit))
    }

    fn bare_normal(&self, hit: &Hit) -> Direction<BodyFixed> {
        *self.found.bare_normal.get_or_init(|| bare_normal(self.scene, hit.position))
    }

    /// How a horizontal local direction looks in the image, from right towards down, 0 to 360.
    fn image_azimuth_deg(&self, hit: &Hit, local: DVec3) -> f64 {
        let along = self.local_from_body(hit).inverse().turn(local.normalize_or_zero());
        let pixel = |sign: f64| {
            let point_m = hit.position.vector_m() + sign * AZIMUTH_STEP * hit.distance_m * along;
            let from_camera_m = point_m - self.view.camera_position.vector_m();
            self.optics.pixel(Direction::new(self.view.camera_from_body.turn(from_camera_m))?)
        };
        let step = pixel(1.0).zip(pixel(-1.0)).map_or(DVec2::NAN, |(ahead, behind)| ahead - behind);
        step.y.atan2(step.x).to_degrees().rem_euclid(360.0)
    }
}

/// Way along the ground over which a direction in the image is taken, per distance of the camera: less than a pixel, more than
/// rounding.
const AZIMUTH_STEP: f64 = 1e-4;

/// Azimuth of a local vector, clockwise from north, 0 to 360.
fn azimuth_deg(local: DVec3) -> f64 {
    local.x.atan2(local.y).to_degrees().rem_euclid(360.0)
}
