//! Detector and outputs, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::dataset::Format;
use crate::render::Quantity;

/// What turns light into digital numbers (EMVA 1288).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Detector {
    /// Electrons per photon, averaged over the band.
    #[schemars(range(min = 1e-4, max = 1.0))]
    pub quantum_efficiency: f64,
    /// Electrons a pixel holds.
    #[schemars(range(min = 1.0, max = 1e8))]
    pub full_well_e: f64,
    /// Noise of reading a pixel, one sigma, in electrons.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e5))]
    pub read_noise_e: f64,
    /// Electrons that a pixel gathers per second in the dark.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e8))]
    pub dark_current_e_per_s: f64,
    /// Electrons per digital number.
    #[schemars(range(min = 1e-4, max = 1e6))]
    pub gain_e_per_dn: f64,
    /// Digital number of no electrons.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 65535.0))]
    pub offset_dn: f64,
    /// Bits of a digital number.
    #[schemars(range(min = 1, max = 16))]
    pub bits: u32,
    /// Standard deviation of the pixels' gains, relative (PRNU).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub prnu: f64,
    /// Standard deviation of the pixels' dark offsets (DSNU).
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1e5))]
    pub dsnu_e: f64,
    /// Whether full wells spill along their column.
    #[serde(default)]
    pub blooming: bool,
}

/// What is written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Outputs {
    /// Planes of each image.
    #[schemars(length(min = 1, max = 64))]
    pub planes: Vec<Quantity>,
    /// Writes the planes as float TIFF too, one page each.
    pub tiff: bool,
    /// Files besides PNG and JSON, which are always written. OpenEXR is left out where another format of all planes (Fits, Npz)
    /// is named and Exr is not.
    #[schemars(length(max = 16))]
    pub formats: Vec<Format>,
    /// Scale of the preview images.
    pub preview: Preview,
    /// Writes the previews as an animation.
    pub animation: bool,
}

impl Default for Outputs {
    fn default() -> Self {
        Self {
            planes: vec![Quantity::Radiance, Quantity::SunFraction, Quantity::Depth, Quantity::Hit],
            tiff: false,
            formats: Vec::new(),
            preview: Preview::Auto,
            animation: true,
        }
    }
}

/// Craters as ellipses and conics, image by image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Landmarks {
    /// Where craters are listed. What an earlier list holds is left out of later ones.
    #[schemars(length(min = 1, max = 16))]
    pub lists: Vec<CraterList>,
    /// Craters whose longest diameter is less in an image are left out of it.
    #[schemars(range(min = 0.1, max = 65536.0))]
    pub smallest_px: f64,
    /// Craters whose longest diameter is more in an image are left out of it: nothing of their rims may be in sight.
    #[schemars(range(min = 0.1, max = 1e9))]
    pub largest_px: f64,
    /// Craters that are worn down further are left out: 0 is fresh, 0.6 all but gone. Lists that do not tell keep theirs.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub most_degraded: f64,
    /// Writes each preview with the ellipses drawn over it.
    pub overlay: bool,
}

impl Default for Landmarks {
    fn default() -> Self {
        Self { lists: vec![CraterList::Terrain], smallest_px: 5.0, largest_px: 1e9, most_degraded: 1e6, overlay: false }
    }
}

/// A lander: what the planes hazard_slope, hazard_roughness, hazard_sunlit and hazard refer to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Hazards {
    /// Diameter of the disc that it stands on.
    #[schemars(range(min = 0.01, max = 100_000.0))]
    pub footprint_m: f64,
    /// Steepest ground that it stands.
    #[schemars(range(min = 0.0, max = 90.0))]
    pub slope_deg: f64,
    /// Highest rock, or deepest hole, against the plane of the ground.
    #[schemars(range(min = 0.0, max = 1e5))]
    pub roughness_m: f64,
    /// Least mean share of the Sun's disc over the footprint. 0: light does not matter.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub sunlit_share: f64,
}

/// 0.3 m and 5 to 10° are what ALHAT looks for (Epp & Smith 2007, doi:10.1109/AERO.2007.352724).
impl Default for Hazards {
    fn default() -> Self {
        Self { footprint_m: 10.0, slope_deg: 10.0, roughness_m: 0.3, sunlit_share: 0.0 }
    }
}

/// A list of craters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum CraterList {
    /// Those that made terrain was given.
    Terrain,
    /// A catalogue in comma-separated values: the columns id, latitude_deg, longitude_deg, diameter_m and optionally
    /// minor_diameter_m, azimuth_deg, depth_m, or those of Robbins (2019).
    File {
        /// The file, looked for beside the scenario, then under `--data` and `SIM_DATA`.
        path: String,
    },
}

/// Scale of the preview images. It is the same for the whole sequence.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Preview {
    /// White is the brightest image's 99.5 % quantile.
    #[default]
    Auto,
    /// White is given.
    White {
        /// The radiance that is white.
        #[schemars(range(min = 1e-9, max = 1e9))]
        radiance_w_m2_sr: f64,
    },
}
