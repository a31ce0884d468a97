//! Terrains that horizons are measured on.

use std::path::{Path, PathBuf};

use super::Error;
use crate::geometry::{Body, Geodetic};
use crate::raster::{self, Dem};
use crate::terrain::build::MAX_NODES_PER_SIDE;
use crate::terrain::synthetic::{self, Parameters};
use crate::terrain::{Face, Gnomonic, Level, NestedDem, build_face};

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
        let body = Body::moon();
        let parameters = Parameters::highland(nodes, nodes, 20.0, seed);
        let heights_m = synthetic::generate(&body, &parameters, &|_, _| ())?.heights_m;
        let map = Gnomonic::about(&body, parameters.centre);
        let half_m = 0.5 * (nodes - 1) as f64 * parameters.posting_m;
        let mut level = Level {
            columns: nodes,
            rows: nodes,
            posting_m: parameters.posting_m,
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
        Ok(Self { name: format!("cratered {nodes}²"), body, face: Face { map, levels: vec![level] } })
    }

    /// NASA's 10 m model of the connecting ridge within the 240 m model of the south polar cap; `None` where
    /// none of the folders has them.
    pub fn connecting_ridge(folders: &[PathBuf]) -> Result<Option<Self>, Error> {
        let find = |name: &str| folders.iter().map(|folder| folder.join("dem").join(name)).find(|path| path.is_file());
        let (Some(fine), Some(coarse)) = (find("site01_connecting_ridge_10m_1600.tif"), find("southcap_240m_1536.tif"))
        else {
            return Ok(None);
        };
        let body = Body::moon();
        let open = |path: &Path| Dem::open(path, &body, &raster::Options::default());
        let dems = [open(&fine)?, open(&coarse)?];
        let middle = glam::DVec2::new((dems[0].columns - 1) as f64, (dems[0].rows - 1) as f64) / 2.0;
        let centre = Geodetic { height_m: 0.0, ..dems[0].georeference.projector()?.geodetics(&[middle])[0] };
        let nested = dems.each_ref().map(NestedDem::whole);
        let (face, _) = build_face(&body, centre, &nested, MAX_NODES_PER_SIDE)?;
        Ok(Some(Self { name: "connecting ridge in the cap".into(), body, face }))
    }

    /// Nodes of the measured level that get horizons.
    pub fn receivers(&self) -> usize {
        let level = &self.face.levels[0];
        (level.columns - 2 * level.margin) * (level.rows - 2 * level.margin)
    }
}
