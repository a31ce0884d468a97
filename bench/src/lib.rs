//! How right, and how fast.
//!
//! Every measurement stands beside the error that was bought with it, and every error is one against traced
//! horizons, which are exact on the bilinear surface. A benchmark gives a [`Report`]: tables, plots and images
//! with a description of the machine, written as JSON, CSV and one HTML page.
#![warn(missing_debug_implementations)]

pub mod dataset;
pub mod error;
pub mod frame;
pub mod horizons;
pub mod illumination;
pub mod radiometry;
pub mod scenes;
pub mod shadows;
pub mod sources;
pub mod stability;
mod step_cache;

pub use error::Error;
use perilune_engine::report::{Machine, Report, Table, Value};
