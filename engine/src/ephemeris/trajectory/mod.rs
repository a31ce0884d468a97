//! Where the camera is: a position and velocity in the body's frame at any epoch.
//!
//! Four kinds, one file each: [`Waypoints`] joined by a cubic spline, an object of a loaded SPK ([`SpkObject`]), a
//! CCSDS orbit ephemeris message ([`Oem`]) and Kepler motion ([`TwoBody`]). The velocity is the time derivative of
//! the body-fixed position, as an observer on the turning body measures it.

mod oem;
mod two_body;
mod waypoints;

use std::path::PathBuf;

use glam::DVec3;
use hifitime::Epoch;

use super::{Almanac, BodyFrame, EphemerisError};
use crate::geometry::{BodyFixed, Position};

pub use oem::Oem;
pub use two_body::{Elements, TwoBody};
pub use waypoints::{SplineEnds, Waypoints};

/// How far outside its span a message is asked without complaint, in seconds: instants in text and in doubles are rounded.
pub(super) const SLACK_S: f64 = 1e-6;

/// A path through space.
#[derive(Debug, Clone, PartialEq)]
pub enum Trajectory {
    Waypoints(Waypoints),
    Spk(SpkObject),
    Oem(Oem),
    TwoBody(TwoBody),
}

/// An object of the loaded SPKs by its SPICE id, as -85 for LRO.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SpkObject {
    pub naif_id: i32,
}

impl Trajectory {
    /// Position in m and velocity in m/s in the body's turning frame.
    pub fn state(
        &self,
        almanac: &Almanac,
        frame: &BodyFrame,
        epoch: Epoch,
    ) -> Result<(Position<BodyFixed>, DVec3), TrajectoryError> {
        match self {
            Self::Waypoints(waypoints) => waypoints.state(epoch),
            Self::Spk(object) => Ok(almanac.state_of(object.naif_id, frame, epoch)?),
            Self::Oem(oem) => oem.state(almanac, frame, epoch),
            Self::TwoBody(orbit) => orbit.state(almanac, frame, epoch),
        }
    }
}

/// What is wrong with a trajectory or with an epoch asked of it.
#[derive(Debug, thiserror::Error)]
pub enum TrajectoryError {
    #[error(transparent)]
    Ephemeris(#[from] EphemerisError),
    #[error("the {kind} at {epoch_utc} is outside its span {from_utc} to {until_utc}")]
    OutsideSpan { kind: &'static str, epoch_utc: String, from_utc: String, until_utc: String },
    #[error("a path needs at least {needed} waypoints, got {got}")]
    TooFewWaypoints { needed: usize, got: usize },
    #[error("waypoint {index} is {offset_s} s after the start, not later than waypoint {before} at {before_s} s")]
    Unsorted { index: usize, offset_s: f64, before: usize, before_s: f64 },
    #[error("waypoint {index} has a time or coordinate that is not finite")]
    WaypointNotFinite { index: usize },
    #[error("trajectory {} cannot be read", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("trajectory {}, line {line}: {problem}", path.display())]
    Oem { path: PathBuf, line: usize, problem: String },
    #[error("trajectory {} has CENTER_NAME = {center}, but the body is {body}", path.display())]
    Center { path: PathBuf, center: String, body: String },
    #[error("orbit.{key} = {got} is outside {allowed}")]
    Element { key: &'static str, got: f64, allowed: &'static str },
}
