//! How skylines from a multi-scale pyramid are asked for.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Multiscale;
use crate::gpu::{Gpu, GpuError};
use crate::horizon::Encoding;
use crate::shadow::field_pages::FieldPages;
use crate::shadow::method::{Ingredients, MethodOptions, PrepareError, ShadowMethod, spelled};
use crate::terrain::{Surface, Terrain};

/// From a multi-scale pyramid of heights (Snyder & Nowrouzezahrai 2008): smooth skylines for large, dim sources. No
/// match for the Sun's disc.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MultiscaleOptions {
    /// Images in each halving of the resolution.
    #[schemars(range(min = 1, max = 16))]
    pub level_step: u32,
    /// Halvings by which images are finer than their distance: more is sharper.
    #[schemars(range(min = 0.0, max = 16.0))]
    pub level_offset: f64,
    /// Azimuths over which the skyline's slope is taken.
    #[schemars(range(min = 0.01, max = 90.0))]
    pub swath_deg: f64,
}

impl Default for MultiscaleOptions {
    /// The Earth's disc is 1.9° across.
    fn default() -> Self {
        Self { level_step: 4, level_offset: 2.0, swath_deg: 2.0 }
    }
}

impl MethodOptions for MultiscaleOptions {
    fn spelling(&self) -> String {
        let usual = Self::default();
        spelled(
            "Multiscale",
            [
                (self.level_step != usual.level_step).then(|| format!("level_step: {}", self.level_step)),
                (self.level_offset != usual.level_offset).then(|| format!("level_offset: {}", self.level_offset)),
                (self.swath_deg != usual.swath_deg).then(|| format!("swath_deg: {}", self.swath_deg)),
            ],
        )
    }

    fn warning(&self, _: Option<&Surface>) -> Option<String> {
        Some("shadows: Multiscale smooths skylines over degrees, the Sun's disc is half a degree wide".into())
    }

    fn check_device(&self, gpu: &Gpu, terrain: &Terrain, lights: usize, _: Encoding) -> Result<(), GpuError> {
        FieldPages::new(gpu, terrain, lights).map(drop)
    }

    fn prepare(&self, ingredients: Ingredients) -> Result<Arc<dyn ShadowMethod>, PrepareError> {
        let (terrain, swath_rad) = (&ingredients.surface.terrain, self.swath_deg.to_radians());
        Ok(Arc::new(Multiscale::new(terrain, self.level_step, self.level_offset, swath_rad)))
    }
}
