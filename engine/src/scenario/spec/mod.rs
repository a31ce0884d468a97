//! The scenario file, field by field. Documents and ranges below become `sim schema`.

mod camera;
mod light;
mod output;
mod shadows;
mod surface;
mod sweep;
mod view;
mod world;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use crate::raster::Values;
use crate::render::ViewRays;

pub use camera::{
    AutoExposure, Camera, Correction, Distortion, First, Preset, PrincipalPoint, PsfComponent, Shutter, Vignetting,
};
pub use light::{Ambient, Bounce, Disc, Earthshine, FixedSun, LimbLaw, Sky, Spectrum, Sun};
pub use output::{CraterList, Detector, Hazards, Landmarks, Outputs, Preview};
pub use shadows::Shadows;
pub use surface::{Albedo, PhaseFunction, Photometry, Surface};
pub use sweep::{Axis, Design, Split, Sweep};
pub use view::{Exposures, HeightAbove, Pointing, Pose, Top, Towards, Trajectory, Waypoint};
pub use world::{Body, Centre, DEFAULT_AZIMUTHS, Dem, Horizon, Terrain};

/// A scenario: a body and its terrain, a Sun, a camera on its way, and what to write.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Spec {
    /// What the sequence shows, in one line; it is copied into every output.
    pub title: String,
    /// The body that is seen.
    #[serde(default)]
    pub body: Body,
    /// Body-fixed frame of all coordinates: IAU_MOON, MOON_ME_DE440_ME421, MOON_ME_DE421, IAU_MARS, … Default: the
    /// best that the kernels have.
    #[serde(default)]
    pub frame: Option<String>,
    /// SPICE kernels: ephemerides (.bsp), orientation (.bpc, .epa), constants (.tpc). Default: the kernels that are
    /// shipped with the program.
    #[serde(default)]
    pub kernels: Option<Vec<String>>,
    /// The ground. Default: the bare spheroid.
    #[serde(default)]
    pub terrain: Option<Terrain>,
    /// How horizons are computed.
    #[serde(default)]
    pub horizon: Horizon,
    /// How shadows are cast.
    #[serde(default)]
    pub shadows: Shadows,
    /// Settles by tracing, pixel by pixel, what horizon maps leave open: where their own error could change the Sun's share.
    /// For shadows from horizon maps with all their coefficients, without visibility. Takes seconds an image.
    #[serde(default)]
    pub refine: bool,
    /// How the first ground along a ray from the camera is found.
    #[serde(default)]
    pub view_rays: ViewRays,
    /// How the ground reflects light.
    #[serde(default)]
    pub surface: Surface,
    /// The Sun.
    #[serde(default)]
    pub sun: Sun,
    /// Light that the Earth reflects onto the ground. Default: none.
    #[serde(default)]
    pub earthshine: Option<Earthshine>,
    /// Light from all of the sky. Default: none.
    #[serde(default)]
    pub ambient: Option<Ambient>,
    /// Sunlight that terrain reflects onto terrain, once. Default: none.
    #[serde(default)]
    pub bounce: Option<Bounce>,
    /// Where the camera is.
    pub trajectory: Trajectory,
    /// Where the camera looks.
    #[serde(default)]
    pub pointing: Pointing,
    /// The camera.
    pub camera: Camera,
    /// What turns light into digital numbers. Default: none, the outputs are radiometric.
    #[serde(default)]
    pub detector: Option<Detector>,
    /// When images are taken.
    pub exposures: Exposures,
    /// Makes all exposures at many points: Suns, places, albedos. Default: none.
    #[serde(default)]
    pub sweep: Option<Sweep>,
    /// Which images are for training, validation and test. Default: not said.
    #[serde(default)]
    pub split: Option<Split>,
    /// What is written.
    #[serde(default)]
    pub outputs: Outputs,
    /// Craters as ellipses and conics. Default: none.
    #[serde(default)]
    pub landmarks: Option<Landmarks>,
    /// A lander, for the planes hazard_….
    #[serde(default)]
    pub hazards: Hazards,
    /// Seed of all noise.
    #[serde(default)]
    pub seed: u64,
}

fn one() -> f64 {
    1.0
}
