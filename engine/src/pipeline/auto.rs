//! Which shadows a scenario gets that asks for `shadows: Auto`.
//!
//! Of the methods that err by no more than the scenario allows, the one that takes the least time, counted in azimuths swept
//! over the terrain: those before the first image, and what each image takes in that unit. Errors are RMS of the irradiance in
//! full Suns, against traced shadows; times from an image of the connecting ridge, 512² on software Vulkan: 0.03 s for a
//! series at every sample, 0.30 s for baking anew, 0.17 s for a swath's field, where two cores sweep an azimuth over all
//! nodes in 0.17 s.
//!
//! | method | taken for its error | azimuths | for the images |
//! |---|---|---|---|
//! | `Fourier` | 0.01 (`fm16`) | all of `horizon.azimuths`, and a sixth of them again for its bounds | 3.3 a sample and node |
//! | `Baked` | 0.01 (`fm16`) | the same | 1.8 a light |
//! | `Swath` | 0.0035 | those that the lights span in all exposures, 64 at most | 1 a light |
//! | `Sweep` | 0.0035 | those that they span in one exposure, for each exposure with its own light | 1 a light |
//! | `Traced` | 0 | none, and taken only where no other is right enough: minutes an image | |
//!
//! Equal numbers go to the first of the table. Maps cost no sweep where they are made for ambient light anyway.
//!
//! All errors are from one table of one bench, run with the Sun at an azimuth of stored horizons (359°) and between two (103°):
//! the largest of either, for encodings the larger mean ratio to `fm16`. Terrain and camera are those of `shadowed_crater.ron`
//! with 384² nodes and no bounce.
//!
//! ```text
//! sim bench shadows crater.ron --elevations 2,4,10 --size 192 --method fourier-fm16 --method fourier-fm4 … --method swath
//!
//!          Sun at 359°                103°                          Sun at 359°    103°
//!          2°      4°      10°        2°      4°      10°   ratio to fm16
//! fm16     0.0086  0.0091  0.0036     0.0062  0.0046  0.0101   fm4  3.5   2.6    raw8  0.9  3.7    w11  1.1  0.8
//! baked    0.0088  0.0092  0.0037     0.0064  0.0046  0.0101   fm8  1.6   1.7    raw12 0.8  3.3    w16  0.8  0.5
//! swath    0.0034  0.0017  0.0010     0.0013  0.0009  0.0017   fm12 1.1   1.25   raw16 0.8  2.65   w21  0.7  0.5
//! none     0.0696  0.0546  0.0208     0.0456  0.0544  0.0571   f12  1.05  1.2    f16   0.8  0.9    q    0.9  0.95
//! ```
//!
//! # Assumptions
//! On a graphics card a sample of a series costs far less beside a sweep: there maps are better than is reckoned.
//! The errors hold for rough terrain; on the ridge they are a quarter to a half. They grow towards lower Suns. The choice
//! depends on the scenario alone, on all of its exposures: neither the cache nor the adapter nor `--frames` has a share in
//! it, so that the same scenario gives the same bytes whatever was run before.

use crate::horizon::{Encoding, calibration};
use crate::scenario::{Ambient, Scenario, Shadows, Sky};
use crate::shadow::HeldLight;
use crate::shadow::swath::MOST_PLANES;
use crate::terrain::{Level, Surface};

use super::{Exposure, swath};

/// Between two azimuths of what is chosen here.
const AZIMUTH_STEP_DEG: f64 = 0.15;

/// RMS errors of the irradiance that are reckoned with, in full Suns: of `fm16`, and of horizons towards the light.
const FOURIER_ERROR: f64 = 0.01;
const TOWARDS_ERROR: f64 = 0.0035;

/// What images take beside a sweep of one azimuth over all nodes, for each node: a sample of a series, a light's field
/// from series, and one from planes.
const SAMPLE: f64 = 3.3;
const BAKE: f64 = 1.8;
const FETCH: f64 = 1.0;

/// RMS error of maps over that of `fm16`.
fn error_ratio(encoding: Encoding) -> f64 {
    match encoding {
        Encoding::Fm4 | Encoding::F4 => 3.5,
        Encoding::Fm8 | Encoding::F8 => 1.7,
        Encoding::Fm12 | Encoding::F12 => 1.25,
        Encoding::Fm16 | Encoding::Q => 1.0,
        Encoding::F16 => 0.9,
        Encoding::Raw8 => 3.7,
        Encoding::Raw12 => 3.3,
        Encoding::Raw16 => 2.65,
        Encoding::W11 => 1.1,
        Encoding::W16 => 0.8,
        Encoding::W21 => 0.7,
    }
}

/// The shadows of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    pub shadows: Shadows,
    /// On one line; `None` where the scenario names the method.
    pub why: Option<String>,
}

/// What a choice rests on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Facts {
    /// What the user allows.
    error: f64,
    /// Of horizon maps.
    maps_error: f64,
    azimuths: usize,
    maps_are_made: bool,
    /// That lights span in all exposures.
    spanned: usize,
    /// The same in one exposure, summed over those with a light of their own.
    swept: usize,
    images: usize,
    samples: f64,
    nodes: f64,
    /// That differ from the exposure before.
    lights: usize,
}

/// The scenario's shadows, chosen where it leaves them open.
pub fn choose(scenario: &Scenario, surface: &Surface, exposures: &[Exposure]) -> Choice {
    let Shadows::Auto { max_irradiance_error } = scenario.shadows else {
        return Choice { shadows: scenario.shadows.clone(), why: None };
    };
    if scenario.terrain.is_none() {
        return Choice { shadows: Shadows::Off, why: Some("shadows: Off, there is no terrain to cast any".into()) };
    }
    if scenario.shows_globe() {
        return Choice {
            shadows: Shadows::Fourier,
            why: Some("shadows: Fourier, a globe's tiles need its horizon maps".into()),
        };
    }
    Facts::of(scenario, surface, exposures, max_irradiance_error).choice()
}

impl Facts {
    fn of(scenario: &Scenario, surface: &Surface, exposures: &[Exposure], error: f64) -> Self {
        let held: Vec<Vec<HeldLight>> = exposures.iter().map(|exposure| exposure.view.held_lights()).collect();
        let is_new = |index: &usize| *index == 0 || held[*index] != held[index - 1];
        let new: Vec<usize> = (0..held.len()).filter(is_new).collect();
        let planes = |exposures: &[Exposure]| swath::spanned(surface, exposures, AZIMUTH_STEP_DEG).most_planes();
        let camera = &scenario.camera;
        let levels = surface.terrain.faces.iter().flat_map(|face| &face.levels);
        let seen = |level: &Level| level.seen_nodes() as f64;
        Self {
            error,
            maps_error: FOURIER_ERROR * error_ratio(scenario.horizon.encoding),
            azimuths: scenario.horizon.azimuths as usize,
            maps_are_made: matches!(scenario.ambient, Some(Ambient { sky: Sky::Horizons, .. }))
                || scenario.bounce.is_some(),
            spanned: planes(exposures),
            swept: new.iter().map(|&index| planes(&exposures[index..=index])).sum(),
            images: exposures.len(),
            samples: exposures.len() as f64
                * f64::from(camera.columns)
                * f64::from(camera.rows)
                * f64::from(camera.samples_per_pixel),
            nodes: levels.map(seen).sum::<f64>().max(1.0),
            lights: new.iter().map(|&index| held[index].len()).sum(),
        }
    }

    fn choice(&self) -> Choice {
        let Self { error, maps_error, spanned, swept, images, .. } = *self;
        let maps = if self.maps_are_made { 0 } else { self.azimuths + self.azimuths.min(calibration::AZIMUTHS) };
        let azimuth_step_deg = AZIMUTH_STEP_DEG;
        let a_light = |cost: f64| cost * self.lights as f64;
        let methods = [
            (maps, SAMPLE * self.samples / self.nodes, Shadows::Fourier, maps_error),
            (maps, a_light(BAKE), Shadows::Baked, maps_error),
            (spanned, a_light(FETCH), Shadows::Swath { azimuth_step_deg }, TOWARDS_ERROR),
            (swept, a_light(FETCH), Shadows::Sweep { azimuth_step_deg }, TOWARDS_ERROR),
        ];
        let is_able = |(azimuths, _, shadows, its_error): &(usize, f64, Shadows, f64)| {
            error >= *its_error && (*azimuths <= MOST_PLANES || !matches!(shadows, Shadows::Swath { .. }))
        };
        let able = methods.into_iter().filter(is_able).map(|(azimuths, a_run, shadows, its_error)| {
            let cost = azimuths as f64 + a_run;
            (cost, shadows, its_error)
        });
        // The first of equal ones.
        let Some((cost, shadows, its_error)) = able.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            let best = TOWARDS_ERROR.min(maps_error);
            let why = format!("shadows: Traced, nothing else errs by less than {best}, allowed is {error}");
            return Choice { shadows: Shadows::Traced, why: Some(why) };
        };
        let why = format!(
            "shadows: {shadows:?} for an error of {its_error}, allowed is {error}: as long as sweeping {cost:.0} azimuths, images \
             included; before the first of {images} images maps (error {maps_error}) take {maps}, a swath {spanned} (at most \
             {MOST_PLANES}), sweeps {swept} in all"
        );
        Choice { shadows, why: Some(why) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LANDING: Facts = Facts {
        error: 0.01,
        maps_error: FOURIER_ERROR,
        azimuths: 360,
        maps_are_made: false,
        spanned: 9,
        swept: 60,
        images: 24,
        samples: 1e8,
        nodes: 2.5e6,
        lights: 24,
    };

    fn chosen(facts: Facts) -> Shadows {
        facts.choice().shadows
    }

    const SWATH: Shadows = Shadows::Swath { azimuth_step_deg: AZIMUTH_STEP_DEG };
    const SWEEP: Shadows = Shadows::Sweep { azimuth_step_deg: AZIMUTH_STEP_DEG };

    #[test]
    fn a_landing_gets_a_swath_and_a_month_gets_maps() {
        assert_eq!(chosen(LANDING), SWATH);
        let month = Facts { spanned: 2400, swept: 700, images: 100, lights: 100, samples: 4e8, ..LANDING };
        assert_eq!(chosen(month), Shadows::Baked);
        assert_eq!(chosen(Facts { samples: 1e6, ..month }), Shadows::Fourier);
    }

    #[test]
    fn a_few_images_far_apart_are_swept_one_by_one() {
        assert_eq!(chosen(Facts { spanned: 2400, swept: 28, images: 4, lights: 4, ..LANDING }), SWEEP);
    }

    #[test]
    fn one_image_gets_a_swath_which_is_kept() {
        assert_eq!(chosen(Facts { spanned: 7, swept: 7, images: 1, lights: 1, ..LANDING }), SWATH);
    }

    #[test]
    fn maps_that_are_made_anyway_are_used_where_they_are_right_enough() {
        let sky = Facts { maps_are_made: true, images: 3, lights: 3, ..LANDING };
        assert_eq!((chosen(sky), chosen(Facts { error: 0.004, ..sky })), (Shadows::Baked, SWATH));
    }

    /// 24 fields of a swath take less than 24 of the maps, by more than its nine azimuths.
    #[test]
    fn what_images_take_is_weighed() {
        assert_eq!(chosen(Facts { maps_are_made: true, ..LANDING }), SWATH);
    }

    #[test]
    fn maps_of_a_coarse_encoding_are_not_right_enough() {
        let month = Facts { spanned: 2400, swept: 700, images: 100, lights: 100, samples: 4e8, ..LANDING };
        let coarse = Facts { maps_error: FOURIER_ERROR * error_ratio(Encoding::Fm4), ..month };
        assert_eq!((chosen(month), chosen(coarse)), (Shadows::Baked, SWEEP));
    }

    #[test]
    fn what_no_method_reaches_is_traced() {
        let exact = Facts { error: 1e-4, ..LANDING };
        assert_eq!(chosen(exact), Shadows::Traced);
        assert!(exact.choice().why.unwrap().contains("allowed is 0.0001"));
    }
}
