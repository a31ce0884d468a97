//! Curvature: traced horizons against points in space.
//!
//! Along the great circle of an azimuth points of the ground are placed in space, in `f64`, from their heights above the
//! body's own figure, and their elevations taken with vectors from the observer. No lifted height takes part, no grid,
//! and where the ground is a formula no interpolation:
//!
//! ```text
//! tan ε = (P − O)·u / |(P − O) − ((P − O)·u) u|
//! ```
//!
//! Observers stand on a mast of 500 m, so that no facet of their own decides; terrain counts to 250 km. `u` is the map's
//! vertical, the direction away from its centre of projection. On a spheroid the normal of the ground is another one; by how much
//! at most, within 250 km of the map's centre, stands beside.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::fritsch::mars;
use super::tiles::Scratch;
use crate::scenes::Scene;
use crate::{Error, Table, Value};
use perilune_engine::geometry::{Body, BodyFixed, Geodetic, Position};
use perilune_engine::horizon::Settings;
use perilune_engine::horizon::measure::Sample;
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::raster::{self, Dem, GeoTiff, GeoTiffBand};
use perilune_engine::statistics::Errors;
use perilune_engine::terrain::build::MAX_NODES_PER_SIDE;
use perilune_engine::terrain::{Face, Gnomonic, NestedDem, build_face};

const REACH_M: f64 = 250_000.0;
const MAST_M: f64 = 500.0;
/// Nodes of the analytic terrains: smooth over tens of kilometres.
const POSTING_M: f64 = 1000.0;

/// Heights above a body's figure at places in space.
pub type Ground<'a> = dyn Fn(Position<BodyFixed>) -> f64 + Sync + 'a;

/// The table that [`rows`] fill.
pub fn table() -> Table {
    Table::new(
        "curvature",
        "Curvature to 250 km: traced against points in space",
        &[
            ("ground", ""),
            ("posting", "m"),
            ("samples", ""),
            ("p50", "deg"),
            ("p95", "deg"),
            ("max", "deg"),
            ("allowed p95", "deg"),
            ("vertical off by", "deg"),
        ],
    )
}

/// The Moon and Mars as spheres and Mars as a spheroid, from models in latitude and longitude; and the polar cap, if given.
pub fn rows(cap: Option<&Scene>, pixels: usize, azimuths: usize) -> Result<Vec<Vec<Value>>, Error> {
    let spheroid = Body::mars();
    let cases = [
        ("Moon, equirectangular, 30° N", Body::moon(), 30.0),
        ("Mars' radius, equirectangular, 30° N", mars(), 30.0),
        ("Mars' spheroid, equirectangular, 30° N", spheroid.clone(), 30.0),
        ("Mars' spheroid, equirectangular, 60° N", spheroid, 60.0),
    ];
    let mut rows = Vec::new();
    for (label, body, latitude_deg) in cases {
        let centre = Geodetic::from_degrees(latitude_deg, 20.0, 0.0);
        let face = equirectangular(&body, centre)?;
        let ground = |at: Position<BodyFixed>| waves_m(&body, body.geodetic_from_position(at));
        rows.push(row(label, &body, &face, &ground, pixels, azimuths));
    }
    if let Some(scene) = cap {
        let face =
            Face { map: scene.face.map.clone(), levels: vec![scene.face.levels[scene.face.levels.len() - 1].clone()] };
        let radii_m = radii_m(&face);
        let ground = |at: Position<BodyFixed>| {
            let at_m = face.map.lifted_from_body(at).map_or(DVec2::NAN, |lifted| lifted.truncate());
            let grid = face.levels[0].grid_from_map(at_m);
            face.levels[0].bilinear_of(&radii_m, grid).unwrap_or(f64::NAN)
        };
        rows.push(row("Moon, polar cap", &scene.body, &face, &ground, pixels, azimuths));
    }
    Ok(rows)
}

fn row(label: &str, body: &Body, face: &Face, ground: &Ground, pixels: usize, azimuths: usize) -> Vec<Value> {
    let Errors { count, p50, p95, max, .. } = errors(body, face, ground, pixels, azimuths);
    let posting_m = face.levels[0].posting_m;
    let allowed_rad = posting_m / (2.0 * face.map.radius_m) + 0.01_f64.to_radians();
    let mut row = vec![label.into(), posting_m.into(), (count as f64).into()];
    row.extend([p50, p95, max, allowed_rad, vertical_rad(body, face)].map(|rad| Value::from(rad.to_degrees())));
    row
}

/// Traced elevations minus those in space, at pixels spread evenly over a face of one level, where there is ground as
/// far as it counts.
pub fn errors(body: &Body, face: &Face, ground: &Ground, pixels: usize, azimuths: usize) -> Errors {
    let settings = Settings { azimuths, observer_height_m: MAST_M, search_m: Some(REACH_M), ..Settings::default() };
    let (tracer, level) = (Tracer::new(face, &settings), &face.levels[0]);
    let sample = Sample::of(level, pixels, azimuths).pixels;
    let errors_rad = |[column, row]: &[usize; 2]| {
        let foot = level.lifted_node(column + level.margin, row + level.margin);
        let error_rad = |azimuth| {
            let (direction, at_m) = (settings.direction(azimuth), foot.truncate());
            // Where the ground ends earlier the bare sphere beyond would count.
            level.cell(level.grid_from_map(at_m + REACH_M * direction))?;
            let traced_rad = tracer.skyline(foot, direction).elevation_rad;
            Some(traced_rad - in_space_rad(body, face, ground, at_m, direction))
        };
        (0..azimuths).filter_map(error_rad).collect::<Vec<_>>()
    };
    Errors::of(sample.par_iter().map(errors_rad).collect::<Vec<_>>().into_iter().flatten())
}

/// The skyline of a mast above a map point, from points in space.
fn in_space_rad(body: &Body, face: &Face, ground: &Ground, at_m: DVec2, direction: DVec2) -> f64 {
    let (map, level) = (&face.map, &face.levels[0]);
    let up = map.up(at_m).unit();
    let observer = on_ground(body, map, ground, at_m) + MAST_M * up;
    let step_m = 0.25 * level.posting_m;
    let steps = (REACH_M / step_m) as usize;
    let elevation_rad = |step: usize| {
        let there_m = at_m + direction * (step as f64 * step_m);
        let grid = level.grid_from_map(there_m);
        let inside = level.cell(grid).is_some_and(|(column, row)| !level.cell_has_gap(column, row));
        inside.then(|| {
            let sight = on_ground(body, map, ground, there_m) - observer;
            sight.dot(up).atan2(sight.reject_from(up).length())
        })
    };
    (1..=steps).map_while(elevation_rad).fold(f64::NEG_INFINITY, f64::max)
}

/// The ground on the ray from the centre of projection through a map point, in map axes.
fn on_ground(body: &Body, map: &Gnomonic, ground: &Ground, at_m: DVec2) -> DVec3 {
    let towards = map.up(at_m).unit();
    let mut radius_m = map.radius_m;
    // The ray is all but vertical: a step corrects all but 1e-4 of the error.
    for _ in 0..4 {
        let turned = map.map_from_body.inverse().turn(radius_m * towards);
        let place = Position::<BodyFixed>::from_m(turned + map.origin.vector_m());
        radius_m += ground(place) - body.geodetic_from_position(place).height_m;
    }
    radius_m * towards
}

/// The largest angle between the map's verticals and the normals of the body's figure, within the reach of the centre.
fn vertical_rad(body: &Body, face: &Face) -> f64 {
    let normal_off_rad = |i: u32| {
        let at_m = DVec2::from_angle(f64::from(i) * 0.1) * REACH_M;
        let up = face.map.up(at_m).unit();
        let turned = face.map.map_from_body.inverse().turn(face.map.radius_m * up);
        let place = Position::<BodyFixed>::from_m(turned + face.map.origin.vector_m());
        let normal = face.map.map_from_body.turn(body.up(body.geodetic_from_position(place)).unit());
        normal.cross(up).length().asin()
    };
    (0..63).map(normal_off_rad).fold(0.0, f64::max)
}

/// Heights above the sphere of a level's nodes.
fn radii_m(face: &Face) -> Vec<f32> {
    let (map, level) = (&face.map, &face.levels[0]);
    let radius_m = |node: usize| {
        (map.radius_from_lifted_m(level.lifted_node(node % level.columns, node / level.columns)) - map.radius_m) as f32
    };
    (0..level.heights_m.len()).map(radius_m).collect()
}

/// Smooth hills of 5 km with waves of some 150 km in latitude and longitude.
pub fn waves_m(body: &Body, place: Geodetic) -> f64 {
    let [north_m, east_m] =
        [place.latitude_rad, place.longitude_east_rad].map(|angle_rad| angle_rad * body.equatorial_radius_m);
    let wave = |n: f64, e: f64| (north_m / n + east_m / e).sin();
    1200.0 * wave(21_000.0, 33_000.0) + 900.0 * wave(-37_000.0, 26_000.0) + 400.0 * wave(17_000.0, -19_000.0)
}

/// A face of 520 km from a model in latitude and longitude.
pub fn equirectangular(body: &Body, centre: Geodetic) -> Result<Face, Error> {
    let folder = Scratch::new()?;
    let path = folder.path.join("equirectangular.tif");
    let pixel_deg = (POSTING_M / body.equatorial_radius_m).to_degrees();
    let (rows, columns) = (560, (560.0 / (centre.latitude_rad.abs() + 0.08).cos()) as usize);
    let [west_deg, north_deg] = [(centre.longitude_east_rad, -0.5, columns), (centre.latitude_rad, 0.5, rows)]
        .map(|(middle_rad, side, count)| middle_rad.to_degrees() + side * count as f64 * pixel_deg);
    let height_m = |pixel: usize| {
        let (column, row) = ((pixel % columns) as f64 + 0.5, (pixel / columns) as f64 + 0.5);
        let place = Geodetic::from_degrees(north_deg - row * pixel_deg, west_deg + column * pixel_deg, 0.0);
        waves_m(body, place) as f32
    };
    let values: Vec<f32> = (0..rows * columns).map(height_m).collect();
    let (equatorial_m, polar_m) = (body.equatorial_radius_m, body.polar_radius_m);
    let raster = GeoTiff {
        columns,
        rows,
        bands: vec![GeoTiffBand { name: "height", unit: "m", values: &values }],
        crs: &format!("+proj=longlat +a={equatorial_m} +b={polar_m} +no_defs"),
        geotransform: [west_deg, pixel_deg, 0.0, north_deg, 0.0, -pixel_deg],
    };
    raster.write(&path)?;
    let dem = Dem::open(&path, body, &raster::Options::default())?;
    let nested = NestedDem { dem: &dem, posting_m: Some(POSTING_M), extent_m: Some(520_000.0) };
    Ok(build_face(body, centre, &[nested], MAX_NODES_PER_SIDE)?.0)
}
