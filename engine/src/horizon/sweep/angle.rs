//! Slopes to elevations, many receivers at once, in `f32`.

use glam::DVec2;

use super::grid::HeightGrid;
use super::ray::Ray;
use crate::horizon::lanes::{LANES, larger, largest};
use crate::horizon::receivers::Receivers;
use crate::horizon::wide::wide;
use crate::terrain::Gnomonic;

/// What the receivers of a row share, lengths in map radii.
#[derive(Debug, Clone, Copy)]
pub struct ReceiverRow {
    /// Major coordinate, minor coordinate of the first receiver, and their spacing.
    pub major: f32,
    pub minor: f32,
    pub spacing: f32,
    /// Unit (major, minor) direction.
    pub direction: [f32; 2],
    /// (major, minor) coordinates at which the terrain ends in that direction.
    pub end: [f32; 2],
}

/// Where the receivers of a plane stand, and on which terrain.
#[derive(Debug, Clone, Copy)]
pub struct Shape<'a> {
    pub map: &'a Gnomonic,
    /// The level that is looked from, then the coarser ones.
    pub grids: &'a [HeightGrid],
    pub receivers: &'a Receivers,
    /// What the receivers' heights are measured from.
    pub datum_m: f64,
}

impl Shape<'_> {
    /// From the slopes of all receivers, times `scale` in metres per map metre, to elevations above the local horizontal, the
    /// bare sphere included.
    pub fn turn_into_elevations(&self, ray: &Ray, scale: f32, plane: &mut [f32]) {
        wide(
            #[inline(always)]
            || self.turn_plain(ray, scale, plane),
        );
    }

    #[inline(always)]
    fn turn_plain(&self, ray: &Ray, scale: f32, plane: &mut [f32]) {
        let (fine, r) = (&self.grids[0], self.receivers);
        let radius_m = self.map.radius_m;
        let radii = |metres: f64| (metres / radius_m) as f32;
        let (height_scale, datum) = (radii(1.0), radii(self.datum_m));
        let coarsest = self.grids.last().expect("a face has levels");
        let span = DVec2::new((coarsest.majors - 1) as f64, (coarsest.minors - 1) as f64) * coarsest.posting_m;
        let end = DVec2::select(ray.direction.cmpgt(DVec2::ZERO), coarsest.origin_m + span, coarsest.origin_m);
        for u in 0..r.majors {
            for start in (0..r.stride).step_by(LANES) {
                let i = u * r.stride + start;
                let heights: [f32; LANES] = std::array::from_fn(|lane| r.observers_m[i + lane] * height_scale + datum);
                let slopes: &mut [f32; LANES] = (&mut plane[i..i + LANES]).try_into().expect("LANES");
                slopes.iter_mut().for_each(|slope| *slope *= scale);
                let row = ReceiverRow {
                    major: radii(fine.origin_m.x + (u + r.margin) as f64 * fine.posting_m),
                    minor: radii(fine.origin_m.y + (start + r.margin) as f64 * fine.posting_m),
                    spacing: radii(fine.posting_m),
                    direction: [ray.direction.x as f32, ray.direction.y as f32],
                    end: [radii(end.x), radii(end.y)],
                };
                *slopes = elevations_rad(&row, &heights, slopes);
            }
        }
    }
}

/// Elevations of the skyline, in radians, from lifted slopes and lifted heights in map radii:
/// `Gnomonic::elevation_tangent` and `sphere::skyline_beyond`.
#[inline(always)]
pub fn elevations_rad(row: &ReceiverRow, heights: &[f32; LANES], slopes: &[f32; LANES]) -> [f32; LANES] {
    let (mut tangents, mut lower) = ([0.0; LANES], [0.0; LANES]);
    for i in 0..LANES {
        tangents[i] = tangent(row, i, heights[i], slopes[i]);
        lower[i] = below_the_dip(row, i, heights[i], tangents[i]);
    }
    if largest(&lower) > 0.0 {
        for i in 0..LANES {
            tangents[i] = larger(tangents[i], tangent(row, i, heights[i], sphere_slope(row, i, heights[i])));
        }
    }
    let mut sizes = [0.0; LANES];
    for i in 0..LANES {
        sizes[i] = tangents[i].abs();
    }
    if largest(&sizes) > 1.0 {
        for tangent in &mut tangents {
            *tangent = atan(*tangent);
        }
    } else {
        for tangent in &mut tangents {
            *tangent = atan_of_gentle(tangent.abs()).copysign(*tangent);
        }
    }
    tangents
}

#[inline(always)]
fn minor_of(row: &ReceiverRow, lane: usize) -> f32 {
    row.minor + lane as f32 * row.spacing
}

/// `(s r/R + q)/√(1 − q²)` with one root and one division: `q = p/√k`, `r/R = √k/(1 − h)`.
#[inline(always)]
fn tangent(row: &ReceiverRow, lane: usize, height: f32, slope: f32) -> f32 {
    let minor = minor_of(row, lane);
    let k = 1.0 + row.major * row.major + minor * minor;
    let p = row.major * row.direction[0] + minor * row.direction[1];
    let depth = 1.0 - height;
    (slope * k + p * depth) / (depth * (k - p * p).sqrt())
}

/// Positive where the bare sphere may rise above a tangent: it never rises above the dip of the observer's height,
/// `tan² = (K − M²)/M²` ([`crate::horizon::sphere`]), nor, seen from below it, above the local horizontal.
#[inline(always)]
fn below_the_dip(row: &ReceiverRow, lane: usize, height: f32, tangent: f32) -> f32 {
    let minor = minor_of(row, lane);
    let above = row.major * row.major + minor * minor + height * (2.0 - height);
    let drop = if tangent < 0.0 { tangent * (1.0 - height) } else { 0.0 };
    // Short of the dip by its rounding.
    drop.mul_add(drop, -0.9999 * larger(above, 0.0))
}

#[inline(always)]
fn sphere_slope(row: &ReceiverRow, lane: usize, h: f32) -> f32 {
    let minor = minor_of(row, lane);
    let [along, across] = row.direction;
    let square = row.major * row.major + minor * minor;
    let (k, m, p) = (1.0 + square, 1.0 - h, row.major * along + minor * across);
    let above = square + h * (2.0 - h);
    let run = |end: f32, at: f32, rate: f32| if rate == 0.0 { f32::MAX } else { (end - at) / rate };
    let (by_major, by_minor) = (run(row.end[0], row.major, along), run(row.end[1], minor, across));
    let edge = larger(if by_major < by_minor { by_major } else { by_minor }, 0.0);
    let reach = |t: f32| (k + t * (2.0 * p + t)).sqrt();
    let touch = (p * above + m * (larger(above, 0.0) * (k - p * p)).sqrt()) / (m * m - p * p);
    let below = -m / k.sqrt() * (2.0 * p + edge) / (reach(edge) + k.sqrt());
    let tangent = -(p + touch) / reach(touch);
    let at_edge = -(above + edge * (2.0 * p + edge)) / ((m + reach(edge)) * edge);
    if above <= 0.0 {
        below
    } else if touch >= edge {
        tangent
    } else {
        at_edge
    }
}

/// Arc tangent to 1e-7 rad, beyond 1 by that of the inverse.
#[inline(always)]
pub fn atan(tangent: f32) -> f32 {
    let size = tangent.abs();
    let steep = size > 1.0;
    let angle = atan_of_gentle(if steep { 1.0 / size } else { size });
    let angle = if steep { std::f32::consts::FRAC_PI_2 - angle } else { angle };
    angle.copysign(tangent)
}

/// Arc tangent on [0, 1]: Abramowitz & Stegun 4.4.49.
#[inline(always)]
fn atan_of_gentle(z: f32) -> f32 {
    let s = z * z;
    let series = [
        0.002_866_225_7,
        -0.016_165_737,
        0.042_909_614,
        -0.075_289_64,
        0.106_562_64,
        -0.142_089,
        0.199_935_51,
        -0.333_331_45,
    ];
    let mut sum = series[0];
    for coefficient in &series[1..] {
        sum = sum * s + coefficient;
    }
    z + z * s * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arc_tangent_is_right_to_two_tenths_of_a_microradian() {
        for i in -4000..4000 {
            let tangent = (f64::from(i) / 400.0).powi(3) as f32;
            assert!((f64::from(atan(tangent)) - f64::from(tangent).atan()).abs() < 2e-7, "{tangent}");
        }
    }
}
