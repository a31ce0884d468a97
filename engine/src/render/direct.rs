//! The light of one disc on the ground at a hit, shadows included: in f64, for the reference renderer and for bounced light.

use super::facet::{normal, site};
use super::{Light, Scene};
use crate::geometry::{BodyFixed, Direction};
use crate::photometry::{HorizonLine, SunAxes};
use crate::shadow::Shadow;
use crate::terrain::Hit;

/// What a facet gets of a light.
#[derive(Debug, Clone, Copy)]
pub struct Lit {
    pub irradiance: f64,
    pub fraction: f64,
}

/// Irradiance of the ground at a hit by one light of the view.
pub fn irradiance_w_m2(scene: &Scene, shadow: Option<&dyn Shadow>, hit: &Hit, light: (usize, &Light)) -> f64 {
    illuminate(scene, shadow, hit, normal(scene, hit), light).irradiance
}

/// Irradiance of a facet by a light, and the share of the disc that it sees.
pub fn illuminate(
    scene: &Scene,
    shadow: Option<&dyn Shadow>,
    hit: &Hit,
    normal: Direction<BodyFixed>,
    (index, light): (usize, &Light),
) -> Lit {
    let Some(towards) = hit.position.direction_to(light.position) else {
        return Lit { irradiance: 0.0, fraction: 0.0 };
    };
    let radius_rad = light.angular_radius_rad;
    let (seen, facet) = match site(scene, hit, normal, (index, light)) {
        Some((site, disc)) => {
            let open = || scene.disk.light(HorizonLine::NONE, disc.facet);
            (shadow.map_or_else(open, |shadow| shadow.light(&site, &disc)), disc.facet)
        }
        None => {
            let facet = SunAxes::new(towards, normal).facet(normal, radius_rad);
            (scene.disk.light(HorizonLine::NONE, facet), facet)
        }
    };
    Lit { irradiance: light.irradiance_w_m2 * seen.irradiance_factor(facet, radius_rad), fraction: seen.fraction }
}
