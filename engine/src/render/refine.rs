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
//! What it gains: `docs/experiments/shadow_methods.md`.
//!
//! # Assumptions
//! Bounds fail for one node in twenty at some azimuth. A penumbra thinner than a pixel that passes between
//! the centres of a device's pixels is not traced.

use super::facet::{normal, site};
use super::{Scene, View};
use crate::photometry::DiskLight;
use crate::shadow::registry::reference_shadow;
use crate::shadow::{BoundedShadow, Disc, Shadow, Site};
use crate::terrain::{Ground, Hit};

/// Horizon maps, and tracing where they leave the Sun's share open.
#[derive(Debug)]
pub struct UncertainTraced<'a> {
    pub maps: Box<dyn BoundedShadow + 'a>,
    traced: Box<dyn Shadow + 'a>,
}

impl<'a> UncertainTraced<'a> {
    /// `None` where the scene asks for no refinement, or has no horizon maps.
    pub fn of(scene: &'a Scene) -> Option<Self> {
        let (surface, settings) = (&scene.surface, scene.refine?);
        let maps = scene.shadows.bounded(surface)?;
        Some(Self { maps, traced: reference_shadow(surface, settings) })
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
pub fn is_open(scene: &Scene, view: &View, maps: &dyn BoundedShadow, hit: &Hit) -> bool {
    let light = view.lights.first().map(|light| (0, light));
    light
        .and_then(|light| site(scene, hit, normal(scene, hit), light))
        .is_some_and(|(site, disc)| maps.is_open(&site, &disc))
}

/// Standard deviation of the Sun's share at a hit; NaN where nothing is known of it.
pub fn sun_fraction_sigma(scene: &Scene, view: &View, hit: &Hit) -> f64 {
    let Some(sun) = view.lights.first() else { return f64::NAN };
    if hit.ground == Ground::Bare || scene.shadows.is_exact() {
        return 0.0;
    }
    let Some(maps) = scene.shadows.bounded(&scene.surface) else { return f64::NAN };
    let Some((site, disc)) = site(scene, hit, normal(scene, hit), (0, sun)) else { return f64::NAN };
    let is_traced = scene.refine.is_some() && maps.is_open(&site, &disc);
    if is_traced { 0.0 } else { maps.sigma(&site, &disc).unwrap_or(f64::NAN) }
}
