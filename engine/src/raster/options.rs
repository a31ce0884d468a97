//! What is asked of a raster.

use super::reading::{Content, Reading, Values};
use super::window::{Around, Window};

/// How to read an elevation model or a map.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// What the file says wrongly or not at all.
    pub reading: Reading,
    pub values: Values,
    pub content: Content,
    /// Read these pixels only.
    pub window: Option<Window>,
    /// Of these, only those that are needed for the ground around a place.
    pub around: Option<Around>,
    /// The posting it will be used at. Pixels are averaged n × n while reading, n = ⌊posting/pixel⌋, so
    /// that a coarse grid holds means and not a random choice of samples.
    pub posting_m: Option<f64>,
    /// Refuse more columns or rows than these of what is kept, before anything is read.
    pub most_side: Option<usize>,
    /// Accept a CRS whose body has another radius.
    pub any_body: bool,
}
