//! The reference renderer: f64, one ray at a time, meant to be read.
//!
//! ```text
//! L = Σ lights  f_r(μ0, μ, g) · E,    E = E_n [V (n·s) + ρ (M_x n·e_x + M_y n·e_y)]
//! ```
//!
//! `V` and `M` are the share and the first moment of the disc's light above the skyline and above the
//! facet's own plane (`photometry::solar_disk`), `ρ` the disc's angular radius, `f_r` the BRDF. `μ0` is
//! taken at the centroid of the visible part, `E/(E_n V)`, which stays positive where the disc's centre has
//! set behind the facet.
//!
//! `passes` renders the same on the GPU; `tests/conformance` holds the two together.

use std::sync::Arc;

use glam::DVec2;
use rayon::prelude::*;

use super::direct::illuminate;
use super::facet::{albedo, normal};
use super::planes::{Radiometry, Samples};
use super::refine::UncertainTraced;
use super::{Diffuse, Rays, RenderError, Scene, View, sky_reflectance};
use crate::camera::Camera as Optics;
use crate::geometry::{Camera, Direction};
use crate::shadow::{Shadow, Skylines, UnpreparedLight};
use crate::terrain::{Ground, Hit};

/// What manifests call this renderer.
pub const NAME: &str = "reference renderer (CPU, f64)";

/// What some rays from a view's pose see: on the CPU, in f64, on all cores.
pub fn follow(scene: &Scene, rays: &Rays, view: &View) -> Result<Samples, RenderError> {
    let shadow = shadow(scene, view, &Skylines::default())?;
    let sky = sky_reflectance(scene, &view.reflectance).map(Arc::new);
    let diffuse = Diffuse::of(scene, view, shadow.as_deref(), sky);
    let lighting = Lighting { shadow: shadow.as_deref(), diffuse: &diffuse };
    let offsets = rays.offsets();
    let (columns, rows) = (rays.optics.columns as usize, rays.optics.rows as usize);
    let pixel = |index: usize| DVec2::new((index % columns) as f64, (index / columns) as f64);
    let pixels = (0..columns * rows)
        .into_par_iter()
        .map(|index| mean(scene, &rays.optics, view, lighting, pixel(index), &offsets))
        .collect();
    let centres = if rays.centres {
        (0..columns * rows).into_par_iter().map(|index| look(scene, &rays.optics, view, pixel(index))).collect()
    } else {
        Vec::new()
    };
    Ok(Samples { pixels, centres })
}

/// What decides how bright the ground of a view is, besides the view's own lights.
#[derive(Debug, Clone, Copy)]
pub struct Lighting<'a> {
    pub shadow: Option<&'a dyn Shadow>,
    pub diffuse: &'a Diffuse<'a>,
}

/// The scene's method of shadows, with whatever it finds in advance for a view's lights and `known` does not hold already.
pub fn shadow<'a>(
    scene: &'a Scene,
    view: &View,
    known: &Skylines,
) -> Result<Option<Box<dyn Shadow + 'a>>, UnpreparedLight> {
    if let Some(shadow) = UncertainTraced::of(scene) {
        return Ok(Some(Box::new(shadow)));
    }
    scene.shadows.shadow(&scene.surface, &scene.disk, &view.quantized_lights(), known)
}

/// Share of the Sun's disc that a point of the ground sees; NaN on ground without heights.
pub fn sun_fraction(scene: &Scene, view: &View, shadow: Option<&dyn Shadow>, hit: &Hit) -> f64 {
    match view.lights.first() {
        Some(sun) if hit.ground != Ground::Gap => illuminate(scene, shadow, hit, normal(scene, hit), (0, sun)).fraction,
        _ => f64::NAN,
    }
}

/// What the ray through an image point meets.
fn look(scene: &Scene, optics: &Optics, view: &View, pixel: DVec2) -> Option<Hit> {
    let direction: Direction<Camera> = optics.direction(pixel)?;
    scene.surface.intersect(view.camera_position, view.camera_from_body.inverse() * direction)
}

/// What a pixel's samples see on average.
pub fn mean(
    scene: &Scene,
    optics: &Optics,
    view: &View,
    lighting: Lighting,
    pixel: DVec2,
    offsets: &[DVec2],
) -> Radiometry {
    let mut sum = Sample::default();
    let mut hits = 0.0;
    for &offset in offsets {
        let Some(hit) = look(scene, optics, view, pixel + offset) else { continue };
        let sample = shade(scene, view, lighting, &hit);
        sum.radiance += sample.radiance;
        sum.irradiance += sample.irradiance;
        sum.fraction += sample.fraction;
        hits += 1.0;
    }
    Radiometry {
        radiance_w_m2_sr: (sum.radiance / offsets.len() as f64) as f32,
        irradiance_w_m2: (sum.irradiance / hits) as f32,
        sun_fraction: (sum.fraction / hits) as f32,
        hit: (hits / offsets.len() as f64) as f32,
    }
}

#[derive(Debug, Clone, Copy, Default)]
struct Sample {
    radiance: f64,
    irradiance: f64,
    fraction: f64,
}

/// Radiance towards the camera, and irradiance and share of the first light, at a hit.
fn shade(scene: &Scene, view: &View, lighting: Lighting, hit: &Hit) -> Sample {
    if hit.ground == Ground::Gap {
        return Sample { radiance: f64::NAN, irradiance: f64::NAN, fraction: f64::NAN };
    }
    let to_camera = hit.position.direction_to(view.camera_position);
    let normal = normal(scene, hit);
    let law = &view.reflectance;
    let albedo = albedo(scene, law, hit);
    let mut sample = Sample::default();
    for (index, light) in view.lights.iter().enumerate() {
        let lit = illuminate(scene, lighting.shadow, hit, normal, (index, light));
        let Some((to_camera, to_light)) = to_camera.zip(hit.position.direction_to(light.position)) else { continue };
        if lit.irradiance > 0.0 {
            let mu0 = (lit.irradiance / (light.irradiance_w_m2 * lit.fraction)).min(1.0);
            let mu = normal.unit().dot(to_camera.unit()).max(0.0);
            let cos_phase = to_light.unit().dot(to_camera.unit());
            sample.radiance += scene.brdf_sr(law, albedo, mu0, mu, cos_phase) * lit.irradiance;
        }
        if index == 0 {
            (sample.irradiance, sample.fraction) = (lit.irradiance, lit.fraction);
        }
    }
    if let Some(to_camera) = to_camera {
        let mu = normal.unit().dot(to_camera.unit()).max(0.0);
        sample.radiance += lighting.diffuse.radiance(scene, view, hit, (to_camera, mu));
    }
    sample
}
