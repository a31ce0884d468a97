//! The scenarios that the program carries.
#![warn(missing_docs)]

use std::path::{Path, PathBuf};

use super::error::{Fault, ScenarioError};
use super::files::SearchPath;
use super::resolve::resolve;
use super::spec::Spec;
use super::text::read;

/// A scenario inside the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShippedScenario {
    /// Its name as a file without `.ron`.
    pub name: &'static str,
    /// RON, with comments.
    pub text: &'static str,
}

macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        [$(ShippedScenario { name: $name, text: include_str!(concat!("../../../scenarios/", $name, ".ron")) }),*]
    };
}

/// All shipped scenarios; the first ones need no data.
pub const SHIPPED: [ShippedScenario; 7] = shipped![
    "lunar_descent",
    "training_set",
    "shadowed_crater",
    "connecting_ridge",
    "orbit_pass",
    "full_disc",
    "mars_gale",
];

impl ShippedScenario {
    /// The scenario of a name, with or without `.ron`.
    pub fn named(name: &str) -> Option<Self> {
        let name = name.strip_suffix(".ron").unwrap_or(name);
        SHIPPED.into_iter().find(|scenario| scenario.name == name)
    }

    /// The scenario's file in the user's folder, whether it is there or not.
    pub fn path(self) -> PathBuf {
        PathBuf::from(self.name).with_extension("ron")
    }

    /// What its sequence shows, on one line.
    pub fn title(self) -> String {
        read::<Spec>(self.text).map(|spec| spec.title).unwrap_or_default()
    }

    /// Names of the files that it needs besides what the program carries.
    pub fn needs(self) -> Vec<String> {
        let nowhere = SearchPath { beside: PathBuf::from("\0"), data: Vec::new() };
        match resolve(Path::new(self.name), self.text, &nowhere, &|_| None) {
            Err(ScenarioError::Problems { problems, .. }) => {
                let missing = problems.into_iter().filter_map(|problem| match problem.fault {
                    Fault::FileNotFound { got, .. } => Some(got),
                    _ => None,
                });
                missing.collect()
            }
            _ => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_scenario_says_what_it_shows_and_needs() {
        for scenario in SHIPPED {
            assert!(!scenario.title().is_empty(), "{}", scenario.name);
            let is_synthetic = scenario.text.contains("Synthetic(");
            assert_eq!(scenario.needs().is_empty(), is_synthetic, "{}: {:?}", scenario.name, scenario.needs());
        }
        assert_eq!(ShippedScenario::named("orbit_pass.ron").unwrap().needs(), ["WAC_GLD100_E000N1800_016P.IMG"]);
        assert_eq!(ShippedScenario::named("nowhere"), None);
    }
}
