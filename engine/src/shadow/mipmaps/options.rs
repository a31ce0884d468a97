//! How a search of maximum mipmaps is asked for, and the method.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::search::{MipmapRuns, Mipmaps};
use crate::gpu::Gpu;
use crate::photometry::SolarDisk;
use crate::shadow::device::{DeviceError, DevicePart, SKYLINE_WGSL};
use crate::shadow::light::QuantizedLight;
use crate::shadow::method::{Domain, Ingredients, MethodOptions, PrepareError, ShadowMethod, spelled};
use crate::shadow::site::Shadow;
use crate::shadow::skylines::{Skylines, UnpreparedLight};
use crate::terrain::{Level, Surface};

const WGSL: &str = include_str!("mipmaps.wgsl");

/// A float of maxima at each mip.
const MAXIMA_BYTES: f64 = 4.0 / 3.0;

/// By a search of maximum mipmaps towards the Sun at every sample (Jung 2020): no horizon maps, more time an image.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MipmapsOptions {
    /// Mips of each run of the search, the nearest run first; a run of N mips looks 2^(N−1) postings further.
    /// [5, 5, 5] and [5, 5, 5, 3] are the published ones: 48 and 52 postings. Default: 5, 5, 6, 7, … as far as the
    /// terrain reaches.
    #[schemars(length(max = 16), inner(range(min = 1, max = 15)))]
    pub runs: Vec<u32>,
    /// Uniform stepping in their place, the published baseline: how many steps, of how many postings.
    #[serde(skip)]
    pub steps: Option<[u32; 2]>,
}

impl MipmapsOptions {
    /// Postings that the runs look far; those without an end reach the terrain's.
    fn postings(&self) -> Option<u32> {
        (!self.runs.is_empty()).then(|| self.runs.iter().map(|mips| 1 << (mips - 1)).sum())
    }
}

impl MethodOptions for MipmapsOptions {
    fn spelling(&self) -> String {
        spelled("MaximumMipmaps", [(!self.runs.is_empty()).then(|| format!("runs: {:?}", self.runs))])
    }

    /// Of runs that end before the terrain does.
    fn warning(&self, surface: Option<&Surface>) -> Option<String> {
        let postings = self.postings()?;
        let reach = |levels: &[Level]| {
            let (low, high) = levels.last()?.seen_m();
            Some((high - low).length() / levels.first()?.posting_m)
        };
        let levels = surface?.terrain.faces.iter().filter_map(|face| reach(&face.levels));
        let needed = levels.fold(0.0, f64::max);
        (f64::from(postings) < needed).then(|| {
            format!(
                "shadows: {} looks {postings} postings far, the terrain is {needed:.0} wide: what stands further off casts no \
                 shadow; without runs the search goes to the end",
                self.spelling()
            )
        })
    }

    fn domain(&self) -> Domain {
        Domain { reach_postings: self.postings().map_or(f64::INFINITY, f64::from), penumbrae: true }
    }

    fn prepare(&self, ingredients: Ingredients) -> Result<Arc<dyn ShadowMethod>, PrepareError> {
        Ok(Arc::new(match (self.steps, &self.runs[..]) {
            (Some([count, spacing]), _) => Mipmaps::uniform(count, f64::from(spacing)),
            (None, []) => Mipmaps::reaching(&ingredients.surface.terrain),
            (None, runs) => Mipmaps::of(runs),
        }))
    }
}

impl ShadowMethod for Mipmaps {
    fn name(&self) -> &'static str {
        "mipmaps"
    }

    fn shadow<'a>(
        &'a self,
        surface: &'a Surface,
        _: &SolarDisk,
        _: &[QuantizedLight],
        _: &Skylines,
    ) -> Result<Option<Box<dyn Shadow + 'a>>, UnpreparedLight> {
        Ok(Some(Box::new(MipmapRuns::new(surface, self))))
    }

    fn device(&self, _: &Gpu, _: &Surface, _: &SolarDisk) -> Result<DevicePart, DeviceError> {
        Ok(DevicePart::of([SKYLINE_WGSL, WGSL].concat(), self.constants().to_vec()))
    }

    fn device_bytes(&self, nodes: usize) -> f64 {
        MAXIMA_BYTES * nodes as f64
    }
}
