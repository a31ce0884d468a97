//! The light of areas and places, by their names.

use crate::geometry::Geodetic;
use crate::illumination::area::AreaSummary;
use crate::illumination::place::{Moment, Summary};
use crate::illumination::{Place, Series};

/// A place as it was named, with its light.
#[derive(Debug)]
pub struct PlaceResult<'a> {
    pub name: String,
    pub at: Geodetic,
    /// Its node or the nearest one, where that is on the map.
    pub node: Option<usize>,
    pub place: Place<'a>,
    pub moments: Vec<Moment>,
    pub summary: Summary,
}

/// An area as it was named, with its light.
#[derive(Debug, Clone)]
pub struct AreaResult {
    pub name: String,
    pub series: Series,
    pub summary: AreaSummary,
}
