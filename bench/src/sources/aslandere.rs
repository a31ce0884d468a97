//! Aslandere et al. (2015): one azimuth for all nodes against a horizon map of 16 (tables 1 and 2).
//!
//! A frame of theirs finds the horizon of every texel anew; one of Max's method reads a map made in advance. Here both are
//! fields of a level under one Sun, on all cores of the host; of the errors the truth is traced at every few nodes.
//!
//! # References
//! Aslandere, Flatken & Gerndt (2015), *A real-time physically based algorithm for hard shadows on dynamic height-fields*;
//! Max (1988), *Horizon mapping: shadows for bump-mapped surfaces*, doi:10.1007/BF01905562.

use std::time::Instant;

use rayon::prelude::*;

use super::{Options, timed};
use crate::horizons::tiles::Scratch;
use crate::scenes::Scene;
use crate::stability::scenes::sun;
use crate::{Error, Table, Value};
use perilune_engine::horizon::decode::Decoder;
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::horizon::{self, Encoding, HorizonMap, Request, Settings};
use perilune_engine::pipeline::Progress;
use perilune_engine::render::RenderError;
use perilune_engine::shadow::skylines::Field;
use perilune_engine::shadow::towards_sun::{Edge, SingleAzimuth, Swept};
use perilune_engine::shadow::{QuantizedLight, SkylineSource, SurfacePoints};
use perilune_engine::terrain::{Surface, Terrain};

/// Nodes a side; frames per second of the method and of 16 azimuths on a Quadro 6000, and seconds before the first.
const PRINTED: [(usize, f64, f64, f64); 3] =
    [(256, 527.0, 1542.0, 0.37), (512, 89.0, 355.0, 2.9), (1024, 12.0, 154.0, 21.93)];
/// Kilobytes of the two.
const PRINTED_KB: [[f64; 2]; 3] = [[64.0, 1024.0], [256.0, 4096.0], [1024.0, 16384.0]];

const AZIMUTH_RAD: f64 = 0.7;
const ELEVATION_DEG: f64 = 6.0;
const STEP_DEG: f64 = 0.15;

/// Tables 1 and 2.
pub fn tables(options: &Options, progress: &dyn Progress) -> Result<Vec<Table>, Error> {
    let mut speed = Table::new(
        "aslandere_1",
        "Aslandere 2015, table 1: all nodes under one Sun (paper: Quadro 6000)",
        &[
            ("nodes", "a side"),
            ("method", ""),
            ("preparation", "s"),
            ("field", "s"),
            ("fields/s", "Hz"),
            ("paper", "Hz"),
            ("paper's preparation", "s"),
            ("time over raw16's", ""),
            ("paper's ratio", ""),
            ("hard shadows wrong", "%"),
        ],
    );
    let mut memory = Table::new(
        "aslandere_2",
        "Aslandere 2015, table 2: memory",
        &[
            ("nodes", "a side"),
            ("method", ""),
            ("ours", "kB"),
            ("paper", "kB"),
            ("over raw16's", ""),
            ("paper's ratio", ""),
        ],
    );
    let sizes = if options.quick { &PRINTED[..2] } else { &PRINTED[..] };
    progress.begin("Aslandere, tables 1 and 2", sizes.len(), "sizes");
    for (done, (&printed, kilobytes)) in sizes.iter().zip(PRINTED_KB).enumerate() {
        speed.rows.extend(speeds(printed, progress)?);
        let nodes = (printed.0 * printed.0) as f64;
        // An elevation and a slope; sixteen half floats.
        let ours = [8.0, Encoding::Raw16.bytes_per_pixel()].map(|bytes| bytes * nodes / 1024.0);
        for (index, method) in ["one azimuth", "raw16"].into_iter().enumerate() {
            let mut row = vec![(printed.0 as f64).into(), method.into()];
            row.extend(
                [ours[index], kilobytes[index], ours[index] / ours[1], kilobytes[index] / kilobytes[1]]
                    .map(Value::from),
            );
            memory.rows.push(row);
        }
        progress.at(done + 1, sizes.len());
    }
    Ok(vec![speed, memory])
}

fn speeds(
    (nodes, paper_hz, paper_raw_hz, paper_s): (usize, f64, f64, f64),
    progress: &dyn Progress,
) -> Result<Vec<Vec<Value>>, Error> {
    let scene = Scene::synthetic(nodes, 1)?;
    let surface = Surface::new(Terrain { body: scene.body.clone(), faces: vec![scene.face.clone()] });
    let light = sun(&scene.face.map, AZIMUTH_RAD, ELEVATION_DEG.to_radians());
    let light = QuantizedLight::new(light.position, light.angular_radius_rad);
    let settings = Settings::default();

    progress.begin(&format!("raw16 of {nodes}²"), 1, "tile");
    let folder = Scratch::new()?;
    let of_sixteen = Settings { azimuths: 16, ..settings };
    let request =
        Request { body: &scene.body, face: &scene.face, level: 0, settings: of_sixteen, encoding: Encoding::Raw16 };
    let start = Instant::now();
    let map = horizon::build(&request, &folder.path, &|_, _| ())?;
    let prepared_s = start.elapsed().as_secs_f64();
    let (raw_s, raw) = timed(3, || decoded(&map, &surface, &light));

    let single = SingleAzimuth { settings, spacing: 1.0, edge: Edge::Level };
    let swept = Swept { settings, step_rad: STEP_DEG.to_radians() };
    let mut rows = Vec::new();
    let mut row = |name: &str, preparation_s: f64, seconds: f64, paper: [f64; 2], field: &Field| {
        let mut row = vec![(nodes as f64).into(), name.into()];
        let [hz, its_s] = paper;
        row.extend(
            [preparation_s, seconds, 1.0 / seconds, hz, its_s, seconds / raw_s, paper_raw_hz / hz].map(Value::from),
        );
        row.push((100.0 * wrong(&scene, &light, field)).into());
        rows.push(row);
    };
    let (single_s, field) = timed(2, || single.field(&surface, 0, 0, &light));
    row("one azimuth", 0.0, single_s, [paper_hz, 0.0], &field.map_err(RenderError::from)?);
    let (swept_s, field) = timed(2, || swept.field(&surface, 0, 0, &light));
    row("one azimuth, swept (ours)", 0.0, swept_s, [f64::NAN; 2], &field.map_err(RenderError::from)?);
    row("raw16", prepared_s, raw_s, [paper_raw_hz, paper_s], &raw);
    Ok(rows)
}

/// Skylines of all nodes towards the light at the map's centre.
fn decoded(map: &HorizonMap, surface: &Surface, light: &QuantizedLight) -> Field {
    let face = &surface.terrain.faces[0];
    let middle = face.levels[0].lifted_node(face.levels[0].columns / 2, face.levels[0].rows / 2);
    let decoder = Decoder::new(map, &[light.from(&face.map, middle).0]);
    let row = |row: usize| decoder.row(row).into_iter().map(|elevation_rad| [elevation_rad, 0.0]).collect::<Vec<_>>();
    (0..map.rows).into_par_iter().flat_map_iter(row).collect()
}

/// Share of nodes, every few looked at, that a field lights and tracing does not, or the other way round.
fn wrong(scene: &Scene, light: &QuantizedLight, field: &Field) -> f64 {
    let points = SurfacePoints::of(&scene.face.levels[0]);
    let tracer = Tracer::new(&scene.face, &Settings::default());
    let looked_at: Vec<usize> = (0..points.count()).step_by(points.count() / 4000 + 1).collect();
    let is_wrong = |&&node: &&usize| {
        let point = points.lifted(node);
        let pointing = light.pointing(&scene.face.map, point);
        let truth_rad = tracer.skyline(point, pointing.towards).elevation_rad;
        (truth_rad < pointing.elevation_rad) != (f64::from(field[node][0]) < pointing.elevation_rad)
    };
    looked_at.par_iter().filter(is_wrong).count() as f64 / looked_at.len() as f64
}
