//! A path through given points: cubic splines in body-fixed axes.
//!
//! Between knots at `t_i` each coordinate is the cubic whose second derivatives `m_i` solve, with `h_i = t_{i+1} - t_i`,
//!
//! ```text
//! h_{i-1} m_{i-1} + 2 (h_{i-1} + h_i) m_i + h_i m_{i+1} = 6 ((y_{i+1} - y_i)/h_i - (y_i - y_{i-1})/h_{i-1})
//! ```
//!
//! so that position, velocity and acceleration are continuous. At the ends the acceleration is zero (natural) or the
//! velocity is given (clamped).
//!
//! # Assumptions
//! Axes turn with the body: a straight line between two points is a chord, which dips below a sphere of radius `R`
//! by `s²/8R` over a distance `s` (7 m over 10 km on the Moon).
//!
//! # References
//! de Boor (2001), A Practical Guide to Splines, revised ed., chapter IV.

use glam::DVec3;
use hifitime::{Epoch, Unit};

use super::TrajectoryError;
use crate::ephemeris::utc_text;
use crate::geometry::{BodyFixed, Position};

/// How a path begins and ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SplineEnds {
    /// No acceleration.
    Natural,
    /// Given velocities in the body's frame, m/s.
    Clamped { first_m_s: DVec3, last_m_s: DVec3 },
}

/// Points in time, joined smoothly.
#[derive(Debug, Clone, PartialEq)]
pub struct Waypoints {
    start: Epoch,
    offsets_s: Vec<f64>,
    points_m: Vec<DVec3>,
    accelerations_m_s2: Vec<DVec3>,
}

impl Waypoints {
    /// A path through points at seconds after `start`, in rising order.
    pub fn new(start: Epoch, points: &[(f64, Position<BodyFixed>)], ends: SplineEnds) -> Result<Self, TrajectoryError> {
        const NEEDED: usize = 2;
        if points.len() < NEEDED {
            return Err(TrajectoryError::TooFewWaypoints { needed: NEEDED, got: points.len() });
        }
        let (offsets_s, points_m): (Vec<f64>, Vec<DVec3>) =
            points.iter().map(|(offset_s, point)| (*offset_s, point.vector_m())).unzip();
        if let Some(index) = (0..points.len()).find(|i| !offsets_s[*i].is_finite() || !points_m[*i].is_finite()) {
            return Err(TrajectoryError::WaypointNotFinite { index });
        }
        if let Some(before) = (0..points.len() - 1).find(|i| offsets_s[i + 1] <= offsets_s[*i]) {
            let (index, offset_s, before_s) = (before + 1, offsets_s[before + 1], offsets_s[before]);
            return Err(TrajectoryError::Unsorted { index, offset_s, before, before_s });
        }
        let accelerations_m_s2 = spline_accelerations(&offsets_s, &points_m, ends);
        // Kept in a scale without leap seconds, in which offsets add up.
        let start = start.to_time_scale(hifitime::TimeScale::TAI);
        Ok(Self { start, offsets_s, points_m, accelerations_m_s2 })
    }

    /// First and last epoch.
    pub fn span(&self) -> (Epoch, Epoch) {
        let at = |offset_s: f64| self.start + offset_s * Unit::Second;
        (at(self.offsets_s[0]), at(self.offsets_s[self.offsets_s.len() - 1]))
    }

    /// Position and velocity, in m and m/s.
    pub fn state(&self, epoch: Epoch) -> Result<(Position<BodyFixed>, DVec3), TrajectoryError> {
        let (first, last) = self.span();
        if epoch < first || epoch > last {
            return Err(TrajectoryError::OutsideSpan {
                kind: "path of waypoints",
                epoch_utc: utc_text(epoch),
                from_utc: utc_text(first),
                until_utc: utc_text(last),
            });
        }
        let offset_s = (epoch - self.start).to_seconds();
        let after = self.offsets_s.partition_point(|knot_s| *knot_s <= offset_s);
        Ok(self.cubic(after.clamp(1, self.offsets_s.len() - 1) - 1, offset_s))
    }

    fn cubic(&self, i: usize, offset_s: f64) -> (Position<BodyFixed>, DVec3) {
        let h = self.offsets_s[i + 1] - self.offsets_s[i];
        let (left, right) = (self.offsets_s[i + 1] - offset_s, offset_s - self.offsets_s[i]);
        let (y0, y1) = (self.points_m[i], self.points_m[i + 1]);
        let (m0, m1) = (self.accelerations_m_s2[i], self.accelerations_m_s2[i + 1]);
        let position = (m0 * left.powi(3) + m1 * right.powi(3)) / (6.0 * h)
            + (y0 / h - m0 * h / 6.0) * left
            + (y1 / h - m1 * h / 6.0) * right;
        let velocity = (m1 * right * right - m0 * left * left) / (2.0 * h) + (y1 - y0) / h - (m1 - m0) * h / 6.0;
        (Position::from_m(position), velocity)
    }
}

/// Second derivatives at the knots, by Thomas's elimination; the matrix is diagonally dominant.
fn spline_accelerations(t: &[f64], y: &[DVec3], ends: SplineEnds) -> Vec<DVec3> {
    let last = t.len() - 1;
    let h = |i: usize| t[i + 1] - t[i];
    let slope = |i: usize| (y[i + 1] - y[i]) / h(i);
    // Row i: below, diagonal, above, right-hand side.
    let row = |i: usize| match ends {
        SplineEnds::Natural if i == 0 || i == last => (0.0, 1.0, 0.0, DVec3::ZERO),
        SplineEnds::Clamped { first_m_s, .. } if i == 0 => (0.0, 2.0 * h(0), h(0), 6.0 * (slope(0) - first_m_s)),
        SplineEnds::Clamped { last_m_s, .. } if i == last => {
            (h(last - 1), 2.0 * h(last - 1), 0.0, 6.0 * (last_m_s - slope(last - 1)))
        }
        _ => (h(i - 1), 2.0 * (h(i - 1) + h(i)), h(i), 6.0 * (slope(i) - slope(i - 1))),
    };
    let mut above = vec![0.0; t.len()];
    let mut m = vec![DVec3::ZERO; t.len()];
    for i in 0..=last {
        let (below, diagonal, next, right) = row(i);
        let (previous_above, previous_m) = if i == 0 { (0.0, DVec3::ZERO) } else { (above[i - 1], m[i - 1]) };
        let pivot = diagonal - below * previous_above;
        above[i] = next / pivot;
        m[i] = (right - below * previous_m) / pivot;
    }
    for i in (0..last).rev() {
        m[i] = m[i] - above[i] * m[i + 1];
    }
    m
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start() -> Epoch {
        crate::ephemeris::parse_epoch("2026-09-08T00:00:00Z").unwrap()
    }

    fn path(points: &[(f64, DVec3)], ends: SplineEnds) -> Waypoints {
        let points: Vec<_> = points.iter().map(|(t, p)| (*t, Position::from_m(*p))).collect();
        Waypoints::new(start(), &points, ends).unwrap()
    }

    /// A clamped cubic spline reproduces any cubic.
    #[test]
    fn a_cubic_is_met_everywhere() {
        let cubic = |t: f64| DVec3::new(1.0 + t, 3.0 * t * t - t, 2.0 - 0.1 * t.powi(3));
        let slope = |t: f64| DVec3::new(1.0, 6.0 * t - 1.0, -0.3 * t * t);
        let knots = [0.0, 1.0, 4.0, 4.5, 10.0];
        let ends = SplineEnds::Clamped { first_m_s: slope(0.0), last_m_s: slope(10.0) };
        let path = path(&knots.map(|t| (t, cubic(t))), ends);
        for i in 0..=100 {
            let t = f64::from(i) * 0.1;
            let (position, velocity) = path.state(start() + t * Unit::Second).unwrap();
            assert!(position.vector_m().distance(cubic(t)) < 1e-11, "{t}");
            assert!(velocity.distance(slope(t)) < 1e-11, "{t}");
        }
    }

    #[test]
    fn two_points_are_joined_by_a_straight_line() {
        let path = path(&[(0.0, DVec3::ZERO), (10.0, DVec3::X * 20.0)], SplineEnds::Natural);
        let (position, velocity) = path.state(start() + 2.5 * Unit::Second).unwrap();
        assert_eq!((position.vector_m(), velocity), (DVec3::X * 5.0, DVec3::X * 2.0));
    }

    #[test]
    fn position_velocity_and_acceleration_are_continuous_at_knots_and_ends_are_free() {
        let wild = [(0.0, DVec3::ZERO), (1.0, DVec3::X * 5.0), (3.0, DVec3::Y * -7.0), (3.5, DVec3::Z)];
        let path = path(&wild, SplineEnds::Natural);
        for (i, t) in [(1, 1.0), (2, 3.0)] {
            let ((p0, v0), (p1, v1)) = (path.cubic(i - 1, t), path.cubic(i, t));
            assert!(p0.distance_m(p1) < 1e-13 && v0.distance(v1) < 1e-12);
            assert!(p0.vector_m().distance(wild[i].1) < 1e-13);
        }
        assert_eq!(path.accelerations_m_s2[0], DVec3::ZERO);
        assert_eq!(path.accelerations_m_s2[3], DVec3::ZERO);
    }

    #[test]
    fn the_path_ends_where_it_ends() {
        let path = path(&[(0.0, DVec3::ZERO), (10.0, DVec3::X)], SplineEnds::Natural);
        assert!(path.state(start() + 10.0 * Unit::Second).is_ok());
        let error = path.state(start() + 10.1 * Unit::Second).unwrap_err().to_string();
        assert!(error.contains("2026-09-08T00:00:10.100Z is outside its span 2026-09-08T00:00:00Z"), "{error}");
    }

    #[test]
    fn bad_waypoints_are_refused() {
        let new = |points: &[(f64, DVec3)]| {
            let points: Vec<_> = points.iter().map(|(t, p)| (*t, Position::from_m(*p))).collect();
            Waypoints::new(start(), &points, SplineEnds::Natural).unwrap_err().to_string()
        };
        assert!(new(&[(0.0, DVec3::X)]).contains("at least 2 waypoints, got 1"));
        assert!(
            new(&[(0.0, DVec3::X), (1.0, DVec3::X), (1.0, DVec3::Y)]).contains("waypoint 2 is 1 s after the start")
        );
        assert!(new(&[(0.0, DVec3::X), (f64::NAN, DVec3::X)]).contains("waypoint 1"));
    }
}
