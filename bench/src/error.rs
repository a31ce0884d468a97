//! What can go wrong while measuring.

use std::path::PathBuf;

use crate::pipeline::error::wraps_stages;

/// Any stage's error; the stages' own say what was met and what is allowed.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Pipeline(#[from] crate::pipeline::Error),
    #[error("cannot write {path}")]
    Write { path: PathBuf, source: std::io::Error },
    #[error("cannot run {path}")]
    Program { path: PathBuf, source: std::io::Error },
    #[error("cannot encode the image {name} as PNG")]
    Png { name: String, source: image::ImageError },
    #[error("{key} = {got} is outside [{}, {}]", allowed[0], allowed[1])]
    Range { key: &'static str, got: usize, allowed: [usize; 2] },
    #[error("method = {got} is unknown, allowed are {allowed}")]
    Method { got: String, allowed: String },
    #[error("the scenario has no terrain, there is nothing to cast a shadow")]
    NoTerrain,
    #[error(
        "the terrain is a Globe, beyond whose tiles nothing is traced: there is no truth to compare with; use Cube"
    )]
    Globe,
    #[error("exposure {exposure} sees no ground with heights")]
    NoGround { exposure: usize },
}

wraps_stages!(
    Error: crate::raster::Error,
    crate::terrain::synthetic::Error,
    crate::terrain::build::Error,
    crate::horizon::Error,
    crate::photometry::PhotometryError,
    crate::render::RenderError,
    crate::dataset::DatasetError,
    crate::ephemeris::EphemerisError,
);
