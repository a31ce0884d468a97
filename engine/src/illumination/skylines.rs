//! Where the skylines of a level come from: swept anew, or decoded from a tile.
//!
//! A polar Sun stays within 2° of the skyline. On the connecting ridge, in a year by hours, the mean share of the disc
//! from 16 coefficients in half floats is off by 0.15 % RMS and 0.3 % at most of 12 traced nodes; from 360 swept azimuths,
//! which take no longer to make but 720 bytes a node for 64, by 0.007 % and 0.015 %. Swept skylines are kept as they are
//! found, in 16 bits a sample. `sim bench illumination` measures all kinds.
//!
//! # Assumptions
//! A sample is rounded to steps of [`STEP_RAD`], 0.003°: a hundredth of the Sun's disc.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec2;
use rayon::prelude::*;

use super::blocks::{Blocks, LANES};
use crate::horizon::axis::Major;
use crate::horizon::elevation_plane::ElevationPlane;
use crate::horizon::search::Search;
use crate::horizon::settings::direction;
use crate::horizon::{Error, HorizonMap, Settings};
use crate::terrain::Face;

/// Resolution of a swept sample.
pub const STEP_RAD: f64 = FRAC_PI_2 / 32767.0;

/// Azimuths at which a tile is decoded.
const DECODED: usize = 360;

/// Skylines by azimuth, of blocks of nodes.
#[derive(Debug)]
pub enum Skylines<'a> {
    Swept(Swept),
    Decoded(&'a HorizonMap),
}

/// Swept skylines of some blocks of a level.
#[derive(Debug)]
pub struct Swept {
    azimuths: usize,
    /// The blocks that are held, in rising order.
    held: Vec<usize>,
    /// `[held block][azimuth][lane]`, in steps of [`STEP_RAD`].
    samples: Vec<i16>,
}

impl Swept {
    /// Bytes that the skylines of some blocks take.
    pub fn bytes(blocks: usize, azimuths: usize) -> usize {
        2 * blocks * azimuths * LANES
    }

    /// Sweeps a level and keeps the blocks `held`, in rising order. `progress` hears of azimuths.
    pub fn new(
        face: &Face,
        level: usize,
        settings: &Settings,
        held: Vec<usize>,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Self, Error> {
        let (blocks, azimuths) = (Blocks::of(&face.levels[level]), settings.azimuths);
        let mut swept = Self { azimuths, samples: vec![0; held.len() * azimuths * LANES], held };
        let mut done = 0;
        for major in [Major::Row, Major::Column] {
            let along: Vec<usize> =
                (0..azimuths).filter(|index| Major::of(settings.direction(*index)) == major).collect();
            let search = Search::new(face, level, major, settings, None)?;
            // As many planes at a time as there are threads to sweep them.
            for azimuths in along.chunks(rayon::current_num_threads()) {
                let plane = |&azimuth: &usize| {
                    let elevations_rad = search.elevations_rad(settings.direction(azimuth))?;
                    Ok(ElevationPlane { azimuth, stride: search.receivers().stride, elevations_rad })
                };
                let planes = azimuths.par_iter().map(plane).collect::<Result<Vec<ElevationPlane>, Error>>()?;
                swept.keep(&blocks, &planes, major);
                done += azimuths.len();
                progress(done, swept.azimuths);
            }
        }
        Ok(swept)
    }

    fn keep(&mut self, blocks: &Blocks, planes: &[ElevationPlane], major: Major) {
        let of_block = |(samples, &block): (&mut [i16], &usize)| {
            for plane in planes {
                let lanes = &mut samples[plane.azimuth * LANES..(plane.azimuth + 1) * LANES];
                for (lane, sample) in lanes.iter_mut().enumerate() {
                    let [column, row] = blocks.node(block, lane);
                    *sample = (f64::from(plane.at(major, column, row)) / STEP_RAD).round() as i16;
                }
            }
        };
        self.samples.par_chunks_mut(self.azimuths * LANES).zip(&self.held).for_each(of_block);
    }
}

impl Skylines<'_> {
    pub fn azimuths(&self) -> usize {
        match self {
            Self::Swept(swept) => swept.azimuths,
            Self::Decoded(_) => DECODED,
        }
    }

    /// Elevations of a block's skylines, `[azimuth][lane]`, the first azimuth again at the end.
    pub(super) fn block(&self, blocks: &Blocks, block: usize) -> Vec<f32> {
        match self {
            Self::Swept(swept) => {
                let held = swept.held.binary_search(&block).expect("a block that was swept");
                let samples = &swept.samples[held * swept.azimuths * LANES..(held + 1) * swept.azimuths * LANES];
                samples.iter().chain(&samples[..LANES]).map(|sample| f32::from(*sample) * STEP_RAD as f32).collect()
            }
            Self::Decoded(horizons) => decoded(horizons, blocks, block),
        }
    }
}

fn decoded(horizons: &HorizonMap, blocks: &Blocks, block: usize) -> Vec<f32> {
    let towards: Vec<DVec2> = (0..=DECODED).map(|index| direction(TAU * index as f64 / DECODED as f64)).collect();
    let mut skylines = vec![0.0; towards.len() * LANES];
    for lane in 0..LANES {
        let [column, row] = blocks.node(block, lane);
        let horizon = horizons.horizon(DVec2::new(column as f64, row as f64));
        for (azimuth, towards) in towards.iter().enumerate() {
            skylines[azimuth * LANES + lane] = horizon.evaluate_towards(*towards).0 as f32;
        }
    }
    skylines
}
