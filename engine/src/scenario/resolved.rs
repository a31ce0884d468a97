//! A scenario as the program uses it: SI and radians, instants, files that exist.

use std::path::PathBuf;

use glam::{DQuat, DVec3};
use hifitime::Epoch;

use super::spec;
use super::varied::Sweep;
use crate::camera::{Correction, Isd, PsfComponent, Shutter, Vignetting};
use crate::ephemeris::KernelSource;
use crate::geometry::{Body, Geodetic};
use crate::horizon::Encoding;
use crate::labels::Wanted;
use crate::photometry::{Curve, DiscFunction, Hapke, PhaseFunction};
use crate::raster::Reading;
use crate::render::ViewRays;

pub use super::spec::{
    Ambient, AutoExposure, Bounce, Detector, Distortion, HeightAbove, LimbLaw, Outputs, Preset, Preview, Shadows, Sky,
    Split, Top, Values,
};

/// All that a run needs, as plain values.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// The scenario's file.
    pub path: PathBuf,
    /// Name of the file without its extension: the name of the output directory.
    pub name: String,
    /// The file as written.
    pub text: String,
    /// What it says, presets filled in.
    pub spec: spec::Spec,
    pub title: String,
    pub body: Body,
    /// Body-fixed frame by its SPICE name; `None`: the best that the kernels have.
    pub frame: Option<String>,
    /// `None`: the shipped default kernels.
    pub kernels: Option<Vec<KernelSource>>,
    /// `None`: the bare spheroid.
    pub terrain: Option<Terrain>,
    pub horizon: Horizon,
    /// Never an older spelling.
    pub shadows: Shadows,
    /// What the user should write otherwise, though it works.
    pub notes: Vec<String>,
    /// Whether tracing settles what horizon maps leave open.
    pub refine: bool,
    pub view_rays: ViewRays,
    pub photometry: Photometry,
    pub albedo: Albedo,
    pub sun: Sun,
    /// `None`: all wavelengths.
    pub band: Option<Passband>,
    /// Geometric albedo of the Earth; `None`: no earthshine.
    pub earthshine_albedo: Option<f64>,
    /// `None`: a black sky.
    pub ambient: Option<Ambient>,
    /// `None`: no light from terrain to terrain.
    pub bounce: Option<Bounce>,
    pub trajectory: Trajectory,
    pub pointing: Pointing,
    pub camera: Camera,
    pub detector: Option<Detector>,
    /// Strictly increasing, never empty.
    pub exposures: Vec<Epoch>,
    /// `None`: the exposures are made once.
    pub sweep: Option<Sweep>,
    pub split: Option<Split>,
    pub outputs: Outputs,
    /// `None`: no landmarks are written.
    pub landmarks: Option<Landmarks>,
    pub hazards: crate::labels::Limits,
    pub seed: u64,
    /// Whether it is made for a first look only ([`Scenario::draft`]).
    pub draft: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Terrain {
    /// Height 0; `None`: the centre of the first DEM.
    pub centre: Option<Geodetic>,
    /// Finest first, never empty.
    pub dems: Vec<Dem>,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Dem {
    File {
        path: PathBuf,
        reading: Reading,
        values: Values,
        posting_m: Option<f64>,
        extent_m: Option<f64>,
    },
    Synthetic {
        columns: u32,
        rows: u32,
        posting_m: f64,
        centre: Geodetic,
        seed: u64,
    },
    /// Continues the next model. `None`: about the middle of the first measured one.
    Detail {
        posting_m: f64,
        extent_m: f64,
        centre: Option<Geodetic>,
        seed: u64,
        craters: f64,
        boulders_per_km2: f64,
    },
    Cube {
        path: PathBuf,
        reading: Reading,
        values: Values,
        posting_m: Option<f64>,
    },
    Globe(Globe),
}

impl Scenario {
    /// Whether the terrain is a globe in tiles.
    pub fn shows_globe(&self) -> bool {
        self.terrain.as_ref().is_some_and(|terrain| matches!(terrain.dems[..], [Dem::Globe(_)]))
    }
}

/// A model of the whole body, shown in tiles by what the cameras see.
#[derive(Debug, Clone, PartialEq)]
pub struct Globe {
    pub path: PathBuf,
    pub reading: Reading,
    pub values: Values,
    /// `None`: the model's own.
    pub posting_m: Option<f64>,
    /// A folder of horizon tiles.
    pub tiles: Option<PathBuf>,
    pub posting_px: f64,
    pub most_tiles: u32,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Horizon {
    pub azimuths: u32,
    /// `None`: as far as the highest terrain can stand above the horizon.
    pub search_m: Option<f64>,
    pub observer_height_m: f64,
    pub encoding: Encoding,
    /// Whether horizons are clamped to the elevations that the Sun's disc reaches in the exposures.
    pub band: bool,
}

/// A law of reflection without its albedo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Photometry {
    Empirical { disc: DiscFunction, phase: PhaseFunction },
    LrocNac2019,
    Hapke(Hapke),
}

impl Photometry {
    /// Whether its reflectance is its own, so that an albedo multiplies it and a phase function would be a second one.
    pub fn is_absolute(&self) -> bool {
        !matches!(self, Self::Empirical { .. })
    }
}

#[derive(Debug, Clone, PartialEq)]
pub enum Albedo {
    Constant(f64),
    Map(PathBuf, Reading),
    /// Of Hapke's `w`.
    SingleScattering(PathBuf, Reading),
}

#[derive(Debug, Clone, PartialEq)]
pub struct Sun {
    /// `None`: a uniform disc.
    pub limb_darkening: Option<LimbDarkened>,
    /// What the spectrum is called in records.
    pub spectrum: String,
    /// The file that it comes from; `None`: none, or one that is shipped.
    pub table: Option<PathBuf>,
    /// At 1 au, in the camera's band.
    pub irradiance_w_m2: f64,
    /// Whether the Earth may hide it from the Moon.
    pub eclipses: bool,
    /// `None`: from the kernels.
    pub fixed: Option<FixedSun>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimbDarkened {
    pub law: LimbLaw,
    pub wavelength_m: f64,
}

/// The wavelengths that count.
#[derive(Debug, Clone, PartialEq)]
pub struct Passband {
    pub response: Curve,
    /// The response's file; `None`: the same response between two wavelengths.
    pub path: Option<PathBuf>,
    /// `∫ T dλ`
    pub width_nm: f64,
    /// Mean wavelength of sunlight in the band, weighted by energy.
    pub wavelength_nm: f64,
}

/// A Sun held still in the sky of the terrain's centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedSun {
    /// Clockwise from north.
    pub azimuth_rad: f64,
    pub elevation_rad: f64,
    pub distance_m: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Trajectory {
    /// Body-fixed; epochs strictly increasing, never empty.
    Waypoints {
        points: Vec<Waypoint>,
        height_above: HeightAbove,
    },
    /// `path` is `None` where one of the scenario's kernels holds the body.
    Spk {
        path: Option<KernelSource>,
        naif_id: i32,
    },
    Oem {
        path: PathBuf,
    },
    /// Osculating elements about the ICRF equator.
    Orbit {
        epoch: Epoch,
        elements: Elements,
        gm_m3_s2: Option<f64>,
    },
    /// Axes of the ICRF.
    State {
        epoch: Epoch,
        position_m: DVec3,
        velocity_m_s: DVec3,
        gm_m3_s2: Option<f64>,
    },
    /// The poses of the camera's ISD.
    Isd,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    pub epoch: Epoch,
    pub point: Geodetic,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elements {
    pub semi_major_axis_m: f64,
    pub eccentricity: f64,
    pub inclination_rad: f64,
    pub node_rad: f64,
    pub periapsis_rad: f64,
    pub true_anomaly_rad: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Pointing {
    pub towards: Towards,
    /// `None`: the law's own.
    pub top: Option<Top>,
    /// From +x (right) towards +y (down).
    pub roll_rad: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Towards {
    Nadir,
    At {
        point: Geodetic,
        height_above: HeightAbove,
    },
    AlongVelocity,
    /// `camera_from_body`, one per epoch, of length 1; a fixed attitude is a table of one.
    Table(Vec<(Epoch, DQuat)>),
    Aem {
        path: PathBuf,
    },
}

#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    pub columns: u32,
    pub rows: u32,
    /// Focal length over pixel pitch.
    pub focal_length_px: f64,
    /// `None`: the scenario gave a field of view.
    pub pixel_pitch_m: Option<f64>,
    /// From the outer corner of the top left pixel; of scanners, of one line or framelet.
    pub principal_point_px: [f64; 2],
    pub distortion: Option<Distortion>,
    /// On the plane at distance 1, from measured to ideal.
    pub correction: Option<Correction>,
    pub vignetting: Vignetting,
    pub spreads: Vec<PsfComponent>,
    /// A measured kernel, which follows the spreads.
    pub kernel: Option<PathBuf>,
    /// A square number.
    pub samples_per_pixel: u32,
    pub f_number: f64,
    pub transmission: f64,
    pub exposure_s: f64,
    /// `None`: `exposure_s` holds.
    pub auto_exposure: Option<AutoExposure>,
    /// Of each exposure; odd.
    pub moments: u32,
    pub shutter: Shutter,
    /// What the figures were taken from.
    pub preset: Option<Preset>,
    pub isd: Option<Box<Isd>>,
}

impl Camera {
    /// However the exposure is chosen.
    pub fn longest_exposure_s(&self) -> f64 {
        self.auto_exposure.map_or(self.exposure_s, |auto| auto.longest_s)
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Landmarks {
    pub lists: Vec<CraterList>,
    pub wanted: Wanted,
    pub overlay: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub enum CraterList {
    /// Of the made models of the terrain.
    Terrain,
    File(PathBuf),
}
