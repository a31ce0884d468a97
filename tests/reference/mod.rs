//! Against others: closed forms, other programs, published values.

mod horizon;
mod photometry;
mod raster;
