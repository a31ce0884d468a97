//! How the light of one point is spread over the pixels.
//!
//! A ray stands for its share of a pixel's light, `1/n²` with `n × n` rays a pixel. Each pixel gets of it what the spread
//! puts inside the pixel's square:
//!
//! ```text
//! L(pixel) = 1/n² Σ rays  W(pixel − ray) L(ray)         W(d) = ∫ square about d  s(x) dx,   Σ pixels W = 1
//!
//! Gaussian   s = exp(−r²/2σ²) / (2πσ²)
//! Airy       s = π/(4c²) [2 J₁(v)/v]²,   v = π r/c,   c = λN/pitch         within r of energy 1 − J₀² − J₁²
//! disc       s = 4/(πd²)  up to r = d/2                                     (defocus)
//! ```
//!
//! Spreads are put one behind the other by convolution of their masses in cells of a tenth of a pixel. A measured kernel
//! is the share of one pixel's light in each pixel around it and comes last.
//!
//! The sum of the shares is 1 for every ray: energy is kept. Light from beyond the image's edges is rendered and falls
//! into it ([`Psf::reach`] pixels all round). Pixels without a value stay so and lend nothing to their neighbours.
//!
//! # Assumptions
//! - The same everywhere in the image.
//! - A Gaussian ends at 4 σ (3e-4 of its energy beyond), an Airy pattern at ten times `c` (2.0 %), or 48 pixels; what is
//!   cut off is given back in proportion ([`Psf::cut_off`]).
//!
//! # References
//! Born & Wolf (1999), Principles of Optics, 8.5.2, for Airy's pattern and Rayleigh's formula for its energy.

use libm::{erf, j0, j1};
use rayon::prelude::*;

use super::{CameraError, check};

/// One cause of blur.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PsfComponent {
    Gaussian {
        sigma_px: f64,
    },
    /// Diffraction at a round aperture; `λN` over the pitch.
    Airy {
        cutoff_px: f64,
    },
    /// A point out of focus.
    Disc {
        diameter_px: f64,
    },
}

/// Shares of a pixel's light in the pixels around it, row by row, as the image lies. Both sides are odd.
#[derive(Debug, Clone, PartialEq)]
pub struct Kernel {
    pub columns: usize,
    pub rows: usize,
    pub shares: Vec<f64>,
}

/// The spread of a camera's rays over its pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Psf {
    /// Rays along a pixel's side.
    side: usize,
    /// Pixels on each side that a pixel gets light from.
    pub reach: usize,
    /// Of each ray of the `(2 reach + 1)²` pixels around a pixel, row by row.
    weights: Vec<f32>,
    /// Energy beyond the ends of the spreads, before it was given back.
    pub cut_off: f64,
}

/// Cells along a pixel's side, at least.
const CELLS: usize = 9;
/// Where a Gaussian ends, in σ.
const GAUSSIAN_END: f64 = 4.0;
/// Where an Airy pattern ends, in `c`.
const AIRY_END: f64 = 10.0;
/// No spread reaches farther.
const FARTHEST_PX: f64 = 48.0;
/// Points along a side of what Airy's pattern and a disc's edge are summed from, over `c` and the diameter.
const AIRY_STEP: f64 = 0.1;
const DISC_STEP: f64 = 0.01;

impl PsfComponent {
    pub fn check(&self) -> Result<(), CameraError> {
        match *self {
            Self::Gaussian { sigma_px } => check("psf sigma", sigma_px, 0.05..=12.0, "[0.05, 12] px"),
            Self::Airy { cutoff_px } => check("psf wavelength times f-number", cutoff_px, 0.01..=16.0, "[0.01, 16] px"),
            Self::Disc { diameter_px } => check("psf diameter", diameter_px, 0.05..=64.0, "[0.05, 64] px"),
        }
    }

    /// Radius at which the spread ends.
    fn end_px(&self) -> f64 {
        match *self {
            Self::Gaussian { sigma_px } => GAUSSIAN_END * sigma_px,
            Self::Airy { cutoff_px } => (AIRY_END * cutoff_px).min(FARTHEST_PX),
            Self::Disc { diameter_px } => 0.5 * diameter_px,
        }
    }

    /// Energy within a radius.
    pub fn encircled(&self, radius_px: f64) -> f64 {
        match *self {
            Self::Gaussian { sigma_px } => 1.0 - (-0.5 * (radius_px / sigma_px).powi(2)).exp(),
            Self::Airy { cutoff_px } => {
                let v = std::f64::consts::PI * radius_px / cutoff_px;
                1.0 - j0(v).powi(2) - j1(v).powi(2)
            }
            Self::Disc { diameter_px } => (2.0 * radius_px / diameter_px).powi(2).min(1.0),
        }
    }

    /// Energy in each of the cells of width `step_px` about the point, within the spread's end.
    fn cells(&self, step_px: f64) -> Cells {
        let half = (self.end_px() / step_px - 0.5).ceil().max(0.0) as usize;
        match *self {
            Self::Gaussian { sigma_px } => Cells::filled(half, |column, row| {
                let share = |cell: f64| {
                    let below = |edge: f64| erf(edge * step_px / sigma_px * std::f64::consts::FRAC_1_SQRT_2);
                    0.5 * (below(cell + 0.5) - below(cell - 0.5))
                };
                share(column) * share(row)
            }),
            Self::Airy { cutoff_px } => {
                let density = |radius_px: f64| {
                    let v = std::f64::consts::PI * radius_px / cutoff_px;
                    let amplitude = if v < 1e-6 { 1.0 } else { 2.0 * j1(v) / v };
                    amplitude * amplitude * std::f64::consts::FRAC_PI_4 / (cutoff_px * cutoff_px)
                };
                let end = self.end_px();
                let inside = move |radius_px: f64| if radius_px <= end { density(radius_px) } else { 0.0 };
                Cells::integrated(half, step_px, AIRY_STEP * cutoff_px, inside)
            }
            Self::Disc { diameter_px } => {
                let area = std::f64::consts::FRAC_PI_4 * diameter_px * diameter_px;
                let inside = move |radius_px: f64| if 2.0 * radius_px <= diameter_px { 1.0 / area } else { 0.0 };
                Cells::integrated(half, step_px, DISC_STEP * diameter_px, inside)
            }
        }
    }
}

/// Energy in square cells about a point: `2 half + 1` along a side.
#[derive(Debug, Clone, PartialEq)]
struct Cells {
    half: usize,
    energy: Vec<f64>,
}

impl Cells {
    fn side(&self) -> usize {
        2 * self.half + 1
    }

    fn filled(half: usize, energy: impl Fn(f64, f64) -> f64 + Sync) -> Self {
        let side = 2 * half + 1;
        let place = |index: usize| index as f64 - half as f64;
        let at = |index: usize| energy(place(index % side), place(index / side));
        Self { half, energy: (0..side * side).into_par_iter().map(at).collect() }
    }

    /// Of a density by radius, summed at points no farther apart than `step_px`.
    fn integrated(half: usize, cell_px: f64, step_px: f64, density: impl Fn(f64) -> f64 + Sync) -> Self {
        let points = (cell_px / step_px).ceil().max(1.0) as usize;
        let offset = |point: usize| (point as f64 + 0.5) / points as f64 - 0.5;
        Self::filled(half, |column, row| {
            let line =
                |y: f64| -> f64 { (0..points).map(|i| density((column + offset(i)).hypot(row + y) * cell_px)).sum() };
            (0..points).map(|j| line(offset(j))).sum::<f64>() * (cell_px / points as f64).powi(2)
        })
    }

    /// One spread behind the other.
    fn convolved(&self, other: &Self) -> Self {
        let half = self.half + other.half;
        let (side, own, others) = (2 * half + 1, self.side(), other.side());
        let line = |row: usize| {
            let mut line = vec![0.0; side];
            for below in row.saturating_sub(own - 1)..others.min(row + 1) {
                for (right, b) in other.energy[below * others..][..others].iter().enumerate() {
                    let a = &self.energy[(row - below) * own..][..own];
                    line[right..right + own].iter_mut().zip(a).for_each(|(sum, a)| *sum += a * b);
                }
            }
            line
        };
        Self { half, energy: (0..side).into_par_iter().flat_map_iter(line).collect() }
    }

    /// Running sums over columns and rows, with a first row and column of zeros.
    fn sums(&self) -> Vec<f64> {
        let side = self.side();
        let mut sums = vec![0.0; (side + 1) * (side + 1)];
        for row in 0..side {
            let mut line = 0.0;
            for column in 0..side {
                line += self.energy[row * side + column];
                sums[(row + 1) * (side + 1) + column + 1] = sums[row * (side + 1) + column + 1] + line;
            }
        }
        sums
    }
}

impl Kernel {
    /// From non-negative numbers of any scale; refuses even sides and sums that are not positive.
    pub fn new(columns: usize, rows: usize, values: &[f64]) -> Result<Self, CameraError> {
        let odd = |side: usize| side % 2 == 1 && (1..=2 * FARTHEST_PX as usize + 1).contains(&side);
        let sum: f64 = values.iter().sum();
        let shares_light = values.iter().all(|value| *value >= 0.0) && sum > 0.0 && sum.is_finite();
        if !odd(columns) || !odd(rows) || values.len() != columns * rows || !shares_light {
            return Err(CameraError::Kernel { columns, rows });
        }
        Ok(Self { columns, rows, shares: values.iter().map(|value| value / sum).collect() })
    }
}

impl Psf {
    /// For `side × side` rays a pixel. Spreads follow one another; a kernel comes last.
    pub fn new(spreads: &[PsfComponent], kernel: Option<&Kernel>, side: usize) -> Result<Self, CameraError> {
        spreads.iter().try_for_each(PsfComponent::check)?;
        let cells_a_ray = (CELLS.div_ceil(side)) | 1;
        let cells_a_pixel = cells_a_ray * side;
        let step_px = 1.0 / cells_a_pixel as f64;
        let point = Cells { half: 0, energy: vec![1.0] };
        let cells = spreads.iter().fold(point, |all, spread| all.convolved(&spread.cells(step_px)));
        let cut_off = 1.0 - spreads.iter().map(|spread| spread.encircled(spread.end_px())).product::<f64>();
        let mut shares = Shares::new(&cells, side, cells_a_pixel);
        if let Some(kernel) = kernel {
            shares = shares.followed_by(kernel);
        }
        let weights = shares.normalised();
        Ok(Self { side, reach: shares.reach, weights, cut_off })
    }

    /// What pixels get from rays: `rays` are those of `columns × rows` pixels and of [`Psf::reach`] more all round.
    pub fn spread(&self, rays: &[f32], [columns, rows]: [usize; 2]) -> Vec<f32> {
        let stride = (columns + 2 * self.reach) * self.side;
        assert_eq!(rays.len(), stride * (rows + 2 * self.reach) * self.side, "rays of a frame with its margin");
        (0..columns * rows)
            .into_par_iter()
            .map(|index| self.received(rays, stride, [index % columns, index / columns].map(|at| at * self.side)))
            .collect()
    }

    /// Of one pixel, whose first ray within reach is at `[column, row]`.
    fn received(&self, rays: &[f32], stride: usize, [column, row]: [usize; 2]) -> f32 {
        let width = (2 * self.reach + 1) * self.side;
        let lines = || (0..width).map(|line| &rays[(row + line) * stride + column..][..width]);
        let sum: f64 = self.weights.chunks(width).zip(lines()).map(|(weights, rays)| dot(weights, rays)).sum();
        if sum.is_finite() {
            return sum as f32;
        }
        let own = self.reach * self.side..(self.reach + 1) * self.side;
        if own.clone().any(|line| rays[(row + line) * stride + column..][own.clone()].iter().any(|ray| ray.is_nan())) {
            return f32::NAN;
        }
        let pairs = self.weights.chunks(width).zip(lines()).flat_map(|(weights, rays)| weights.iter().zip(rays));
        let known = pairs.filter(|(_, ray)| ray.is_finite());
        let sums = known.map(|(w, ray)| [f64::from(*w), f64::from(*w) * f64::from(*ray)]);
        let [weight, light] = sums.fold([0.0; 2], |sum, pair| [sum[0] + pair[0], sum[1] + pair[1]]);
        (light / weight) as f32
    }
}

/// In eight lanes: sums of floats are not reordered by the compiler.
fn dot(weights: &[f32], rays: &[f32]) -> f64 {
    let mut lanes = [0.0_f32; 8];
    let (weights, rays) = (weights.chunks_exact(8), rays.chunks_exact(8));
    let rest: f32 = weights.remainder().iter().zip(rays.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in weights.zip(rays) {
        lanes.iter_mut().zip(a.iter().zip(b)).for_each(|(lane, (a, b))| *lane += a * b);
    }
    lanes.iter().map(|lane| f64::from(*lane)).sum::<f64>() + f64::from(rest)
}

/// What a pixel gets of each ray around it: as [`Psf`]'s weights, before they are divided by the rays of a pixel.
struct Shares {
    side: usize,
    reach: usize,
    shares: Vec<f64>,
}

impl Shares {
    fn new(cells: &Cells, side: usize, cells_a_pixel: usize) -> Self {
        // A ray is off its pixel's centre by less than half a pixel.
        let reach = cells.half.div_ceil(cells_a_pixel);
        let width = (2 * reach + 1) * side;
        let (sums, stride) = (cells.sums(), cells.side() + 1);
        let cells_a_ray = cells_a_pixel / side;
        // The pixel's cells, counted from the first of the ray's; the ray is in the middle of its own cell.
        let first = |ray: usize| {
            let middle = ray * cells_a_ray + cells_a_ray / 2;
            (reach * cells_a_pixel + cells.half) as i64 - middle as i64
        };
        let clamped = |cell: i64| cell.clamp(0, cells.side() as i64) as usize;
        let range = |ray: usize| [clamped(first(ray)), clamped(first(ray) + cells_a_pixel as i64)];
        let share = |index: usize| {
            let ([left, right], [top, bottom]) = (range(index % width), range(index / width));
            let sum = |row: usize, column: usize| sums[row * stride + column];
            (sum(bottom, right) - sum(top, right) - sum(bottom, left) + sum(top, left)).max(0.0)
        };
        Self { side, reach, shares: (0..width * width).map(share).collect() }
    }

    /// With the light of each pixel shared out once more.
    fn followed_by(&self, kernel: &Kernel) -> Self {
        let (half_columns, half_rows) = (kernel.columns / 2, kernel.rows / 2);
        let more = half_columns.max(half_rows);
        let reach = self.reach + more;
        let (width, own) = ((2 * reach + 1) * self.side, (2 * self.reach + 1) * self.side);
        let mut shares = vec![0.0; width * width];
        for (index, share) in kernel.shares.iter().enumerate() {
            // Light that the kernel carries to the right comes from rays on the left.
            let right = more + half_columns - index % kernel.columns;
            let down = more + half_rows - index / kernel.columns;
            for row in 0..own {
                let into = &mut shares[(down * self.side + row) * width + right * self.side..][..own];
                let from = &self.shares[row * own..][..own];
                into.iter_mut().zip(from).for_each(|(sum, own)| *sum += share * own);
            }
        }
        Self { side: self.side, reach, shares }
    }

    /// Each ray's shares add up to what it stands for.
    fn normalised(&self) -> Vec<f32> {
        let (side, width) = (self.side, (2 * self.reach + 1) * self.side);
        let mut sums = vec![0.0; side * side];
        let place = |index: usize| (index / width % side) * side + index % width % side;
        self.shares.iter().enumerate().for_each(|(index, share)| sums[place(index)] += share);
        let rays = (side * side) as f64;
        self.shares.iter().enumerate().map(|(index, share)| (share / sums[place(index)] / rays) as f32).collect()
    }
}

#[cfg(test)]
mod tests;
