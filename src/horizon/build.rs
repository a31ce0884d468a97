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
use super::error::{Error, TileErrors};
use super::fit::{Accumulator, Plane};
use super::measure::{Sample, measure};
use super::pack::HorizonMap;
use super::request::Request;
use super::store::{self, Header};
use super::sweep::Sweep;
use super::sweep::grid::Major;

/// How much work a kill may cost.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(20);
/// Pixels on which a tile measures its own error.
pub const MEASURED_PIXELS: usize = 64;

/// Told how many of how many azimuths are done.
pub type Progress<'a> = dyn Fn(usize, usize) + Sync + 'a;

/// The horizon map asked for from its tile in `directory`, made first where there is no such tile, or a damaged one.
pub fn open_or_build(request: &Request, directory: &Path, progress: &Progress) -> Result<HorizonMap, Error> {
    request.check()?;
    match store::read_of(directory, &request.key()) {
        Ok(map) => Ok(map),
        Err(_) => build(request, directory, progress),
    }
}

/// Makes the horizon map asked for and stores its tile in `directory`.
pub fn build(request: &Request, directory: &Path, progress: &Progress) -> Result<HorizonMap, Error> {
    let mut builder = Builder::new(request, directory)?;
    let mut saved = Instant::now();
    while builder.done() < request.settings.azimuths {
        builder.step();
        progress(builder.done(), request.settings.azimuths);
        if saved.elapsed() > CHECKPOINT_EVERY {
            builder.save()?;
            saved = Instant::now();
        }
    }
    builder.finish()
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
    request: Request<'a>,
    path: PathBuf,
    checkpoint: Checkpoint,
    /// Azimuths along the rows' axis, then along the columns'.
    order: Vec<usize>,
    along_rows: usize,
    state: State,
    sweep: Option<(Major, Sweep<'a>, Option<Ends>)>,
}

impl<'a> Builder<'a> {
    /// A build of a tile, where a checkpoint of it left off if there is one.
    pub fn new(request: &Request<'a>, directory: &Path) -> Result<Self, Error> {
        request.check()?;
        fs::create_dir_all(directory).map_err(|source| Error::write(directory, source))?;
        let key = request.key();
        let path = store::path_for(directory, &key);
        let checkpoint = Checkpoint::new(path.with_extension("partial"), key);

        let settings = &request.settings;
        let along = |major: Major| (0..settings.azimuths).filter(move |i| Major::of(settings.direction(*i)) == major);
        let along_rows = along(Major::Row).count();
        let order = along(Major::Row).chain(along(Major::Column)).collect();

        let nodes = request.nodes();
        let (columns, rows) = (nodes.columns - 2 * nodes.margin, nodes.rows - 2 * nodes.margin);
        let sums = Accumulator::new(request.encoding, columns, rows, settings.azimuths);
        let mut state = State { done: 0, sums, sample: Sample::of(nodes, MEASURED_PIXELS, settings.azimuths) };
        checkpoint.resume(&mut state, along_rows);
        Ok(Self { request: *request, path, checkpoint, order, along_rows, state, sweep: None })
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
        let Request { face, level, settings, .. } = &self.request;
        if self.sweep.as_ref().is_none_or(|(prepared, ..)| *prepared != major) {
            let ends = settings.band.map(|band| Ends::of(&band, &face.map, &face.levels[*level], major));
            self.sweep = Some((major, Sweep::new(face, *level, major, settings), ends));
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
    fn finish(mut self) -> Result<HorizonMap, Error> {
        self.sweep = None;
        let sums = &mut self.state.sums;
        sums.transpose();
        let (columns, rows) = (sums.columns(), sums.rows());
        let errors = TileErrors::default();
        let levels = sums.texels();
        let Request { face, level, settings, encoding, .. } = &self.request;
        let mut map = HorizonMap { encoding: *encoding, columns, rows, levels, errors };
        map.errors = measure(face, *level, settings, &self.state.sample, &map);
        let header = Header::new(&self.request, &map);
        store::write(&self.path, &header, &map)?;
        self.checkpoint.remove();
        Ok(map)
    }
}
