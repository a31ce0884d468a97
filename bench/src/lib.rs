//! How right, and how fast.
//!
//! Every measurement stands beside the error that was bought with it, and every error is one against traced
//! horizons, which are exact on the bilinear surface. A benchmark gives a [`Report`]: tables, plots and images
//! with a description of the machine, written as JSON, CSV and one HTML page.

pub mod dataset;
pub mod error;
pub mod frame;
pub mod horizons;
pub mod illumination;
pub mod images;
mod kept;
pub mod machine;
pub mod plot;
pub mod radiometry;
pub mod report;
pub mod scenes;
pub mod shadows;
pub mod sources;
pub mod stability;
pub mod statistics;
pub mod table;
pub mod tile;

pub use error::Error;
pub use machine::Machine;
pub use report::Report;
pub use table::{Table, Value};
pub use tile::{Verification, verify};
