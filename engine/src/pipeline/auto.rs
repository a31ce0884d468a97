//! Which shadows a scenario gets that names none or asks for `shadows: Auto`.
//!
//! Of the methods that err by no more than the scenario allows, the one that takes the least time, counted in azimuths swept
//! over the terrain: those before the first image, and what each image takes in that unit. Methods say themselves what they
//! cost ([`crate::shadow::MethodOptions::cost`]); equal costs go to the first of the registry. Where none is right enough the
//! reference is taken: minutes an image. Maps cost no sweep where they are made for ambient light anyway. What costs and errors
//! were measured on: `docs/experiments/shadow_methods.md`.
//!
//! # Assumptions
//! The errors hold for rough terrain; on the connecting ridge they are a quarter to a half. They grow towards lower Suns. The
//! choice depends on the scenario alone, on all of its exposures: neither the cache nor the adapter nor `--frames` has a share
//! in it, so that the same scenario gives the same bytes whatever was run before. A sweep has no limit, so that there is always
//! a choice; what an adapter cannot hold the reference renderer renders ([`super::device`]).

use crate::render::Quantity;
use crate::scenario::{Ambient, Scenario, Shadows, Sky};
use crate::shadow::fan::azimuths_spanned;
use crate::shadow::{Cost, MethodOptions, QuantizedLight, Workload, registry};
use crate::terrain::Surface;

use super::Exposure;

/// The shadows of a run.
#[derive(Debug)]
pub struct Choice {
    pub method: Box<dyn MethodOptions>,
    /// On one line; `None` where the scenario names the method.
    pub why: Option<String>,
}

/// The scenario's shadows, chosen where it leaves them open.
pub fn choose(scenario: &Scenario, surface: &Surface, exposures: &[Exposure]) -> Choice {
    if let Some(method) = scenario.shadows.method() {
        return Choice { method, why: None };
    }
    if scenario.terrain.is_none() {
        return settled(registry::no_shadows_options(), "there is no terrain to cast any");
    }
    if scenario.shows_globe()
        && let Some(method) = registry::candidates().find(|method| method.serves_globe())
    {
        return settled(method, "a globe's tiles need its horizon maps");
    }
    let sigma = |point: &Quantity| *point == Quantity::SunFractionSigma;
    if scenario.refine || scenario.outputs.planes.iter().any(sigma) {
        return settled(
            registry::maps_options(),
            "refine and sun_fraction_sigma rest on the known errors of horizon maps",
        );
    }
    let allowed = match scenario.shadows {
        Shadows::Auto { max_irradiance_error } => max_irradiance_error,
        _ => 0.0,
    };
    choice(&workload(scenario, surface, exposures), allowed)
}

fn settled(method: Box<dyn MethodOptions>, because: &str) -> Choice {
    let why = Some(format!("shadows: {}, {because}", method.spelling()));
    Choice { method, why }
}

fn workload(scenario: &Scenario, surface: &Surface, exposures: &[Exposure]) -> Workload {
    let lights = lights(exposures);
    let is_new = |index: &usize| *index == 0 || lights[*index] != lights[index - 1];
    let new: Vec<usize> = (0..lights.len()).filter(is_new).collect();
    let camera = &scenario.camera;
    Workload {
        encoding: scenario.horizon.encoding,
        azimuths: scenario.horizon.azimuths as usize,
        maps_are_made: matches!(scenario.ambient, Some(Ambient { sky: Sky::Horizons, .. }))
            || scenario.bounce.is_some(),
        spanned: azimuths_spanned(surface, &lights),
        swept: new.iter().map(|&index| azimuths_spanned(surface, &lights[index..=index])).sum(),
        images: exposures.len(),
        samples: exposures.len() as f64
            * f64::from(camera.columns)
            * f64::from(camera.rows)
            * f64::from(camera.samples_per_pixel),
        nodes: (surface.terrain.seen_nodes() as f64).max(1.0),
        lights: new.iter().map(|&index| lights[index].len()).sum(),
    }
}

/// All lights of the exposures, as methods see them that find horizons in advance: of images that take their time, more than one
/// set each.
pub fn lights(exposures: &[Exposure]) -> Vec<Vec<QuantizedLight>> {
    exposures.iter().flat_map(Exposure::quantized_lights).collect()
}

/// The cheapest method that errs by no more than `allowed`.
fn choice(work: &Workload, allowed: f64) -> Choice {
    let costs = |method: Box<dyn MethodOptions>| method.cost(work).map(|cost| (method, cost));
    let mut candidates: Vec<_> = registry::candidates().filter_map(costs).collect();
    let is_able = |cost: &Cost| allowed >= cost.error && cost.azimuths <= cost.most;
    // The first of equal ones.
    let able = candidates.iter().enumerate().filter(|(_, (_, cost))| is_able(cost));
    let Some((best, _)) = able.min_by(|a, b| total(&a.1.1).total_cmp(&total(&b.1.1))) else {
        let least = candidates.iter().map(|(_, cost)| cost.error).fold(f64::INFINITY, f64::min);
        let because =
            format!("the others err by {least} of full sunlight and more, allowed is {allowed}: minutes an image");
        return settled(registry::reference_options(), &because);
    };
    let (method, cost) = candidates.remove(best);
    let others: Vec<String> =
        candidates.iter().map(|(method, cost)| passed_over(method.as_ref(), cost, allowed)).collect();
    let why = format!(
        "shadows: {}, the least work with an error of at most {allowed} of full sunlight (it has {}): {} of the Sun before the \
         first image, all told as long as {:.0} sweeps over the terrain for {}; {}",
        method.spelling(),
        cost.error,
        counted(cost.azimuths, "azimuth"),
        total(&cost),
        counted(work.images, "image"),
        others.join(", ")
    );
    Choice { method, why: Some(why) }
}

/// What a method takes, in sweeps of one azimuth over all nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Before the first image.
    pub before: f64,
    pub images: f64,
}

/// What a method would take for a scenario; `None`: it does not say.
pub fn effort(
    scenario: &Scenario,
    surface: &Surface,
    exposures: &[Exposure],
    method: &dyn MethodOptions,
) -> Option<Effort> {
    let cost = method.cost(&workload(scenario, surface, exposures))?;
    Some(Effort { before: cost.azimuths as f64, images: cost.images })
}

fn total(cost: &Cost) -> f64 {
    cost.azimuths as f64 + cost.images
}

/// Why another method was not taken.
fn passed_over(method: &dyn MethodOptions, cost: &Cost, allowed: f64) -> String {
    let spelling = method.spelling();
    if cost.error > allowed {
        return format!("{spelling} has an error of {}", cost.error);
    }
    if cost.azimuths > cost.most {
        return format!("{spelling} holds {} azimuths, the Sun's are {}", cost.most, cost.azimuths);
    }
    format!("{spelling} would take {:.0} sweeps", total(cost))
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::horizon::Encoding;

    const LANDING: Workload = Workload {
        encoding: Encoding::Fm16,
        azimuths: 360,
        maps_are_made: false,
        spanned: 9,
        swept: 60,
        images: 24,
        samples: 1e8,
        nodes: 2.5e6,
        lights: 24,
    };

    /// Where an error of 0.01 is allowed.
    fn chosen(work: Workload) -> String {
        choice(&work, 0.01).method.spelling()
    }

    const MAPS: &str = "HorizonMaps()";
    const NODES: &str = "HorizonMaps(at: Nodes)";
    const SWATH: &str = "TowardsSun(by: Swath())";
    const SWEEP: &str = "TowardsSun(by: Sweep())";

    #[test]
    fn a_landing_gets_a_swath_and_a_month_gets_maps() {
        assert_eq!(chosen(LANDING), SWATH);
        let month = Workload { spanned: 2400, swept: 700, images: 100, lights: 100, samples: 4e8, ..LANDING };
        assert_eq!(chosen(month), NODES);
        assert_eq!(chosen(Workload { samples: 1e6, ..month }), MAPS);
    }

    #[test]
    fn a_few_images_far_apart_are_swept_one_by_one() {
        assert_eq!(chosen(Workload { spanned: 2400, swept: 28, images: 4, lights: 4, ..LANDING }), SWEEP);
    }

    #[test]
    fn one_image_gets_a_swath_which_is_kept() {
        assert_eq!(chosen(Workload { spanned: 7, swept: 7, images: 1, lights: 1, ..LANDING }), SWATH);
    }

    #[test]
    fn maps_that_are_made_anyway_are_used_where_they_are_right_enough() {
        let sky = Workload { maps_are_made: true, images: 3, lights: 3, ..LANDING };
        assert_eq!(chosen(sky), NODES);
        assert_eq!(choice(&sky, 0.004).method.spelling(), SWATH);
    }

    /// 24 fields of a swath take less than 24 of the maps, by more than its nine azimuths.
    #[test]
    fn what_images_take_is_weighed() {
        assert_eq!(chosen(Workload { maps_are_made: true, ..LANDING }), SWATH);
    }

    #[test]
    fn maps_of_a_coarse_encoding_are_not_right_enough() {
        let month = Workload { spanned: 2400, swept: 700, images: 100, lights: 100, samples: 4e8, ..LANDING };
        let coarse = Workload { encoding: Encoding::Fm4, ..month };
        assert_eq!((chosen(month).as_str(), chosen(coarse).as_str()), (NODES, SWEEP));
    }

    #[test]
    fn what_no_method_reaches_is_traced() {
        let exact = choice(&LANDING, 1e-4);
        assert_eq!(exact.method.spelling(), "Traced");
        assert!(exact.why.unwrap().contains("allowed is 0.0001"));
    }
}
