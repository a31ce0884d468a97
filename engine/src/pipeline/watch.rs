//! Looks at each image of a run for what is odd, tells the first few at once and all of them in the end.

use std::sync::{Mutex, PoisonError};

use super::capture::CapturedExposure;
use super::facts::Looker;
use super::warnings::{self, Shares, Warning};
use super::{Error, Prepared, Progress};
use crate::dataset::{self, WarningRecord};
use crate::scenario::Scenario;

/// Lines that are told while images are made; all are summed in the end.
const TOLD: usize = 10;

/// What a run has found odd so far.
#[derive(Debug)]
pub struct Watch {
    looker: Looker,
    odd: Mutex<Vec<(usize, Vec<Warning>)>>,
}

impl Watch {
    pub fn new(scenario: &Scenario, prepared: &Prepared) -> Result<Self, Error> {
        let ground = &prepared.ground;
        let looker = Looker::new(scenario, &ground.surface, &ground.models)?;
        Ok(Self { looker, odd: Mutex::default() })
    }

    /// Puts what is odd about an image into its record.
    pub fn note(
        &self,
        prepared: &Prepared,
        captured: &CapturedExposure,
        image: &mut dataset::Exposure,
        progress: &dyn Progress,
    ) -> Result<(), Error> {
        let look = self.looker.look(&prepared.exposures[image.index])?;
        let mut found = self.looker.warnings(&look);
        let shares = shares(captured);
        found.extend(warnings::of_image(&shares, captured.exposure_s));
        let record = |warning: &Warning| WarningRecord { kind: warning.kind.name().into(), text: warning.text.clone() };
        image.facts.quality.share_saturated = shares.saturated;
        image.facts.quality.warnings = found.iter().map(record).collect();
        if found.is_empty() {
            return Ok(());
        }
        let mut odd = self.odd.lock().unwrap_or_else(PoisonError::into_inner);
        let told: usize = odd.iter().map(|(_, warnings)| warnings.len()).sum();
        for warning in found.iter().take(TOLD.saturating_sub(told)) {
            progress.say(&format!("warning: in exposure {} {}", image.index, warning.text));
        }
        odd.push((image.index, found));
        Ok(())
    }

    /// A line for each kind of what was odd about some of so many images.
    pub fn summed(self, images: usize) -> Vec<String> {
        let mut odd = self.odd.into_inner().unwrap_or_else(PoisonError::into_inner);
        odd.sort_by_key(|(index, _)| *index);
        warnings::summed(&odd, images)
    }
}

/// By the light on the focal plane, before noise.
fn shares(captured: &CapturedExposure) -> Shares {
    let light = captured.light.focal_plane_irradiance();
    let share = |is_odd: &dyn Fn(f32) -> bool| {
        light.iter().filter(|light| is_odd(**light)).count() as f64 / light.len().max(1) as f64
    };
    let without_value = share(&|light| light.is_nan());
    let Some(detector) = &captured.detector else {
        return Shares { saturated: None, black: share(&|light| light <= 0.0), without_value };
    };
    let electrons = |light: f32| detector.quantum_efficiency * detector.photons(f64::from(light));
    let capacity_e = detector.capacity_e();
    Shares {
        saturated: Some(share(&|light| electrons(light) >= capacity_e)),
        black: share(&|light| electrons(light) * detector.gain_dn_e < 1.0),
        without_value,
    }
}
