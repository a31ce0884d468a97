//! Loading kernels: what `anise` reads wrongly without a word is refused or repaired here.
//!
//! Refused are segments in frames other than ICRF (`anise` 0.10.6 ignores a segment's frame), of types that it cannot
//! evaluate, and those that overlap in a file. Repaired are constants: text kernels are merged in order,
//! bodies without mass kept, and frames given by matrices left out.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use anise::almanac::Almanac as Anise;
use anise::naif::kpl::fk::FKItem;
use anise::naif::kpl::parser::{convert_fk_items, convert_tpc_items};
use anise::naif::kpl::tpc::TPCItem;
use anise::naif::kpl::{KPLValue, Parameter};
use anise::naif::{BPC, SPK};

use super::daf::{DafError, Kind, Segment};
use super::epoch::et_text;
use super::kernel::{Contents, Kernel};
use super::names::{LUNAR_FRAMES, body_name};
use super::shipped::KernelSource;
use super::{Almanac, EphemerisError};

/// SPK types that are evaluated, and the only one of binary PCK.
const SPK_TYPES: (&[i32], &str) = (&[1, 2, 3, 8, 9, 12, 13], "1, 2, 3, 8, 9, 12 and 13");
const BPC_TYPES: (&[i32], &str) = (&[2], "2");
/// SPICE's id of ICRF, called J2000 there.
const ICRF: i32 = 1;

impl Almanac {
    /// Loads kernels in order; where two cover the same, the later one wins, as in SPICE.
    pub fn load(paths: &[PathBuf]) -> Result<Self, EphemerisError> {
        Self::load_sources(&paths.iter().cloned().map(KernelSource::File).collect::<Vec<_>>())
    }

    /// Loads kernels in order, from files or from the program; where two cover the same, the later one wins, as in SPICE.
    pub fn load_sources(sources: &[KernelSource]) -> Result<Self, EphemerisError> {
        let mut anise = Anise::default();
        let mut kernels: Vec<Kernel> = Vec::new();
        let mut constants = HashMap::new();
        let mut constants_path = PathBuf::new();
        for source in sources {
            let (kernel, contents) = Kernel::read(source)?;
            let path = source.path();
            check_segments(&kernel)?;
            // ANISE keeps kernels by name, and two folders may hold one name.
            let alias = Some(format!("{} {}", kernels.len(), path.display()));
            anise = match contents {
                Contents::Daf(bytes) => load_daf(anise, path, &kernel, &bytes, alias)?,
                Contents::Bodies(set) => anise.with_planetary_data_as(set, alias),
                Contents::Frames(set) => anise.with_euler_parameters_as(set, alias),
                Contents::Text { bodies, frames } => {
                    if !bodies.is_empty() {
                        path.clone_into(&mut constants_path);
                    }
                    merge_constants(&mut constants, bodies);
                    with_fixed_frames(anise, path, frames, alias)?
                }
            };
            kernels.push(kernel);
        }
        if !constants.is_empty() {
            let set = convert_tpc_items(with_masses(constants), HashMap::new())
                .map_err(|source| EphemerisError::Constants { path: constants_path, source: Box::new(source) })?;
            anise = anise.with_planetary_data_as(set, Some("text".to_owned()));
        }
        Ok(Self { anise, kernels })
    }
}

/// Refuses segments that ANISE would read wrongly without a word.
fn check_segments(kernel: &Kernel) -> Result<(), EphemerisError> {
    for segment in &kernel.segments {
        let (path, name) = (kernel.path.clone(), segment.name.clone());
        let (types, allowed) = if segment.kind == Kind::Spk { SPK_TYPES } else { BPC_TYPES };
        if !types.contains(&segment.data_type) {
            return Err(EphemerisError::DataType { path, segment: name, data_type: segment.data_type, allowed });
        }
        // ANISE ignores the frame that a segment states.
        let frame_id = segment.inertial_frame_id;
        if frame_id != ICRF {
            return Err(EphemerisError::InertialFrame { path, segment: name, frame_id, allowed: "1 (ICRF)" });
        }
    }
    check_overlaps(kernel)
}

/// SPICE prefers the last of two overlapping segments in a file, ANISE the first.
fn check_overlaps(kernel: &Kernel) -> Result<(), EphemerisError> {
    let ids: BTreeSet<i32> = kernel.segments.iter().map(|segment| segment.target_id).collect();
    for id in ids {
        let mut spans: Vec<&Segment> = kernel.segments.iter().filter(|segment| segment.target_id == id).collect();
        spans.sort_by(|a, b| a.start_et_s.total_cmp(&b.start_et_s));
        if let Some(pair) = spans.windows(2).find(|pair| pair[1].start_et_s < pair[0].end_et_s) {
            let from_utc = et_text(pair[1].start_et_s);
            let what = body_name(id);
            return Err(EphemerisError::Overlap { path: kernel.path.clone(), what, from_utc });
        }
    }
    Ok(())
}

fn load_daf(
    anise: Anise,
    path: &Path,
    kernel: &Kernel,
    bytes: &[u8],
    alias: Option<String>,
) -> Result<Anise, EphemerisError> {
    // The summaries were checked before; what ANISE may still refuse is a summary's epochs.
    let refused = |_| EphemerisError::Corrupted { path: path.to_owned(), source: DafError::Summary { index: 0 } };
    if kernel.segments[0].kind == Kind::Spk {
        Ok(anise.with_spk_as(SPK::parse(bytes).map_err(refused)?, alias))
    } else {
        Ok(anise.with_bpc_as(BPC::parse(bytes).map_err(refused)?, alias))
    }
}

fn with_fixed_frames(
    anise: Anise,
    path: &Path,
    frames: HashMap<i32, FKItem>,
    alias: Option<String>,
) -> Result<Anise, EphemerisError> {
    // ANISE hangs frames given by a matrix on the wrong parent; only the lunar ones, given by angles, are used.
    let lunar: HashMap<i32, FKItem> =
        frames.into_iter().filter(|(id, _)| LUNAR_FRAMES.iter().any(|frame| frame.id == *id)).collect();
    if lunar.is_empty() {
        return Ok(anise);
    }
    let set = convert_fk_items(lunar)
        .map_err(|source| EphemerisError::Constants { path: path.to_owned(), source: Box::new(source) })?;
    Ok(anise.with_euler_parameters_as(set, alias))
}

fn merge_constants(all: &mut HashMap<i32, TPCItem>, more: HashMap<i32, TPCItem>) {
    for (id, item) in more {
        all.entry(id).or_insert_with(|| TPCItem { body_id: Some(id), ..TPCItem::default() }).data.extend(item.data);
    }
}

/// Gives every body a mass, since ANISE skips bodies without, and Mercury and Venus their systems' angles, since
/// ANISE finds them under either id, by chance.
fn with_masses(mut constants: HashMap<i32, TPCItem>) -> HashMap<i32, TPCItem> {
    for (planet, system) in [(199, 1), (299, 2)] {
        if let Some(system) = constants.remove(&system)
            && let Some(planet) = constants.get_mut(&planet)
        {
            for (parameter, value) in system.data {
                planet.data.entry(parameter).or_insert(value);
            }
        }
    }
    for item in constants.values_mut() {
        let mass = item.data.entry(Parameter::GravitationalParameter).or_insert(KPLValue::Float(0.0));
        if let KPLValue::Integer(whole) = *mass {
            *mass = KPLValue::Float(f64::from(whole));
        }
    }
    constants
}
