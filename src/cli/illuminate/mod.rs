//! `sim illuminate`.

use std::path::PathBuf;
use std::time::Instant;

use hifitime::Duration;
use perilune_engine::dataset;
use perilune_engine::ephemeris::{Almanac, BodyFrame, MOON, parse_epoch, utc_text};
use perilune_engine::geometry::{Body, Geodetic};
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::horizon::{self, Encoding, HorizonMap, Request, Settings};
use perilune_engine::illumination::blocks::Blocks;
use perilune_engine::illumination::geotiff::MappedLevel;
use perilune_engine::illumination::maps::needed_blocks;
use perilune_engine::illumination::place::Summary;
use perilune_engine::illumination::report::{IlluminationReport, PlaceResult};
use perilune_engine::illumination::{self, Lit, Maps, Place, Skylines, Study, Swept, Traced, Track};
use perilune_engine::photometry::{LimbDarkening, SolarDisk, VISIBLE_NM};
use perilune_engine::pipeline::Progress;
use perilune_engine::pipeline::ground::Ground;
use perilune_engine::terrain::{Face, Gnomonic, Level};
use serde_json::json;

use super::bars::Bars;
use super::common::{CacheArgs, Kernels};
use super::horizon::levels;
use super::sun::parse_step;
use super::{Outcome, place, print_line, ranges};
use area::NamedArea;

mod area;
mod results;

/// Map how often the Sun and the Earth are seen: share of the time lit, mean share of the disc, longest night.
///
/// Writes illumination.tif (a band each), a page illumination.html with the same as pictures, JSON and CSV, and a CSV
/// series for each area and place. With areas, only they are mapped.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Elevation models that GDAL reads, the finest first; it is the one that is mapped
    #[arg(required = true, value_name = "DEM")]
    dems: Vec<PathBuf>,
    /// Directory of the results
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// First epoch with its scale, as 2026-01-01T00:00:00Z
    #[arg(long, value_name = "EPOCH")]
    from: String,
    /// The epoch before which the last step lies
    #[arg(long, value_name = "EPOCH")]
    until: String,
    /// Step, as 30min, 1h or 1d
    #[arg(long, default_value = "1h", value_parser = parse_step, allow_hyphen_values = true)]
    step: Duration,
    /// What counts as lit: `any` part of the disc, its `centre`, or a share of its light, as 0.5
    #[arg(long, default_value = "any", value_parser = lit, allow_hyphen_values = true)]
    lit: Lit,
    /// Leave out that the Earth hides the Sun in lunar eclipses
    #[arg(long)]
    no_eclipses: bool,
    /// A circle LAT,LON,RADIUS_M, a polygon 'LAT,LON;LAT,LON;LAT,LON' of great circles, or a file of them (GeoJSON, or
    /// CSV with a corner a line); may be given several times
    #[arg(long, value_name = "AREA", value_parser = area::areas, allow_hyphen_values = true)]
    area: Vec<Vec<NamedArea>>,
    /// A place for which to write a series, in degrees; may be given several times
    #[arg(long, value_name = "LAT,LON", value_parser = place, allow_hyphen_values = true)]
    at: Vec<Geodetic>,
    /// Choose so many best nodes of the map, and trace their skylines
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = ranges::number(0_usize..=10_000, ""), allow_hyphen_values = true)]
    best: usize,
    /// What makes a node good
    #[arg(long, value_enum, default_value_t, requires = "best")]
    by: By,
    /// Least distance between the best nodes, in metres
    #[arg(long, value_name = "M", default_value_t = 500.0, value_parser = ranges::metres, allow_hyphen_values = true, requires = "best")]
    apart: f64,
    /// Height of the observer above the ground, in metres
    #[arg(long, value_name = "M", default_value_t = 0.0, value_parser = ranges::height, allow_hyphen_values = true)]
    observer_height: f64,
    /// Azimuths at which skylines are swept
    #[arg(long, value_name = "N", default_value_t = 360, value_parser = ranges::number(36_usize..=3600, ""), allow_hyphen_values = true)]
    azimuths: usize,
    /// Take skylines from a compressed tile, which is kept for the next time, instead of sweeping them anew: less memory,
    /// larger errors
    #[arg(long, value_name = "NAME")]
    encoding: Option<Encoding>,
    /// Memory that swept skylines may take, in MiB
    #[arg(long, value_name = "MIB", default_value_t = 4096, value_parser = ranges::memory, allow_hyphen_values = true)]
    memory: usize,
    /// Trace the skylines of so many nodes, and tell how far the maps are from them
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = ranges::places, allow_hyphen_values = true)]
    check: usize,
    /// Centre of the map, in degrees [default: the middle of the first DEM]
    #[arg(long, value_name = "LAT,LON", value_parser = place, allow_hyphen_values = true)]
    centre: Option<Geodetic>,
    #[command(flatten)]
    cache: CacheArgs,
    #[command(flatten)]
    kernels: Kernels,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    levels: levels::Args,
}

/// What the best nodes are best in.
#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
enum By {
    /// Mean share of the Sun's disc
    #[default]
    Disc,
    /// Share of the time lit
    Lit,
    /// A short longest night
    Night,
    /// Share of the time with the Earth in sight
    Earth,
}

const EXAMPLES: &str = "\
Examples:
  sim illuminate ridge_10m.tif southcap_240m.tif -o output/ridge --from 2026-01-01Z --until 2027-01-01Z \\
      --at -89.45,222.69 --observer-height 2 --best 5
  sim illuminate ridge_10m.tif southcap_240m.tif -o output/site --from 2026-01-01Z --until 2027-01-01Z \
      --area -89.45,222.69,500 --area sites.geojson --best 3 --by night --apart 200";

/// More steps are a slip of the pen: 100 years at hourly steps have fewer.
const STEPS_AT_MOST: f64 = 1e6;

pub fn run(args: Args) -> Outcome {
    let almanac = args.kernels.almanac()?;
    dataset::check_writable(&args.output)?;
    let bars = Bars::new();
    let ground = args.levels.ground(&args.dems, args.centre, &bars)?;
    let (face, body) = one_map(&ground)?;
    let ends = [parse_epoch(&args.from)?, parse_epoch(&args.until)?];
    let (frame, note) = almanac.body_frame_at(&body.name, None, &ends)?;
    let settings = Settings { azimuths: args.azimuths, observer_height_m: args.observer_height, ..Settings::default() };
    let track = track(&args, &almanac, &frame, &ground)?;
    note.iter().for_each(|note| bars.say(note));
    let disk = SolarDisk::new(LimbDarkening::hestroffer_magnan(VISIBLE_NM)?)?;
    let level = &face.levels[0];

    // Areas and places that lie outside are told before the work.
    let named: Vec<&NamedArea> = args.area.iter().flatten().collect();
    let areas = named.iter().map(|named| nodes(named, &ground)).collect::<Result<Vec<_>, _>>()?;
    let tracer = Tracer::new(face, &settings).with_pyramids(&ground.surface.pyramids[0]);
    let look = PlaceStudy { args: &args, ground: &ground, tracer, track: &track, disk: &disk };
    let mut places = args.at.iter().map(|at| look.at(*at)).collect::<Result<Vec<_>, _>>()?;

    let start = Instant::now();
    let on_progress = |done: usize, total: usize| bars.at(done, total);
    let tile = tile(&args, &ground, settings, &bars)?;
    let skylines = match &tile {
        Some(tile) => Skylines::Decoded(tile),
        None => Skylines::Swept(swept(&args, face, &settings, needed_blocks(level, &areas), &bars)?),
    };
    let swept_s = start.elapsed().as_secs_f64();

    bars.begin("illumination", 0, "strips");
    let start = Instant::now();
    let study = Study { face, level: 0, skylines: &skylines, track: &track, disk: &disk, lit: args.lit, areas: &areas };
    let (maps, all_series) = study.run(&on_progress);
    let seconds = start.elapsed().as_secs_f64();
    places.iter_mut().for_each(|named| named.node = nearest(&face.map, level, body, named.at));
    places.extend(look.best(&maps));
    let check = (args.check > 0).then(|| Traced::of(&study, body, &look.tracer, args.check).check(&maps));
    bars.clear();

    let results = results::of_areas(&named, &areas, all_series, &maps, &track);
    let samples = maps.lit_share.iter().filter(|share| share.is_finite()).count() as f64 * track.steps() as f64;
    let findings = IlluminationReport {
        title: format!("Illumination from {} to {}", args.from, args.until),
        notes: notes(&args, &track, tile.as_ref(), [swept_s, seconds], samples),
        track: &track,
        maps: &maps,
        node_m2: level.posting_m * level.posting_m,
        areas: &results,
        places: &places,
        check,
    };
    let report = findings.report()?;
    results::write_map(&maps, MappedLevel { body, map: &face.map, level }, &args.dems[0], &args.output)?;
    results::write(&args.output, &track, &results, &places)?;
    report.write(&args.output)?;
    if args.json {
        let all = json!({ "report": report.json(), "seconds": seconds, "samples": samples });
        return Ok(print_line(format_args!("{all:#}"))?);
    }
    Ok(print_line(report.text())?)
}

/// The map that is studied, of a sphere.
fn one_map(ground: &Ground) -> Result<(&Face, &Body), String> {
    let [face] = &ground.surface.terrain.faces[..] else {
        return Err("illumination is mapped over one map; pass elevation models without --cube".into());
    };
    let body = &ground.surface.terrain.body;
    if !body.is_sphere() {
        return Err(format!("{} is a spheroid; pass --radius M for the sphere of its map", body.name));
    }
    Ok((face, body))
}

/// The node nearest to a place; `None` where no skylines are sought.
fn nearest(map: &Gnomonic, level: &Level, body: &Body, at: Geodetic) -> Option<usize> {
    let at_m = map.lifted_from_body(body.position_from_geodetic(Geodetic { height_m: 0.0, ..at }))?.truncate();
    let nodes = Blocks::of(level);
    let grid = (level.grid_from_map(at_m) - level.margin as f64).round();
    let inside = grid.x >= 0.0 && grid.y >= 0.0 && grid.x < nodes.columns as f64 && grid.y < nodes.rows as f64;
    inside.then(|| grid.y as usize * nodes.columns + grid.x as usize)
}

/// The nodes of an area; an area without any is a slip.
fn nodes(named: &NamedArea, ground: &Ground) -> Result<Vec<bool>, String> {
    let (face, body) = (&ground.surface.terrain.faces[0], &ground.surface.terrain.body);
    let nodes = named.area.nodes(body, &face.map, &face.levels[0]);
    nodes.filter(|nodes| nodes.contains(&true)).ok_or_else(|| {
        format!(
            "--area {} holds no node of the first elevation model, whose posting is {} m",
            named.name, face.levels[0].posting_m
        )
    })
}

/// The tile to decode, where one is asked for.
fn tile(
    args: &Args,
    ground: &Ground,
    settings: Settings,
    bars: &Bars,
) -> Result<Option<HorizonMap>, Box<dyn std::error::Error>> {
    let Some(encoding) = args.encoding else { return Ok(None) };
    let cache = args.cache.open()?;
    let (face, body) = (&ground.surface.terrain.faces[0], &ground.surface.terrain.body);
    let request = Request { body, face, level: 0, settings, encoding };
    bars.begin("horizons", settings.azimuths, "azimuths");
    let on_progress = |done: usize, total: usize| bars.at(done, total);
    Ok(Some(horizon::open_or_build(&request, &cache.join("horizon"), horizon::Memory::default(), &on_progress)?))
}

/// Skylines swept for the blocks that are needed.
fn swept(
    args: &Args,
    face: &Face,
    settings: &Settings,
    held: Vec<usize>,
    bars: &Bars,
) -> Result<Swept, Box<dyn std::error::Error>> {
    check_memory(args, held.len())?;
    bars.begin("horizons", settings.azimuths, "azimuths");
    let on_progress = |done: usize, total: usize| bars.at(done, total);
    Ok(Swept::new(face, 0, settings, held, &on_progress)?)
}

fn check_memory(args: &Args, blocks: usize) -> Result<(), String> {
    let mib = Swept::bytes(blocks, args.azimuths).div_ceil(1 << 20);
    if mib <= args.memory {
        return Ok(());
    }
    Err(format!(
        "skylines of {blocks} blocks of 1024 nodes at {} azimuths take {mib} MiB, allowed are {} (--memory); pass fewer \
         --azimuths, an --area, a smaller --extent, or an --encoding",
        args.azimuths, args.memory
    ))
}

/// All that places are looked at with.
struct PlaceStudy<'a> {
    args: &'a Args,
    ground: &'a Ground,
    tracer: Tracer<'a>,
    track: &'a Track,
    disk: &'a SolarDisk,
}

impl<'a> PlaceStudy<'a> {
    fn named(&self, name: String, at: Geodetic, node: Option<usize>, place: Place<'a>) -> PlaceResult<'a> {
        let moments = place.moments(self.track, self.disk, self.args.lit);
        let summary = Summary::of(&moments, self.track.step_h());
        PlaceResult { name, at, node, place, moments, summary }
    }

    /// A place that was asked for.
    fn at(&self, at: Geodetic) -> Result<PlaceResult<'a>, String> {
        let name = format!("{:.5},{:.5}", at.latitude_rad.to_degrees(), at.longitude_east_rad.to_degrees());
        let (face, body) = (&self.ground.surface.terrain.faces[0], &self.ground.surface.terrain.body);
        let place = Place::new(body, &face.map, &self.tracer, at)
            .ok_or_else(|| format!("--at {name} lies outside the elevation models"))?;
        Ok(self.named(format!("--at {name}"), at, None, place))
    }

    /// The best nodes of the map.
    fn best(&self, maps: &Maps) -> Vec<PlaceResult<'a>> {
        let (face, body) = (&self.ground.surface.terrain.faces[0], &self.ground.surface.terrain.body);
        let level = &face.levels[0];
        let nights: Vec<f32>;
        let values = match self.args.by {
            By::Disc => &maps.disc_share,
            By::Lit => &maps.lit_share,
            By::Earth => &maps.earth_share,
            By::Night => {
                nights = maps.longest_night_h.iter().map(|hours| -hours).collect();
                &nights
            }
        };
        let chosen = illumination::best_places(values, &face.map, level, self.args.best, self.args.apart);
        let named = |(rank, &node): (usize, &usize)| {
            let [column, row] = [node % maps.columns, node / maps.columns].map(|index| index + level.margin);
            let foot = level.lifted_node(column, row);
            let at = body.geodetic_from_position(face.map.body_from_lifted(foot));
            let place = Place::of_foot(body, &face.map, &self.tracer, foot);
            self.named(format!("best {}", rank + 1), at, Some(node), place)
        };
        chosen.iter().enumerate().map(named).collect()
    }
}

fn lit(text: &str) -> Result<Lit, String> {
    match (text, text.parse::<f64>()) {
        ("any", _) => Ok(Lit::AnyLimb),
        ("centre", _) => Ok(Lit::Centre),
        (_, Ok(share)) if share > 0.0 && share < 1.0 => Ok(Lit::Share(share)),
        _ => Err("want any, centre, or a share between 0 and 1".into()),
    }
}

fn track(
    args: &Args,
    almanac: &Almanac,
    frame: &BodyFrame,
    ground: &Ground,
) -> Result<Track, Box<dyn std::error::Error>> {
    let start = parse_epoch(&args.from)?;
    let steps = ((parse_epoch(&args.until)? - start).to_seconds() / args.step.to_seconds() - 1e-9).ceil();
    if !(1.0..=STEPS_AT_MOST).contains(&steps) {
        let Args { from, until, step, .. } = args;
        return Err(format!(
            "--from {from} --until {until} --step {step} gives {steps} steps; allowed are 1 to {STEPS_AT_MOST}"
        )
        .into());
    }
    let point = frame.body.position_from_geodetic(ground.centre);
    let track = Track::new(almanac, frame, point, start, args.step, steps as usize)?;
    let eclipses = !args.no_eclipses && frame.body.naif_id == MOON;
    Ok(if eclipses { track.with_eclipses(LimbDarkening::hestroffer_magnan(VISIBLE_NM)?) } else { track })
}

fn notes(
    args: &Args,
    track: &Track,
    tile: Option<&HorizonMap>,
    [swept_s, seconds]: [f64; 2],
    samples: f64,
) -> Vec<String> {
    let lit = match args.lit {
        Lit::AnyLimb => "any part of the Sun's disc is seen".to_owned(),
        Lit::Centre => "the Sun's centre is seen".to_owned(),
        Lit::Share(share) => format!("at least {share} of the Sun's light is seen"),
    };
    let skylines = match tile {
        None => format!("Skylines: swept at {} azimuths in {swept_s:.1} s; those of places are traced.", args.azimuths),
        Some(tile) => format!(
            "Skylines: decoded from {}, RMS error {:.3}°, 99 % within {:.3}° of {} traced nodes; those of places are \
             traced.",
            tile.encoding,
            tile.errors.decoded.rms_rad.to_degrees(),
            tile.errors.decoded.p99_rad.to_degrees(),
            tile.errors.pixels
        ),
    };
    vec![
        format!("{} steps of {}, the first at {}.", track.steps(), args.step, utc_text(track.start)),
        format!("Lit: {lit}, {} m above the ground.", args.observer_height),
        match (args.no_eclipses, track.sunlight.iter().filter(|sunlight| **sunlight < 1.0).count()) {
            (true, _) => "Lunar eclipses are left out.".into(),
            (false, steps) => format!("The Earth hides a part of the Sun or all of it at {steps} steps."),
        },
        skylines,
        "Each height stands for a square of the posting: what is smaller shades nothing.".into(),
        format!("{:.0} million node-steps in {seconds:.1} s.", samples / 1e6),
    ]
}
