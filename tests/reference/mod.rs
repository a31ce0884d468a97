//! Against others: closed forms, other programs, published values.

mod default_kernels;
mod ephemeris;
mod flow;
mod globe;
mod hazards;
mod horizon;
mod labels;
mod photometry;
mod raster;
mod render;
mod ridge;
mod sky;
mod trajectory;
