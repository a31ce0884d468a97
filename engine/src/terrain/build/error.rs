//! What can keep levels from being built.

use std::path::PathBuf;

use crate::geometry::Geodetic;
use crate::raster::{self, Dem};

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("a terrain needs at least one elevation model")]
    NoDem,
    #[error(transparent)]
    Raster(#[from] raster::Error),
    #[error("{path} has no heights around latitude {latitude_deg}, longitude {longitude_deg} deg")]
    Outside { path: PathBuf, latitude_deg: f64, longitude_deg: f64 },
    #[error("{path} does not overlap the next coarser elevation model")]
    Apart { path: PathBuf },
    #[error("{path}: {key} = {got} m is not a positive length")]
    Length { path: PathBuf, key: &'static str, got: f64 },
    #[error(
        "{path}: posting_m = {posting_m} is not a whole multiple, 2 or more, of the next finer level's {finer_m} m"
    )]
    Postings { path: PathBuf, posting_m: f64, finer_m: f64 },
    #[error(
        "{path}: {nodes} nodes a side at {posting_m} m, at most {max} allowed: posting_m = {fitting_posting_m} \
         or extent_m = {fitting_extent_m} fits"
    )]
    TooLarge { path: PathBuf, nodes: usize, posting_m: f64, max: usize, fitting_posting_m: f64, fitting_extent_m: f64 },
}

impl Error {
    pub(super) fn outside(dem: &Dem, centre: Geodetic) -> Self {
        let (latitude_deg, longitude_deg) = (centre.latitude_rad.to_degrees(), centre.longitude_east_rad.to_degrees());
        Self::Outside { path: dem.path.clone(), latitude_deg, longitude_deg }
    }
}
