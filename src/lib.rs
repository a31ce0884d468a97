//! Perilune renders calibrated images of airless terrain for landing navigation.
//!
//! A [`Scene`] holds a body and its terrain, and what casts shadows there; it never changes. A [`View`] says what one image
//! shows: pose, lens, lights, the reflectance of the ground, the planes that are asked for. A [`Session`] keeps a scene on a
//! device and renders views of it, each as if it were rendered alone. A [`Sequence`] is a [`Scenario`] made ready: its scene
//! and a view for every exposure.
//!
//! ```
//! use perilune::{Adapter, Camera, Ephemeris, Geodetic, Pose, Quantity, Scene, View, parse_epoch};
//!
//! # fn main() -> Result<(), perilune::Error> {
//! let moon = Ephemeris::of("moon")?;
//! let scene = Scene::smooth(moon.body());
//! let place = |height_m| moon.body().position_from_geodetic(Geodetic::from_degrees(-85.0, 0.0, height_m));
//! let pose = Pose::looking_at(place(20_000.0), place(0.0), moon.north_at(place(0.0))).expect("not along its own top");
//! let sun = moon.sunlight(place(0.0), parse_epoch("2026-11-24T00:00:00 UTC")?)?;
//! let view = View::new(pose, Camera::from_field_of_view(64, 64, 0.5)?, vec![sun]);
//! let image = scene.session(Adapter::Cpu)?.render(&view.with_quantities([Quantity::Radiance, Quantity::Range]))?;
//! let range = image.plane(Quantity::Range).expect("asked for above");
//! assert_eq!((range.quantity.unit(), range.values.len()), ("m", 64 * 64));
//! # Ok(())
//! # }
//! ```
//!
//! A scenario, as `sim run` takes it:
//!
//! ```no_run
//! # fn main() -> Result<(), perilune::Error> {
//! use perilune::{Adapter, Quantity, Scenario, Silent};
//!
//! let sequence = Scenario::load("lunar_descent.ron")?.prepare("output/cache", &Silent)?;
//! let mut session = sequence.scene().session(Adapter::Auto)?;
//! for exposure in 0..sequence.len() {
//!     let image = sequence.render(&mut session, exposure)?;
//!     println!("{}: {:?}", sequence.epoch(exposure), image.plane(Quantity::Radiance).map(|plane| plane.values[0]));
//! }
//! # Ok(())
//! # }
//! ```
//!
//! The Sun at a place is [`Ephemeris::sun`], the horizon of a place a [`HorizonTile`]. `examples/` has whole programs.
//!
//! # Conventions
//!
//! SI and radians; a name ends with its unit. Body-fixed axes: z to the north pole, x to longitude 0, longitudes east.
//! Azimuths are clockwise from north. Camera axes are OpenCV's: +x right, +y down, +z along the boresight; the centre of the
//! first pixel is (0, 0). Epochs carry their scale. A pixel without a value is NaN.
#![warn(missing_docs, missing_debug_implementations)]

mod ephemeris;
mod error;
mod horizons;
mod image;
mod scenario;
mod scene;

pub use ephemeris::{Ephemeris, SkySource};
pub use error::{Error, ErrorKind, Problem};
pub use glam::{DVec2, DVec3};
pub use horizons::{HorizonSettings, HorizonTile, Skyline};
pub use image::write_exr;
pub use scenario::{Scenario, Sequence};
pub use scene::{Dem, Scene, Session};

pub use hifitime::Unit;
pub use perilune_engine::camera::{Camera, Correction, Detector, Distortion, Pose, Vignetting};
pub use perilune_engine::ephemeris::{Epoch, parse_epoch};
pub use perilune_engine::geometry::{
    Body, BodyFixed, Camera as CameraFrame, Direction, Frame, Geodetic, Icrf, Local, Map, Position, Rotation,
};
pub use perilune_engine::horizon::{Encoding, ErrorStatistics, Method as HorizonMethod};
pub use perilune_engine::photometry::{Hapke, LimbDarkening, MultipleScattering, Reflectance};
pub use perilune_engine::pipeline::{AdapterChoice as Adapter, Progress, Report as RunReport, Silent};
pub use perilune_engine::render::{Image, Light, Plane, Quantity, View};
pub use perilune_engine::scenario::{SHIPPED as SHIPPED_SCENARIOS, ShippedScenario};
