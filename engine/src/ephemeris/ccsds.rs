//! CCSDS orbit and attitude ephemeris messages in keyword form, written for flight dynamics; and what both share when read.
//!
//! Positions in km and velocities in km/s; quaternions turn components in frame A into components in frame B, scalar last.
//! Times are TDB. A message needs rising times: the caller sorts. The versions are those that most programs read, and that of
//! attitudes is the one that names its direction and the place of its scalar.
//!
//! # References
//! CCSDS 502.0-B-2 (2009), Orbit Data Messages, chapter 5; CCSDS 504.0-B-1 (2008), Attitude Data Messages, chapter 4.

use glam::DVec3;
use hifitime::{Epoch, TimeScale};

use super::utc_text;

const KM_PER_M: f64 = 1e-3;
/// Of the polynomials that a reader joins states by, at most: four states with their velocities.
const DEGREE: usize = 7;

/// What both kinds of messages say of themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Message<'a> {
    /// Name and id of what moves.
    pub object: &'a str,
    /// The body about which it moves, and its frame.
    pub center: &'a str,
    pub frame: &'a str,
    pub comment: &'a str,
}

/// Position in m and velocity in m/s at an instant.
pub type State = (Epoch, DVec3, DVec3);

/// Scalar-first quaternion at an instant.
pub type Attitude = (Epoch, [f64; 4]);

impl Message<'_> {
    /// An orbit ephemeris message; empty without states.
    pub fn oem(&self, states: &[State]) -> String {
        let [Some((first, ..)), Some((last, ..))] = [states.first(), states.last()] else { return String::new() };
        let mut text = self.header("OEM", "2.0", *first);
        text += &format!("CENTER_NAME = {}\nREF_FRAME = {}\n", self.center.to_uppercase(), self.frame);
        text += &span(*first, *last);
        text += &format!("INTERPOLATION = HERMITE\nINTERPOLATION_DEGREE = {DEGREE}\nMETA_STOP\n");
        for (epoch, position_m, velocity_m_s) in states {
            let [r, v] = [position_m, velocity_m_s].map(|vector| *vector * KM_PER_M);
            text += &format!("{} {} {} {} {} {} {}\n", tdb_text(*epoch), r.x, r.y, r.z, v.x, v.y, v.z);
        }
        text
    }

    /// An attitude ephemeris message from `frame` to a frame named `CAMERA`; empty without attitudes.
    pub fn aem(&self, attitudes: &[Attitude]) -> String {
        let [Some((first, _)), Some((last, _))] = [attitudes.first(), attitudes.last()] else { return String::new() };
        let mut text = self.header("AEM", "1.0", *first);
        text += &format!(
            "CENTER_NAME = {}\nREF_FRAME_A = {}\nREF_FRAME_B = CAMERA\n",
            self.center.to_uppercase(),
            self.frame
        );
        text += &span(*first, *last);
        text += "ATTITUDE_DIR = A2B\nATTITUDE_TYPE = QUATERNION\nQUATERNION_TYPE = LAST\nMETA_STOP\nDATA_START\n";
        for (epoch, [w, x, y, z]) in attitudes {
            text += &format!("{} {x} {y} {z} {w}\n", tdb_text(*epoch));
        }
        text + "DATA_STOP\n"
    }

    /// Up to the object's id. The date of creation is the first state's: the same run makes the same bytes on any day.
    fn header(&self, kind: &str, version: &str, first: Epoch) -> String {
        let Self { object, comment, .. } = self;
        let created = utc_text(first);
        format!(
            "CCSDS_{kind}_VERS = {version}\nCOMMENT {comment}\nCREATION_DATE = {}\nORIGINATOR = PERILUNE\n\
             META_START\nOBJECT_NAME = {object}\nOBJECT_ID = {object}\n",
            created.trim_end_matches('Z')
        )
    }
}

fn span(first: Epoch, last: Epoch) -> String {
    format!("TIME_SYSTEM = TDB\nSTART_TIME = {}\nSTOP_TIME = {}\n", tdb_text(first), tdb_text(last))
}

/// An instant in TDB to the nanosecond, without its scale.
fn tdb_text(epoch: Epoch) -> String {
    epoch.to_time_scale(TimeScale::TDB).to_string().trim_end_matches(" TDB").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ephemeris::parse_epoch;

    const MESSAGE: Message = Message { object: "CAMERA", center: "moon", frame: "IAU_MOON", comment: "a test" };

    #[test]
    fn a_state_is_in_kilometres_and_tdb() {
        let epoch = parse_epoch("2026-11-06T00:00:00.25 TDB").unwrap();
        let text = MESSAGE.oem(&[(epoch, DVec3::new(1.75e6, -2e3, 0.0), DVec3::new(0.0, 1600.0, 0.5))]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.last(), Some(&"2026-11-06T00:00:00.250000000 1750 -2 0 0 1.6 0.0005"));
        assert!(lines.contains(&"CENTER_NAME = MOON") && lines.contains(&"TIME_SYSTEM = TDB"), "{text}");
    }

    #[test]
    fn a_quaternion_has_its_scalar_last() {
        let epoch = parse_epoch("2026-11-06 TDB").unwrap();
        let text = MESSAGE.aem(&[(epoch, [0.5, 0.1, 0.2, 0.3])]);
        assert!(text.ends_with("2026-11-06T00:00:00 0.1 0.2 0.3 0.5\nDATA_STOP\n"), "{text}");
    }
}
