//! `sim sun`.

use hifitime::{Duration, Epoch, Unit};
use perilune_engine::ephemeris::{
    Almanac, BodyFrame, Horizontal, MOON, Source, earth, horizontal, parse_epoch, sun, utc_text,
};
use perilune_engine::geometry::{BodyFixed, Direction, Geodetic, Position};
use perilune_engine::photometry::{LimbDarkening, VISIBLE_NM};
use perilune_engine::pipeline::lights::sun_left_by_earth;
use perilune_engine::quantity::{ASTRONOMICAL_UNIT_M, TOTAL_SOLAR_IRRADIANCE_W_M2};
use serde_json::json;

use super::common::Kernels;
use super::{Outcome, print_line};

/// Where the Sun and the Earth stand in the sky of a place.
///
/// Apparent directions, without refraction: azimuth clockwise from north, elevation above the local horizontal. On the
/// Moon the irradiance is what the Earth leaves of the Sun's light in an eclipse. One epoch also tells the points of the
/// body that have the Sun and the Earth in the zenith, and the phase; `--json` and `--csv` have them for every epoch.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Body the place lies on
    #[arg(long, default_value = "moon")]
    body: String,
    /// Place as LATITUDE,LONGITUDE in degrees (longitude east), optionally with ,HEIGHT in metres
    #[arg(long, allow_hyphen_values = true, value_parser = parse_place, value_name = "LAT,LON[,M]")]
    at: Geodetic,
    /// Epoch with its scale, as 2026-09-08T00:00:00Z or "2026-09-08T00:00:00 TDB"
    #[arg(long)]
    epoch: String,
    /// Last epoch of a series
    #[arg(long, requires = "step")]
    until: Option<String>,
    /// Step of a series, as 30min, 1h or 12.5s
    #[arg(long, requires = "until", value_parser = parse_step)]
    step: Option<Duration>,
    #[command(flatten)]
    kernels: Kernels,
    /// Body-fixed frame, as MOON_ME_DE421; by default the best that the kernels have
    #[arg(long)]
    frame: Option<String>,
    /// Comma-separated values with a header
    #[arg(long, conflicts_with = "json")]
    csv: bool,
    /// One JSON object a line, one line an epoch
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  sim sun --at -89.67,129.78 --epoch 2026-09-08T00:00:00Z
  sim sun --at -89.67,129.78 --epoch 2026-09-08Z --until 2026-10-08Z --step 1h --csv
  sim sun --body mars --at -4.59,137.44 --epoch 2026-09-08Z";

/// One line of output.
struct Row {
    epoch: Epoch,
    sun: Source,
    sun_at: Horizontal,
    earth: Source,
    earth_at: Horizontal,
    /// Share of the Sun's light that the Earth leaves.
    sunlight: f64,
    sub_solar: Geodetic,
    sub_earth: Geodetic,
    /// Between the directions from the body's centre to the Sun and to the Earth.
    phase_rad: f64,
}

pub fn run(args: Args) -> Outcome {
    let almanac = args.kernels.almanac()?;
    let epochs = epochs(&args)?;
    let ends = [epochs[0], epochs[epochs.len() - 1]];
    let (frame, note) = almanac.body_frame_at(&args.body, args.frame.as_deref(), &ends)?;
    let point = frame.body.position_from_geodetic(args.at);
    let rows: Vec<Row> =
        epochs.into_iter().map(|epoch| Row::at(&almanac, &frame, args.at, point, epoch)).collect::<Result<_, _>>()?;
    if let Some(note) = note {
        eprintln!("{note}");
    }
    let alone = rows.len() == 1;
    if args.csv {
        print_line(COLUMNS.join(","))?;
    } else if !args.json {
        print_line(format_args!("{} in {}, seen from {}", args.body, frame.frame_name, place_text(args.at)))?;
        print_line(table_header())?;
    }
    for row in rows {
        if args.json {
            print_line(row.as_json(&frame))?;
        } else if args.csv {
            print_line(row.as_csv())?;
        } else {
            print_line(row.as_table_line())?;
            if alone {
                print_line(row.as_notes(&args.body))?;
            }
        }
    }
    Ok(())
}

/// The epochs asked for, the last one included where a step meets it.
fn epochs(args: &Args) -> Result<Vec<Epoch>, Box<dyn std::error::Error>> {
    /// A longer series is a slip of the pen.
    const EPOCHS_AT_MOST: f64 = 1e6;
    let first = parse_epoch(&args.epoch)?;
    let (Some(until), Some(step)) = (&args.until, args.step) else { return Ok(vec![first]) };
    let span_s = (parse_epoch(until)? - first).to_seconds();
    let steps = span_s / step.to_seconds();
    if !(0.0..EPOCHS_AT_MOST).contains(&steps) {
        return Err(format!(
            "--until {until} --step {step} gives {steps:.0} steps; allowed are 0 to {EPOCHS_AT_MOST:.0}"
        )
        .into());
    }
    // A nanosecond of grace keeps the last epoch against rounding.
    let count = (steps + 1e-9).floor() as i64 + 1;
    Ok((0..count).map(|i| first + step * i).collect())
}

fn parse_place(text: &str) -> Result<Geodetic, String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse().map_err(|_| format!("`{part}` is not a number")))
        .collect::<Result<_, _>>()?;
    let (latitude_deg, longitude_deg, height_m) = match numbers[..] {
        [latitude, longitude] => (latitude, longitude, 0.0),
        [latitude, longitude, height] => (latitude, longitude, height),
        _ => return Err("write it as LATITUDE,LONGITUDE or LATITUDE,LONGITUDE,HEIGHT".into()),
    };
    if !(-90.0..=90.0).contains(&latitude_deg) {
        return Err(format!("latitude {latitude_deg} is outside [-90, 90] degrees"));
    }
    if !(-360.0..=360.0).contains(&longitude_deg) {
        return Err(format!("longitude {longitude_deg} is outside [-360, 360] degrees"));
    }
    if !height_m.is_finite() {
        return Err(format!("height {height_m} is not finite"));
    }
    Ok(Geodetic::from_degrees(latitude_deg, longitude_deg, height_m))
}

pub fn parse_step(text: &str) -> Result<Duration, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match text[digits.len()..].trim() {
        "s" | "" => Unit::Second,
        "min" => Unit::Minute,
        "h" => Unit::Hour,
        "d" => Unit::Day,
        other => return Err(format!("unit `{other}` is unknown; allowed are s, min, h and d")),
    };
    match digits.trim().parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number * unit),
        _ => Err(format!("`{digits}` is not a positive number")),
    }
}

fn place_text(at: Geodetic) -> String {
    format!("{:.6}°, {:.6}° E, {} m", at.latitude_rad.to_degrees(), at.longitude_east_rad.to_degrees(), at.height_m)
}

const COLUMNS: [&str; 16] = [
    "epoch_utc",
    "sun_azimuth_deg",
    "sun_elevation_deg",
    "sun_angular_diameter_arcsec",
    "sun_range_au",
    "sun_irradiance_w_m2",
    "earth_azimuth_deg",
    "earth_elevation_deg",
    "earth_range_km",
    "earth_angular_diameter_arcsec",
    "sunlight",
    "sub_solar_latitude_deg",
    "sub_solar_longitude_deg",
    "sub_earth_latitude_deg",
    "sub_earth_longitude_deg",
    "phase_deg",
];

fn table_header() -> String {
    format!(
        "{:<24}{:>12}{:>11}{:>12}{:>11}{:>10}{:>15}{:>11}{:>15}\n{:<24}{:>12}{:>11}{:>12}{:>11}{:>10}{:>15}{:>11}{:>15}",
        "epoch",
        "Sun azimuth",
        "elevation",
        "diameter",
        "range",
        "irrad.",
        "Earth azimuth",
        "elevation",
        "range",
        "UTC",
        "deg",
        "deg",
        "arcsec",
        "au",
        "W/m²",
        "deg",
        "deg",
        "km"
    )
}

impl Row {
    fn at(
        almanac: &Almanac,
        frame: &BodyFrame,
        at: Geodetic,
        point: Position<BodyFixed>,
        epoch: Epoch,
    ) -> Result<Self, Box<dyn std::error::Error>> {
        let centre = Position::from_m(glam::DVec3::ZERO);
        let [from_centre_sun, from_centre_earth] =
            [sun(almanac, frame, centre, epoch)?, earth(almanac, frame, centre, epoch)?].map(|seen| seen.direction);
        let (sun, earth) = (sun(almanac, frame, point, epoch)?, earth(almanac, frame, point, epoch)?);
        let sunlight = match frame.body.naif_id {
            MOON => sun_left_by_earth(LimbDarkening::hestroffer_magnan(VISIBLE_NM)?, &sun, &earth),
            _ => 1.0,
        };
        Ok(Self {
            epoch,
            sun,
            sun_at: horizontal(&frame.body, at, sun.direction),
            earth,
            earth_at: horizontal(&frame.body, at, earth.direction),
            sunlight,
            sub_solar: beneath(frame, from_centre_sun),
            sub_earth: beneath(frame, from_centre_earth),
            phase_rad: from_centre_sun.angle_to(from_centre_earth),
        })
    }

    /// The numbers in the order and units of [`COLUMNS`].
    fn numbers(&self) -> [f64; 15] {
        let [sub_solar, sub_earth] = [self.sub_solar, self.sub_earth]
            .map(|at| [at.latitude_rad.to_degrees(), at.longitude_east_rad.to_degrees().rem_euclid(360.0)]);
        [
            self.sun_at.azimuth_rad.to_degrees(),
            self.sun_at.elevation_rad.to_degrees(),
            2.0 * self.sun.angular_radius_rad.to_degrees() * 3600.0,
            self.sun.distance_m / ASTRONOMICAL_UNIT_M,
            self.sunlight * self.sun.irradiance_w_m2(TOTAL_SOLAR_IRRADIANCE_W_M2),
            self.earth_at.azimuth_rad.to_degrees(),
            self.earth_at.elevation_rad.to_degrees(),
            self.earth.distance_m / 1000.0,
            2.0 * self.earth.angular_radius_rad.to_degrees() * 3600.0,
            self.sunlight,
            sub_solar[0],
            sub_solar[1],
            sub_earth[0],
            sub_earth[1],
            self.phase_rad.to_degrees(),
        ]
    }

    fn as_json(&self, frame: &BodyFrame) -> serde_json::Value {
        let mut object = serde_json::Map::from_iter([
            ("epoch_utc".to_owned(), json!(utc_text(self.epoch))),
            ("frame".to_owned(), json!(frame.frame_name)),
        ]);
        object.extend(COLUMNS[1..].iter().zip(self.numbers()).map(|(key, number)| ((*key).to_owned(), json!(number))));
        object.into()
    }

    fn as_csv(&self) -> String {
        let [az, el, diameter, au, irradiance, earth_az, earth_el, km, earth_diameter, sunlight, below @ ..] =
            self.numbers();
        let below = below.map(|angle_deg| format!("{angle_deg:.6}")).join(",");
        let epoch = utc_text(self.epoch);
        format!(
            "{epoch},{az:.6},{el:.6},{diameter:.3},{au:.11},{irradiance:.4},{earth_az:.6},{earth_el:.6},{km:.3},\
             {earth_diameter:.3},{sunlight:.6},{below}"
        )
    }

    fn as_table_line(&self) -> String {
        let [az, el, diameter, au, irradiance, earth_az, earth_el, km, ..] = self.numbers();
        let epoch = utc_text(self.epoch);
        format!(
            "{epoch:<24}{az:>12.5}{el:>11.5}{diameter:>12.3}{au:>11.7}{irradiance:>10.3}{earth_az:>15.5}{earth_el:>11.5}{km:>15.3}"
        )
    }

    fn as_notes(&self, body: &str) -> String {
        let [.., earth_diameter, sunlight, sun_latitude, sun_longitude, earth_latitude, earth_longitude, phase] =
            self.numbers();
        let eclipse = match sunlight {
            share if share < 1.0 => format!("\nEclipse: the Earth leaves {:.4} of the Sun's light.", share),
            _ => String::new(),
        };
        format!(
            "Sun in the zenith at {sun_latitude:.4}°, {sun_longitude:.4}° E; Earth at {earth_latitude:.4}°, \
             {earth_longitude:.4}° E, {earth_diameter:.1} arcsec wide; phase angle at the {body} {phase:.3}°.{eclipse}"
        )
    }
}

/// The point of a body's spheroid that has a direction in its zenith.
fn beneath(frame: &BodyFrame, towards: Direction<BodyFixed>) -> Geodetic {
    let body = &frame.body;
    // The spheroid's normal is (x/a², y/a², z/c²): the point whose normal is the direction.
    let (a, c) = (body.equatorial_radius_m, body.polar_radius_m);
    let [x, y, z] = towards.unit().to_array();
    Geodetic {
        height_m: 0.0,
        ..body.geodetic_from_position(Position::from_m(glam::DVec3::new(a * a * x, a * a * y, c * c * z) / a))
    }
}
