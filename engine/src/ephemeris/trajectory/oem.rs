//! CCSDS orbit ephemeris messages in keyword form (KVN), read and interpolated.
//!
//! Between states the position is the polynomial through positions and velocities of the nearest ones (Hermite), or
//! through positions alone where a segment says `INTERPOLATION = LAGRANGE`; velocity is its derivative. Blocks of
//! covariances are skipped, accelerations are not used.
//!
//! # Assumptions
//! A segment without `INTERPOLATION_DEGREE` gets degree 7. Segments of turning frames (IAU_MOON, MOON_ME...) are
//! interpolated there. `ICRF`, `EME2000` and `J2000` are one frame, as in SPICE (EME2000 is 0.02″ off).
//!
//! # References
//! CCSDS 502.0-B-3 (2023), Orbit Data Messages, chapter 5.

use std::path::{Path, PathBuf};

use glam::DVec3;
use hifitime::{Epoch, Unit};

use super::{SLACK_S, TrajectoryError};
use crate::ephemeris::metadata::{Metadata, check_frame, check_overlaps};
use crate::ephemeris::names::INERTIAL_FRAMES;
use crate::ephemeris::{Almanac, BodyFrame, EphemerisError, body_id, utc_text};
use crate::geometry::{BodyFixed, Position};

const M_PER_KM: f64 = 1000.0;
/// Keywords of metadata.
const KEYWORDS: [&str; 12] = [
    "OBJECT_NAME",
    "OBJECT_ID",
    "CENTER_NAME",
    "REF_FRAME",
    "REF_FRAME_EPOCH",
    "TIME_SYSTEM",
    "START_TIME",
    "USEABLE_START_TIME",
    "USEABLE_STOP_TIME",
    "STOP_TIME",
    "INTERPOLATION",
    "INTERPOLATION_DEGREE",
];
/// No spacecraft is faster (Parker Solar Probe: 192 km/s): numbers beyond are m/s.
const FASTEST_M_S: f64 = 300e3;
/// Distances, in radii of the body, of states in metres that are taken for km: in low orbits at any speed, in others at one
/// that no approach from there has.
const LOW_RADII: std::ops::Range<f64> = 980.0..1200.0;
const HIGH_RADII: std::ops::Range<f64> = 900.0..3000.0;
const HIGH_SPEED_M_S: f64 = 30e3;
/// Positions and velocities agree if the chord between two states is the mean velocity to this share: an orbit of which a step
/// is half a radian leaves 2 %.
const AGREEMENT: f64 = 0.1;
/// Cosine of the turn of the velocity between two states up to which they are compared.
const SMALL_TURN: f64 = 0.88;
/// What positions written to the metre add to a chord.
const ROUNDING_M: f64 = 2.0;
const DEFAULT_DEGREE: usize = 7;
/// Higher degrees oscillate between equal steps.
const DEGREE_AT_MOST: usize = 27;

/// A message: segments of states.
#[derive(Debug, Clone, PartialEq)]
pub struct Oem {
    path: PathBuf,
    segments: Vec<Segment>,
}

#[derive(Debug, Clone, PartialEq)]
struct Segment {
    center: String,
    frame: String,
    uses_velocities: bool,
    degree: usize,
    useable_from: Epoch,
    useable_until: Epoch,
    states: Vec<State>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct State {
    epoch: Epoch,
    position_m: DVec3,
    velocity_m_s: DVec3,
}

impl Oem {
    pub fn read(path: &Path) -> Result<Self, TrajectoryError> {
        let text =
            crate::text::read(path).map_err(|source| TrajectoryError::Unreadable { path: path.to_owned(), source })?;
        Self::parse(path, &text)
    }

    /// From a message's text; `path` names it in faults.
    pub fn parse(path: &Path, text: &str) -> Result<Self, TrajectoryError> {
        let mut parser = Parser::default();
        for (line, content) in (1..).zip(text.lines()) {
            parser.take(content.trim()).map_err(|problem| fault(path, line, problem))?;
        }
        let last = text.lines().count();
        parser.end_segment().map_err(|problem| fault(path, last, problem))?;
        if parser.segments.is_empty() {
            return Err(fault(path, last, "the message has no META_START".to_owned()));
        }
        let spans: Vec<_> =
            parser.segments.iter().map(|segment| [segment.useable_from, segment.useable_until]).collect();
        check_overlaps(&spans, SLACK_S).map_err(|problem| fault(path, last, problem))?;
        Ok(Self { path: path.to_owned(), segments: parser.segments })
    }

    /// First and last epoch of all segments.
    pub fn span(&self) -> (Epoch, Epoch) {
        let first = self.segments.iter().map(|segment| segment.useable_from).min();
        let last = self.segments.iter().map(|segment| segment.useable_until).max();
        first.zip(last).expect("a message that was read has a segment")
    }

    /// Position and velocity in the turning frame.
    pub fn state(
        &self,
        almanac: &Almanac,
        frame: &BodyFrame,
        epoch: Epoch,
    ) -> Result<(Position<BodyFixed>, DVec3), TrajectoryError> {
        let slack = SLACK_S * Unit::Second;
        let holds =
            |segment: &&Segment| (segment.useable_from - slack..=segment.useable_until + slack).contains(&epoch);
        // Where segments meet, the later one begins.
        let segment = self.segments.iter().rev().find(holds).ok_or_else(|| {
            let (from, until) = self.span();
            TrajectoryError::OutsideSpan {
                kind: "orbit ephemeris message",
                epoch_utc: utc_text(epoch),
                from_utc: utc_text(from),
                until_utc: utc_text(until),
            }
        })?;
        if body_id(&segment.center)? != frame.body.naif_id {
            let (center, body) = (segment.center.clone(), frame.body.name.clone());
            return Err(TrajectoryError::Center { path: self.path.clone(), center, body });
        }
        let (position_m, velocity_m_s) = segment.interpolate(epoch);
        segment
            .check_unit(frame.body.equatorial_radius_m, velocity_m_s)
            .map_err(|problem| fault(&self.path, 1, problem))?;
        Ok(turned(almanac, frame, &segment.frame, epoch, position_m, velocity_m_s)?)
    }
}

/// From the message's frame into the body's.
fn turned(
    almanac: &Almanac,
    frame: &BodyFrame,
    given: &str,
    epoch: Epoch,
    position_m: DVec3,
    velocity_m_s: DVec3,
) -> Result<(Position<BodyFixed>, DVec3), EphemerisError> {
    let turning = almanac.orientation(frame, epoch)?;
    if INERTIAL_FRAMES.contains(&given) {
        return Ok(turning.turn_state(position_m, velocity_m_s));
    }
    let given = almanac.body_frame(&frame.body.naif_id.to_string(), Some(given))?;
    let position = Position::from_m(position_m);
    if given.frame_id == frame.frame_id {
        return Ok((position, velocity_m_s));
    }
    let (position_m, velocity_m_s) = almanac.orientation(&given, epoch)?.turn_state_back(position, velocity_m_s);
    Ok(turning.turn_state(position_m, velocity_m_s))
}

fn fault(path: &Path, line: usize, problem: String) -> TrajectoryError {
    TrajectoryError::Oem { path: path.to_owned(), line, problem }
}

/// What the parser is inside of.
#[derive(Debug, Default, PartialEq)]
enum Block {
    #[default]
    Header,
    Meta,
    States,
    Covariance,
}

#[derive(Debug, Default)]
struct Parser {
    block: Block,
    meta: Metadata,
    states: Vec<State>,
    segments: Vec<Segment>,
}

impl Parser {
    fn take(&mut self, line: &str) -> Result<(), String> {
        match (&self.block, line) {
            (_, "") => Ok(()),
            (_, line) if line.starts_with("COMMENT") => Ok(()),
            (Block::Header | Block::States, "META_START") => {
                self.end_segment()?;
                self.block = Block::Meta;
                Ok(())
            }
            (Block::Meta, "META_STOP") => {
                self.block = Block::States;
                self.meta.time_scale().map(|_| ())
            }
            (Block::States, "COVARIANCE_START") => {
                self.block = Block::Covariance;
                Ok(())
            }
            (Block::Covariance, "COVARIANCE_STOP") => {
                self.block = Block::States;
                Ok(())
            }
            (Block::Covariance, _) => Ok(()),
            (Block::Header, line) if line.contains('=') => Ok(()),
            (Block::Header, line) => Err(format!("`{line}` is not KEYWORD = value")),
            (Block::Meta, line) => self.meta.take(line, &KEYWORDS),
            (Block::States, line) => self.take_state(line),
        }
    }

    fn take_state(&mut self, line: &str) -> Result<(), String> {
        let mut words = line.split_whitespace();
        let epoch = self.meta.epoch(words.next().unwrap_or_default())?;
        let numbers: Vec<f64> = words
            .map(|word| word.parse().ok().filter(|x: &f64| x.is_finite()).ok_or(format!("`{word}` is not a number")))
            .collect::<Result<_, _>>()?;
        let [x, y, z, vx, vy, vz] = match numbers[..] {
            [x, y, z, vx, vy, vz] | [x, y, z, vx, vy, vz, _, _, _] => [x, y, z, vx, vy, vz].map(|km| km * M_PER_KM),
            _ => return Err(format!("a state has 6 or 9 numbers after the epoch, got {}", numbers.len())),
        };
        if self.states.last().is_some_and(|last| last.epoch >= epoch) {
            return Err("the epoch is not later than that of the state before".to_owned());
        }
        let state = State { epoch, position_m: DVec3::new(x, y, z), velocity_m_s: DVec3::new(vx, vy, vz) };
        let speed_m_s = state.velocity_m_s.length();
        if speed_m_s > FASTEST_M_S {
            return Err(format!(
                "a velocity of {} km/s looks like m/s; a message has km and km/s",
                speed_m_s / M_PER_KM
            ));
        }
        let ignores_velocities = speed_m_s == 0.0 && !self.uses_velocities()?;
        match self.states.last().filter(|before| !ignores_velocities && !before.agrees_with(&state)) {
            Some(_) => Err("the positions of this state and the one before do not agree with their velocities".into()),
            None => {
                self.states.push(state);
                Ok(())
            }
        }
    }

    fn method(&self) -> &str {
        self.meta.optional("INTERPOLATION").unwrap_or("HERMITE")
    }

    fn uses_velocities(&self) -> Result<bool, String> {
        match self.method() {
            "HERMITE" => Ok(true),
            "LAGRANGE" | "LINEAR" => Ok(false),
            other => Err(format!("INTERPOLATION = {other}; allowed are HERMITE, LAGRANGE and LINEAR")),
        }
    }

    fn end_segment(&mut self) -> Result<(), String> {
        match self.block {
            Block::Header => return Ok(()),
            Block::Meta => return Err("META_START without META_STOP".to_owned()),
            Block::Covariance => return Err("COVARIANCE_START without COVARIANCE_STOP".to_owned()),
            Block::States => {}
        }
        const NEEDED: usize = 2;
        if self.states.len() < NEEDED {
            return Err(format!("a segment needs at least {NEEDED} states, got {}", self.states.len()));
        }
        let (first, last) = (self.states[0].epoch, self.states[self.states.len() - 1].epoch);
        let [useable_from, useable_until] = self.meta.useable(first, last)?;
        let uses_velocities = self.uses_velocities()?;
        let degree = match (self.method(), self.meta.optional("INTERPOLATION_DEGREE")) {
            ("LINEAR", _) => 1,
            (_, None) => DEFAULT_DEGREE,
            (_, Some(text)) => text
                .parse()
                .ok()
                .filter(|degree| (1..=DEGREE_AT_MOST).contains(degree))
                .ok_or(format!("INTERPOLATION_DEGREE = {text} is outside [1, {DEGREE_AT_MOST}]"))?,
        };
        let (center, frame) =
            (self.meta.required("CENTER_NAME")?.to_owned(), self.meta.required("REF_FRAME")?.to_owned());
        check_frame("REF_FRAME", &frame)?;
        let states = std::mem::take(&mut self.states);
        self.meta.clear();
        self.segments.push(Segment { center, frame, uses_velocities, degree, useable_from, useable_until, states });
        Ok(())
    }
}

impl State {
    /// Whether the chord to the next state is what their velocities say, as far as these can tell.
    fn agrees_with(&self, next: &State) -> bool {
        let step_s = (next.epoch - self.epoch).to_seconds();
        let (chord_m_s, mean_m_s) =
            ((next.position_m - self.position_m) / step_s, 0.5 * (self.velocity_m_s + next.velocity_m_s));
        let [a, b] = [self.velocity_m_s, next.velocity_m_s];
        let (slower, faster) = (a.length().min(b.length()), a.length().max(b.length()));
        let turns_little = a.dot(b) >= SMALL_TURN * a.length() * b.length() && faster <= 2.0 * slower;
        let tolerance_m_s = AGREEMENT * chord_m_s.length().max(mean_m_s.length()) + 1.0 + ROUNDING_M / step_s;
        !turns_little || chord_m_s.distance(mean_m_s) <= tolerance_m_s
    }
}

impl Segment {
    /// Refuses states that look like metres, from a body of some radius.
    fn check_unit(&self, radius_m: f64, velocity_m_s: DVec3) -> Result<(), String> {
        let all_within = |radii: &std::ops::Range<f64>| {
            let ends = self.states.first().into_iter().chain(self.states.last());
            ends.clone().all(|state| radii.contains(&(state.position_m.length() / radius_m)))
        };
        let is_fast = velocity_m_s.length() > HIGH_SPEED_M_S;
        if !(all_within(&LOW_RADII) || is_fast && all_within(&HIGH_RADII)) {
            return Ok(());
        }
        let distance_km = self.states.first().map_or(0.0, |state| state.position_m.length() / M_PER_KM);
        Err(format!(
            "the first state, {distance_km:.0} km from the centre, looks like metres; a message has km and km/s"
        ))
    }

    /// Newton's polynomial through the states around `epoch`, each taken twice where velocities count, and its
    /// derivative.
    fn interpolate(&self, epoch: Epoch) -> (DVec3, DVec3) {
        let window = self.window(epoch);
        let repeats = if self.uses_velocities { 2 } else { 1 };
        let knots: Vec<&State> = window.iter().flat_map(|state| std::iter::repeat_n(state, repeats)).collect();
        // Seconds from the epoch asked for, so that the polynomial is wanted at 0.
        let times_s: Vec<f64> = knots.iter().map(|state| (state.epoch - epoch).to_seconds()).collect();
        let mut differences: Vec<DVec3> = knots.iter().map(|state| state.position_m).collect();
        for order in 1..knots.len() {
            for i in (order..knots.len()).rev() {
                let span_s = times_s[i] - times_s[i - order];
                differences[i] =
                    if span_s == 0.0 { knots[i].velocity_m_s } else { (differences[i] - differences[i - 1]) / span_s };
            }
        }
        let (mut position_m, mut velocity_m_s) = (DVec3::ZERO, DVec3::ZERO);
        for (difference, time_s) in differences.iter().zip(&times_s).rev() {
            velocity_m_s = position_m - velocity_m_s * *time_s;
            position_m = *difference - position_m * *time_s;
        }
        (position_m, velocity_m_s)
    }

    /// The states nearest to an epoch that the degree asks for, as many before as after where there are such.
    fn window(&self, epoch: Epoch) -> &[State] {
        // A polynomial of degree d has d + 1 coefficients; a state with its velocity fixes two.
        let wanted = if self.uses_velocities { self.degree / 2 + 1 } else { self.degree + 1 };
        let count = wanted.clamp(2, self.states.len());
        let after = self.states.partition_point(|state| state.epoch <= epoch);
        let first = after.saturating_sub(count / 2).min(self.states.len() - count);
        &self.states[first..first + count]
    }
}

#[cfg(test)]
mod tests;
