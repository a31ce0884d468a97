//! The error of a tile against traced horizons.

use glam::DVec2;
use rayon::prelude::*;

use super::axis::Major;
use super::elevation_plane::ElevationPlane;
use super::pack::HorizonMap;
use super::settings::Settings;
use super::statistics::{BoundStatistics, ErrorStatistics, TileErrors};
use super::trace::Tracer;
use crate::terrain::{Face, Level, Pyramid};

/// The swept profiles of some pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    azimuths: usize,
    /// (column, row) in the seen part.
    pub pixels: Vec<[usize; 2]>,
    /// `[pixel][azimuth]`.
    pub elevations_rad: Vec<f32>,
}

impl Sample {
    /// About `count` pixels spread evenly over the seen part of a level, gaps left out.
    pub fn of(level: &Level, count: usize, azimuths: usize) -> Self {
        let [columns, rows] = level.seen_size();
        // The additive recurrence of the plastic number fills a square evenly (Roberts 2018).
        let plastic = 1.324_717_957_244_746;
        let spread = |i: usize| {
            let spread_over = |step: f64, nodes: usize| ((0.5 + i as f64 * step).fract() * nodes as f64) as usize;
            [spread_over(1.0 / plastic, columns), spread_over(1.0 / (plastic * plastic), rows)]
        };
        let known = |[column, row]: &[usize; 2]| !level.gap[level.index(column + level.margin, row + level.margin)];
        let pixels: Vec<_> = (0..count).map(spread).filter(known).collect();
        Self { azimuths, elevations_rad: vec![0.0; pixels.len() * azimuths], pixels }
    }

    /// Keeps what a plane along `major` says about the sampled pixels.
    pub fn keep(&mut self, plane: &ElevationPlane, major: Major) {
        for (i, [column, row]) in self.pixels.iter().enumerate() {
            self.elevations_rad[i * self.azimuths + plane.azimuth] = plane.at(major, *column, *row);
        }
    }
}

/// Errors against traced horizons at the sampled pixels, `[pixel][azimuth]`. Where the settings have a band, elevations beyond it
/// count as its ends.
#[derive(Debug)]
pub struct Measured {
    pub swept_rad: Vec<Vec<f64>>,
    pub decoded_rad: Vec<Vec<f64>>,
}

impl Measured {
    pub fn statistics(&self, bound: BoundStatistics) -> TileErrors {
        let of = |errors_rad: &[Vec<f64>]| ErrorStatistics::of(errors_rad.iter().flatten().copied());
        let [swept, decoded] = [&self.swept_rad, &self.decoded_rad].map(|errors_rad| of(errors_rad));
        TileErrors { pixels: self.decoded_rad.len(), swept, decoded, bound }
    }
}

/// Errors of swept profiles and of the map's decoded series.
pub fn measure(face: &Face, level: usize, settings: &Settings, sample: &Sample, map: &HorizonMap) -> Measured {
    let nodes = &face.levels[level];
    let pyramids: Vec<_> = face.levels[level..].iter().map(Pyramid::new).collect();
    let tracer = Tracer::without_finer(face, level, settings).with_pyramids(&pyramids);
    let errors = |(i, [column, row]): (usize, &[usize; 2])| {
        let foot = nodes.lifted_node(column + nodes.margin, row + nodes.margin);
        let series = map.horizon(DVec2::new(*column as f64, *row as f64));
        let relevant = |elevation_rad| settings.relevant_rad(&face.map, foot.truncate(), elevation_rad);
        let swept = &sample.elevations_rad[i * settings.azimuths..(i + 1) * settings.azimuths];
        let error = |azimuth: usize| {
            let direction = settings.direction(azimuth);
            let traced_rad = relevant(tracer.skyline(foot, direction).elevation_rad);
            let decoded_rad = relevant(series.evaluate_towards(direction).0);
            (f64::from(swept[azimuth]) - traced_rad, decoded_rad - traced_rad)
        };
        (0..settings.azimuths).map(error).unzip()
    };
    let (swept_rad, decoded_rad) = sample.pixels.par_iter().enumerate().map(errors).unzip();
    Measured { swept_rad, decoded_rad }
}
