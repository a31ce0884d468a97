//! Illumination by each kind of skyline against traced ones, and beside published percentages.
//!
//! Published percentages hang on the model's posting, the height above it, the span of time, and on what counts: each row
//! says its own. `best` is the best node near the place that was named; a place is named to 0.01°, 5 m of longitude
//! there and 300 m of latitude, and on a ridge the share changes by tens of percent within 50 m.
//!
//! Both definitions stand in each row, the mean share of the disc and the time with any part of it: they are 3 to 8 points
//! apart, and Mazarico's mean, which weighs the disc, is not told from ours by the second. What stands within a posting or
//! two decides more: at the node of the connecting ridge the share of the disc is 83.9 % when the search begins at the own
//! facet, 85.4 % from one posting on and 90.0 % from one and a half (240 m, 2020).
//!
//! # References
//! Mazarico et al. (2011), Icarus 211, 1066; Gläser et al. (2014), Icarus 243, 78; Gläser et al. (2018), Planet. Space Sci.
//! 162, 170; Bussey et al. (2010), Icarus 208, 558.

use std::path::{Path, PathBuf};
use std::time::Instant;

use hifitime::Unit;

use crate::horizons::tiles::Scratch;
use crate::scenes::{CAP, RIDGE, Scene};
use crate::{Error, Machine, Report, Table, Value};
use perilune_engine::ephemeris::{Almanac, parse_epoch};
use perilune_engine::geometry::Geodetic;
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::horizon::{self, Encoding, Request, Settings};
use perilune_engine::illumination::area::MinMeanMax;
use perilune_engine::illumination::maps::needed_blocks;
use perilune_engine::illumination::{Area, Lit, Maps, Skylines, Study, Swept, Traced, Track, best_places};
use perilune_engine::photometry::{LimbDarkening, SolarDisk, VISIBLE_NM};
use perilune_engine::pipeline::Progress;
use perilune_engine::terrain::{Face, Level, Pyramid};

/// What to measure.
#[derive(Debug, Clone)]
pub struct Options {
    pub quick: bool,
    /// Folders that may hold `dem/` and `kernels/`.
    pub folders: Vec<PathBuf>,
}

/// A published percentage and how ours is made to stand beside it.
#[derive(Debug, Clone, Copy)]
pub struct Claim {
    place: &'static str,
    source: &'static str,
    percent: f64,
    latitude_deg: f64,
    longitude_deg: f64,
    model: Model,
    height_m: f64,
    span: &'static Span,
}

/// Heights about a place.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Model {
    /// The cap's 240 m.
    Cap,
    /// The ridge's 10 m or a mean of it, in the cap.
    Ridge { posting_m: f64 },
}

#[derive(Debug)]
struct Span {
    text: &'static str,
    from: &'static str,
    days: f64,
    step_h: f64,
}

/// A nodal period of the Moon: what longer means tend to, Gläser's of 19 and 20 years among them.
const NODAL: Span = Span { text: "18.6 years from 2011", from: "2011-01-01T00:00:00Z", days: 6793.5, step_h: 6.0 };
const YEAR_2020: Span = Span { text: "2020", from: "2020-01-01T00:00:00Z", days: 366.0, step_h: 1.0 };

/// Heights above the ground are the papers'; a span is the paper's where the kernels reach.
pub const CLAIMS: [Claim; 7] = [
    ridge("Mazarico 2011, 240 m", 89.0, Model::Cap, 0.0, &NODAL),
    ridge("Mazarico 2011, 240 m", 89.0, Model::Ridge { posting_m: 20.0 }, 0.0, &NODAL),
    ridge("Mazarico 2011, 240 m", 89.0, Model::Ridge { posting_m: 10.0 }, 0.0, &NODAL),
    ridge("Glaeser 2014, 20 m", 92.27, Model::Ridge { posting_m: 20.0 }, 2.0, &NODAL),
    ridge("Glaeser 2014, 20 m", 95.65, Model::Ridge { posting_m: 20.0 }, 10.0, &NODAL),
    ridge("Glaeser 2018, 20 m", 88.0, Model::Ridge { posting_m: 20.0 }, 2.0, &NODAL),
    Claim {
        place: "peak near 88.74 S 124.5 E",
        source: "Bussey 2010, 474 m",
        percent: 86.0,
        latitude_deg: -88.74,
        longitude_deg: 124.5,
        model: Model::Cap,
        height_m: 0.0,
        span: &YEAR_2020,
    },
];

const fn ridge(source: &'static str, percent: f64, model: Model, height_m: f64, span: &'static Span) -> Claim {
    let (latitude_deg, longitude_deg) = (-89.45, 222.69);
    Claim { place: "connecting ridge", source, percent, latitude_deg, longitude_deg, model, height_m, span }
}

/// Around a named place the best node is looked for: the peak that Bussey means stands 2107 m from where he names it.
const WITHIN_M: f64 = 3000.0;
/// Side of the ground whose illumination is held against traced nodes.
const CHECKED_M: f64 = 3200.0;
/// Azimuths swept for a published percentage.
const AZIMUTHS: usize = 720;
/// The ridge's model reaches so far from the place; beyond it lies the cap's.
const RIDGE_M: f64 = 15_000.0;
const CAP_M: f64 = 320_000.0;

/// The files of a longer span than the default kernels have.
pub const KERNELS: [&str; 5] = [
    "de440s_sun_emb_earth_moon_2000_2030.bsp",
    "moon_pa_de440_2000_2030.bpc",
    "moon_fk_de440.epa",
    "pck00011.tpc",
    "gm_de440.tpc",
];

/// Measures both tables; each says why where its files are missing.
pub fn run(options: &Options, progress: &dyn Progress) -> Result<Report, Error> {
    let mut report = Report {
        name: "illumination",
        title: "Illumination: kinds of skylines, and published percentages".into(),
        machine: Machine::here(),
        notes: vec![
            "Errors: maps less traced skylines at the same nodes, of the mean share of the disc and of the time lit \
             (any limb). Times are wall time of all threads."
                .into(),
            format!(
                "Best: the node of largest mean share of the disc within {WITHIN_M} m of the place, {AZIMUTHS} azimuths."
            ),
        ],
        tables: Vec::new(),
        plots: Vec::new(),
        figures: Vec::new(),
    };
    let folder = options.folders.iter().map(|folder| folder.join("kernels")).find(|folder| holds_kernels(folder));
    let Some(folder) = folder else {
        report.notes.push(format!("No folder has kernels/ with {}: nothing was measured.", KERNELS.join(", ")));
        return Ok(report);
    };
    let almanac = Almanac::load(&KERNELS.map(|name| folder.join(name)))?;
    let claims = &CLAIMS[..if options.quick { 1 } else { CLAIMS.len() }];
    for table in [skylines(options, &almanac, progress)?, published(&options.folders, claims, &almanac, progress)?] {
        match table {
            Some(table) => report.tables.push(table),
            None => report.notes.push(format!("No folder has dem/{RIDGE} and dem/{CAP}.")),
        }
    }
    Ok(report)
}

fn holds_kernels(folder: &Path) -> bool {
    KERNELS.iter().all(|name| folder.join(name).is_file())
}

fn centre(latitude_deg: f64, longitude_deg: f64) -> Geodetic {
    Geodetic::from_degrees(latitude_deg, longitude_deg, 0.0)
}

impl Model {
    /// The scene about a place, with skylines for a square of `side_m` about it.
    fn scene(self, folders: &[PathBuf], centre: Geodetic, side_m: f64) -> Result<Option<Scene>, Error> {
        let (name, posting_m) = match self {
            Self::Cap => ("cap 240 m".to_owned(), 240.0),
            Self::Ridge { posting_m } => (format!("ridge {posting_m} m in the cap"), posting_m),
        };
        let cap = (CAP, None, Some(CAP_M));
        let scene = match self {
            Self::Cap => Scene::about(&name, folders, centre, &[cap])?,
            Self::Ridge { posting_m } => {
                Scene::about(&name, folders, centre, &[(RIDGE, Some(posting_m), Some(RIDGE_M)), cap])?
            }
        };
        Ok(scene.map(|scene| scene.cut((side_m / posting_m).ceil() as usize)))
    }
}

fn track(almanac: &Almanac, scene: &Scene, span: &Span) -> Result<Track, Error> {
    let frame = almanac.body_frame("moon", None)?;
    let (middle, _) = scene.face.map.north_up();
    let point = frame.body.position_from_geodetic(middle);
    let steps = (span.days * 24.0 / span.step_h) as usize;
    Ok(Track::new(almanac, &frame, point, parse_epoch(span.from)?, span.step_h * Unit::Hour, steps)?)
}

fn disk() -> Result<SolarDisk, Error> {
    Ok(SolarDisk::new(LimbDarkening::hestroffer_magnan(VISIBLE_NM)?)?)
}

/// What all kinds of skylines are tried on.
struct Trial<'a> {
    face: &'a Face,
    track: &'a Track,
    disk: &'a SolarDisk,
}

impl Trial<'_> {
    fn study<'a>(&'a self, skylines: &'a Skylines<'a>) -> Study<'a> {
        let Self { face, track, disk } = *self;
        Study { face, level: 0, skylines, track, disk, lit: Lit::AnyLimb, areas: &[] }
    }
}

/// Columns of skylines and their units.
const SKYLINE_COLUMNS: [(&str, &str); 9] = [
    ("skylines", ""),
    ("size", "B/node"),
    ("made in", "s"),
    ("steps", "M/s"),
    ("disc, mean error", "%"),
    ("disc RMS", "%"),
    ("disc largest", "%"),
    ("lit RMS", "%"),
    ("lit largest", "%"),
];

/// A row for each kind of skyline.
fn skylines(options: &Options, almanac: &Almanac, progress: &dyn Progress) -> Result<Option<Table>, Error> {
    let model = Model::Ridge { posting_m: 10.0 };
    let Some(scene) = model.scene(&options.folders, centre(-89.45, 222.69), CHECKED_M)? else { return Ok(None) };
    let (track, disk) = (track(almanac, &scene, &YEAR_2020)?, disk()?);
    let (body, face) = (&scene.body, &scene.face);
    let held = needed_blocks(&face.levels[0], &[]);
    let on_progress = |done: usize, total: usize| progress.at(done, total);
    let trial = Trial { face, track: &track, disk: &disk };
    let pyramids: Vec<Pyramid> = face.levels.iter().map(Pyramid::new).collect();
    let settings = Settings::default();
    let tracer = Tracer::new(face, &settings).with_pyramids(&pyramids);

    let (azimuths, encodings): (&[usize], &[Encoding]) = match options.quick {
        true => (&[360], &[Encoding::F16]),
        false => (
            &[180, 360, 720, 1440],
            &[Encoding::F16, Encoding::Fm16, Encoding::W21, Encoding::W16, Encoding::W11, Encoding::Raw16],
        ),
    };
    let nodes = scene.receivers();
    let title =
        format!("Skylines of {}, {nodes} nodes about -89.45, 222.69, in 2020 by hours, at the ground", scene.name);
    let mut table = Table::new("skylines", &title, &SKYLINE_COLUMNS);
    let mut traced = None;
    let mut row = |name: String, bytes: f64, made_s: f64, skylines: &Skylines| {
        let traced = traced.get_or_insert_with(|| {
            Traced::of(&trial.study(skylines), body, &tracer, if options.quick { 12 } else { 64 })
        });
        progress.begin(&name, 1, "strips");
        let start = Instant::now();
        let (maps, _) = trial.study(skylines).run(&on_progress);
        let rate = (nodes * track.steps()) as f64 / start.elapsed().as_secs_f64();
        let check = traced.check(&maps);
        let (disc, lit) = (check.disc_share, check.lit_share);
        let mut row: Vec<Value> = vec![name.as_str().into()];
        row.extend([bytes, made_s, rate * 1e-6].map(Value::from));
        row.extend([disc.mean, disc.rms, disc.max, lit.rms, lit.max].map(|e| Value::from(100.0 * e)));
        table.rows.push(row);
    };
    for &azimuths in azimuths {
        progress.begin(&format!("{azimuths} azimuths"), azimuths, "azimuths");
        let start = Instant::now();
        let swept = Swept::new(face, 0, &Settings { azimuths, ..settings }, held.clone(), &on_progress)?;
        let made_s = start.elapsed().as_secs_f64();
        row(format!("swept, {azimuths}"), 2.0 * azimuths as f64, made_s, &Skylines::Swept(swept));
    }
    for &encoding in encodings {
        let folder = Scratch::new()?;
        let request = Request { body, face, level: 0, settings, encoding };
        progress.begin(&format!("{encoding}"), settings.azimuths, "azimuths");
        let start = Instant::now();
        let tile = horizon::build(&request, &folder.path, &on_progress)?;
        let made_s = start.elapsed().as_secs_f64();
        row(encoding.name().into(), encoding.bytes_per_pixel(), made_s, &Skylines::Decoded(&tile));
    }
    Ok(Some(table))
}

/// A row for each published percentage; `None` where none of the folders has the heights.
pub fn published(
    folders: &[PathBuf],
    claims: &[Claim],
    almanac: &Almanac,
    progress: &dyn Progress,
) -> Result<Option<Table>, Error> {
    let columns = [
        ("place", ""),
        ("source", ""),
        ("published", "%"),
        ("heights", ""),
        ("above ground", "m"),
        ("span", ""),
        ("nearest node, disc", "%"),
        ("mean, disc", "%"),
        ("best, disc", "%"),
        ("best, lit", "%"),
        ("disc less published", "%"),
        ("lit less published", "%"),
        ("longest night", "h"),
        ("best at latitude", "deg"),
        ("longitude", "deg"),
    ];
    let mut table = Table::new("published", "Published percentages", &columns);
    for claim in claims {
        let at = centre(claim.latitude_deg, claim.longitude_deg);
        let Some(scene) = claim.model.scene(folders, at, 2.0 * WITHIN_M)? else { return Ok(None) };
        table.rows.push(claim.row(&scene, at, almanac, progress)?);
    }
    Ok(Some(table))
}

impl Claim {
    fn row(
        &self,
        scene: &Scene,
        at: Geodetic,
        almanac: &Almanac,
        progress: &dyn Progress,
    ) -> Result<Vec<Value>, Error> {
        let (face, level) = (&scene.face, &scene.face.levels[0]);
        let area = Area::Circle { centre: at, radius_m: WITHIN_M };
        // The map is about the place itself.
        let areas = [area.nodes(&scene.body, &face.map, level).unwrap_or_default()];
        let (track, disk) = (track(almanac, scene, self.span)?, disk()?);
        let settings = Settings { azimuths: AZIMUTHS, observer_height_m: self.height_m, ..Settings::default() };
        let on_progress = |done: usize, total: usize| progress.at(done, total);
        progress.begin(&format!("{}, {}", self.place, scene.name), AZIMUTHS, "azimuths");
        let swept = Swept::new(face, 0, &settings, needed_blocks(level, &areas), &on_progress)?;
        let skylines = Skylines::Swept(swept);
        progress.begin(&format!("{}, {}", self.place, self.span.text), 1, "strips");
        let study =
            Study { face, level: 0, skylines: &skylines, track: &track, disk: &disk, lit: Lit::AnyLimb, areas: &areas };
        let (maps, _) = study.run(&on_progress);
        let percent = |plane: &[f32], node: usize| 100.0 * f64::from(plane[node]);
        let best = best_places(&maps.disc_share, &face.map, level, 1, 1.0)[0];
        let [column, row] = [best % maps.columns, best / maps.columns].map(|index| index + level.margin);
        let there = scene.body.geodetic_from_position(face.map.body_from_lifted(level.lifted_node(column, row)));
        let degrees = |angle_rad: f64| Value::from(format!("{:.4}", angle_rad.to_degrees().rem_euclid(360.0)).as_str());
        Ok(vec![
            self.place.into(),
            self.source.into(),
            self.percent.into(),
            scene.name.as_str().into(),
            self.height_m.into(),
            self.span.text.into(),
            percent(&maps.disc_share, nearest(&maps, level)).into(),
            (100.0 * MinMeanMax::of(&maps.disc_share, &areas[0]).mean).into(),
            percent(&maps.disc_share, best).into(),
            percent(&maps.lit_share, best).into(),
            (percent(&maps.disc_share, best) - self.percent).into(),
            (percent(&maps.lit_share, best) - self.percent).into(),
            f64::from(maps.longest_night_h[best]).into(),
            Value::from(format!("{:.4}", there.latitude_rad.to_degrees()).as_str()),
            degrees(there.longitude_east_rad),
        ])
    }
}

/// The node nearest to the map's centre.
fn nearest(maps: &Maps, level: &Level) -> usize {
    let grid = level.grid_from_map(glam::DVec2::ZERO) - level.margin as f64;
    let index = |at: f64, nodes: usize| (at.round().max(0.0) as usize).min(nodes - 1);
    index(grid.y, maps.rows) * maps.columns + index(grid.x, maps.columns)
}
