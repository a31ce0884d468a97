//! The job of Fritsch (2025): 3072 tiles of 256², 360 azimuths, 800 m, the whole of Mars.
//!
//! A march of 150 compute hours there. Here some tiles are made and the rest is extrapolated; each has its margin, which
//! casts shadows and gets no horizons: as far as the top of the relief shows above the datum, `R acos(R/(R + ΔH))`.
//!
//! # References
//! Fritsch et al. (2025), *Fourier-compressed horizon maps*: section on precomputation.

use std::time::Instant;

use glam::DVec2;
use rayon::prelude::*;

use super::tiles::{ENCODINGS, Scratch};
use crate::scenes::Scene;
use crate::{Error, Table, Value};
use perilune_engine::geometry::{Body, Geodetic};
use perilune_engine::horizon::request::Request;
use perilune_engine::horizon::{self, Method, Settings};
use perilune_engine::pipeline::Progress;
use perilune_engine::terrain::synthetic::{self, Parameters};
use perilune_engine::terrain::{Face, Gnomonic, Level};

/// Tiles that are made.
pub const MEASURED: usize = 24;
const TILES: usize = 3072;
const NODES: usize = 256;
const POSTING_M: f64 = 800.0;
const AZIMUTHS: usize = 360;
const THEIR_HOURS: f64 = 150.0;

/// Nodes on each side of a tile: 200 km, from which 5.9 km of relief show.
const MARGIN: usize = 250;

/// Mars' mean radius (MOLA).
const MARS_RADIUS_M: f64 = 3_389_500.0;

/// The table that [`rows`] fill.
pub fn table() -> Table {
    Table::new(
        "fritsch",
        "The job of Fritsch 2025: 3072 tiles of 256², 360 azimuths, 800 m, with margins",
        &[
            ("horizons", ""),
            ("tiles", ""),
            ("margin", "km"),
            ("threads", ""),
            ("a tile", "s"),
            ("whole job", "min"),
            ("samples/s", "M/s"),
            ("theirs over ours", ""),
        ],
    )
}

/// A sphere of Mars' radius.
pub fn mars() -> Body {
    Body { name: "mars".into(), naif_id: 499, equatorial_radius_m: MARS_RADIUS_M, polar_radius_m: MARS_RADIUS_M }
}

/// Time of `tiles` tiles by each method, from heights to files that state their error, as many at a time as there are threads,
/// and of all of them.
pub fn rows(tiles: usize, progress: &dyn Progress) -> Result<Vec<Vec<Value>>, Error> {
    let scenes = scenes(tiles)?;
    let folder = Scratch::new()?;
    let mut rows = Vec::new();
    for (label, method) in [("swept", Method::Sweep), ("exact", Method::Exact)] {
        let settings = Settings { azimuths: AZIMUTHS, method, ..Settings::default() };
        progress.begin(&format!("tiles of Mars, {label}"), tiles, "tiles");
        let start = Instant::now();
        let threads = rayon::current_num_threads();
        for (done, some) in scenes.chunks(threads).enumerate() {
            some.par_iter().try_for_each(|Scene { body, face, .. }| {
                let request = Request { body, face, level: 0, settings, encoding: ENCODINGS[0] };
                horizon::build(&request, &folder.path, &|_, _| ()).map(drop)
            })?;
            progress.at((done + 1) * threads, tiles);
        }
        let tile_s = start.elapsed().as_secs_f64() / tiles as f64;
        let job_s = tile_s * TILES as f64;
        let samples = (TILES * NODES * NODES * AZIMUTHS) as f64;
        let mut row = vec![label.into(), (tiles as f64).into(), (MARGIN as f64 * POSTING_M * 1e-3).into()];
        row.extend(
            [threads as f64, tile_s, job_s / 60.0, samples / job_s * 1e-6, THEIR_HOURS * 3600.0 / job_s]
                .map(Value::from),
        );
        rows.push(row);
    }
    Ok(rows)
}

/// Tiles with their margins, cut from one terrain of Mars' radius with basins of 200 km and 5 km of relief, each on a
/// map about its own centre.
fn scenes(tiles: usize) -> Result<Vec<Scene>, Error> {
    let body = mars();
    let side = NODES + 2 * MARGIN;
    let across = (tiles as f64).sqrt().ceil() as usize;
    let step = NODES / 2;
    let nodes = side + (across - 1) * step;
    let centre = Geodetic::from_degrees(-20.0, 0.0, 0.0);
    let parameters = Parameters {
        largest_m: 200_000.0,
        relief_m: 5000.0,
        centre,
        ..Parameters::highland(nodes, nodes, POSTING_M, 7)
    };
    let heights_m = synthetic::generate(&body, &parameters, &|_, _| ())?.heights_m;
    let map = Gnomonic::about(&body, centre);
    let tile = |index: usize| {
        let (left, low) = (index % across * step, index / across * step);
        let half_m = 0.5 * (side - 1) as f64 * POSTING_M;
        let mut level = Level {
            columns: side,
            rows: side,
            posting_m: POSTING_M,
            west_m: -half_m,
            south_m: -half_m,
            heights_m: Vec::with_capacity(side * side),
            gap: vec![false; side * side],
            margin: MARGIN,
        };
        for row in 0..side {
            for column in 0..side {
                let radius_m = map.radius_m + f64::from(heights_m[(low + row) * nodes + left + column]);
                let at_m: DVec2 = level.node_m(column, row);
                level.heights_m.push(map.lifted_height_m(at_m, radius_m) as f32);
            }
        }
        let face = Face { map: map.clone(), levels: vec![level] };
        Scene { name: format!("Mars {index}"), body: body.clone(), face }
    };
    Ok((0..tiles).map(tile).collect())
}
