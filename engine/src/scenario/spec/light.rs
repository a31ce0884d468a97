//! The Sun, the Earth and the sky, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The Sun.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Sun {
    /// Brightness across the disc.
    pub disc: Disc,
    /// The Sun's spectrum, from which follows the light in the camera's band. Default: Tsis1Hsrs where the camera has a
    /// band; without one all of sunlight, 1361 W m-2 (IAU 2015 B3).
    pub spectrum: Option<Spectrum>,
    /// Irradiance at 1 au in the camera's band, instead of a spectrum.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub irradiance_w_m2: Option<f64>,
    /// Lets the Earth hide the Sun from the Moon during a lunar eclipse. One share holds for the whole scene.
    pub eclipses: bool,
    /// Holds the Sun still in the sky of the terrain's centre, whatever the epoch: for tests and studies.
    pub fixed: Option<FixedSun>,
}

impl Default for Sun {
    fn default() -> Self {
        Self { disc: Disc::default(), spectrum: None, irradiance_w_m2: None, eclipses: true, fixed: None }
    }
}

/// A table of the Sun's spectral irradiance at 1 au.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Spectrum {
    /// TSIS-1 Hybrid Solar Reference Spectrum, version 2: 350 to 2500 nm, 0.3 %.
    Tsis1Hsrs,
    /// ASTM E490: 119.5 nm to 1 mm, scaled to 1366.1 W m-2.
    E490,
    /// A file of two columns: wavelength in nm, W m-2 nm-1.
    Table(String),
}

/// Brightness across the solar disc.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Disc {
    /// The same everywhere: no measured Sun, but 1/3 to 2/3 more light in the depth of the penumbra.
    Uniform,
    /// Darker towards the limb, as measured at a wavelength. The default.
    LimbDarkened {
        /// The wavelength. Default: the mean wavelength of sunlight in the camera's band, 550 nm without a band.
        #[serde(default)]
        #[schemars(range(min = 300.0, max = 5000.0))]
        wavelength_nm: Option<f64>,
        /// Who measured it.
        #[serde(default)]
        law: LimbLaw,
    },
}

impl Default for Disc {
    fn default() -> Self {
        Self::LimbDarkened { wavelength_nm: None, law: LimbLaw::default() }
    }
}

/// A law of limb darkening.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum LimbLaw {
    /// A power of the cosine (Hestroffer & Magnan 1998): 303 to 357 and 416 to 1099 nm.
    #[default]
    HestrofferMagnan,
    /// A polynomial in the cosine (Neckel & Labs 1994): 303.327 to 1098.95 nm. Closer near the limb, slower.
    NeckelLabs,
}

/// A Sun that does not move.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FixedSun {
    /// Azimuth clockwise from north, at the terrain's centre.
    #[schemars(range(min = -360.0, max = 360.0))]
    pub azimuth_deg: f64,
    /// Elevation of the disc's centre above the horizontal plane, at the terrain's centre.
    #[schemars(range(min = -90.0, max = 90.0))]
    pub elevation_deg: f64,
    /// Distance of the Sun.
    #[serde(default = "super::one")]
    #[schemars(range(min = 0.05, max = 100.0))]
    pub range_au: f64,
}

/// Light that the Earth reflects onto the ground.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Earthshine {
    /// Geometric albedo of the Earth as a Lambert sphere: two thirds of its Bond albedo.
    #[serde(default = "earth_albedo")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub albedo: f64,
}

/// Two thirds of the Bond albedo of 0.29 that CERES measured (Stephens et al. 2015, doi:10.1002/2014RG000449): what the Earth
/// sends back in all directions together is then what it does send back. The geometric albedo of 0.434 (Mallama et al. 2017)
/// goes with a phase curve that is narrower than Lambert's.
fn earth_albedo() -> f64 {
    0.196
}

/// Light from all of the sky, of the same radiance everywhere: scattered light, starlight, haze.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ambient {
    /// Radiance of the sky in the camera's band.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub radiance_w_m2_sr: f64,
    /// How much of the sky the ground sees.
    #[serde(default)]
    pub sky: Sky,
}

/// Sunlight that terrain reflects onto terrain, with solid angles from horizon maps, which are made if shadows need none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Bounce {
    /// Directions all round in which ground is looked for.
    #[schemars(range(min = 4, max = 128))]
    pub azimuths: u32,
    /// Elevations between a point's own plane and its skyline in each of them.
    #[schemars(range(min = 1, max = 8))]
    pub elevations: u32,
    /// How often light is reflected from ground to ground. Each time leaves the share of the light before that ground sees of ground
    /// times its albedo: some 2 % in a lunar crater.
    #[schemars(range(min = 1, max = 4))]
    pub orders: u32,
}

impl Default for Bounce {
    fn default() -> Self {
        Self { azimuths: 32, elevations: 4, orders: 1 }
    }
}

/// How much of the sky the ground sees.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Sky {
    /// From horizon maps, which are made if shadows need none.
    #[default]
    Horizons,
    /// From a multi-scale pyramid of heights and spherical harmonics (Snyder & Nowrouzezahrai 2008): no horizon maps.
    Multiscale {
        /// Images in each halving of the resolution.
        #[serde(default = "default_level_step")]
        #[schemars(range(min = 1, max = 16))]
        level_step: u32,
        /// Halvings by which images are finer than their distance: more is sharper.
        #[serde(default = "default_level_offset")]
        #[schemars(range(min = 0.0, max = 16.0))]
        level_offset: f64,
        /// Directions all round.
        #[serde(default = "default_sky_azimuths")]
        #[schemars(range(min = 4, max = 128))]
        azimuths: u32,
    },
}

/// 16 to 32 are published for light from all round.
fn default_sky_azimuths() -> u32 {
    16
}

fn default_level_step() -> u32 {
    4
}

fn default_level_offset() -> f64 {
    2.0
}
