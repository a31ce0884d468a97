//! The metadata of a segment of a CCSDS message in keyword form: each key once, none that is not known.
//!
//! # References
//! CCSDS 502.0-B-3 (2023), Orbit Data Messages, table 5-3; CCSDS 504.0-B-2 (2024), Attitude Data Messages, table 4-3.

use hifitime::{Epoch, TimeScale};

use super::epoch::parse_in_scale;
use super::names::{INERTIAL_FRAMES, LUNAR_FRAMES, frame_ids};

/// Time systems by their names there.
const TIME_SYSTEMS: [(&str, TimeScale); 5] = [
    ("UTC", TimeScale::UTC),
    ("TDB", TimeScale::TDB),
    ("TT", TimeScale::TT),
    ("TAI", TimeScale::TAI),
    ("GPS", TimeScale::GPST),
];

/// Keys and values, both in capitals where they are words.
#[derive(Debug, Default)]
pub(super) struct Metadata(Vec<(String, String)>);

impl Metadata {
    /// Takes a line `KEYWORD = value` over.
    pub fn take(&mut self, line: &str, known: &[&str]) -> Result<(), String> {
        let (key, value) = line.split_once('=').ok_or_else(|| format!("`{line}` is not KEYWORD = value"))?;
        let (key, value) = (key.trim().to_uppercase(), value.trim());
        if !known.contains(&key.as_str()) {
            return Err(format!("{key} is not a keyword of the metadata; allowed are {}", known.join(", ")));
        }
        if self.optional(&key).is_some() {
            return Err(format!("{key} is given twice"));
        }
        self.0.push((key, value.to_uppercase()));
        Ok(())
    }

    pub fn clear(&mut self) {
        self.0.clear();
    }

    pub fn optional(&self, key: &str) -> Option<&str> {
        self.0.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    pub fn required(&self, key: &str) -> Result<&str, String> {
        self.optional(key).ok_or_else(|| format!("the segment's metadata lack {key}"))
    }

    pub fn time_scale(&self) -> Result<TimeScale, String> {
        let name = self.required("TIME_SYSTEM")?;
        let found = TIME_SYSTEMS.iter().find(|(known, _)| *known == name).map(|(_, scale)| *scale);
        let allowed = TIME_SYSTEMS.map(|(name, _)| name).join(", ");
        found.ok_or_else(|| format!("TIME_SYSTEM = {name}; allowed are {allowed}"))
    }

    /// An epoch of the message, in its time system unless a `Z` follows.
    pub fn epoch(&self, text: &str) -> Result<Epoch, String> {
        let (date_time, scale) = match text.strip_suffix('Z') {
            Some(date_time) => (date_time, TimeScale::UTC),
            None => (text, self.time_scale()?),
        };
        parse_in_scale(date_time, scale).map_err(|problem| format!("epoch `{text}`: {problem}"))
    }

    /// The part of a span that the segment says is to be used.
    pub fn useable(&self, first: Epoch, last: Epoch) -> Result<[Epoch; 2], String> {
        let given = |key: &str| self.optional(key).map(|text| self.epoch(text)).transpose();
        let from = given("USEABLE_START_TIME")?.unwrap_or(first).max(first);
        let until = given("USEABLE_STOP_TIME")?.unwrap_or(last).min(last);
        if until < from {
            return Err("USEABLE_STOP_TIME lies before USEABLE_START_TIME".into());
        }
        Ok([from, until])
    }
}

/// Refuses a frame that no kernel could have, with the names that there are.
pub(super) fn check_frame(key: &str, frame: &str) -> Result<(), String> {
    if INERTIAL_FRAMES.contains(&frame) || frame_ids(frame).is_ok() {
        return Ok(());
    }
    let (inertial, lunar) = (INERTIAL_FRAMES.join(", "), LUNAR_FRAMES.map(|frame| frame.name).join(", "));
    Err(format!("{key} = {frame}; allowed are {inertial}, IAU_<BODY>, MOON_ME, MOON_PA, {lunar} and SPICE ids"))
}

/// Refuses segments that cover an instant twice, by more than `slack_s`: which of them holds there is not told.
pub(super) fn check_overlaps(spans: &[[Epoch; 2]], slack_s: f64) -> Result<(), String> {
    let mut sorted = spans.to_vec();
    sorted.sort_by_key(|[from, _]| *from);
    let overlap = sorted.windows(2).find(|pair| (pair[0][1] - pair[1][0]).to_seconds() > slack_s);
    overlap.map_or(Ok(()), |pair| {
        let [from, until] = [pair[1][0], pair[0][1].min(pair[1][1])].map(super::utc_text);
        Err(format!(
            "segments overlap from {from} to {until}; say which holds with USEABLE_START_TIME and USEABLE_STOP_TIME"
        ))
    })
}
