//! From what a renderer sampled to the planes that the user asked for.
//!
//! Radiometric planes are means over a pixel's samples. Geometric planes belong to the ray through the
//! pixel's centre and are computed here in f64, for every renderer alike.

mod seen;

use std::cell::OnceCell;

use glam::DVec2;
use rayon::prelude::*;

pub use super::facet::normal;
use super::{Image, Plane, Quantity, Scene, View};
use crate::camera::{Camera as Optics, Detector};
use crate::terrain::Hit;
use seen::{Found, Seen};

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

/// From this share of the Sun's disc on a pixel is lit.
pub const LIT_SHARE: f32 = 0.5;

/// Rows of an image that are seen through one part of the optics from one pose.
#[derive(Debug, Clone, Copy)]
pub struct Part<'a> {
    pub optics: &'a Optics,
    pub view: &'a View,
    pub samples: &'a Samples,
}

/// The planes of `view.quantities`, but for labels, of an image that is taken at once.
pub fn image(scene: &Scene, view: &View, samples: &Samples) -> Image {
    image_of(scene, view.detector.as_ref(), &[Part { optics: &view.optics, view, samples }])
}

/// The planes of an image of parts, but for labels, the upper one first.
pub fn image_of(scene: &Scene, detector: Option<&Detector>, parts: &[Part]) -> Image {
    let rows = parts.iter().map(|part| part.optics.rows as usize).sum();
    let columns = parts.first().map_or(0, |part| part.optics.columns as usize);
    let asked = parts.first().map_or(&[][..], |part| &part.view.quantities);
    let wanted: Vec<Quantity> = asked.iter().copied().filter(|quantity| !quantity.is_label()).collect();
    let geometric: Vec<Quantity> = wanted.iter().copied().filter(|quantity| quantity.is_geometric()).collect();
    let mut geometry = joined(parts.iter().map(|part| part.geometric_channels(scene, &geometric))).into_iter();
    let light = OnceCell::new();
    let light = || light.get_or_init(|| focal_plane_irradiance(parts)).as_slice();
    let planes = wanted.iter().flat_map(|&quantity| {
        let channels = match quantity {
            _ if quantity.is_geometric() => geometry.by_ref().take(quantity.channels().len()).collect(),
            Quantity::DigitalNumber | Quantity::NoiseFreeDigitalNumber => {
                vec![digital_numbers(detector, parts, quantity, light, columns)]
            }
            Quantity::FocalPlaneIrradiance => vec![light().to_vec()],
            _ => vec![parts.iter().flat_map(|part| part.radiometric(quantity)).collect()],
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
    fn radiometric(&self, quantity: Quantity) -> Vec<f32> {
        let columns = self.optics.columns as usize;
        let value = |(index, mean): (usize, &Radiometry)| {
            let pixel = DVec2::new((index % columns) as f64, (index / columns) as f64);
            radiometric(self.optics, self.view, quantity, pixel, mean)
        };
        self.samples.pixels.par_iter().enumerate().map(value).collect()
    }

    /// The channels of all these quantities, one after the other.
    fn geometric_channels(&self, scene: &Scene, quantities: &[Quantity]) -> Vec<Vec<f32>> {
        if quantities.is_empty() {
            return Vec::new();
        }
        let columns = self.optics.columns as usize;
        let channels: usize = quantities.iter().map(|quantity| quantity.channels().len()).sum();
        // A row of all channels at a time: what planes share is found once a pixel.
        let row = |(row, centres): (usize, &[Option<Hit>])| {
            let mut values = vec![0.0; channels * columns];
            for (column, hit) in centres.iter().enumerate() {
                let (Self { optics, view, .. }, hit) = (*self, hit.as_ref());
                let pixel = DVec2::new(column as f64, row as f64);
                let seen = Seen { scene, optics, view, pixel, hit, found: Found::default() };
                let pixel_values = quantities.iter().flat_map(|quantity| {
                    let values = seen.values(*quantity);
                    values.into_iter().take(quantity.channels().len())
                });
                values[column..].iter_mut().step_by(columns).zip(pixel_values).for_each(|(to, value)| *to = value);
            }
            values
        };
        let rows: Vec<Vec<f32>> = self.samples.centres.par_chunks(columns).enumerate().map(row).collect();
        let channel = |channel: usize| {
            let lines: Vec<&[f32]> = rows.iter().map(|row| &row[channel * columns..][..columns]).collect();
            lines.concat()
        };
        (0..channels).into_par_iter().map(channel).collect()
    }
}

/// Irradiance of the focal plane, all parts.
pub fn focal_plane_irradiance(parts: &[Part]) -> Vec<f32> {
    parts.iter().flat_map(|part| part.radiometric(Quantity::FocalPlaneIrradiance)).collect()
}

/// What the detector makes of the focal plane's irradiance; empty where there is no detector.
fn digital_numbers<'a>(
    detector: Option<&Detector>,
    parts: &[Part],
    quantity: Quantity,
    light: impl Fn() -> &'a [f32],
    columns: usize,
) -> Vec<f32> {
    let Some((detector, part)) = detector.zip(parts.first()) else { return Vec::new() };
    let numbers = match quantity {
        Quantity::DigitalNumber => detector.expose(light(), columns, part.view.exposure),
        _ => detector.expose_without_noise(light(), columns),
    };
    numbers.into_iter().map(f32::from).collect()
}

fn radiometric(optics: &Optics, view: &View, quantity: Quantity, pixel: DVec2, mean: &Radiometry) -> f32 {
    let per_nm = |value: f32| (f64::from(value) / view.band_width_nm.unwrap_or(f64::NAN)) as f32;
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

/// The angle between a pixel's ray and the next column's.
pub fn pixel_angle_rad(optics: &Optics, pixel: DVec2) -> f64 {
    let here = optics.direction(pixel);
    let next = optics.direction(pixel + DVec2::X);
    here.zip(next).map_or(f64::NAN, |(here, next)| here.angle_to(next))
}
