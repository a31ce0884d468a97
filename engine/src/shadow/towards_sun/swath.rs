//! Swath maps: horizons only for the azimuths that lights span in the exposures of a scenario.
//!
//! A landing lasts minutes, in which the Sun moves by 0.04°. Its disc, and the turn of azimuths over the map, span
//! about 1°: a few planes of elevations at full accuracy ([`crate::horizon::planes`]) take the place of a whole
//! horizon map. An exposure gets, at each node, the line of its own azimuth between them ([`crate::shadow::fan`]).
//!
//! Two bytes a node and plane. Planes are kept as tiles, and made once for all exposures.
//!
//! Accuracy beside horizon maps of all azimuths: `docs/experiments/shadow_methods.md`. What is left is the interpolation
//! between nodes.
//!
//! # Assumptions
//! Between planes a step apart the skyline is straight. A light must stay within the swath that was made for it:
//! any other is an error ([`UnpreparedLight`]).

use std::path::Path;

use rayon::prelude::*;

use crate::horizon::planes::{self, StoredPlane, Sweeps};
use crate::horizon::{Error, Settings};
use crate::shadow::fan::{Fan, LitNodes, fans};
use crate::shadow::light::QuantizedLight;
use crate::shadow::method::ShadowMethod;
use crate::shadow::near::Near;
use crate::shadow::skylines::{Field, SkylineSource, SurfacePoints, UnpreparedLight};
use crate::terrain::{Surface, Terrain};

/// 128 bytes a node: long before, Fourier maps are smaller.
pub const MOST_PLANES: usize = 64;

/// Planes of all levels towards lights, `[light][face][level]`.
#[derive(Debug)]
pub struct Swath {
    strips: Vec<Vec<Vec<Strip>>>,
    near: Near,
}

/// The planes of one level towards one light.
#[derive(Debug)]
struct Strip {
    fan: Fan,
    planes: Vec<StoredPlane>,
}

/// The azimuths of a swath before anything is swept.
#[derive(Debug)]
pub struct Plan {
    fans: Vec<Vec<Vec<Fan>>>,
}

impl Plan {
    /// The azimuths of all lights of each exposure, no wider apart than `step_rad`.
    pub fn new(surface: &Surface, lights: &[Vec<QuantizedLight>], step_rad: f64) -> Self {
        Self { fans: fans(surface, lights, step_rad) }
    }

    /// The most planes that a level gets towards one light.
    pub fn most_planes(&self) -> usize {
        self.fans.iter().flatten().flatten().map(|fan| fan.planes).max().unwrap_or(0)
    }

    /// All planes.
    pub fn planes(&self) -> usize {
        self.fans.iter().flatten().flatten().map(|fan| fan.planes).sum()
    }

    /// The planes from tiles in `directory`, those that are not there swept first; `progress` hears how many are done.
    pub fn open_or_build(
        self,
        surface: &Surface,
        settings: &Settings,
        directory: &Path,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Swath, Error> {
        let (all, mut done) = (self.planes(), 0);
        let mut strips = Vec::new();
        for faces in self.fans {
            let mut of_light = Vec::new();
            for (face, levels) in faces.into_iter().enumerate() {
                let mut of_face = Vec::new();
                for (level, fan) in levels.into_iter().enumerate() {
                    done += fan.planes;
                    of_face.push(Strip::open_or_build(&surface.terrain, [face, level], fan, settings, directory)?);
                    progress(done, all);
                }
                of_light.push(of_face);
            }
            strips.push(of_light);
        }
        Ok(Swath { strips, near: Near { postings: settings.near } })
    }
}

impl Strip {
    fn open_or_build(
        terrain: &Terrain,
        [face, level]: [usize; 2],
        fan: Fan,
        settings: &Settings,
        directory: &Path,
    ) -> Result<Self, Error> {
        let face = &terrain.faces[face];
        let points = SurfacePoints::of(&face.levels[level]);
        let level_key = planes::level_key(&terrain.body, face, level, settings);
        let key = |plane: usize| planes::key(&level_key, fan.azimuth_rad(plane));
        let known = |plane: usize| planes::read(directory, &key(plane), [points.columns, points.rows]).ok();
        let mut found: Vec<Option<StoredPlane>> = (0..fan.planes).into_par_iter().map(known).collect();
        let missing: Vec<usize> = (0..fan.planes).filter(|plane| found[*plane].is_none()).collect();
        let directions: Vec<_> = missing.iter().map(|plane| fan.direction(*plane)).collect();
        let sweeps = Sweeps::new(face, level, settings, &directions);
        let make = |&plane: &usize| {
            let made = StoredPlane::new(points.columns, &sweeps.elevations_rad(fan.direction(plane)));
            planes::write(directory, &key(plane), fan.azimuth_rad(plane), &made)?;
            Ok::<_, Error>((plane, made))
        };
        for made in missing.par_iter().map(make).collect::<Vec<_>>() {
            let (plane, made) = made?;
            found[plane] = Some(made);
        }
        Ok(Self { planes: found.into_iter().flatten().collect(), fan })
    }
}

impl Swath {
    /// Bytes of all planes.
    pub fn bytes(&self) -> usize {
        self.planes().map(StoredPlane::bytes).sum()
    }

    /// Most that rounding has moved an elevation by.
    pub fn rounding_rad(&self) -> f32 {
        self.planes().map(StoredPlane::rounding_rad).fold(0.0, f32::max)
    }

    fn planes(&self) -> impl Iterator<Item = &StoredPlane> {
        self.strips.iter().flatten().flatten().flat_map(|strip| &strip.planes)
    }
}

impl ShadowMethod for Swath {
    fn name(&self) -> &'static str {
        "swath"
    }

    fn skylines(&self) -> Option<&dyn SkylineSource> {
        Some(self)
    }

    fn near(&self) -> Near {
        self.near
    }
}

impl SkylineSource for Swath {
    fn field(
        &self,
        surface: &Surface,
        face: usize,
        level: usize,
        light: &QuantizedLight,
    ) -> Result<Field, UnpreparedLight> {
        let terrain = &surface.terrain.faces[face];
        let points = SurfacePoints::of(&terrain.levels[level]);
        let lit = LitNodes { map: &terrain.map, points, light };
        let corners = [0, points.columns - 1, points.count() - points.columns, points.count() - 1];
        let mut strips = self.strips.iter().map(|faces| &faces[face][level]);
        let holds = |strip: &&Strip| corners.iter().all(|corner| strip.fan.spans(&lit.pointing(*corner)));
        let Strip { fan, planes } = strips.find(holds).ok_or(UnpreparedLight { face, level })?;
        let mut field = vec![[0.0; 2]; points.count()];
        fan.add(&mut field, &lit, &(0..planes.len()), |plane, node| planes[plane].elevation_rad(node));
        Ok(field)
    }
}
