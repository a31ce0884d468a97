//! Shadows by a search of maximum mipmaps towards the light at every sample ([`search`]).

mod options;
pub mod search;

pub use options::MipmapsOptions;
pub use search::{MipmapRuns, Mipmaps};

use super::method::{Bench, Family, MethodOptions, NamedMethod};

pub const FAMILY: Family = Family {
    named: &[
        NamedMethod {
            name: "mipmaps-5-5-5",
            bench: Bench::Usual,
            hard_cases: true,
            auto: false,
            options: || runs(&[5, 5, 5]),
        },
        NamedMethod {
            name: "mipmaps-5-5-5-3",
            bench: Bench::Usual,
            hard_cases: false,
            auto: false,
            options: || runs(&[5, 5, 5, 3]),
        },
        NamedMethod { name: "mipmaps", bench: Bench::Usual, hard_cases: true, auto: false, options: || runs(&[]) },
        NamedMethod {
            name: "uniform-100",
            bench: Bench::Slow,
            hard_cases: false,
            auto: false,
            options: || Box::new(MipmapsOptions { steps: Some([100, 1]), ..Default::default() }),
        },
    ],
    patterns: &[],
    parse: |_| None,
};

fn runs(runs: &[u32]) -> Box<dyn MethodOptions> {
    Box::new(MipmapsOptions { runs: runs.to_vec(), steps: None })
}
