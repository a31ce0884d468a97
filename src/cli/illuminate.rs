//! `sim illuminate`.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use hifitime::Duration;
use perilune::ephemeris::{Almanac, BodyFrame, default_kernel_folder, parse_epoch, utc_text};
use perilune::evaluate::illumination::{Findings, Named};
use perilune::geometry::Geodetic;
use perilune::horizon::trace::Tracer;
use perilune::horizon::{self, Encoding, Request, Settings};
use perilune::illumination::place::{Moment, Summary};
use perilune::illumination::{self, Lit, Place, Track};
use perilune::photometry::{LimbDarkening, SolarDisk};
use perilune::pipeline::Progress;
use perilune::pipeline::ground::Ground;
use serde_json::json;

use super::bars::Bars;
use super::horizon::levels;
use super::sun::parse_step;
use super::{Outcome, place, say};

/// Map how often the Sun and the Earth are seen: share of the time lit, mean share of the disc, longest night.
///
/// Writes illumination.tif (a band each), a page illumination.html with the same as pictures, JSON and CSV, and a CSV
/// series for each place.
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
    #[arg(long, default_value = "1h", value_parser = parse_step)]
    step: Duration,
    /// What counts as lit: `any` part of the disc, its `centre`, or a share of its light, as 0.5
    #[arg(long, default_value = "any", value_parser = lit)]
    lit: Lit,
    /// A place for which to write a series, in degrees; may be given several times
    #[arg(long, value_name = "LAT,LON", value_parser = place, allow_hyphen_values = true)]
    at: Vec<Geodetic>,
    /// Height of the observer above the ground, in metres
    #[arg(long, value_name = "M", default_value_t = 0.0)]
    observer_height: f64,
    /// Centre of the map, in degrees [default: the middle of the first DEM]
    #[arg(long, value_name = "LAT,LON", value_parser = place, allow_hyphen_values = true)]
    centre: Option<Geodetic>,
    /// Directory in which horizon tiles are kept for the next time
    #[arg(long, value_name = "DIR", default_value = "output/cache")]
    cache: PathBuf,
    /// Kernel to load instead of the default ones; may be given several times
    #[arg(long = "kernel", value_name = "FILE")]
    kernels: Vec<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    levels: levels::Args,
}

const EXAMPLES: &str = "\
Example:
  sim illuminate ridge_10m.tif southcap_240m.tif -o output/ridge --from 2026-01-01Z --until 2027-01-01Z \\
      --at -89.45,222.69 --observer-height 2";

/// The Moon's horizons turn sharply against a Sun that stays within 2° of them.
const ENCODING: Encoding = Encoding::F16;

/// The visible light that limb darkening is taken for.
const WAVELENGTH_NM: f64 = 550.0;

/// More steps are a slip of the pen: 100 years at hourly steps have fewer.
const STEPS_AT_MOST: f64 = 1e6;

pub fn run(args: Args) -> Outcome {
    let almanac = match args.kernels[..] {
        [] => Almanac::default_kernels(&default_kernel_folder())?,
        _ => Almanac::load(&args.kernels)?,
    };
    fs::create_dir_all(&args.output).map_err(|error| cannot_write(&args.output, &error))?;
    let bars = Bars::new();
    let ground = args.levels.ground(&args.dems, args.centre, &bars)?;
    let [face] = &ground.surface.terrain.faces[..] else {
        return Err("illumination is mapped over one map; pass elevation models without --cube".into());
    };
    let body = &ground.surface.terrain.body;
    if !body.is_sphere() {
        return Err(format!("{} is a spheroid; pass --radius M for the sphere of its map", body.name).into());
    }
    let frame = BodyFrame { body: body.clone(), ..almanac.body_frame(&body.name.to_lowercase(), None)? };
    let track = track(&args, &almanac, &frame, &ground)?;
    let settings = Settings { observer_height_m: args.observer_height, ..Settings::default() };
    let disk = SolarDisk::new(LimbDarkening::hestroffer_magnan(WAVELENGTH_NM)?)?;
    // Places that lie outside are told before the work.
    let places = places(&args, &ground, &settings, &track, &disk)?;

    let request = Request { body, face, level: 0, settings, encoding: ENCODING };
    bars.begin("horizons", settings.azimuths, "azimuths");
    let heard = |done: usize, total: usize| bars.at(done, total);
    let horizons = horizon::open_or_build(&request, &args.cache.join("horizon"), &heard)?;
    bars.begin("illumination", 0, "strips");
    let start = Instant::now();
    let maps = illumination::maps(face, 0, &horizons, &track, &disk, args.lit, &heard);
    let seconds = start.elapsed().as_secs_f64();
    bars.clear();

    let level = &face.levels[0];
    maps.write(&face.map, level, &args.output.join("illumination.tif"))?;
    for (index, named) in places.iter().enumerate() {
        let path = args.output.join(format!("place_{}.csv", index + 1));
        fs::write(&path, csv(&track, &named.moments)).map_err(|error| cannot_write(&path, &error))?;
    }
    let samples = (maps.columns * maps.rows) as f64 * track.steps() as f64;
    let findings = Findings {
        title: format!("Illumination from {} to {}", args.from, args.until),
        notes: notes(&args, &track, &horizons.errors, seconds, samples),
        maps: &maps,
        node_m2: level.posting_m * level.posting_m,
        places: &places,
    };
    let report = findings.report()?;
    report.write(&args.output)?;
    if args.json {
        let report = report.json();
        return Ok(say(format_args!("{:#}", json!({ "report": report, "seconds": seconds, "samples": samples })))?);
    }
    Ok(say(report.text())?)
}

fn cannot_write(path: &Path, error: &std::io::Error) -> String {
    format!("cannot write {}: {error}", path.display())
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
    Ok(Track::new(almanac, frame, point, start, args.step, steps as usize)?)
}

fn places<'a>(
    args: &Args,
    ground: &'a Ground,
    settings: &Settings,
    track: &Track,
    disk: &SolarDisk,
) -> Result<Vec<Named<'a>>, String> {
    let (face, body) = (&ground.surface.terrain.faces[0], &ground.surface.terrain.body);
    let tracer = Tracer::new(face, settings).with_pyramids(&ground.surface.pyramids[0]);
    let named = |at: &Geodetic| {
        let name = format!("{:.5},{:.5}", at.latitude_rad.to_degrees(), at.longitude_east_rad.to_degrees());
        let place = Place::new(body, &face.map, &tracer, *at)
            .ok_or_else(|| format!("--at {name} lies outside the elevation models"))?;
        let moments = place.moments(track, disk, args.lit);
        let summary = Summary::of(&moments, track.step_h());
        Ok(Named { name, place, moments, summary })
    };
    args.at.iter().map(named).collect()
}

fn notes(args: &Args, track: &Track, errors: &horizon::TileErrors, seconds: f64, samples: f64) -> Vec<String> {
    let lit = match args.lit {
        Lit::AnyLimb => "any part of the Sun's disc is seen".to_owned(),
        Lit::Centre => "the Sun's centre is seen".to_owned(),
        Lit::Share(share) => format!("at least {share} of the Sun's light is seen"),
    };
    vec![
        format!("{} steps of {}, the first at {}.", track.steps(), args.step, utc_text(track.start)),
        format!("Lit: {lit}, {} m above the ground.", args.observer_height),
        format!(
            "Horizons: decoded from 16 coefficients, RMS error {:.3}°, 99 % within {:.3}° of {} traced nodes; those \
             of places are traced.",
            errors.decoded.rms_rad.to_degrees(),
            errors.decoded.p99_rad.to_degrees(),
            errors.pixels
        ),
        "Each height stands for a square of the posting: what is smaller shades nothing.".into(),
        format!("{:.0} million node-steps in {seconds:.1} s.", samples / 1e6),
    ]
}

fn csv(track: &Track, moments: &[Moment]) -> String {
    let header = "epoch_utc,sun_azimuth_deg,sun_elevation_deg,skyline_deg,disc_share,lit,earth_azimuth_deg,\
                  earth_elevation_deg,earth_seen\n";
    moments.iter().enumerate().fold(header.to_owned(), |text, (index, moment)| {
        let deg = f64::to_degrees;
        text + &format!(
            "{},{:.5},{:.5},{:.5},{:.4},{},{:.5},{:.5},{}\n",
            utc_text(track.epoch(index)),
            deg(moment.sun_azimuth_rad),
            deg(moment.sun_elevation_rad),
            deg(moment.skyline_rad),
            moment.share,
            u8::from(moment.lit),
            deg(moment.earth_azimuth_rad),
            deg(moment.earth_elevation_rad),
            u8::from(moment.earth_seen),
        )
    })
}
