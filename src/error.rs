//! What can go wrong, by kind.

use perilune_engine::camera::CameraError;
use perilune_engine::ephemeris::EphemerisError;
use perilune_engine::gpu::GpuError;
use perilune_engine::photometry::PhotometryError;
use perilune_engine::render::RenderError;
use perilune_engine::scenario::ScenarioError;
use perilune_engine::{horizon, pipeline, raster};

/// A failure: its kind for programs, its text for people. The text says what was got and what is allowed.
#[derive(Debug, thiserror::Error)]
#[error("{source}")]
pub struct Error {
    kind: ErrorKind,
    source: Box<dyn std::error::Error + Send + Sync>,
}

/// What a failure is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// A scenario's text, or a file that it names.
    Scenario,
    /// Kernels, bodies, frames, epochs outside what is covered.
    Ephemeris,
    /// Elevation models and other rasters.
    Raster,
    /// Lens, pose or detector.
    Camera,
    /// Reflectance, spectra, limb darkening.
    Photometry,
    /// Horizons and their tiles.
    Horizon,
    /// The graphics device, or its absence.
    Device,
    /// A view that cannot be rendered.
    Render,
    /// Anything else between a scenario and its images.
    Run,
}

/// One thing that is wrong with a scenario's text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Line of the text, counted from 1.
    pub line: usize,
    /// Column of the text, counted from 1.
    pub column: usize,
    /// The key, as in `trajectory.points[2].t_s`; empty for the whole text.
    pub key: String,
    /// What was got, and what is allowed.
    pub message: String,
}

impl Error {
    /// What the failure is about.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// What is wrong with a scenario's text, in the order of its lines; empty for all other failures.
    pub fn problems(&self) -> Vec<Problem> {
        let found = self.source.downcast_ref::<ScenarioError>().map_or(&[][..], ScenarioError::problems);
        let told = found.iter().map(|problem| Problem {
            line: problem.place.line,
            column: problem.place.column,
            key: problem.key.clone(),
            message: problem.fault.to_string(),
        });
        told.collect()
    }

    pub(crate) fn new(kind: ErrorKind, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self { kind, source: source.into() }
    }
}

macro_rules! kinds {
    ($($kind:ident: $source:ty),* $(,)?) => {$(
        impl From<$source> for Error {
            fn from(source: $source) -> Self {
                Self::new(ErrorKind::$kind, source)
            }
        }
    )*};
}

kinds!(
    Scenario: ScenarioError,
    Ephemeris: EphemerisError,
    Raster: raster::Error,
    Camera: CameraError,
    Photometry: PhotometryError,
    Horizon: horizon::Error,
    Device: GpuError,
);

impl From<RenderError> for Error {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Gpu(error) => error.into(),
            error => Self::new(ErrorKind::Render, error),
        }
    }
}

impl From<pipeline::Error> for Error {
    fn from(error: pipeline::Error) -> Self {
        use pipeline::Error as E;
        match error {
            E::Ephemeris(error) => error.into(),
            E::Raster(error) => error.into(),
            E::Camera(error) => error.into(),
            E::Photometry(error) => error.into(),
            E::Horizon(error) => error.into(),
            E::Gpu(error) => error.into(),
            E::Render(error) => error.into(),
            error => Self::new(ErrorKind::Run, error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_has_the_kind_of_its_stage_and_its_text() {
        let no_adapter = || GpuError::NoAdapter { wanted: "graphics", found: "found none".into() };
        let error = Error::from(pipeline::Error::from(no_adapter()));
        assert_eq!((error.kind(), error.to_string()), (ErrorKind::Device, no_adapter().to_string()));
        assert!(error.problems().is_empty());
    }
}
