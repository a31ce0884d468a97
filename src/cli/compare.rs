//! `sim compare`.

use std::path::PathBuf;

use perilune_engine::compare::{Freedom, GeometrySource, Law, Model, Request, compare};

use super::bars::Bars;
use super::common::Files;
use super::run::Adapter;
use super::{Outcome, print_line, ranges};

/// Hold a mission photograph against a render of the same view.
///
/// The view is rendered with the true camera and the true Sun over the elevation models given, registered with the
/// photograph, fitted photometrically and compared, at the coarser of the two resolutions. Terrain and Sun are never
/// touched, the pose with --fit-pose alone. A page with pictures and JSON with the numbers are written.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// The photograph: PNG, TIFF, ISIS cube, PDS3 or PDS4 image, whatever GDAL reads
    photo: PathBuf,
    /// Camera, pose and Sun: a frame as JSON, a CSM ISD (frame, line-scan, push-frame), or a scenario (.ron)
    #[arg(long, value_name = "FILE")]
    geometry: PathBuf,
    /// Elevation model, the finest first; may be given several times. Default with a scenario: its own
    #[arg(long, value_name = "FILE")]
    dem: Vec<PathBuf>,
    /// Albedo map. One that holds the photograph is refused
    #[arg(long, value_name = "FILE")]
    albedo: Option<PathBuf>,
    /// Take the albedo map even if it holds the photograph; the report's first line says so
    #[arg(long, requires = "albedo")]
    force: bool,
    /// Law of reflection [default: a scenario's own, else lunar-lambert]
    #[arg(long, value_enum)]
    photometry: Option<Photometry>,
    /// How the image may be moved to meet the render
    #[arg(long, value_enum, default_value_t)]
    register: Registration,
    /// Turn the camera as the motion of the image asks, set its focal length, and render anew until nothing moves
    #[arg(long)]
    fit_pose: bool,
    /// What may lie between radiance and the photograph's numbers
    #[arg(long, value_enum, default_value_t)]
    fit: Fit,
    /// Dark level of Jung's protocol, a share of the photograph's largest number, as in 0.027 (7/255)
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = ranges::number(0.0..=0.999, ""), allow_hyphen_values = true)]
    dark: f64,
    /// Compare at so many pixels along the longer side [default: as many as the elevation model resolves]
    #[arg(long, value_name = "PIXELS", value_parser = ranges::number(32_usize..=16_384, "pixels"), allow_hyphen_values = true)]
    size: Option<usize>,
    /// Which exposure of a scenario, counted from 0
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = ranges::number(0_usize..=10_000_000, ""), allow_hyphen_values = true)]
    image: usize,
    /// Band of the photograph, counted from 1, where there are several
    #[arg(long, value_name = "N", value_parser = ranges::number(1_usize..=65_536, ""), allow_hyphen_values = true)]
    band: Option<usize>,
    /// Leave out the variants of the physics and of the Sun's place
    #[arg(long)]
    no_ablation: bool,
    /// Directory of the report [default: output/compare/PHOTO]
    #[arg(long, short, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    files: Files,
    /// Who renders
    #[arg(long, value_enum, default_value_t)]
    adapter: Adapter,
    /// Print the numbers as JSON
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  sim compare AS15-M-0297_SML.png --geometry geometry.json --dem gld100_64ppd.tif
  sim compare M1234567890LE.cub --geometry M1234567890LE.json --dem site_5m.tif --dem cap_240m.tif
  sim compare exposure_0003.png --geometry lunar_descent.ron --image 3";

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Photometry {
    Lambert,
    LommelSeeliger,
    LunarLambert,
    Minnaert,
    HapkeMoon,
}

#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
enum Registration {
    None,
    Shift,
    /// Shift, rotation and scale
    #[default]
    Similarity,
}

#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
enum Fit {
    None,
    /// Gain and offset
    #[default]
    Gain,
    /// A rising curve
    Film,
    /// Gain, offset and scattered light
    Stray,
}

impl From<Photometry> for Law {
    fn from(photometry: Photometry) -> Self {
        match photometry {
            Photometry::Lambert => Self::Lambert,
            Photometry::LommelSeeliger => Self::LommelSeeliger,
            Photometry::LunarLambert => Self::LunarLambert,
            Photometry::Minnaert => Self::Minnaert,
            Photometry::HapkeMoon => Self::HapkeMoon,
        }
    }
}

impl From<Registration> for Freedom {
    fn from(registration: Registration) -> Self {
        match registration {
            Registration::None => Self::Nothing,
            Registration::Shift => Self::Shift,
            Registration::Similarity => Self::Similarity,
        }
    }
}

impl From<Fit> for Model {
    fn from(fit: Fit) -> Self {
        match fit {
            Fit::None => Self::Nothing,
            Fit::Gain => Self::Gain,
            Fit::Film => Self::Film,
            Fit::Stray => Self::Stray,
        }
    }
}

pub fn run(args: Args) -> Outcome {
    let is_scenario = args.geometry.extension().is_some_and(|extension| extension == "ron");
    let geometry = if is_scenario {
        let scenario = Box::new(args.files.scenario(&args.geometry)?);
        GeometrySource::Scenario { scenario, exposure: args.image }
    } else {
        GeometrySource::File(args.geometry)
    };
    let stem = args.photo.file_stem().unwrap_or_default().to_owned();
    let cache = args.files.cache.open()?;
    let request = Request {
        photo: args.photo,
        band: args.band,
        geometry,
        dems: args.dem,
        albedo: args.albedo,
        force: args.force,
        law: args.photometry.map(Law::from),
        freedom: args.register.into(),
        fit_pose: args.fit_pose,
        model: args.fit.into(),
        dark: args.dark,
        pixels: args.size,
        ablation: !args.no_ablation,
        turn_sun: !args.no_ablation,
        cache: cache.to_path_buf(),
        adapter: args.adapter.into(),
    };
    let output = args.output.unwrap_or_else(|| PathBuf::from("output/compare").join(stem));
    let bars = Bars::new();
    let comparison = compare(&request, &bars)?;
    bars.clear();
    let files = comparison.write(&output)?;
    if args.json {
        return Ok(print_line(serde_json::to_string_pretty(&comparison.json())?)?);
    }
    print_line(comparison.text())?;
    for file in files {
        print_line(file.display())?;
    }
    Ok(())
}
