//! Against others: closed forms, other programs, published values.

mod ephemeris;
mod horizon;
mod photometry;
mod raster;
