//! What to compare, and with which physics.

use std::path::PathBuf;

use super::Error;
use super::photometric::Model;
use super::register::Freedom;
use super::render::Trial;
use crate::photometry::{DiscFunction, Hapke, LimbDarkening, Reflectance, SolarDisk};
use crate::pipeline::{self, AdapterChoice};
use crate::scenario;

/// What to compare, and how.
#[derive(Debug, Clone)]
pub struct Request {
    pub photo: PathBuf,
    /// Of the photograph, counted from 1.
    pub band: Option<usize>,
    pub geometry: GeometrySource,
    pub dems: Vec<PathBuf>,
    pub albedo: Option<PathBuf>,
    /// Compare even where the albedo map holds the photograph.
    pub force: bool,
    /// `None`: a scenario's own, else lunar-Lambert.
    pub law: Option<Law>,
    pub freedom: Freedom,
    /// Take the pose that explains the motion and render anew, until nothing moves.
    pub fit_pose: bool,
    pub model: Model,
    /// Jung's dark level, a share of the photograph's largest number.
    pub dark: f64,
    /// Pixels along the longer side; `None`: as many as the elevation model resolves.
    pub pixels: Option<usize>,
    /// Compare variants of the physics.
    pub ablation: bool,
    /// Ask the photograph where it has the Sun.
    pub turn_sun: bool,
    pub cache: PathBuf,
    pub adapter: AdapterChoice,
}

/// Where the camera and the Sun come from.
#[derive(Debug, Clone)]
pub enum GeometrySource {
    /// A frame of ours or a CSM ISD.
    File(PathBuf),
    /// An exposure of a scenario, counted from 0.
    Scenario { scenario: Box<scenario::Scenario>, exposure: usize },
}

/// Laws of reflection by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    Lambert,
    LommelSeeliger,
    LunarLambert,
    Minnaert,
    HapkeMoon,
}

/// Effective wavelength of panchromatic film and of unfiltered silicon under sunlight.
const WAVELENGTH_NM: f64 = 580.0;
/// About the Moon's; only ratios count in a comparison.
pub(super) const NORMAL_ALBEDO: f64 = 0.12;
/// Between Lambert's 1 and the ½ of a law without limb darkening; its change with phase is left out.
const MINNAERT_EXPONENT: f64 = 0.7;

impl Law {
    pub const ALL: [Self; 5] =
        [Self::Lambert, Self::LommelSeeliger, Self::LunarLambert, Self::Minnaert, Self::HapkeMoon];

    pub fn name(self) -> &'static str {
        match self {
            Self::Lambert => "Lambert",
            Self::LommelSeeliger => "Lommel-Seeliger",
            Self::LunarLambert => "lunar-Lambert",
            Self::Minnaert => "Minnaert k = 0.7",
            Self::HapkeMoon => "Hapke, Moon",
        }
    }

    /// Without a phase function, but for Hapke's: a photograph's own brightness is not known, and within one the phase angle
    /// hardly changes.
    pub fn reflectance(self) -> Reflectance {
        let empirical = |disc| Reflectance::empirical(NORMAL_ALBEDO, disc);
        match self {
            Self::Lambert => empirical(DiscFunction::Lambert),
            Self::LommelSeeliger => empirical(DiscFunction::LommelSeeliger),
            Self::LunarLambert => empirical(DiscFunction::LunarLambert),
            Self::Minnaert => empirical(DiscFunction::Minnaert { exponent: MINNAERT_EXPONENT }),
            Self::HapkeMoon => Reflectance::Hapke(Hapke::moon()),
        }
    }
}

impl Trial {
    /// Cast shadows of a limb-darkened Sun.
    pub fn of(law: Law) -> Result<Self, Error> {
        let disk = SolarDisk::new(LimbDarkening::hestroffer_magnan(WAVELENGTH_NM)?)?;
        let (name, reflectance) = (law.name().into(), law.reflectance());
        Ok(Self { name, reflectance, disk, shadows: true, sun_radii: 1.0, sun_turn_rad: [0.0; 2] })
    }

    /// The scenario's own surface, disc and shadows.
    pub(super) fn of_scenario(scenario: &scenario::Scenario) -> Result<Self, Error> {
        Ok(Self {
            name: "the scenario's".into(),
            reflectance: pipeline::scene::reflectance(scenario)?,
            disk: pipeline::scene::disk(scenario)?,
            shadows: !scenario.shadows.are_off(),
            sun_radii: 1.0,
            sun_turn_rad: [0.0; 2],
        })
    }
}
