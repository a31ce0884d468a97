//! Where a file lies on its body: what its coordinate system, its affine map and its label say, and what they leave out.

use std::path::Path;

use gdal::Dataset;
use gdal::spatial_ref::SpatialRef;

use super::access::{label, label_value};
use super::{Error, Georeference};
use crate::geometry::Body;

/// A skew that moves no pixel by more than this is rounding.
const SKEW_PIXELS: f64 = 1e-3;

/// Radii that differ by less are those of one body.
const RADIUS_TOLERANCE: f64 = 1e-3;

/// The georeference of a data set; `crs` goes before the file's own system.
pub fn georeference(path: &Path, dataset: &Dataset, crs: Option<&str>) -> Result<Georeference, Error> {
    let wkt = match crs {
        Some(crs) => crs.to_string(),
        None => system(path, dataset)?,
    };
    let geotransform = dataset.geo_transform().map_err(|_| no_map(path, dataset))?;
    let [_, a, b, _, c, d] = geotransform;
    if !(a * d - b * c).is_normal() {
        return Err(no_map(path, dataset));
    }
    let size = dataset.raster_size();
    Georeference::new(&wkt, straightened(geotransform, size), size.0)
}

/// A file without an affine map may have control points, which are none.
fn no_map(path: &Path, dataset: &Dataset) -> Error {
    match dataset.gcps().len() {
        0 => Error::NoGeotransform { path: path.into() },
        count => Error::ControlPoints { path: path.into(), count },
    }
}

/// Skews of rounding size are none: rows then run along parallels exactly.
fn straightened(mut geotransform: [f64; 6], (columns, rows): (usize, usize)) -> [f64; 6] {
    let [_, a, b, _, c, d] = geotransform;
    if (b * rows as f64).abs() < SKEW_PIXELS * a.abs() {
        geotransform[2] = 0.0;
    }
    if (c * columns as f64).abs() < SKEW_PIXELS * d.abs() {
        geotransform[4] = 0.0;
    }
    geotransform
}

/// The file's own coordinate system.
fn system(path: &Path, dataset: &Dataset) -> Result<String, Error> {
    let wkt = dataset.projection();
    if wkt.is_empty() {
        return Err(match dataset.gcps().len() {
            0 => Error::NoCrs { path: path.into() },
            count => Error::ControlPoints { path: path.into(), count },
        });
    }
    if SpatialRef::from_wkt(&wkt).is_ok_and(|crs| crs.is_local()) {
        return Err(Error::LocalGrid { path: path.into() });
    }
    match counts_west(path, dataset) {
        West::No => Ok(wkt),
        // GDAL takes an ISIS cube's central meridian for an east longitude; its maps themselves run east.
        West::Isis => mirrored(&wkt).ok_or_else(|| Error::West { path: path.into() }),
        West::Other => Err(Error::West { path: path.into() }),
    }
}

/// Whether a label counts longitudes to the west, which GDAL does not read.
enum West {
    No,
    Isis,
    Other,
}

fn counts_west(path: &Path, dataset: &Dataset) -> West {
    let driver = dataset.driver().short_name();
    if !["ISIS3", "ISIS2", "PDS", "PDS4", "VICAR"].contains(&driver.as_str()) {
        return West::No;
    }
    let label = label(path);
    let is_west = |value: &str| value.to_ascii_lowercase().replace(['_', ' '], "").contains("west");
    if label_value(&label, "LongitudeDirection").is_some_and(is_west) {
        return if driver == "ISIS3" { West::Isis } else { West::Other };
    }
    let in_pds = label_value(&label, "POSITIVE_LONGITUDE_DIRECTION").is_some_and(is_west);
    let in_xml =
        label.split("longitude_direction>").nth(1).is_some_and(|rest| rest.to_lowercase().starts_with("positive west"));
    if in_pds || in_xml { West::Other } else { West::No }
}

/// The same projection about the meridian on the other side of the prime one.
fn mirrored(wkt: &str) -> Option<String> {
    for name in ["central_meridian", "longitude_of_center", "longitude_of_origin"] {
        let key = format!("PARAMETER[\"{name}\",");
        if let Some(at) = wkt.find(&key) {
            let (before, rest) = wkt.split_at(at + key.len());
            let end = rest.find([',', ']'])?;
            let meridian: f64 = rest[..end].trim().parse().ok()?;
            return Some(format!("{before}{}{}", -meridian, &rest[end..]));
        }
    }
    None
}

pub fn check_body(path: &Path, georeference: &Georeference, body: &Body, any: bool) -> Result<(), Error> {
    let (got_m, expected_m) = (georeference.figure.equatorial_radius_m, body.equatorial_radius_m);
    if any || (got_m / expected_m - 1.0).abs() <= RADIUS_TOLERANCE {
        return Ok(());
    }
    Err(Error::OtherBody { path: path.into(), body: body.name.clone(), got_m, expected_m })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_skew_that_moves_no_pixel_is_none() {
        let skewed = |b: f64, c: f64| straightened([0.0, 2.0, b, 0.0, c, -2.0], (180, 90));
        assert_eq!(skewed(1e-15, -1e-12), [0.0, 2.0, 0.0, 0.0, 0.0, -2.0]);
        assert_eq!(skewed(0.001, 0.0)[2], 0.001);
    }

    #[test]
    fn a_meridian_is_mirrored() {
        let wkt = "PROJCS[\"a\",PROJECTION[\"Equirectangular\"],PARAMETER[\"central_meridian\",150],UNIT[\"m\",1]]";
        assert!(mirrored(wkt).unwrap().contains("\"central_meridian\",-150]"));
        assert_eq!(mirrored("GEOGCS[\"a\"]"), None);
    }
}
