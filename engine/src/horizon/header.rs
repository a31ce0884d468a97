//! What a tile says of itself, as JSON in the file.

use serde::{Deserialize, Serialize};

use super::georeference::{self, Georeference};
use super::key::{FORMAT_VERSION, Key, level_hash};
use super::pack::{Encoding, HorizonMap, encoding};
use super::pages::PageHeader;
use super::request::Request;
use super::settings::Settings;
use super::statistics::TileErrors;
use crate::terrain::{Face, Level};

mod check;

pub const FORMAT: &str = "perilune horizon tile";

/// All that a decoder needs, as JSON in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    pub format: String,
    pub format_version: u32,
    pub generator: String,
    pub key: Key,
    #[serde(with = "encoding::by_name")]
    pub encoding: Encoding,
    /// `h(A) = Re Σ Xₖ e^{ikA}`: one-sided, radians.
    pub series: String,
    /// κ of [`super::companding`], where the series is of compressed elevations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub growth: Option<f64>,
    pub azimuth: String,
    pub elevation: String,
    pub pixel: String,
    pub body: BodyHeader,
    /// Nodes of the grid.
    pub columns: usize,
    pub rows: usize,
    pub settings: Settings,
    pub map: MapHeader,
    /// The swept level, then the coarser ones that only occlude.
    pub inputs: Vec<InputHeader>,
    pub errors: TileErrors,
    /// In the order of the file; filled in by [`super::store::write()`].
    pub pages: Vec<PageHeader>,
}

/// The spheroid that latitudes refer to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BodyHeader {
    pub name: String,
    pub equatorial_radius_m: f64,
    pub polar_radius_m: f64,
}

/// The gnomonic map of a tile.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MapHeader {
    pub projection: String,
    pub radius_m: f64,
    /// Centre of projection, body-fixed.
    pub origin_m: [f64; 3],
    /// Body-fixed axes: right and up on the map, and outward.
    pub right: [f64; 3],
    pub up: [f64; 3],
    pub outward: [f64; 3],
    pub posting_m: f64,
    /// Map coordinates of the first seen node, bottom left.
    pub west_m: f64,
    pub south_m: f64,
    /// Latitude and longitude of the map's centre, and the map for PROJ; absent where it is no map about the body's
    /// centre with north up.
    pub centre_deg: Option<[f64; 2]>,
    pub proj4: Option<String>,
}

/// One level of heights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InputHeader {
    pub columns: usize,
    pub rows: usize,
    pub posting_m: f64,
    pub margin: usize,
    pub sha256: String,
}

impl Header {
    pub fn new(request: &Request, map: &HorizonMap) -> Self {
        let Request { body, face, level, settings, .. } = *request;
        let input = |level: &Level| InputHeader {
            columns: level.columns,
            rows: level.rows,
            posting_m: level.posting_m,
            margin: level.margin,
            sha256: crate::digest::hex(&level_hash(level)),
        };
        Self {
            format: FORMAT.into(),
            format_version: FORMAT_VERSION,
            generator: format!("perilune {}", env!("CARGO_PKG_VERSION")),
            key: request.key(),
            encoding: map.encoding,
            series: "h(A) = sum over pages of weight * value; weight: re k, a k: cos kA; im k: -sin kA; b k: sin kA; h i of n: \
                     max(0, 1 - |A n/2pi - i|); with a growth the skyline is h + growth * h^3"
                .into(),
            growth: map.encoding.growth(),
            azimuth: "map azimuth, clockwise from map up (+Y) towards map right (+X)".into(),
            elevation: "above the plane perpendicular to the vector from the centre of projection".into(),
            pixel: "pixel centres are grid nodes; a texel of scale s is the mean of its s x s nodes, counted from the bottom left".into(),
            body: BodyHeader {
                name: body.name.clone(),
                equatorial_radius_m: body.equatorial_radius_m,
                polar_radius_m: body.polar_radius_m,
            },
            columns: map.columns,
            rows: map.rows,
            settings,
            map: MapHeader::new(face, level),
            inputs: face.levels[level..].iter().map(input).collect(),
            errors: map.errors,
            pages: Vec::new(),
        }
    }
}

impl MapHeader {
    fn new(face: &Face, level: usize) -> Self {
        let (map, level) = (&face.map, &face.levels[level]);
        let axes = map.map_from_body.matrix();
        let centre_deg = georeference::centre_deg(map);
        let corner_m = level.node_m(level.margin, level.margin);
        Self {
            projection: "gnomonic: X = R x/z, Y = R y/z, with x, y, z along right, up, outward from the origin".into(),
            radius_m: map.radius_m,
            origin_m: map.origin.vector_m().to_array(),
            right: axes.row(0).to_array(),
            up: axes.row(1).to_array(),
            outward: axes.row(2).to_array(),
            posting_m: level.posting_m,
            west_m: corner_m.x,
            south_m: corner_m.y,
            centre_deg,
            proj4: centre_deg.map(|centre_deg| georeference::proj4(map.radius_m, centre_deg)),
        }
    }

    /// The map as GeoTIFF has it, for a tile of so many rows; `None` where PROJ has no word for it.
    pub fn georeference(&self, rows: usize) -> Option<Georeference> {
        Some(Georeference {
            radius_m: self.radius_m,
            centre_deg: self.centre_deg?,
            posting_m: self.posting_m,
            west_m: self.west_m,
            north_m: self.south_m + (rows - 1) as f64 * self.posting_m,
        })
    }
}
