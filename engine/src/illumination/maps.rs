//! Illumination of every node of a level.
//!
//! Nodes are taken in square blocks (`kernel`); strips of them run side by side.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::blocks::Blocks;
use super::kernel::{LitStep, Sums, Task};
use super::lit::{DiscShare, Lit};
use super::series::{Series, Totals};
use super::skylines::Skylines;
use super::track::{Seen, Track};
use crate::photometry::SolarDisk;
use crate::terrain::{Face, Gnomonic, Level};

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

/// What shapes the maps of a level.
#[derive(Debug, Clone, Copy)]
pub struct Study<'a> {
    pub face: &'a Face,
    pub level: usize,
    pub skylines: &'a Skylines<'a>,
    pub track: &'a Track,
    pub disk: &'a SolarDisk,
    pub lit: Lit,
    /// The nodes of areas. Where there are any, what lies outside them all is not mapped.
    pub areas: &'a [Vec<bool>],
}

/// The blocks that a level's maps need.
pub fn needed_blocks(level: &Level, areas: &[Vec<bool>]) -> Vec<usize> {
    let blocks = Blocks::of(level);
    if areas.is_empty() {
        return (0..blocks.count()).collect();
    }
    blocks.holding(&(0..blocks.nodes()).map(|node| areas.iter().any(|area| area[node])).collect::<Vec<_>>())
}

impl Study<'_> {
    /// The maps, and a series for each area. `progress` hears of strips of blocks.
    pub fn run(&self, progress: &(dyn Fn(usize, usize) + Sync)) -> (Maps, Vec<Series>) {
        let Self { face, level, track, areas, .. } = *self;
        let nodes = &face.levels[level];
        let blocks = Blocks::of(nodes);
        let task = Task {
            map: &face.map,
            nodes,
            blocks,
            skylines: self.skylines,
            areas,
            sun: in_map(&face.map, &track.sun),
            earth: in_map(&face.map, &track.earth),
            disc: DiscShare::new(self.disk),
            lit: track
                .sunlight
                .iter()
                .map(|&sunlight| LitStep {
                    sunlight: sunlight as f32,
                    threshold: self.lit.threshold(self.disk, sunlight) as f32,
                })
                .collect(),
        };
        // A strip's series is summed in the order of its blocks, the strips' in theirs: the same whatever the threads.
        let needed = needed_blocks(nodes, areas);
        let strips: Vec<&[usize]> = needed.chunk_by(|a, b| a / blocks.across() == b / blocks.across()).collect();
        let done = AtomicUsize::new(0);
        let strip = |held: &&[usize]| {
            let mut totals = vec![Totals::new(track.steps()); areas.len()];
            let sums: Vec<(usize, Sums)> = held.iter().map(|&block| (block, task.block(block, &mut totals))).collect();
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, strips.len());
            (sums, totals)
        };
        let (sums, totals): (Vec<_>, Vec<_>) = strips.par_iter().map(strip).unzip();
        let mut by_block: Vec<Option<Sums>> = (0..blocks.count()).map(|_| None).collect();
        sums.into_iter().flatten().for_each(|(block, sums)| by_block[block] = Some(sums));
        let series = |(index, area): (usize, &Vec<bool>)| {
            let count = area.iter().filter(|counts| **counts).count() as f64;
            Totals::series(totals.iter().map(|totals| &totals[index]), track.steps(), count)
        };
        (self.maps(&blocks, &by_block), areas.iter().enumerate().map(series).collect())
    }

    /// Which of the seen nodes are mapped: those with heights, in an area where there are any.
    pub fn mapped(&self) -> Vec<bool> {
        let nodes = &self.face.levels[self.level];
        let blocks = Blocks::of(nodes);
        let mapped = |node: usize| {
            let [column, row] = [node % blocks.columns, node / blocks.columns].map(|index| index + nodes.margin);
            let inside = self.areas.is_empty() || self.areas.iter().any(|area| area[node]);
            inside && !nodes.gap[nodes.index(column, row)]
        };
        (0..blocks.nodes()).map(mapped).collect()
    }

    fn maps(&self, blocks: &Blocks, sums: &[Option<Sums>]) -> Maps {
        let mapped = self.mapped();
        let plane = |of: &dyn Fn(&Sums, usize) -> f32| {
            let value = |node: usize| {
                let (block, lane) = blocks.lane(node);
                sums[block].as_ref().filter(|_| mapped[node]).map_or(f32::NAN, |sums| of(sums, lane))
            };
            (0..blocks.nodes()).map(value).collect()
        };
        let (steps, step_h) = (self.track.steps() as f32, self.track.step_h() as f32);
        Maps {
            columns: blocks.columns,
            rows: blocks.rows,
            lit_share: plane(&|sums, lane| sums.lit[lane] / steps),
            disc_share: plane(&|sums, lane| sums.share[lane] / steps),
            longest_night_h: plane(&|sums, lane| sums.longest[lane] * step_h),
            earth_share: plane(&|sums, lane| sums.earth[lane] / steps),
        }
    }
}

fn in_map(map: &Gnomonic, seen: &[Seen]) -> Vec<Seen> {
    seen.iter().map(|seen| Seen { towards: map.map_from_body.turn(seen.towards), ..*seen }).collect()
}
