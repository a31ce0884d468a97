//! How the ground reflects light, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the ground reflects light.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// The reflectance model.
    #[serde(default)]
    pub photometry: Photometry,
    /// How light falls with the phase angle, where the reflectance model does not say so itself. Default: as on the Moon for
    /// the Moon and every model but `Lambert`, and not at all elsewhere.
    #[serde(default)]
    pub phase_function: Option<PhaseFunction>,
    /// Brightness of the ground. Default: 0.19 with the Moon's phase function, 0.12 without one, and 1 for the models whose
    /// reflectance it multiplies, those of Hapke and LROC.
    #[serde(default)]
    pub albedo: Option<Albedo>,
}

/// The reflectance model.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Photometry {
    /// Equal radiance in all directions. Without a phase function, unless one is asked for.
    Lambert,
    /// Single scattering of a dark, half-infinite medium.
    LommelSeeliger,
    /// McEwen's mixture of the two, weighted by the phase angle as fits the Moon.
    #[default]
    LunarLambert,
    /// Radiance falls with the incidence as a power of its cosine. Not beyond 80° of emission, where it diverges.
    Minnaert {
        /// 1 is Lambert's law.
        #[schemars(range(min = 0.5, max = 1.5))]
        k: f64,
    },
    /// Akimov's law, found on the Moon: flat at full phase, falling towards terminator and poles.
    Akimov {
        /// How fast light falls towards the poles of the photometric system: 1 is the law without a parameter.
        #[serde(default = "super::one")]
        #[schemars(range(min = 0.0, max = 2.0))]
        eta: f64,
    },
    /// The Moon as LROC's narrow-angle cameras saw it, fitted in 2019 to phase angles of 15 to 65° (USGS ISIS, `lronacpho`).
    LrocNac2019,
    /// Hapke's model with the parameters of the Moon at 566 nm (Sato et al. 2014).
    HapkeMoon,
    /// Hapke's model with parameters of Mars in red light (Kirk & Johnson, in USGS ISIS).
    HapkeMars,
    /// Hapke's model with parameters of Mercury at 554 nm (Warell & Valegård 2006).
    HapkeMercury,
    /// Hapke's model.
    Hapke {
        /// Single-scattering albedo.
        #[schemars(range(min = 0.0, max = 1.0))]
        w: f64,
        /// Width of the two lobes of the particle phase function.
        #[schemars(range(min = 0.0, max = 0.999))]
        b: f64,
        /// Weight of the backward lobe: 1 is all backward, -1 all forward.
        #[schemars(range(min = -1.3, max = 1.3))]
        c: f64,
        /// Amplitude of the shadow-hiding opposition surge.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 10.0))]
        bs0: f64,
        /// Angular width of the shadow-hiding opposition surge.
        #[serde(default = "default_surge_width")]
        #[schemars(range(min = 1e-4, max = 10.0))]
        hs: f64,
        /// Amplitude of coherent backscatter.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 10.0))]
        bc0: f64,
        /// Angular width of coherent backscatter.
        #[serde(default = "default_surge_width")]
        #[schemars(range(min = 1e-4, max = 10.0))]
        hc: f64,
        /// Mean slope of the roughness that no pixel resolves.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 60.0))]
        theta_bar_deg: f64,
        /// Filling factor: the share of volume that grains take.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 0.75))]
        phi: f64,
    },
}

/// How light falls with the phase angle, beyond what the reflectance model says.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum PhaseFunction {
    /// So that a sphere is as bright as ROLO saw the Moon at 665 nm (Kieffer & Stone 2005), up to 97°, and as that goes on up
    /// to 130°.
    Moon,
    /// Not at all: a model without a phase function is 1.3 to 2.2 times as bright as the Moon at 30 to 90°.
    Constant,
}

/// Without an amplitude the width has no effect; it only has to keep the surge finite.
fn default_surge_width() -> f64 {
    0.1
}

/// Brightness of the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Albedo {
    /// The same everywhere.
    Constant(#[schemars(range(min = 0.0, max = 1.0))] f64),
    /// From a georeferenced raster.
    Map {
        /// The file, looked for beside the scenario, then under `--data` and `SIM_DATA`.
        path: String,
        /// The band, counted from 1; needed where there are several.
        #[serde(default)]
        #[schemars(range(min = 1, max = 65535))]
        band: Option<u32>,
        /// The stored number that marks missing data, besides what the file declares.
        #[serde(default)]
        #[schemars(range(min = f64::MIN, max = f64::MAX))]
        nodata: Option<f64>,
        /// What stored numbers are multiplied by. Default: as the file says.
        #[serde(default)]
        #[schemars(range(min = -1e9, max = 1e9))]
        scale: Option<f64>,
        /// What is added to scaled numbers. Default: as the file says.
        #[serde(default)]
        #[schemars(range(min = -1e9, max = 1e9))]
        offset: Option<f64>,
        /// Unit of the values after scale and offset: 1 or %. Default: as the file says.
        #[serde(default)]
        unit: Option<String>,
        /// Coordinate reference system as WKT, PROJ string or authority code. Default: the file's own.
        #[serde(default)]
        crs: Option<String>,
    },
    /// The single-scattering albedo w of a Hapke model from a georeferenced raster, instead of the model's own.
    SingleScattering {
        /// The file, looked for beside the scenario, then under `--data` and `SIM_DATA`.
        path: String,
        /// The band, counted from 1; needed where there are several.
        #[serde(default)]
        #[schemars(range(min = 1, max = 65535))]
        band: Option<u32>,
        /// The stored number that marks missing data, besides what the file declares.
        #[serde(default)]
        #[schemars(range(min = f64::MIN, max = f64::MAX))]
        nodata: Option<f64>,
        /// What stored numbers are multiplied by. Default: as the file says.
        #[serde(default)]
        #[schemars(range(min = -1e9, max = 1e9))]
        scale: Option<f64>,
        /// What is added to scaled numbers. Default: as the file says.
        #[serde(default)]
        #[schemars(range(min = -1e9, max = 1e9))]
        offset: Option<f64>,
        /// Unit of the values after scale and offset: 1 or %. Default: as the file says.
        #[serde(default)]
        unit: Option<String>,
        /// Coordinate reference system as WKT, PROJ string or authority code. Default: the file's own.
        #[serde(default)]
        crs: Option<String>,
    },
}
