//! From heights to a horizon map: sweep, project, measure, store.
//!
//! Azimuths are swept in blocks, one a thread, first those along the rows' axis, then those along the columns', so
//! that one orientation of the heights is in memory at a time. Each plane is added to the coefficients and dropped.
//! Every [`CHECKPOINT_EVERY`] the sums are saved beside the tile: an interrupted build goes on from there, to the same
//! bytes.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::checkpoint::Checkpoint;
use super::error::Error;
use super::fit::{Accumulator, Plane};
use super::measure::{Sample, measure};
use super::pack::{Encoding, HorizonMap};
use super::settings::Settings;
use super::store::{self, Header, Key};
use super::sweep::Sweep;
use super::sweep::grid::Major;
use crate::terrain::Face;

/// How much work a kill may cost.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(20);
/// Pixels on which a tile measures its own error.
const MEASURED_PIXELS: usize = 64;

/// Told how many of how many azimuths are done.
pub type Progress<'a> = dyn Fn(usize, usize) + Sync + 'a;

/// The horizon map of a level from its tile in `directory`, made first where there is no such tile, or a damaged one.
pub fn open_or_build(
    face: &Face,
    level: usize,
    settings: &Settings,
    encoding: Encoding,
    directory: &Path,
    progress: &Progress,
) -> Result<HorizonMap, Error> {
    check(face, level, settings, encoding)?;
    let key = Key::of(face, level, settings, encoding);
    match store::read_of(directory, &key) {
        Ok(map) => Ok(map),
        Err(_) => build(face, level, settings, encoding, directory, progress),
    }
}

/// Makes the horizon map of a level and stores its tile in `directory`.
pub fn build(
    face: &Face,
    level: usize,
    settings: &Settings,
    encoding: Encoding,
    directory: &Path,
    progress: &Progress,
) -> Result<HorizonMap, Error> {
    check(face, level, settings, encoding)?;
    fs::create_dir_all(directory).map_err(|source| Error::write(directory, source))?;
    let key = Key::of(face, level, settings, encoding);
    let path = store::path_for(directory, &key);
    let checkpoint = Checkpoint::new(path.with_extension("partial"), key);

    let mut state = State::new(face, level, settings, encoding);
    checkpoint.resume(&mut state);
    let mut saved = Instant::now();
    state.run(face, level, settings, |state| {
        progress(state.done, settings.azimuths);
        if saved.elapsed() > CHECKPOINT_EVERY && state.done < settings.azimuths {
            checkpoint.save(state)?;
            saved = Instant::now();
        }
        Ok(())
    })?;

    let map = state.finish(face, level, settings, encoding);
    store::write(&path, &Header::new(face, level, settings, &map), &map)?;
    checkpoint.remove();
    Ok(map)
}

fn check(face: &Face, level: usize, settings: &Settings, encoding: Encoding) -> Result<(), Error> {
    let nodes = face.levels.get(level).ok_or(Error::NoLevel { got: level, levels: face.levels.len() })?;
    let seen = |nodes: usize, margin: usize| nodes.saturating_sub(2 * margin);
    let (columns, rows) = (seen(nodes.columns, nodes.margin), seen(nodes.rows, nodes.margin));
    if columns < 2 || rows < 2 {
        return Err(Error::TooSmall { level, columns, rows });
    }
    // Fewer samples than twice the highest harmonic do not determine it.
    let least = 2 * encoding.harmonics() + 1;
    if settings.azimuths < least {
        return Err(Error::TooFewAzimuths { got: settings.azimuths, harmonics: encoding.harmonics(), least });
    }
    if !(0.0..=1e6).contains(&settings.observer_height_m) {
        return Err(Error::ObserverHeight { got: settings.observer_height_m });
    }
    match settings.search_m {
        Some(got) if got.is_nan() || got <= 0.0 => Err(Error::SearchDistance { got }),
        _ => Ok(()),
    }
}

/// A build under way.
#[derive(Debug)]
pub struct State {
    /// Azimuths added: first those along the rows' axis, then those along the columns'.
    pub done: usize,
    /// `[row][column]` until the first azimuth along the columns is added, `[column][row]` from then on.
    pub sums: Accumulator,
    pub sample: Sample,
    /// Azimuths along the rows' axis.
    along_rows: usize,
}

/// Azimuths along one axis.
fn along(settings: &Settings, major: Major) -> Vec<usize> {
    (0..settings.azimuths).filter(|azimuth| Major::of(settings.direction(*azimuth)) == major).collect()
}

impl State {
    fn new(face: &Face, level: usize, settings: &Settings, encoding: Encoding) -> Self {
        let nodes = &face.levels[level];
        let (columns, rows) = (nodes.columns - 2 * nodes.margin, nodes.rows - 2 * nodes.margin);
        let sums = Accumulator::new(encoding, columns, rows, settings.azimuths);
        let sample = Sample::of(nodes, MEASURED_PIXELS, settings.azimuths);
        Self { done: 0, sums, sample, along_rows: along(settings, Major::Row).len() }
    }

    /// Takes on the shape of a state after so many azimuths.
    pub fn resume_at(&mut self, done: usize) {
        if done > self.along_rows {
            self.sums = self.sums.transposed();
        }
        self.done = done;
    }

    /// Sweeps what is not done yet, calling back after every block.
    fn run(
        &mut self,
        face: &Face,
        level: usize,
        settings: &Settings,
        mut after_block: impl FnMut(&Self) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let mut before = 0;
        for major in [Major::Row, Major::Column] {
            let azimuths = along(settings, major);
            let left = azimuths.len().saturating_sub(self.done.saturating_sub(before));
            if left > 0 {
                if major == Major::Column && self.done == before {
                    self.sums = self.sums.transposed();
                }
                let sweep = Sweep::new(face, level, major, settings);
                for block in azimuths[azimuths.len() - left..].chunks(rayon::current_num_threads()) {
                    self.add(&sweep, block, settings, major);
                    after_block(self)?;
                }
            }
            before += azimuths.len();
        }
        Ok(())
    }

    fn add(&mut self, sweep: &Sweep, block: &[usize], settings: &Settings, major: Major) {
        let plane = |&azimuth: &usize| Plane {
            azimuth,
            stride: sweep.receivers.stride,
            elevations_rad: sweep.elevations_rad(settings.direction(azimuth)),
        };
        let planes: Vec<_> = block.par_iter().map(plane).collect();
        self.sums.add(&planes);
        planes.iter().for_each(|plane| self.sample.keep(plane, major));
        self.done += block.len();
    }

    fn finish(self, face: &Face, level: usize, settings: &Settings, encoding: Encoding) -> HorizonMap {
        let sums = self.sums.transposed();
        let mut map = HorizonMap {
            encoding,
            columns: sums.columns(),
            rows: sums.rows(),
            levels: sums.texels(),
            errors: Default::default(),
        };
        map.errors = measure(face, level, settings, &self.sample, &map);
        map
    }
}
