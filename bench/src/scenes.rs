//! Terrains that horizons are measured on.

use std::path::PathBuf;

use glam::DVec2;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::Error;
use perilune_engine::geometry::{Body, Geodetic};
use perilune_engine::raster::{self, Dem};
use perilune_engine::terrain::build::MAX_NODES_PER_SIDE;
use perilune_engine::terrain::synthetic::{self, Parameters};
use perilune_engine::terrain::{Face, Gnomonic, Level, NestedDem, build_face};

/// Posting of synthetic scenes.
const POSTING_M: f64 = 20.0;
/// NASA's 10 m model of the connecting ridge.
pub const RIDGE: &str = "site01_connecting_ridge_10m_1600.tif";
/// The 240 m model of the south polar cap.
pub const CAP: &str = "southcap_240m_1536.tif";

/// A terrain by name; its finest level is measured.
#[derive(Debug)]
pub struct Scene {
    pub name: String,
    pub body: Body,
    pub face: Face,
}

impl Scene {
    /// A cratered highland of `nodes²` at 20 m, the same for the same seed.
    pub fn synthetic(nodes: usize, seed: u64) -> Result<Self, Error> {
        Self::generated(format!("cratered {nodes}²"), Parameters::highland(nodes, nodes, POSTING_M, seed))
    }

    /// The same without craters and massif: self-affine ground, six times as rough.
    pub fn fractal(nodes: usize, seed: u64) -> Result<Self, Error> {
        let rough = Parameters::highland(nodes, nodes, POSTING_M, seed);
        let parameters = Parameters { density: 0.0, relief_m: 0.0, roughness: 6.0 * rough.roughness, ..rough };
        Self::generated("fractal".into(), parameters)
    }

    fn generated(name: String, parameters: Parameters) -> Result<Self, Error> {
        let heights_m = synthetic::generate(&Body::moon(), &parameters, &|_, _| ())?.heights_m;
        Ok(Self::of(name, parameters.columns, heights_m))
    }

    /// Hills of 400 m to 2 km width without an edge: sums of Gaussians.
    pub fn smooth(nodes: usize, seed: u64) -> Self {
        let hill = |at: DVec2, width: f64| (-2.0 * at.length_squared() / (width * width)).exp();
        Self::scattered("smooth", nodes, seed, [20.0, 100.0], &|at, width, height| height * 4.0 * hill(at, width))
    }

    /// Boxes with vertical sides, as far as a grid has them.
    pub fn blocks(nodes: usize, seed: u64) -> Self {
        let inside = |at: DVec2, width: f64| f64::from(at.abs().max_element() < 0.5 * width);
        Self::scattered("blocks", nodes, seed, [4.0, 40.0], &|at, width, height| 2.0 * height * inside(at, width))
    }

    /// Needles of one node: the worst that a horizon can meet.
    pub fn peaks(nodes: usize, seed: u64) -> Self {
        let needle = |at: DVec2| f64::from(at.abs().max_element() < 0.5);
        Self::scattered("peaks", nodes, seed, [2.0, 40.0], &|at, _, height| 4.0 * height * needle(at))
    }

    /// The highest of many shapes on a plain, their places and widths in nodes drawn evenly, their heights up to a fifth of
    /// their widths.
    fn scattered(
        name: &str,
        nodes: usize,
        seed: u64,
        [least, most]: [f64; 2],
        shape: &dyn Fn(DVec2, f64, f64) -> f64,
    ) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut heights_m = vec![0.0_f32; nodes * nodes];
        for _ in 0..nodes * nodes / 2000 {
            let mut between = |low: f64, high: f64| random.random_range(low..high);
            let at = DVec2::new(between(0.0, nodes as f64), between(0.0, nodes as f64)).floor();
            let width = between(least, most);
            let height_m = 0.2 * width * POSTING_M * between(0.2, 1.0);
            let reach = |at: f64| (at - 2.0 * width).max(0.0) as usize..((at + 2.0 * width) as usize + 1).min(nodes);
            for row in reach(at.y) {
                for column in reach(at.x) {
                    let height_m = shape(DVec2::new(column as f64, row as f64) - at, width, height_m) as f32;
                    let node = &mut heights_m[row * nodes + column];
                    *node = node.max(height_m);
                }
            }
        }
        Self::of(name.into(), nodes, heights_m)
    }

    /// A square of heights about a place near the south pole.
    fn of(name: String, nodes: usize, heights_m: Vec<f32>) -> Self {
        let body = Body::moon();
        let map = Gnomonic::about(&body, Geodetic::from_degrees(-89.0, 0.0, 0.0));
        let half_m = 0.5 * (nodes - 1) as f64 * POSTING_M;
        let mut level = Level {
            columns: nodes,
            rows: nodes,
            posting_m: POSTING_M,
            west_m: -half_m,
            south_m: -half_m,
            heights_m,
            gap: vec![false; nodes * nodes],
            margin: 0,
        };
        for row in 0..nodes {
            for column in 0..nodes {
                let node = level.index(column, row);
                let radius_m = map.radius_m + f64::from(level.heights_m[node]);
                level.heights_m[node] = map.lifted_height_m(level.node_m(column, row), radius_m) as f32;
            }
        }
        Self { name, body, face: Face { map, levels: vec![level] } }
    }

    /// The scene with horizons for no more than `side²` nodes, those in the middle of its finest level.
    pub fn cut(mut self, side: usize) -> Self {
        let level = &mut self.face.levels[0];
        let nodes = level.columns.min(level.rows);
        level.margin = level.margin.max(nodes.saturating_sub(side) / 2);
        self
    }

    /// NASA's 10 m model of the connecting ridge within the 240 m model of the south polar cap; `None` where
    /// none of the folders has them.
    pub fn connecting_ridge(folders: &[PathBuf]) -> Result<Option<Self>, Error> {
        let (Some(fine), Some(coarse)) = (find(folders, RIDGE), find(folders, CAP)) else { return Ok(None) };
        Self::real("connecting ridge in the cap", &[fine, coarse]).map(Some)
    }

    /// The 240 m model of the south polar cap by itself.
    pub fn south_cap(folders: &[PathBuf]) -> Result<Option<Self>, Error> {
        find(folders, CAP).map(|path| Self::real("south polar cap", &[path])).transpose()
    }

    /// Files of `dem/` about a place, the finest first: the distance of their nodes, and the side of the square that they
    /// cover, each by default the file's own; `None` where none of the folders has them.
    pub fn about(
        name: &str,
        folders: &[PathBuf],
        centre: Geodetic,
        models: &[(&str, Option<f64>, Option<f64>)],
    ) -> Result<Option<Self>, Error> {
        let paths: Option<Vec<PathBuf>> = models.iter().map(|(file, ..)| find(folders, file)).collect();
        let Some(paths) = paths else { return Ok(None) };
        let dems = opened(&paths)?;
        let nested = |(dem, &(_, posting_m, extent_m))| NestedDem { dem, posting_m, extent_m };
        let nested: Vec<_> = dems.iter().zip(models).map(nested).collect();
        Self::nested(name, centre, &nested).map(Some)
    }

    fn real(name: &str, paths: &[PathBuf]) -> Result<Self, Error> {
        let dems = opened(paths)?;
        let middle = DVec2::new((dems[0].columns - 1) as f64, (dems[0].rows - 1) as f64) / 2.0;
        let centre = Geodetic { height_m: 0.0, ..dems[0].georeference.projector()?.geodetics(&[middle])[0] };
        Self::nested(name, centre, &dems.iter().map(NestedDem::whole).collect::<Vec<_>>())
    }

    fn nested(name: &str, centre: Geodetic, nested: &[NestedDem]) -> Result<Self, Error> {
        let body = Body::moon();
        let (face, _) = build_face(&body, centre, nested, MAX_NODES_PER_SIDE)?;
        Ok(Self { name: name.into(), body, face })
    }

    /// Nodes of the measured level that get horizons.
    pub fn receivers(&self) -> usize {
        let level = &self.face.levels[0];
        level.seen_nodes()
    }
}

fn opened(paths: &[PathBuf]) -> Result<Vec<Dem>, raster::Error> {
    paths.iter().map(|path| Dem::open(path, &Body::moon(), &raster::Options::default())).collect()
}

fn find(folders: &[PathBuf], name: &str) -> Option<PathBuf> {
    folders.iter().map(|folder| folder.join("dem").join(name)).find(|path| path.is_file())
}
