//! Light that comes from everywhere: an even sky, and what other ground reflects.
//!
//! Both renderers read it as shares of one unit at the nodes of the terrain. The ground reflects it as if it came along the
//! normal.

use std::borrow::Cow;
use std::f64::consts::PI;

use super::{Scene, View};
use crate::shadow::Shadow;

/// Diffuse irradiance of a view's ground.
#[derive(Debug)]
pub struct Diffuse<'a> {
    /// Irradiance of a share of 1.
    pub unit_w_m2: f64,
    /// At each node of each face's levels.
    pub shares: Cow<'a, [Vec<Vec<f32>>]>,
    /// On ground without DEM heights.
    pub bare_share: f64,
}

impl<'a> Diffuse<'a> {
    /// `None` where a scene has none.
    pub fn of(scene: &'a Scene, view: &View, shadow: Option<&dyn Shadow>) -> Option<Self> {
        let unit_w_m2 = Self::unit_w_m2(scene);
        let bare_share = Self::bare_share(scene);
        let sky = scene.ambient.as_ref().filter(|_| bare_share > 0.0).map(|ambient| ambient.shares.as_slice());
        let Some(bounce) = &scene.bounce else {
            return sky.map(|shares| Self { unit_w_m2, shares: shares.into(), bare_share });
        };
        let mut shares = bounce.irradiance_w_m2(scene, view, shadow);
        for (face, levels) in shares.iter_mut().enumerate() {
            for (level, values) in levels.iter_mut().enumerate() {
                let open = sky.map(|sky| &sky[face][level]);
                values.iter_mut().enumerate().for_each(|(node, value)| {
                    *value = *value / unit_w_m2 as f32 + open.map_or(0.0, |open| open[node]);
                });
            }
        }
        Some(Self { unit_w_m2, shares: shares.into(), bare_share })
    }

    /// `π L` of the sky; 1 where the sky is black and ground bounces, 0 where there is neither.
    pub fn unit_w_m2(scene: &Scene) -> f64 {
        match (&scene.ambient, &scene.bounce) {
            (Some(ambient), _) if ambient.radiance_w_m2_sr > 0.0 => PI * ambient.radiance_w_m2_sr,
            (_, Some(_)) => 1.0,
            _ => 0.0,
        }
    }

    /// Bare ground sees all of the sky and no other ground.
    pub fn bare_share(scene: &Scene) -> f64 {
        let has_sky = scene.ambient.as_ref().is_some_and(|ambient| ambient.radiance_w_m2_sr > 0.0);
        f64::from(u8::from(has_sky))
    }
}
