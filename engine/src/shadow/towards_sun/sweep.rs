//! Horizons of all nodes towards a still light by the linear-time sweep.
//!
//! A sweep finds the skylines of all nodes of a level in one azimuth in a time proportional to their number, whatever
//! their distance ([`crate::horizon::sweep`]). Over a level the light's azimuth turns slightly: the few azimuths that
//! bracket it and the disc's width are swept, and each node gets the line of its own azimuth between them
//! ([`crate::shadow::fan`]).
//!
//! # Assumptions
//! Between azimuths a step apart the skyline is straight. Where a light's azimuths span more than [`MOST_PLANES`] steps the
//! azimuths are as many, farther apart: under the Sun in the zenith of the map.
//!
//! # References
//! Barrett, *Linear-time horizon sweep*; Timonen & Westerholm (2010), *Scalable height field self-shadowing*,
//! doi:10.1111/j.1467-8659.2009.01642.x.

use rayon::prelude::*;

use crate::horizon::Settings;
use crate::horizon::planes::Sweeps;
use crate::shadow::fan::{Fan, LitNodes};
use crate::shadow::light::QuantizedLight;
use crate::shadow::method::ShadowMethod;
use crate::shadow::near::Near;
use crate::shadow::skylines::{Field, SkylineSource, SurfacePoints, UnpreparedLight};
use crate::terrain::Surface;

/// As many azimuths as a horizon map is made from.
pub const MOST_PLANES: usize = 360;

/// Sweeps towards each light, anew when it moves.
#[derive(Debug, Clone, Copy)]
pub struct Swept {
    pub settings: Settings,
    /// Between two swept azimuths.
    pub step_rad: f64,
}

impl ShadowMethod for Swept {
    fn name(&self) -> &'static str {
        "sweep"
    }

    fn skylines(&self) -> Option<&dyn SkylineSource> {
        Some(self)
    }

    fn near(&self) -> Near {
        Near { postings: self.settings.near }
    }
}

impl SkylineSource for Swept {
    fn field(
        &self,
        surface: &Surface,
        face: usize,
        level: usize,
        light: &QuantizedLight,
    ) -> Result<Field, UnpreparedLight> {
        let (terrain, nodes) = (&surface.terrain.faces[face], &surface.terrain.faces[face].levels[level]);
        let fan = Fan::over(&terrain.map, nodes, &[*light], self.step_rad, MOST_PLANES);
        let directions: Vec<_> = (0..fan.planes).map(|plane| fan.direction(plane)).collect();
        let sweeps = Sweeps::new(terrain, level, &self.settings, &directions);
        let lit = LitNodes { map: &terrain.map, points: SurfacePoints::of(nodes), light };
        let mut field = vec![[0.0; 2]; lit.points.count()];
        let at_once = rayon::current_num_threads();
        for first in (0..fan.planes).step_by(at_once) {
            let some = first..fan.planes.min(first + at_once);
            let swept: Vec<_> =
                directions[some.clone()].par_iter().map(|direction| sweeps.elevations_rad(*direction)).collect();
            fan.add(&mut field, &lit, &some, |plane, node| swept[plane - first][node]);
        }
        Ok(field)
    }
}
