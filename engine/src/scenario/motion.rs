//! Resolves exposures, trajectory and pointing.

use glam::{DQuat, DVec3};
use hifitime::{Epoch, Unit};

use super::check::Check;
use super::resolved::{Camera, Elements, Pointing, Towards, Trajectory, Waypoint};
use super::spec::{self, HeightAbove, Spec};
use super::world;
use crate::geometry::Geodetic;

/// How far a quaternion's length may be from 1: more than the rounding of three decimals, less than a typing error.
const QUATERNION_LENGTH_TOLERANCE: f64 = 1e-3;

/// A count beyond its range is reported already; it must not fill the memory meanwhile.
const MOST_EXPOSURES: u32 = 100_000;

/// Epochs in order; empty where none could be read.
pub fn exposures(spec: &Spec, camera: &Camera, check: &mut Check) -> Vec<Epoch> {
    match &spec.exposures {
        spec::Exposures::Series { start, step_s, count } => {
            let Some(start) = check.epoch("exposures.start", start) else { return Vec::new() };
            (0..(*count).min(MOST_EXPOSURES)).map(|index| after(start, step_s * f64::from(index))).collect()
        }
        spec::Exposures::List(texts) => listed(texts, check),
        spec::Exposures::Isd => {
            check.needs(spec.camera.isd.is_some(), "exposures", "needs camera.isd, whose centre time it takes");
            let centre = camera.isd.as_ref().map_or(0.0, |isd| isd.centre_tdb_s);
            vec![Epoch::from_et_seconds(centre)]
        }
    }
}

fn listed(texts: &[String], check: &mut Check) -> Vec<Epoch> {
    let mut epochs: Vec<Epoch> = Vec::new();
    for (index, text) in texts.iter().enumerate() {
        let key = format!("exposures[{index}]");
        let Some(epoch) = check.epoch(&key, text) else { continue };
        let later = epochs.last().is_none_or(|earlier| epoch > *earlier);
        check.rule(later, &key, format!("{text:?}"), "is not later than the epoch before it");
        epochs.push(epoch);
    }
    epochs
}

/// `seconds` of physical time after `start`; leap seconds count. What is not finite is reported already
/// and must not stop the check here.
fn after(start: Epoch, seconds: f64) -> Epoch {
    let seconds = if seconds.is_finite() { seconds } else { 0.0 };
    start + seconds * Unit::Second
}

pub fn trajectory(spec: &Spec, exposures: &[Epoch], check: &mut Check) -> Trajectory {
    match &spec.trajectory {
        spec::Trajectory::Waypoints { points, height_above } => {
            above("trajectory.height_above", *height_above, spec.terrain.is_some(), check);
            waypoints(points, *height_above, exposures, check)
        }
        spec::Trajectory::Spk { path, naif_id } => {
            let known = path.is_some() || spec.kernels.is_some();
            check.needs(known, "trajectory", "needs path: the shipped kernels hold no spacecraft");
            let path = path.as_ref().map(|path| check.kernel("trajectory.path", path));
            Trajectory::Spk { path, naif_id: *naif_id }
        }
        spec::Trajectory::Oem { path } => Trajectory::Oem { path: check.file("trajectory.path", path) },
        spec::Trajectory::Isd => {
            check.needs(spec.camera.isd.is_some(), "trajectory", "needs camera.isd, whose poses it takes");
            check.needs(spec.camera.moments == 1, "camera.moments", "needs a trajectory: an ISD has one pose a line");
            let free = spec.pointing == spec::Pointing::default();
            check.needs(free, "pointing", "contradicts trajectory: Isd, which says it");
            Trajectory::Isd
        }
        spec::Trajectory::Orbit { .. } => orbit(&spec.trajectory, check),
        spec::Trajectory::State { epoch, position_m, velocity_m_s, gm_m3_s2 } => {
            let position_m = DVec3::from(*position_m);
            let inside_m = world::body(&spec.body).polar_radius_m;
            let rule = format!("is inside the body, whose polar radius is {inside_m} m");
            check.rule(
                position_m.length() >= inside_m || !position_m.is_finite(),
                "trajectory.position_m",
                position_m,
                rule,
            );
            Trajectory::State {
                epoch: check.epoch("trajectory.epoch", epoch).unwrap_or_default(),
                position_m,
                velocity_m_s: DVec3::from(*velocity_m_s),
                gm_m3_s2: *gm_m3_s2,
            }
        }
    }
}

fn waypoints(
    points: &[spec::Waypoint],
    height_above: HeightAbove,
    exposures: &[Epoch],
    check: &mut Check,
) -> Trajectory {
    let times_s: Vec<f64> = points.iter().map(|point| point.t_s).collect();
    over_time("trajectory.points", &times_s, exposures, check);
    let start = exposures.first().copied().unwrap_or_default();
    let resolved = |point: &spec::Waypoint| Waypoint {
        epoch: after(start, point.t_s),
        point: Geodetic::from_degrees(point.latitude_deg, point.longitude_deg, point.height_m),
    };
    Trajectory::Waypoints { points: points.iter().map(resolved).collect(), height_above }
}

fn orbit(written: &spec::Trajectory, check: &mut Check) -> Trajectory {
    let spec::Trajectory::Orbit {
        ref epoch,
        semi_major_axis_m,
        eccentricity,
        inclination_deg,
        node_deg,
        periapsis_deg,
        true_anomaly_deg,
        gm_m3_s2,
    } = *written
    else {
        unreachable!("called for orbits only")
    };
    let parabola = "is a parabola, which these elements cannot describe; give a State";
    check.rule(eccentricity != 1.0, "trajectory.eccentricity", eccentricity, parabola);
    let sign = "must be positive for an ellipse and negative for a hyperbola";
    check.rule(
        semi_major_axis_m * (1.0 - eccentricity) >= 0.0 && semi_major_axis_m != 0.0,
        "trajectory.semi_major_axis_m",
        semi_major_axis_m,
        sign,
    );
    Trajectory::Orbit {
        epoch: check.epoch("trajectory.epoch", epoch).unwrap_or_default(),
        elements: Elements {
            semi_major_axis_m,
            eccentricity,
            inclination_rad: inclination_deg.to_radians(),
            node_rad: node_deg.to_radians(),
            periapsis_rad: periapsis_deg.to_radians(),
            true_anomaly_rad: true_anomaly_deg.to_radians(),
        },
        gm_m3_s2,
    }
}

pub fn pointing(spec: &Spec, exposures: &[Epoch], check: &mut Check) -> Pointing {
    let (written, has_terrain) = (&spec.pointing, spec.terrain.is_some());
    let stands_still = matches!(&spec.trajectory, spec::Trajectory::Waypoints { points, .. } if points.len() < 2);
    let along_nothing = stands_still && written.towards == spec::Towards::AlongVelocity;
    check.needs(!along_nothing, "pointing.towards", "needs a trajectory that moves: of two waypoints or more");
    let towards = match &written.towards {
        spec::Towards::Nadir => Towards::Nadir,
        spec::Towards::AlongVelocity => Towards::AlongVelocity,
        spec::Towards::At { latitude_deg, longitude_deg, height_m, height_above } => {
            above("pointing.towards.height_above", *height_above, has_terrain, check);
            let point = Geodetic::from_degrees(*latitude_deg, *longitude_deg, *height_m);
            Towards::At { point, height_above: *height_above }
        }
        spec::Towards::Quaternion { w, x, y, z } => {
            let attitude = quaternion("pointing.towards", [*w, *x, *y, *z], check);
            Towards::Table(vec![(exposures.first().copied().unwrap_or_default(), attitude)])
        }
        spec::Towards::Table { points } => table(points, exposures, check),
        spec::Towards::Aem { path } => Towards::Aem { path: check.file("pointing.towards.path", path) },
    };
    let turned = matches!(towards, Towards::Table(_));
    check.needs(!turned || written.top.is_none(), "pointing.top", "has no meaning with a fixed attitude");
    let still = stands_still && written.top == Some(spec::Top::Velocity);
    check.needs(!still, "pointing.top", "needs a trajectory that moves: of two waypoints or more");
    Pointing { towards, top: written.top, roll_rad: written.roll_deg.to_radians() }
}

fn table(points: &[spec::Pose], exposures: &[Epoch], check: &mut Check) -> Towards {
    let times_s: Vec<f64> = points.iter().map(|point| point.t_s).collect();
    over_time("pointing.towards.points", &times_s, exposures, check);
    let start = exposures.first().copied().unwrap_or_default();
    let mut attitudes = Vec::new();
    for (index, point) in points.iter().enumerate() {
        let key = format!("pointing.towards.points[{index}]");
        attitudes.push((after(start, point.t_s), quaternion(&key, [point.w, point.x, point.y, point.z], check)));
    }
    Towards::Table(attitudes)
}

/// Heights above the terrain need one.
fn above(key: &str, height_above: HeightAbove, has_terrain: bool, check: &mut Check) {
    check.needs(has_terrain || height_above == HeightAbove::Spheroid, key, "needs terrain");
}

/// Times must increase; several must begin before the first exposure and end after the last.
fn over_time(key: &str, times_s: &[f64], exposures: &[Epoch], check: &mut Check) {
    let mut increasing = true;
    for (index, pair) in times_s.windows(2).enumerate().filter(|(_, pair)| pair[1] <= pair[0]) {
        let rule = format!("is not later than the {} s before it", pair[0]);
        check.rule(false, &format!("{key}[{}].t_s", index + 1), pair[1], rule);
        increasing = false;
    }
    let ([first_s, .., last_s], [first, .., last], true) = (times_s, exposures, increasing) else { return };
    let duration_s = (*last - *first).to_seconds();
    check.rule(*first_s <= 0.0, &format!("{key}[0].t_s"), first_s, "is after the first exposure at 0 s");
    let key = format!("{key}[{}].t_s", times_s.len() - 1);
    check.rule(*last_s >= duration_s, &key, last_s, format!("is before the last exposure at {duration_s} s"));
}

fn quaternion(key: &str, [w, x, y, z]: [f64; 4], check: &mut Check) -> DQuat {
    let attitude = DQuat::from_xyzw(x, y, z, w);
    let length = attitude.length();
    if !length.is_finite() {
        // Reported already.
        return DQuat::IDENTITY;
    }
    if (length - 1.0).abs() > QUATERNION_LENGTH_TOLERANCE {
        let rule = format!("has length {length:.4}, allowed is 1 within {QUATERNION_LENGTH_TOLERANCE}");
        check.rule(false, key, format!("(w: {w}, x: {x}, y: {y}, z: {z})"), rule);
        return DQuat::IDENTITY;
    }
    attitude.normalize()
}
