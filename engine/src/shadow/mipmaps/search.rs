//! Soft shadows by dynamic programming over maximum mipmaps (Jung, Schrempf & Son 2020).
//!
//! Along the ray towards the light a *run* of `N'` mips looks for the place where the terrain comes closest to it. It
//! begins with the interval of length `T`. All blocks of a mip under the interval are compared (three, where the grid
//! does not change), the interval becomes the ray's way over the best of them, and the search goes on one mip finer:
//!
//! ```text
//! T = 2^(N'−1) postings     m = N' − 1, …, 1, 0
//! cost = least height H(t) − max h_m of the ray over the block
//! ```
//!
//! At mip 0 the surface itself is read. The next run begins where the last one ended; the steepest line of sight of
//! all runs is the skyline, level across the disc (the paper's prism). `{5, 5, 5}` looks 48 postings far. Where the
//! terrain does not change across the ray a run finds its skyline exactly.
//!
//! # What differs from the paper
//! - Heights are lifted: rays are straight and curvature is in them, so no step divides by a sphere.
//! - Blocks are visited by their footprint on the ray, as its section "Texel traversal" asks. The three points half a
//!   block apart of its Algorithm 1 miss blocks: holes of light in the umbra of a plain step.
//! - The share of the disc is the disc integral of the whole program; equations 6 and 7 as printed cannot be right
//!   (`d` leaves [−1, 1], and the segment is the lit one).
//! - The first run begins one posting away: at `t = 0` every ray touches the ground.
//! - Beyond a level's edge the next coarser one answers, by the mip whose blocks are not larger; beyond all runs lies the
//!   bare sphere. Of a cube only the face of the point is looked at.
//!
//! # Assumptions
//! A block's maximum may lie beside the ray, and the search never turns back: it finds too low a skyline, never too high
//! a one (figures: `docs/experiments/shadow_methods.md`). Blocks are counted from the level's corner, so
//! that terrain turned about its middle is searched through other blocks, and another image comes out
//! (`tests/reference/render/methods.rs`): the two hard cases that runs fail, a wall seen past the corner of its block and a pole
//! after a quarter turn, are of the method, which is to search each block once. Filled gaps occlude as the surface that
//! fills them.
//!
//! `mipmaps.wgsl` is the twin for devices.
//!
//! # References
//! Jung, Schrempf & Son (2020), Optimally fast soft shadows on curved terrain with dynamic programming and maximum mipmaps.

use std::borrow::Cow;

use glam::{DVec2, DVec3};

use crate::photometry::{DiskLight, HorizonLine};
use crate::shadow::site::{Disc, Shadow, Site};
use crate::shadow::skylines::line;
use crate::terrain::{Level, Pyramid, Surface, Terrain};

/// How runs go.
#[derive(Debug, Clone, PartialEq)]
pub struct Mipmaps {
    /// Mips `N'` of each run, the nearest run first: at most [`Self::RUNS`] of [`Self::MIPS`] each.
    pub runs: Vec<u32>,
    /// Even steps along the ray in their place, the baseline of the paper.
    steps: Option<Steps>,
}

/// Heights are read at `spacing, 2 spacing, … count spacing` postings.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Steps {
    count: u32,
    spacing: f64,
}

/// Room for rounding where a size is a power of two of a posting.
const MIP_SLACK: f64 = 1e-3;

/// How far inside a block its corners are passed by, in blocks: f32 cannot tell them apart.
const NUDGE: f64 = 4e-3;

/// Blocks under an interval, at most: three, and more where a coarser level has smaller ones.
const BLOCKS: usize = 8;

/// Squared length of a light's map direction below which it stands in the zenith.
const ZENITH: f64 = 1e-12;

impl Mipmaps {
    pub const RUNS: usize = 16;
    pub const MIPS: u32 = 15;

    /// Runs of so many mips each.
    pub fn of(runs: &[u32]) -> Self {
        Self { runs: runs.to_vec(), steps: None }
    }

    /// No runs but uniform stepping, which the paper compares with: so many steps of so many postings.
    pub fn uniform(count: u32, spacing: f64) -> Self {
        Self { runs: Vec::new(), steps: Some(Steps { count, spacing }) }
    }

    /// Runs of doubling length after the first two, as far as the terrain reaches from its finest level.
    pub fn reaching(terrain: &Terrain) -> Self {
        let reach = |levels: &[Level]| {
            let (finest, outermost) = (levels.first()?, levels.last()?);
            let (low, high) = outermost.seen_m();
            Some((high - low).length() / finest.posting_m)
        };
        let reach = terrain.faces.iter().filter_map(|face| reach(&face.levels)).fold(0.0, f64::max);
        let mut runs = vec![5, 5];
        let mut reached = 32.0;
        while reached < reach && runs[runs.len() - 1] < Self::MIPS {
            let mips = runs[runs.len() - 1] + 1;
            reached += f64::from(1u32 << (mips - 1));
            runs.push(mips);
        }
        Self { runs, steps: None }
    }

    /// The `override` values of `mipmaps.wgsl`: four bits a run.
    pub fn constants(&self) -> [(&'static str, f64); 4] {
        let packed = |runs: &[u32]| {
            let bits = runs.iter().zip((0..).step_by(4)).map(|(mips, shift)| mips << shift);
            f64::from(bits.fold(0, |all, run| all | run))
        };
        let (first, second) = self.runs.split_at(self.runs.len().min(Self::RUNS / 2));
        let Steps { count, spacing } = self.steps.unwrap_or(Steps { count: 0, spacing: 1.0 });
        [
            ("MIPMAP_RUNS_1", packed(first)),
            ("MIPMAP_RUNS_2", packed(second)),
            ("UNIFORM_STEPS", f64::from(count)),
            ("UNIFORM_SPACING", spacing),
        ]
    }
}

/// Searches runs anew for each site.
#[derive(Debug)]
pub struct MipmapRuns<'a> {
    method: &'a Mipmaps,
    /// The seen parts of all levels, by face.
    ground: Vec<Vec<Seen<'a>>>,
}

#[derive(Debug)]
struct Seen<'a> {
    level: Cow<'a, Level>,
    pyramid: Cow<'a, Pyramid>,
}

impl<'a> MipmapRuns<'a> {
    pub fn new(surface: &'a Surface, method: &'a Mipmaps) -> Self {
        let seen = |(level, pyramid): (&'a Level, &'a Pyramid)| {
            if level.margin == 0 {
                return Seen { level: Cow::Borrowed(level), pyramid: Cow::Borrowed(pyramid) };
            }
            let level = level.seen();
            Seen { pyramid: Cow::Owned(Pyramid::new(&level)), level: Cow::Owned(level) }
        };
        let faces = surface.terrain.faces.iter().zip(&surface.pyramids);
        let ground = faces.map(|(face, pyramids)| face.levels.iter().zip(pyramids).map(seen).collect()).collect();
        Self { method, ground }
    }

    /// The steepest line of sight that the runs find from a lifted point; `light_slope` is that of the ray.
    fn slope(&self, levels: &[Seen], from: DVec3, towards: DVec2, light_slope: f64) -> f64 {
        let posting_m = levels[0].level.posting_m;
        let mut steepest = f64::NEG_INFINITY;
        let mut start_m = posting_m;
        for &mips in &self.method.runs {
            let end_m = start_m + posting_m * f64::from(1u32 << (mips - 1));
            let whole = Way { ends_m: [start_m, end_m], slopes: [f64::NEG_INFINITY; 2] };
            let found = (0..mips).rev().try_fold(whole, |way, mip| {
                let size_m = posting_m * f64::from(1u32 << mip);
                let cost = |way: &Way| way.clearance_m(light_slope);
                // The first of equals, as on the device.
                let ways = ways(levels, from, towards, way.ends_m, size_m).into_iter();
                ways.map(|way| (cost(&way), way)).reduce(|a, b| if b.0 < a.0 { b } else { a }).map(|(_, way)| way)
            });
            steepest = steepest.max(found.map_or(f64::NEG_INFINITY, |way| way.steepest()));
            start_m = end_m;
        }
        let steps = self.method.steps.iter().flat_map(|steps| (1..=steps.count).map(|i| f64::from(i) * steps.spacing));
        let slope = |step: f64| {
            let at_m = step * posting_m;
            let there_m = from.truncate() + at_m * towards;
            let level = &levels.iter().find(|seen| seen.level.sees(there_m))?.level;
            Some((level.bilinear_m(level.grid_from_map(there_m))? - from.z) / at_m)
        };
        steps.map_while(slope).fold(steepest, f64::max)
    }
}

/// The ray's way over a block: its ends, and the slopes of the lines of sight to the block's height there.
#[derive(Debug, Clone, Copy)]
struct Way {
    ends_m: [f64; 2],
    slopes: [f64; 2],
}

impl Way {
    fn steepest(&self) -> f64 {
        self.slopes[0].max(self.slopes[1])
    }

    /// The least height above the block of a ray of a slope.
    fn clearance_m(&self, light_slope: f64) -> f64 {
        let [near_m, far_m] = [0, 1].map(|end| (light_slope - self.slopes[end]) * self.ends_m[end]);
        near_m.min(far_m)
    }
}

/// The ways over all blocks of `size_m` between two distances; none beyond the terrain's end.
fn ways(levels: &[Seen], from: DVec3, towards: DVec2, [start_m, end_m]: [f64; 2], size_m: f64) -> Vec<Way> {
    let nudge_m = NUDGE * size_m;
    let mut ways = Vec::new();
    let mut at_m = start_m;
    while at_m < end_m - nudge_m && ways.len() < BLOCKS {
        let inside_m = from.truncate() + (at_m + nudge_m) * towards;
        let Some(Seen { level, pyramid }) = levels.iter().find(|seen| seen.level.sees(inside_m)) else { break };
        let mip = ((size_m / level.posting_m).log2() + MIP_SLACK).floor().max(0.0) as usize;
        let mip = mip.min(pyramid.mips.len() - 1);
        let (start, rate) = (level.grid_from_map(from.truncate()), towards / level.posting_m);
        let (inside, far) = (level.grid_from_map(inside_m), DVec2::new(level.columns as f64, level.rows as f64) - 1.0);
        let exit_m = |axis: usize| {
            let block = inside[axis] / (1u32 << mip) as f64;
            let line = if rate[axis] > 0.0 { block.floor() + 1.0 } else { block.ceil() - 1.0 };
            let line = (line * (1u32 << mip) as f64).clamp(0.0, far[axis]);
            if rate[axis] == 0.0 { f64::INFINITY } else { (line - start[axis]) / rate[axis] }
        };
        let next_m = exit_m(0).min(exit_m(1)).min(end_m).max(at_m + nudge_m);
        let ends_m = [at_m, next_m];
        let heights_m = if mip == 0 {
            ends_m.map(|at_m| level.bilinear_m((start + at_m * rate).clamp(DVec2::ZERO, far)).unwrap_or(f64::NAN))
        } else {
            let blocks = &pyramid.mips[mip];
            let index = |at: f64, cells: f64| (at.min(cells - 1.0) as usize) >> mip;
            [f64::from(blocks.maxima_m[index(inside.y, far.y) * blocks.columns + index(inside.x, far.x)]); 2]
        };
        ways.push(Way { ends_m, slopes: [0, 1].map(|end| (heights_m[end] - from.z) / ends_m[end]) });
        at_m = next_m;
    }
    ways
}

impl Shadow for MipmapRuns<'_> {
    fn light(&self, site: &Site, disc: &Disc) -> DiskLight {
        let (map, at_m) = (site.map, site.lifted.truncate());
        let towards = map.map_direction(at_m, disc.axes.sun);
        if towards.length_squared() < ZENITH {
            return disc.disk.light(HorizonLine::NONE, disc.facet);
        }
        let towards = towards.normalize();
        let sine = map.up(at_m).unit().dot(disc.axes.sun.unit()).clamp(-1.0, 1.0);
        // The tangent is affine in the slope.
        let [level, one] = [0.0, 1.0].map(|slope| map.elevation_tangent(site.lifted, towards, slope));
        let light_slope = (sine.asin().tan() - level) / (one - level);
        let slope = self.slope(&self.ground[site.face][site.level..], site.lifted, towards, light_slope);
        let (x, h) = (at_m / map.radius_m, site.lifted.z / map.radius_m);
        // r²/R² − 1 of the site; below the sphere the plain through its feet.
        let above = ((x.length_squared() + h * (2.0 - h)) / ((1.0 - h) * (1.0 - h))).max(0.0);
        let tangent = (level + (one - level) * slope).max(-above.sqrt());
        line(site, disc, tangent.atan(), 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_packed_in_four_bits_each() {
        let method = Mipmaps::of(&[5, 5, 5, 3, 1, 1, 1, 1, 15]);
        assert_eq!(method.constants().map(|(_, value)| value), [f64::from(0x1111_3555), 15.0, 0.0, 1.0]);
    }
}
