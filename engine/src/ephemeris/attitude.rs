//! Where the camera looks: pointing laws and tables of quaternions.
//!
//! Camera axes are OpenCV's: `z` along the boresight, `x` to the right, `y` down in the image. A law gives the
//! boresight `z` and a direction `t` towards which the top of the image leans; then
//!
//! ```text
//! y = -(t - (t·z) z) / |…|,    x = y × z
//! ```
//!
//! and roll `ρ` turns the camera about its boresight, right-handed (clockwise as the camera sees; the scene turns
//! the other way in the image): `x' = x cos ρ + y sin ρ`, `y' = y cos ρ - x sin ρ`.
//!
//! A quaternion `q` is scalar first and turns components in the body's frame into components in the camera's
//! (`v_camera = q v_body q*`), as SPICE's C-matrices; `q` and `-q` are one attitude.
//!
//! # References
//! Shoemake (1985), Proc. SIGGRAPH 19, 245, doi:10.1145/325165.325242, for slerp.

use glam::{DMat3, DQuat, DVec3};
use hifitime::{Epoch, TimeScale, Unit};

use super::utc_text;
use crate::geometry::{Body, BodyFixed, Camera, Geodetic, Position, Rotation};

/// How far a quaternion's length may be from 1 before it is taken for a mistake.
const LENGTH_TOLERANCE: f64 = 1e-3;
/// Sine of the angle between boresight and top below which the roll is undefined.
const PARALLEL: f64 = 1e-6;

/// What decides where the camera looks.
#[derive(Debug, Clone, PartialEq)]
pub enum Pointing {
    /// Down the spheroid's normal.
    Nadir { top: Top, roll_rad: f64 },
    /// At a point of the surface.
    AtPoint { point: Geodetic, top: Top, roll_rad: f64 },
    /// Along the velocity against the turning body.
    AlongVelocity { top: Top, roll_rad: f64 },
    /// One attitude against the body.
    Fixed(Quaternion),
    /// Attitudes at given epochs.
    Table(AttitudeTable),
}

/// Whither the top of the image leans.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Top {
    /// The body's north pole; straight above or below a pole the way north of the meridian of longitude 0.
    North,
    /// The velocity against the turning body: ground enters the image at the top.
    Velocity,
    /// Away from the ground.
    Up,
}

/// A unit quaternion, camera from body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quaternion(DQuat);

/// Quaternions in time, joined by slerp on the shorter way.
#[derive(Debug, Clone, PartialEq)]
pub struct AttitudeTable {
    start: Epoch,
    offsets_s: Vec<f64>,
    camera_from_body: Vec<DQuat>,
}

/// What is wrong with an attitude.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AttitudeError {
    #[error("the quaternion {wxyz:?} has length {length}; allowed are 1 ± 1e-3, scalar first")]
    NotUnit { wxyz: [f64; 4], length: f64 },
    #[error("the boresight is undefined: {why}")]
    NoBoresight { why: &'static str },
    #[error("the roll is undefined: the top of the image shall lean towards {top:?}, which lies along the boresight")]
    NoTop { top: Top },
    #[error("an attitude table needs at least 1 row, got 0")]
    EmptyTable,
    #[error("attitude {index} is {offset_s} s after the start, not later than attitude {before} at {before_s} s")]
    Unsorted { index: usize, offset_s: f64, before: usize, before_s: f64 },
    #[error("the attitude at {epoch_utc} is outside the table's span {from_utc} to {until_utc}")]
    OutsideSpan { epoch_utc: String, from_utc: String, until_utc: String },
}

impl Pointing {
    /// The attitude of a camera at `position`, in m, with `velocity_m_s` against the turning body.
    pub fn camera_from_body(
        &self,
        body: &Body,
        epoch: Epoch,
        position: Position<BodyFixed>,
        velocity_m_s: DVec3,
    ) -> Result<Rotation<Camera, BodyFixed>, AttitudeError> {
        let up = body.up(body.geodetic_from_position(position)).unit();
        let (boresight, top, roll_rad) = match self {
            Self::Fixed(quaternion) => return Ok(quaternion.rotation()),
            Self::Table(table) => return table.at(epoch),
            Self::Nadir { top, roll_rad } => (Some(-up), top, roll_rad),
            Self::AtPoint { point, top, roll_rad } => {
                let target = body.position_from_geodetic(*point);
                (position.direction_to(target).map(|direction| direction.unit()), top, roll_rad)
            }
            Self::AlongVelocity { top, roll_rad } => (velocity_m_s.try_normalize(), top, roll_rad),
        };
        let why = match self {
            Self::AtPoint { .. } => "the camera is at the point it shall look at",
            _ => "the velocity is zero",
        };
        let z = boresight.ok_or(AttitudeError::NoBoresight { why })?;
        let towards = match top {
            Top::North => north(z, up),
            Top::Velocity => velocity_m_s.try_normalize().unwrap_or(z),
            Top::Up => up,
        };
        look(z, towards, *roll_rad).ok_or(AttitudeError::NoTop { top: *top })
    }
}

/// Where north is for a boresight: at a pole, where all ways lead south or north, that of the meridian of longitude 0.
fn north(boresight: DVec3, up: DVec3) -> DVec3 {
    if boresight.cross(DVec3::Z).length() < PARALLEL { -up.z.signum() * DVec3::X } else { DVec3::Z }
}

/// Camera axes from the boresight and the top; `None` where the two are parallel.
fn look(z: DVec3, top: DVec3, roll_rad: f64) -> Option<Rotation<Camera, BodyFixed>> {
    let across = top - top.dot(z) * z;
    if across.length() < PARALLEL {
        return None;
    }
    let y = -across.normalize();
    let x = y.cross(z);
    let (sin, cos) = roll_rad.sin_cos();
    Some(Rotation::from_axes(x * cos + y * sin, y * cos - x * sin, z))
}

impl Quaternion {
    /// From scalar-first components; the length may be off by rounding, not more.
    pub fn from_wxyz(wxyz: [f64; 4]) -> Result<Self, AttitudeError> {
        let [w, x, y, z] = wxyz;
        let quaternion = DQuat::from_xyzw(x, y, z, w);
        let length = quaternion.length();
        // Written so that a length that is not a number is refused.
        if (length - 1.0).abs() <= LENGTH_TOLERANCE {
            Ok(Self(quaternion.normalize()))
        } else {
            Err(AttitudeError::NotUnit { wxyz, length })
        }
    }

    pub fn rotation(self) -> Rotation<Camera, BodyFixed> {
        Rotation::from_matrix(DMat3::from_quat(self.0))
    }
}

impl AttitudeTable {
    /// Attitudes at seconds after `start`, in rising order.
    pub fn new(start: Epoch, rows: &[(f64, Quaternion)]) -> Result<Self, AttitudeError> {
        if rows.is_empty() {
            return Err(AttitudeError::EmptyTable);
        }
        let (offsets_s, camera_from_body): (Vec<f64>, Vec<DQuat>) =
            rows.iter().map(|(offset_s, quaternion)| (*offset_s, quaternion.0)).unzip();
        let rises = |i: &usize| offsets_s[*i] < offsets_s[i + 1];
        if let Some(before) = (0..rows.len() - 1).find(|i| !rises(i)) {
            let (index, offset_s, before_s) = (before + 1, offsets_s[before + 1], offsets_s[before]);
            return Err(AttitudeError::Unsorted { index, offset_s, before, before_s });
        }
        Ok(Self { start: start.to_time_scale(TimeScale::TAI), offsets_s, camera_from_body })
    }

    /// First and last epoch.
    pub fn span(&self) -> (Epoch, Epoch) {
        let at = |offset_s: f64| self.start + offset_s * Unit::Second;
        (at(self.offsets_s[0]), at(self.offsets_s[self.offsets_s.len() - 1]))
    }

    /// The attitude at an epoch within the span.
    pub(super) fn at(&self, epoch: Epoch) -> Result<Rotation<Camera, BodyFixed>, AttitudeError> {
        let (from, until) = self.span();
        if epoch < from || epoch > until {
            let [epoch_utc, from_utc, until_utc] = [epoch, from, until].map(utc_text);
            return Err(AttitudeError::OutsideSpan { epoch_utc, from_utc, until_utc });
        }
        let offset_s = (epoch - self.start).to_seconds();
        let last = self.offsets_s.len() - 1;
        let i = self.offsets_s.partition_point(|knot_s| *knot_s <= offset_s).saturating_sub(1).min(last);
        let j = (i + 1).min(last);
        let span_s = self.offsets_s[j] - self.offsets_s[i];
        let share = if span_s > 0.0 { (offset_s - self.offsets_s[i]) / span_s } else { 0.0 };
        let quaternion = slerp(self.camera_from_body[i], self.camera_from_body[j], share);
        Ok(Rotation::from_matrix(DMat3::from_quat(quaternion)))
    }
}

/// Turns at a constant rate from `a` to `b` on the shorter way.
fn slerp(a: DQuat, b: DQuat, share: f64) -> DQuat {
    let b = if a.dot(b) < 0.0 { -b } else { b };
    // The half angle between the two, accurate for small ones too.
    let half_rad = ((a - b).length()).atan2((a + b).length()) * 2.0;
    if half_rad == 0.0 {
        return a;
    }
    let sin = half_rad.sin();
    (a * (((1.0 - share) * half_rad).sin() / sin) + b * ((share * half_rad).sin() / sin)).normalize()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    fn epoch() -> Epoch {
        crate::ephemeris::parse_epoch("2026-09-08T00:00:00Z").unwrap()
    }

    /// Above (0, 0), moving east.
    fn attitude(pointing: &Pointing) -> Result<Rotation<Camera, BodyFixed>, AttitudeError> {
        pointing.camera_from_body(&Body::moon(), epoch(), Position::from_m(DVec3::X * 1.8374e6), DVec3::Y * 1600.0)
    }

    fn close(a: DVec3, b: DVec3) -> bool {
        a.distance(b) < 1e-14
    }

    #[test]
    fn nadir_with_north_up_has_east_to_the_right() {
        let rotation = attitude(&Pointing::Nadir { top: Top::North, roll_rad: 0.0 }).unwrap();
        assert!(close(rotation.turn(-DVec3::X), DVec3::Z), "down is the boresight");
        assert!(close(rotation.turn(DVec3::Z), -DVec3::Y), "north is up in the image");
        assert!(close(rotation.turn(DVec3::Y), DVec3::X), "east is right");
        assert!((rotation.matrix().determinant() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn nadir_with_velocity_up_has_the_ground_run_down_the_image() {
        let rotation = attitude(&Pointing::Nadir { top: Top::Velocity, roll_rad: 0.0 }).unwrap();
        assert!(close(rotation.turn(DVec3::Y), -DVec3::Y));
        assert!(close(rotation.turn(-DVec3::Z), DVec3::X), "south is right when flying east");
    }

    #[test]
    fn roll_turns_the_camera_clockwise() {
        let rolled = attitude(&Pointing::Nadir { top: Top::North, roll_rad: FRAC_PI_2 }).unwrap();
        // The camera's top now points where its right was: east is up.
        assert!(close(rolled.turn(DVec3::Y), -DVec3::Y));
    }

    #[test]
    fn the_camera_sees_its_target_in_the_middle() {
        let point = Geodetic::from_degrees(3.0, -7.0, 1200.0);
        let rotation = attitude(&Pointing::AtPoint { point, top: Top::Up, roll_rad: 0.4 }).unwrap();
        let sight_m = Body::moon().position_from_geodetic(point).vector_m() - DVec3::X * 1.8374e6;
        let seen = rotation.turn(sight_m);
        assert!(seen.x.hypot(seen.y) < 1e-9 * seen.z);
        let ahead = attitude(&Pointing::AlongVelocity { top: Top::Up, roll_rad: 0.0 }).unwrap();
        assert!(close(ahead.turn(DVec3::Y), DVec3::Z) && close(ahead.turn(DVec3::X), -DVec3::Y));
    }

    #[test]
    fn degenerate_attitudes_are_told() {
        let error = |pointing, velocity_m_s| {
            let position = Position::from_m(DVec3::X * 1.8374e6);
            Pointing::camera_from_body(&pointing, &Body::moon(), epoch(), position, velocity_m_s).unwrap_err()
        };
        let falling = error(Pointing::Nadir { top: Top::Velocity, roll_rad: 0.0 }, -DVec3::X);
        assert_eq!(falling, AttitudeError::NoTop { top: Top::Velocity });
        assert!(falling.to_string().contains("Velocity, which lies along the boresight"));
        assert_eq!(error(Pointing::Nadir { top: Top::Velocity, roll_rad: 0.0 }, DVec3::ZERO), falling);
        let ahead = Pointing::AlongVelocity { top: Top::Up, roll_rad: 0.0 };
        assert!(error(ahead.clone(), DVec3::ZERO).to_string().contains("the velocity is zero"));
        assert_eq!(error(ahead, DVec3::X), AttitudeError::NoTop { top: Top::Up });
        let here = Geodetic::from_degrees(0.0, 0.0, 1e5);
        assert!(matches!(
            error(Pointing::AtPoint { point: here, top: Top::North, roll_rad: 0.0 }, DVec3::Y),
            AttitudeError::NoBoresight { .. }
        ));
    }

    /// CSPICE `m2q(rotate(30 degrees, 3)) = (.965926, 0, 0, -.258819)`: the frame turned by +30 degrees about z.
    #[test]
    fn a_quaternion_is_scalar_first_and_camera_from_body() {
        let angle_rad = 30.0_f64.to_radians();
        let quaternion = Quaternion::from_wxyz([(0.5 * angle_rad).cos(), 0.0, 0.0, -(0.5 * angle_rad).sin()]).unwrap();
        let rotation = attitude(&Pointing::Fixed(quaternion)).unwrap();
        assert!(close(rotation.turn(DVec3::X), DVec3::new(angle_rad.cos(), -angle_rad.sin(), 0.0)));
    }

    #[test]
    fn quaternions_that_are_not_unit_are_refused() {
        for wxyz in [[0.0; 4], [1.01, 0.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0, 0.0], [0.5, 0.5, 0.5, 0.6]] {
            assert!(matches!(Quaternion::from_wxyz(wxyz), Err(AttitudeError::NotUnit { .. })), "{wxyz:?}");
        }
        assert!(Quaternion::from_wxyz([1.0005, 0.0, 0.0, 0.0]).is_ok());
    }

    fn about_z(angle_rad: f64, sign: f64) -> Quaternion {
        let (sin, cos) = (0.5 * angle_rad).sin_cos();
        Quaternion::from_wxyz([sign * cos, 0.0, 0.0, sign * sin]).unwrap()
    }

    /// Hard case 43.
    #[test]
    fn the_signs_of_quaternions_do_not_matter_and_the_rate_is_constant() {
        let rows = |signs: [f64; 3]| {
            let rows = [(0.0, 0.2, signs[0]), (10.0, 1.2, signs[1]), (20.0, 2.2, signs[2])];
            AttitudeTable::new(epoch(), &rows.map(|(t, angle_rad, sign)| (t, about_z(angle_rad, sign)))).unwrap()
        };
        let plain = rows([1.0, 1.0, 1.0]);
        for signs in [[1.0, -1.0, 1.0], [-1.0, 1.0, 1.0], [-1.0, -1.0, -1.0]] {
            let flipped = rows(signs);
            for i in 0..=40 {
                let offset_s = 0.5 * f64::from(i);
                let at = |table: &AttitudeTable| table.at(epoch() + offset_s * Unit::Second).unwrap();
                let expected = DVec3::new((0.2 + 0.1 * offset_s).cos(), (0.2 + 0.1 * offset_s).sin(), 0.0);
                assert!(close(at(&plain).turn(DVec3::X), expected), "{offset_s}");
                assert!(close(at(&flipped).turn(DVec3::X), expected), "{offset_s} {signs:?}");
            }
        }
    }

    #[test]
    fn a_table_ends_where_it_ends_and_must_rise() {
        let table = AttitudeTable::new(epoch(), &[(0.0, about_z(0.0, 1.0)), (1.0, about_z(1.0, 1.0))]).unwrap();
        assert!(table.at(epoch() + 1.0 * Unit::Second).is_ok());
        assert!(matches!(table.at(epoch() + 1.1 * Unit::Second), Err(AttitudeError::OutsideSpan { .. })));
        let falling = AttitudeTable::new(epoch(), &[(1.0, about_z(0.0, 1.0)), (0.0, about_z(1.0, 1.0))]);
        assert!(matches!(falling, Err(AttitudeError::Unsorted { index: 1, .. })));
        let not_a_time = AttitudeTable::new(epoch(), &[(0.0, about_z(0.0, 1.0)), (f64::NAN, about_z(1.0, 1.0))]);
        assert!(not_a_time.is_err());
        assert_eq!(AttitudeTable::new(epoch(), &[]), Err(AttitudeError::EmptyTable));
        let one = AttitudeTable::new(epoch(), &[(5.0, about_z(0.3, 1.0))]).unwrap();
        assert!(one.at(epoch() + 5.0 * Unit::Second).is_ok());
    }
}
