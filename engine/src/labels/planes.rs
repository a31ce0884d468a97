//! Labels as planes of an image.

use super::{Flow, Hazards, Limits, shadow_change, synthetic_detail_height_m};
use crate::render::planes::Radiometry;
use crate::render::{Plane, Quantity, Samples, Scene, View};
use crate::shadow::Shadow;
use crate::terrain::Hit;

/// What an exposure's labels need besides itself.
#[derive(Debug, Clone, Copy)]
pub struct Sequence<'a> {
    pub previous: Option<&'a View>,
    pub next: Option<&'a View>,
    /// What the previous exposure sampled, where the change of shadows is asked for.
    pub before: Option<&'a [Radiometry]>,
    /// What decides which ground the Sun lights, where [`need_light`] says so.
    pub shadow: Option<&'a dyn Shadow>,
    pub limits: &'a Limits,
    /// How many of the finest levels are made up.
    pub synthetic_levels: usize,
}

/// Whether any of these labels asks which ground the Sun lights.
pub fn need_light(quantities: &[Quantity], limits: &Limits) -> bool {
    let asked = |quantity| quantities.contains(&quantity);
    asked(Quantity::HazardSunlit) || asked(Quantity::Hazard) && limits.sunlit_share > 0.0
}

/// The planes of `view.quantities` that are labels. None of them costs anything unless it is asked for.
pub fn planes(scene: &Scene, view: &View, samples: &Samples, sequence: &Sequence) -> Vec<Plane> {
    use Quantity as Q;
    let asked = |quantities: &[Q]| quantities.iter().any(|quantity| view.quantities.contains(quantity));
    let flow = |wanted, other: Option<&View>| {
        if wanted { Flow::to(scene, view, other, &samples.centres) } else { Flow::none() }
    };
    let next = flow(asked(&[Q::Flow, Q::Covisible]), sequence.next);
    let previous = flow(asked(&[Q::FlowBack, Q::CovisibleBack]), sequence.previous);
    let hazards = if asked(&[Q::HazardSlope, Q::HazardRoughness, Q::HazardSunlit, Q::Hazard]) {
        let light = need_light(&view.quantities, sequence.limits);
        Hazards::of(scene, view, sequence.shadow, &samples.centres, sequence.limits, light)
    } else {
        Hazards::default()
    };
    let channels = |quantity: Q| match quantity {
        Q::Flow => vec![next.x_px.clone(), next.y_px.clone()],
        Q::Covisible => vec![next.covisible.clone()],
        Q::FlowBack => vec![previous.x_px.clone(), previous.y_px.clone()],
        Q::CovisibleBack => vec![previous.covisible.clone()],
        Q::ShadowChange => vec![shadow_change(&samples.pixels, sequence.before)],
        Q::HazardSlope => vec![hazards.slope_deg.clone()],
        Q::HazardRoughness => vec![hazards.roughness_m.clone()],
        Q::HazardSunlit => vec![hazards.sunlit_share.clone()],
        Q::Hazard => vec![hazards.hazard.clone()],
        Q::InventedHeight => {
            let height_m = |hit: &Hit| synthetic_detail_height_m(&scene.surface, sequence.synthetic_levels, hit);
            vec![samples.centres.iter().map(|hit| hit.as_ref().map_or(f64::NAN, height_m) as f32).collect()]
        }
        _ => unreachable!("{quantity:?} is no label"),
    };
    let labels = view.quantities.iter().copied().filter(|quantity| quantity.is_label());
    labels
        .flat_map(|quantity| {
            let named = quantity.channels().iter().zip(channels(quantity));
            named.map(move |(name, values)| Plane { quantity, name, values }).collect::<Vec<_>>()
        })
        .collect()
}
