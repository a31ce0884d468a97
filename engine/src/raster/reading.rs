//! How a band's stored numbers become metres, or shares of light.
//!
//! ```text
//! value = unit · (offset + scale · stored)          what the user says goes before what the file says
//! ```

use std::path::Path;

use gdal::raster::{ColorInterpretation, GdalDataType, RasterBand};
use gdal::{Dataset, Metadata};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::access::{label, label_value};
use super::unit::{metres_in, says_nothing, shares_in};
use super::{Error, Georeference, unit};
use crate::geometry::Body;

/// What the numbers of an elevation model are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum Values {
    /// Heights, or radii where the numbers are near the body's radius in m or km.
    #[default]
    Auto,
    /// Heights above the file's own ellipsoid.
    Height,
    /// Distances from the body's centre.
    Radius,
}

/// What a raster is read as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Content {
    /// Heights or radii, in units of length.
    #[default]
    Elevation,
    /// Albedos, 0 to 1.
    Albedo,
}

/// What a user says of a raster where its file says it wrongly or not at all.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    /// Counted from 1; needed where there are several.
    pub band: Option<u32>,
    /// The stored number that marks missing data, besides what the file declares.
    pub nodata: Option<f64>,
    pub scale: Option<f64>,
    pub offset: Option<f64>,
    /// Of the values after scale and offset.
    pub unit: Option<String>,
    /// WKT, PROJ string or authority code.
    pub crs: Option<String>,
}

/// `value = offset + scale × stored`, in metres or shares; the unit is in both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Numbers {
    /// Never `Auto`.
    pub values: Values,
    pub scale: f64,
    pub offset: f64,
    /// Of what the body can have, in stored numbers; others are wrong.
    pub plausible: [f64; 2],
}

impl Numbers {
    fn new(values: Values, [scale, offset]: [f64; 2], unit: f64, allowed: [f64; 2]) -> Self {
        let (scale, offset) = (scale * unit, offset * unit);
        let [a, b] = allowed.map(|end| (end - offset) / scale);
        Self { values, scale, offset, plausible: [a.min(b), a.max(b)] }
    }

    pub fn holds(&self, stored: f64) -> bool {
        self.plausible[0] <= stored && stored <= self.plausible[1]
    }

    /// Metres or shares.
    pub fn value(&self, stored: f64) -> f64 {
        self.offset + self.scale * stored
    }
}

/// Heights that a body can have, with slack: −9.2 to 10.8 km on the Moon, −8.2 to 21.2 km above the areoid on Mars, 22 km
/// up and down on Vesta.
pub fn relief_m(body: &Body) -> [f64; 2] {
    match body.naif_id {
        301 => [-9_700.0, 11_300.0],
        499 => [-9_900.0, 24_000.0],
        _ => {
            let most_m = (0.3 * body.equatorial_radius_m).min(30_000.0);
            [-most_m, most_m]
        }
    }
}

fn radii_m(body: &Body) -> [f64; 2] {
    let [low, high] = relief_m(body);
    let (a, b) = (body.equatorial_radius_m, body.polar_radius_m);
    [a.min(b) + low, a.max(b) + high]
}

/// A shade above 1 that `f32` makes of it.
const ROUNDING: f64 = 1e-6;

/// All that a band's numbers may be: one where file and user say all, several where `Auto` has to look at them.
pub fn readings(
    path: &Path,
    (dataset, band): (&Dataset, &RasterBand),
    georeference: &Georeference,
    body: &Body,
    (content, values, reading): (Content, Values, &Reading),
    own_sphere: bool,
) -> Result<Vec<Numbers>, Error> {
    let scale = reading.scale.or(band.scale()).unwrap_or(1.0);
    let offset = reading.offset.or(band.offset()).unwrap_or(0.0);
    let written = unit_of(path, dataset, band, georeference, reading, content)?;
    if content == Content::Albedo {
        let allowed = [-ROUNDING, 1.0 + ROUNDING];
        return Ok(vec![Numbers::new(Values::Height, [scale, offset], written.unwrap_or(1.0), allowed)]);
    }
    // Heights stand on the file's own sphere.
    let above_m = if own_sphere { sphere_above_m(georeference, body) } else { 0.0 };
    let heights = |unit: f64| {
        let [low, high] = relief_m(body);
        let height = Numbers::new(Values::Height, [scale, offset], unit, [low - above_m, high - above_m]);
        Numbers { offset: height.offset + above_m, ..height }
    };
    let radii = |unit: f64| Numbers::new(Values::Radius, [scale, offset], unit, radii_m(body));
    Ok(match (values, written) {
        (Values::Height, unit) => vec![heights(unit.unwrap_or(1.0))],
        (Values::Radius, Some(unit)) => vec![radii(unit)],
        (Values::Radius, None) => vec![radii(1.0), radii(1000.0)],
        (Values::Auto, Some(unit)) => vec![heights(unit), radii(unit)],
        (Values::Auto, None) => vec![heights(1.0), radii(1.0), radii(1000.0)],
    })
}

/// How much higher the sphere of a map stands than a spherical body: heights above the one are that much more above the
/// other. Spheres that maps of a spheroid use say nothing of its heights.
pub fn sphere_above_m(georeference: &Georeference, body: &Body) -> f64 {
    let figure = &georeference.figure;
    let above_m = figure.equatorial_radius_m - body.equatorial_radius_m;
    // Radii are rounded to metres.
    if figure.is_sphere() && body.is_sphere() && above_m.abs() > 1.0 { above_m } else { 0.0 }
}

/// The one that most of some stored numbers bear out. `None`: there are none, so that any would do.
pub fn settle(path: &Path, readings: &[Numbers], stored: &[f64]) -> Result<Option<Numbers>, Error> {
    if let [only] = readings {
        return Ok(Some(*only));
    }
    if stored.is_empty() {
        return Ok(None);
    }
    let share = |numbers: &Numbers| stored.iter().filter(|stored| numbers.holds(**stored)).count();
    let most = readings.iter().map(share).max().unwrap_or(0);
    let mut borne_out = readings.iter().filter(|numbers| share(numbers) == most);
    match (borne_out.next(), borne_out.next()) {
        (Some(_), Some(other)) if most > 0 => {
            let value = stored.iter().copied().find(|stored| other.holds(*stored)).unwrap_or(f64::NAN);
            Err(Error::Ambiguous { path: path.into(), value })
        }
        (first, _) => Ok(first.copied()),
    }
}

/// Metres, or shares, in the unit of a band's values; `None`: neither file nor user says it.
fn unit_of(
    path: &Path,
    dataset: &Dataset,
    band: &RasterBand,
    georeference: &Georeference,
    reading: &Reading,
    content: Content,
) -> Result<Option<f64>, Error> {
    let (size, allowed): (fn(&str) -> Option<f64>, _) = match content {
        Content::Elevation => (metres_in, unit::LENGTHS),
        Content::Albedo => (shares_in, unit::SHARES),
    };
    let known = |unit: String| match size(&unit) {
        Some(size) => Ok(Some((unit, size))),
        None if says_nothing(&unit) => Ok(None),
        None => Err(Error::Unit { path: path.into(), unit, allowed }),
    };
    if let Some(unit) = &reading.unit {
        return Ok(known(unit.clone())?.map(|(_, size)| size));
    }
    let of_band = known(written_unit(path, dataset, band))?;
    let of_system = georeference.height_unit_m.filter(|_| content == Content::Elevation);
    match (of_band, of_system) {
        (Some((unit, size)), Some(other)) if (size / other - 1.0).abs() > 1e-5 => {
            Err(Error::Units { path: path.into(), unit, other_m: other })
        }
        (of_band, of_system) => Ok(of_band.map(|(_, size)| size).or(of_system)),
    }
}

/// The unit that a band, its metadata or its label name.
fn written_unit(path: &Path, dataset: &Dataset, band: &RasterBand) -> String {
    let in_metadata = || ["UNIT", "UNITS", "units", "unit"].into_iter().find_map(|key| band.metadata_item(key, ""));
    let in_label = || {
        let is_pds = dataset.driver().short_name() == "PDS";
        is_pds.then(|| label_value(&label(path), "UNIT").map(str::to_string)).flatten()
    };
    let of_band = Some(band.unit()).filter(|unit| !unit.is_empty());
    of_band.or_else(in_metadata).or_else(in_label).unwrap_or_default()
}

/// The band to read: the one asked for, or the only one beside a mask.
pub(super) fn choose_band<'a>(
    path: &Path,
    dataset: &'a Dataset,
    wanted: Option<usize>,
) -> Result<RasterBand<'a>, Error> {
    let bands = dataset.raster_count();
    let damaged = |source| Error::Damaged { path: path.into(), source };
    let is_mask = |band: &usize| {
        dataset.rasterband(*band).is_ok_and(|band| band.color_interpretation() == ColorInterpretation::AlphaBand)
    };
    let shown: Vec<usize> = (1..=bands).filter(|band| !is_mask(band)).collect();
    let band = match (&shown[..], wanted) {
        (_, Some(band)) if (1..=bands).contains(&band) => band,
        (_, Some(band)) => return Err(Error::NoSuchBand { path: path.into(), band, bands }),
        ([only], None) => *only,
        _ if bands == 0 => return Err(Error::NoBand { path: path.into() }),
        _ => {
            let name = |band: usize| dataset.rasterband(band).ok().map(|found| name_of(band, &found));
            return Err(Error::ManyBands { path: path.into(), bands, names: (1..=bands).filter_map(name).collect() });
        }
    };
    let band = dataset.rasterband(band).map_err(damaged)?;
    // The bindings know the real types only.
    if band.band_type() == GdalDataType::Unknown {
        return Err(Error::NotReal { path: path.into() });
    }
    if band.color_table().is_some() && band.color_interpretation() == ColorInterpretation::PaletteIndex {
        return Err(Error::Palette { path: path.into() });
    }
    Ok(band)
}

/// `2 (sigma)`.
fn name_of(band: usize, found: &RasterBand) -> String {
    let description = found.description().unwrap_or_default();
    match (description.is_empty(), found.color_interpretation()) {
        (false, _) => format!("{band} ({description})"),
        (true, ColorInterpretation::GrayIndex | ColorInterpretation::Undefined) => band.to_string(),
        (true, colour) => format!("{band} ({})", colour.name().to_lowercase()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_is_settled_by_what_most_numbers_bear_out() {
        let height = Numbers::new(Values::Height, [1.0, 0.0], 1.0, relief_m(&Body::moon()));
        let radius = Numbers::new(Values::Radius, [1.0, 0.0], 1.0, radii_m(&Body::moon()));
        let kilometres = Numbers::new(Values::Radius, [1.0, 0.0], 1000.0, radii_m(&Body::moon()));
        let all = [height, radius, kilometres];
        let settled = |stored: &[f64]| settle(Path::new("a.tif"), &all, stored);
        assert_eq!(settled(&[0.0, 1_737_000.0, 1_738_000.0]).unwrap(), Some(radius));
        assert_eq!(settled(&[-9999.0, 10.0, 1735.0]).unwrap(), Some(height));
        assert!(matches!(settled(&[1737.4, 1738.0]), Err(Error::Ambiguous { .. })));
        assert_eq!(settled(&[]).unwrap(), None);
        // As LOLA's float images: the label's offset makes radii.
        let offset = Numbers::new(Values::Radius, [1.0, 1737.4], 1000.0, radii_m(&Body::moon()));
        assert!(offset.holds(0.4) && !offset.holds(84.0) && (offset.value(0.4) - 1_737_800.0).abs() < 1e-6);
    }
}
