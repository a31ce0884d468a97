//! Double precision array files: the container of SPICE's binary kernels.
//!
//! A file is a list of 1024-byte records. The first names the format, summary records list the segments
//! (each with the name record that follows it), the rest is doubles, addressed from 1:
//!
//! ```text
//! record 1            file record: identification, counts per summary, first summary record
//! record 2 ..         comments
//! record `forward`    summary record: next, previous, count, then the summaries; its name record follows
//! further             the segments' doubles
//! ```
//!
//! Reading covers summaries of either byte order, enough to list and to check a kernel; `anise` evaluates the
//! segments. Writing covers SPK type 2 (Chebyshev positions), which `anise` cannot write.
//!
//! # References
//! NAIF, *DAF Required Reading* and *SPK Required Reading*, toolkit N0067.

const RECORD_BYTES: usize = 1024;
const DOUBLE_BYTES: usize = 8;
const RECORD_DOUBLES: usize = RECORD_BYTES / DOUBLE_BYTES;
/// A comment record holds 1000 characters.
const COMMENT_BYTES: usize = 1000;
/// Bytes that tell whether a transfer in text mode damaged the file.
const TRANSFER_CHECK: &[u8; 28] = b"FTPSTR:\r:\n:\r\n:\r\x00:\x81:\x10\xce:ENDFTP";

/// The kinds of segment that Perilune can use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Positions of a body against a centre.
    Spk,
    /// Orientation of a body-fixed frame against an inertial one.
    Bpc,
}

/// One segment as its summary states it.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    pub kind: Kind,
    pub name: String,
    /// SPK: the body. BPC: the body-fixed frame.
    pub target_id: i32,
    /// SPK: the centre of motion. BPC: none.
    pub center_id: Option<i32>,
    /// The inertial frame that the data refer to; 1 is ICRF (called J2000).
    pub inertial_frame_id: i32,
    pub data_type: i32,
    /// TDB seconds past J2000.
    pub start_et_s: f64,
    pub end_et_s: f64,
}

/// What is wrong with a file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DafError {
    #[error("it ends at byte {length}, before byte {needed}")]
    Short { length: usize, needed: usize },
    #[error("the identification `{found}` is neither DAF/SPK nor DAF/PCK")]
    Identification { found: String },
    #[error("the byte order `{found}` is neither LTL-IEEE nor BIG-IEEE")]
    ByteOrder { found: String },
    #[error("the transfer check string is damaged, as by a transfer in text mode")]
    Transfer,
    #[error("the summaries have {doubles} doubles and {integers} integers, which {kind:?} does not")]
    SummaryShape { kind: Kind, doubles: i32, integers: i32 },
    #[error("the summary records form a loop")]
    Loop,
    #[error("the summary of segment {index} is not a valid one")]
    Summary { index: usize },
    #[error("it lists no segments")]
    Empty,
}

/// Whether the bytes begin like a double precision array file.
pub fn is_daf(bytes: &[u8]) -> bool {
    bytes.starts_with(b"DAF/") || bytes.starts_with(b"NAIF/DAF")
}

/// Bytes with their order.
struct Reader<'a> {
    bytes: &'a [u8],
    little_endian: bool,
}

impl Reader<'_> {
    fn slice(&self, at: usize, length: usize) -> Result<&[u8], DafError> {
        let needed = at.saturating_add(length);
        self.bytes.get(at..needed).ok_or(DafError::Short { length: self.bytes.len(), needed })
    }

    fn integer(&self, at: usize) -> Result<i32, DafError> {
        let raw = self.slice(at, 4)?.try_into().expect("the slice has 4 bytes");
        Ok(if self.little_endian { i32::from_le_bytes(raw) } else { i32::from_be_bytes(raw) })
    }

    fn double(&self, at: usize) -> Result<f64, DafError> {
        let raw = self.slice(at, DOUBLE_BYTES)?.try_into().expect("the slice has 8 bytes");
        Ok(if self.little_endian { f64::from_le_bytes(raw) } else { f64::from_be_bytes(raw) })
    }

    fn text(&self, at: usize, length: usize) -> Result<String, DafError> {
        Ok(String::from_utf8_lossy(self.slice(at, length)?).trim_matches(['\0', ' ']).to_owned())
    }
}

/// Lists the segments of a file and checks that their data lie inside it.
pub fn read_segments(bytes: &[u8]) -> Result<Vec<Segment>, DafError> {
    let mut reader = Reader { bytes, little_endian: true };
    reader.slice(0, RECORD_BYTES)?;
    let kind = match reader.text(0, 8)?.as_str() {
        "DAF/SPK" => Kind::Spk,
        "DAF/PCK" => Kind::Bpc,
        other => return Err(DafError::Identification { found: other.to_owned() }),
    };
    reader.little_endian = match reader.text(88, 8)?.as_str() {
        "LTL-IEEE" => true,
        "BIG-IEEE" => false,
        other => return Err(DafError::ByteOrder { found: other.to_owned() }),
    };
    let check = reader.slice(699, TRANSFER_CHECK.len())?;
    // Kernels of before 1999 have no check string at all.
    if check != TRANSFER_CHECK && check.starts_with(b"FTPSTR") {
        return Err(DafError::Transfer);
    }
    let (doubles, integers) = (reader.integer(8)?, reader.integer(12)?);
    if (doubles, integers) != (2, if kind == Kind::Spk { 6 } else { 5 }) {
        return Err(DafError::SummaryShape { kind, doubles, integers });
    }
    let segments = walk_summaries(&reader, kind, reader.integer(76)?)?;
    if segments.is_empty() { Err(DafError::Empty) } else { Ok(segments) }
}

/// Whether the byte order is this machine's, the only one that `anise` evaluates.
pub fn has_native_order(bytes: &[u8]) -> bool {
    let native: &[u8] = if cfg!(target_endian = "little") { b"LTL-IEEE" } else { b"BIG-IEEE" };
    bytes.get(88..96) == Some(native)
}

fn walk_summaries(reader: &Reader, kind: Kind, forward: i32) -> Result<Vec<Segment>, DafError> {
    // Both kinds round up to 5 doubles a summary: 2 + ceil(6 / 2) and 2 + ceil(5 / 2).
    const SUMMARY_BYTES: usize = 5 * DOUBLE_BYTES;
    let mut segments = Vec::new();
    let mut record = usize::try_from(forward).unwrap_or(0);
    // A chain longer than the file is a loop.
    for _ in 0..=reader.bytes.len() / RECORD_BYTES {
        if record == 0 {
            return Ok(segments);
        }
        let at = (record - 1).saturating_mul(RECORD_BYTES);
        reader.slice(at, 2 * RECORD_BYTES)?;
        let count = reader.double(at + 2 * DOUBLE_BYTES)?;
        if !(0.0..=25.0).contains(&count) {
            return Err(DafError::Summary { index: segments.len() });
        }
        for i in 0..count as usize {
            let summary_at = at + 3 * DOUBLE_BYTES + i * SUMMARY_BYTES;
            let name = reader.text(at + RECORD_BYTES + i * SUMMARY_BYTES, SUMMARY_BYTES)?;
            segments.push(read_summary(reader, kind, summary_at, name, segments.len())?);
        }
        record = reader.double(at)? as usize;
    }
    Err(DafError::Loop)
}

fn read_summary(reader: &Reader, kind: Kind, at: usize, name: String, index: usize) -> Result<Segment, DafError> {
    let integer = |i: usize| reader.integer(at + 2 * DOUBLE_BYTES + 4 * i);
    let (start_et_s, end_et_s) = (reader.double(at)?, reader.double(at + DOUBLE_BYTES)?);
    let (center_id, next) = match kind {
        Kind::Spk => (Some(integer(1)?), 2),
        Kind::Bpc => (None, 1),
    };
    let (first, last) = (integer(next + 2)?, integer(next + 3)?);
    if !(start_et_s.is_finite() && end_et_s.is_finite() && start_et_s <= end_et_s) || first < 1 || last < first {
        return Err(DafError::Summary { index });
    }
    reader.slice((first as usize - 1) * DOUBLE_BYTES, (last - first + 1) as usize * DOUBLE_BYTES)?;
    let (inertial_frame_id, data_type) = (integer(next)?, integer(next + 1)?);
    Ok(Segment { kind, name, target_id: integer(0)?, center_id, inertial_frame_id, data_type, start_et_s, end_et_s })
}

/// Positions as Chebyshev polynomials over equal intervals, in ICRF and kilometres: SPK type 2.
#[derive(Debug, Clone, PartialEq)]
pub struct ChebyshevSegment {
    pub name: String,
    pub target_id: i32,
    pub center_id: i32,
    pub start_et_s: f64,
    pub interval_s: f64,
    /// For each interval the coefficients of x, y and z, all of one length.
    pub coefficients_km: Vec<[Vec<f64>; 3]>,
}

impl ChebyshevSegment {
    pub fn end_et_s(&self) -> f64 {
        self.start_et_s + self.interval_s * self.coefficients_km.len() as f64
    }

    fn doubles(&self) -> Vec<f64> {
        let mut doubles = Vec::new();
        for (i, axes) in self.coefficients_km.iter().enumerate() {
            doubles.extend([self.start_et_s + (i as f64 + 0.5) * self.interval_s, 0.5 * self.interval_s]);
            doubles.extend(axes.iter().flatten());
        }
        let intervals = self.coefficients_km.len();
        let record_doubles = doubles.len() / intervals.max(1);
        doubles.extend([self.start_et_s, self.interval_s, record_doubles as f64, intervals as f64]);
        doubles
    }
}

/// Writes a little-endian SPK of at most 25 segments, the same bytes for the same input.
pub fn write_spk(internal_name: &str, comment: &str, segments: &[ChebyshevSegment]) -> Vec<u8> {
    assert!(segments.len() <= 25, "one summary record holds 25 segments");
    let comments = comment_records(comment);
    let summary_record = 2 + comments.len() / RECORD_BYTES;
    let mut address = (summary_record + 1) * RECORD_DOUBLES + 1;
    let mut summaries = Vec::new();
    let mut names = Vec::new();
    let mut data = Vec::new();
    for segment in segments {
        let doubles = segment.doubles();
        let last = address + doubles.len() - 1;
        summaries.extend([segment.start_et_s, segment.end_et_s()].iter().flat_map(|x| x.to_le_bytes()));
        let integers = [segment.target_id, segment.center_id, 1, 2, address as i32, last as i32];
        summaries.extend(integers.iter().flat_map(|x| x.to_le_bytes()));
        names.extend(padded(&segment.name, 40));
        data.extend(doubles.iter().flat_map(|x| x.to_le_bytes()));
        address = last + 1;
    }
    let mut file = file_record(internal_name, summary_record as i32, address as i32);
    file.extend(comments);
    file.extend([0.0, 0.0, segments.len() as f64].iter().flat_map(|x: &f64| x.to_le_bytes()));
    file.extend(summaries);
    fill_record(&mut file, 0);
    file.extend(names);
    fill_record(&mut file, b' ');
    file.extend(data);
    fill_record(&mut file, 0);
    file
}

fn file_record(internal_name: &str, summary_record: i32, free_address: i32) -> Vec<u8> {
    let mut record = b"DAF/SPK ".to_vec();
    record.extend([2_i32, 6].iter().flat_map(|x| x.to_le_bytes()));
    record.extend(padded(internal_name, 60));
    record.extend([summary_record, summary_record, free_address].iter().flat_map(|x| x.to_le_bytes()));
    record.extend(b"LTL-IEEE");
    record.resize(699, 0);
    record.extend(TRANSFER_CHECK);
    fill_record(&mut record, 0);
    record
}

/// Comment records: lines end with a null, the text with the character 4.
fn comment_records(comment: &str) -> Vec<u8> {
    let mut text: Vec<u8> = comment.bytes().map(|byte| if byte == b'\n' { 0 } else { byte }).collect();
    text.push(4);
    let mut records = Vec::new();
    for chunk in text.chunks(COMMENT_BYTES) {
        records.extend(chunk);
        fill_record(&mut records, 0);
    }
    records
}

fn padded(text: &str, length: usize) -> Vec<u8> {
    let mut bytes: Vec<u8> = text.bytes().take(length).collect();
    bytes.resize(length, b' ');
    bytes
}

fn fill_record(bytes: &mut Vec<u8>, filler: u8) {
    bytes.resize(bytes.len().next_multiple_of(RECORD_BYTES), filler);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file() -> Vec<u8> {
        let line = |i: f64| [vec![i, 1.0], vec![2.0 * i, 0.0], vec![0.0, -1.0]];
        let segment = ChebyshevSegment {
            name: "a line".into(),
            target_id: -999,
            center_id: 301,
            start_et_s: 100.0,
            interval_s: 50.0,
            coefficients_km: vec![line(0.0), line(1.0), line(2.0)],
        };
        write_spk("test", "a comment\nof two lines", &[segment.clone(), ChebyshevSegment { target_id: 7, ..segment }])
    }

    #[test]
    fn a_written_file_lists_its_segments() {
        let segments = read_segments(&file()).unwrap();
        assert_eq!(segments.len(), 2);
        let first = &segments[0];
        assert_eq!((first.target_id, first.center_id, first.data_type), (-999, Some(301), 2));
        assert_eq!((first.name.as_str(), first.inertial_frame_id), ("a line", 1));
        assert_eq!((first.start_et_s, first.end_et_s), (100.0, 250.0));
        assert_eq!(segments[1].target_id, 7);
    }

    #[test]
    fn a_damaged_file_is_refused() {
        let whole = file();
        let cut = &whole[..whole.len() - RECORD_BYTES];
        assert!(matches!(read_segments(cut), Err(DafError::Short { .. })));
        assert!(matches!(read_segments(&whole[..100]), Err(DafError::Short { .. })));
        let mut text_mode = whole.clone();
        text_mode[699 + 9] = b'\r';
        assert_eq!(read_segments(&text_mode), Err(DafError::Transfer));
        let mut looping = whole.clone();
        let at = 2 * RECORD_BYTES;
        looping[at..at + 8].copy_from_slice(&3.0_f64.to_le_bytes());
        assert_eq!(read_segments(&looping), Err(DafError::Loop));
        let mut pointers = whole;
        pointers[at + 24..at + 32].copy_from_slice(&f64::NAN.to_le_bytes());
        assert_eq!(read_segments(&pointers), Err(DafError::Summary { index: 0 }));
    }
}
