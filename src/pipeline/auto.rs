//! Which shadows a scenario gets that asks for `shadows: Auto`.
//!
//! Of the methods that err by no more than the scenario allows, the one with the fewest azimuths to sweep over the terrain
//! before all images are made; sweeping is what a run waits for. RMS errors of the irradiance in full Suns, against traced
//! shadows of one exposure each:
//!
//! | method | connecting ridge, Sun at 1.9° | cratered highland, six levels, 4.1° | taken | azimuths |
//! |---|---|---|---|---|
//! | `Fourier`, `Baked` | 0.0024 (`w21`) | 0.0026 (`fm16`) | 0.005 | all of `horizon.azimuths`, and a sixth of them again for its bounds |
//! | `Swath` | 0.0008 | 0.0016 | 0.002 | those that the lights span in all exposures, 64 at most |
//! | `Sweep` | 0.0008 | 0.0016 | 0.002 | those that they span in one exposure, for each exposure with its own light |
//! | `Traced` | 0 | 0 | 0 | none, and taken only where no other is right enough: minutes an image |
//!
//! Equal numbers go to the first of the table. `Fourier` sweeps nothing where its maps are made for ambient light anyway. It is
//! evaluated once a node (`Baked`) where the exposures have more samples than the terrain has nodes for each light,
//! otherwise at each sample. Its encoding is the scenario's: the default one is the most accurate of its size.
//!
//! 0.005 is taken for maps because another exposure of the ridge, from 17 km above it, has 0.0042 (`fm16`).
//!
//! # Assumptions
//! What an image takes is not weighed.
//! The errors hold for terrain like the two scenes'; they grow towards lower Suns. The choice depends on the scenario alone,
//! on all of its exposures: neither the cache nor the adapter nor `--frames` has a share in it, so that the
//! same scenario gives the same bytes whatever was run before.

use crate::horizon::bound;
use crate::scenario::{Ambient, Scenario, Shadows, Sky};
use crate::shadow::HeldLight;
use crate::shadow::swath::MOST_PLANES;
use crate::terrain::{Level, Surface};

use super::{Exposure, swath};

/// Between two azimuths of what is chosen here.
const AZIMUTH_STEP_DEG: f64 = 0.15;

/// RMS errors of the irradiance that are reckoned with, in full Suns.
const FOURIER_ERROR: f64 = 0.005;
const TOWARDS_ERROR: f64 = 0.002;

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
    azimuths: usize,
    maps_are_made: bool,
    /// That lights span in all exposures.
    spanned: usize,
    /// The same in one exposure, summed over those with a light of their own.
    swept: usize,
    images: usize,
    samples: f64,
    /// Times the lights that they are evaluated for.
    nodes: f64,
}

/// The scenario's shadows, chosen where it leaves them open.
pub fn choose(scenario: &Scenario, surface: &Surface, exposures: &[Exposure]) -> Choice {
    let Shadows::Auto { max_irradiance_error } = scenario.shadows else {
        return Choice { shadows: scenario.shadows.clone(), why: None };
    };
    if scenario.terrain.is_none() {
        return Choice { shadows: Shadows::Off, why: Some("shadows: Off, there is no terrain to cast any".into()) };
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
        let seen = |level: &Level| (level.columns - 2 * level.margin) as f64 * (level.rows - 2 * level.margin) as f64;
        let lights: usize = new.iter().map(|&index| held[index].len()).sum();
        Self {
            error,
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
            nodes: levels.map(seen).sum::<f64>() * lights as f64,
        }
    }

    fn choice(&self) -> Choice {
        let Self { error, spanned, swept, images, .. } = *self;
        let maps = if self.maps_are_made { 0 } else { self.azimuths + self.azimuths.min(bound::AZIMUTHS) };
        let maps_method = if self.samples > self.nodes { Shadows::Baked } else { Shadows::Fourier };
        let azimuth_step_deg = AZIMUTH_STEP_DEG;
        let mut able = Vec::new();
        if error >= FOURIER_ERROR {
            able.push((maps, maps_method, FOURIER_ERROR));
        }
        if error >= TOWARDS_ERROR && spanned <= MOST_PLANES {
            able.push((spanned, Shadows::Swath { azimuth_step_deg }, TOWARDS_ERROR));
        }
        if error >= TOWARDS_ERROR {
            able.push((swept, Shadows::Sweep { azimuth_step_deg }, TOWARDS_ERROR));
        }
        // The first of equal ones.
        let Some((azimuths, shadows, its_error)) = able.into_iter().min_by_key(|(azimuths, ..)| *azimuths) else {
            let why = format!("shadows: Traced, nothing else errs by less than {TOWARDS_ERROR}, allowed is {error}");
            return Choice { shadows: Shadows::Traced, why: Some(why) };
        };
        let why = format!(
            "shadows: {shadows:?} for an error of {its_error}, allowed is {error}: {azimuths} azimuths to sweep; maps take \
             {maps}, a swath {spanned} (at most {MOST_PLANES}), sweeps {swept} for {images} images"
        );
        Choice { shadows, why: Some(why) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LANDING: Facts = Facts {
        error: 0.01,
        azimuths: 360,
        maps_are_made: false,
        spanned: 9,
        swept: 60,
        images: 24,
        samples: 1e8,
        nodes: 1e7,
    };

    fn chosen(facts: Facts) -> Shadows {
        facts.choice().shadows
    }

    const SWATH: Shadows = Shadows::Swath { azimuth_step_deg: AZIMUTH_STEP_DEG };
    const SWEEP: Shadows = Shadows::Sweep { azimuth_step_deg: AZIMUTH_STEP_DEG };

    #[test]
    fn a_landing_gets_a_swath_and_a_month_gets_maps() {
        assert_eq!(chosen(LANDING), SWATH);
        let month = Facts { spanned: 2400, swept: 700, images: 100, ..LANDING };
        assert_eq!(chosen(month), Shadows::Baked);
        assert_eq!(chosen(Facts { samples: 1e6, ..month }), Shadows::Fourier);
    }

    #[test]
    fn a_few_images_far_apart_are_swept_one_by_one() {
        assert_eq!(chosen(Facts { spanned: 2400, swept: 28, images: 4, ..LANDING }), SWEEP);
    }

    #[test]
    fn one_image_gets_a_swath_which_is_kept() {
        assert_eq!(chosen(Facts { spanned: 7, swept: 7, images: 1, ..LANDING }), SWATH);
    }

    #[test]
    fn maps_that_are_made_anyway_are_used_where_they_are_right_enough() {
        let sky = Facts { maps_are_made: true, ..LANDING };
        assert_eq!((chosen(sky), chosen(Facts { error: 0.004, ..sky })), (Shadows::Baked, SWATH));
    }

    #[test]
    fn what_no_method_reaches_is_traced() {
        let exact = Facts { error: 1e-4, ..LANDING };
        assert_eq!(chosen(exact), Shadows::Traced);
        assert!(exact.choice().why.unwrap().contains("allowed is 0.0001"));
    }
}
