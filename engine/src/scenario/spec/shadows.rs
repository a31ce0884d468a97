//! How shadows are cast, as written; older spellings, and what they are now.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::shadow::horizon_maps::{At, HorizonMapsOptions, ShadowPreset, Visibility};
use crate::shadow::mipmaps::MipmapsOptions;
use crate::shadow::multiscale::MultiscaleOptions;
use crate::shadow::towards_sun::options::{NEAR, default_azimuth_step_deg, default_spacing};
use crate::shadow::towards_sun::{Edge, Search, TowardsSunOptions};
use crate::shadow::{MethodOptions, registry};

/// How shadows are cast.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Shadows {
    /// By the method that is ready soonest of those that are right enough: towards the Sun by a swath where a sequence lasts
    /// hours at most, by a sweep for each of a few exposures, horizon maps for more or where `refine` or `sun_fraction_sigma`
    /// need them, tracing where nothing else will do. The run says which, and why. The default.
    Auto {
        /// RMS error of the irradiance, in full Suns, that the shadows may have on terrain like the measured.
        #[serde(default = "default_max_irradiance_error")]
        #[schemars(range(min = 0.0, max = 1.0))]
        max_irradiance_error: f64,
    },
    /// From Fourier-compressed horizon maps, made once for all Suns.
    HorizonMaps(HorizonMapsOptions),
    /// From horizons of all nodes in the azimuths of the Sun's disc, found while the Sun stands still: accurate and small.
    TowardsSun(TowardsSunOptions),
    /// By a search of maximum mipmaps towards the Sun at every sample (Jung 2020): no horizon maps, more time an image.
    MaximumMipmaps(MipmapsOptions),
    /// From a multi-scale pyramid of heights (Snyder & Nowrouzezahrai 2008): smooth skylines for large, dim sources. No
    /// match for the Sun's disc.
    Multiscale(MultiscaleOptions),
    /// From the exact horizon of each point, without compression. Slow; the one to compare with.
    Traced,
    /// No cast shadows; the ground still turns away from the Sun.
    Off,
    /// Now HorizonMaps().
    #[schemars(extend("deprecated" = true))]
    Fourier,
    /// Now HorizonMaps(at: Nodes).
    #[schemars(extend("deprecated" = true))]
    Baked,
    /// Now HorizonMaps(visibility: …).
    #[schemars(extend("deprecated" = true))]
    Series {
        /// How the share is found.
        #[serde(default)]
        visibility: Visibility,
        /// Coefficients that are evaluated: 4, 8, 12 or 16 of an fm or f encoding. Default: all.
        #[serde(default)]
        #[schemars(range(min = 4, max = 16))]
        coefficients: Option<u32>,
        /// Where.
        #[serde(default)]
        at: At,
    },
    /// Now HorizonMaps(visibility: …, coefficients: …).
    #[schemars(extend("deprecated" = true))]
    Preset(ShadowPreset),
    /// Now TowardsSun(by: Swath()).
    #[schemars(extend("deprecated" = true))]
    Swath {
        /// Most between two azimuths.
        #[serde(default = "default_azimuth_step_deg")]
        #[schemars(range(min = 0.01, max = 5.0))]
        azimuth_step_deg: f64,
    },
    /// Now TowardsSun(by: Sweep()).
    #[schemars(extend("deprecated" = true))]
    Sweep {
        /// Most between two azimuths.
        #[serde(default = "default_azimuth_step_deg")]
        #[schemars(range(min = 0.01, max = 5.0))]
        azimuth_step_deg: f64,
    },
    /// Now TowardsSun(by: SingleAzimuth()).
    #[schemars(extend("deprecated" = true))]
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

/// What all methods but the coarse ones reach.
fn default_max_irradiance_error() -> f64 {
    0.01
}

impl Default for Shadows {
    fn default() -> Self {
        Self::Auto { max_irradiance_error: default_max_irradiance_error() }
    }
}

impl Shadows {
    /// As it is written now.
    pub fn current(&self) -> Self {
        let towards_sun = |by: Search| Self::TowardsSun(TowardsSunOptions { by });
        match *self {
            Self::Fourier => Self::HorizonMaps(HorizonMapsOptions::default()),
            Self::Baked => Self::HorizonMaps(HorizonMapsOptions { at: At::Nodes, ..Default::default() }),
            Self::Series { visibility, coefficients, at } => {
                // At every sample the line's share is that of the disc above the skyline's tangent.
                let visibility = Some(visibility).filter(|&found| (found, at) != (Visibility::Line, At::Pixels));
                Self::HorizonMaps(HorizonMapsOptions { at, visibility, coefficients, encoding: None })
            }
            Self::Preset(preset) => preset.options().map_or(Self::Off, Self::HorizonMaps),
            Self::Swath { azimuth_step_deg } => towards_sun(Search::Swath { azimuth_step_deg, near: NEAR }),
            Self::Sweep { azimuth_step_deg } => towards_sun(Search::Sweep { azimuth_step_deg, near: NEAR }),
            Self::SingleAzimuth { spacing, edge } => towards_sun(Search::SingleAzimuth { spacing, edge }),
            _ => self.clone(),
        }
    }

    /// What to write instead of an older spelling.
    pub fn note(&self) -> Option<String> {
        let old = match self {
            Self::Fourier => "Fourier",
            Self::Baked => "Baked",
            Self::Series { .. } => "Series",
            Self::Preset(_) => "Preset",
            Self::Swath { .. } => "Swath",
            Self::Sweep { .. } => "Sweep",
            Self::SingleAzimuth { .. } => "SingleAzimuth",
            _ => return None,
        };
        let now = self.method()?.spelling();
        Some(format!("shadows: {old} is an older spelling that goes on working; write {now}"))
    }

    /// The options of the method; `None`: it is to be chosen.
    pub fn method(&self) -> Option<Box<dyn MethodOptions>> {
        Some(match self.current() {
            Self::HorizonMaps(options) => Box::new(options),
            Self::TowardsSun(options) => Box::new(options),
            Self::MaximumMipmaps(options) => Box::new(options),
            Self::Multiscale(options) => Box::new(options),
            Self::Traced => registry::reference_options(),
            Self::Off => registry::no_shadows_options(),
            _ => return None,
        })
    }

    /// Whether nothing casts any.
    pub fn are_off(&self) -> bool {
        self.current() == Self::Off
    }

    /// The key of an option, for messages.
    pub fn key(&self, option: &str) -> String {
        match self {
            Self::Preset(_) => "shadows".into(),
            _ => format!("shadows.{option}"),
        }
    }
}
