//! From heights to a horizon map: sweep, project, measure, store.
//!
//! Azimuths are swept in blocks, one a thread, first those along the rows' axis, then those along the columns', so
//! that one orientation of the heights is in memory at a time. Each plane is added to the coefficients and dropped.
//! Every `CHECKPOINT_EVERY` the sums are saved beside the tile: an interrupted build goes on from there, to the same
//! bytes.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::band::Ends;
use super::checkpoint::Checkpoint;
use super::error::Error;
use super::fit::{Accumulator, Plane};
use super::measure::{Sample, measure};
use super::pack::{Encoding, HorizonMap};
use super::settings::Settings;
use super::store::{self, Header, Key};
use super::sweep::Sweep;
use super::sweep::grid::Major;
use crate::geometry::Body;
use crate::terrain::Face;

/// How much work a kill may cost.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(20);
/// Pixels on which a tile measures its own error.
pub const MEASURED_PIXELS: usize = 64;

/// Told how many of how many azimuths are done.
pub type Progress<'a> = dyn Fn(usize, usize) + Sync + 'a;

/// The horizon map of a level from its tile in `directory`, made first where there is no such tile, or a damaged one.
pub fn open_or_build(
    body: &Body,
    face: &Face,
    level: usize,
    settings: &Settings,
    encoding: Encoding,
    directory: &Path,
    progress: &Progress,
) -> Result<HorizonMap, Error> {
    check(face, level, settings, encoding)?;
    match store::read_of(directory, &Key::of(body, face, level, settings, encoding)) {
        Ok(map) => Ok(map),
        Err(_) => build(body, face, level, settings, encoding, directory, progress),
    }
}

/// Makes the horizon map of a level and stores its tile in `directory`.
pub fn build(
    body: &Body,
    face: &Face,
    level: usize,
    settings: &Settings,
    encoding: Encoding,
    directory: &Path,
    progress: &Progress,
) -> Result<HorizonMap, Error> {
    let mut builder = Builder::new(body, face, level, settings, encoding, directory)?;
    let mut saved = Instant::now();
    while builder.done() < settings.azimuths {
        builder.step();
        progress(builder.done(), settings.azimuths);
        if saved.elapsed() > CHECKPOINT_EVERY {
            builder.save()?;
            saved = Instant::now();
        }
    }
    builder.finish(body)
}

fn check(face: &Face, level: usize, settings: &Settings, encoding: Encoding) -> Result<(), Error> {
    let nodes = face.levels.get(level).ok_or(Error::NoLevel { got: level, levels: face.levels.len() })?;
    let seen = |nodes: usize, margin: usize| nodes.saturating_sub(2 * margin);
    let (columns, rows) = (seen(nodes.columns, nodes.margin), seen(nodes.rows, nodes.margin));
    if columns < 2 || rows < 2 {
        return Err(Error::TooSmall { level, columns, rows });
    }
    let least = encoding.least_azimuths();
    if settings.azimuths < least {
        return Err(Error::TooFewAzimuths { got: settings.azimuths, encoding, least });
    }
    if !(0.0..=1e6).contains(&settings.observer_height_m) {
        return Err(Error::ObserverHeight { got: settings.observer_height_m });
    }
    match settings.search_m {
        Some(got) if got.is_nan() || got <= 0.0 => Err(Error::SearchDistance { got }),
        _ => Ok(()),
    }
}

/// What a build has reached.
#[derive(Debug)]
pub struct State {
    /// Azimuths added, in the builder's order.
    pub done: usize,
    /// `[row][column]` until the first azimuth along the columns is added, `[column][row]` from then on.
    pub sums: Accumulator,
    pub sample: Sample,
}

/// A build under way.
#[derive(Debug)]
pub struct Builder<'a> {
    face: &'a Face,
    level: usize,
    settings: Settings,
    encoding: Encoding,
    path: PathBuf,
    checkpoint: Checkpoint,
    /// Azimuths along the rows' axis, then along the columns'.
    order: Vec<usize>,
    along_rows: usize,
    state: State,
    sweep: Option<(Major, Sweep<'a>, Option<Ends>)>,
}

impl<'a> Builder<'a> {
    /// A build of a level's tile, where a checkpoint of it left off if there is one.
    pub fn new(
        body: &Body,
        face: &'a Face,
        level: usize,
        settings: &Settings,
        encoding: Encoding,
        directory: &Path,
    ) -> Result<Self, Error> {
        check(face, level, settings, encoding)?;
        fs::create_dir_all(directory).map_err(|source| Error::write(directory, source))?;
        let key = Key::of(body, face, level, settings, encoding);
        let path = store::path_for(directory, &key);
        let checkpoint = Checkpoint::new(path.with_extension("partial"), key);

        let along = |major: Major| (0..settings.azimuths).filter(move |i| Major::of(settings.direction(*i)) == major);
        let along_rows = along(Major::Row).count();
        let order = along(Major::Row).chain(along(Major::Column)).collect();

        let nodes = &face.levels[level];
        let (columns, rows) = (nodes.columns - 2 * nodes.margin, nodes.rows - 2 * nodes.margin);
        let sums = Accumulator::new(encoding, columns, rows, settings.azimuths);
        let mut state = State { done: 0, sums, sample: Sample::of(nodes, MEASURED_PIXELS, settings.azimuths) };
        checkpoint.resume(&mut state, along_rows);
        Ok(Self { face, level, settings: *settings, encoding, path, checkpoint, order, along_rows, state, sweep: None })
    }

    /// Azimuths done.
    pub fn done(&self) -> usize {
        self.state.done
    }

    /// Sweeps the next azimuths, one a thread.
    pub fn step(&mut self) {
        let done = self.state.done;
        let major = if done < self.along_rows { Major::Row } else { Major::Column };
        let end = if done < self.along_rows { self.along_rows } else { self.order.len() };
        let block = &self.order[done..end.min(done + rayon::current_num_threads())];
        if done == self.along_rows {
            // One orientation of the heights at a time, and none beside a second copy of the sums.
            self.sweep = None;
            self.state.sums.transpose();
        }
        let (face, level, settings) = (self.face, self.level, &self.settings);
        if self.sweep.as_ref().is_none_or(|(prepared, ..)| *prepared != major) {
            let ends = settings.band.map(|band| Ends::of(&band, &face.map, &face.levels[level], major));
            self.sweep = Some((major, Sweep::new(face, level, major, settings), ends));
        }
        let Some((_, sweep, ends)) = &self.sweep else { return };
        let plane = |&azimuth: &usize| {
            let elevations_rad = sweep.elevations_rad(settings.direction(azimuth));
            let mut plane = Plane { azimuth, stride: sweep.receivers.stride, elevations_rad };
            ends.iter().for_each(|ends| ends.clamp(&mut plane));
            plane
        };
        let planes: Vec<_> = block.par_iter().map(plane).collect();
        self.state.sums.add(&planes);
        planes.iter().for_each(|plane| self.state.sample.keep(plane, major));
        self.state.done += block.len();
    }

    /// Saves what is done for a later build of the same tile.
    pub fn save(&self) -> Result<(), Error> {
        self.checkpoint.save(&self.state)
    }

    /// Stores the finished tile.
    fn finish(mut self, body: &Body) -> Result<HorizonMap, Error> {
        self.sweep = None;
        let sums = &mut self.state.sums;
        sums.transpose();
        let mut map = sums.map();
        map.errors = measure(self.face, self.level, &self.settings, &self.state.sample, &map);
        let header = Header::new(body, self.face, self.level, &self.settings, &map);
        store::write(&self.path, &header, &map)?;
        self.checkpoint.remove();
        Ok(map)
    }
}
