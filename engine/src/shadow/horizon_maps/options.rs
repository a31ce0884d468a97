//! How horizon maps are asked for.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::cost::cost;
use super::device::DeviceMaps;
use super::maps::{At, HorizonMaps};
use super::visibility::Visibility;
use crate::gpu::{Gpu, GpuError};
use crate::horizon::{Encoding, HorizonMap};
use crate::shadow::field_pages::FieldPages;
use crate::shadow::method::{
    Cost, Flaw, Ingredients, MethodOptions, PrepareError, ShadowMethod, Workload, spelled, unless_default,
};
use crate::terrain::Terrain;

/// From Fourier-compressed horizon maps.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct HorizonMapsOptions {
    /// Where they are evaluated. At nodes: far less work an image, and shadows that are smoother by a fraction of a node.
    pub at: At,
    /// Light as the share of the Sun's disc above the skyline times the cosine of the incidence (Fritsch 2025), with the share
    /// found so. Default: the part of the disc above the skyline's tangent and above the ground's own plane, which is more
    /// accurate.
    pub visibility: Option<Visibility>,
    /// Coefficients that are evaluated: 4, 8, 12 or 16 of an fm or f encoding. Default: all.
    #[schemars(range(min = 4, max = 16))]
    pub coefficients: Option<u32>,
    /// `None`: the scenario's.
    #[serde(skip)]
    pub encoding: Option<Encoding>,
}

impl MethodOptions for HorizonMapsOptions {
    fn spelling(&self) -> String {
        let at = match self.at {
            At::Pixels => "Pixels",
            At::Nodes => "Nodes",
        };
        spelled(
            "HorizonMaps",
            [
                unless_default("at", &self.at, at),
                self.visibility.map(|visibility| format!("visibility: {visibility}")),
                self.coefficients.map(|coefficients| format!("coefficients: {coefficients}")),
            ],
        )
    }

    fn needs_maps(&self) -> bool {
        true
    }

    fn encoding(&self, of_scenario: Encoding) -> Encoding {
        self.encoding.unwrap_or(of_scenario)
    }

    fn has_bounds(&self) -> bool {
        self.visibility.is_none() && self.coefficients.is_none()
    }

    fn flaw(&self, encoding: Encoding) -> Option<Flaw> {
        let coefficients = self.coefficients?;
        let flaw = |got: Option<String>, rule: String| Some(Flaw { key: "coefficients", got, rule });
        if !coefficients.is_multiple_of(4) {
            let rule = "is not 4, 8, 12 or 16: four make a page of texels";
            return flaw(Some(coefficients.to_string()), rule.into());
        }
        if encoding.with_coefficients(coefficients).is_some() {
            return None;
        }
        flaw(
            None,
            format!(
                "needs {coefficients} coefficients, which horizon.encoding {encoding} has not; fm{coefficients} or more \
                 and f{coefficients} or more have them"
            ),
        )
    }

    fn cost(&self, work: &Workload) -> Option<Cost> {
        Some(cost(work, self.at))
    }

    fn check_device(&self, gpu: &Gpu, terrain: &Terrain, lights: usize, encoding: Encoding) -> Result<(), GpuError> {
        DeviceMaps::check(gpu, terrain.seen_nodes(), self.encoding(encoding))?;
        match self.at {
            At::Pixels => Ok(()),
            At::Nodes => FieldPages::new(gpu, terrain, lights).map(drop),
        }
    }

    fn prepare(&self, ingredients: Ingredients) -> Result<Arc<dyn ShadowMethod>, PrepareError> {
        let cut = |map: HorizonMap| match self.coefficients {
            // A map that has fewer was refused as a flaw.
            Some(coefficients) => map.with_coefficients(coefficients).expect("options without a flaw"),
            None => map,
        };
        let maps = ingredients.maps.into_iter().map(|levels| levels.into_iter().map(cut).collect()).collect();
        Ok(Arc::new(HorizonMaps { maps, at: self.at, visibility: self.visibility }))
    }
}
