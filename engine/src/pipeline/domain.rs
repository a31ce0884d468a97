//! Where a scenario asks for shadows that its method is not made for: a warning, for the images still come.

use crate::scenario::{Scenario, Shadows};
use crate::shadow::Edge;
use crate::terrain::Surface;

/// What a user should know of the scenario's shadows, a line each; `surface` where it can be had.
pub fn warnings(scenario: &Scenario, surface: Option<&Surface>) -> Vec<String> {
    if scenario.terrain.is_none() {
        return Vec::new();
    }
    let warning = match &scenario.shadows {
        Shadows::Multiscale { .. } => {
            Some("shadows: Multiscale smooths skylines over degrees, the Sun's disc is half a degree wide".into())
        }
        Shadows::SingleAzimuth { edge: Edge::Hard, .. } => Some(
            "shadows: SingleAzimuth with the edge Hard has no penumbra: a point sees all of the disc or nothing".into(),
        ),
        Shadows::MaximumMipmaps { runs } if !runs.is_empty() => short(runs, surface),
        _ => None,
    };
    warning.into_iter().collect()
}

/// Runs that end before the terrain does.
fn short(runs: &[u32], surface: Option<&Surface>) -> Option<String> {
    let postings: u32 = runs.iter().map(|mips| 1 << (mips - 1)).sum();
    let reach = |levels: &[crate::terrain::Level]| {
        let (low, high) = levels.last()?.seen_m();
        Some((high - low).length() / levels.first()?.posting_m)
    };
    let levels = surface?.terrain.faces.iter().filter_map(|face| reach(&face.levels));
    let needed = levels.fold(0.0, f64::max);
    (f64::from(postings) < needed).then(|| {
        format!(
            "shadows: MaximumMipmaps(runs: {runs:?}) looks {postings} postings far, the terrain is {needed:.0} wide: what stands \
             further off casts no shadow; without runs the search goes to the end"
        )
    })
}
