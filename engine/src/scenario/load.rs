//! From a scenario's name to a [`Scenario`].

use std::path::{Path, PathBuf};

use super::check::FileHint;
use super::error::ScenarioError;
use super::files::SearchPath;
use super::resolve::resolve;
use super::resolved::Scenario;
use super::shipped::{SHIPPED, ShippedScenario};

/// Reads and resolves the scenario `name`: a path, a name in `scenarios/`, or a shipped scenario. Files are looked for in `data` too.
pub fn load(name: &Path, data: &[PathBuf], about: FileHint) -> Result<Scenario, ScenarioError> {
    let (path, text) = find(name)?;
    resolve(&path, &text, &SearchPath::of(&path, data), about)
}

/// A scenario's path and text: the file itself, the one in `scenarios/`, or the one that the program carries.
fn find(name: &Path) -> Result<(PathBuf, String), ScenarioError> {
    let mut candidates = vec![name.to_path_buf()];
    let is_bare = name.components().count() == 1;
    if is_bare {
        candidates.push(Path::new("scenarios").join(name));
    }
    if let Some(path) = candidates.iter().find(|path| path.exists()).cloned() {
        let text = crate::text::read(&path).map_err(|source| ScenarioError::Read { path: path.clone(), source })?;
        return Ok((path, text));
    }
    let shipped = is_bare.then(|| ShippedScenario::named(&name.to_string_lossy())).flatten();
    shipped.map(|scenario| (scenario.path(), scenario.text.to_owned())).ok_or_else(|| ScenarioError::NotFound {
        name: name.display().to_string(),
        looked_for: candidates.iter().map(|path| path.display().to_string()).collect(),
        shipped: SHIPPED.iter().map(|scenario| scenario.name).collect(),
    })
}
