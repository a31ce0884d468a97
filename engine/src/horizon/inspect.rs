//! A question to a finished tile: what is the skyline of a place.

use glam::{DMat3, DVec2, DVec3};

use super::header::{Header, MapHeader};
use super::pack::HorizonMap;
use super::trace::{Skyline, Tracer};
use crate::geometry::{Body, Direction, Geodetic, Local, Position, Rotation};
use crate::terrain::Gnomonic;

/// A place on a tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TilePoint {
    /// Map coordinates, and nodes from the first seen one.
    pub at_m: DVec2,
    pub grid: DVec2,
    /// Turns east, north, up into map axes.
    local: Rotation<crate::geometry::Map, Local>,
}

impl TilePoint {
    /// A place by latitude and longitude; `None` outside the tile.
    pub fn on(header: &Header, latitude_deg: f64, longitude_east_deg: f64) -> Option<Self> {
        let map = gnomonic(&header.map);
        let body = Body {
            name: header.body.name.clone(),
            naif_id: 0,
            equatorial_radius_m: header.body.equatorial_radius_m,
            polar_radius_m: header.body.polar_radius_m,
        };
        let point = Geodetic::from_degrees(latitude_deg, longitude_east_deg, 0.0);
        let at_m = map.lifted_from_body(body.position_from_geodetic(point))?.truncate();
        let grid = (at_m - DVec2::new(header.map.west_m, header.map.south_m)) / header.map.posting_m;
        let last = DVec2::new((header.columns - 1) as f64, (header.rows - 1) as f64);
        let inside = grid.cmpge(DVec2::ZERO).all() && grid.cmple(last).all();
        let local = map.map_from_body * body.local_from_body(point).inverse();
        inside.then_some(Self { at_m, grid, local })
    }

    /// The unit map direction of an azimuth clockwise from north.
    pub fn direction(&self, header: &Header, azimuth_rad: f64) -> DVec2 {
        let (sin, cos) = azimuth_rad.sin_cos();
        let towards = Direction::<Local>::new(DVec3::new(sin, cos, 0.0)).expect("a unit vector");
        gnomonic(&header.map).map_direction(self.at_m, self.local * towards).normalize()
    }

    /// Elevation of the skyline that the tile decodes to.
    pub fn decoded_rad(&self, header: &Header, map: &HorizonMap, azimuth_rad: f64) -> f64 {
        map.horizon(self.grid).evaluate_towards(self.direction(header, azimuth_rad)).0
    }

    /// What of an elevation the tile's band lets matter.
    pub fn relevant_rad(&self, header: &Header, elevation_rad: f64) -> f64 {
        header.settings.relevant_rad(&gnomonic(&header.map), self.at_m, elevation_rad)
    }

    /// The traced skyline, from the heights that the tile was made from.
    pub fn traced(&self, header: &Header, tracer: &Tracer, azimuth_rad: f64) -> Option<Skyline> {
        Some(tracer.skyline(tracer.foot(self.at_m)?, self.direction(header, azimuth_rad)))
    }
}

/// The map that a header describes.
fn gnomonic(header: &MapHeader) -> Gnomonic {
    let axes = [header.right, header.up, header.outward].map(DVec3::from_array);
    let matrix = DMat3::from_cols(axes[0], axes[1], axes[2]).transpose();
    Gnomonic {
        origin: Position::from_m(DVec3::from_array(header.origin_m)),
        map_from_body: Rotation::from_matrix(matrix),
        radius_m: header.radius_m,
    }
}
