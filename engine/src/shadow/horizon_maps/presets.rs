//! Presets of Fritsch et al. (2025), table 3, as options.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::maps::At;
use super::options::HorizonMapsOptions;
use super::visibility::Visibility;
use crate::horizon::Encoding;

/// Presets of Fritsch 2025, table 3: coefficients, samples across the Sun, shader stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum ShadowPreset {
    /// No shadows.
    None,
    /// 8, middle value, vertices.
    Low,
    /// 16, middle value, vertices.
    Medium,
    /// 8, middle value, fragments.
    MediumFrag,
    /// 16, middle value, fragments.
    High,
    /// 16, three boxes, fragments.
    VeryHighX3,
    /// 16, five boxes, fragments.
    VeryHighX5,
    /// 16, seven boxes, fragments.
    VeryHighX7,
}

impl ShadowPreset {
    pub const ALL: [Self; 8] = [
        Self::None,
        Self::Low,
        Self::Medium,
        Self::MediumFrag,
        Self::High,
        Self::VeryHighX3,
        Self::VeryHighX5,
        Self::VeryHighX7,
    ];

    /// The paper's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "None",
            Self::Low => "Low",
            Self::Medium => "Medium",
            Self::MediumFrag => "MediumFrag",
            Self::High => "High",
            Self::VeryHighX3 => "VeryHighX3",
            Self::VeryHighX5 => "VeryHighX5",
            Self::VeryHighX7 => "VeryHighX7",
        }
    }

    /// What it stands for; `None`: no shadows.
    pub fn options(self) -> Option<HorizonMapsOptions> {
        let (visibility, coefficients, at) = match self {
            Self::None => return None,
            Self::Low => (Visibility::MiddleValue, 8, At::Nodes),
            Self::Medium => (Visibility::MiddleValue, 16, At::Nodes),
            Self::MediumFrag => (Visibility::MiddleValue, 8, At::Pixels),
            Self::High => (Visibility::MiddleValue, 16, At::Pixels),
            Self::VeryHighX3 => (Visibility::Boxes(3), 16, At::Pixels),
            Self::VeryHighX5 => (Visibility::Boxes(5), 16, At::Pixels),
            Self::VeryHighX7 => (Visibility::Boxes(7), 16, At::Pixels),
        };
        let (visibility, coefficients) = (Some(visibility), Some(coefficients));
        Some(HorizonMapsOptions { at, visibility, coefficients, encoding: None })
    }

    /// The preset on maps of the paper's encoding, whatever the scenario's is.
    pub fn as_printed(self) -> Option<HorizonMapsOptions> {
        self.options().map(|options| HorizonMapsOptions { encoding: Some(Encoding::Fm16), ..options })
    }
}
