//! A globe's tiles against traces over the full resolution.
//!
//! At a node of a finest tile all azimuths are traced twice: over the levels that the tile was made from, and over ground
//! that is at the tile's own posting out to `FULL_NODES` nodes beyond the tile (all that can be seen of the Moon down to a
//! posting of 1.4 km). The one against the other is what coarse levels did; the decoded tile against the latter is all of
//! its error.
//!
//! Places: poles, the cube's corners and the middles of its edges, the antimeridian, and random ones evenly over the sphere.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::Globe;
use crate::geometry::Position;
use crate::horizon::ErrorStatistics;
use crate::horizon::trace::Tracer;
use crate::pipeline::{Error, Progress};
use crate::terrain::quadtree::TileId;
use crate::terrain::{Pyramid, build_tile};

/// Nodes beyond a tile at its own posting that count as the full resolution.
const FULL_NODES: usize = 512;
/// Draws for each place that is wanted, where few of the tiles are there.
const DRAWS: usize = 2000;

/// What the places have shown, over all azimuths.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Checks {
    pub places: usize,
    /// Traced over the tile's own levels, against the full resolution.
    pub coarsening: ErrorStatistics,
    /// Decoded from the tile, against the full resolution.
    pub decoded: ErrorStatistics,
}

/// Compares at the special places and at `random` others, as far as their tiles are there.
pub fn check(globe: &Globe, random: usize, progress: &dyn Progress) -> Result<Checks, Error> {
    let there = |(tile, _): &(TileId, DVec2)| globe.path(*tile).is_file();
    let special = special_places().into_iter().map(|place| node_at(globe, place)).filter(there);
    let drawn = random_places().take(DRAWS * random).map(|place| node_at(globe, place)).filter(there).take(random);
    let mut nodes: Vec<_> = special.chain(drawn).collect();
    nodes.sort_by_key(|(tile, node)| (*tile, node.x as usize, node.y as usize));
    nodes.dedup();
    progress.begin("checking places", nodes.len(), "places");
    let (mut coarsening_rad, mut decoded_rad) = (Vec::new(), Vec::new());
    let mut places = 0;
    for of_tile in nodes.chunk_by(|a, b| a.0 == b.0) {
        for (coarsening, decoded) in compare(globe, of_tile[0].0, of_tile)? {
            coarsening_rad.push(coarsening);
            decoded_rad.push(decoded);
        }
        places += of_tile.len();
        progress.at(places, nodes.len());
    }
    Ok(Checks { places, coarsening: ErrorStatistics::of(coarsening_rad), decoded: ErrorStatistics::of(decoded_rad) })
}

/// Signed errors in radians at all azimuths of nodes of one tile.
fn compare(globe: &Globe, tile: TileId, nodes: &[(TileId, DVec2)]) -> Result<Vec<(f64, f64)>, Error> {
    let Some((_, map)) = globe.read(tile) else { return Ok(Vec::new()) };
    let settings = &globe.plan.settings;
    let own = build_tile(&globe.tree, tile, &globe.dem, globe.plan.margin)?;
    let full = build_tile(&globe.tree, tile, &globe.dem, FULL_NODES.max(globe.plan.margin))?;
    let pyramids = [&own, &full].map(|face| face.levels.iter().map(Pyramid::new).collect::<Vec<_>>());
    let own_tracer = Tracer::new(&own, settings).with_pyramids(&pyramids[0]);
    let full_tracer = Tracer::new(&full, settings).with_pyramids(&pyramids[1]);
    let errors = |(_, node): &(TileId, DVec2)| {
        let level = &own.levels[0];
        let foot = level.lifted_node(node.x as usize + level.margin, node.y as usize + level.margin);
        let series = map.horizon(*node);
        let at = |azimuth: usize| {
            let direction = settings.direction(azimuth);
            let full_rad = full_tracer.skyline(foot, direction).elevation_rad;
            let own_rad = own_tracer.skyline(foot, direction).elevation_rad;
            (own_rad - full_rad, series.evaluate_towards(direction).0 - full_rad)
        };
        (0..settings.azimuths).map(at).collect::<Vec<_>>()
    };
    Ok(nodes.par_iter().map(errors).collect::<Vec<_>>().concat())
}

fn node_at(globe: &Globe, place: DVec3) -> (TileId, DVec2) {
    let point = Position::from_m(place * globe.tree.body.equatorial_radius_m);
    let (tile, node) = globe.tree.find(globe.tree.levels - 1, point);
    (tile, node.round())
}

fn special_places() -> Vec<DVec3> {
    let mut places = vec![DVec3::Z, -DVec3::Z];
    // Corners and middles of edges of the cube.
    for i in 0..27 {
        let corner = DVec3::new(f64::from(i % 3), f64::from(i / 3 % 3), f64::from(i / 9)) - 1.0;
        if corner.length_squared() > 1.5 {
            places.push(corner.normalize());
        }
    }
    for latitude_deg in [-75.0_f64, -50.0, -25.0, 0.0, 25.0, 50.0, 75.0] {
        let (sin, cos) = latitude_deg.to_radians().sin_cos();
        places.push(DVec3::new(-cos, 0.0, sin));
    }
    places
}

/// Evenly over the sphere, the same ones each time.
fn random_places() -> impl Iterator<Item = DVec3> {
    let mut numbers = ChaCha8Rng::seed_from_u64(1);
    std::iter::repeat_with(move || {
        let (z, longitude_rad) = (numbers.random_range(-1.0..1.0_f64), numbers.random_range(0.0..TAU));
        let (sin, cos) = longitude_rad.sin_cos();
        ((1.0 - z * z).sqrt() * DVec3::new(cos, sin, 0.0)).with_z(z)
    })
}
