//! What can go wrong between a scenario and its images.

use std::path::PathBuf;

/// Any stage's error; the stages' own say what was met and what is allowed.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Ephemeris(#[from] crate::ephemeris::EphemerisError),
    #[error(transparent)]
    Trajectory(#[from] crate::ephemeris::trajectory::TrajectoryError),
    #[error(transparent)]
    Attitude(#[from] crate::ephemeris::attitude::AttitudeError),
    #[error(transparent)]
    Aem(#[from] crate::ephemeris::aem::AemError),
    #[error(transparent)]
    Raster(#[from] crate::raster::Error),
    #[error(transparent)]
    Synthetic(#[from] crate::terrain::synthetic::Error),
    #[error(transparent)]
    Terrain(#[from] crate::terrain::build::Error),
    #[error(transparent)]
    Horizon(#[from] crate::horizon::Error),
    #[error(transparent)]
    Camera(#[from] crate::camera::CameraError),
    #[error(transparent)]
    Photometry(#[from] crate::photometry::PhotometryError),
    #[error(transparent)]
    Gpu(#[from] crate::gpu::GpuError),
    #[error(transparent)]
    Craters(#[from] crate::labels::catalogue::Error),
    #[error(transparent)]
    Render(#[from] crate::render::RenderError),
    #[error(transparent)]
    Dataset(#[from] crate::dataset::DatasetError),
    #[error("cannot read the psf kernel {path}: {source}")]
    UnreadableKernel { path: PathBuf, source: std::io::Error },
    #[error("psf kernel {path}, line {line}: {got:?} is no number, or the line has not as many as the first")]
    KernelLine { path: PathBuf, line: usize, got: String },
    #[error("cannot write {path}")]
    Unwritable { path: PathBuf, source: std::io::Error },
    #[error("{path} lists the tiles of another globe: {difference}; choose another folder, or remove it")]
    OtherGlobe { path: PathBuf, difference: String },
    #[error("{path} is not the index of a globe")]
    Index { path: PathBuf, source: serde_json::Error },
    #[error("terrain: no {path}; tiles must be a folder that sim horizon globe has made")]
    NoIndex { path: PathBuf },
    #[error(
        "terrain: {path} lists tiles that the scenario cannot use: {difference}; change the scenario's terrain or horizon, \
         or leave tiles out"
    )]
    TilesOfAnother { path: PathBuf, difference: String },
    #[error("the selection holds no tile: there are faces 0 to 5 and levels 0 to {}", levels - 1)]
    NoTiles { levels: usize },
    #[error(
        "trajectory: at exposure {exposure} ({epoch_utc}) the camera is {height_m:.1} m above the reference surface, \
         the ground below it {ground_m:.1} m; the camera must be above the ground"
    )]
    BelowGround { exposure: usize, epoch_utc: String, height_m: f64, ground_m: f64 },
    #[error("horizon.band: true keeps of horizons what decides about one part of the sky, but {why}; leave it out")]
    NoBand { why: &'static str },
    #[error(transparent)]
    Shadows(Box<crate::shadow::PrepareError>),
    #[error(
        "outputs.planes: shadow_change needs a camera that stands still; before exposure {exposure} it moves by {moved_m:.3} m \
         and turns by {turned_deg:.5} deg"
    )]
    CameraMoves { exposure: usize, moved_m: f64, turned_deg: f64 },
    #[error(
        "memory: the run takes about {needed_gb:.1} GB, {available_gb:.1} GB are available; ask for fewer pixels, planes, rays a pixel \
         or nodes"
    )]
    TooLittleMemory { needed_gb: f64, available_gb: f64 },
    #[error("{frames} names no exposure; the scenario has {count}, counted from 0")]
    NoSuchExposures { frames: String, count: usize },
}

impl From<crate::shadow::PrepareError> for Error {
    fn from(error: crate::shadow::PrepareError) -> Self {
        Self::Shadows(Box::new(error))
    }
}

/// Makes an error that wraps [`Error`] as `Pipeline` from the stages' own, so that `?` serves for them too.
#[macro_export]
macro_rules! wraps_stages {
    ($error:ty: $($stage:ty),* $(,)?) => {$(
        impl From<$stage> for $error {
            fn from(error: $stage) -> Self {
                Self::Pipeline(error.into())
            }
        }
    )*};
}
