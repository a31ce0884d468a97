//! Shadows from horizons of all nodes towards the light, found while it stands still.
//!
//! ```text
//! swath             from kept planes of the few azimuths that lights span in all exposures
//! sweep             from planes swept for a light
//! single_azimuth    stepped for a light
//! ```

pub mod options;
pub mod single_azimuth;
pub mod swath;
mod sweep;

pub use options::{NEAR, Search, TowardsSunOptions};
pub use single_azimuth::{Edge, SingleAzimuth};
pub use swath::Swath;
pub use sweep::Swept;

use super::fan::STEP_DEG;
use super::method::{Bench, Family, MethodOptions, NamedMethod};

pub const FAMILY: Family = Family {
    named: &[
        NamedMethod {
            name: "swath",
            bench: Bench::Usual,
            hard_cases: true,
            auto: true,
            options: || by(Search::Swath { azimuth_step_deg: STEP_DEG, near: NEAR }),
        },
        NamedMethod {
            name: "sweep",
            bench: Bench::Slow,
            hard_cases: true,
            auto: true,
            options: || by(Search::Sweep { azimuth_step_deg: STEP_DEG, near: NEAR }),
        },
        NamedMethod {
            name: "single-azimuth",
            bench: Bench::Slow,
            hard_cases: true,
            auto: false,
            options: || by(Search::SingleAzimuth { spacing: 1.0, edge: Edge::Sloped }),
        },
        NamedMethod {
            name: "single-azimuth-level",
            bench: Bench::Slow,
            hard_cases: true,
            auto: false,
            options: || by(Search::SingleAzimuth { spacing: 1.0, edge: Edge::Level }),
        },
        NamedMethod {
            name: "single-azimuth-hard",
            bench: Bench::Slow,
            hard_cases: true,
            auto: false,
            options: || by(Search::SingleAzimuth { spacing: 1.0, edge: Edge::Hard }),
        },
    ],
    patterns: &["swath-POSTINGS", "sweep-POSTINGS"],
    parse,
};

/// `swath-16` and its like: another number of postings within which samples look at the terrain themselves.
fn parse(name: &str) -> Option<Box<dyn MethodOptions>> {
    let (method, postings) = name.split_once('-')?;
    let near = postings.parse().ok()?;
    match method {
        "swath" => Some(by(Search::Swath { azimuth_step_deg: STEP_DEG, near })),
        "sweep" => Some(by(Search::Sweep { azimuth_step_deg: STEP_DEG, near })),
        _ => None,
    }
}

fn by(by: Search) -> Box<dyn MethodOptions> {
    Box::new(TowardsSunOptions { by })
}
