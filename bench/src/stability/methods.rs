//! Every shadow method on a case.

use std::path::Path;
use std::sync::Arc;

use super::{Case, Outcome};
use crate::Error;
use perilune_engine::gpu::Gpu;
use perilune_engine::horizon::{self, Encoding, HorizonMap, Memory, Request, Settings};
use perilune_engine::render::{Renderer, Shadows, View};
use perilune_engine::shadow::swath::{MOST_PLANES, Plan};
use perilune_engine::shadow::{Baked, Edge, Mipmaps, Multiscale, SingleAzimuth, Swept};
use perilune_engine::terrain::{Face, Surface};

pub const METHODS: [&str; 12] = [
    "traced",
    "fourier",
    "fourier-f16",
    "baked",
    "swath",
    "sweep",
    "single-azimuth",
    "single-azimuth-level",
    "single-azimuth-hard",
    "mipmaps-5-5-5",
    "mipmaps",
    "multiscale",
];

/// Azimuths of the horizon maps, and between two of swaths and sweeps.
const AZIMUTHS: usize = 120;
const STEP_RAD: f64 = 0.15 * std::f64::consts::PI / 180.0;
/// Postings that runs of 5, 5 and 5 mips look far.
const RUNS_REACH: f64 = 48.0;

/// What a terrain's methods are made from: its horizon maps, by face and level.
#[derive(Debug)]
pub struct Workbench<'a> {
    small: Vec<Vec<HorizonMap>>,
    full: Vec<Vec<HorizonMap>>,
    cache: &'a Path,
}

impl<'a> Workbench<'a> {
    pub fn new(surface: &Surface, cache: &'a Path) -> Result<Self, Error> {
        let terrain = &surface.terrain;
        let settings = Settings { azimuths: AZIMUTHS, ..Settings::default() };
        let maps = |encoding| {
            let map = |face: &Face, level: usize| {
                let request = Request { body: &terrain.body, face, level, settings, encoding };
                horizon::open_or_build(&request, &cache.join("horizon"), Memory::default(), &|_, _| ())
            };
            let of_face = |face: &Face| (0..face.levels.len()).map(|level| map(face, level)).collect();
            terrain.faces.iter().map(of_face).collect::<Result<_, _>>()
        };
        Ok(Self { small: maps(Encoding::Fm16)?, full: maps(Encoding::F16)?, cache })
    }

    /// The shadows of a method towards a view's lights; `None` outside its domain.
    fn shadows(&self, method: &str, surface: &Surface, view: &View) -> Result<Option<Shadows>, Error> {
        let settings = Settings::default();
        let single = |edge| Shadows::Towards(Box::new(SingleAzimuth { settings, spacing: 1.0, edge }));
        Ok(Some(match method {
            "traced" => Shadows::Traced(settings),
            "fourier" => Shadows::Fourier(self.small.clone()),
            "fourier-f16" => Shadows::Fourier(self.full.clone()),
            "baked" => Shadows::Baked(Baked(self.small.clone())),
            "swath" => {
                let plan = Plan::new(surface, &[view.held_lights()], STEP_RAD);
                if plan.most_planes() > MOST_PLANES {
                    return Ok(None);
                }
                let swath = plan.open_or_build(surface, &settings, &self.cache.join("horizon"), &|_, _| ())?;
                Shadows::Towards(Box::new(swath))
            }
            "sweep" => Shadows::Towards(Box::new(Swept { settings, step_rad: STEP_RAD })),
            "single-azimuth" => single(Edge::Sloped),
            "single-azimuth-level" => single(Edge::Level),
            "single-azimuth-hard" => single(Edge::Hard),
            "mipmaps-5-5-5" => Shadows::Mipmaps(Mipmaps::of(&[5, 5, 5])),
            "mipmaps" => Shadows::Mipmaps(Mipmaps::reaching(&surface.terrain)),
            "multiscale" => Shadows::Towards(Box::new(Multiscale::new(&surface.terrain, 4, 2.0, 2f64.to_radians()))),
            _ => return Err(Error::Method { got: method.into(), allowed: METHODS.join(", ") }),
        }))
    }
}

fn within_domain(case: &Case, method: &str) -> bool {
    let posting_m = case.scene.surface.terrain.faces[0].levels[0].posting_m;
    match method {
        "mipmaps-5-5-5" => case.reach_m <= RUNS_REACH * posting_m,
        "single-azimuth-hard" => !case.soft,
        _ => true,
    }
}

/// The case by a method, in the reference renderer or on a device.
pub fn outcome(case: &mut Case, method: &str, gpu: Option<&Gpu>, workbench: &Workbench) -> Result<Outcome, Error> {
    if !within_domain(case, method) {
        return Ok(Outcome::Outside);
    }
    let mut images = Vec::new();
    let mut held = None;
    for view in &case.views {
        // A swath belongs to its lights; a device keeps what others have uploaded.
        if held.is_none() || method == "swath" {
            let Some(shadows) = workbench.shadows(method, &case.scene.surface, view)? else {
                return Ok(Outcome::Outside);
            };
            case.scene.shadows = Arc::new(shadows);
            held = Some(Renderer::on_any(gpu).session(&case.scene)?);
        }
        if let Some(session) = &mut held {
            images.push(session.samples(view)?);
        }
    }
    Ok(case.outcome(&images))
}
