//! Illumination of a block of nodes: its skylines by azimuth stay in the cache while the whole track passes over them.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::blocks::{BLOCK, Blocks, LANES};
use super::lit::DiscShare;
use super::series::Totals;
use super::skylines::Skylines;
use super::track::Seen;
use crate::horizon::wide::wide;
use crate::terrain::{Gnomonic, Level};

/// What all blocks share; directions in map axes.
pub struct Task<'a> {
    pub map: &'a Gnomonic,
    pub nodes: &'a Level,
    pub blocks: Blocks,
    pub skylines: &'a Skylines<'a>,
    pub areas: &'a [Vec<bool>],
    pub sun: Vec<Seen>,
    pub earth: Vec<Seen>,
    pub disc: DiscShare,
    /// By step.
    pub lit: Vec<LitStep>,
}

/// What a step's light takes to count.
#[derive(Clone, Copy)]
pub struct LitStep {
    /// Share of the Sun's light that the Earth leaves.
    pub sunlight: f32,
    /// Solar radii that the disc's centre must stand above the skyline.
    pub threshold: f32,
}

/// Counts of steps of a block's nodes.
pub struct Sums {
    pub lit: Vec<f32>,
    pub share: Vec<f32>,
    dark: Vec<f32>,
    pub longest: Vec<f32>,
    pub earth: Vec<f32>,
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
    pub fn block(&self, block: usize, totals: &mut [Totals]) -> Sums {
        let skylines = self.skylines.block(&self.blocks, block);
        let zeros = || vec![0.0; LANES];
        let mut sums = Sums { lit: zeros(), share: zeros(), dark: zeros(), longest: zeros(), earth: zeros() };
        let here: Vec<(usize, Vec<f32>)> = self.areas_of(block).collect();
        let first = DVec2::from(self.blocks.first(block).map(|index| index as f64));
        for (step, (sun, earth)) in self.sun.iter().zip(&self.earth).enumerate() {
            let (above, radius_rad) = (self.above(first, sun.towards), sun.angular_radius_rad as f32);
            let (earth, lit) = (self.above(first, earth.towards), self.lit[step]);
            wide(
                #[inline(always)]
                || {
                    self.add_sun(&skylines, &above, 1.0 / radius_rad, lit, &mut sums);
                    add_earth(&skylines, &earth, &mut sums.earth);
                    for (area, counts) in &here {
                        let total = self.total(&skylines, [&above, &earth], 1.0 / radius_rad, lit, counts);
                        totals[*area].0.iter_mut().zip(total).for_each(|(sums, more)| sums[step] += f64::from(more));
                    }
                },
            );
        }
        sums
    }

    /// The areas that a block has a part in, with 1 for a lane that counts and 0 for another.
    fn areas_of(&self, block: usize) -> impl Iterator<Item = (usize, Vec<f32>)> {
        let [column, row] = self.blocks.first(block);
        self.areas.iter().enumerate().filter_map(move |(index, area)| {
            let counts = |lane: usize| {
                let (column, row) = (column + lane % BLOCK, row + lane / BLOCK);
                let inside = column < self.blocks.columns && row < self.blocks.rows;
                f32::from(u8::from(inside && area[row * self.blocks.columns + column]))
            };
            let counts: Vec<f32> = (0..LANES).map(counts).collect();
            counts.iter().any(|count| *count > 0.0).then_some((index, counts))
        })
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
        let azimuths = self.skylines.azimuths();
        let turns = d.x.atan2(d.y).rem_euclid(TAU) / TAU * azimuths as f64;
        let azimuth = (turns as usize).min(azimuths - 1);
        Above {
            azimuth,
            share: (turns - azimuth as f64) as f32,
            elevation_rad: (elevation_rad(middle) - half * (by_column + by_row)) as f32,
            by_column: by_column as f32,
            by_row: by_row as f32,
        }
    }

    /// Sums over the lanes that count: lit, share of the disc, Earth in sight.
    #[inline(always)]
    fn total(
        &self,
        skylines: &[f32],
        [sun, earth]: [&Above; 2],
        inverse_radius: f32,
        lit: LitStep,
        counts: &[f32],
    ) -> [f32; 3] {
        let mut total = [[0.0_f32; BLOCK]; 3];
        for row in 0..BLOCK {
            let (over, beside) = (sun.clearances(skylines, row), earth.clearances(skylines, row));
            let counts = &counts[row * BLOCK..(row + 1) * BLOCK];
            for i in 0..BLOCK {
                let radii = over[i] * inverse_radius;
                total[0][i] += if radii > lit.threshold { counts[i] } else { 0.0 };
                total[1][i] += counts[i] * lit.sunlight * self.disc.at(radii);
                total[2][i] += if beside[i] > 0.0 { counts[i] } else { 0.0 };
            }
        }
        total.map(|lanes| lanes.iter().sum())
    }

    #[inline(always)]
    fn add_sun(&self, skylines: &[f32], above: &Above, inverse_radius: f32, step: LitStep, sums: &mut Sums) {
        for row in 0..BLOCK {
            let lanes = row * BLOCK..(row + 1) * BLOCK;
            let clearances: [f32; BLOCK] = above.clearances(skylines, row);
            let (lit, share) = (&mut sums.lit[lanes.clone()], &mut sums.share[lanes.clone()]);
            let (dark, longest) = (&mut sums.dark[lanes.clone()], &mut sums.longest[lanes]);
            for i in 0..BLOCK {
                let radii = clearances[i] * inverse_radius;
                let is_lit = if radii > step.threshold { 1.0 } else { 0.0 };
                lit[i] += is_lit;
                share[i] += step.sunlight * self.disc.at(radii);
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
