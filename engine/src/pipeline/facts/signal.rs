//! The light to be expected, against what the detector holds.
//!
//! Reflectance law, facets and Sun at the ground that a few rays meet; lens, exposure and detector as written. Cast shadows are
//! left out: ground that they darken is not among the darkest.

use serde::Serialize;

use super::look::{Look, least_and_greatest};
use crate::camera::Detector;
use crate::pipeline::capture;
use crate::scenario::AutoExposure;

/// What the exposures are expected to give: an estimate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SignalFacts {
    /// Of lit ground: what a twentieth of it stays below, and the greatest; `None`: none is lit.
    pub radiance_w_m2_sr: Option<[f64; 2]>,
    /// `None`: the scenario has no detector.
    pub detector: Option<DetectorFacts>,
}

/// What a detector makes of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DetectorFacts {
    /// Shortest and longest.
    pub exposure_s: [f64; 2],
    /// Electrons that a twentieth of the lit ground stays below, and of the brightest.
    pub electrons: Option<[f64; 2]>,
    /// Electrons above which a pixel is saturated: of the full well or of the largest number.
    pub capacity_e: f64,
    pub full_well_e: f64,
    /// Electrons in one digital number.
    pub electrons_per_dn: f64,
    /// Share of the lit ground that saturates, of the worst exposure.
    pub share_saturated: f64,
}

/// What one exposure is expected to give.
#[derive(Debug, Clone)]
pub struct Expected {
    pub exposure_s: f64,
    /// Of each ray on ground.
    pub electrons: Vec<f64>,
    pub capacity_e: f64,
    pub electrons_per_dn: f64,
}

impl Expected {
    pub fn of(look: &Look, detector: &Detector, auto: Option<&AutoExposure>) -> Self {
        let exposure_s =
            auto.map_or(detector.exposure_s, |auto| capture::chosen_s(auto, detector, look.focal_w_m2.clone()));
        let exposed = Detector { exposure_s, ..detector.clone() };
        let electrons =
            look.focal_w_m2.iter().map(|light| exposed.quantum_efficiency * exposed.photons(f64::from(*light)));
        Self {
            exposure_s,
            electrons: electrons.collect(),
            capacity_e: exposed.capacity_e(),
            electrons_per_dn: 1.0 / exposed.gain_dn_e,
        }
    }

    pub fn share_saturated(&self) -> f64 {
        let full = self.electrons.iter().filter(|electrons| **electrons >= self.capacity_e).count();
        full as f64 / self.electrons.len().max(1) as f64
    }

    /// Whether the brightest ground gives less than a digital number.
    pub fn is_black(&self) -> bool {
        !self.electrons.is_empty() && self.electrons.iter().all(|electrons| *electrons < self.electrons_per_dn)
    }

    /// Of the brightest ground, in shares of what a pixel holds.
    pub fn fullest(&self) -> f64 {
        self.electrons.iter().copied().fold(0.0, f64::max) / self.capacity_e
    }
}

/// Ground that the Sun grazes is as dark as one likes: a twentieth of the values is left out below.
fn dim_and_bright(mut values: Vec<f64>) -> Option<[f64; 2]> {
    values.sort_by(f64::total_cmp);
    Some([*values.get(values.len() / 20)?, *values.last()?])
}

/// Of all exposures that were looked at, each with its detector where there is one.
pub fn signal(looks: &[Look], expected: &[Expected], detector: Option<&Detector>) -> SignalFacts {
    let lit =
        |values: &[f32]| values.iter().filter(|value| **value > 0.0).map(|value| f64::from(*value)).collect::<Vec<_>>();
    let radiance_w_m2_sr = dim_and_bright(looks.iter().flat_map(|look| lit(&look.radiance_w_m2_sr)).collect());
    let detector = detector.map(|detector| DetectorFacts {
        exposure_s: least_and_greatest(expected.iter().map(|exposure| exposure.exposure_s)).unwrap_or_default(),
        electrons: dim_and_bright(
            expected
                .iter()
                .flat_map(|exposure| &exposure.electrons)
                .copied()
                .filter(|electrons| *electrons > 0.0)
                .collect(),
        ),
        capacity_e: detector.capacity_e(),
        full_well_e: detector.full_well_e,
        electrons_per_dn: 1.0 / detector.gain_dn_e,
        share_saturated: expected.iter().map(Expected::share_saturated).fold(0.0, f64::max),
    });
    SignalFacts { radiance_w_m2_sr, detector }
}
