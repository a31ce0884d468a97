//! Body, terrain, horizon, surface and Sun, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::horizon::Encoding;

/// The body that is seen.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Body {
    /// The Moon: the sphere of 1 737 400 m that LOLA heights refer to.
    #[default]
    Moon,
    /// Mars: the IAU spheroid of 3 396 190 m and 3 376 200 m.
    Mars,
    /// Any other body; `frame` must be given with it.
    Custom {
        /// Name in the outputs.
        name: String,
        /// SPICE id of the body, as in 301 for the Moon.
        naif_id: i32,
        /// Radius at the equator.
        #[schemars(range(min = 1.0, max = 1e9))]
        equatorial_radius_m: f64,
        /// Radius at the poles.
        #[schemars(range(min = 1.0, max = 1e9))]
        polar_radius_m: f64,
    },
}

/// The ground: nested elevation models on the reference spheroid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Terrain {
    /// Where the terrain is centred. Default: the centre of the first elevation model.
    #[serde(default)]
    pub centre: Option<Centre>,
    /// Elevation models, the finest first. Beyond the last comes the bare spheroid.
    #[schemars(length(min = 1, max = 8))]
    pub dems: Vec<Dem>,
}

/// A place on the spheroid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Centre {
    /// Geodetic latitude, north positive.
    #[schemars(range(min = -90.0, max = 90.0))]
    pub latitude_deg: f64,
    /// East longitude.
    #[schemars(range(min = -360.0, max = 360.0))]
    pub longitude_deg: f64,
}

/// One elevation model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Dem {
    /// A georeferenced raster in any format and projection that GDAL reads.
    File {
        /// The file, looked for beside the scenario, then under `--data` and `SIM_DATA`.
        path: String,
        /// What its numbers are.
        #[serde(default)]
        values: Values,
        /// Resample to this posting. Default: the file's own.
        #[serde(default)]
        #[schemars(range(min = 0.01, max = 100_000.0))]
        posting_m: Option<f64>,
        /// Use only a square of this width around the centre. Default: all of it.
        #[serde(default)]
        #[schemars(range(min = 1.0, max = 1e8))]
        extent_m: Option<f64>,
    },
    /// A cratered terrain with published statistics, made on the first run and kept. Several of them, about one
    /// centre, are one terrain: each continues the next coarser one with smaller craters and shorter wavelengths.
    Synthetic {
        /// Width in postings.
        #[schemars(range(min = 16, max = 16384))]
        columns: u32,
        /// Height in postings.
        #[schemars(range(min = 16, max = 16384))]
        rows: u32,
        /// Distance of neighbouring heights.
        #[schemars(range(min = 0.01, max = 100_000.0))]
        posting_m: f64,
        /// Geodetic latitude of its centre, north positive.
        #[schemars(range(min = -90.0, max = 90.0))]
        latitude_deg: f64,
        /// East longitude of its centre.
        #[schemars(range(min = -360.0, max = 360.0))]
        longitude_deg: f64,
        /// Another seed is another terrain.
        #[serde(default)]
        seed: u64,
    },
    /// Made-up ground below the posting of the measured model that comes next: it goes on with that one's roughness, and
    /// has small craters and boulders. Means over the measured posting stay. Craters of it are landmarks that are marked
    /// invented.
    Detail {
        /// Distance of neighbouring heights: at most half of the measured model's.
        #[schemars(range(min = 0.01, max = 100_000.0))]
        posting_m: f64,
        /// Side of the square about the terrain's centre.
        #[schemars(range(min = 1.0, max = 1e6))]
        extent_m: f64,
        /// Another seed is other ground.
        #[serde(default)]
        seed: u64,
        /// Craters per area, in units of the equilibrium density.
        #[serde(default = "one")]
        #[schemars(range(min = 0.0, max = 10.0))]
        craters: f64,
        /// Boulders of more than 1 m; their number falls with the cube of their size, up to 10 m.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 1e6))]
        boulders_per_km2: f64,
    },
    /// A raster of the whole body, cut into a cube of six maps. It must be the last.
    Cube {
        /// The file, looked for beside the scenario, then under `--data` and `SIM_DATA`.
        path: String,
        /// What its numbers are.
        #[serde(default)]
        values: Values,
        /// Resample to this posting. Default: the file's own.
        #[serde(default)]
        #[schemars(range(min = 1.0, max = 1_000_000.0))]
        posting_m: Option<f64>,
    },
    /// A raster of the whole body of any size, of which the parts that the cameras see are read, each at the level of detail at
    /// which they see it. It stands alone, and its shadows come from horizon maps.
    Globe {
        /// The file, looked for beside the scenario, then under `--data` and `SIM_DATA`.
        path: String,
        /// What its numbers are.
        #[serde(default)]
        values: Values,
        /// The finest posting, at most. Default: the file's own.
        #[serde(default)]
        #[schemars(range(min = 1.0, max = 1_000_000.0))]
        posting_m: Option<f64>,
        /// A folder of `sim horizon globe` whose horizons are taken where it has them; its tiles' size, posting and margin
        /// hold. Default: all are made, and kept in the cache.
        #[serde(default)]
        tiles: Option<String>,
        /// Detail ends where nodes are seen closer than this.
        #[serde(default = "one")]
        #[schemars(range(min = 0.1, max = 100.0))]
        posting_px: f64,
        /// Where more tiles than this would be needed, detail ends sooner. A tile takes some 5 MB.
        #[serde(default = "default_most_tiles")]
        #[schemars(range(min = 6, max = 1024))]
        most_tiles: u32,
    },
}

fn default_most_tiles() -> u32 {
    96
}

/// What the numbers of an elevation model are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum Values {
    /// Heights, or radii where the numbers are near the body's radius.
    #[default]
    Auto,
    /// Heights above the file's own ellipsoid.
    Height,
    /// Distances from the body's centre.
    Radius,
}

/// How horizons are computed.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Horizon {
    /// Every key below at its default.
    #[default]
    Auto,
    /// Chosen by hand.
    Settings {
        /// Azimuths at which the horizon is sampled before it is compressed.
        #[serde(default = "default_azimuths")]
        #[schemars(range(min = 32, max = 4096))]
        azimuths: u32,
        /// How far terrain is looked for. Default: as far as the highest terrain can stand above the horizon.
        #[serde(default)]
        #[schemars(range(min = 1.0, max = 1e7))]
        search_m: Option<f64>,
        /// Height of the point above the ground from which the horizon is seen.
        #[serde(default)]
        #[schemars(range(min = 0.0, max = 1000.0))]
        observer_height_m: f64,
        /// How they are stored.
        #[serde(default)]
        encoding: Encoding,
        /// Keeps of each horizon only what decides about the Sun of this scenario's exposures: elevations far above or below
        /// its disc are moved nearer to it before they are compressed, so that high cliffs disturb the skyline less where
        /// the Sun stands. Worth trying beside cliffs; on two exposures of cratered terrain it gained nothing. Horizons are then
        /// this scenario's own. Without effect where there is earthshine, ambient or bounced light.
        #[serde(default)]
        band: bool,
    },
}

/// As in Fritsch 2025; the 31 harmonics of the default encoding need 63.
pub const DEFAULT_AZIMUTHS: u32 = 360;

fn default_azimuths() -> u32 {
    DEFAULT_AZIMUTHS
}

fn default_level_step() -> u32 {
    4
}

fn default_level_offset() -> f64 {
    2.0
}

/// How the ground reflects light.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Surface {
    /// The reflectance model.
    #[serde(default)]
    pub photometry: Photometry,
    /// Brightness of the ground. Default: 0.12, and 1 for the Hapke models, whose reflectance it multiplies.
    #[serde(default)]
    pub albedo: Option<Albedo>,
}

/// The reflectance model.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Photometry {
    /// Equal radiance in all directions.
    Lambert,
    /// Single scattering of a dark, half-infinite medium.
    LommelSeeliger,
    /// McEwen's mixture of the two with the Moon's phase function.
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
        #[serde(default = "one")]
        #[schemars(range(min = 0.0, max = 2.0))]
        eta: f64,
    },
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
    },
    /// The single-scattering albedo w of a Hapke model from a georeferenced raster, instead of the model's own.
    SingleScattering {
        /// The file, looked for beside the scenario, then under `--data` and `SIM_DATA`.
        path: String,
    },
}

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
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum Disc {
    /// The same everywhere.
    #[default]
    Uniform,
    /// Darker towards the limb, as measured at a wavelength.
    LimbDarkened {
        /// The wavelength. Default: the mean wavelength of sunlight in the camera's band.
        #[serde(default)]
        #[schemars(range(min = 300.0, max = 5000.0))]
        wavelength_nm: Option<f64>,
        /// Who measured it.
        #[serde(default)]
        law: LimbLaw,
    },
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
    #[serde(default = "one")]
    #[schemars(range(min = 0.05, max = 100.0))]
    pub range_au: f64,
}

fn one() -> f64 {
    1.0
}

/// Light that the Earth reflects onto the ground.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Earthshine {
    /// Geometric albedo of the Earth.
    #[serde(default = "earth_albedo")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub albedo: f64,
}

/// Geometric albedo of the Earth in the visible: 0.434 (Mallama et al. 2017, doi:10.1016/j.icarus.2016.09.023).
fn earth_albedo() -> f64 {
    0.434
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

/// Sunlight that terrain reflects onto terrain, once, with form factors from horizon maps, which are made if shadows need none.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Bounce {
    /// Directions all round in which ground is looked for.
    #[schemars(range(min = 4, max = 128))]
    pub azimuths: u32,
    /// Elevations between a point's own plane and its skyline in each of them.
    #[schemars(range(min = 1, max = 8))]
    pub elevations: u32,
}

impl Default for Bounce {
    fn default() -> Self {
        Self { azimuths: 32, elevations: 4 }
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
