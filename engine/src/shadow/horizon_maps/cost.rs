//! What horizon maps cost and how far they err, for the choice of a method.
//!
//! Measured in sweeps of one azimuth over all nodes, and in full Suns: `docs/experiments/shadow_methods.md`.
//!
//! # Assumptions
//! On a graphics card a sample of a series costs far less beside a sweep: there maps are better than is reckoned.

use super::maps::At;
use crate::horizon::{Encoding, calibration};
use crate::shadow::method::{Cost, Workload};

/// RMS error of the irradiance with `fm16`.
const ERROR: f64 = 0.01;

/// What images take beside a sweep of one azimuth over all nodes, for each node: a sample of a series, and a light's field
/// from series.
const SAMPLE: f64 = 3.3;
const FIELD: f64 = 1.8;

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

/// Maps of all azimuths, and a sixth of them again for their bounds.
pub fn cost(work: &Workload, at: At) -> Cost {
    let azimuths = if work.maps_are_made { 0 } else { work.azimuths + work.azimuths.min(calibration::AZIMUTHS) };
    let images = match at {
        At::Pixels => SAMPLE * work.samples / work.nodes,
        At::Nodes => FIELD * work.lights as f64,
    };
    Cost { azimuths, most: usize::MAX, images, error: ERROR * error_ratio(work.encoding) }
}
