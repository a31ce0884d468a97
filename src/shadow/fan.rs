//! A fan of azimuths over those that lights take on a level, and the straight line nearest to a skyline across a disc.
//!
//! Over a map a light's azimuth turns by little. The skyline is found at the azimuths `A_k = k·step` that bracket it, half a
//! disc's width `w` to each side, and is straight between them. The line that takes its place across the disc is the
//! least-squares fit with the disc's chords `√(1 − x²)` as weights, by Gauss–Chebyshev sums of the second kind:
//!
//! ```text
//! elevation = Σ wᵢ h(A + w xᵢ)        slope = 4 Σ wᵢ xᵢ h(A + w xᵢ) / w        xᵢ = cos(iπ/(n+1)),  wᵢ ∝ sin²(iπ/(n+1))
//! ```
//!
//! for `Σ wᵢ xᵢ² = ¼` whatever `n` is. Where a peak or a notch stands within the disc, its mean decides how much light
//! passes, not its height at the disc's middle.
//!
//! Both are linear in the planes' elevations, so that planes are added one after the other and need not be kept.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::skylines::{Aim, HeldLight, Skyline, WIDEST_RAD};
use crate::horizon::planes;
use crate::terrain::{Gnomonic, Level};

/// Places across the disc, in its half widths, and their shares.
const ACROSS: [[f32; 2]; 5] =
    [[-0.866_025_4, 1.0 / 12.0], [-0.5, 0.25], [0.0, 1.0 / 3.0], [0.5, 0.25], [0.866_025_4, 1.0 / 12.0]];

/// Below this half width a disc has no slope.
const NARROWEST_RAD: f32 = 1e-6;

/// The line across a disc from skylines at [`THREE`] places: the same sums with `n = 3`.
pub fn line_of_three(elevations_rad: [f64; 3], half_width_rad: f64) -> Skyline {
    let [a, b, c] = elevations_rad;
    let slope = if half_width_rad > 0.0 { (c - a) * THREE[2] / half_width_rad } else { 0.0 };
    [(0.25 * a + 0.5 * b + 0.25 * c) as f32, slope as f32]
}

/// Places across the disc in its half widths; the first and the last have half the share of the middle.
pub const THREE: [f64; 3] = [-std::f64::consts::FRAC_1_SQRT_2, 0.0, std::f64::consts::FRAC_1_SQRT_2];

/// Evenly spaced map azimuths, a whole number of steps around the circle.
#[derive(Debug, Clone, PartialEq)]
pub struct Fan {
    step_rad: f64,
    /// Azimuth of the first plane, in steps.
    first: i64,
    pub planes: usize,
    /// A direction within the fan, from which azimuths are counted.
    middle: DVec2,
    middle_rad: f64,
}

/// A disc on a fan, in steps from its first plane.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    at: f32,
    half_width: f32,
}

impl Fan {
    /// The azimuths of lights on a level, no wider apart than `step_rad` unless they would be more than `most`; at least
    /// three.
    pub fn over(map: &Gnomonic, level: &Level, lights: &[HeldLight], step_rad: f64, most: usize) -> Self {
        let rim = rim(level);
        let centre = level.lifted_node(level.columns / 2, level.rows / 2);
        let middle = lights.first().map_or(DVec2::Y, |light| light.aim(map, centre).towards);
        let mut fan = Self { step_rad, first: 0, planes: 0, middle, middle_rad: middle.x.atan2(middle.y) };
        let mut ends_rad = [f64::INFINITY, f64::NEG_INFINITY];
        for light in lights {
            for &[column, row] in &rim {
                let aim = light.aim(map, level.lifted_node(column, row));
                let turn_rad = fan.turn_rad(aim.towards);
                ends_rad[0] = ends_rad[0].min(turn_rad - aim.half_width_rad);
                ends_rad[1] = ends_rad[1].max(turn_rad + aim.half_width_rad);
            }
            if overhead(map, level, light) {
                ends_rad = [-PI - WIDEST_RAD, PI + WIDEST_RAD];
            }
        }
        if ends_rad[0] > ends_rad[1] {
            ends_rad = [0.0; 2];
        }
        let widened_rad = step_rad.max((ends_rad[1] - ends_rad[0]) / (most - 2) as f64);
        fan.step_rad = TAU / (TAU / widened_rad).ceil();
        let [low, high] = ends_rad.map(|turn_rad| (fan.middle_rad + turn_rad) / fan.step_rad);
        fan.first = low.floor() as i64;
        fan.planes = ((high.ceil() as i64 - fan.first + 1) as usize).max(3);
        fan
    }

    /// Map azimuth of a plane.
    pub fn azimuth_rad(&self, plane: usize) -> f64 {
        (self.first + plane as i64) as f64 * self.step_rad
    }

    /// Unit map direction of a plane.
    pub fn direction(&self, plane: usize) -> DVec2 {
        planes::towards(self.azimuth_rad(plane))
    }

    /// Angle from the middle to a direction, clockwise on the map.
    fn turn_rad(&self, towards: DVec2) -> f64 {
        (towards.x * self.middle.y - towards.y * self.middle.x).atan2(towards.dot(self.middle))
    }

    /// Whether a light's disc lies between the fan's outermost planes.
    pub fn spans(&self, aim: &Aim) -> bool {
        let (at, half_width) = self.steps(aim);
        // The rim of a level is where azimuths are outermost but for the parallax of heights.
        (at - half_width) > -0.01 && at + half_width < (self.planes - 1) as f64 + 0.01
    }

    pub fn place(&self, aim: &Aim) -> Place {
        let (at, half_width) = self.steps(aim);
        Place { at: at as f32, half_width: half_width as f32 }
    }

    fn steps(&self, aim: &Aim) -> (f64, f64) {
        let at = (self.middle_rad + self.turn_rad(aim.towards)) / self.step_rad - self.first as f64;
        (at, aim.half_width_rad / self.step_rad)
    }

    /// The planes with a share in a line.
    pub fn near(&self, place: Place) -> std::ops::RangeInclusive<usize> {
        let last = self.planes - 1;
        let reach = ACROSS[ACROSS.len() - 1][0] * place.half_width;
        ((place.at - reach).max(0.0) as usize).min(last)..=((place.at + reach).max(0.0).ceil() as usize).min(last)
    }

    /// Adds what plane `plane` with an elevation at a place has in the line there.
    pub fn add(&self, line: &mut Skyline, place: Place, plane: usize, elevation_rad: f32) {
        let last = (self.planes - 1) as f32;
        let mut shares = [0.0_f32; 2];
        for [x, weight] in ACROSS {
            let at = (place.at + place.half_width * x).clamp(0.0, last);
            let near = weight * (1.0 - (at - plane as f32).abs()).max(0.0);
            shares[0] += near;
            shares[1] += x * near;
        }
        line[0] += shares[0] * elevation_rad;
        let half_width_rad = (place.half_width * self.step_rad as f32).max(NARROWEST_RAD);
        line[1] += 4.0 / half_width_rad * shares[1] * elevation_rad;
    }
}

/// Whether a light stands in the zenith of a map point of a level, or in the nadir: there it has all azimuths.
fn overhead(map: &Gnomonic, level: &Level, light: &HeldLight) -> bool {
    let towards = map.map_vector(light.position);
    level.sees(towards.truncate() * (map.radius_m / towards.z))
}

/// Column and row of the outermost seen nodes: over them azimuths take their ends.
fn rim(level: &Level) -> Vec<[usize; 2]> {
    let (west, south) = (level.margin, level.margin);
    let (east, north) = (level.columns - 1 - level.margin, level.rows - 1 - level.margin);
    let rows = (west..=east).flat_map(|column| [[column, south], [column, north]]);
    let columns = (south..=north).flat_map(|row| [[west, row], [east, row]]);
    rows.chain(columns).collect()
}
