//! The shadow methods that a comparison tries, by name.

use std::path::Path;

use crate::evaluate::Error;
use crate::horizon::{HorizonMap, Settings};
use crate::pipeline::{Prepared, Progress, swath};
use crate::render::Shadows;
use crate::shadow::{Baked, Edge, Mipmaps, Multiscale, SingleAzimuth, Swept};

/// What is tried where nobody asks for more.
pub const USUAL: [&str; 7] = ["fourier", "baked", "swath", "mipmaps-5-5-5", "mipmaps-5-5-5-3", "mipmaps", "none"];

/// Methods that take minutes a frame on large terrain.
pub const SLOW: [&str; 5] = ["sweep", "single-azimuth", "single-azimuth-level", "single-azimuth-hard", "multiscale"];

/// Between two azimuths of swaths and sweeps, in degrees.
const AZIMUTH_STEP_DEG: f64 = 0.15;

/// What methods are made from.
#[derive(Debug)]
pub struct Workshop<'a> {
    pub prepared: &'a Prepared,
    pub settings: Settings,
    /// Horizon maps by face and level.
    pub maps: Vec<Vec<HorizonMap>>,
    pub cache: &'a Path,
}

impl Workshop<'_> {
    /// The shadows of a method.
    pub fn shadows(&self, name: &str, progress: &dyn Progress) -> Result<Shadows, Error> {
        let (settings, surface) = (self.settings, &self.prepared.ground.surface);
        let single = |edge| Shadows::Towards(Box::new(SingleAzimuth { settings, spacing: 1.0, edge }));
        Ok(match name {
            "fourier" => Shadows::Fourier(self.maps.clone()),
            "baked" => Shadows::Baked(Baked(self.maps.clone())),
            "swath" => {
                let (exposures, folder) = (&self.prepared.exposures, self.cache.join("horizon"));
                let swath = swath::swath(surface, exposures, AZIMUTH_STEP_DEG, &settings, &folder, progress)?;
                Shadows::Towards(Box::new(swath))
            }
            "sweep" => Shadows::Towards(Box::new(Swept { settings, step_rad: AZIMUTH_STEP_DEG.to_radians() })),
            "single-azimuth" => single(Edge::Sloped),
            "single-azimuth-level" => single(Edge::Level),
            "single-azimuth-hard" => single(Edge::Hard),
            "mipmaps-5-5-5" => Shadows::Mipmaps(Mipmaps { runs: vec![5, 5, 5] }),
            "mipmaps-5-5-5-3" => Shadows::Mipmaps(Mipmaps { runs: vec![5, 5, 5, 3] }),
            "mipmaps" => Shadows::Mipmaps(Mipmaps::reaching(&surface.terrain)),
            "multiscale" => Shadows::Towards(Box::new(Multiscale::new(&surface.terrain, 4, 2.0, 2f64.to_radians()))),
            "none" => Shadows::None,
            _ => return Err(Error::Method { got: name.into(), allowed: [&USUAL[..], &SLOW].concat().join(", ") }),
        })
    }
}
