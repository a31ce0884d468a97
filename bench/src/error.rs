//! What can go wrong while measuring.

use std::path::PathBuf;

use perilune_engine::wraps_stages;

/// Any stage's error; the stages' own say what was met and what is allowed.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Pipeline(#[from] perilune_engine::pipeline::Error),
    #[error("cannot write {path}")]
    Write { path: PathBuf, source: std::io::Error },
    #[error("cannot run {path}")]
    Program { path: PathBuf, source: std::io::Error },
    #[error(transparent)]
    Report(#[from] perilune_engine::report::Error),
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
    Error: perilune_engine::raster::Error,
    perilune_engine::terrain::synthetic::Error,
    perilune_engine::terrain::build::Error,
    perilune_engine::horizon::Error,
    perilune_engine::photometry::PhotometryError,
    perilune_engine::render::RenderError,
    perilune_engine::dataset::DatasetError,
    perilune_engine::ephemeris::EphemerisError,
);
