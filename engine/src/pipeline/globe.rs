//! Horizons of a whole body, tile by tile, from a model of any size.
//!
//! ```text
//! global DEM --windows--> levels around a tile --sweep, fit--> tile      for all tiles of the quad-tree -> index
//! ```
//!
//! Each tile is made on its own, from windows of the model: what it holds depends neither on the other tiles nor on which
//! of them are asked for, and no more is in memory than its own levels. Tiles that are there are kept, so that a run which
//! was stopped goes on where it was; a folder holds the tiles of one plan only.
//!
//! Parents are swept over their own ground, means at twice the posting of their children's: they are the horizons of the surface
//! that a renderer shows at that level of detail.
//!
//! # Assumptions
//! What coarse levels beyond a tile's margin do to its horizons is measured against traces over the full resolution, at
//! the poles, on the cube's edges and corners, on the antimeridian and at random places ([`check`]).

pub mod check;
pub mod exposures;
pub mod index;
pub mod lod;
pub mod selection;
pub mod view_cone;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use rayon::prelude::*;

pub use check::Checks;
pub use index::{Index, Plan};
pub use lod::DrawnTiles;
pub use selection::Selection;

use super::{Error, Progress};
use crate::geometry::Body;
use crate::horizon::{self, Encoding, HorizonMap, Memory, Request, Settings, header, store};
use crate::raster::{self, Reading, Values};
use crate::terrain::quadtree::{QuadTree, TileId};
use crate::terrain::{GlobalDem, build_tile};

/// What a globe's tiles are made from, and how.
#[derive(Debug, Clone)]
pub struct Options {
    pub dem: PathBuf,
    pub values: Values,
    /// Finest posting, by default the model's.
    pub posting_m: Option<f64>,
    /// Cells along a tile's side.
    pub cells: usize,
    /// Nodes beyond a tile at its own posting, and again at each coarser one.
    pub margin: usize,
    pub settings: Settings,
    pub encoding: Encoding,
    pub directory: PathBuf,
    pub memory: Memory,
    /// Which tiles; none: all.
    pub tiles: Vec<Selection>,
    /// Random places at which finished tiles are compared with the full resolution; poles, edges, corners and antimeridian
    /// come on top. 0: none at all.
    pub checks: usize,
}

/// A body with its model and its tiles.
#[derive(Debug)]
pub struct Globe {
    pub tree: QuadTree,
    pub dem: GlobalDem,
    pub plan: Plan,
    pub directory: PathBuf,
    pub memory: Memory,
}

/// What a run did.
#[derive(Debug)]
pub struct Report {
    pub built: usize,
    pub kept: usize,
    pub index: Index,
}

impl Globe {
    /// Looks through the model, and at what the folder holds.
    pub fn open(body: &Body, options: &Options, progress: &dyn Progress) -> Result<Self, Error> {
        progress.begin("reading the model", 1, "file");
        let dem = GlobalDem::open(&options.dem, body, &Reading::default(), options.values)?;
        dem.findings.iter().for_each(|finding| progress.say(finding));
        let tree = QuadTree::new(body, options.cells, options.posting_m.unwrap_or(dem.posting_m));
        let digest = raster::digest(&options.dem)?;
        let plan = Plan::new(&tree, &dem, digest, options.margin, options.settings, options.encoding);
        Self { tree, dem, plan, directory: options.directory.clone(), memory: options.memory }.claimed()
    }

    /// Itself, once it has its folder.
    fn claimed(self) -> Result<Self, Error> {
        self.claim()?;
        Ok(self)
    }

    /// Refuses a folder that holds the tiles of another plan.
    fn claim(&self) -> Result<(), Error> {
        let path = self.index_path();
        match Index::read(&path)? {
            Some(index) if index.plan != self.plan => {
                let difference = index.plan.difference(&self.plan);
                Err(Error::OtherGlobe { path, difference })
            }
            Some(_) => Ok(()),
            None => {
                crate::dataset::check_writable(&self.directory)?;
                Index { plan: self.plan.clone(), tiles: Vec::new(), checks: None }.write(&path)
            }
        }
    }

    pub fn index_path(&self) -> PathBuf {
        self.directory.join(index::FILE)
    }

    pub fn path(&self, tile: TileId) -> PathBuf {
        self.directory.join(index::file_of(tile))
    }

    /// The tile from its file; `None` where there is none, or a damaged one.
    pub fn read(&self, tile: TileId) -> Option<(header::Header, HorizonMap)> {
        store::read(&self.path(tile)).ok()
    }

    /// Makes tiles side by side, one a thread as far as memory reaches. Returns the seconds that each took.
    fn make_all(&self, tiles: &[TileId], progress: &dyn Progress) -> Result<Vec<f64>, Error> {
        if tiles.is_empty() {
            return Ok(Vec::new());
        }
        let Plan { encoding, cells, margin, settings, .. } = &self.plan;
        let fitting = self.memory.tiles(*encoding, cells + 1, *margin, settings.azimuths);
        let at_once = fitting.min(rayon::current_num_threads());
        let memory = self.memory.shared_by(at_once);
        let all = tiles.len() * settings.azimuths;
        progress.begin(&format!("horizons of {} tiles", tiles.len()), all, "azimuths");
        let swept = AtomicUsize::new(0);
        let make = |tile: &TileId| {
            let (start, of_this) = (Instant::now(), AtomicUsize::new(0));
            self.make(*tile, memory, &|done, _| {
                let step = done - of_this.swap(done, Ordering::Relaxed);
                progress.at(swept.fetch_add(step, Ordering::Relaxed) + step, all);
            })?;
            Ok(start.elapsed().as_secs_f64())
        };
        let mut seconds = Vec::new();
        for some in tiles.chunks(at_once) {
            seconds.extend(some.par_iter().map(make).collect::<Result<Vec<_>, Error>>()?);
        }
        Ok(seconds)
    }

    /// Makes one tile within some memory.
    fn make(&self, tile: TileId, memory: Memory, progress: &horizon::build::Progress) -> Result<(), Error> {
        let face = build_tile(&self.tree, tile, &self.dem, self.plan.margin)?;
        let Plan { settings, encoding, .. } = self.plan;
        let request = Request { body: &self.tree.body, face: &face, level: 0, settings, encoding };
        horizon::build_at(&request, &self.path(tile), memory, progress)?;
        Ok(())
    }
}

/// Makes the tiles asked for that are not there, then the index of all that are.
pub fn build(body: &Body, options: &Options, progress: &dyn Progress) -> Result<Report, Error> {
    let globe = Globe::open(body, options, progress)?;
    let wanted: Vec<TileId> = globe.tree.tiles().filter(|tile| asked_for(&globe.tree, *tile, &options.tiles)).collect();
    if wanted.is_empty() {
        return Err(Error::NoTiles { levels: globe.tree.levels });
    }
    let missing: Vec<TileId> = wanted.iter().copied().filter(|tile| globe.read(*tile).is_none()).collect();
    globe.make_all(&missing, progress)?;
    let mut index = Index::of(&globe)?;
    if options.checks > 0 {
        index.checks = Some(check::check(&globe, options.checks, progress)?);
    }
    index.write(&globe.index_path())?;
    Ok(Report { built: missing.len(), kept: wanted.len() - missing.len(), index })
}

fn asked_for(tree: &QuadTree, tile: TileId, selections: &[Selection]) -> bool {
    selections.is_empty() || selections.iter().any(|selection| selection.holds(tree, tile))
}

/// Makes the folder of a file.
fn make_room(path: &Path) -> Result<(), Error> {
    let folder = path.parent().unwrap_or(path);
    fs::create_dir_all(folder).map_err(|source| Error::Unwritable { path: folder.into(), source })
}
