//! Speed and error of horizons: swept, compressed, and as shadows.
//!
//! A *sample* is the horizon of one node in one azimuth. Speed is samples over the seconds that a thread spends on a core,
//! so that other programs' work does not count; errors are against [`perilune_engine::horizon::trace`], at pixels spread evenly over
//! the level, in all azimuths. Shadows are decided by the same horizons: a sample is lit where its horizon is below the
//! Sun's centre, and in the penumbra the share of a uniform disc above a level line at the horizon's elevation stands for
//! the irradiance.

pub mod certificates;
pub mod curvature;
pub mod encodings;
pub mod fritsch;
pub mod memory;
pub mod peers;
pub mod profiles;
pub mod shadows;
pub mod speed;
pub mod tiles;

use std::path::PathBuf;

use super::scenes::Scene;
use super::{Error, Machine, Report, Table, Value};
use perilune_engine::horizon::measure::Sample;
use perilune_engine::horizon::{Method, Settings};
use perilune_engine::pipeline::Progress;
use perilune_engine::report::plot::{Axis, Curve, Plot};

pub use profiles::{Profiles, errors, searched, traced};
pub use shadows::{ShadowErrors, shadows};

/// What to measure.
#[derive(Debug, Clone)]
pub struct Options {
    /// The smallest scene only, in fewer azimuths.
    pub quick: bool,
    /// Folders that may hold real models.
    pub data: Vec<PathBuf>,
    pub pixels: usize,
    pub azimuths: usize,
    /// Some of [`PARTS`]; all if none is named.
    pub parts: Vec<String>,
    /// The program whose memory is measured, `sim`; without it that table stays empty.
    pub program: Option<PathBuf>,
}

impl Options {
    pub fn new(quick: bool, data: Vec<PathBuf>) -> Self {
        Self { quick, data, pixels: 512, azimuths: if quick { 120 } else { 360 }, parts: Vec::new(), program: None }
    }

    fn settings(&self) -> Settings {
        Settings { azimuths: self.azimuths, ..Settings::default() }
    }

    fn includes(&self, part: &str) -> bool {
        self.parts.is_empty() || self.parts.iter().any(|named| named == part)
    }

    /// Runs of the clock, and azimuths in each.
    fn clock(&self) -> (usize, usize) {
        if self.quick { (3, 4) } else { (3, 24) }
    }
}

/// What a run consists of: scenes, and tables of their own. A quick run has neither the larger scenes nor Fritsch's job.
pub const PARTS: [&str; 6] = ["cratered", "cratered-2048", "ridge", "curvature", "fritsch", "memory"];

/// Takes a report that is not whole yet.
pub type Publish<'a> = &'a dyn Fn(&Report) -> Result<(), Error>;

/// Columns of the tables of errors and of speed.
const P95: usize = 6;
const MEDIAN: usize = 5;

/// Measures all scenes. What is found is shown to `publish` scene by scene: a run of a quarter of an hour that is stopped
/// leaves what it had.
pub fn run(options: &Options, progress: &dyn Progress, publish: Publish) -> Result<Report, Error> {
    let mut notes = vec![
        format!("{} pixels of each scene, {} azimuths, no limit of the search.", options.pixels, options.azimuths),
        "Samples/s/core: of the time a thread spends on a core. Median of the runs; slowest and fastest beside it."
            .into(),
        "Peak memory of encodings: of the whole benchmark, terrain included, while the tile was built.".into(),
        "Shadows: all azimuths of the same pixels; the penumbra is where truth or trial see a part of the disc.".into(),
    ];
    let mut tables = Tables::new();
    let scenes = scenes(options, &mut notes)?;
    let grass = peers::grass_version();
    notes.push(match &grass {
        Some(version) => format!("Peers: {version}, an azimuth a run, by its own time on the core."),
        None => "GRASS: skipped, no `grass` on the path.".into(),
    });
    for scene in &scenes {
        measure(scene, options, &mut tables, progress)?;
        // GRASS knows one model, not nested ones.
        if grass.is_some() && scene.face.levels.len() == 1 {
            beside_grass(scene, options, &mut tables, &mut notes, progress)?;
        }
        publish(&tables.report(&notes))?;
    }
    if options.includes("curvature") {
        progress.begin("curvature", 1, "table");
        let measured = scenes.into_iter().find(|scene| scene.face.levels.len() > 1);
        let nested = match measured {
            None if !options.quick => Scene::connecting_ridge(&options.data)?,
            there => there,
        };
        let [pixels, azimuths] = if options.quick { [6, 12] } else { [64, 36] };
        tables.curvature.rows = curvature::rows(nested.as_ref(), pixels, azimuths)?;
    }
    if options.includes("fritsch") && !options.quick {
        tables.fritsch.rows = fritsch::rows(fritsch::MEASURED, progress)?;
    }
    if let Some(program) = options.program.as_ref().filter(|_| options.includes("memory")) {
        progress.begin("memory", 1, "table");
        tables.memory.rows = memory::rows(program, if options.quick { 256 } else { 1024 }, options.azimuths)?;
    }
    Ok(tables.report(&notes))
}

/// Measures all encodings on patches of some of [`ENCODED`], of all if none is named. What is found is shown to `publish`
/// scene by scene.
pub fn run_encodings(
    options: &Options,
    only: &[String],
    progress: &dyn Progress,
    publish: Publish,
) -> Result<Report, Error> {
    let side = if options.quick { 96 } else { 128 };
    let mut tables = encodings::Tables::new();
    let mut report = Report {
        name: "encodings",
        title: "Encodings of horizons: bytes and error".into(),
        machine: Machine::here(),
        notes: vec![
            "Truth: the swept horizons before compression; shadows of 180 Suns at each elevation.".into(),
            format!("Patches of {side}² nodes with all terrain around them, {} azimuths.", encodings::AZIMUTHS),
        ],
        plots: Vec::new(),
        tables: Vec::new(),
        figures: Vec::new(),
    };
    let usual = if options.quick && only.is_empty() { &ENCODED[..2] } else { &ENCODED[..] };
    let names = usual.iter().filter(|name| only.is_empty() || only.iter().any(|only| only == *name));
    for name in names {
        let Some(scene) = encoded(name, options)? else {
            report.notes.push(format!("{name}: skipped, its elevation models are in none of the data folders."));
            continue;
        };
        let scene = scene.cut(if FILED.contains(name) { FILED_SIDE } else { side });
        if !options.quick && FILED.contains(name) {
            encodings::measure_files(&scene, &mut tables, progress)?;
        }
        encodings::measure(&scene.cut(side), &mut tables, progress)?;
        encodings::summarise(&mut tables);
        report.plots = vec![encodings::plot(&tables)];
        report.tables = tables.in_order();
        publish(&report)?;
    }
    Ok(report)
}

fn beside_grass(
    scene: &Scene,
    options: &Options,
    tables: &mut Tables,
    notes: &mut Vec<String>,
    progress: &dyn Progress,
) -> Result<(), Error> {
    progress.begin(&format!("r.horizon on {}", scene.name), 1, "scene");
    match peers::rows(scene, &options.settings(), if options.quick { 1 } else { 3 })? {
        Some(rows) => tables.peers.rows.extend(rows),
        None => notes.push(format!("GRASS did not run r.horizon on {}.", scene.name)),
    }
    Ok(())
}

fn scenes(options: &Options, notes: &mut Vec<String>) -> Result<Vec<Scene>, Error> {
    let mut scenes = Vec::new();
    if options.includes("cratered") {
        scenes.push(Scene::synthetic(if options.quick { 512 } else { 1024 }, 1)?);
    }
    if options.includes("cratered-2048") && !options.quick {
        scenes.push(Scene::synthetic(2048, 1)?);
    }
    if options.includes("ridge") && !options.quick {
        match Scene::connecting_ridge(&options.data)? {
            Some(scene) => scenes.push(scene),
            None => {
                notes.push("Connecting ridge: skipped, its elevation models are in none of the data folders.".into());
            }
        }
    }
    Ok(scenes)
}

/// Terrains on which every encoding is tried; the first two are those of a quick run.
pub const ENCODED: [&str; 7] = ["cratered", "fractal", "smooth", "blocks", "peaks", "ridge", "cap"];

/// Those of which files are measured as well, on patches of so many nodes.
const FILED: [&str; 2] = ["cratered", "ridge"];
const FILED_SIDE: usize = 512;

/// One of them; `None` where its models are absent.
fn encoded(name: &str, options: &Options) -> Result<Option<Scene>, Error> {
    Ok(Some(match name {
        "cratered" => Scene::synthetic(1024, 1)?,
        "fractal" => Scene::fractal(512, 2)?,
        "smooth" => Scene::smooth(512, 3),
        "blocks" => Scene::blocks(512, 4),
        "peaks" => Scene::peaks(512, 5),
        "ridge" => return Scene::connecting_ridge(&options.data),
        _ => return Scene::south_cap(&options.data),
    }))
}

struct Tables {
    speed: Table,
    peers: Table,
    errors: Table,
    certificates: Table,
    curvature: Table,
    fritsch: Table,
    memory: Table,
    tiles: Table,
    shadows: Table,
}

impl Tables {
    fn new() -> Self {
        Self {
            speed: speed::table(),
            peers: peers::table(),
            errors: profiles::table(),
            certificates: certificates::table(),
            curvature: curvature::table(),
            fritsch: fritsch::table(),
            memory: memory::table(),
            tiles: tiles::table(),
            shadows: shadows::table(),
        }
    }

    /// What is known so far: the tables that have rows.
    fn report(&self, notes: &[String]) -> Report {
        let Self { speed, peers, errors, certificates, curvature, fritsch, memory, tiles, shadows } = self;
        let all = [speed, peers, errors, certificates, curvature, fritsch, memory, tiles, shadows];
        Report {
            name: "horizon",
            title: "Horizons: speed and error".into(),
            machine: Machine::here(),
            notes: notes.to_vec(),
            plots: std::iter::once(speed_and_error(self)).chain(shadows::plots(shadows)).collect(),
            tables: all.into_iter().filter(|table| !table.rows.is_empty()).cloned().collect(),
            figures: Vec::new(),
        }
    }
}

/// Speed over the 95th percentile of the error, a curve a method and a point a scene.
fn speed_and_error(tables: &Tables) -> Plot {
    let curve = |label: &str| {
        let of = |table: &'_ Table, column: usize| -> Vec<f64> {
            let rows = table.rows.iter().filter(|row| row[1].text() == label);
            rows.map(|row| if let Value::Number(number) = row[column] { number } else { f64::NAN }).collect()
        };
        let points = of(&tables.errors, P95).into_iter().zip(of(&tables.speed, MEDIAN)).map(|(x, y)| [x, y]).collect();
        Curve { name: label.into(), points, joined: false }
    };
    Plot {
        title: "Speed and error of each scene".into(),
        x: Axis::logarithmic("p95 of the error [deg]"),
        y: Axis::logarithmic("M samples/s/core"),
        curves: ["swept", "exact"].map(curve).into(),
    }
}

fn measure(scene: &Scene, options: &Options, tables: &mut Tables, progress: &dyn Progress) -> Result<(), Error> {
    let settings = options.settings();
    let (runs, azimuths) = options.clock();
    progress.begin(&format!("speed on {}", scene.name), 1, "scene");
    tables.speed.rows.extend(speed::rows(scene, &settings, runs, azimuths)?);

    progress.begin(&format!("tracing {}", scene.name), 1, "scene");
    let pixels = Sample::of(&scene.face.levels[0], options.pixels, options.azimuths).pixels;
    let truth = traced(scene, &settings, &pixels);
    let exact = Settings { method: Method::Exact, ..settings };
    let mut trials = vec![
        ("swept".to_owned(), searched(scene, &settings, &pixels)?),
        ("exact".to_owned(), searched(scene, &exact, &pixels)?),
    ];
    tables.certificates.rows.push(certificates::row(scene, &exact, &pixels, &truth));
    for encoding in tiles::ENCODINGS {
        let (profiles, row) = tiles::tile(scene, &settings, encoding, &pixels, progress)?;
        tables.tiles.rows.push(row);
        trials.push((encoding.name().to_owned(), profiles));
    }
    for (label, tried) in &trials {
        tables.errors.rows.push(profiles::row(scene, label, &errors(&truth, tried)));
        tables.shadows.rows.extend(shadows::rows(scene, label, &truth, tried)?);
    }
    Ok(())
}
