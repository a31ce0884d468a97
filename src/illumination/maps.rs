//! Illumination of every node of a level.
//!
//! Nodes are taken in square blocks: their skylines by azimuth stay in the cache while the whole track passes over
//! them.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::lit::{DiscShare, Lit};
use super::track::{Seen, Track};
use crate::horizon::HorizonMap;
use crate::horizon::settings::direction;
use crate::horizon::sweep::wide::wide;
use crate::photometry::SolarDisk;
use crate::terrain::{Face, Gnomonic, Level};

/// Nodes along a block's side.
pub const BLOCK: usize = 32;
const LANES: usize = BLOCK * BLOCK;

/// Skylines are looked up this many to the turn and interpolated between.
const AZIMUTHS: usize = 360;

/// Maps of the seen nodes of a level, row by row, rows up the map; NaN in gaps.
#[derive(Debug, Clone, PartialEq)]
pub struct Maps {
    pub columns: usize,
    pub rows: usize,
    /// Share of the steps at which a node is lit.
    pub lit_share: Vec<f32>,
    /// Mean share of the Sun's light that is seen.
    pub disc_share: Vec<f32>,
    /// Longest time without light, in hours; it may go on before the first step or after the last one.
    pub longest_night_h: Vec<f32>,
    /// Share of the steps at which the Earth's centre is seen.
    pub earth_share: Vec<f32>,
}

/// Illumination of a level by its horizon map over a track. `progress` hears of rows of blocks.
pub fn maps(
    face: &Face,
    level: usize,
    horizons: &HorizonMap,
    track: &Track,
    disk: &SolarDisk,
    lit: Lit,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Maps {
    let nodes = &face.levels[level];
    let (columns, rows) = (horizons.columns, horizons.rows);
    let task = Task {
        map: &face.map,
        nodes,
        horizons,
        sun: in_map(&face.map, &track.sun),
        earth: in_map(&face.map, &track.earth),
        disc: DiscShare::new(disk),
        threshold: lit.threshold(disk) as f32,
    };
    let strips = rows.div_ceil(BLOCK);
    let done = std::sync::atomic::AtomicUsize::new(0);
    let strip = |strip: usize| {
        let blocks: Vec<Sums> = (0..columns.div_ceil(BLOCK)).map(|block| task.block(block, strip)).collect();
        progress(done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1, strips);
        blocks
    };
    let strips: Vec<Vec<Sums>> = (0..strips).into_par_iter().map(strip).collect();
    let steps = track.steps() as f32;
    let plane = |of: &dyn Fn(&Sums, usize) -> f32| {
        let node = |index: usize| {
            let (column, row) = (index % columns, index / columns);
            if nodes.gap[nodes.index(column + nodes.margin, row + nodes.margin)] {
                return f32::NAN;
            }
            of(&strips[row / BLOCK][column / BLOCK], row % BLOCK * BLOCK + column % BLOCK)
        };
        (0..columns * rows).map(node).collect()
    };
    let step_h = track.step_h() as f32;
    Maps {
        columns,
        rows,
        lit_share: plane(&|sums, lane| sums.lit[lane] / steps),
        disc_share: plane(&|sums, lane| sums.share[lane] / steps),
        longest_night_h: plane(&|sums, lane| sums.longest[lane] * step_h),
        earth_share: plane(&|sums, lane| sums.earth[lane] / steps),
    }
}

fn in_map(map: &Gnomonic, seen: &[Seen]) -> Vec<Seen> {
    seen.iter().map(|seen| Seen { towards: map.map_from_body.turn(seen.towards), ..*seen }).collect()
}

/// What all blocks share; directions in map axes.
struct Task<'a> {
    map: &'a Gnomonic,
    nodes: &'a Level,
    horizons: &'a HorizonMap,
    sun: Vec<Seen>,
    earth: Vec<Seen>,
    disc: DiscShare,
    threshold: f32,
}

/// Counts of steps of a block's nodes.
struct Sums {
    lit: Vec<f32>,
    share: Vec<f32>,
    dark: Vec<f32>,
    longest: Vec<f32>,
    earth: Vec<f32>,
}

/// A disc over a block: between which two azimuths of the skylines, and its elevation as a plane over the nodes.
struct Above {
    azimuth: usize,
    share: f32,
    elevation_rad: f32,
    by_column: f32,
    by_row: f32,
}

impl Task<'_> {
    fn block(&self, column: usize, row: usize) -> Sums {
        let skylines = self.skylines(column * BLOCK, row * BLOCK);
        let zeros = || vec![0.0; LANES];
        let mut sums = Sums { lit: zeros(), share: zeros(), dark: zeros(), longest: zeros(), earth: zeros() };
        let first = DVec2::new((column * BLOCK) as f64, (row * BLOCK) as f64);
        for (sun, earth) in self.sun.iter().zip(&self.earth) {
            let (above, radius_rad) = (self.above(first, sun.towards), sun.angular_radius_rad as f32);
            let earth = self.above(first, earth.towards);
            wide(
                #[inline(always)]
                || {
                    self.add_sun(&skylines, &above, 1.0 / radius_rad, &mut sums);
                    add_earth(&skylines, &earth, &mut sums.earth);
                },
            );
        }
        sums
    }

    /// Elevations of a block's skylines, `[azimuth][node]`, the first azimuth again at the end. Nodes beyond the map
    /// repeat its edge.
    fn skylines(&self, column: usize, row: usize) -> Vec<f32> {
        let mut skylines = vec![0.0; (AZIMUTHS + 1) * LANES];
        for lane in 0..LANES {
            let at = |first: usize, lane: usize, nodes: usize| (first + lane).min(nodes - 1) as f64;
            let grid =
                DVec2::new(at(column, lane % BLOCK, self.horizons.columns), at(row, lane / BLOCK, self.horizons.rows));
            let series = self.horizons.horizon(grid);
            for azimuth in 0..=AZIMUTHS {
                let towards = direction(TAU * azimuth as f64 / AZIMUTHS as f64);
                skylines[azimuth * LANES + lane] = series.evaluate_towards(towards).0 as f32;
            }
        }
        skylines
    }

    fn above(&self, first: DVec2, towards: DVec3) -> Above {
        let half = 0.5 * (BLOCK - 1) as f64;
        let at_m = |grid: DVec2| self.nodes.map_from_grid(grid + self.nodes.margin as f64);
        let elevation_rad = |grid: DVec2| self.map.up(at_m(grid)).unit().dot(towards).clamp(-1.0, 1.0).asin();
        let middle = first + half;
        let slope =
            |along: DVec2| (elevation_rad(middle + half * along) - elevation_rad(middle - half * along)) / (2.0 * half);
        let [by_column, by_row] = [DVec2::X, DVec2::Y].map(slope);
        let d = towards.truncate() - at_m(middle) * (towards.z / self.map.radius_m);
        let turns = d.x.atan2(d.y).rem_euclid(TAU) / TAU * AZIMUTHS as f64;
        let azimuth = (turns as usize).min(AZIMUTHS - 1);
        Above {
            azimuth,
            share: (turns - azimuth as f64) as f32,
            elevation_rad: (elevation_rad(middle) - half * (by_column + by_row)) as f32,
            by_column: by_column as f32,
            by_row: by_row as f32,
        }
    }

    #[inline(always)]
    fn add_sun(&self, skylines: &[f32], above: &Above, inverse_radius: f32, sums: &mut Sums) {
        for row in 0..BLOCK {
            let lanes = row * BLOCK..(row + 1) * BLOCK;
            let clearances: [f32; BLOCK] = above.clearances(skylines, row);
            let (lit, share) = (&mut sums.lit[lanes.clone()], &mut sums.share[lanes.clone()]);
            let (dark, longest) = (&mut sums.dark[lanes.clone()], &mut sums.longest[lanes]);
            for i in 0..BLOCK {
                let radii = clearances[i] * inverse_radius;
                let is_lit = if radii > self.threshold { 1.0 } else { 0.0 };
                lit[i] += is_lit;
                share[i] += self.disc.at(radii);
                dark[i] = (dark[i] + 1.0) * (1.0 - is_lit);
                longest[i] = if dark[i] > longest[i] { dark[i] } else { longest[i] };
            }
        }
    }
}

#[inline(always)]
fn add_earth(skylines: &[f32], above: &Above, seen: &mut [f32]) {
    for row in 0..BLOCK {
        let clearances: [f32; BLOCK] = above.clearances(skylines, row);
        for (seen, clearance) in seen[row * BLOCK..(row + 1) * BLOCK].iter_mut().zip(clearances) {
            *seen += if clearance > 0.0 { 1.0 } else { 0.0 };
        }
    }
}

impl Above {
    /// Elevation of the disc's centre above the skyline for a row of nodes.
    #[inline(always)]
    fn clearances(&self, skylines: &[f32], row: usize) -> [f32; BLOCK] {
        let start = self.azimuth * LANES + row * BLOCK;
        let low: &[f32; BLOCK] = skylines[start..].first_chunk().expect("a row");
        let high: &[f32; BLOCK] = skylines[start + LANES..].first_chunk().expect("a row");
        let elevation_rad = self.elevation_rad + self.by_row * row as f32;
        std::array::from_fn(|i| elevation_rad + self.by_column * i as f32 - (low[i] + self.share * (high[i] - low[i])))
    }
}
