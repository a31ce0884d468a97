//! The part of a limb-darkened disc above a horizon line and above a facet's own plane.
//!
//! On the unit disc the radiance is `μ^α`, `μ² = 1 − x² − y²`. Its share above a straight line at distance `h`
//! from the centre, and the first moment of that part, are closed:
//!
//! ```text
//! V(h) = ∫_h^1 (1 − v²)^((α+1)/2) dv / B(½, a)      M(h) = (1 − h²)^a / (2 a B(½, a))      a = (α + 3)/2
//! ```
//!
//! A polynomial in `μ` is a sum of such discs, some of negative weight.
//!
//! `V` is the regularised incomplete beta function `I_{(1−h)/2}(a, a)`; here it is a Gauss–Legendre sum in
//! `φ = asin v`, good to 1e-9. Where horizon and facet plane both cut the disc, columns of constant `x` between
//! the corners of the region are summed, each in the same way. The ground's irradiance follows to first order in
//! the angular radius `r`:
//!
//! ```text
//! E = E_n [ V n·s + r (M_x n·e_x + M_y n·e_y) ]
//! ```
//!
//! which is not `V cos i`: at 1.5° Sun elevation and half the disc hidden it is 7 % more. Axes and lines:
//! [`SunAxes`](super::SunAxes).
//!
//! # Assumptions
//! - One law for the whole band: see [`LimbDarkening`].
//! - Second order in `r` is left out: 2e-5 of the irradiance for the Sun at 1 au.
//!
//! `fast` sorts the cases instead and interpolates tables: within 1e-6 of the whole Sun. `solar_disk.wgsl` does so in
//! `f32`: within 4e-5, 1e-5 for `α = 0.5`. `tests/conformance/photometry.rs` holds it to the quadrature.
//!
//! # References
//! Max (1988), The Visual Computer 4, 109, doi:10.1007/BF01905562, for the uniform disc.

mod fast;
mod light;
mod quadrature;

use std::f64::consts::{FRAC_PI_2, PI};

use fast::Fast;
use glam::DVec2;
pub use light::DiskLight;
use light::HalfPlane;
use quadrature::Quadrature;

use super::quadrature::gauss_legendre;
use super::{Facet, HorizonLine, LimbDarkening, PhotometryError};

/// The Sun's disc with its limb darkening, in units of its own radius: a sum of discs whose radiance is a power of `μ`.
#[derive(Debug, Clone, PartialEq)]
pub struct SolarDisk {
    parts: Vec<Part>,
}

#[derive(Debug, Clone, PartialEq)]
struct Part {
    /// Share of the whole light; negative where a polynomial's factor is.
    weight: f64,
    believed: Quadrature,
    fast: Fast,
}

impl SolarDisk {
    pub fn new(law: LimbDarkening) -> Result<Self, PhotometryError> {
        law.check()?;
        let mean = law.mean();
        let part = |(alpha, factor): (f64, f64)| {
            let believed = Quadrature::new(alpha);
            Part { weight: 2.0 * factor / (alpha + 2.0) / mean, fast: Fast::new(&believed), believed }
        };
        Ok(Self { parts: law.powers().into_iter().map(part).collect() })
    }

    /// Share of the light above a straight line at `height` solar radii from the centre.
    pub fn visible_above(&self, height: f64) -> f64 {
        self.parts.iter().map(|part| part.weight * part.believed.visible_above(height)).sum()
    }

    /// The same from a table, to 1e-6.
    pub fn share_above(&self, height: f64) -> f64 {
        self.parts.iter().map(|part| part.weight * part.fast.share_above(height)).sum()
    }

    /// Share of the light above some heights in the columns at `x`, which stand for the disc: `[x, height]`, in solar radii.
    pub fn share_of_columns(&self, columns: &[[f64; 2]]) -> f64 {
        let of_part = |part: &Part| {
            let (mut light, mut weights) = (0.0, 0.0);
            for &[x, height] in columns {
                let chord = (1.0 - x * x).sqrt();
                let weight = chord.powf(part.believed.alpha + 1.0);
                light += weight * part.fast.chord_above(height / chord);
                weights += weight;
            }
            part.weight * light / weights
        };
        self.parts.iter().map(of_part).sum()
    }

    /// First moment of that light, across the line, in solar radii.
    pub fn moment_above(&self, height: f64) -> f64 {
        self.parts.iter().map(|part| part.weight * part.believed.moment_above(height)).sum()
    }

    /// The sum over the parts of what `light` gives for each.
    fn sum(&self, light: impl Fn(&Part) -> DiskLight) -> DiskLight {
        if let [part] = &self.parts[..] {
            return light(part);
        }
        let (mut fraction, mut moment) = (0.0, DVec2::ZERO);
        for part in &self.parts {
            let light = light(part);
            fraction += part.weight * light.fraction;
            moment += part.weight * light.moment;
        }
        DiskLight { fraction: fraction.clamp(0.0, 1.0), moment }
    }

    /// What is seen above the horizon and above the facet's own plane.
    pub fn light(&self, horizon: HorizonLine, facet: Facet) -> DiskLight {
        match Cut::of(horizon, facet) {
            Cut::None(whole) => whole,
            Cut::One(plane) => self.sum(|part| part.fast.light_above_line(plane)),
            Cut::Both(a, b) => self.sum(|part| part.fast.light_above_both(a, b)),
        }
    }

    /// The same by quadrature: 1 µs where one line cuts the disc, 0.1 ms where both do.
    pub fn light_by_quadrature(&self, horizon: HorizonLine, facet: Facet) -> DiskLight {
        match Cut::of(horizon, facet) {
            Cut::None(whole) => whole,
            Cut::One(plane) => self.sum(|part| part.believed.light_above_line(plane)),
            Cut::Both(a, b) => self.sum(|part| part.believed.light_by_columns([a, b])),
        }
    }

    /// What is seen above any skyline, given as its height at a column `x`, and above the facet's own plane: the
    /// disc in `COLUMNS_OF_SKYLINE` columns of equal angle. A smooth skyline is met to 1e-3, a step inside the
    /// disc to a column's width.
    pub fn light_above(&self, skyline: &dyn Fn(f64) -> f64, facet: Facet) -> DiskLight {
        let own = HalfPlane::new(facet.slope, facet.height);
        let width_rad = PI / f64::from(Self::COLUMNS_OF_SKYLINE);
        let columns = (0..Self::COLUMNS_OF_SKYLINE).map(|column| {
            let (x, chord) = ((f64::from(column) + 0.5) * width_rad - FRAC_PI_2).sin_cos();
            (x, chord, HalfPlane { normal: DVec2::Y, height: skyline(x) })
        });
        let columns: Vec<_> = columns.collect();
        self.sum(|part| {
            let alpha = part.believed.alpha;
            let (mut fraction, mut moment) = (0.0, DVec2::ZERO);
            for &(x, chord, horizon) in &columns {
                let weight = width_rad * chord.powf(alpha + 2.0);
                let (share, offset) = part.fast.column([horizon, own], x, chord);
                fraction += weight * share;
                moment += weight * DVec2::new(x * share, chord * offset);
            }
            let norm = (alpha + 2.0) / (2.0 * PI);
            DiskLight { fraction: norm * fraction, moment: norm * moment }
        })
    }

    const COLUMNS_OF_SKYLINE: u32 = 24;

    /// The numbers that `solar_disk.wgsl` reads, part by part: three constants and the part's weight; `V(h)` at `DISK_KNOTS`
    /// even steps of `√(1 − h)` from 0 to 1; the share of a chord above the same heights; `DISK_COLUMNS` nodes and weights
    /// on [0, 1], in turns.
    pub fn tables(&self) -> Vec<f32> {
        let heights = (0..Self::KNOTS).map(|i| 1.0 - (f64::from(i) / f64::from(Self::KNOTS - 1)).powi(2));
        let columns: Vec<_> =
            gauss_legendre(Self::COLUMNS as usize).into_iter().flat_map(|(node, weight)| [node, weight]).collect();
        let of_part = |part: &Part| {
            let Quadrature { alpha, line_norm, chord_norm, .. } = part.believed;
            let numbers = [alpha, line_norm, chord_norm, part.weight].into_iter();
            let lines = heights.clone().map(|height| part.believed.visible_above(height));
            let chords = heights.clone().map(|height| part.believed.chord_above(height));
            numbers
                .chain(lines)
                .chain(chords)
                .chain(columns.iter().copied())
                .map(|value| value as f32)
                .collect::<Vec<_>>()
        };
        self.parts.iter().flat_map(of_part).collect()
    }

    const KNOTS: u32 = 257;
    const COLUMNS: u32 = 12;

    /// The `override` values that go with [`SolarDisk::tables`].
    pub fn constants(&self) -> [(&'static str, f64); 3] {
        [
            ("DISK_KNOTS", f64::from(Self::KNOTS)),
            ("DISK_COLUMNS", f64::from(Self::COLUMNS)),
            ("DISK_PARTS", self.parts.len() as f64),
        ]
    }
}

/// What horizon and facet plane do to the disc.
enum Cut {
    /// All or nothing is seen.
    None(DiskLight),
    One(HalfPlane),
    Both(HalfPlane, HalfPlane),
}

impl Cut {
    fn of(horizon: HorizonLine, facet: Facet) -> Self {
        let horizon = HalfPlane::new(DVec2::new(-horizon.slope, 1.0), -horizon.height);
        let own = HalfPlane::new(facet.slope, facet.height);
        match [horizon, own].map(|plane| (plane.height >= 1.0, plane.height <= -1.0)) {
            [(true, _), _] | [_, (true, _)] => Self::None(DiskLight::NONE),
            [(_, true), (_, true)] => Self::None(DiskLight::FULL),
            [_, (_, true)] => Self::One(horizon),
            [(_, true), _] => Self::One(own),
            _ => Self::Both(horizon, own),
        }
    }
}

#[cfg(test)]
mod tests;
