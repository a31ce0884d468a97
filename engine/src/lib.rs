//! Perilune renders calibrated images of airless terrain for landing navigation.
//!
//! A scenario names a body, its elevation models, a trajectory and epochs. The Sun's direction, distance and
//! angular size come from SPICE-style ephemerides, shadows from Fourier-compressed horizon maps, and each
//! image holds radiance and irradiance in SI units with the ground truth beside them.
//!
//! # What is computed
//!
//! ```text
//! L = Σ lights  f_r(μ0, μ, g) · E        radiance towards the camera, W m⁻² sr⁻¹
//! E = E_n [V (n·s) + ρ (M_x n·e_x + M_y n·e_y)]   irradiance of the ground facet, W m⁻²
//! ```
//!
//! `V` and `M` are share and first moment of the limb-darkened solar disc above the skyline *and* above the
//! facet's own plane ([`photometry::SolarDisk`]): near the poles, where the Sun's disc is as high as the Sun,
//! the product of visibility and cosine is 7 to 17 % too low across a penumbra.
//!
//! # The idea that carries it
//!
//! Terrain lives on gnomonic maps with *lifted* heights ([`terrain::gnomonic`]). The map is projective: view
//! rays, sunrays and great circles are straight lines over a flat height field, and planets stay curved to
//! the last digit. One surface, bilinear in lifted height, serves the horizon engine and both renderers.
//!
//! # The two stories
//!
//! ```text
//! RUN      scenario -> Scenario; for each exposure: Sun, pose -> View -> renderer -> planes -> dataset
//! OFFLINE  DEMs -> levels on a map -> horizons of all points -> Fourier coefficients -> tiles with their error
//! ```
//!
//! `pipeline` tells both in order. [`render::View`] is the waist: plain numbers, no epoch, no kernel, no file.
//!
//! # Two of each model
//!
//! What is fast has a twin that is believed, and a test that has been seen to fail holds them together:
//! `horizon::sweep` and [`horizon::trace`], `render::passes` and [`render::reference`], every `.wgsl` file
//! and the `.rs` file beside it.
//!
//! # Who may depend on whom
//!
//! ```text
//! { quantity, digest, files, statistics, grid, text } -> geometry -> { ephemeris, raster, gpu, photometry } -> { terrain, camera }
//!          -> horizon -> shadow -> render -> labels -> dataset -> { report, image_metrics }
//!          -> { illumination, scenario } -> pipeline -> compare
//! ```
//!
//! A module uses only modules to its left. `tests/architecture.rs` reads the sources and says so. The packages above
//! this one are `perilune-bench`, which measures, and `perilune`, the face and the program `sim`.
//!
//! # Conventions
//!
//! SI and radians inside; a name ends with its unit. Body-fixed axes: z to the north pole, x to longitude 0,
//! longitudes east. Azimuth is clockwise from north; on a map, clockwise from map +Y ([`terrain::level`]).
//! Camera axes are OpenCV's: +x right, +y down, +z along the boresight; the centre of the first pixel is
//! (0, 0). Quaternions are scalar first and turn body-fixed components into camera components. Epochs carry
//! their scale. A pixel without a value is NaN.
#![warn(missing_debug_implementations)]

pub mod digest;
pub mod files;
pub mod grid;
pub mod quantity;
pub mod signals;
pub mod statistics;
pub mod text;

pub mod geometry;

pub mod ephemeris;
pub mod gpu;
pub mod photometry;
pub mod raster;

pub mod camera;
pub mod terrain;

pub mod horizon;
pub mod shadow;

pub mod render;

pub mod labels;

pub mod dataset;

pub mod image_metrics;
pub mod report;

pub mod illumination;
pub mod scenario;

pub mod pipeline;

pub mod compare;
