//! CCSDS attitude ephemeris messages in keyword form, read: quaternions of a camera over time.
//!
//! One of the two frames is the camera's, by whatever name; the other is an inertial one or one that the kernels know, turning or
//! not. Between its quaternions a segment turns at a constant rate on the shorter way ([`AttitudeTable`]), in the frame that it
//! is given in. `ATTITUDE_DIR` and `QUATERNION_TYPE` (of version 1) are obeyed; without them the turn is from A to B and the
//! scalar comes last, as version 2 fixes.
//!
//! # References
//! CCSDS 504.0-B-1 (2008) and 504.0-B-2 (2024), Attitude Data Messages, chapter 4.

use std::path::{Path, PathBuf};

use hifitime::{Epoch, Unit};

use super::attitude::{AttitudeError, AttitudeTable, Quaternion};
use super::metadata::{Metadata, check_overlaps};
use super::names::{INERTIAL_FRAMES, frame_ids};
use super::trajectory::SLACK_S;
use super::{Almanac, BodyFrame, EphemerisError, utc_text};
use crate::geometry::{BodyFixed, Camera, Rotation};

/// Keywords of metadata.
const KEYWORDS: [&str; 17] = [
    "OBJECT_NAME",
    "OBJECT_ID",
    "CENTER_NAME",
    "REF_FRAME_A",
    "REF_FRAME_B",
    "ATTITUDE_DIR",
    "TIME_SYSTEM",
    "START_TIME",
    "USEABLE_START_TIME",
    "USEABLE_STOP_TIME",
    "STOP_TIME",
    "ATTITUDE_TYPE",
    "QUATERNION_TYPE",
    "EULER_ROT_SEQ",
    "ANGVEL_FRAME",
    "INTERPOLATION_METHOD",
    "INTERPOLATION_DEGREE",
];

/// A message: segments of attitudes.
#[derive(Debug, Clone, PartialEq)]
pub struct Aem {
    path: PathBuf,
    segments: Vec<Segment>,
}

#[derive(Debug, Clone, PartialEq)]
struct Segment {
    /// The frame that is not the camera's.
    frame: String,
    /// Camera from `frame`.
    table: AttitudeTable,
    useable: [Epoch; 2],
}

/// What is wrong with a message or with an epoch asked of it.
#[derive(Debug, thiserror::Error)]
pub enum AemError {
    #[error("attitude {} cannot be read", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("attitude {}, line {line}: {problem}", path.display())]
    Line { path: PathBuf, line: usize, problem: String },
    #[error("attitude {}: {epoch_utc} is in none of its segments, which reach from {from_utc} to {until_utc}", path.display())]
    OutsideSpan { path: PathBuf, epoch_utc: String, from_utc: String, until_utc: String },
    #[error(transparent)]
    Attitude(#[from] AttitudeError),
    #[error(transparent)]
    Ephemeris(#[from] EphemerisError),
}

impl Aem {
    pub fn read(path: &Path) -> Result<Self, AemError> {
        let text = crate::text::read(path).map_err(|source| AemError::Unreadable { path: path.into(), source })?;
        Self::parse(path, &text)
    }

    /// From a message's text; `path` names it in faults.
    pub fn parse(path: &Path, text: &str) -> Result<Self, AemError> {
        let fault = |line, problem| AemError::Line { path: path.into(), line, problem };
        let mut parser = Parser::default();
        for (line, content) in (1..).zip(text.lines()) {
            parser.take(content.trim()).map_err(|problem| fault(line, problem))?;
        }
        let last = text.lines().count();
        match (parser.block, parser.segments.is_empty()) {
            (Block::Outside, false) => {
                let spans: Vec<_> = parser.segments.iter().map(|segment| segment.useable).collect();
                check_overlaps(&spans, SLACK_S).map_err(|problem| fault(last, problem))?;
                Ok(Self { path: path.into(), segments: parser.segments })
            }
            (Block::Outside, true) => Err(fault(last, "the message has no DATA_START".into())),
            _ => Err(fault(last, "the last segment has no end".into())),
        }
    }

    /// The attitude against the body's frame.
    pub fn camera_from_body(
        &self,
        almanac: &Almanac,
        frame: &BodyFrame,
        epoch: Epoch,
    ) -> Result<Rotation<Camera, BodyFixed>, AemError> {
        let slack = SLACK_S * Unit::Second;
        let holds = |segment: &&Segment| {
            let [from, until] = segment.useable;
            (from - slack..=until + slack).contains(&epoch)
        };
        // Where segments meet, the later one begins.
        let segment = self.segments.iter().rev().find(holds).ok_or_else(|| self.outside(epoch))?;
        let (from, until) = segment.table.span();
        let camera_from_given = segment.table.at(epoch.clamp(from, until))?;
        if segment.frame == frame.frame_name {
            return Ok(camera_from_given);
        }
        let mut given_from_body = almanac.body_from_icrf(frame, epoch)?.matrix().transpose();
        if !INERTIAL_FRAMES.contains(&segment.frame.as_str()) {
            let given = almanac.body_frame(&frame.body.naif_id.to_string(), Some(&segment.frame))?;
            given_from_body = almanac.body_from_icrf(&given, epoch)?.matrix() * given_from_body;
        }
        Ok(Rotation::from_matrix(camera_from_given.matrix() * given_from_body))
    }

    fn outside(&self, epoch: Epoch) -> AemError {
        let spans = || self.segments.iter().map(|segment| segment.useable);
        let from = spans().map(|[from, _]| from).min().expect("a message that was read has a segment");
        let until = spans().map(|[_, until]| until).max().expect("a message that was read has a segment");
        let [epoch_utc, from_utc, until_utc] = [epoch, from, until].map(utc_text);
        AemError::OutsideSpan { path: self.path.clone(), epoch_utc, from_utc, until_utc }
    }
}

/// What the parser is inside of.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
enum Block {
    #[default]
    Outside,
    Meta,
    /// Between metadata and data.
    Between,
    Data,
}

#[derive(Debug, Default)]
struct Parser {
    block: Block,
    meta: Metadata,
    rows: Vec<(Epoch, Quaternion)>,
    segments: Vec<Segment>,
}

impl Parser {
    fn take(&mut self, line: &str) -> Result<(), String> {
        match (self.block, line) {
            (_, "") => {}
            (_, line) if line.starts_with("COMMENT") => {}
            (Block::Outside, "META_START") => {
                self.meta.clear();
                self.block = Block::Meta;
            }
            (Block::Meta, "META_STOP") => self.block = Block::Between,
            (Block::Between, "DATA_START") => self.block = Block::Data,
            (Block::Data, "DATA_STOP") => self.end_segment()?,
            (Block::Data, line) => self.take_attitude(line)?,
            (Block::Between, line) => return Err(format!("want DATA_START, got `{line}`")),
            (Block::Outside, line) if line.contains('=') => {}
            (Block::Outside, line) => return Err(format!("`{line}` is not KEYWORD = value")),
            (Block::Meta, line) => self.meta.take(line, &KEYWORDS)?,
        }
        Ok(())
    }

    /// One of two words; the first where the key is absent.
    fn is_first(&self, key: &str, [first, second]: [&str; 2]) -> Result<bool, String> {
        match self.meta.optional(key).unwrap_or(first) {
            word if word == first => Ok(true),
            word if word == second => Ok(false),
            word => Err(format!("{key} = {word}; allowed are {first} and {second}")),
        }
    }

    fn take_attitude(&mut self, line: &str) -> Result<(), String> {
        let kind = self.meta.required("ATTITUDE_TYPE")?;
        if kind != "QUATERNION" {
            return Err(format!("ATTITUDE_TYPE = {kind}; allowed is QUATERNION"));
        }
        let mut words = line.split_whitespace();
        let epoch = self.meta.epoch(words.next().unwrap_or_default())?;
        if self.rows.last().is_some_and(|(last, _)| *last >= epoch) {
            return Err("the epoch is not later than that of the attitude before".to_owned());
        }
        let numbers: Vec<f64> = words
            .map(|word| word.parse().map_err(|_| format!("`{word}` is not a number")))
            .collect::<Result<_, String>>()?;
        let &[a, b, c, d] = numbers.as_slice() else {
            return Err(format!("an attitude has 4 numbers after the epoch, got {}", numbers.len()));
        };
        let [w, x, y, z] =
            if self.is_first("QUATERNION_TYPE", ["LAST", "FIRST"])? { [d, a, b, c] } else { [a, b, c, d] };
        // Turned over where B is the reference and A the camera, or where the turn is told from B to A; twice is not at all.
        let turned_over =
            self.is_first("ATTITUDE_DIR", ["A2B", "B2A"])? != is_reference(self.meta.required("REF_FRAME_A")?);
        let wxyz = if turned_over { [w, -x, -y, -z] } else { [w, x, y, z] };
        self.rows.push((epoch, Quaternion::from_wxyz(wxyz).map_err(|error| error.to_string())?));
        Ok(())
    }

    fn end_segment(&mut self) -> Result<(), String> {
        let rows = std::mem::take(&mut self.rows);
        let Some((start, _)) = rows.first().copied() else { return Err("the segment has no attitude".into()) };
        let after: Vec<(f64, Quaternion)> =
            rows.iter().map(|(epoch, quaternion)| ((*epoch - start).to_unit(Unit::Second), *quaternion)).collect();
        let table = AttitudeTable::new(start, &after).map_err(|error| error.to_string())?;
        let [a, b] = [self.meta.required("REF_FRAME_A")?, self.meta.required("REF_FRAME_B")?];
        let frame = (if is_reference(a) { a } else { b }).to_owned();
        let useable = self.meta.useable(start, rows.last().map_or(start, |(last, _)| *last))?;
        self.segments.push(Segment { frame, table, useable });
        self.block = Block::Outside;
        Ok(())
    }
}

/// Whether a frame is one of space or of a body, by a name that the kernels' frames have.
fn is_reference(frame: &str) -> bool {
    INERTIAL_FRAMES.contains(&frame) || frame_ids(frame).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(meta: &str, rows: &str) -> String {
        format!(
            "CCSDS_AEM_VERS = 1.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = X\nMETA_START\nTIME_SYSTEM = UTC\n{meta}\
             ATTITUDE_TYPE = QUATERNION\nMETA_STOP\nDATA_START\n{rows}DATA_STOP\n"
        )
    }

    const A_IS_BODY: &str = "REF_FRAME_A = IAU_MOON\nREF_FRAME_B = SC_BODY_1\n";

    fn quaternion(meta: &str, row: &str) -> [f64; 4] {
        let rows = format!("2026-01-01T00:00:00 {row}\n");
        let aem = Aem::parse(Path::new("a.aem"), &message(meta, &rows)).unwrap();
        let start = aem.segments[0].table.span().0;
        assert_eq!(aem.segments[0].frame, "IAU_MOON");
        let q = aem.segments[0].table.at(start).unwrap().quaternion();
        [q.w, q.x, q.y, q.z]
    }

    /// A turn by 60° about x: the scalar is cos 30°.
    #[test]
    fn direction_and_order_of_the_quaternion_are_as_the_message_says() {
        let (c, s) = (0.75_f64.sqrt(), 0.5);
        let near = |got: [f64; 4], wanted: [f64; 4]| {
            assert!(got.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{got:?} {wanted:?}");
        };
        let last = format!("{s} 0 0 {c}");
        near(quaternion(A_IS_BODY, &last), [c, s, 0.0, 0.0]);
        near(quaternion(&format!("{A_IS_BODY}QUATERNION_TYPE = FIRST\n"), &format!("{c} {s} 0 0")), [c, s, 0.0, 0.0]);
        near(quaternion(&format!("{A_IS_BODY}ATTITUDE_DIR = B2A\n"), &last), [c, -s, 0.0, 0.0]);
        let b_is_body = "REF_FRAME_A = CAMERA\nREF_FRAME_B = IAU_MOON\n";
        near(quaternion(b_is_body, &last), [c, -s, 0.0, 0.0]);
        near(quaternion(&format!("{b_is_body}ATTITUDE_DIR = B2A\n"), &last), [c, s, 0.0, 0.0]);
    }

    #[test]
    fn faults_are_told_with_their_line() {
        let fault =
            |meta: &str, rows: &str| Aem::parse(Path::new("a.aem"), &message(meta, rows)).unwrap_err().to_string();
        let row = "2026-01-01T00:00:00 0 0 0 1\n";
        assert!(fault(A_IS_BODY, "2026-01-01T00:00:00 0 0 1\n").contains("line 11: an attitude has 4 numbers"));
        assert!(fault(A_IS_BODY, "2026-01-01T00:00:00 0 0 0 2\n").contains("line 11: the quaternion"));
        assert!(fault(A_IS_BODY, &format!("{row}{row}")).contains("line 12: the epoch is not later"));
        assert!(fault(A_IS_BODY, "").contains("line 11: the segment has no attitude"));
        assert!(fault("REF_FRAME_B = IAU_MOON\n", row).contains("lack REF_FRAME_A"));
        assert!(fault(&format!("{A_IS_BODY}ATTITUDE_DIR = C2A\n"), row).contains("allowed are A2B and B2A"));
        assert!(fault(&format!("{A_IS_BODY}SPIN = 1\n"), row).contains("SPIN is not a keyword of the metadata"));
        assert!(fault(&format!("{A_IS_BODY}REF_FRAME_A = ICRF\n"), row).contains("REF_FRAME_A is given twice"));
        let twice = message(A_IS_BODY, &format!("{row}2026-01-01T00:01:00 0 0 0 1\n"));
        let twice = format!("{twice}{}", &twice[twice.find("META_START").unwrap()..]);
        let error = Aem::parse(Path::new("a.aem"), &twice).unwrap_err().to_string();
        assert!(error.contains("segments overlap from 2026-01-01T00:00:00Z to 2026-01-01T00:01:00Z"), "{error}");
        let open = Aem::parse(Path::new("a.aem"), &message(A_IS_BODY, row).replace("DATA_STOP\n", "")).unwrap_err();
        assert!(open.to_string().contains("the last segment has no end"), "{open}");
    }
}
