//! Light that does not come from a light's disc: from an even sky, and from other ground.
//!
//! The ground reflects the sky's as [`SkyReflectance`] says, and that of other ground as light from the directions that it comes
//! from, see [`super::bounce`].

use std::f64::consts::PI;
use std::sync::Arc;

use super::bounced_light::BouncedLight;
use super::facet::{albedo, at_nodes};
use super::{Ambient, Scene, View};
use crate::geometry::{BodyFixed, Direction};
use crate::photometry::{Reflectance, SkyReflectance};
use crate::shadow::Shadow;
use crate::terrain::Hit;

/// Diffuse light of a view's ground.
#[derive(Debug)]
pub struct Diffuse<'a> {
    sky: Option<Sky<'a>>,
    /// `None`: ground bounces none.
    pub bounced: Option<BouncedLight<'a>>,
}

/// An even sky, and how the view's ground reflects it.
#[derive(Debug)]
struct Sky<'a> {
    ambient: &'a Ambient,
    reflectance: Arc<SkyReflectance>,
}

impl<'a> Diffuse<'a> {
    /// With what [`sky_reflectance`] says of the view's law.
    pub fn of(scene: &'a Scene, view: &View, shadow: Option<&dyn Shadow>, sky: Option<Arc<SkyReflectance>>) -> Self {
        let sky = scene.ambient.as_deref().zip(sky).map(|(ambient, reflectance)| Sky { ambient, reflectance });
        Self { sky, bounced: scene.bounce.as_ref().map(|bounce| bounce.light(scene, view, shadow)) }
    }

    /// How the ground reflects the sky's light, as the shader reads it.
    pub fn sky_table(&self) -> Vec<f32> {
        self.sky.as_ref().map_or_else(Vec::new, |sky| sky.reflectance.table())
    }

    /// Radiance of the ground at a hit towards a direction, under which its normal stands at a cosine.
    pub fn radiance(&self, scene: &Scene, view: &View, hit: &Hit, (towards, mu): (Direction<BodyFixed>, f64)) -> f64 {
        let of_sky = self.sky.as_ref().map_or(0.0, |Sky { ambient, reflectance }| {
            let irradiance_w_m2 = ambient.irradiance_w_m2() * at_nodes(scene, &ambient.shares, hit, 1.0);
            reflectance.sr(albedo(scene, &view.reflectance, hit), mu) * irradiance_w_m2
        });
        of_sky + self.bounced.as_ref().map_or(0.0, |light| light.radiance(scene, view, hit, towards))
    }
}

impl Ambient {
    /// Of a facet that sees all of the sky, as bare ground does.
    pub fn irradiance_w_m2(&self) -> f64 {
        PI * self.radiance_w_m2_sr
    }
}

/// How a law reflects the scene's sky; `None` where that is black.
pub fn sky_reflectance(scene: &Scene, law: &Reflectance) -> Option<SkyReflectance> {
    scene.ambient.as_ref().filter(|ambient| ambient.radiance_w_m2_sr > 0.0)?;
    Some(match law {
        Reflectance::Hapke(hapke) if scene.albedo_is_w(law) => SkyReflectance::of_any_w(hapke),
        law => SkyReflectance::new(law),
    })
}
