//! Horizon tiles: built, opened, asked for the skyline of a place.

use std::path::{Path, PathBuf};

use glam::DVec2;
use perilune_engine::horizon::header::Header;
use perilune_engine::horizon::inspect::TilePoint;
use perilune_engine::horizon::{self, Encoding, ErrorStatistics, HorizonMap, Method, Settings, store};
use perilune_engine::pipeline::Progress;

use crate::{Error, Scene};

/// How horizons are searched and compressed. All of it shapes a tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HorizonSettings {
    /// Number of azimuths, evenly spaced.
    pub azimuths: usize,
    /// Terrain further away, in metres, does not occlude; `None`: all terrain does.
    pub search_m: Option<f64>,
    /// Height of the observer above the ground.
    pub observer_height_m: f64,
    /// How skylines are looked for.
    pub method: Method,
    /// How they are compressed.
    pub encoding: Encoding,
}

impl Default for HorizonSettings {
    /// All terrain, seen from the ground in 360 azimuths, swept, as 16 Fourier coefficients.
    fn default() -> Self {
        let Settings { azimuths, search_m, observer_height_m, method, .. } = Settings::default();
        Self { azimuths, search_m, observer_height_m, method, encoding: Encoding::default() }
    }
}

impl HorizonSettings {
    pub(crate) fn engine(&self) -> (Settings, Encoding) {
        let Self { azimuths, search_m, observer_height_m, method, encoding } = *self;
        (Settings { azimuths, search_m, observer_height_m, method, ..Settings::default() }, encoding)
    }
}

/// The skylines of all nodes of a map, compressed, with their error.
#[derive(Debug)]
pub struct HorizonTile {
    header: Header,
    map: HorizonMap,
}

impl HorizonTile {
    /// Builds the tiles of a scene's terrain in a folder, one a level, the finest first; those that are there are kept.
    ///
    /// # Errors
    /// [`ErrorKind::Horizon`](crate::ErrorKind::Horizon) for settings out of range and tiles that cannot be written.
    pub fn build(
        scene: &Scene,
        settings: &HorizonSettings,
        folder: impl AsRef<Path>,
        progress: &dyn Progress,
    ) -> Result<Vec<PathBuf>, Error> {
        let mut paths = Vec::new();
        scene.horizon_maps(settings, folder.as_ref(), progress, |path| paths.push(path))?;
        Ok(paths)
    }

    /// Opens a tile.
    ///
    /// # Errors
    /// [`ErrorKind::Horizon`](crate::ErrorKind::Horizon) for a file that is no whole tile.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, Error> {
        let (header, map) = store::read(path.as_ref())?;
        Ok(Self { header, map })
    }

    /// Nodes along the map's axes: columns, rows.
    pub fn nodes(&self) -> [usize; 2] {
        [self.map.columns, self.map.rows]
    }

    /// Distance of its nodes on the map.
    pub fn posting_m(&self) -> f64 {
        self.header.map.posting_m
    }

    /// How far decoded skylines are off traced ones, as measured when the tile was built.
    pub fn errors(&self) -> ErrorStatistics {
        self.map.errors.decoded
    }

    /// The skyline of a place in degrees, longitudes east; `None` off the tile.
    pub fn skyline(&self, latitude_deg: f64, longitude_deg: f64) -> Option<Skyline<'_>> {
        let point = TilePoint::on(&self.header, latitude_deg, longitude_deg)?;
        Some(Skyline { tile: self, horizon: self.map.horizon(point.grid), point })
    }
}

/// The skyline around a place.
#[derive(Debug)]
pub struct Skyline<'a> {
    tile: &'a HorizonTile,
    point: TilePoint,
    horizon: horizon::Horizon,
}

impl Skyline<'_> {
    /// Elevation of the skyline at an azimuth clockwise from north, above the plane that is perpendicular to the vector from
    /// the map's centre of projection.
    pub fn elevation_rad(&self, azimuth_rad: f64) -> f64 {
        let towards: DVec2 = self.point.direction(&self.tile.header, azimuth_rad);
        self.point.relevant_rad(&self.tile.header, self.horizon.evaluate_towards(towards).0)
    }

    /// What the error stays below at every azimuth, at 19 places of 20; `None` where it is not known.
    pub fn bound_rad(&self) -> Option<f64> {
        self.tile.map.bound_rad(self.point.grid)
    }
}
