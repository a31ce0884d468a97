//! Kernel files: what kind they are, what they cover, their SHA-256.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anise::structure::{EulerParameterDataSet, PlanetaryDataSet};

use super::daf::{self, DafError, Kind, Segment};
use super::epoch::et_text;
use super::names::{body_name, frame_name};
use super::shipped::KernelSource;
use super::text_kernel::{self, Assignment};
use super::{EphemerisError, fixed_frames, kernel_pool, known_file, meta_kernel};

/// A kernel file and what it holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Kernel {
    pub path: PathBuf,
    /// The file's name without its folder, as manifests state it.
    pub name: String,
    pub sha256: String,
    pub format: Format,
    /// Positions and tabulated orientations over spans of time.
    pub segments: Vec<Segment>,
    /// Bodies whose size, mass or rotation are given as constants.
    pub constants_of: Vec<i32>,
    /// Frames defined by a constant rotation.
    pub fixed_frames: Vec<i32>,
    /// The kernels that a meta-kernel names.
    pub names: Vec<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    Spk,
    BinaryPck,
    /// A text kernel: PCK, FK or leap seconds. The last change nothing, since the program knows them.
    Text,
    /// A text kernel that names kernels to load.
    Meta,
    /// ANISE's `.pca` or `.epa`.
    Anise,
}

/// The data of a kernel, ready for the almanac.
pub(super) enum Contents {
    Daf(Vec<u8>),
    Text { assignments: Vec<Assignment>, names: Vec<KernelSource> },
    Bodies(PlanetaryDataSet),
    Frames(EulerParameterDataSet),
}

impl Kernel {
    /// Reads what a file covers, without checking that all of it can be used.
    pub fn open(path: &Path) -> Result<Self, EphemerisError> {
        Self::read(&KernelSource::File(path.to_owned())).map(|(kernel, _)| kernel)
    }

    pub(super) fn read(source: &KernelSource) -> Result<(Self, Contents), EphemerisError> {
        let path = source.path();
        let bytes = match source {
            KernelSource::File(path) => read_file(path)?,
            KernelSource::Shipped(kernel) => kernel.bytes.to_vec(),
        };
        let sha256 = crate::digest::sha256_hex(&bytes);
        let contents = Contents::from_bytes(path, bytes)?;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let (format, segments) = match &contents {
            Contents::Daf(bytes) => {
                let segments = daf::read_segments(bytes).map_err(|source| corrupted(path, source))?;
                let format = if segments[0].kind == Kind::Spk { Format::Spk } else { Format::BinaryPck };
                (format, segments)
            }
            Contents::Text { names, .. } if names.is_empty() => (Format::Text, Vec::new()),
            Contents::Text { .. } => (Format::Meta, Vec::new()),
            Contents::Bodies(_) | Contents::Frames(_) => (Format::Anise, Vec::new()),
        };
        let (constants_of, fixed_frames) = contents.ids();
        let names = match &contents {
            Contents::Text { names, .. } => names.iter().map(|named| named.path().to_owned()).collect(),
            _ => Vec::new(),
        };
        let path = path.to_owned();
        Ok((Self { path, name, sha256, format, segments, constants_of, fixed_frames, names }, contents))
    }

    /// The kernel as lines of text: format, SHA-256, then a line for each segment and list of constants.
    pub fn describe(&self) -> Vec<String> {
        let mut lines = vec![format!("{}: {:?}, sha256 {}", self.path.display(), self.format, self.sha256)];
        let widest = self.segments.iter().map(|segment| segment.subject().len()).max().unwrap_or(0);
        lines.extend(self.segments.iter().map(|segment| {
            let ([start, end], subject) = (segment.span_utc(), segment.subject());
            format!("  {subject:<widest$}  {start} to {end}  type {}  `{}`", segment.data_type, segment.name)
        }));
        let list = |ids: &[i32], name: fn(i32) -> String| ids.iter().map(|id| name(*id)).collect::<Vec<_>>().join(", ");
        if !self.constants_of.is_empty() {
            lines.push(format!("  constants of {}", list(&self.constants_of, body_name)));
        }
        if !self.fixed_frames.is_empty() {
            lines.push(format!("  frames {}", list(&self.fixed_frames, frame_name)));
        }
        lines.extend(self.names.iter().map(|path| format!("  loads {}", path.display())));
        lines
    }
}

fn read_file(path: &Path) -> Result<Vec<u8>, EphemerisError> {
    std::fs::read(path).map_err(|source| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let hint = known_file(&name).map(|file| format!("; it is {}; get it from {}", file.what, file.source));
        EphemerisError::Unreadable { path: path.to_owned(), hint: hint.unwrap_or_default(), source }
    })
}

impl Segment {
    /// What the segment tells of: `moon (301) from earth-moon barycenter (3) in ICRF`.
    pub fn subject(&self) -> String {
        let with_id = |id: i32| {
            if body_name(id) == id.to_string() { id.to_string() } else { format!("{} ({id})", body_name(id)) }
        };
        match self.center_id {
            Some(center) => {
                format!(
                    "{} from {} in {}",
                    with_id(self.target_id),
                    with_id(center),
                    frame_name(self.inertial_frame_id)
                )
            }
            None => {
                format!("{} ({}) in {}", frame_name(self.target_id), self.target_id, frame_name(self.inertial_frame_id))
            }
        }
    }

    /// First and last epoch as text.
    pub fn span_utc(&self) -> [String; 2] {
        [self.start_et_s, self.end_et_s].map(et_text)
    }

    pub(super) fn covers(&self, et_s: f64) -> bool {
        (self.start_et_s..=self.end_et_s).contains(&et_s)
    }
}

impl Contents {
    fn from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, EphemerisError> {
        let unsupported = |found| EphemerisError::Unsupported { path: path.to_owned(), found };
        if bytes.is_empty() {
            return Err(corrupted(path, DafError::Empty));
        }
        if daf::is_daf(&bytes) {
            return match bytes.get(..8) {
                Some(b"DAF/CK  ") => Err(unsupported("a CK (spacecraft attitude)")),
                Some(b"DAF/SPK " | b"DAF/PCK ") if bytes.len() >= 96 && !daf::has_native_order(&bytes) => {
                    daf::read_segments(&bytes).map_err(|source| corrupted(path, source))?;
                    Err(unsupported("a kernel in the other byte order (convert it with NAIF's bingo)"))
                }
                _ => Ok(Self::Daf(bytes)),
            };
        }
        if bytes.starts_with(b"version https://git-lfs") {
            return Err(unsupported("a Git LFS pointer, not the file it stands for"));
        }
        if text_kernel::is_text_kernel(&bytes) {
            let fault = |fault: text_kernel::Fault| {
                let (path, problem) = (path.to_owned(), fault.problem);
                EphemerisError::Text { path, line: fault.line, problem }
            };
            let assignments = text_kernel::parse(&String::from_utf8_lossy(&bytes)).map_err(fault)?;
            let names = meta_kernel::named(path, &assignments)?;
            return Ok(Self::Text { assignments, names });
        }
        if let Ok(bodies) = PlanetaryDataSet::try_from_bytes(&bytes[..]) {
            return Ok(Self::Bodies(bodies));
        }
        match EulerParameterDataSet::try_from_bytes(&bytes[..]) {
            Ok(frames) => Ok(Self::Frames(frames)),
            Err(_) => Err(unsupported("of no known kind")),
        }
    }

    /// Ids of the bodies and of the frames given as constants, sorted.
    fn ids(&self) -> (Vec<i32>, Vec<i32>) {
        let sorted = |ids: BTreeSet<i32>| ids.into_iter().collect::<Vec<_>>();
        match self {
            Self::Daf(_) => (Vec::new(), Vec::new()),
            Self::Text { assignments, .. } => {
                (sorted(kernel_pool::bodies(assignments)), sorted(fixed_frames::frames(assignments)))
            }
            Self::Bodies(set) => (sorted(set.lut.by_id.keys().copied().collect()), Vec::new()),
            Self::Frames(set) => (Vec::new(), sorted(set.lut.by_id.keys().copied().collect())),
        }
    }
}

fn corrupted(path: &Path, source: DafError) -> EphemerisError {
    EphemerisError::Corrupted { path: path.to_owned(), source }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_other_kinds_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let cases: [(&[u8], &str); 5] = [
            (b"", "it lists no segments"),
            (b"DAF/CK  and more", "a CK"),
            (b"version https://git-lfs.github.com/spec/v1", "Git LFS"),
            (b"\x89PNG and more", "of no known kind"),
            (b"DAF/SPK cut", "it ends at byte 11"),
        ];
        for (bytes, expected) in cases {
            let path = folder.path().join("file.bsp");
            std::fs::write(&path, bytes).unwrap();
            let error = Kernel::open(&path).unwrap_err();
            let text =
                format!("{error}: {}", std::error::Error::source(&error).map(ToString::to_string).unwrap_or_default());
            assert!(text.contains(expected), "{text}");
        }
    }

    #[test]
    fn a_missing_file_that_is_known_tells_where_it_can_be_had() {
        let error = Kernel::open(Path::new("nowhere/de440s.bsp")).unwrap_err().to_string();
        assert!(error.contains("nowhere/de440s.bsp") && error.contains("naif.jpl.nasa.gov"), "{error}");
    }
}
