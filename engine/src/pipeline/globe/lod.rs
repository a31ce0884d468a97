//! A globe as a scenario shows it: its tiles at the levels of detail that the cameras see, and their horizons.
//!
//! ```text
//! global DEM -> coarsest tiles -> poses -> tiles by screen size -> drawn tiles       horizon tiles: given, kept or made
//! ```
//!
//! Each tile stands alone on its face's map; what lies around it is in its horizons only. In memory are the drawn tiles,
//! and the levels around one of them while its horizons are made.

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde_json::json;

use super::view_cone::{self, Choice};
use super::{Globe, Index, Plan, index};
use crate::camera::{Camera, Pose};
use crate::geometry::Body;
use crate::horizon::{Encoding, HorizonMap, Memory, Settings};
use crate::pipeline::tiles::Tile;
use crate::pipeline::{Error, Progress};
use crate::raster::{self, Values};
use crate::scenario;
use crate::terrain::quadtree::QuadTree;
use crate::terrain::{Cut, GlobalDem, Surface, Terrain, drawn_tile};

/// Cells along a tile's side, and nodes around it for its horizons, where no folder of tiles says otherwise.
const CELLS: usize = 256;
const MARGIN: usize = 128;

/// A globe and which of its tiles are drawn.
#[derive(Debug, Clone)]
pub struct DrawnTiles {
    pub tree: QuadTree,
    pub dem: GlobalDem,
    pub dem_sha256: String,
    pub cut: Cut,
    /// What postings are seen as, in pixels, unless the model ends before.
    pub posting_px: f64,
    /// Tiles at most.
    most: usize,
    margin: usize,
    /// The index of tiles that are there, and its folder.
    given: Option<(PathBuf, Index)>,
}

impl DrawnTiles {
    /// The globe at its coarsest, before a camera looks at it.
    pub fn open(body: &Body, written: &scenario::Globe, values: Values) -> Result<Self, Error> {
        let dem = GlobalDem::open(&written.path, body, &written.reading, values)?;
        let given = written.tiles.as_deref().map(index_in).transpose()?;
        let (cells, margin) =
            given.as_ref().map_or((CELLS, MARGIN), |(_, index)| (index.plan.cells, index.plan.margin));
        let given_m = given.as_ref().map(|(_, index)| index.plan.posting_m);
        let tree = QuadTree::new(body, cells, given_m.or(written.posting_m).unwrap_or(dem.posting_m));
        let dem_sha256 = raster::digest(&written.path)?;
        let cut = Cut::coarsest(&tree);
        let (posting_px, most) = (written.posting_px, written.most_tiles as usize);
        Ok(Self { tree, dem, dem_sha256, cut, posting_px, most, margin, given })
    }

    /// The same with the tiles that cameras see from all poses; `ground` is its own, at its coarsest.
    pub fn seen(self, ground: &Surface, camera: &Camera, poses: &[Pose]) -> Self {
        let Choice { cut, posting_px } =
            view_cone::choose(&self.tree, &self.dem, ground, camera, poses, self.posting_px, self.most);
        Self { cut, posting_px, ..self }
    }

    /// The ground of its tiles.
    pub fn surface(&self) -> Result<Surface, Error> {
        let tiles: Vec<_> = self.cut.tiles().collect();
        let drawn = tiles.par_iter().map(|tile| drawn_tile(&self.tree, &self.cut, *tile, &self.dem));
        let faces = drawn.collect::<Result<Vec<_>, _>>()?;
        Ok(Surface::new(Terrain { body: self.tree.body.clone(), faces }))
    }

    /// What is shown, on one line.
    pub fn summary(&self) -> String {
        let levels = || self.cut.tiles().map(|tile| tile.level);
        let posting_m = |level: Option<usize>| self.tree.posting_m(level.unwrap_or(0));
        let nodes = self.cut.tiles().len() * (self.tree.cells + 1).pow(2);
        format!(
            "{} tiles, {:.2} million nodes {:.0} m to {:.0} m apart, at most {:.2} pixels where the model is not coarser",
            self.cut.tiles().len(),
            nodes as f64 / 1e6,
            posting_m(levels().max()),
            posting_m(levels().min()),
            self.posting_px,
        )
    }

    /// The same for a manifest, with the number of tiles of each posting.
    pub fn record(&self) -> serde_json::Value {
        let of_level = |level: usize| self.cut.tiles().filter(|tile| tile.level == level).count();
        let levels = (0..self.tree.levels).filter(|level| of_level(*level) > 0);
        let levels = levels.map(|level| json!({ "posting_m": self.tree.posting_m(level), "tiles": of_level(level) }));
        json!({ "levels": levels.collect::<Vec<_>>(), "cells": self.tree.cells, "posting_px": self.posting_px })
    }

    /// Horizon maps of its tiles: from the folder that was given, else from the cache, else made.
    pub fn horizons<E: From<Error>>(
        &self,
        settings: Settings,
        encoding: Encoding,
        cache: &Path,
        progress: &dyn Progress,
        mut finished: impl FnMut(&Tile) -> Result<(), E>,
    ) -> Result<Vec<Vec<HorizonMap>>, E> {
        let plan = Plan::new(&self.tree, &self.dem, self.dem_sha256.clone(), self.margin, settings, encoding);
        let given = self.given_globe(&plan)?;
        let directory = cache.join("globe").join(key(&plan));
        let made = self.globe(plan, directory).claimed()?;
        let there = |tile| given.iter().chain([&made]).find_map(|globe| Some((globe.path(tile), globe.read(tile)?)));
        let found: Vec<_> = self.cut.tiles().map(|tile| (tile, there(tile))).collect();
        let missing: Vec<_> = found.iter().filter(|(_, there)| there.is_none()).map(|(tile, _)| *tile).collect();
        let mut seconds = made.make_all(&missing, progress)?.into_iter();
        let mut maps = Vec::new();
        for (face, (tile, there)) in found.into_iter().enumerate() {
            let built_s = if there.is_none() { seconds.next() } else { None };
            let (path, (header, map)) = match there {
                Some(there) => there,
                None => (made.path(tile), crate::horizon::store::read(&made.path(tile)).map_err(Error::from)?),
            };
            finished(&Tile { face, level: 0, path, key: header.key, map: &map, built_s })?;
            maps.push(vec![map]);
        }
        if maps.is_empty() {
            return Ok(maps);
        }
        Index::of(&made)?.write(&made.index_path())?;
        Ok(maps)
    }

    /// The globe in the given folder, which must be of the same plan.
    fn given_globe(&self, plan: &Plan) -> Result<Option<Globe>, Error> {
        let Some((directory, index)) = &self.given else { return Ok(None) };
        if index.plan != *plan {
            let (path, difference) = (directory.join(index::FILE), index.plan.difference(plan));
            return Err(Error::TilesOfAnother { path, difference });
        }
        Ok(Some(self.globe(plan.clone(), directory.clone())))
    }

    /// Whether the given tiles are those of a plan with these settings.
    pub fn check_given(&self, settings: Settings, encoding: Encoding) -> Result<(), Error> {
        let plan = Plan::new(&self.tree, &self.dem, self.dem_sha256.clone(), self.margin, settings, encoding);
        self.given_globe(&plan).map(|_| ())
    }

    fn globe(&self, plan: Plan, directory: PathBuf) -> Globe {
        Globe { tree: self.tree.clone(), dem: self.dem.clone(), plan, directory, memory: Memory::default() }
    }
}

/// The index in a folder of `sim horizon globe`.
fn index_in(folder: &Path) -> Result<(PathBuf, Index), Error> {
    let path = folder.join(index::FILE);
    let index = Index::read(&path)?.ok_or(Error::NoIndex { path })?;
    Ok((folder.into(), index))
}

/// The name of a plan's folder in the cache.
fn key(plan: &Plan) -> String {
    let text = serde_json::to_string(plan).expect("plain data");
    crate::digest::sha256_hex(text.as_bytes())[..16].into()
}
