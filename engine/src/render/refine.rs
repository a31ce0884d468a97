//! What compressed horizons leave open, told or settled by tracing.
//!
//! A map knows how far its skyline may be off at each node: a bound `B` that holds at all azimuths, and a standard deviation
//! `σ` ([`crate::horizon::bound`]). With `V(h)` the share of the Sun's disc above a skyline at elevation `h`
//!
//! ```text
//! uncertainty of the share    |V(h + σ) − V(h − σ)| / 2
//! open                        V(h + B) ≠ V(h − B)
//! ```
//!
//! [`Settled`] traces the Sun's light where a site is open; the bound says that elsewhere tracing would change nothing.
//! The reference renderer asks at every sample. A device renders all samples from the maps, and the host
//! renders again each pixel whose centre is open or, where a pixel has more samples than its centre, a neighbour's is.
//!
//! Measured on the connecting ridge, Sun at 1.9°, 256² pixels, against tracing every pixel, in full Suns:
//!
//! | | RMS | RMS in the penumbra | largest | shares off by 0.01 |
//! |---|---|---|---|---|
//! | maps (`w21`) | 0.0024 | 0.0155 | 0.19 | 1.40 % |
//! | refined | 0.0003 | 0.0017 | 0.03 | 0.18 % |
//!
//! # Assumptions
//! Bounds fail for one node in twenty at some azimuth. A penumbra thinner than a pixel that passes between
//! the centres of a device's pixels is not settled.

use glam::DVec2;
use rayon::prelude::*;

use super::planes::{Samples, normal};
use super::reference::{self, Lighting, site};
use super::{Diffuse, Rays, Scene, Shadows, View};
use crate::photometry::DiskLight;
use crate::shadow::{Disc, FourierMaps, Shadow, Site, Traced};
use crate::terrain::{Ground, Hit};

/// Horizon maps, and tracing where they leave the Sun's share open.
#[derive(Debug)]
pub struct Settled<'a> {
    maps: FourierMaps<'a>,
    traced: Traced<'a>,
}

impl<'a> Settled<'a> {
    /// `None` where the scene asks for no refinement, or has no horizon maps.
    pub fn of(scene: &'a Scene) -> Option<Self> {
        let (surface, settings) = (&scene.surface, scene.refine?);
        let maps = FourierMaps { surface, maps: scene.shadows.maps()? };
        Some(Self { maps, traced: Traced { surface, settings } })
    }
}

impl Shadow for Settled<'_> {
    fn light(&self, site: &Site, disc: &Disc) -> DiskLight {
        // Earthshine is 1e-4 of sunlight.
        if disc.light == 0 && self.maps.is_open(site, disc) {
            self.traced.light(site, disc)
        } else {
            self.maps.light(site, disc)
        }
    }
}

/// Whether the Sun's share at a hit is open.
fn is_open(scene: &Scene, view: &View, maps: &FourierMaps, hit: &Hit) -> bool {
    let light = view.lights.first().map(|light| (0, light));
    light
        .and_then(|light| site(scene, hit, normal(scene, hit), light))
        .is_some_and(|(site, disc)| maps.is_open(&site, &disc))
}

/// Standard deviation of the Sun's share at a hit; NaN where nothing is known of it.
pub fn sun_fraction_sigma(scene: &Scene, view: &View, hit: &Hit) -> f64 {
    let Some(sun) = view.lights.first() else { return f64::NAN };
    match (hit.ground, &scene.shadows, scene.shadows.maps()) {
        (Ground::Bare, ..) | (_, Shadows::Traced(_), _) => 0.0,
        (_, _, Some(maps)) => {
            let maps = FourierMaps { surface: &scene.surface, maps };
            let Some((site, disc)) = site(scene, hit, normal(scene, hit), (0, sun)) else { return f64::NAN };
            let settled = scene.refine.is_some() && maps.is_open(&site, &disc);
            if settled { 0.0 } else { maps.sigma(&site, &disc).unwrap_or(f64::NAN) }
        }
        _ => f64::NAN,
    }
}

/// Renders again what a device's samples leave open.
pub fn settle(scene: &Scene, rays: &Rays, view: &View, diffuse: Option<&Diffuse>, samples: &mut Samples) {
    let Some(settled) = Settled::of(scene) else { return };
    let (columns, rows) = (rays.optics.columns as usize, rays.optics.rows as usize);
    let is_open = |hit: &Option<Hit>| hit.as_ref().is_some_and(|hit| is_open(scene, view, &settled.maps, hit));
    let open: Vec<bool> = samples.centres.par_iter().map(is_open).collect();
    let reach = usize::from(rays.samples_per_side > 1);
    let concerned = |index: usize| {
        let near = |at: usize, count: usize| at.saturating_sub(reach)..(at + reach + 1).min(count);
        let (column, row) = (index % columns, index / columns);
        near(row, rows).any(|row| near(column, columns).any(|column| open[row * columns + column]))
    };
    let offsets = rays.offsets();
    samples.pixels.par_iter_mut().enumerate().filter(|(index, _)| concerned(*index)).for_each(|(index, pixel)| {
        let at = DVec2::new((index % columns) as f64, (index / columns) as f64);
        let lighting = Lighting { shadow: Some(&settled), diffuse };
        *pixel = reference::mean(scene, &rays.optics, view, lighting, at, &offsets);
    });
}
