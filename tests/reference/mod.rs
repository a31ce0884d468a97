//! Against others: closed forms, other programs, published values.

mod bounce;
mod default_kernels;
mod detail;
mod ephemeris;
mod flow;
mod globe;
mod hazards;
pub mod horizon;
mod labels;
mod lod;
mod photometry;
mod raster;
mod render;
mod ridge;
mod sky;
mod slopes;
mod trajectory;
