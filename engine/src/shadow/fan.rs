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
//! What the line loses: `docs/experiments/shadow_methods.md`.
//!
//! Both are linear in the planes' elevations, so that planes are added one after the other and need not be kept.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};
use std::ops::Range;

use glam::DVec2;
use rayon::prelude::*;

use super::light::{Pointing, QuantizedLight, WIDEST_RAD};
use super::skylines::{Skyline, SurfacePoints};
use crate::horizon::settings::direction;
use crate::terrain::{Gnomonic, Level, Surface};

/// Places across the disc, in its half widths, and their shares.
const ACROSS: [[f32; 2]; 5] =
    [[-0.866_025_4, 1.0 / 12.0], [-0.5, 0.25], [0.0, 1.0 / 3.0], [0.5, 0.25], [0.866_025_4, 1.0 / 12.0]];

/// Between two azimuths where nobody asks for another step, in degrees.
pub const STEP_DEG: f64 = 0.15;

/// Below this half width a disc has no slope.
const NARROWEST_RAD: f32 = 1e-6;

/// The line across a disc from skylines at [`THREE`] places: the same sums with `n = 3`.
pub fn line_of_three(elevations_rad: [f64; 3], half_width_rad: f64) -> Skyline {
    let [a, b, c] = elevations_rad;
    let slope = if half_width_rad > 0.0 { (c - a) * THREE[2] / half_width_rad } else { 0.0 };
    [(0.25 * a + 0.5 * b + 0.25 * c) as f32, slope as f32]
}

/// Places across the disc in its half widths; the first and the last have half the share of the middle.
pub const THREE: [f64; 3] = [-FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2];

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

/// Nodes side by side that are worked on at once.
const LANES: usize = 16;

/// Across fewer nodes than [`LANES`] an azimuth that turns by less is taken to turn evenly, which misses it by a ten
/// thousandth of this.
const EVEN_RAD: f64 = 0.01;

/// Discs of neighbouring nodes on a fan, in steps from its first plane.
#[derive(Debug, Clone, Copy, Default)]
struct Places {
    at: [f32; LANES],
    half_width: [f32; LANES],
}

/// Nodes of a level, and a light as seen from them.
#[derive(Debug, Clone, Copy)]
pub struct LitNodes<'a> {
    pub map: &'a Gnomonic,
    pub points: SurfacePoints<'a>,
    pub light: &'a QuantizedLight,
}

impl LitNodes<'_> {
    pub fn pointing(&self, node: usize) -> Pointing {
        self.light.pointing(self.map, self.points.lifted(node))
    }
}

impl Fan {
    /// The azimuths of lights on a level, no wider apart than `step_rad` unless they would be more than `most`; at least
    /// three.
    pub fn over(map: &Gnomonic, level: &Level, lights: &[QuantizedLight], step_rad: f64, most: usize) -> Self {
        let rim = rim(level);
        let centre = level.lifted_node(level.columns / 2, level.rows / 2);
        let middle = lights.first().map_or(DVec2::Y, |light| light.pointing(map, centre).towards);
        let mut fan = Self { step_rad, first: 0, planes: 0, middle, middle_rad: middle.x.atan2(middle.y) };
        let mut ends_rad = [f64::INFINITY, f64::NEG_INFINITY];
        for light in lights {
            for &[column, row] in &rim {
                let pointing = light.pointing(map, level.lifted_node(column, row));
                let turn_rad = fan.turn_rad(pointing.towards);
                ends_rad[0] = ends_rad[0].min(turn_rad - pointing.half_width_rad);
                ends_rad[1] = ends_rad[1].max(turn_rad + pointing.half_width_rad);
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
        direction(self.azimuth_rad(plane))
    }

    /// Angle from the middle to a direction, clockwise on the map.
    fn turn_rad(&self, towards: DVec2) -> f64 {
        (towards.x * self.middle.y - towards.y * self.middle.x).atan2(towards.dot(self.middle))
    }

    /// Whether a light's disc lies between the fan's outermost planes.
    pub fn spans(&self, pointing: &Pointing) -> bool {
        let (at, half_width) = self.steps(pointing);
        // The rim of a level is where azimuths are outermost but for the parallax of heights.
        (at - half_width) > -0.01 && at + half_width < (self.planes - 1) as f64 + 0.01
    }

    fn steps(&self, pointing: &Pointing) -> (f64, f64) {
        let at = (self.middle_rad + self.turn_rad(pointing.towards)) / self.step_rad - self.first as f64;
        (at, pointing.half_width_rad / self.step_rad)
    }

    /// Adds to the lines of a level's nodes what `planes` of elevations, by plane and node, have in them.
    pub fn add(
        &self,
        field: &mut [Skyline],
        lit: &LitNodes,
        planes: &Range<usize>,
        elevation_rad: impl Fn(usize, usize) -> f32 + Sync,
    ) {
        let columns = lit.points.columns;
        field.par_chunks_mut(columns).enumerate().for_each(|(row, lines)| {
            for (block, lines) in lines.chunks_mut(LANES).enumerate() {
                let (first, last) = (row * columns + block * LANES, lines.len() - 1);
                let places = self.places(lit, first, lines.len());
                let near = self.near(&places);
                for plane in near.start.max(planes.start)..near.end.min(planes.end) {
                    let elevations_rad = std::array::from_fn(|lane| elevation_rad(plane, first + lane.min(last)));
                    self.add_plane(lines, &places, plane, &elevations_rad);
                }
            }
        });
    }

    /// The discs of nodes side by side.
    fn places(&self, lit: &LitNodes, first: usize, count: usize) -> Places {
        let exact = |lane: usize| self.steps(&lit.pointing(first + lane.min(count - 1)));
        let (low, high) = (exact(0), exact(count - 1));
        let even = (high.0 - low.0).abs() * self.step_rad < EVEN_RAD;
        let mut places = Places::default();
        for lane in 0..LANES {
            let share = lane.min(count - 1) as f64 / (count.max(2) - 1) as f64;
            let between = (low.0 + share * (high.0 - low.0), low.1 + share * (high.1 - low.1));
            let (at, half_width) = if even { between } else { exact(lane) };
            (places.at[lane], places.half_width[lane]) = (at as f32, half_width as f32);
        }
        places
    }

    /// The planes with a share in lines.
    fn near(&self, places: &Places) -> Range<usize> {
        let [outermost, _] = ACROSS[ACROSS.len() - 1];
        let mut ends = [f32::MAX, f32::MIN];
        for (at, half_width) in places.at.iter().zip(&places.half_width) {
            ends = [ends[0].min(at - outermost * half_width), ends[1].max(at + outermost * half_width)];
        }
        let last = self.planes - 1;
        let [low, high] = [ends[0].floor(), ends[1].ceil()].map(|at| (at.max(0.0) as usize).min(last));
        low..high + 1
    }

    /// Adds what a plane with elevations at nodes has in their lines.
    fn add_plane(&self, lines: &mut [Skyline], places: &Places, plane: usize, elevations_rad: &[f32; LANES]) {
        let (last, plane) = ((self.planes - 1) as f32, plane as f32);
        let [mut means, mut tilts] = [[0.0_f32; LANES]; 2];
        for [x, weight] in ACROSS {
            let discs = places.at.iter().zip(&places.half_width);
            for ((mean, tilt), (at, half_width)) in means.iter_mut().zip(&mut tilts).zip(discs) {
                let at = (at + half_width * x).max(0.0).min(last);
                let near = weight * (1.0 - (at - plane).abs()).max(0.0);
                *mean += near;
                *tilt += x * near;
            }
        }
        let step_rad = self.step_rad as f32;
        for (lane, line) in lines.iter_mut().enumerate() {
            let half_width_rad = (places.half_width[lane] * step_rad).max(NARROWEST_RAD);
            line[0] += means[lane] * elevations_rad[lane];
            line[1] += 4.0 / half_width_rad * tilts[lane] * elevations_rad[lane];
        }
    }
}

/// Azimuths of all lights, each over its places in the exposures, no wider apart than `step_rad`: by light, face and level.
pub fn fans(surface: &Surface, exposures: &[Vec<QuantizedLight>], step_rad: f64) -> Vec<Vec<Vec<Fan>>> {
    let of_light = |light: usize| {
        let places: Vec<QuantizedLight> = exposures.iter().map(|lights| lights[light]).collect();
        let of_level = |map: &Gnomonic, level: &Level| Fan::over(map, level, &places, step_rad, usize::MAX);
        let faces = surface.terrain.faces.iter();
        faces.map(|face| face.levels.iter().map(|level| of_level(&face.map, level)).collect()).collect()
    };
    (0..exposures.first().map_or(0, Vec::len)).map(of_light).collect()
}

/// The most planes, [`STEP_DEG`] apart, that a level gets towards one light.
pub fn azimuths_spanned(surface: &Surface, exposures: &[Vec<QuantizedLight>]) -> usize {
    let fans = fans(surface, exposures, STEP_DEG.to_radians());
    fans.iter().flatten().flatten().map(|fan| fan.planes).max().unwrap_or(0)
}

/// Whether a light stands in the zenith of a map point of a level, or in the nadir: there it has all azimuths.
fn overhead(map: &Gnomonic, level: &Level, light: &QuantizedLight) -> bool {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Body, Geodetic, Position};

    fn flat(columns: usize) -> Level {
        let nodes = columns * columns;
        let half_m = 500.0 * (columns - 1) as f64;
        let (heights_m, gap) = (vec![0.0; nodes], vec![false; nodes]);
        Level {
            columns,
            rows: columns,
            posting_m: 1000.0,
            west_m: -half_m,
            south_m: -half_m,
            heights_m,
            gap,
            margin: 0,
        }
    }

    /// The Sun over the middle of the map.
    fn sun(map: &Gnomonic, azimuth_rad: f64, elevation_rad: f64) -> QuantizedLight {
        let ((sin_a, cos_a), (sin_e, cos_e)) = (azimuth_rad.sin_cos(), elevation_rad.sin_cos());
        let towards = map.map_from_body.inverse().turn(glam::DVec3::new(cos_e * sin_a, cos_e * cos_a, sin_e));
        QuantizedLight::new(Position::from_m(1.5e11 * towards), 0.00465)
    }

    fn map() -> Gnomonic {
        Gnomonic::about(&Body::moon(), Geodetic::from_degrees(-88.0, 10.0, 0.0))
    }

    /// Lines of all nodes where the skyline is a function of azimuth.
    fn lines(
        level: &Level,
        light: &QuantizedLight,
        step_deg: f64,
        skyline: impl Fn(f64) -> f64 + Sync,
    ) -> Vec<Skyline> {
        let (map, points) = (map(), SurfacePoints::of(level));
        let fan = Fan::over(&map, level, &[*light], step_deg.to_radians(), usize::MAX);
        let mut field = vec![[0.0; 2]; points.count()];
        let lit = LitNodes { map: &map, points, light };
        fan.add(&mut field, &lit, &(0..fan.planes), |plane, _| skyline(fan.azimuth_rad(plane)) as f32);
        field
    }

    /// Wherever the Sun stands, across north and south too. 1e-6 rad: a plane's place on the fan is a float.
    #[test]
    fn a_straight_skyline_is_its_own_line() {
        let level = flat(37);
        for azimuth_deg in [0.0_f64, 0.2, 179.9, -179.9, 90.0, -100.0, 300.0] {
            let light = sun(&map(), azimuth_deg.to_radians(), 0.05);
            let middle_rad = azimuth_deg.to_radians();
            let height = |azimuth_rad: f64| 0.04 + 0.3 * (azimuth_rad - middle_rad + PI).rem_euclid(TAU) - 0.3 * PI;
            let field = lines(&level, &light, 0.15, height);
            for (index, [elevation_rad, slope]) in field.into_iter().enumerate() {
                let towards = light.pointing(&map(), SurfacePoints::of(&level).lifted(index)).towards;
                let expected = height(towards.x.atan2(towards.y));
                assert!((f64::from(elevation_rad) - expected).abs() < 1e-6, "{azimuth_deg}° {index}: {elevation_rad}");
                assert!((slope - 0.3).abs() < 1e-3, "{azimuth_deg}° {index}: {slope}");
            }
        }
    }

    /// The peak `−|x|` across the unit disc has the mean `−∫|x|√(1−x²)dx/∫√(1−x²)dx = −4/(3π)`, −0.4244 half widths; sums of
    /// five and of three places give −0.3943 and −0.3536.
    #[test]
    fn a_peak_within_the_disc_counts_by_its_mean() {
        let light = sun(&map(), 1.0, 0.05);
        let level = flat(3);
        let half_width_rad = light.pointing(&map(), level.lifted_node(1, 1)).half_width_rad;
        let peak = |azimuth_rad: f64| -(azimuth_rad - 1.0).abs() / half_width_rad;
        let [elevation, slope] = lines(&level, &light, 0.001, peak)[4];
        assert!(
            (elevation + 0.3943).abs() < 2e-3 && slope.abs() * half_width_rad as f32 <= 0.01,
            "{elevation} {slope}"
        );
        let [elevation, slope] = line_of_three(THREE.map(|x| -x.abs()), half_width_rad);
        assert!((elevation + 0.3536).abs() < 1e-4 && slope == 0.0);
    }

    #[test]
    fn a_fan_brackets_the_disc_and_is_three_planes_at_least() {
        let (map, level) = (map(), flat(65));
        for step_deg in [0.01_f64, 0.15, 5.0] {
            let lights = [0.99, 1.0, 1.01].map(|azimuth_rad| sun(&map, azimuth_rad, 0.05));
            let fan = Fan::over(&map, &level, &lights, step_deg.to_radians(), usize::MAX);
            assert!(fan.planes >= 3 && fan.step_rad <= step_deg.to_radians() + 1e-12, "{fan:?}");
            for light in &lights {
                assert!(
                    (0..SurfacePoints::of(&level).count())
                        .all(|i| fan.spans(&light.pointing(&map, SurfacePoints::of(&level).lifted(i))))
                );
            }
            let other = sun(&map, 1.2, 0.05).pointing(&map, level.lifted_node(0, 0));
            assert!(!fan.spans(&other) || step_deg == 5.0);
        }
    }

    #[test]
    fn under_the_zenith_a_fan_goes_all_around_in_as_many_planes_as_allowed() {
        let light = sun(&map(), 0.3, PI / 2.0 - 0.001);
        let fan = Fan::over(&map(), &flat(65), &[light], 0.002, 360);
        assert!(fan.planes <= 361 && fan.planes as f64 * fan.step_rad > TAU, "{fan:?}");
    }
}
