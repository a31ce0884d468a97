//! What compressed horizons leave uncertain, told or traced.
//!
//! A map knows how far its skyline may be off at each node: a bound `B` that holds at all azimuths, and a standard deviation
//! `σ` ([`crate::horizon::bound`]). With `V(h)` the share of the Sun's disc above a skyline at elevation `h`
//!
//! ```text
//! uncertainty of the share    |V(h + σ) − V(h − σ)| / 2
//! open                        V(h + B) ≠ V(h − B)
//! ```
//!
//! [`UncertainTraced`] traces the Sun's light where a site is open; the bound says that elsewhere tracing would change nothing.
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
//! the centres of a device's pixels is not traced.

use super::facet::{normal, site};
use super::{Scene, Shadows, View};
use crate::photometry::DiskLight;
use crate::shadow::{Disc, FourierMaps, Shadow, Site, Traced};
use crate::terrain::{Ground, Hit};

/// Horizon maps, and tracing where they leave the Sun's share open.
#[derive(Debug)]
pub struct UncertainTraced<'a> {
    pub maps: FourierMaps<'a>,
    traced: Traced<'a>,
}

impl<'a> UncertainTraced<'a> {
    /// `None` where the scene asks for no refinement, or has no horizon maps.
    pub fn of(scene: &'a Scene) -> Option<Self> {
        let (surface, settings) = (&scene.surface, scene.refine?);
        let maps = FourierMaps { surface, maps: scene.shadows.maps()? };
        Some(Self { maps, traced: Traced { surface, settings } })
    }
}

impl Shadow for UncertainTraced<'_> {
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
pub fn is_open(scene: &Scene, view: &View, maps: &FourierMaps, hit: &Hit) -> bool {
    let light = view.lights.first().map(|light| (0, light));
    light
        .and_then(|light| site(scene, hit, normal(scene, hit), light))
        .is_some_and(|(site, disc)| maps.is_open(&site, &disc))
}

/// Standard deviation of the Sun's share at a hit; NaN where nothing is known of it.
pub fn sun_fraction_sigma(scene: &Scene, view: &View, hit: &Hit) -> f64 {
    let Some(sun) = view.lights.first() else { return f64::NAN };
    match (hit.ground, scene.shadows.as_ref(), scene.shadows.maps()) {
        (Ground::Bare, ..) | (_, Shadows::Traced(_), _) => 0.0,
        (_, _, Some(maps)) => {
            let maps = FourierMaps { surface: &scene.surface, maps };
            let Some((site, disc)) = site(scene, hit, normal(scene, hit), (0, sun)) else { return f64::NAN };
            let traced = scene.refine.is_some() && maps.is_open(&site, &disc);
            if traced { 0.0 } else { maps.sigma(&site, &disc).unwrap_or(f64::NAN) }
        }
        _ => f64::NAN,
    }
}
