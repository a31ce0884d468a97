//! What an elevation model is, in words a person can check: reference system, posting, where it lies, least and greatest height.

use glam::DVec2;
use serde::Serialize;

use crate::geometry::{Body, Geodetic};
use crate::raster::{Dem, Error, Georeference};

/// An elevation model as it is read: of a part, that part.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelFacts {
    /// Of the file.
    pub name: String,
    /// Of the reference system.
    pub crs: String,
    pub posting_m: f64,
    pub columns: usize,
    pub rows: usize,
    pub extent: Option<Extent>,
    /// Least and greatest; `None`: not looked through.
    pub heights_m: Option<[f64; 2]>,
    pub share_without_heights: f64,
}

/// Where ground lies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Extent {
    /// South and north.
    pub latitude_deg: [f64; 2],
    /// From west to east, the west in 0 to 360.
    pub longitude_deg: [f64; 2],
}

/// Places along a side of a raster at which it is asked where it lies.
const ALONG: usize = 33;

impl ModelFacts {
    pub fn of(body: &Body, name: String, dem: &Dem) -> Result<Self, Error> {
        let known = dem.heights_m.iter().filter(|height_m| !height_m.is_nan());
        let start = (0_usize, [f64::INFINITY, f64::NEG_INFINITY]);
        let (count, heights_m) = known.fold(start, |(count, [low, high]), &height_m| {
            (count + 1, [low.min(height_m.into()), high.max(height_m.into())])
        });
        let all = dem.heights_m.len().max(1) as f64;
        Ok(Self {
            heights_m: (count > 0).then_some(heights_m),
            share_without_heights: 1.0 - count as f64 / all,
            ..Self::unread(body, name, &dem.georeference, [dem.columns, dem.rows])?
        })
    }

    /// Of a raster whose heights are not looked through.
    pub fn unread(
        body: &Body,
        name: String,
        georeference: &Georeference,
        [columns, rows]: [usize; 2],
    ) -> Result<Self, Error> {
        Ok(Self {
            name,
            crs: georeference.figure.name.clone(),
            posting_m: georeference.posting_m(),
            columns,
            rows,
            extent: Extent::of_raster(body, georeference, [columns, rows])?,
            heights_m: None,
            share_without_heights: 0.0,
        })
    }
}

impl Extent {
    /// In latitudes of `body`, whatever figure the raster has; `None` where the raster shows no place of it.
    pub fn of_raster(
        body: &Body,
        georeference: &Georeference,
        [columns, rows]: [usize; 2],
    ) -> Result<Option<Self>, Error> {
        let size = DVec2::new(columns as f64, rows as f64);
        let share = |index: usize| index as f64 / (ALONG - 1) as f64;
        let at = |index: usize| DVec2::new(share(index % ALONG), share(index / ALONG)) * size - 0.5;
        let pixels: Vec<DVec2> = (0..ALONG * ALONG).map(at).collect();
        let projector = georeference.projector()?;
        let points = projector.positions(body, &pixels, &vec![0.0; pixels.len()]);
        let known = points.iter().filter(|point| point.vector_m().is_finite());
        let places: Vec<Geodetic> = known.map(|point| body.geodetic_from_position(*point)).collect();
        let poles = [-90.0, 90.0].map(|latitude_deg| Geodetic::from_degrees(latitude_deg, 0.0, 0.0));
        let poles = poles.map(|pole| body.position_from_geodetic(pole));
        let inside =
            |pixel: &DVec2| pixel.cmpge(DVec2::splat(-0.5)).all() && pixel.cmple(size - 0.5).all() && pixel.is_finite();
        let holds_pole: Vec<bool> = projector.pixels(&poles).iter().map(inside).collect();
        Ok(Self::around(&places, [holds_pole[0], holds_pole[1]]))
    }

    /// The least that holds all places; whoever holds a pole holds all longitudes.
    pub fn around(places: &[Geodetic], holds_pole: [bool; 2]) -> Option<Self> {
        let known: Vec<_> = places.iter().filter(|place| place.latitude_rad.is_finite()).collect();
        let latitudes = known.iter().map(|place| place.latitude_rad.to_degrees());
        let [mut south, mut north] = latitudes.fold([f64::INFINITY, f64::NEG_INFINITY], |[south, north], latitude| {
            [south.min(latitude), north.max(latitude)]
        });
        if south > north {
            return None;
        }
        if holds_pole[0] {
            south = -90.0;
        }
        if holds_pole[1] {
            north = 90.0;
        }
        let mut longitudes: Vec<f64> =
            known.iter().map(|place| place.longitude_east_rad.to_degrees().rem_euclid(360.0)).collect();
        longitudes.sort_by(f64::total_cmp);
        let longitude_deg = if holds_pole.contains(&true) { [0.0, 360.0] } else { arc(&longitudes) };
        Some(Self { latitude_deg: [south, north], longitude_deg })
    }

    /// What holds both.
    pub fn with(self, other: Self) -> Self {
        let corners = |extent: &Self| {
            let [south, north] = extent.latitude_deg;
            let [west, east] = extent.longitude_deg;
            // Close enough together that the widest gap is the one between the extents.
            let step = |index: usize| west + (east - west) * index as f64 / (ALONG - 1) as f64;
            let at =
                move |index: usize| [south, north].map(|latitude| Geodetic::from_degrees(latitude, step(index), 0.0));
            (0..ALONG).flat_map(at).collect::<Vec<_>>()
        };
        let places = [corners(&self), corners(&other)].concat();
        Self::around(&places, [false; 2]).unwrap_or(self)
    }
}

/// The shortest arc that holds all of some sorted longitudes; the whole circle where they stand all around.
fn arc(sorted: &[f64]) -> [f64; 2] {
    /// Farther apart than neighbours of a raster that goes all around.
    const GAP_DEG: f64 = 1.5 * 360.0 / (ALONG - 1) as f64;
    let [Some(&first), Some(&last)] = [sorted.first(), sorted.last()] else { return [0.0, 360.0] };
    let mut widest = (first + 360.0 - last, [first, last]);
    for pair in sorted.windows(2) {
        if pair[1] - pair[0] > widest.0 {
            widest = (pair[1] - pair[0], [pair[1], pair[0] + 360.0]);
        }
    }
    if widest.0 < GAP_DEG { [0.0, 360.0] } else { widest.1 }
}

impl std::fmt::Display for Extent {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let [south, north] = self.latitude_deg;
        let [west, east] = self.longitude_deg;
        let digits = if north - south < 0.02 { 5 } else { 3 };
        write!(f, "latitude {south:.digits$} to {north:.digits$}, ")?;
        match east - west {
            whole if whole >= 360.0 => f.write_str("all longitudes"),
            _ => write!(
                f,
                "longitude {west:.digits$} to {:.digits$} east",
                if east > 360.0 { east - 360.0 } else { east }
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent(definition: &str, geotransform: [f64; 6], size: [usize; 2]) -> Extent {
        let georeference = Georeference::new(definition, geotransform, size[0]).unwrap();
        Extent::of_raster(&Body::moon(), &georeference, size).unwrap().unwrap()
    }

    const MOON: &str = "+proj=longlat +R=1737400 +no_defs";
    const POLE: &str = "+proj=stere +lat_0=-90 +R=1737400 +units=m +no_defs";

    #[test]
    fn a_map_across_the_antimeridian_or_longitude_0_is_not_the_whole_body() {
        for (west, expected) in [(170.0, [170.0, 190.0]), (-10.0, [350.0, 370.0]), (10.0, [10.0, 30.0])] {
            let found = extent(MOON, [west, 1.0, 0.0, 5.0, 0.0, -1.0], [20, 10]);
            assert!((found.latitude_deg[0] + 5.0).abs() < 1e-9 && (found.latitude_deg[1] - 5.0).abs() < 1e-9);
            let error = found.longitude_deg.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(error < 1e-9, "{found:?}");
        }
        let whole = extent(MOON, [-180.0, 1.0, 0.0, 90.0, 0.0, -1.0], [360, 180]);
        assert_eq!(whole.longitude_deg, [0.0, 360.0]);
        assert!(whole.to_string().ends_with("all longitudes"), "{whole}");
    }

    /// 2 atan(r/2R) from the pole: corners of a square of 20 km about it are 0.466° away.
    #[test]
    fn a_map_about_the_pole_holds_it() {
        let found = extent(POLE, [-10_000.0, 100.0, 0.0, 10_000.0, 0.0, -100.0], [200, 200]);
        assert_eq!((found.latitude_deg[0], found.longitude_deg), (-90.0, [0.0, 360.0]));
        assert!((found.latitude_deg[1] + 89.5336).abs() < 1e-3, "{found:?}");
        let beside = extent(POLE, [10_000.0, 100.0, 0.0, 10_000.0, 0.0, -100.0], [200, 200]);
        assert!(beside.latitude_deg[0] > -90.0 && beside.longitude_deg[1] - beside.longitude_deg[0] < 91.0);
    }

    #[test]
    fn two_extents_are_joined_the_short_way_round() {
        let one = Extent { latitude_deg: [0.0, 1.0], longitude_deg: [350.0, 355.0] };
        let other = Extent { latitude_deg: [2.0, 3.0], longitude_deg: [5.0, 10.0] };
        let both = one.with(other);
        assert_eq!(both.longitude_deg, [350.0, 370.0]);
        assert!(both.latitude_deg[0] == 0.0 && (both.latitude_deg[1] - 3.0).abs() < 1e-12, "{both:?}");
    }
}
