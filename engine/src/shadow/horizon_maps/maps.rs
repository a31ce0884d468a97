//! Horizon maps, where they are evaluated, and what is made of them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::visibility::Visibility;
use crate::horizon::HorizonMap;

/// Where horizon maps are evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum At {
    /// At every sample of a pixel.
    #[default]
    Pixels,
    /// At the terrain's nodes, once while the Sun stands still; interpolated between them.
    Nodes,
}

/// The method: horizon maps by face and level.
#[derive(Debug, Clone)]
pub struct HorizonMaps {
    pub maps: Vec<Vec<HorizonMap>>,
    pub at: At,
    /// `None`: what stands above the skyline's tangent is seen of the disc. Else a lighting factor, found so.
    pub visibility: Option<Visibility>,
}

impl HorizonMaps {
    /// Evaluated at every sample, with what is seen of the disc.
    pub fn of(maps: Vec<Vec<HorizonMap>>) -> Self {
        Self { maps, at: At::Pixels, visibility: None }
    }

    /// Skylines found at nodes.
    pub fn at_nodes(maps: Vec<Vec<HorizonMap>>) -> Self {
        Self { at: At::Nodes, ..Self::of(maps) }
    }
}
