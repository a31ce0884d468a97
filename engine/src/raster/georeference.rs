//! From points of a body to the pixels of a map of it, and back.
//!
//! ```text
//! point of the body --latitude on the CRS's figure--> (lon, lat) --PROJ--> (x, y) --affine--> (column, row)
//! ```
//!
//! # Conventions
//! Pixel coordinates are continuous and pixel *centres* lie at integers: the first pixel spans −0.5 to
//! 0.5. GDAL's affine transform refers to pixel corners, also for files whose samples are points
//! (`AREA_OR_POINT=Point`, which GDAL shifts by half a pixel), so that one rule serves both.
//! Coordinates are (easting, northing) or (longitude, latitude) whatever axis order the authority of a
//! CRS prescribes; a CRS's west-positive longitudes and prime meridians other than the reference one are undone. Labels of
//! archives that count longitudes west are another matter, see `placed`.
//!
//! Latitude is measured on the CRS's own figure through the point in space: planetocentric where the
//! CRS is a sphere, planetographic where it is a spheroid, whatever figure the body has (at 45° on Mars
//! they are 0.338° = 20 km apart).
//!
//! Maps whose columns run around the body (cylindrical, or longitude itself) are periodic: the column is
//! the one nearest to the raster's middle.

use std::f64::consts::FRAC_PI_2;

use glam::{DMat2, DVec2};

use gdal::spatial_ref::{AxisMappingStrategy, CoordTransform, SpatialRef};

use super::Error;
use super::access::keep_gdal_quiet;
use super::unit::height_unit_m;
use crate::geometry::{Body, BodyFixed, Geodetic, Position};

/// How a raster lies on its body.
#[derive(Debug, Clone, PartialEq)]
pub struct Georeference {
    /// The coordinate reference system as WKT.
    pub wkt: String,
    /// `x = g₀ + c g₁ + r g₂`, `y = g₃ + c g₄ + r g₅` with `(c, r)` counted from the first pixel's corner.
    pub geotransform: [f64; 6],
    /// The sphere or spheroid of the CRS.
    pub figure: Body,
    /// Columns once around the body, where columns run around it.
    pub period_columns: Option<f64>,
    /// Metres in the unit of heights, where the CRS says it.
    pub height_unit_m: Option<f64>,
    /// The raster's middle, to which periodic columns are counted nearest.
    middle_column: f64,
    longitude: Longitude,
}

/// How the CRS counts longitude.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Longitude {
    /// +1 east positive, −1 west positive.
    sign: f64,
    prime_meridian_rad: f64,
    radians_per_unit: f64,
}

impl Georeference {
    /// A raster of `columns` in the CRS `definition` (WKT, PROJ string or authority code).
    pub fn new(definition: &str, geotransform: [f64; 6], columns: usize) -> Result<Self, Error> {
        keep_gdal_quiet();
        let failed = |source| Error::Crs { definition: definition.into(), source };
        let crs = traditional(SpatialRef::from_definition(definition).map_err(failed)?);
        let height_unit_m = height_unit_m(&crs);
        if crs.is_compound() {
            // SAFETY: the handle belongs to `crs`, which nothing else refers to.
            unsafe { gdal_sys::OSRStripVertical(crs.to_c_hsrs()) };
        }
        let figure = Body {
            name: crs.name().unwrap_or_default(),
            naif_id: 0,
            equatorial_radius_m: crs.semi_major().map_err(failed)?,
            polar_radius_m: crs.semi_minor().map_err(failed)?,
        };
        let geographic = crs.geog_cs().map_err(failed)?;
        let mut georeference = Self {
            wkt: crs.to_wkt().map_err(failed)?,
            geotransform,
            figure,
            period_columns: None,
            height_unit_m,
            middle_column: (columns as f64 - 1.0) / 2.0,
            longitude: Longitude::of(&geographic),
        };
        georeference.period_columns = georeference.find_period()?;
        Ok(georeference)
    }

    /// The transformations of one thread.
    pub fn projector(&self) -> Result<Projector<'_>, Error> {
        let failed = |source| Error::Crs { definition: self.wkt.clone(), source };
        let crs = traditional(SpatialRef::from_wkt(&self.wkt).map_err(failed)?);
        let transforms = if crs.is_geographic() {
            None
        } else {
            let geographic = traditional(crs.geog_cs().map_err(failed)?);
            let forward = CoordTransform::new(&geographic, &crs).map_err(failed)?;
            Some((forward, CoordTransform::new(&crs, &geographic).map_err(failed)?))
        };
        Ok(Projector { georeference: self, transforms })
    }

    /// The larger side of a pixel in units of the CRS.
    pub fn pixel_size(&self) -> f64 {
        let linear = self.linear();
        linear.x_axis.length().max(linear.y_axis.length())
    }

    /// Metres on the ground along a degree of the CRS's figure, or 1 for a projected CRS.
    pub fn metres_per_unit(&self) -> f64 {
        let crs = SpatialRef::from_wkt(&self.wkt).expect("this WKT came from GDAL");
        if crs.is_geographic() { crs.angular_units() * self.figure.equatorial_radius_m } else { crs.linear_units() }
    }

    /// Distance of pixels, along a meridian where they are angles.
    pub fn posting_m(&self) -> f64 {
        self.pixel_size() * self.metres_per_unit()
    }

    fn linear(&self) -> DMat2 {
        let g = self.geotransform;
        DMat2::from_cols(DVec2::new(g[1], g[4]), DVec2::new(g[2], g[5]))
    }

    fn crs_from_pixel(&self, pixel: DVec2) -> DVec2 {
        DVec2::new(self.geotransform[0], self.geotransform[3]) + self.linear() * (pixel + 0.5)
    }

    fn pixel_from_crs(&self, inverse: DMat2, at: DVec2) -> DVec2 {
        let pixel = inverse * (at - DVec2::new(self.geotransform[0], self.geotransform[3])) - 0.5;
        match self.period_columns {
            Some(period) => DVec2::new(pixel.x - period * ((pixel.x - self.middle_column) / period).round(), pixel.y),
            None => pixel,
        }
    }

    /// Columns around the body: the change of column per degree of longitude is the same at every
    /// latitude and longitude, and rows do not depend on longitude. Only unrotated rasters are tried.
    fn find_period(&self) -> Result<Option<f64>, Error> {
        if self.geotransform[2] != 0.0 || self.geotransform[4] != 0.0 {
            return Ok(None);
        }
        const STEP_DEG: f64 = 1.0;
        let at = |latitude_deg, longitude_deg| {
            self.figure.position_from_geodetic(Geodetic::from_degrees(latitude_deg, longitude_deg, 0.0))
        };
        let mut points = Vec::new();
        for latitude_deg in [-50.0, 0.0, 50.0] {
            for longitude_deg in [-130.5, -60.5, -3.5, 33.5, 121.5] {
                points.extend([at(latitude_deg, longitude_deg), at(latitude_deg, longitude_deg + STEP_DEG)]);
            }
        }
        let pixels = self.projector()?.pixels(&points);
        let steps: Vec<DVec2> = pixels.chunks(2).map(|pair| pair[1] - pair[0]).collect();
        let period = (steps[0].x * 360.0 / STEP_DEG).abs();
        let same = |step: &DVec2| (step.x - steps[0].x).abs() < 1e-6 * steps[0].x.abs() && step.y.abs() < 1e-6;
        Ok((period > 0.0 && steps.iter().all(same)).then_some(period))
    }
}

impl Longitude {
    fn of(geographic: &SpatialRef) -> Self {
        // An authority may name latitude first: longitude is whichever axis runs west.
        let west = (0..2).any(|axis| geographic.axis_orientation("GEOGCS", axis).is_ok_and(|o| o == WEST));
        let prime_meridian_deg =
            geographic.get_attr_value("PRIMEM", 1).ok().flatten().and_then(|text| text.parse::<f64>().ok());
        Self {
            sign: if west { -1.0 } else { 1.0 },
            prime_meridian_rad: prime_meridian_deg.unwrap_or(0.0).to_radians(),
            radians_per_unit: geographic.angular_units(),
        }
    }

    fn crs_from_east_rad(self, east_rad: f64) -> f64 {
        self.sign * (east_rad - self.prime_meridian_rad) / self.radians_per_unit
    }

    fn east_rad_from_crs(self, longitude: f64) -> f64 {
        self.sign * longitude * self.radians_per_unit + self.prime_meridian_rad
    }
}

/// `OGRAxisOrientation::OAO_West`.
const WEST: gdal::spatial_ref::AxisOrientationType = 4;

fn traditional(mut crs: SpatialRef) -> SpatialRef {
    crs.set_axis_mapping_strategy(AxisMappingStrategy::TraditionalGisOrder);
    crs
}

/// One thread's transformations between a body and a raster. PROJ takes 0.2 µs a point in a batch.
#[derive(Debug)]
pub struct Projector<'a> {
    georeference: &'a Georeference,
    /// Geographic to projected and back; none for a geographic raster.
    transforms: Option<(CoordTransform, CoordTransform)>,
}

impl Projector<'_> {
    /// Pixel coordinates of body-fixed points; NaN where the projection has no image.
    pub fn pixels(&self, points: &[Position<BodyFixed>]) -> Vec<DVec2> {
        let georeference = self.georeference;
        let (mut x, mut y): (Vec<f64>, Vec<f64>) = points
            .iter()
            .map(|&point| {
                let on_figure = georeference.figure.geodetic_from_position(point);
                let longitude = georeference.longitude.crs_from_east_rad(on_figure.longitude_east_rad);
                (longitude, on_figure.latitude_rad / georeference.longitude.radians_per_unit)
            })
            .unzip();
        if let Some((forward, _)) = &self.transforms {
            transform(forward, &mut x, &mut y);
        }
        let inverse = georeference.linear().inverse();
        x.iter().zip(&y).map(|(&x, &y)| georeference.pixel_from_crs(inverse, finite(DVec2::new(x, y)))).collect()
    }

    /// Latitude (on the CRS's figure) and east longitude of pixel coordinates, at height 0; NaN where
    /// the pixel lies outside the map of the body.
    pub fn geodetics(&self, pixels: &[DVec2]) -> Vec<Geodetic> {
        let georeference = self.georeference;
        let crs = pixels.iter().map(|&pixel| georeference.crs_from_pixel(pixel));
        let (mut x, mut y): (Vec<f64>, Vec<f64>) = crs.map(|at| (at.x, at.y)).unzip();
        if let Some((_, back)) = &self.transforms {
            transform(back, &mut x, &mut y);
        }
        let unit_rad = georeference.longitude.radians_per_unit;
        let geodetic = |(&x, &y)| {
            let at = finite(DVec2::new(x, y));
            Geodetic {
                // A pixel past the pole of a geographic raster is no place.
                latitude_rad: if (at.y * unit_rad).abs() > FRAC_PI_2 + 1e-9 { f64::NAN } else { at.y * unit_rad },
                longitude_east_rad: georeference.longitude.east_rad_from_crs(at.x),
                height_m: 0.0,
            }
        };
        x.iter().zip(&y).map(geodetic).collect()
    }

    /// The points above pixel coordinates at heights above the reference spheroid of `body`, each on the
    /// normal of the CRS's figure: those that [`Projector::pixels`] takes back to the same pixels.
    pub fn positions(&self, body: &Body, pixels: &[DVec2], heights_m: &[f64]) -> Vec<Position<BodyFixed>> {
        let figure = &self.georeference.figure;
        let above = |(on_figure, &height_m): (Geodetic, &f64)| {
            let mut above_figure = on_figure;
            // Normals of body and figure part by δ < 0.4°: each round leaves 1 − cos δ of the error.
            for _ in 0..3 {
                let point = figure.position_from_geodetic(above_figure);
                above_figure.height_m += height_m - body.geodetic_from_position(point).height_m;
            }
            figure.position_from_geodetic(above_figure)
        };
        self.geodetics(pixels).into_iter().zip(heights_m).map(above).collect()
    }
}

/// Points that fail come back infinite, and the call says so as an error: it concerns those points only.
fn transform(transform: &CoordTransform, x: &mut [f64], y: &mut [f64]) {
    let _ = transform.transform_coords(x, y, &mut []);
}

fn finite(at: DVec2) -> DVec2 {
    if at.is_finite() { at } else { DVec2::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The international foot is 0.3048 m; horizontally nothing changes.
    #[test]
    fn the_vertical_part_of_a_system_gives_the_unit_of_heights() {
        let flat = SpatialRef::from_proj4("+proj=stere +lat_0=-90 +R=1737400 +units=m").unwrap().to_wkt().unwrap();
        let vertical = "VERT_CS[\"height\",VERT_DATUM[\"sphere\",2005],UNIT[\"foot\",0.3048],AXIS[\"Up\",UP]]";
        let geotransform = [0.0, 10.0, 0.0, 0.0, 0.0, -10.0];
        let of = |wkt: &str| Georeference::new(wkt, geotransform, 10).unwrap();
        let compound = of(&format!("COMPD_CS[\"both\",{flat},{vertical}]"));
        assert_eq!((compound.height_unit_m, of(&flat).height_unit_m), (Some(0.3048), None));
        let named = flat.replacen("PROJCS[\"unknown\"", "PROJCS[\"Moon polar + height (ft)\"", 1);
        assert_eq!(of(&named).height_unit_m, Some(0.3048));
        let place =
            |georeference: &Georeference| georeference.projector().unwrap().geodetics(&[DVec2::new(5.0, 7.0)])[0];
        assert_eq!(place(&compound), place(&of(&flat)));
    }
}
