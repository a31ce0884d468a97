//! The points of a sweep, and the scenario at each of them.
//!
//! ```text
//! u ∈ [0, 1)ⁿ of the design --axes--> values --> a scenario
//! ```
//!
//! Which values a point has depends on the design alone, not on how many of its points are rendered. The axes stand in the order
//! of their fields, each with its own stream of random numbers (ChaCha8), so that another axis changes none of the others.
//!
//! # References
//! McKay, Beckman & Conover 1979, doi:10.1080/00401706.1979.10489755.
//! Joe & Kuo 2008, doi:10.1137/070709359, whose direction numbers `new-joe-kuo-6` Sobol's sequence has here.

use glam::{DMat3, DQuat, DVec2, DVec3};
use hifitime::Unit;
use rand::seq::SliceRandom;
use rand::{Rng, RngCore, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::check::Check;
use super::resolved::{Albedo, Scenario, Towards, Trajectory};
use super::spec::{self, Axis, Design};
use super::varied::{Point, Sweep, Varied};
use crate::geometry::Geodetic;

/// More images than this would fill any disk.
const MOST_IMAGES: usize = 1_000_000;

impl Varied {
    /// What values may be.
    fn allowed(self) -> [f64; 2] {
        match self {
            Self::EpochS => [-1e10, 1e10],
            Self::SunAzimuthDeg | Self::RollDeg => [-360.0, 360.0],
            Self::SunElevationDeg => [-90.0, 90.0],
            Self::NorthM | Self::EastM => [-1e7, 1e7],
            Self::HeightFactor => [1e-6, 1e6],
            Self::Albedo => [0.0, 1.0],
            Self::NoiseSeed => [0.0, 1e10],
        }
    }

    /// What else the scenario must have.
    fn needs(self, scenario: &Scenario) -> Option<&'static str> {
        let waypoints = matches!(scenario.trajectory, Trajectory::Waypoints { .. });
        let (holds, needs) = match self {
            Self::EpochS => (scenario.sun.fixed.is_none() || !waypoints, "needs a Sun that moves, not sun.fixed"),
            Self::SunAzimuthDeg | Self::SunElevationDeg => {
                (scenario.sun.fixed.is_some(), "needs sun.fixed, which says the rest of where the Sun stands")
            }
            Self::NorthM | Self::EastM | Self::HeightFactor => (waypoints, "needs trajectory: Waypoints"),
            Self::RollDeg => {
                let table = matches!(scenario.pointing.towards, Towards::Table(_) | Towards::Aem { .. });
                (!table, "needs pointing towards Nadir, At or AlongVelocity")
            }
            Self::Albedo => (
                matches!(scenario.albedo, Albedo::Constant(_)),
                "needs surface.albedo: Constant, in whose place it stands",
            ),
            Self::NoiseSeed => (scenario.detector.is_some(), "needs detector, whose noise it seeds"),
        };
        (!holds).then_some(needs)
    }
}

/// The sweep of a scenario that is resolved but for it.
pub fn sweep(written: &spec::Sweep, scenario: &Scenario, check: &mut Check) -> Option<Sweep> {
    let axes = axes(written);
    check.needs(
        !axes.is_empty(),
        "sweep",
        "needs something that varies, as in sun_azimuth_deg: Range(from: 0, to: 360)",
    );
    for (varied, axis) in &axes {
        let key = format!("sweep.{}", varied.key());
        if let Some(needs) = varied.needs(scenario) {
            check.needs(false, &key, needs);
        }
        let [least, most] = varied.allowed();
        let ends = ends(axis);
        let rule = format!("is not within [{least}, {most}]");
        check.rule(least <= ends[0] && ends[1] <= most, &key, format!("{} to {}", ends[0], ends[1]), rule);
        let open = matches!(axis, Axis::Range { .. }) && written.design == Design::Grid;
        check.needs(!open, &key, "needs Values or Steps: a grid has points at given values only");
    }
    let count = count(written.design, &axes);
    let images = count.saturating_mul(scenario.exposures.len());
    let rule = format!("points make {images} images, at most {MOST_IMAGES} are allowed");
    check.rule(images <= MOST_IMAGES, "sweep.design", count, rule);
    (images <= MOST_IMAGES).then(|| Sweep { written: written.clone(), points: points(written.design, &axes, count) })
}

/// How far the shares of a split may be from adding up to 1: the rounding of three decimals.
const SHARES_TOLERANCE: f64 = 1e-3;

pub fn check_split(split: &spec::Split, check: &mut Check) {
    let sum = split.train + split.validation + split.test;
    let rule = format!("is what train, validation and test add up to, want 1 within {SHARES_TOLERANCE}");
    check.rule((sum - 1.0).abs() <= SHARES_TOLERANCE || !sum.is_finite(), "split", format!("{sum:.4}"), rule);
}

fn axes(written: &spec::Sweep) -> Vec<(Varied, &Axis)> {
    use Varied::*;
    let spec::Sweep {
        design: _,
        epoch_s,
        sun_azimuth_deg,
        sun_elevation_deg,
        north_m,
        east_m,
        height_factor,
        roll_deg,
        albedo,
        noise_seed,
    } = written;
    let all = [
        (EpochS, epoch_s),
        (SunAzimuthDeg, sun_azimuth_deg),
        (SunElevationDeg, sun_elevation_deg),
        (NorthM, north_m),
        (EastM, east_m),
        (HeightFactor, height_factor),
        (RollDeg, roll_deg),
        (Albedo, albedo),
        (NoiseSeed, noise_seed),
    ];
    all.into_iter().filter_map(|(varied, axis)| Some((varied, axis.as_ref()?))).collect()
}

fn ends(axis: &Axis) -> [f64; 2] {
    match axis {
        Axis::Values(values) => {
            let end = |choose: fn(f64, f64) -> f64| values.iter().copied().reduce(choose).unwrap_or(f64::NAN);
            [end(f64::min), end(f64::max)]
        }
        Axis::Steps { from, to, .. } | Axis::Range { from, to } => [from.min(*to), from.max(*to)],
    }
}

/// How many values an axis has; one where it has any.
fn values(axis: &Axis) -> usize {
    match axis {
        Axis::Values(values) => values.len(),
        Axis::Steps { count, .. } => *count as usize,
        Axis::Range { .. } => 1,
    }
}

/// The value at `share` of the way through an axis, in [0, 1).
fn at(axis: &Axis, share: f64) -> f64 {
    let index = |count: usize| ((share * count as f64) as usize).min(count - 1);
    match axis {
        Axis::Values(values) => values[index(values.len())],
        Axis::Steps { from, count: 1, .. } => *from,
        Axis::Steps { from, to, count } => {
            let step = index(*count as usize) as f64 / f64::from(count - 1);
            from * (1.0 - step) + to * step
        }
        Axis::Range { from, to } => from * (1.0 - share) + to * share,
    }
}

fn count(design: Design, axes: &[(Varied, &Axis)]) -> usize {
    match design {
        Design::Grid => axes.iter().fold(1, |count: usize, (_, axis)| count.saturating_mul(values(axis))),
        Design::Uniform { count, .. } | Design::LatinHypercube { count, .. } | Design::Sobol { count, .. } => {
            count as usize
        }
    }
}

fn points(design: Design, axes: &[(Varied, &Axis)], count: usize) -> Vec<Point> {
    let shares: Vec<Vec<f64>> = (0..axes.len()).map(|axis| shares(design, axes, axis, count)).collect();
    let value = |index: usize| {
        move |(axis, shares): (&(Varied, &Axis), &Vec<f64>)| {
            let value = at(axis.1, shares[index]);
            (axis.0, if axis.0 == Varied::NoiseSeed { value.round() } else { value })
        }
    };
    (0..count).map(|index| Point(axes.iter().zip(&shares).map(value(index)).collect())).collect()
}

/// Where the points lie along one axis.
fn shares(design: Design, axes: &[(Varied, &Axis)], axis: usize, count: usize) -> Vec<f64> {
    let random = |seed: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        // A stream for each quantity, whichever others vary.
        random.set_stream(axes[axis].0 as u64);
        random
    };
    match design {
        Design::Grid => {
            let faster: usize = axes[axis + 1..].iter().map(|(_, axis)| values(axis)).product();
            let own = values(axes[axis].1);
            // The middle of a value's part of [0, 1): rounding cannot move it to the next.
            (0..count).map(|index| ((index / faster % own) as f64 + 0.5) / own as f64).collect()
        }
        Design::Uniform { seed, .. } => {
            let mut random = random(seed);
            (0..count).map(|_| random.random()).collect()
        }
        Design::LatinHypercube { seed, .. } => {
            let mut random = random(seed);
            let mut strata: Vec<usize> = (0..count).collect();
            strata.shuffle(&mut random);
            strata.into_iter().map(|stratum| (stratum as f64 + random.random::<f64>()) / count as f64).collect()
        }
        Design::Sobol { seed, .. } => {
            let shift = if seed == 0 { 0 } else { random(seed).next_u32() };
            let directions = directions(axis);
            (0..count as u32).map(|index| f64::from(sobol(&directions, index) ^ shift) / 2_f64.powi(32)).collect()
        }
    }
}

/// Degree, coefficients and initial numbers of the primitive polynomials of `new-joe-kuo-6`, dimensions 2 to 9.
const POLYNOMIALS: [(usize, u32, &[u32]); 8] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
];

/// Direction numbers of a dimension, the first the highest bit.
fn directions(dimension: usize) -> [u32; 32] {
    let mut v: [u32; 32] = std::array::from_fn(|bit| 1 << (31 - bit));
    let Some((degree, coefficients, initial)) = dimension.checked_sub(1).map(|at| POLYNOMIALS[at]) else { return v };
    for bit in 0..32 {
        v[bit] = if bit < degree {
            initial[bit] << (31 - bit)
        } else {
            let taps = (1..degree).filter(|tap| coefficients >> (degree - 1 - tap) & 1 == 1);
            taps.fold(v[bit - degree] ^ (v[bit - degree] >> degree), |sum, tap| sum ^ v[bit - tap])
        };
    }
    v
}

/// Point `index` in the order of Gray's code, as everywhere.
fn sobol(directions: &[u32; 32], index: u32) -> u32 {
    let gray = index ^ (index >> 1);
    (0..32).filter(|bit| gray >> bit & 1 == 1).fold(0, |sum, bit| sum ^ directions[bit])
}

impl Scenario {
    /// How often the exposures are made: 1 without a sweep.
    pub fn points(&self) -> usize {
        self.sweep.as_ref().map_or(1, |sweep| sweep.points.len())
    }

    /// All images, those of one point after those of the one before.
    pub fn images(&self) -> usize {
        self.exposures.len() * self.points()
    }

    /// The scenario at a point of its sweep, without the sweep; itself where it has none.
    pub fn at_point(&self, point: usize) -> Self {
        let mut scenario = Self { sweep: None, ..self.clone() };
        let mut over_ground_m = DVec2::ZERO;
        for &(varied, value) in self.sweep.iter().flat_map(|sweep| &sweep.points[point].0) {
            match varied {
                Varied::EpochS => scenario.delay(value),
                Varied::SunAzimuthDeg | Varied::SunElevationDeg => {
                    if let Some(sun) = &mut scenario.sun.fixed {
                        let angle_rad = value.to_radians();
                        if varied == Varied::SunAzimuthDeg {
                            sun.azimuth_rad = angle_rad
                        } else {
                            sun.elevation_rad = angle_rad
                        }
                    }
                }
                Varied::NorthM => over_ground_m.y = value,
                Varied::EastM => over_ground_m.x = value,
                Varied::HeightFactor => scenario.each_waypoint(|point| point.height_m *= value),
                Varied::RollDeg => scenario.pointing.roll_rad += value.to_radians(),
                Varied::Albedo => scenario.albedo = Albedo::Constant(value),
                Varied::NoiseSeed => scenario.seed = value as u64,
            }
        }
        if over_ground_m != DVec2::ZERO {
            scenario.carry(over_ground_m);
        }
        scenario
    }

    fn each_waypoint(&mut self, change: impl Fn(&mut Geodetic)) {
        if let Trajectory::Waypoints { points, .. } = &mut self.trajectory {
            points.iter_mut().for_each(|waypoint| change(&mut waypoint.point));
        }
    }

    fn delay(&mut self, seconds: f64) {
        let delay = seconds * Unit::Second;
        self.exposures.iter_mut().for_each(|epoch| *epoch += delay);
        if let Trajectory::Waypoints { points, .. } = &mut self.trajectory {
            points.iter_mut().for_each(|waypoint| waypoint.epoch += delay);
        }
        if let Towards::Table(rows) = &mut self.pointing.towards {
            rows.iter_mut().for_each(|(epoch, _)| *epoch += delay);
        }
    }

    /// Turns the path and what is looked at about the body's centre, so that the latter (or the first waypoint) moves by
    /// metres east and north.
    fn carry(&mut self, over_ground_m: DVec2) {
        let Trajectory::Waypoints { points, .. } = &self.trajectory else { return };
        let reference = match &self.pointing.towards {
            Towards::At { point, .. } => *point,
            _ => points[0].point,
        };
        let local_from_body: DMat3 = self.body.local_from_body(reference).matrix();
        // Towards (east, north): a right-handed turn about the horizontal axis to the left of the way.
        let axis = local_from_body.transpose() * DVec3::new(-over_ground_m.y, over_ground_m.x, 0.0).normalize();
        let turn =
            DQuat::from_axis_angle(axis, over_ground_m.length() / self.body.gaussian_radius_m(reference.latitude_rad));
        let body = self.body.clone();
        let carried = |point: &mut Geodetic| {
            let up = turn * body.up(*point).unit();
            point.latitude_rad = up.z.clamp(-1.0, 1.0).asin();
            point.longitude_east_rad = up.y.atan2(up.x);
        };
        self.each_waypoint(carried);
        if let Towards::At { point, .. } = &mut self.pointing.towards {
            carried(point);
        }
    }
}

#[cfg(test)]
mod tests;
