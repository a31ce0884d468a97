//! Horizons of all nodes in the azimuth of a still light, by stepping along the map line towards it (Aslandere 2015).
//!
//! From a node `P` heights are sampled, bilinearly, at every `spacing` postings of the level that a line crosses:
//!
//! ```text
//! β = max over k of elevation((H(P + t_k d) − H_P)/t_k)     t_k = k · spacing · posting            (eqs. 3–5)
//! hard:   the whole disc where β ≤ α, else none of it, α the light's elevation at the node          (eq. 6)
//! level:  the disc above a level skyline at β                                                       (Max 1988)
//! sloped: the disc above the line nearest to β at three azimuths across it                          ([`crate::shadow::fan`])
//! ```
//!
//! Lines are straight on the lifted map and tangents are turned into elevations there, so that bodies are round; where
//! a level ends the line goes on over the next coarser one at that one's posting, and beyond the last one stands the bare
//! sphere. The paper's angles lie between 0° and 90°; a skyline seen from a height is below the horizontal, and so it is here.
//!
//! [`mod@reference`] is the paper's loop in `f64`, [`lanes`] samples neighbouring nodes of a row side by side in `f32`;
//! `tests/conformance/directional.rs` holds the two together.
//!
//! # Assumptions
//! Peaks between two samples are missed: at a spacing of 1 no image measured so far shows it beside what interpolation between
//! nodes costs. Levels finer than the node's own do not exist. Nodes side by side share
//! an azimuth within [`lanes::ALIKE_RAD`].
//!
//! # References
//! Aslandere, Flatken & Gerndt (2015), *A real-time physically based algorithm for hard shadows on dynamic height-fields*;
//! Max (1988), *Horizon mapping: shadows for bump-mapped surfaces*, doi:10.1007/BF01905562.

pub mod lanes;
pub mod reference;

use std::fmt;

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::horizon::Settings;
use crate::shadow::fan::{THREE, line_of_three};
use crate::shadow::light::QuantizedLight;
use crate::shadow::method::ShadowMethod;
use crate::shadow::skylines::{Field, Skyline, SkylineSource, UnpreparedLight};
use crate::terrain::Surface;
use lanes::{LANES, Lines};

/// What becomes of a light's disc at the edge of a shadow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum Edge {
    /// All of it is seen or nothing, as in the paper.
    Hard,
    /// What stands above a level skyline.
    Level,
    /// What stands above a straight skyline that slopes as it does across the disc, from three azimuths.
    #[default]
    Sloped,
}

/// As a scenario writes it.
impl fmt::Display for Edge {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Hard => "Hard",
            Self::Level => "Level",
            Self::Sloped => "Sloped",
        })
    }
}

/// Steps towards each light, anew when it moves.
#[derive(Debug, Clone, Copy)]
pub struct SingleAzimuth {
    /// Azimuths and band have no share in it.
    pub settings: Settings,
    /// Between two samples, in postings of the level that is sampled.
    pub spacing: f64,
    pub edge: Edge,
}

impl ShadowMethod for SingleAzimuth {
    fn name(&self) -> &'static str {
        match self.edge {
            Edge::Hard => "single-azimuth-hard",
            Edge::Level => "single-azimuth-level",
            Edge::Sloped => "single-azimuth",
        }
    }

    fn skylines(&self) -> Option<&dyn SkylineSource> {
        Some(self)
    }
}

impl SkylineSource for SingleAzimuth {
    fn field(
        &self,
        surface: &Surface,
        face: usize,
        level: usize,
        light: &QuantizedLight,
    ) -> Result<Field, UnpreparedLight> {
        let lines = Lines::new(surface, face, level, self.spacing, &self.settings);
        let (columns, rows) = lines.seen();
        let mut field = vec![[0.0; 2]; columns * rows];
        field.par_chunks_mut(columns).enumerate().for_each(|(row, skylines)| {
            for (block, skylines) in skylines.chunks_mut(LANES).enumerate() {
                self.block(&lines, light, [block * LANES, row], skylines);
            }
        });
        Ok(field)
    }
}

impl SingleAzimuth {
    /// The skylines of nodes side by side in a row, from `first` on.
    fn block(&self, lines: &Lines, light: &QuantizedLight, first: [usize; 2], skylines: &mut [Skyline]) {
        let count = skylines.len();
        let pointing = |lane: usize| light.pointing(lines.map(), lines.point([first[0] + lane, first[1]]));
        let [west, middle, east] = [pointing(0), pointing(count / 2), pointing(count - 1)];
        if count > 1 && west.towards.distance(east.towards) > lanes::ALIKE_RAD {
            let (left, right) = skylines.split_at_mut(count / 2);
            self.block(lines, light, first, left);
            return self.block(lines, light, [first[0] + count / 2, first[1]], right);
        }
        let turned = |x: f64| glam::DVec2::from_angle(-x * middle.half_width_rad).rotate(middle.towards);
        match self.edge {
            Edge::Sloped => {
                let [a, b, c] = THREE.map(|x| lines.elevations_rad(first, count, turned(x)));
                for (lane, skyline) in skylines.iter_mut().enumerate() {
                    *skyline = line_of_three([a[lane], b[lane], c[lane]], middle.half_width_rad);
                }
            }
            Edge::Level => {
                let elevations_rad = lines.elevations_rad(first, count, middle.towards);
                skylines.iter_mut().zip(elevations_rad).for_each(|(skyline, e)| *skyline = [e as f32, 0.0]);
            }
            Edge::Hard => {
                let elevations_rad = lines.elevations_rad(first, count, middle.towards);
                for (lane, skyline) in skylines.iter_mut().enumerate() {
                    let light_rad = pointing(lane).elevation_rad;
                    *skyline = flag(elevations_rad[lane] <= light_rad, light_rad);
                }
            }
        }
    }
}

/// A skyline far below a light or far above it: between two nodes of which one is lit the disc is crossed halfway.
fn flag(lit: bool, light_rad: f64) -> Skyline {
    let away_rad = if lit { -FAR_RAD } else { FAR_RAD };
    [(light_rad + away_rad) as f32, 0.0]
}

/// 200 of the Sun's radii, so that a penumbra takes 1/200 of a cell.
const FAR_RAD: f64 = 1.0;
