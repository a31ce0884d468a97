//! From heights to a horizon map: sweep, project, measure, store.
//!
//! Azimuths are swept in blocks, first those along the rows' axis, then those along the columns', so that one
//! orientation of the heights is in memory at a time. Each plane is added to the coefficients and dropped.
//!
//! Where the [`Memory`] that a build may take holds the sums, a block is an azimuth a thread or a few, and every
//! `CHECKPOINT_EVERY` the sums are saved beside the tile. Where it does not, the checkpoint *is* the sums: a block has as
//! many azimuths as there is memory for their planes, and adding it writes the file anew; the finished texels wait in a
//! file while the bounds are found. Either way an interrupted build goes on, to the same bytes.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::axis::Major;
use super::band_limits::BandLimits;
use super::calibration;
use super::checkpoint::{Checkpoint, State};
use super::elevation_plane::ElevationPlane;
use super::error::Error;
use super::fit::Accumulator;
use super::header::Header;
use super::measure::{Sample, measure};
use super::memory::{self, Memory};
use super::pack::HorizonMap;
use super::request::Request;
use super::resources::Resources;
use super::search::Search;
use super::store;
use super::texel_store::TexelStore;
use crate::files;
use crate::gpu::Gpu;

/// How much work a kill may cost.
const CHECKPOINT_EVERY: Duration = Duration::from_secs(20);
/// Pixels on which a tile measures its own error.
pub const MEASURED_PIXELS: usize = 64;

/// Reports progress: azimuths done, and all.
pub type Progress<'a> = dyn Fn(usize, usize) + Sync + 'a;

/// The horizon map asked for from its tile in `directory`, made first where there is no such tile, or a damaged one.
pub fn open_or_build<'a>(
    request: &Request<'a>,
    directory: &Path,
    resources: impl Into<Resources<'a>>,
    progress: &Progress,
) -> Result<HorizonMap, Error> {
    request.check()?;
    match store::read_of(directory, &request.key()) {
        Ok(map) => Ok(map),
        Err(_) => build_at(request, &store::path_for(directory, &request.key()), resources, progress),
    }
}

/// Makes the horizon map asked for and stores its tile in `directory`, under the name of its key.
pub fn build(request: &Request, directory: &Path, progress: &Progress) -> Result<HorizonMap, Error> {
    request.check()?;
    build_at(request, &store::path_for(directory, &request.key()), Memory::default(), progress)
}

/// Makes the horizon map asked for with what it may use of the machine, and stores its tile under a name.
pub fn build_at<'a>(
    request: &Request<'a>,
    path: &Path,
    resources: impl Into<Resources<'a>>,
    progress: &Progress,
) -> Result<HorizonMap, Error> {
    let mut builder = Builder::new(request, path, resources)?;
    let mut saved = Instant::now();
    while builder.done() < request.settings.azimuths {
        builder.step()?;
        progress(builder.done(), request.settings.azimuths);
        if builder.state.sums.in_memory() && saved.elapsed() > CHECKPOINT_EVERY {
            builder.save()?;
            saved = Instant::now();
        }
    }
    builder.finish()
}

/// A build under way.
#[derive(Debug)]
pub struct Builder<'a> {
    request: Request<'a>,
    device: Option<&'a Gpu>,
    path: PathBuf,
    checkpoint: Checkpoint,
    /// Azimuths along the rows' axis, then along the columns'.
    order: Vec<usize>,
    along_rows: usize,
    /// Azimuths of a block.
    block: usize,
    state: State,
    /// Planes that the bounds are found from, where there is memory for them.
    probes: Option<Vec<ElevationPlane>>,
    search: Option<(Major, Search<'a>, Option<BandLimits>)>,
}

impl<'a> Builder<'a> {
    /// A build of a tile, where a checkpoint of it left off if there is one.
    pub fn new(request: &Request<'a>, path: &Path, resources: impl Into<Resources<'a>>) -> Result<Self, Error> {
        request.check()?;
        let Resources { memory, device } = resources.into();
        if let Some(directory) = path.parent() {
            fs::create_dir_all(directory).map_err(|source| Error::write(directory, source))?;
            files::remove_stale(directory).map_err(|source| Error::read(directory, source))?;
        }
        let checkpoint = Checkpoint::new(path.with_extension("checkpoint"), request.key());

        let settings = &request.settings;
        let along = |major: Major| (0..settings.azimuths).filter(move |i| Major::of(settings.direction(*i)) == major);
        let along_rows = along(Major::Row).count();
        let order = along(Major::Row).chain(along(Major::Column)).collect();

        let nodes = request.nodes();
        let [columns, rows] = nodes.seen_size();
        let allowance = memory.allowance(request);
        let accumulator = if allowance.sums_fit { Accumulator::new } else { Accumulator::on_disk };
        let sums = accumulator(request.encoding, columns, rows, settings.azimuths);
        let mut state = State { done: 0, sums, sample: Sample::of(nodes, MEASURED_PIXELS, settings.azimuths) };
        checkpoint.resume(&mut state);
        if !allowance.sums_fit {
            memory::give_back();
        }
        let (block, probes) = (allowance.planes, allowance.probes_fit.then(Vec::new));
        Ok(Self {
            request: *request,
            device,
            path: path.into(),
            checkpoint,
            order,
            along_rows,
            block,
            state,
            probes,
            search: None,
        })
    }

    /// Azimuths done.
    pub fn done(&self) -> usize {
        self.state.done
    }

    /// Sweeps the next azimuths and adds them.
    pub fn step(&mut self) -> Result<(), Error> {
        let done = self.state.done;
        let major = if done < self.along_rows { Major::Row } else { Major::Column };
        let end = if done < self.along_rows { self.along_rows } else { self.order.len() };
        let block = &self.order[done..end.min(done + self.block)];
        let Request { face, level, settings, .. } = &self.request;
        if self.search.as_ref().is_none_or(|(prepared, ..)| *prepared != major) {
            // One orientation of the heights at a time.
            self.search = None;
            let limits = settings.band.map(|band| BandLimits::of(&band, &face.map, &face.levels[*level], major));
            self.search = Some((major, Search::new(face, *level, major, settings, self.device)?, limits));
        }
        let Some((_, search, limits)) = &self.search else { return Ok(()) };
        let plane = |&azimuth: &usize| search.plane(limits.as_ref(), settings, azimuth);
        let planes = block.par_iter().map(plane).collect::<Result<Vec<_>, Error>>()?;
        planes.iter().for_each(|plane| self.state.sample.keep(plane, major));
        self.state.done += block.len();
        if self.state.sums.in_memory() {
            self.state.sums.add(&planes, major);
            if let Some(probes) = &mut self.probes {
                let azimuths = settings.azimuths;
                probes.extend(planes.into_iter().filter(|plane| calibration::is_probed(plane.azimuth, azimuths)));
            }
            return Ok(());
        }
        self.checkpoint.save(&mut self.state, &planes, major)
    }

    /// Saves what is done for a later build of the same tile.
    pub fn save(&mut self) -> Result<(), Error> {
        self.checkpoint.save(&mut self.state, &[], Major::Row)
    }

    /// Stores the finished tile.
    fn finish(mut self) -> Result<HorizonMap, Error> {
        self.search = None;
        let Request { face, level, settings, .. } = &self.request;
        let map = self.state.sums.map();
        let errors = measure(face, *level, settings, &self.state.sample, &map);
        let (texels, block) = match self.state.sums.in_memory() {
            true => (TexelStore::Memory(map), calibration::BLOCK),
            false => (TexelStore::on_disk(map, &self.path.with_extension("texels"))?, self.block),
        };
        let swept = calibration::Swept {
            request: &self.request,
            device: self.device,
            planes: &self.probes.unwrap_or_default(),
            block,
        };
        let (bounds, statistics) =
            calibration::bounds(&swept, &texels, &self.state.sample.pixels, &errors.decoded_rad)?;
        let mut map = texels.take()?;
        map.errors = errors.statistics(statistics);
        map.bounds = bounds;
        let header = Header::new(&self.request, &map);
        store::write(&self.path, &header, &map)?;
        self.checkpoint.remove();
        Ok(map)
    }
}
