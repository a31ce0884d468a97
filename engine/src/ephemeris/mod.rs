//! When things are where: kernels, the Sun and the Earth in the sky, trajectories and attitudes.
//!
//! The only user of `anise` (kernels) and `sofars` (the series behind the default kernels), and the only place with
//! kilometres: kernels state them. What leaves the module is in metres, radians and seconds, with frames in the types.
//! An `Epoch` is an instant whatever its scale; kernels are asked in TDB, text is UTC unless it says otherwise.

pub mod aem;
pub mod attitude;
pub mod ccsds;
pub mod trajectory;

mod almanac;
mod daf;
mod default_kernels;
mod epoch;
mod error;
mod fixed_frames;
mod kernel;
mod kernel_pool;
mod load;
mod manifest;
mod meta_kernel;
mod metadata;
mod names;
mod shipped;
mod sun;
mod text_kernel;

pub use almanac::{Almanac, BodyFrame, Orientation};
pub use daf::{DafError, Kind, Segment};
pub use default_kernels::{default_span, make_default_kernels};
pub use epoch::{parse_epoch, utc_text};
pub use error::EphemerisError;
pub use hifitime::Epoch;
pub use kernel::{Format, Kernel};
pub use manifest::{KnownFile, known_file, known_files};
pub use names::{MOON, body_id, body_name, frame_name};
pub use shipped::{DEFAULT_KERNELS, KernelSource, ShippedKernel, default_kernels};
pub use sun::{EARTH_RADIUS_M, Horizontal, Source, apparent, earth, horizontal, sun};
