//! Shadows from Fourier-compressed horizon maps.
//!
//! ```text
//!                 the disc above the skyline's tangent       a lighting factor, as in Fritsch et al. (2025)
//! every sample    samples                                    factors
//! every node      nodes                                      factors
//! ```
//!
//! # References
//! Fritsch et al. (2025), *Fast Planetary Shadows using Fourier-Compressed Horizon Maps*, doi:10.2312/hpg.20251171.

mod cost;
pub mod device;
mod factors;
mod maps;
mod method;
mod nodes;
mod options;
mod presets;
mod samples;
pub mod visibility;

pub use maps::{At, HorizonMaps};
pub use options::HorizonMapsOptions;
pub use presets::ShadowPreset;
pub use visibility::Visibility;

use super::method::{Bench, Family, MethodOptions, NamedMethod};
use super::off::Off;
use crate::horizon::Encoding;

pub const FAMILY: Family = Family {
    named: &[
        NamedMethod {
            name: "fourier",
            bench: Bench::Usual,
            hard_cases: true,
            auto: true,
            options: || Box::new(HorizonMapsOptions::default()),
        },
        NamedMethod {
            name: "fourier-f16",
            bench: Bench::Unlisted,
            hard_cases: true,
            auto: false,
            options: || Box::new(HorizonMapsOptions { encoding: Some(Encoding::F16), ..Default::default() }),
        },
        NamedMethod {
            name: "baked",
            bench: Bench::Usual,
            hard_cases: true,
            auto: true,
            options: || Box::new(HorizonMapsOptions { at: At::Nodes, ..Default::default() }),
        },
    ],
    patterns: &["fourier-ENCODING", "baked-ENCODING", "preset-NAME"],
    parse,
};

/// `fourier-fm16` and its like: maps in an encoding that is not the scenario's; `preset-High` and its like.
fn parse(name: &str) -> Option<Box<dyn MethodOptions>> {
    let (method, parameter) = name.split_once('-')?;
    let at = match method {
        "fourier" => At::Pixels,
        "baked" => At::Nodes,
        "preset" => {
            let preset = ShadowPreset::ALL.into_iter().find(|preset| preset.name() == parameter)?;
            return Some(match preset.as_printed() {
                Some(options) => Box::new(options),
                None => Box::new(Off),
            });
        }
        _ => return None,
    };
    Some(Box::new(HorizonMapsOptions { at, encoding: Some(parameter.parse().ok()?), ..Default::default() }))
}
