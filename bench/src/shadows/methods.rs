//! The shadow methods that a comparison tries, by name.

use std::path::Path;

use crate::Error;
use perilune_engine::horizon::{Encoding, HorizonMap, Memory, Settings};
use perilune_engine::pipeline::{self, Prepared, Progress, ground, swath};
use perilune_engine::render::Shadows;
use perilune_engine::scenario::{self, ShadowPreset};
use perilune_engine::shadow::{At, Baked, Edge, Lighting, Mipmaps, Multiscale, SingleAzimuth, Swept};

/// What is tried where nobody asks for more.
pub const USUAL: [&str; 7] = ["fourier", "baked", "swath", "mipmaps-5-5-5", "mipmaps-5-5-5-3", "mipmaps", "none"];

/// Methods that take minutes a frame on large terrain.
pub const SLOW: [&str; 6] =
    ["uniform-100", "sweep", "single-azimuth", "single-azimuth-level", "single-azimuth-hard", "multiscale"];

/// Between two azimuths of swaths and sweeps, in degrees.
const AZIMUTH_STEP_DEG: f64 = 0.15;

/// An elevation and a slope, or a fourth of a float of maxima at each mip.
const FIELD_BYTES: f64 = 8.0;
const MAXIMA_BYTES: f64 = 4.0 / 3.0;

/// Whether a method goes by this name.
pub fn known(name: &str) -> bool {
    [&USUAL[..], &SLOW].concat().contains(&name) || encoded(name).is_some() || preset(name).is_some()
}

/// All names, for people.
pub fn allowed() -> String {
    [&USUAL[..], &SLOW].concat().join(", ") + ", fourier-ENCODING, baked-ENCODING, preset-NAME"
}

/// `preset-High` and its like: those of Fritsch 2025.
fn preset(name: &str) -> Option<ShadowPreset> {
    let name = name.strip_prefix("preset-")?;
    ShadowPreset::ALL.into_iter().find(|preset| format!("{preset:?}") == name)
}

/// `fourier-fm16` and its like: horizon maps in an encoding that is not the scenario's.
fn encoded(name: &str) -> Option<(&str, Encoding)> {
    let (method, encoding) = name.split_once('-')?;
    ["fourier", "baked"].contains(&method).then_some(())?;
    Some((method, encoding.parse().ok()?))
}

/// What stops a run, or why a method cannot do a scene.
pub fn outside_domain(method: &str, error: Error) -> Result<String, Error> {
    match error {
        Error::Pipeline(why @ pipeline::Error::SwathTooWide { .. }) => {
            Ok(format!("{method}: outside its domain: {why}."))
        }
        other => Err(other),
    }
}

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
            "mipmaps-5-5-5" => Shadows::Mipmaps(Mipmaps::of(&[5, 5, 5])),
            "mipmaps-5-5-5-3" => Shadows::Mipmaps(Mipmaps::of(&[5, 5, 5, 3])),
            "uniform-100" => Shadows::Mipmaps(Mipmaps::uniform(100, 1.0)),
            "mipmaps" => Shadows::Mipmaps(Mipmaps::reaching(&surface.terrain)),
            "multiscale" => Shadows::Towards(Box::new(Multiscale::new(&surface.terrain, 4, 2.0, 2f64.to_radians()))),
            "none" => Shadows::None,
            _ => match encoded(name) {
                Some(("fourier", encoding)) => Shadows::Fourier(self.encoded_maps(encoding, progress)?),
                Some((_, encoding)) => Shadows::Baked(Baked(self.encoded_maps(encoding, progress)?)),
                None => match preset(name).map(ShadowPreset::shadows) {
                    Some(scenario::Shadows::Series { visibility, coefficients, at }) => {
                        let maps = match self.maps.iter().flatten().all(|map| map.encoding == Encoding::Fm16) {
                            true => self.maps.clone(),
                            false => self.encoded_maps(Encoding::Fm16, progress)?,
                        };
                        pipeline::scene::series(maps, visibility, coefficients, at)
                    }
                    Some(_) => Shadows::None,
                    None => return Err(Error::Method { got: name.into(), allowed: allowed() }),
                },
            },
        })
    }

    fn encoded_maps(&self, encoding: Encoding, progress: &dyn Progress) -> Result<Vec<Vec<HorizonMap>>, Error> {
        let folder = self.cache.join("horizon");
        let surface = &self.prepared.ground.surface;
        let finished = |_: &ground::Tile| Ok::<_, pipeline::Error>(());
        let maps = ground::horizons(surface, &self.settings, encoding, &folder, Memory::default(), progress, finished)?;
        Ok(maps)
    }

    /// What a device holds for a method, per node of the terrain.
    pub fn bytes_per_node(&self, shadows: &Shadows) -> f64 {
        let levels = || self.prepared.ground.surface.terrain.faces.iter().flat_map(|face| &face.levels);
        let seen = levels().map(|level| level.seen_nodes());
        let nodes = seen.sum::<usize>().max(1) as f64;
        let maps =
            |maps: &[Vec<HorizonMap>]| maps.iter().flatten().map(HorizonMap::bytes).sum::<usize>() as f64 / nodes;
        match shadows {
            Shadows::None | Shadows::Traced(_) => 0.0,
            Shadows::Fourier(held) => maps(held),
            Shadows::Lighting(Lighting { maps: held, at: At::Pixels, .. }) => maps(held),
            Shadows::Baked(Baked(held)) | Shadows::Lighting(Lighting { maps: held, .. }) => maps(held) + FIELD_BYTES,
            Shadows::Towards(_) => FIELD_BYTES,
            Shadows::Mipmaps(_) => MAXIMA_BYTES,
        }
    }
}
