//! Body, terrain and horizon, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::horizon::Encoding;
use crate::raster::Values;

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
        /// Unit of the values after scale and offset: m, km, dm, cm, mm, ft, us-ft, yd or mi. Default: as the file says.
        #[serde(default)]
        unit: Option<String>,
        /// Coordinate reference system as WKT, PROJ string or authority code. Default: the file's own.
        #[serde(default)]
        crs: Option<String>,
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
        #[serde(default = "super::one")]
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
        /// Unit of the values after scale and offset: m, km, dm, cm, mm, ft, us-ft, yd or mi. Default: as the file says.
        #[serde(default)]
        unit: Option<String>,
        /// Coordinate reference system as WKT, PROJ string or authority code. Default: the file's own.
        #[serde(default)]
        crs: Option<String>,
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
        /// Unit of the values after scale and offset: m, km, dm, cm, mm, ft, us-ft, yd or mi. Default: as the file says.
        #[serde(default)]
        unit: Option<String>,
        /// Coordinate reference system as WKT, PROJ string or authority code. Default: the file's own.
        #[serde(default)]
        crs: Option<String>,
        /// The finest posting, at most. Default: the file's own.
        #[serde(default)]
        #[schemars(range(min = 1.0, max = 1_000_000.0))]
        posting_m: Option<f64>,
        /// A folder of `sim horizon globe` whose horizons are taken where it has them; its tiles' size, posting and margin
        /// hold. Default: all are made, and kept in the cache.
        #[serde(default)]
        tiles: Option<String>,
        /// Detail ends where nodes are seen closer than this.
        #[serde(default = "super::one")]
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
        /// this scenario's own. Refused where light comes from elsewhere (earthshine, ambient or bounced light) and where the Sun
        /// goes through more than 120° over the exposures.
        #[serde(default)]
        band: bool,
    },
}

/// As in Fritsch 2025; the 31 harmonics of the default encoding need 63.
pub const DEFAULT_AZIMUTHS: u32 = 360;

fn default_azimuths() -> u32 {
    DEFAULT_AZIMUTHS
}
