//! What can stand between a photograph and its comparison.

use std::path::PathBuf;

use crate::wraps_stages;

/// Any stage's error; the stages' own say what was met and what is allowed.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Pipeline(#[from] crate::pipeline::Error),
    #[error(transparent)]
    Report(#[from] crate::report::Error),
    #[error(transparent)]
    Isd(#[from] crate::camera::IsdError),
    #[error("cannot read {path}")]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{path} is neither a frame of ours nor a CSM ISD")]
    Geometry { path: PathBuf, source: serde_json::Error },
    #[error("{path}: {key} = {got}, allowed is {allowed}")]
    Value { path: PathBuf, key: String, got: String, allowed: &'static str },
    #[error("{path} holds no frame for {photo}; it has {}", there.join(", "))]
    NoSuchFrame { path: PathBuf, photo: String, there: Vec<String> },
    #[error("{photo} has {columns} x {rows} pixels, its geometry is for {}", allowed.join(" or "))]
    Size { photo: PathBuf, columns: usize, rows: usize, allowed: Vec<String> },
    #[error("--image {image} names no exposure; {path} has {count}, counted from 0")]
    NoSuchImage { image: usize, path: PathBuf, count: usize },
    #[error("{path} has no elevation model: give --dem")]
    NoDem { path: PathBuf },
    #[error("the camera of {path} sees nothing of {body}")]
    NoGround { path: PathBuf, body: String },
    #[error(
        "--albedo {albedo} holds the compared image: {reason}; it would be compared with itself. --force does it nevertheless"
    )]
    AlbedoHoldsPhoto { albedo: PathBuf, reason: String },
    #[error("photograph and render share {pixels} pixels of ground, {allowed} are needed")]
    NothingShared { pixels: usize, allowed: usize },
    #[error("the photograph is the same everywhere within {pixels} pixels: nothing can be registered")]
    Featureless { pixels: usize },
}

wraps_stages!(
    Error: crate::raster::Error,
    crate::camera::CameraError,
    crate::horizon::Error,
    crate::photometry::PhotometryError,
    crate::render::RenderError,
    crate::dataset::DatasetError,
);
