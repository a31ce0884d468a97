//! How horizons towards the Sun are asked for.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::single_azimuth::{Edge, SingleAzimuth};
use super::swath::{MOST_PLANES, Plan};
use super::sweep::Swept;
use crate::gpu::{Gpu, GpuError};
use crate::horizon::{Encoding, Settings};
use crate::shadow::fan::STEP_DEG;
use crate::shadow::field_pages::FieldPages;
use crate::shadow::light::QuantizedLight;
use crate::shadow::method::{
    Cost, Domain, Flaw, Ingredients, MethodOptions, PrepareError, ShadowMethod, Workload, spelled, unless_default,
};
use crate::terrain::{Surface, Terrain};

/// RMS error of the irradiance in full Suns: `docs/experiments/shadow_methods.md`.
const ERROR: f64 = 0.0035;

/// What a light's field from planes takes beside a sweep of one azimuth over all nodes.
const FIELD: f64 = 1.0;

/// From horizons of all nodes in the azimuths of the Sun's disc, found while the Sun stands still: accurate and small.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TowardsSunOptions {
    /// How the horizons are found.
    pub by: Search,
}

/// How horizons towards the Sun are found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Search {
    /// From planes of those azimuths only that the Sun's disc spans in the exposures, kept for the next run: where a sequence
    /// lasts hours at most. The default.
    Swath {
        /// Most between two azimuths.
        #[serde(default = "default_azimuth_step_deg")]
        #[schemars(range(min = 0.01, max = 5.0))]
        azimuth_step_deg: f64,
        /// Postings of the terrain within which it is looked at from every sample, where the skylines of nodes are far from those
        /// between them. 0: nodes have whole skylines.
        #[serde(default = "default_near")]
        #[schemars(range(max = 16))]
        near: u32,
    },
    /// Swept anew whenever the Sun has moved: as accurate as a swath, nothing is kept.
    Sweep {
        /// Most between two azimuths.
        #[serde(default = "default_azimuth_step_deg")]
        #[schemars(range(min = 0.01, max = 5.0))]
        azimuth_step_deg: f64,
        /// Postings of the terrain within which it is looked at from every sample, where the skylines of nodes are far from those
        /// between them. 0: nodes have whole skylines.
        #[serde(default = "default_near")]
        #[schemars(range(max = 16))]
        near: u32,
    },
    /// Stepped along the map anew whenever the Sun has moved (Aslandere 2015). `horizon.search_m` is their reach.
    SingleAzimuth {
        /// From one sample to the next, in postings of the terrain.
        #[serde(default = "default_spacing")]
        #[schemars(range(min = 0.1, max = 100.0))]
        spacing: f64,
        /// What becomes of the Sun's disc.
        #[serde(default)]
        edge: Edge,
    },
}

impl Default for Search {
    fn default() -> Self {
        Self::Swath { azimuth_step_deg: STEP_DEG, near: NEAR }
    }
}

/// Postings within which terrain is looked at from every sample where nobody asks for others.
pub const NEAR: u32 = 8;

/// Nearer than so many postings a sweep errs.
const LEAST_NEAR: u32 = 8;

/// The near terrain of swaths and sweeps where none is written.
pub fn default_near() -> u32 {
    NEAR
}

/// The step of swaths and sweeps where none is written.
pub fn default_azimuth_step_deg() -> f64 {
    STEP_DEG
}

/// The spacing of samples where none is written.
pub fn default_spacing() -> f64 {
    1.0
}

impl MethodOptions for TowardsSunOptions {
    fn spelling(&self) -> String {
        let step = |step_deg: f64| (step_deg != STEP_DEG).then(|| format!("azimuth_step_deg: {step_deg}"));
        let within = |near: u32| (near != NEAR).then(|| format!("near: {near}"));
        let by = match self.by {
            Search::Swath { azimuth_step_deg, near } => spelled("Swath", [step(azimuth_step_deg), within(near)]),
            Search::Sweep { azimuth_step_deg, near } => spelled("Sweep", [step(azimuth_step_deg), within(near)]),
            Search::SingleAzimuth { spacing, edge } => spelled(
                "SingleAzimuth",
                [
                    (spacing != default_spacing()).then(|| format!("spacing: {spacing}")),
                    unless_default("edge", &edge, edge),
                ],
            ),
        };
        spelled("TowardsSun", [Some(format!("by: {by}"))])
    }

    fn flaw(&self, _: Encoding) -> Option<Flaw> {
        let (Search::Swath { near, .. } | Search::Sweep { near, .. }) = self.by else { return None };
        let rule = format!(
            "is neither 0 nor at least {LEAST_NEAR}: nearer than that lines a posting apart do not meet what they pass"
        );
        (1..LEAST_NEAR).contains(&near).then(|| Flaw { key: "near", got: Some(near.to_string()), rule })
    }

    fn is_for_given_lights(&self) -> bool {
        matches!(self.by, Search::Swath { .. })
    }

    fn warning(&self, _: Option<&Surface>) -> Option<String> {
        (!self.domain().penumbrae).then(|| {
            "shadows: SingleAzimuth with the edge Hard has no penumbra: a point sees all of the disc or nothing".into()
        })
    }

    fn refusal(&self, surface: &Surface, lights: &[Vec<QuantizedLight>]) -> Option<PrepareError> {
        let Search::Swath { azimuth_step_deg, .. } = self.by else { return None };
        plan(surface, lights, azimuth_step_deg).err()
    }

    fn domain(&self) -> Domain {
        let penumbrae = !matches!(self.by, Search::SingleAzimuth { edge: Edge::Hard, .. });
        Domain { reach_postings: f64::INFINITY, penumbrae }
    }

    fn cost(&self, work: &Workload) -> Option<Cost> {
        let (azimuths, most) = match self.by {
            Search::Swath { .. } => (work.spanned, MOST_PLANES),
            Search::Sweep { .. } => (work.swept, usize::MAX),
            Search::SingleAzimuth { .. } => return None,
        };
        Some(Cost { azimuths, most, images: FIELD * work.lights as f64, error: ERROR })
    }

    fn check_device(&self, gpu: &Gpu, terrain: &Terrain, lights: usize, _: Encoding) -> Result<(), GpuError> {
        FieldPages::new(gpu, terrain, lights).map(drop)
    }

    fn prepare(&self, ingredients: Ingredients) -> Result<Arc<dyn ShadowMethod>, PrepareError> {
        let Ingredients { surface, settings, lights, folder, progress, .. } = ingredients;
        Ok(match self.by {
            Search::Swath { azimuth_step_deg, near } => {
                let settings = beyond(near, surface, settings);
                let plan = plan(surface, lights, azimuth_step_deg)?;
                let told = |done: usize, all: usize| progress("horizons, a swath", done, all);
                told(0, plan.planes());
                Arc::new(plan.open_or_build(surface, &settings, folder, &told)?)
            }
            Search::Sweep { azimuth_step_deg, near } => {
                let settings = beyond(near, surface, settings);
                Arc::new(Swept { settings, step_rad: azimuth_step_deg.to_radians() })
            }
            Search::SingleAzimuth { spacing, edge } => Arc::new(SingleAzimuth { settings, spacing, edge }),
        })
    }
}

/// Horizons of what samples do not look at themselves. Where terrain goes on beyond what is seen of a map, on another face or in a
/// margin, they look at nothing.
fn beyond(near: u32, surface: &Surface, settings: Settings) -> Settings {
    let faces = &surface.terrain.faces;
    let ends = faces.len() == 1 && faces[0].levels.iter().all(|level| level.margin == 0);
    Settings { near: if ends { near as usize } else { 0 }, ..settings }
}

/// The azimuths that the lights of all exposures span, where a swath can hold them.
fn plan(surface: &Surface, lights: &[Vec<QuantizedLight>], step_deg: f64) -> Result<Plan, PrepareError> {
    let plan = Plan::new(surface, lights, step_deg.to_radians());
    match plan.most_planes() {
        got if got > MOST_PLANES => {
            Err(PrepareError::TooManyAzimuths { method: "Swath", got, step_deg, allowed: MOST_PLANES })
        }
        _ => Ok(plan),
    }
}
