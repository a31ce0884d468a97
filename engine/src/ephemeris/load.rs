//! Loading kernels: what `anise` reads wrongly without a word is refused or repaired here.
//!
//! Refused are segments in frames other than ICRF (`anise` 0.10.6 ignores a segment's frame), of types that it cannot
//! evaluate, and those that overlap in a file. Text kernels are read here ([`super::kernel_pool`]); bodies without mass or
//! without the angles of their system are kept.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use anise::almanac::Almanac as Anise;
use anise::naif::kpl::parser::convert_tpc_items;
use anise::naif::kpl::tpc::TPCItem;
use anise::naif::kpl::{KPLValue, Parameter};
use anise::naif::{BPC, SPK};

use super::daf::{DafError, Kind, Segment};
use super::epoch::et_text;
use super::kernel::{Contents, Kernel};
use super::kernel_pool::{Constants, KernelPool};
use super::names::body_name;
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
    /// What a meta-kernel names is loaded where it stands.
    pub fn load_sources(sources: &[KernelSource]) -> Result<Self, EphemerisError> {
        let mut loader = Loader::default();
        for source in sources {
            loader.take(source, None)?;
        }
        loader.finish()
    }
}

/// What has been loaded so far.
#[derive(Default)]
struct Loader {
    anise: Anise,
    kernels: Vec<Kernel>,
    pool: KernelPool,
}

impl Loader {
    fn take(&mut self, source: &KernelSource, named_by: Option<&Path>) -> Result<(), EphemerisError> {
        let (kernel, contents) = Kernel::read(source)?;
        let path = source.path();
        check_segments(&kernel)?;
        // ANISE keeps kernels by name, and two folders may hold one name.
        let alias = Some(format!("{} {}", self.kernels.len(), path.display()));
        let anise = std::mem::take(&mut self.anise);
        let mut names = Vec::new();
        self.anise = match contents {
            Contents::Daf(bytes) => load_daf(anise, path, &kernel, &bytes, alias)?,
            Contents::Bodies(set) => anise.with_planetary_data_as(set, alias),
            Contents::Frames(set) => anise.with_euler_parameters_as(set, alias),
            Contents::Text { assignments, names: named } => {
                names = named;
                self.pool.assign(path, assignments)?;
                anise
            }
        };
        self.kernels.push(kernel);
        match named_by {
            Some(by) if !names.is_empty() => {
                Err(EphemerisError::NestedMeta { path: path.to_owned(), by: by.to_owned() })
            }
            _ => names.iter().try_for_each(|named| self.take(named, Some(path))),
        }
    }

    fn finish(self) -> Result<Almanac, EphemerisError> {
        let Self { mut anise, kernels, pool } = self;
        let Constants { bodies, left_out } = pool.constants()?;
        if !bodies.is_empty() {
            let set = convert_tpc_items(completed(bodies), HashMap::new())
                .map_err(|source| EphemerisError::Constants { source: Box::new(source) })?;
            anise = anise.with_planetary_data_as(set, Some("text".to_owned()));
        }
        if let Some(frames) = pool.lunar_frames()? {
            anise = anise.with_euler_parameters_as(frames, Some("text".to_owned()));
        }
        Ok(Almanac { anise, kernels, left_out })
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

/// Gives every body what ANISE asks for: a mass, since it skips bodies without, an entry of its system, and to Mercury and
/// Venus their systems' angles, since ANISE finds them under either id, by chance.
fn completed(mut constants: HashMap<i32, TPCItem>) -> HashMap<i32, TPCItem> {
    for (planet, system) in [(199, 1), (299, 2)] {
        if let Some(system) = constants.remove(&system)
            && let Some(planet) = constants.get_mut(&planet)
        {
            for (parameter, value) in system.data {
                planet.data.entry(parameter).or_insert(value);
            }
        }
    }
    let systems: Vec<i32> = constants.keys().filter(|id| **id >= 300).map(|id| id / 100).collect();
    for id in systems {
        constants.entry(id).or_insert_with(|| TPCItem { body_id: Some(id), ..TPCItem::default() });
    }
    for item in constants.values_mut() {
        item.data.entry(Parameter::GravitationalParameter).or_insert(KPLValue::Float(0.0));
    }
    constants
}
