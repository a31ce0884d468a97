//! What can go wrong between a kernel file and a position.

use std::path::PathBuf;

use anise::ephemerides::EphemerisError as AniseEphemerisError;
use anise::orientations::OrientationError as AniseOrientationError;
use anise::structure::dataset::DataSetError as AniseDataSetError;

use super::daf::DafError;

/// A kernel, an epoch, a body or a frame that cannot be used, and why.
#[derive(Debug, thiserror::Error)]
pub enum EphemerisError {
    #[error("kernel {} cannot be read{hint}", path.display())]
    Unreadable { path: PathBuf, hint: String, source: std::io::Error },
    #[error("kernel {} is corrupted", path.display())]
    Corrupted { path: PathBuf, source: DafError },
    #[error("kernel {} is {found}; allowed are SPK, binary PCK, text PCK, text FK, meta-kernels and ANISE's .pca and .epa", path.display())]
    Unsupported { path: PathBuf, found: &'static str },
    #[error("kernel {}, line {line}: {problem}", path.display())]
    Text { path: PathBuf, line: usize, problem: String },
    #[error("meta-kernel {} is named by meta-kernel {}; a meta-kernel names no other", path.display(), by.display())]
    NestedMeta { path: PathBuf, by: PathBuf },
    #[error("the constants of the text kernels cannot be used")]
    Constants { source: Box<AniseDataSetError> },
    #[error("the rotation of {frame} in the loaded kernels is not evaluated: {reason}")]
    Rotation { frame: String, reason: String },
    #[error("kernel {}: segment `{segment}` has data type {data_type}; allowed are {allowed}", path.display())]
    DataType { path: PathBuf, segment: String, data_type: i32, allowed: &'static str },
    #[error("kernel {}: segment `{segment}` refers to inertial frame {frame_id}; allowed are {allowed}", path.display())]
    InertialFrame { path: PathBuf, segment: String, frame_id: i32, allowed: &'static str },
    #[error("kernel {}: segments of {what} overlap at {from_utc}, which is read in different ways", path.display())]
    Overlap { path: PathBuf, what: String, from_utc: String },
    #[error("{what} at {epoch_utc} is outside the loaded coverage: {coverage}")]
    OutsideCoverage { what: String, epoch_utc: String, coverage: String },
    #[error("no loaded kernel has {what}; loaded are {loaded}")]
    NotLoaded { what: String, loaded: String },
    #[error("body `{name}` is unknown; allowed are {allowed} and SPICE ids")]
    UnknownBody { name: String, allowed: String },
    #[error("frame `{name}` is unknown; allowed are IAU_<BODY>, {allowed} and SPICE ids")]
    UnknownFrame { name: String, allowed: String },
    #[error("frame {frame} needs {needed}; loaded are {loaded}")]
    FrameNotAvailable { frame: String, needed: String, loaded: String },
    #[error("no loaded kernel has the {constant} of {body}; loaded are {loaded}")]
    NoConstant { body: String, constant: &'static str, loaded: String },
    #[error("epoch `{text}`: {problem}; write it as 2026-09-08T00:00:00Z, or with UTC, TDB, TT or TAI after it")]
    Epoch { text: String, problem: &'static str },
    #[error("{what} at {epoch_utc} cannot be computed")]
    Position { what: String, epoch_utc: String, source: Box<AniseEphemerisError> },
    #[error("the orientation of {frame} at {epoch_utc} cannot be computed")]
    Orientation { frame: String, epoch_utc: String, source: Box<AniseOrientationError> },
    #[error("{what} at {epoch_utc} is not a finite number; the kernel's data are damaged")]
    NotFinite { what: String, epoch_utc: String },
    #[error("{what} coincides with the observer at {epoch_utc}")]
    Coincident { what: String, epoch_utc: String },
    #[error("{} cannot be written", path.display())]
    Unwritable { path: PathBuf, source: std::io::Error },
    #[error("a kernel from {from_utc} until {until_utc} is empty or leaves 1900 to 2100, where the series hold")]
    Span { from_utc: String, until_utc: String },
}
