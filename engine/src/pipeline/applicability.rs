//! Where a scenario asks for shadows that its method is not made for: a warning, for the images still come.

use crate::scenario::Scenario;
use crate::terrain::Surface;

/// What a user should know of the scenario's shadows, a line each; `surface` where it can be had.
pub fn warnings(scenario: &Scenario, surface: Option<&Surface>) -> Vec<String> {
    if scenario.terrain.is_none() {
        return Vec::new();
    }
    scenario.shadows.method().and_then(|method| method.warning(surface)).into_iter().collect()
}
