//! How right the program is.

pub mod tile;

pub use tile::{Verification, verify};
