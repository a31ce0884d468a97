//! From what a renderer sampled to the planes that the user asked for.
//!
//! Radiometric planes are means over a pixel's samples. Geometric planes belong to the ray through the
//! pixel's centre and are computed here in f64, for every renderer alike.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{Image, Plane, Quantity, Scene, View, refine};
use crate::camera::{Camera as Optics, Detector};
use crate::geometry::{BodyFixed, Direction, Position};
use crate::terrain::{Ground, Hit};

/// What a renderer gives, pixel by pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    pub pixels: Vec<Radiometry>,
    /// Hits of the rays through the pixels' centres; empty where no plane needs them.
    pub centres: Vec<Option<Hit>>,
}

/// Means over a pixel. NaN where a sample saw ground without heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Radiometry {
    pub radiance_w_m2_sr: f32,
    /// Over the part of the pixel that the body covers; NaN where it covers none.
    pub irradiance_w_m2: f32,
    pub sun_fraction: f32,
    /// Share of the samples that met the body.
    pub hit: f32,
}

impl Quantity {
    /// True for planes that belong to the ray through the pixel's centre.
    pub fn is_geometric(self) -> bool {
        use Quantity::*;
        match self {
            Radiance
            | SpectralRadiance
            | GroundIrradiance
            | SpectralGroundIrradiance
            | RadianceFactor
            | FocalPlaneIrradiance
            | DigitalNumber
            | NoiseFreeDigitalNumber
            | SunFraction
            | SunIlluminationMask
            | Hit
            | ShadowChange => false,
            Flow | Covisible | FlowBack | CovisibleBack | HazardSlope | HazardRoughness | HazardSunlit | Hazard
            | InventedHeight => true,
            EllipsoidIncidence
            | EllipsoidEmission
            | Slope
            | Aspect
            | NorthAzimuth
            | SunAzimuth
            | SubsolarGroundAzimuth => true,
            SunFractionSigma | DemGap | Depth | Range | Normal | Latitude | Longitude | Height | Incidence
            | Emission | Phase | GroundSampleDistance => true,
        }
    }
}

/// From this share of the Sun's disc on a pixel is lit.
pub const LIT_SHARE: f32 = 0.5;

impl Quantity {
    /// True for planes that need more than one view, or a lander: [`crate::render`] leaves them to whoever knows those.
    pub fn is_label(self) -> bool {
        use Quantity::*;
        matches!(
            self,
            Flow | Covisible
                | FlowBack
                | CovisibleBack
                | ShadowChange
                | HazardSlope
                | HazardRoughness
                | HazardSunlit
                | Hazard
                | InventedHeight
        )
    }
}

/// Rows of an image that are seen through one part of the optics from one pose.
#[derive(Debug, Clone, Copy)]
pub struct Part<'a> {
    pub optics: &'a Optics,
    pub view: &'a View,
    pub samples: &'a Samples,
}

/// The planes of `scene.quantities`, but for labels, of an image that is taken at once.
pub fn image(scene: &Scene, view: &View, samples: &Samples) -> Image {
    image_of(scene, scene.detector.as_ref(), &[Part { optics: &scene.optics, view, samples }])
}

/// The planes of an image of parts, but for labels, the upper one first.
pub fn image_of(scene: &Scene, detector: Option<&Detector>, parts: &[Part]) -> Image {
    let rows = parts.iter().map(|part| part.optics.rows as usize).sum();
    let columns = parts.first().map_or(0, |part| part.optics.columns as usize);
    let planes = scene.quantities.iter().filter(|quantity| !quantity.is_label()).flat_map(|&quantity| {
        let channels = match quantity {
            Quantity::DigitalNumber | Quantity::NoiseFreeDigitalNumber => {
                vec![digital_numbers(scene, detector, parts, quantity, columns)]
            }
            _ => joined(parts.iter().map(|part| part.channels(scene, quantity))),
        };
        let named = quantity.channels().iter().zip(channels);
        named.map(move |(name, values)| Plane { quantity, name, values }).collect::<Vec<_>>()
    });
    Image { columns, rows, planes: planes.collect() }
}

/// Channels of parts, one below the other.
fn joined(mut parts: impl Iterator<Item = Vec<Vec<f32>>>) -> Vec<Vec<f32>> {
    let mut channels = parts.next().unwrap_or_default();
    for part in parts {
        channels.iter_mut().zip(part).for_each(|(channel, more)| channel.extend(more));
    }
    channels
}

impl Part<'_> {
    fn channels(&self, scene: &Scene, quantity: Quantity) -> Vec<Vec<f32>> {
        if quantity.is_geometric() {
            self.geometric_channels(scene, quantity)
        } else {
            vec![self.radiometric(scene, quantity)]
        }
    }

    fn radiometric(&self, scene: &Scene, quantity: Quantity) -> Vec<f32> {
        self.by_pixel(|index, pixel| {
            radiometric(scene, self.optics, self.view, quantity, pixel, &self.samples.pixels[index])
        })
    }

    fn geometric_channels(&self, scene: &Scene, quantity: Quantity) -> Vec<Vec<f32>> {
        let values = self.by_pixel(|index, pixel| {
            geometric(scene, self.optics, self.view, quantity, pixel, self.samples.centres[index].as_ref())
        });
        (0..quantity.channels().len()).map(|channel| values.iter().map(|value| value[channel]).collect()).collect()
    }

    /// One value a pixel, from its index and its image coordinates.
    fn by_pixel<T: Send>(&self, value: impl Fn(usize, DVec2) -> T + Sync) -> Vec<T> {
        let (columns, rows) = (self.optics.columns as usize, self.optics.rows as usize);
        let at = |index: usize| value(index, DVec2::new((index % columns) as f64, (index / columns) as f64));
        (0..columns * rows).into_par_iter().map(at).collect()
    }
}

/// Irradiance of the focal plane, all parts.
pub fn focal_plane_irradiance(scene: &Scene, parts: &[Part]) -> Vec<f32> {
    parts.iter().flat_map(|part| part.radiometric(scene, Quantity::FocalPlaneIrradiance)).collect()
}

/// What the detector makes of the focal plane's irradiance; empty where there is no detector.
fn digital_numbers(
    scene: &Scene,
    detector: Option<&Detector>,
    parts: &[Part],
    quantity: Quantity,
    columns: usize,
) -> Vec<f32> {
    let Some((detector, part)) = detector.zip(parts.first()) else { return Vec::new() };
    let light = focal_plane_irradiance(scene, parts);
    let numbers = match quantity {
        Quantity::DigitalNumber => detector.expose(&light, columns, part.view.exposure),
        _ => detector.expose_without_noise(&light, columns),
    };
    numbers.into_iter().map(f32::from).collect()
}

fn radiometric(
    scene: &Scene,
    optics: &Optics,
    view: &View,
    quantity: Quantity,
    pixel: DVec2,
    mean: &Radiometry,
) -> f32 {
    let per_nm = |value: f32| (f64::from(value) / scene.band_width_nm.unwrap_or(f64::NAN)) as f32;
    match quantity {
        Quantity::Radiance => mean.radiance_w_m2_sr,
        Quantity::GroundIrradiance => mean.irradiance_w_m2,
        Quantity::SpectralRadiance => per_nm(mean.radiance_w_m2_sr),
        Quantity::SpectralGroundIrradiance => per_nm(mean.irradiance_w_m2),
        Quantity::SunFraction => mean.sun_fraction,
        Quantity::Hit => mean.hit,
        Quantity::SunIlluminationMask if mean.sun_fraction.is_nan() => f32::NAN,
        Quantity::SunIlluminationMask => f32::from(u8::from(mean.sun_fraction >= LIT_SHARE)),
        Quantity::RadianceFactor => {
            let facing_w_m2 = view.lights.first().map_or(f64::NAN, |sun| sun.irradiance_w_m2);
            (f64::from(mean.radiance_w_m2_sr) * std::f64::consts::PI / facing_w_m2) as f32
        }
        Quantity::FocalPlaneIrradiance => {
            let factor_sr = optics.irradiance_per_radiance_sr(pixel).unwrap_or(f64::NAN);
            (f64::from(mean.radiance_w_m2_sr) * factor_sr) as f32
        }
        _ => unreachable!("{quantity:?} is no mean over samples"),
    }
}

fn geometric(
    scene: &Scene,
    optics: &Optics,
    view: &View,
    quantity: Quantity,
    pixel: DVec2,
    hit: Option<&Hit>,
) -> [f32; 3] {
    let single = |value: f64| [value as f32, 0.0, 0.0];
    let is_gap = hit.is_some_and(|hit| hit.ground == Ground::Gap);
    if quantity == Quantity::DemGap {
        return single(f64::from(u8::from(is_gap)));
    }
    let Some(hit) = hit.filter(|_| !is_gap) else { return [f32::NAN; 3] };
    let body = &scene.surface.terrain.body;
    let to_camera = hit.position.direction_to(view.camera_position);
    let to_sun = view.lights.first().and_then(|sun| hit.position.direction_to(sun.position));
    let normal = normal(scene, hit);
    let angle = |a: Option<Direction<BodyFixed>>, b: Option<Direction<BodyFixed>>| {
        single(a.zip(b).map_or(f64::NAN, |(a, b)| a.angle_to(b).to_degrees()))
    };
    match quantity {
        Quantity::SunFractionSigma => single(refine::sun_fraction_sigma(scene, view, hit)),
        Quantity::Range => single(hit.distance_m),
        Quantity::Depth => {
            let boresight = view.camera_from_body.inverse().turn(DVec3::Z);
            single((hit.position.vector_m() - view.camera_position.vector_m()).dot(boresight))
        }
        Quantity::Normal => normal.unit().as_vec3().to_array(),
        Quantity::Latitude => single(body.geodetic_from_position(hit.position).latitude_rad.to_degrees()),
        Quantity::Longitude => {
            single(body.geodetic_from_position(hit.position).longitude_east_rad.to_degrees().rem_euclid(360.0))
        }
        Quantity::Height => single(body.geodetic_from_position(hit.position).height_m),
        Quantity::Incidence => angle(Some(normal), to_sun),
        Quantity::Emission => angle(Some(normal), to_camera),
        Quantity::Phase => angle(to_sun, to_camera),
        Quantity::EllipsoidIncidence => angle(Some(bare_normal(scene, hit.position)), to_sun),
        Quantity::EllipsoidEmission => angle(Some(bare_normal(scene, hit.position)), to_camera),
        Quantity::Slope => angle(Some(bare_normal(scene, hit.position)), Some(normal)),
        Quantity::Aspect => single(azimuth_deg(local_m(scene, hit, normal.unit()))),
        Quantity::SubsolarGroundAzimuth => {
            single(to_sun.map_or(f64::NAN, |to_sun| azimuth_deg(local_m(scene, hit, to_sun.unit()))))
        }
        Quantity::NorthAzimuth => single(image_azimuth_deg(scene, optics, view, hit, DVec3::Y)),
        Quantity::SunAzimuth => single(to_sun.map_or(f64::NAN, |to_sun| {
            let local = local_m(scene, hit, to_sun.unit());
            image_azimuth_deg(scene, optics, view, hit, local.with_z(0.0))
        })),
        Quantity::GroundSampleDistance => single(hit.distance_m * pixel_angle_rad(optics, pixel)),
        _ => unreachable!("{quantity:?} is radiometric"),
    }
}

/// The angle between a pixel's ray and the next column's.
pub fn pixel_angle_rad(optics: &Optics, pixel: DVec2) -> f64 {
    let here = optics.direction(pixel);
    let next = optics.direction(pixel + DVec2::X);
    here.zip(next).map_or(f64::NAN, |(here, next)| here.angle_to(next))
}

/// East, north and up components at a hit.
fn local_m(scene: &Scene, hit: &Hit, vector_m: DVec3) -> DVec3 {
    let body = &scene.surface.terrain.body;
    body.local_from_body(body.geodetic_from_position(hit.position)).turn(vector_m)
}

/// Azimuth of a local vector, clockwise from north, 0 to 360.
fn azimuth_deg(local: DVec3) -> f64 {
    local.x.atan2(local.y).to_degrees().rem_euclid(360.0)
}

/// Way along the ground over which a direction in the image is taken, per distance of the camera: less than a pixel, more than
/// rounding.
const AZIMUTH_STEP: f64 = 1e-4;

/// How a horizontal local direction looks in the image, from right towards down, 0 to 360.
fn image_azimuth_deg(scene: &Scene, optics: &Optics, view: &View, hit: &Hit, local: DVec3) -> f64 {
    let body = &scene.surface.terrain.body;
    let along =
        body.local_from_body(body.geodetic_from_position(hit.position)).inverse().turn(local.normalize_or_zero());
    let pixel = |sign: f64| {
        let point_m = hit.position.vector_m() + sign * AZIMUTH_STEP * hit.distance_m * along;
        let direction = Direction::new(view.camera_from_body.turn(point_m - view.camera_position.vector_m()))?;
        optics.pixel(direction)
    };
    let step = pixel(1.0).zip(pixel(-1.0)).map_or(DVec2::NAN, |(ahead, behind)| ahead - behind);
    step.y.atan2(step.x).to_degrees().rem_euclid(360.0)
}

/// The outward normal of the ground at a hit, interpolated between the nodes' central differences.
pub fn normal(scene: &Scene, hit: &Hit) -> Direction<BodyFixed> {
    let terrain = &scene.surface.terrain;
    match hit.ground {
        Ground::Dem { face, level, lifted } => {
            let face = &terrain.faces[face];
            let gradient = face.levels[level].interpolated_gradient(lifted.truncate());
            face.map.map_from_body.inverse() * face.map.normal(lifted, gradient)
        }
        Ground::Bare | Ground::Gap => bare_normal(scene, hit.position),
    }
}

fn bare_normal(scene: &Scene, position: Position<BodyFixed>) -> Direction<BodyFixed> {
    let body = &scene.surface.terrain.body;
    body.up(body.geodetic_from_position(position))
}
