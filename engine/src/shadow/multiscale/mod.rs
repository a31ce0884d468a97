//! Skylines from a multi-scale pyramid of heights (Snyder & Nowrouzezahrai 2008).
//!
//! Terrain far away is looked at through an ever coarser image of it. At scale `i`, with distances that grow by
//! `b = 2^(1/k)` a scale,
//!
//! ```text
//! d_i = b^i postings     D_i = (f_i(x + d_i φ) − f_i(x))/d_i     ω_i = elevation of the lifted slope D_i
//! ω(x, φ) = max over τ of the cubic B-spline of ω_i at τ = 0, ½, 1, 1½, …
//! ```
//!
//! `f_i` has texels of `b^(i − k o)` postings, never finer than the heights themselves: the *level step* `k` and the
//! *level offset* `o` are the method's two settings. Images are made by repeated bilinear decimation and read through
//! bicubic B-splines.
//!
//! # What differs from the paper
//! - The clamp of the offset level is a minimum, not the maximum that is printed.
//! - Skylines below the horizontal stay there: the paper's `max(ω, 0)` is wrong on a sphere.
//! - Images hold heights above the sphere; slopes are those of lifted heights, in which curvature is exact. An image of
//!   lifted heights would tend to a plane, which rises towards the map's edge.
//! - Beyond a level the next coarser one answers.
//!
//! # Assumptions
//! Everything is smoothed: a skyline is met to the width of its scale, good for sources of degrees, not for the Sun's
//! disc.
//!
//! # Twin
//! `multiscale.wgsl` finds fields of nodes on a [`device`] in `f32`: each of the three elevations within 2e-6 rad of the one
//! found here, but for samples within rounding of a level's edge. Every adapter does it; the host does it where the images of a
//! face are more than a buffer may hold. The sky's shares are found on the host, once a scene. Measured:
//! `docs/experiments/shadow_methods.md`.
//!
//! # References
//! Snyder & Nowrouzezahrai (2008), Fast soft self-shadowing on dynamic height fields, Computer Graphics Forum 27(4).

pub mod device;
mod options;

use glam::DVec2;
use rayon::prelude::*;

use device::OnDevice;
pub use options::MultiscaleOptions;

use super::device::FieldMaker;
use super::light::QuantizedLight;
use super::method::{Bench, Family, NamedMethod, ShadowMethod};
use super::skylines::{Field, SkylineSource, UnpreparedLight};
use crate::gpu::{Gpu, GpuError};
use crate::grid::{Cell, Grid2};
use crate::terrain::{Gnomonic, Level, Surface, Terrain};

pub const FAMILY: Family = Family {
    named: &[NamedMethod {
        name: "multiscale",
        bench: Bench::Slow,
        hard_cases: true,
        auto: false,
        options: || Box::new(MultiscaleOptions::default()),
    }],
    patterns: &[],
    parse: |_| None,
};

/// A point no further than this share of a posting beyond a level's edge is on it: rounding decides nothing.
const EDGE: f64 = 1e-3;

/// Images of a level's heights above the sphere, the finest first; each is `2^(1/k)` coarser than the one before.
#[derive(Debug)]
pub struct HeightPyramid {
    level_step: f64,
    images: Vec<Image>,
}

/// Heights at the middles of texels, row by row.
#[derive(Debug)]
struct Image {
    columns: usize,
    rows: usize,
    texel_m: f64,
    /// The south-west corner of the first texel.
    corner_m: DVec2,
    heights_m: Vec<f32>,
}

impl HeightPyramid {
    pub fn new(map: &Gnomonic, level: &Level, level_step: u32) -> Self {
        let height_m = |index: usize| {
            let (column, row) = (index % level.columns, index / level.columns);
            let point = level.lifted_node(column, row);
            // Above the lifted sphere; near enough the height itself, and zero where that is.
            (point.z - map.lifted_height_m(point.truncate(), map.radius_m)) as f32
        };
        let mut images = vec![Image {
            columns: level.columns,
            rows: level.rows,
            texel_m: level.posting_m,
            corner_m: level.node_m(0, 0) - 0.5 * level.posting_m,
            heights_m: (0..level.columns * level.rows).into_par_iter().map(height_m).collect(),
        }];
        let level_step = f64::from(level_step);
        while images.last().is_some_and(|image| image.columns.max(image.rows) > 1) {
            let texel_m = level.posting_m * (images.len() as f64 / level_step).exp2();
            images.push(images[images.len() - 1].decimated(texel_m, &images[0]));
        }
        Self { level_step, images }
    }

    /// Bytes of all images.
    pub fn bytes(&self) -> usize {
        self.images.iter().map(|image| size_of_val(image.heights_m.as_slice())).sum()
    }

    fn holds(&self, at_m: DVec2) -> bool {
        let Image { columns, rows, texel_m, corner_m, .. } = self.images[0];
        let from = (at_m - corner_m) / texel_m - 0.5;
        let far = DVec2::new((columns - 1) as f64, (rows - 1) as f64);
        from.cmpge(DVec2::splat(-EDGE)).all() && from.cmple(far + EDGE).all()
    }

    /// The image whose texels are nearest to a size.
    fn image(&self, texel_m: f64) -> usize {
        let index = (self.level_step * (texel_m / self.images[0].texel_m).log2()).round().max(0.0) as usize;
        index.min(self.images.len() - 1)
    }
}

impl Image {
    /// Bilinear samples of `self` at the middles of texels of `texel_m` over the extent of `finest`.
    fn decimated(&self, texel_m: f64, finest: &Image) -> Self {
        let count = |texels: usize| (texels as f64 * finest.texel_m / texel_m).ceil().max(1.0) as usize;
        let (columns, rows) = (count(finest.columns), count(finest.rows));
        let sample = |index: usize| {
            let texel = DVec2::new((index % columns) as f64, (index / columns) as f64);
            self.bilinear_m((texel + 0.5) * texel_m / self.texel_m - 0.5) as f32
        };
        let heights_m = (0..columns * rows).into_par_iter().map(sample).collect();
        Self { columns, rows, texel_m, corner_m: self.corner_m, heights_m }
    }

    fn texel_m(&self, column: f64, row: f64) -> f64 {
        let clamped = |value: f64, count: usize| value.clamp(0.0, (count - 1) as f64) as usize;
        f64::from(self.heights_m[clamped(row, self.rows) * self.columns + clamped(column, self.columns)])
    }

    fn bilinear_m(&self, grid: DVec2) -> f64 {
        let texels = Grid2::new(&self.heights_m, [self.columns, self.rows]);
        texels.bilinear(Cell::repeated(texels.size(), grid))
    }

    /// The bicubic B-spline over the texels.
    fn spline_m(&self, at_m: DVec2) -> f64 {
        let grid = (at_m - self.corner_m) / self.texel_m - 0.5;
        let low = grid.floor();
        let (x, y) = (weights(grid.x - low.x), weights(grid.y - low.y));
        let offsets = [-1.0, 0.0, 1.0, 2.0];
        let row = |dy: f64| x.iter().zip(offsets).map(|(w, dx)| w * self.texel_m(low.x + dx, low.y + dy)).sum::<f64>();
        y.iter().zip(offsets).map(|(w, dy)| w * row(dy)).sum()
    }
}

/// The four weights of a uniform cubic B-spline at `u` of 0 to 1 between the middle two.
fn weights(u: f64) -> [f64; 4] {
    let v = 1.0 - u;
    [v * v * v, 3.0 * u * u * u - 6.0 * u * u + 4.0, 3.0 * v * v * v - 6.0 * v * v + 4.0, u * u * u].map(|w| w / 6.0)
}

/// The method, ready for a terrain.
#[derive(Debug)]
pub struct Multiscale {
    /// Images in each halving of the resolution, `k`.
    pub level_step: u32,
    /// Halvings by which images are finer than their distance, `o`.
    pub level_offset: f64,
    /// Between the outer two of the three azimuths in which a light is looked for.
    pub swath_rad: f64,
    /// By face and level.
    pyramids: Vec<Vec<HeightPyramid>>,
}

/// A point of the ground with what each scale shows of it.
#[derive(Debug)]
struct Receiver<'a> {
    map: &'a Gnomonic,
    pyramids: &'a [HeightPyramid],
    at_m: DVec2,
    /// Distance, texel and lifted height of the point at each scale.
    scales: Vec<[f64; 3]>,
}

impl Multiscale {
    pub fn new(terrain: &Terrain, level_step: u32, level_offset: f64, swath_rad: f64) -> Self {
        let pyramids = terrain
            .faces
            .iter()
            .map(|face| face.levels.iter().map(|level| HeightPyramid::new(&face.map, level, level_step)).collect());
        Self { level_step, level_offset, swath_rad, pyramids: pyramids.collect() }
    }

    /// Bytes of all pyramids.
    pub fn bytes(&self) -> usize {
        self.pyramids.iter().flatten().map(HeightPyramid::bytes).sum()
    }

    /// Distance and size of texels of every scale on a level and the coarser ones around it.
    fn scales(&self, pyramids: &[HeightPyramid]) -> impl Iterator<Item = [f64; 2]> {
        let (posting_m, outermost) = (pyramids[0].images[0].texel_m, &pyramids[pyramids.len() - 1].images[0]);
        let reach_m = DVec2::new(outermost.columns as f64, outermost.rows as f64).length() * outermost.texel_m;
        let (level_step, level_offset) = (f64::from(self.level_step), self.level_offset);
        let sizes_m = (0..).map(move |scale| {
            let doublings = f64::from(scale) / level_step;
            [posting_m * doublings.exp2(), posting_m * (doublings - level_offset).max(0.0).exp2()]
        });
        sizes_m.take_while(move |[distance_m, _]| *distance_m <= reach_m)
    }

    /// Elevations of the skyline of a map point of a level in unit map directions.
    pub fn elevations_rad(
        &self,
        map: &Gnomonic,
        [face, level]: [usize; 2],
        at_m: DVec2,
        directions: impl IntoIterator<Item = DVec2>,
    ) -> Vec<f64> {
        let receiver = Receiver::new(self, map, &self.pyramids[face][level..], at_m);
        directions.into_iter().map(|towards| receiver.elevation_rad(towards)).collect()
    }
}

impl<'a> Receiver<'a> {
    fn new(method: &Multiscale, map: &'a Gnomonic, pyramids: &'a [HeightPyramid], at_m: DVec2) -> Self {
        let mut receiver = Self { map, pyramids, at_m, scales: Vec::new() };
        for [distance_m, texel_m] in method.scales(pyramids) {
            let lifted_m = receiver.lifted_m(at_m, texel_m).expect("the level holds its own point");
            receiver.scales.push([distance_m, texel_m, lifted_m]);
        }
        receiver
    }

    fn lifted_m(&self, at_m: DVec2, texel_m: f64) -> Option<f64> {
        let pyramid = self.pyramids.iter().find(|pyramid| pyramid.holds(at_m))?;
        let height_m = pyramid.images[pyramid.image(texel_m)].spline_m(at_m);
        Some(self.map.lifted_height_m(at_m, self.map.radius_m) + height_m)
    }

    fn elevation_rad(&self, towards: DVec2) -> f64 {
        let at_scale = |&[distance_m, texel_m, lifted_m]: &[f64; 3]| {
            let there_m = self.lifted_m(self.at_m + distance_m * towards, texel_m)?;
            let from = self.at_m.extend(lifted_m);
            Some(self.map.elevation_tangent(from, towards, (there_m - lifted_m) / distance_m).atan())
        };
        let elevations_rad: Vec<f64> = self.scales.iter().map_while(at_scale).collect();
        // On the very edge nothing is known but the plain.
        highest_of_spline(&elevations_rad).unwrap_or(0.0)
    }
}

/// The maximum of the cubic B-spline over some values, at them and halfway between; the ends stand for what is beyond.
fn highest_of_spline(values: &[f64]) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let at = |i: usize, offset: isize| values[i.saturating_add_signed(offset).min(last)];
    let knot = |i: usize| (at(i, -1) + 4.0 * at(i, 0) + at(i, 1)) / 6.0;
    let half = |i: usize| (at(i, -1) + 23.0 * (at(i, 0) + at(i, 1)) + at(i, 2)) / 48.0;
    (0..=last).flat_map(|i| [knot(i), half(i)]).reduce(f64::max)
}

impl ShadowMethod for Multiscale {
    fn name(&self) -> &'static str {
        "multiscale"
    }

    fn skylines(&self) -> Option<&dyn SkylineSource> {
        Some(self)
    }
}

impl SkylineSource for Multiscale {
    fn field(
        &self,
        surface: &Surface,
        face: usize,
        level: usize,
        light: &QuantizedLight,
    ) -> Result<Field, UnpreparedLight> {
        let (map, nodes) = (&surface.terrain.faces[face].map, &surface.terrain.faces[face].levels[level]);
        let [columns, rows] = nodes.seen_size();
        let half_rad = 0.5 * self.swath_rad;
        let skyline = |index: usize| {
            let point = nodes.lifted_node(index % columns + nodes.margin, index / columns + nodes.margin);
            let (towards, _) = light.from(map, point);
            // Clockwise, as azimuths go.
            let turned = |angle_rad: f64| DVec2::from_angle(-angle_rad).rotate(towards);
            let directions = [-half_rad, 0.0, half_rad].map(turned);
            let [left, middle, right]: [f64; 3] = self
                .elevations_rad(map, [face, level], point.truncate(), directions)
                .try_into()
                .expect("three directions");
            [middle as f32, ((right - left) / self.swath_rad) as f32]
        };
        Ok((0..columns * rows).into_par_iter().map(skyline).collect())
    }

    fn on_device(&self, gpu: &Gpu, surface: &Surface) -> Result<Option<Box<dyn FieldMaker>>, GpuError> {
        let device = OnDevice::new(gpu, self, &surface.terrain)?;
        Ok(device.map(|device| Box::new(device) as Box<dyn FieldMaker>))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spline_of_equal_values_is_that_value_and_its_weights_sum_to_one() {
        assert_eq!(highest_of_spline(&[]), None);
        assert!((highest_of_spline(&[0.3; 7]).unwrap() - 0.3).abs() < 1e-15);
        for u in [0.0, 0.2, 0.5, 1.0] {
            assert!((weights(u).iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn a_peak_at_one_scale_keeps_two_thirds_of_its_height() {
        let mut values = [0.0; 9];
        values[4] = 0.9;
        assert!((highest_of_spline(&values).unwrap() - 0.6).abs() < 1e-15);
    }
}
