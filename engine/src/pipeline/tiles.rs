//! Horizon tiles of a surface's levels: opened where they are there, built where not.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::names::file_name;
use super::{Error, Progress};
use crate::dataset::Input;
use crate::horizon::store;
use crate::horizon::{self, Encoding, HorizonMap, Key, Resources};
use crate::terrain::Surface;

/// A horizon tile that is ready.
#[derive(Debug)]
pub struct Tile<'a> {
    pub face: usize,
    pub level: usize,
    pub path: PathBuf,
    pub key: Key,
    pub map: &'a HorizonMap,
    /// What building took; `None` where the tile was there.
    pub built_s: Option<f64>,
}

impl Tile<'_> {
    /// The tile as a manifest lists it.
    pub fn input(&self) -> Input {
        Input { role: "horizon".into(), name: file_name(&self.path), sha256: self.key.as_str().into() }
    }
}

/// Horizon maps of all levels, by face, from tiles in `folder` that are built where they are not there yet. Each tile
/// is told to `finished`.
pub fn horizons<'a, E: From<Error>>(
    surface: &'a Surface,
    settings: &horizon::Settings,
    encoding: Encoding,
    folder: &Path,
    resources: impl Into<Resources<'a>>,
    progress: &dyn Progress,
    mut finished: impl FnMut(&Tile) -> Result<(), E>,
) -> Result<Vec<Vec<HorizonMap>>, E> {
    let faces = &surface.terrain.faces;
    let resources = resources.into();
    let tiles: usize = faces.iter().map(|face| face.levels.len()).sum();
    let mut tile = 0;
    let mut maps = Vec::new();
    for (index, face) in faces.iter().enumerate() {
        let mut levels = Vec::new();
        for level in 0..face.levels.len() {
            tile += 1;
            progress.begin(&format!("horizons, tile {tile} of {tiles}"), settings.azimuths, "azimuths");
            let (start, built) = (Instant::now(), AtomicBool::new(false));
            let on_progress = |done: usize, total: usize| {
                built.store(true, Ordering::Relaxed);
                progress.at(done, total);
            };
            let body = &surface.terrain.body;
            let request = horizon::Request { body, face, level, settings: *settings, encoding };
            let map = horizon::open_or_build(&request, folder, resources, &on_progress).map_err(Error::from)?;
            let key = request.key();
            let path = store::path_for(folder, &key);
            let built_s = built.into_inner().then(|| start.elapsed().as_secs_f64());
            finished(&Tile { face: index, level, path, key, map: &map, built_s })?;
            levels.push(map);
        }
        maps.push(levels);
    }
    Ok(maps)
}
