//! Perilune: calibrated images of airless terrain for landing navigation.
#![warn(missing_debug_implementations)]

pub mod quantity;

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

pub mod dataset;
pub mod scenario;

pub mod pipeline;

pub mod evaluate;
