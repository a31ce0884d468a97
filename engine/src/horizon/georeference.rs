//! The map of a tile in the words of PROJ and GeoTIFF.
//!
//! # References
//! OGC GeoTIFF 1.1, Annexes C and D; CT_Gnomonic is 19.

use std::io::{Seek, Write};

use glam::DVec3;
use tiff::TiffResult;
use tiff::encoder::{DirectoryEncoder, TiffKind};
use tiff::tags::Tag;

use crate::terrain::Gnomonic;

/// Latitude and longitude of the centre of a map about the body's centre with north up; `None` for other maps.
pub fn centre_deg(map: &Gnomonic) -> Option<[f64; 2]> {
    let (centre, north_up) = map.north_up();
    let same = north_up.abs_diff_eq(map.map_from_body.matrix(), 1e-9) && map.origin.vector_m() == DVec3::ZERO;
    same.then(|| [centre.latitude_rad, centre.longitude_east_rad].map(f64::to_degrees))
}

/// A map about such a centre as a PROJ string.
pub fn proj4(radius_m: f64, [latitude_deg, longitude_deg]: [f64; 2]) -> String {
    format!("+proj=gnom +lat_0={latitude_deg} +lon_0={longitude_deg} +R={radius_m} +units=m +no_defs")
}

/// A gnomonic map about the body's centre with north up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Georeference {
    pub radius_m: f64,
    /// Latitude and longitude of the map's centre.
    pub centre_deg: [f64; 2],
    pub posting_m: f64,
    /// Map coordinates of the first node, top left.
    pub west_m: f64,
    pub north_m: f64,
}

/// GeoTIFF tags of a page at full resolution.
pub fn write_tags<W: Write + Seek, K: TiffKind>(
    page: &mut DirectoryEncoder<W, K>,
    map: &Georeference,
) -> TiffResult<()> {
    let [latitude_deg, longitude_deg] = map.centre_deg;
    page.write_tag(Tag::ModelPixelScaleTag, &[map.posting_m, map.posting_m, 0.0][..])?;
    page.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, map.west_m, map.north_m, 0.0][..])?;
    let doubles = [map.radius_m, map.radius_m, longitude_deg, latitude_deg, 0.0, 0.0];
    let citation = "gnomonic on a sphere|";
    let entry = |key: u16, value: u16| [key, 0, 1, value];
    let double = |key: u16, index: u16| [key, 34736, 1, index];
    let keys = [
        // Version 1.1.0 and the number of keys.
        [1, 1, 0, 17],
        // Projected; a pixel is a point.
        entry(1024, 1),
        entry(1025, 2),
        [1026, 34737, citation.len() as u16, 0],
        // A user-defined sphere in degrees.
        entry(2048, 32767),
        entry(2050, 32767),
        entry(2054, 9102),
        entry(2056, 32767),
        double(2057, 0),
        double(2058, 1),
        // A user-defined gnomonic projection in metres.
        entry(3072, 32767),
        entry(3074, 32767),
        entry(3075, 19),
        entry(3076, 9001),
        double(3082, 4),
        double(3083, 5),
        double(3088, 2),
        double(3089, 3),
    ];
    page.write_tag(Tag::GeoKeyDirectoryTag, keys.as_flattened())?;
    page.write_tag(Tag::GeoDoubleParamsTag, &doubles[..])?;
    page.write_tag(Tag::GeoAsciiParamsTag, citation)
}
