//! What an exposure's image will show, by a few rays: kinds of ground, resolution, Sun, light without cast shadows.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::ephemeris::{Horizontal, horizontal};
use crate::geometry::Geodetic;
use crate::pipeline::{Error, Exposure};
use crate::raster;
use crate::render::planes::{Part, focal_plane_irradiance};
use crate::render::{Rays, Scene, reference};
use crate::terrain::{Ground, Hit};

/// Rays along a side of the image.
const SIDE: u32 = 16;

/// What the rays of an exposure meet.
#[derive(Debug, Clone)]
pub struct Look {
    pub rays: usize,
    /// Of them, those that meet ground with heights.
    pub on_models: usize,
    /// Ground without heights, inside or beside the models.
    pub in_gaps: usize,
    /// The bare spheroid.
    pub on_bare: usize,
    /// Of those on ground, how many the albedo map covers; `None`: there is no map.
    pub on_albedo: Option<usize>,
    /// Ground over whose level horizon some of the Sun stands.
    pub sun_up: usize,
    /// The ground nearest to the image's middle, and the Sun there; of an image without ground, the place below the camera.
    pub target: Geodetic,
    pub sun: Horizontal,
    /// From pixel to pixel on a plane that faces the camera; `None`: no ground.
    pub pixel_m: Option<[f64; 2]>,
    /// Above the ground below the camera.
    pub height_m: f64,
    /// Of the rays on ground that no cast shadow darkens.
    pub radiance_w_m2_sr: Vec<f32>,
    /// The same on the focal plane.
    pub focal_w_m2: Vec<f32>,
}

/// A map of albedos, and what its values multiply the light by.
#[derive(Debug)]
pub struct AlbedoMap {
    pub dem: raster::Dem,
    pub scale: f64,
}

impl Look {
    /// `scene` has no shadows; it is asked for the ground alone.
    pub fn of(scene: &Scene, albedo: Option<&AlbedoMap>, exposure: &Exposure) -> Result<Self, Error> {
        let view = &exposure.view;
        let full = &view.optics;
        let optics = full.resized(full.columns.min(SIDE), full.rows.min(SIDE));
        let shrinks = f64::from(full.columns) * f64::from(full.rows) / f64::from(optics.columns * optics.rows);
        let rays = Rays { optics: optics.clone(), samples_per_side: 1, centres: true };
        let samples = reference::follow(scene, &rays, view)?;
        let factors = albedo.map(|map| map.factors(&samples.centres)).transpose()?;
        let mut samples = samples;
        for (pixel, factor) in samples.pixels.iter_mut().zip(factors.iter().flatten()) {
            pixel.radiance_w_m2_sr *= factor;
        }
        let light = focal_plane_irradiance(&[Part { optics: &optics, view, samples: &samples }]);
        let pixel = |index: usize| {
            let columns = optics.columns as usize;
            DVec2::new((index % columns) as f64, (index / columns) as f64)
        };
        let hits: Vec<(usize, &Hit)> =
            samples.centres.iter().enumerate().filter_map(|(index, hit)| Some((index, hit.as_ref()?))).collect();
        let body = &scene.surface.terrain.body;
        let middle = DVec2::new(f64::from(optics.columns), f64::from(optics.rows)) / 2.0 - 0.5;
        let nearest = hits
            .iter()
            .min_by(|a, b| pixel(a.0).distance_squared(middle).total_cmp(&pixel(b.0).distance_squared(middle)))
            .map_or(view.camera_position, |(_, hit)| hit.position);
        let target = body.geodetic_from_position(nearest);
        let kind = |wanted: fn(Ground) -> bool| hits.iter().filter(|(_, hit)| wanted(hit.ground)).count();
        let sizes = hits
            .iter()
            .filter_map(|(index, hit)| Some(hit.distance_m * (optics.solid_angle_sr(pixel(*index))? / shrinks).sqrt()));
        let sun_at = |place: Geodetic| horizontal(body, place, exposure.sun.direction);
        let sun_up = hits.iter().filter(|(_, hit)| {
            let elevation_rad = sun_at(body.geodetic_from_position(hit.position)).elevation_rad;
            elevation_rad > -exposure.sun.angular_radius_rad
        });
        let lit = |index: &usize| samples.pixels[*index].radiance_w_m2_sr.is_finite();
        let seen: Vec<usize> = hits.iter().map(|(index, _)| *index).filter(lit).collect();
        Ok(Self {
            rays: samples.centres.len(),
            on_models: kind(|ground| matches!(ground, Ground::Dem { .. })),
            in_gaps: kind(|ground| ground == Ground::Gap),
            on_bare: kind(|ground| ground == Ground::Bare),
            on_albedo: factors.map(|factors| hits.iter().filter(|(index, _)| factors[*index].is_finite()).count()),
            sun_up: sun_up.count(),
            sun: sun_at(target),
            target,
            pixel_m: least_and_greatest(sizes),
            height_m: scene.surface.ground_below(view.camera_position).distance_m,
            radiance_w_m2_sr: seen.iter().map(|index| samples.pixels[*index].radiance_w_m2_sr).collect(),
            focal_w_m2: seen.iter().map(|index| light[*index]).collect(),
        })
    }

    /// Rays that meet the body.
    pub fn on_ground(&self) -> usize {
        self.on_models + self.in_gaps + self.on_bare
    }
}

impl AlbedoMap {
    /// What multiplies the light of each hit; NaN beyond the map, 1 in the sky.
    fn factors(&self, hits: &[Option<Hit>]) -> Result<Vec<f32>, Error> {
        let ground: Vec<_> = hits.iter().flatten().map(|hit| hit.position).collect();
        let mut pixels = self.dem.georeference.projector()?.pixels(&ground).into_iter();
        let factor = |hit: &Option<Hit>| match hit {
            Some(_) => pixels.next().map_or(f32::NAN, |pixel| (self.scale * self.dem.bilinear_m(pixel)) as f32),
            None => 1.0,
        };
        Ok(hits.iter().map(factor).collect())
    }
}

/// `None` of nothing.
pub fn least_and_greatest(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    values.into_iter().filter(|value| value.is_finite()).fold(None, |range, value| {
        Some(range.map_or([value; 2], |[low, high]: [f64; 2]| [low.min(value), high.max(value)]))
    })
}

/// Azimuths from the first clockwise or anticlockwise to where they end, whichever is the shorter way to all of them.
pub fn azimuths(values_rad: &[f64]) -> Option<[f64; 2]> {
    let first = *values_rad.first()?;
    let turn = |value: &f64| (value - first + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
    let [low, high] = least_and_greatest(values_rad.iter().map(turn))?;
    Some([first + low, first + high])
}
