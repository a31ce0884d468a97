//! What a run does with what lies in its folder: refuses before the work, goes on, or begins.

use std::path::Path;

use super::{Error, Progress, record};
use crate::dataset::{self, Existing, Folder, Plan, State, Writer};
use crate::scenario::{self, Scenario, Shadows};

/// Refuses, before any work, an output that cannot be written or where something would be lost, as far as that is known. Else
/// the scenario, with the shadows that an earlier run has chosen for it where this one goes on: more exposures would perhaps
/// choose others, and those that are finished could not stay.
pub fn checked(
    scenario: &Scenario,
    shapes: &[serde_json::Value],
    output: &Path,
    existing: Existing,
) -> Result<Scenario, Error> {
    dataset::check_writable(output)?;
    let known = record::known_before(scenario);
    let plan = Plan { shared: &known, key: None, exposures: shapes };
    let folder = Folder::read(output)?;
    if let Some(refusal) = folder.refusal(&plan, existing) {
        return Err(refusal.into());
    }
    let is_open = matches!(scenario.shadows, Shadows::Auto { .. });
    let earlier = folder.manifest().filter(|_| is_open && existing.resume && !folder.finished.is_empty());
    let chosen = earlier.map(|manifest| &manifest.run.made_from).and_then(|made_from| {
        let same = made_from["scenario"] == known["scenario"];
        scenario::parse_shadows(made_from["shadow_method"].as_str().filter(|_| same)?)
    });
    Ok(Scenario { shadows: chosen.unwrap_or_else(|| scenario.shadows.clone()), ..scenario.clone() })
}

/// The exposures to render; says which were damaged.
pub fn todo(writer: &Writer, chosen: &[usize], existing: Existing, progress: &dyn Progress) -> Vec<usize> {
    if !existing.resume {
        return chosen.to_vec();
    }
    let is_missing = |index: &usize| match writer.state(*index) {
        State::Done => false,
        State::Missing => true,
        State::Damaged(why) => {
            progress.say(&format!("exposure {index} is rendered again: {why}"));
            true
        }
        State::DamagedPreview(why) => {
            progress.say(&format!("the preview of exposure {index} is made again: {why}"));
            false
        }
    };
    chosen.iter().copied().filter(is_missing).collect()
}
