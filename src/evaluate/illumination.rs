//! Illumination of an area and of places as tables, plots and pictures.

use std::io::Cursor;

use image::{GrayImage, ImageFormat, Luma};

use super::plot::{Axis, Curve, Plot};
use super::report::Picture;
use super::{Error, Machine, Report, Table, Value};
use crate::illumination::place::{Moment, Summary};
use crate::illumination::{Maps, Place};

/// A place as it was named, with its light.
#[derive(Debug)]
pub struct Named<'a> {
    pub name: String,
    pub place: Place<'a>,
    pub moments: Vec<Moment>,
    pub summary: Summary,
}

/// What was mapped, and what was found.
#[derive(Debug)]
pub struct Findings<'a> {
    pub title: String,
    pub notes: Vec<String>,
    pub maps: &'a Maps,
    /// Area of a node.
    pub node_m2: f64,
    pub places: &'a [Named<'a>],
}

impl Findings<'_> {
    pub fn report(&self) -> Result<Report, Error> {
        let pictures = [
            ("lit_share", "Share of the time lit: black never, white always", &self.maps.lit_share, 1.0),
            (
                "disc_share",
                "Mean share of the Sun's light seen: black none, white all of it",
                &self.maps.disc_share,
                1.0,
            ),
            (
                "earth_share",
                "Share of the time with the Earth's centre in sight: black never, white always",
                &self.maps.earth_share,
                1.0,
            ),
            ("longest_night", "Longest night: black none, white 30 days and more", &self.maps.longest_night_h, 720.0),
        ];
        let pictures = pictures.map(|(name, caption, plane, white)| self.picture(name, caption, plane, white));
        Ok(Report {
            name: "illumination",
            title: self.title.clone(),
            machine: Machine::here(),
            notes: self.notes.clone(),
            tables: vec![self.area(), self.places_table()],
            plots: self.places.iter().map(sky).collect(),
            pictures: pictures.into_iter().collect::<Result<_, _>>()?,
        })
    }

    fn area(&self) -> Table {
        let columns = [("map", ""), ("smallest", ""), ("mean", ""), ("largest", ""), ("unit", "")];
        let mut table = Table::new("area", "The whole map", &columns);
        let maps = self.maps;
        let rows = [
            ("lit", &maps.lit_share, 100.0, "%"),
            ("share of the disc", &maps.disc_share, 100.0, "%"),
            ("longest night", &maps.longest_night_h, 1.0, "h"),
            ("Earth in sight", &maps.earth_share, 100.0, "%"),
        ];
        for (name, plane, scale, unit) in rows {
            let known = || plane.iter().map(|value| f64::from(*value)).filter(|value| value.is_finite());
            let mean = known().sum::<f64>() / known().count().max(1) as f64;
            let ends = [known().fold(f64::INFINITY, f64::min), mean, known().fold(f64::NEG_INFINITY, f64::max)];
            let mut row: Vec<Value> = vec![name.into()];
            row.extend(ends.map(|value| Value::from(scale * value)));
            row.push(unit.into());
            table.rows.push(row);
        }
        let never = maps.lit_share.iter().filter(|share| **share == 0.0).count() as f64 * self.node_m2;
        table.rows.push(vec!["never lit".into(), Value::Missing, (never * 1e-6).into(), Value::Missing, "km²".into()]);
        table
    }

    fn places_table(&self) -> Table {
        let columns =
            [("place", ""), ("lit", "%"), ("share of the disc", "%"), ("longest night", "h"), ("Earth in sight", "%")];
        let mut table = Table::new("places", "Places, by their traced skylines", &columns);
        for Named { name, summary, .. } in self.places {
            let numbers = [
                100.0 * summary.lit_share,
                100.0 * summary.disc_share,
                summary.longest_night_h,
                100.0 * summary.earth_share,
            ];
            table.rows.push(std::iter::once(name.as_str().into()).chain(numbers.map(Value::from)).collect());
        }
        table
    }

    fn picture(&self, name: &str, caption: &str, plane: &[f32], white: f32) -> Result<Picture, Error> {
        let grey: Vec<u8> =
            self.maps.rows_down(plane).iter().map(|value| (255.0 * (value / white).clamp(0.0, 1.0)) as u8).collect();
        let (columns, rows) = (self.maps.columns, self.maps.rows);
        let image = GrayImage::from_fn(columns as u32, rows as u32, |column, row| {
            Luma([grey[row as usize * columns + column as usize]])
        });
        let mut png = Cursor::new(Vec::new());
        image.write_to(&mut png, ImageFormat::Png).map_err(|source| Error::Png { name: name.to_owned(), source })?;
        Ok(Picture { name: name.into(), caption: caption.into(), png: png.into_inner() })
    }
}

/// The skyline of a place with what the Sun's centre covers of its sky.
fn sky(named: &Named) -> Plot {
    let deg = |angle_rad: f64| angle_rad.to_degrees();
    let skyline = named.place.skyline().map(|[azimuth_rad, elevation_rad]| [deg(azimuth_rad), deg(elevation_rad)]);
    let mut highest = vec![f64::NEG_INFINITY; 360];
    let mut lowest = vec![f64::INFINITY; 360];
    for moment in &named.moments {
        let bin = (deg(moment.sun_azimuth_rad) as usize).min(359);
        let elevation = deg(moment.sun_elevation_rad);
        (highest[bin], lowest[bin]) = (highest[bin].max(elevation), lowest[bin].min(elevation));
    }
    let curve = |name: &str, values: &[f64]| Curve {
        name: name.into(),
        points: (0..360).map(|bin| [bin as f64 + 0.5, values[bin]]).filter(|[_, value]| value.is_finite()).collect(),
        joined: true,
    };
    Plot {
        title: format!("Sky of {}", named.name),
        x: Axis::linear("azimuth [deg]"),
        y: Axis::linear("elevation [deg]"),
        curves: vec![
            Curve { name: "skyline".into(), points: skyline.collect(), joined: true },
            curve("highest Sun", &highest),
            curve("lowest Sun", &lowest),
        ],
    }
}
