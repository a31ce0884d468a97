//! A crater as one image shows it.
//!
//! The rim `C + cos t U + sin t W` is the unit circle of its plane. With `R` from body to camera, `c` the camera's place and
//! `K` its focal lengths and principal point, the plane's point `(ξ, η, 1)` is seen at
//!
//! ```text
//! H (ξ, η, 1)ᵀ,   H = K [R U | R W | R (C − c)]
//! ```
//!
//! A lens moves that ellipse; the affine map that moves its points most like the lens does is applied to it, and what is left
//! over is [`Landmark::lens_misfit_px`].
//!
//! # Which are listed, and their flags
//! Craters whose ellipse meets the image and is at least some pixels across. Beyond the limb, where nothing of a rim is seen
//! and its plane looks away, there are no landmarks; behind a ridge there are, and flagged.
//!
//! | flag | holds where | decided by |
//! |---|---|---|
//! | `truncated` | the ellipse leaves the image | its bounds |
//! | `occluded` | at least half of the rim is hidden | rays from the camera to 36 points of the ground at the rim |
//! | `in_shadow` | less than half of the Sun is seen, on average over rim and floor | the shadows that the image has |
//!
//! A point is hidden where a ray meets other ground at least [`OWN_GROUND`] diameters in front of it.

use std::f64::consts::TAU;

use glam::{DMat2, DMat3, DVec2};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::rim::RIM_POINTS;
use super::{Conic, Crater, Ellipse, Origin, Rim};
use crate::geometry::{BodyFixed, Direction, Position};
use crate::render::{Scene, View, reference};
use crate::shadow::Shadow;
use crate::terrain::Hit;

/// Ground this near in front of a rim's point, in diameters, is the rim itself.
pub const OWN_GROUND: f64 = 0.01;

/// Shares from which on a landmark counts as hidden, and below which as dark.
const HALF: f64 = 0.5;

/// Points of the rim that tell what the lens does to it.
const LENS_POINTS: usize = 24;

/// A crater in an image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Landmark {
    pub id: String,
    pub origin: Origin,
    /// Of the rim plane's centre.
    pub latitude_deg: f64,
    pub longitude_east_deg: f64,
    pub height_m: f64,
    /// Longest and shortest, along the ground.
    pub diameters_m: [f64; 2],
    pub depth_m: Option<f64>,
    /// `κt/R²`: 0 fresh, 0.6 all but gone.
    pub degradation: Option<f64>,
    /// A younger crater of at least its size holds its centre.
    pub buried: bool,
    /// RMS of the ground at the rim about the rim's plane.
    pub rim_misfit_m: f64,
    pub ellipse: Ellipse,
    pub conic: Conic,
    /// The longest diameter in the image.
    pub diameter_px: f64,
    /// Largest distance of a point of the rim from the ellipse's, because a lens bends it. 0 without distortion.
    pub lens_misfit_px: f64,
    /// Of the Sun and of the camera with the normal of the rim's plane.
    pub incidence_deg: f64,
    pub emission_deg: f64,
    pub truncated: bool,
    pub occluded: bool,
    /// Share of the rim that is hidden.
    pub occluded_share: f64,
    pub in_shadow: bool,
    /// Mean share of the Sun's disc seen from the rim, and from the floor out to half the radius.
    pub rim_lit_share: f64,
    pub floor_lit_share: f64,
}

/// Which craters an image lists.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wanted {
    /// Longest diameters in the image.
    pub smallest_px: f64,
    pub largest_px: f64,
    /// `κt/R²`; a crater of which it is not known is wanted.
    pub most_degraded: f64,
}

/// The landmarks of a view, in the order of the craters.
pub fn landmarks(
    scene: &Scene,
    view: &View,
    shadow: Option<&dyn Shadow>,
    craters: &[(Crater, Rim)],
    wanted: &Wanted,
) -> Vec<Landmark> {
    let landmark = |(crater, rim): &(Crater, Rim)| {
        if crater.degradation.is_some_and(|worn| worn > wanted.most_degraded) {
            return None;
        }
        let (ellipse, lens_misfit_px) = project(view, rim)?;
        let sizes_px = wanted.smallest_px..=wanted.largest_px;
        if !sizes_px.contains(&(2.0 * ellipse.semi_axes_px[0])) || !meets_image(view, &ellipse) {
            return None;
        }
        let toward = |place: Position<BodyFixed>| rim.centre.direction_to(place);
        let angle_deg = |towards: Option<Direction<BodyFixed>>| {
            towards.map_or(f64::NAN, |towards| rim.normal.angle_to(towards).to_degrees())
        };
        let emission_deg = angle_deg(toward(view.camera_position));
        let occluded_share = hidden_share(scene, view, rim, crater.diameters_m[0]);
        if occluded_share == 1.0 && emission_deg >= 90.0 {
            return None;
        }
        let lit = |ground: &[Hit]| {
            let shares = ground.iter().map(|hit| reference::sun_fraction(scene, view, shadow, hit));
            shares.sum::<f64>() / ground.len() as f64
        };
        let (rim_ground, floor_ground) = rim.ground.split_at(RIM_POINTS);
        let (rim_lit_share, floor_lit_share) = (lit(rim_ground), lit(floor_ground));
        let place = scene.surface.terrain.body.geodetic_from_position(rim.centre);
        let [low, high] = ellipse.bounds_px();
        Some(Landmark {
            id: crater.id.clone(),
            origin: crater.origin,
            latitude_deg: place.latitude_rad.to_degrees(),
            longitude_east_deg: place.longitude_east_rad.to_degrees().rem_euclid(360.0),
            height_m: place.height_m,
            diameters_m: crater.diameters_m,
            depth_m: crater.depth_m,
            degradation: crater.degradation,
            buried: crater.buried,
            rim_misfit_m: rim.misfit_m,
            ellipse,
            conic: Conic::from(&ellipse),
            diameter_px: 2.0 * ellipse.semi_axes_px[0],
            lens_misfit_px,
            incidence_deg: angle_deg(view.lights.first().and_then(|sun| toward(sun.position))),
            emission_deg,
            truncated: !(view.optics.contains(low) && view.optics.contains(high)),
            occluded: occluded_share >= HALF,
            occluded_share,
            in_shadow: (rim_lit_share + floor_lit_share) / 2.0 < HALF,
            rim_lit_share,
            floor_lit_share,
        })
    };
    craters.par_iter().filter_map(landmark).collect()
}

/// The rim as an ellipse of the image, and how far the lens bends it off that. `None` where a part of it is behind the camera
/// or where the lens sees nothing.
pub fn project(view: &View, rim: &Rim) -> Option<(Ellipse, f64)> {
    let optics = &view.optics;
    let turned = |vector_m| view.camera_from_body.turn(vector_m);
    let [u, w] = rim.axes_m.map(turned);
    let centre = turned(rim.centre.vector_m() - view.camera_position.vector_m());
    if centre.z <= u.z.hypot(w.z) {
        return None;
    }
    let intrinsic = DMat3::from_cols_array_2d(&[
        [optics.focal_px.x, 0.0, 0.0],
        [0.0, optics.focal_px.y, 0.0],
        [optics.principal_px.x, optics.principal_px.y, 1.0],
    ]);
    let ideal = Ellipse::of_circle(intrinsic * DMat3::from_cols(u, w, centre))?;

    let pair = |k: usize| {
        let turn_rad = TAU * k as f64 / LENS_POINTS as f64;
        let p = centre + turn_rad.cos() * u + turn_rad.sin() * w;
        let measured = optics.pixel(Direction::new(p)?)?;
        Some((optics.principal_px + optics.focal_px * p.truncate() / p.z, measured))
    };
    let pairs: Vec<(DVec2, DVec2)> = (0..LENS_POINTS).map(pair).collect::<Option<_>>()?;
    let largest = |apart: &dyn Fn(&(DVec2, DVec2)) -> f64| pairs.iter().map(apart).fold(0.0, f64::max);
    // A pinhole's points are where they were, but for rounding.
    if largest(&|(from, to)| from.distance(*to)) < 1e-6 {
        return Some((ideal, 0.0));
    }
    let (linear, offset) = affine(&pairs)?;
    let misfit_px = largest(&|(from, to)| (linear * *from + offset).distance(*to));
    Some((ideal.moved(linear, offset)?, misfit_px))
}

/// The affine map that takes the first points of pairs to the second ones, by least squares.
fn affine(pairs: &[(DVec2, DVec2)]) -> Option<(DMat2, DVec2)> {
    let count = pairs.len() as f64;
    let (sum_from, sum_to) = pairs.iter().fold((DVec2::ZERO, DVec2::ZERO), |(a, b), (from, to)| (a + from, b + to));
    let (mean_from, mean_to) = (sum_from / count, sum_to / count);
    let (mut moments, mut mixed) = (DMat2::ZERO, DMat2::ZERO);
    for (from, to) in pairs {
        let (from, to) = (*from - mean_from, *to - mean_to);
        moments += DMat2::from_cols(from * from.x, from * from.y);
        mixed += DMat2::from_cols(to * from.x, to * from.y);
    }
    let linear = mixed * moments.inverse();
    linear.is_finite().then(|| (linear, mean_to - linear * mean_from))
}

/// Whether an ellipse and the image have a point in common.
fn meets_image(view: &View, ellipse: &Ellipse) -> bool {
    let size = DVec2::new(f64::from(view.optics.columns), f64::from(view.optics.rows));
    let [low, high] = ellipse.bounds_px();
    if high.cmplt(DVec2::splat(-0.5)).any() || low.cmpgt(size - 0.5).any() {
        return false;
    }
    // Bounds that meet are not enough: the image may lie beside a slanting ellipse.
    let nearest = DVec2::from(ellipse.centre_px).clamp(DVec2::splat(-0.5), size - 0.5);
    let on_rim = |k: usize| view.optics.contains(ellipse.at(TAU * k as f64 / 180.0));
    Conic::from(ellipse).value(nearest) <= 0.0 || (0..180).any(on_rim)
}

/// Share of the rim's points that ground in front hides.
fn hidden_share(scene: &Scene, view: &View, rim: &Rim, diameter_m: f64) -> f64 {
    let is_hidden = |point: &&Hit| {
        let Some(towards) = view.camera_position.direction_to(point.position) else { return false };
        let distance_m = view.camera_position.distance_m(point.position);
        let met = scene.surface.intersect(view.camera_position, towards);
        met.is_some_and(|met| met.distance_m < distance_m - OWN_GROUND * diameter_m)
    };
    rim.ground[..RIM_POINTS].iter().filter(is_hidden).count() as f64 / RIM_POINTS as f64
}
