//! Crater lists in comma-separated values, quoted after RFC 4180 ([`crate::text`]).
//!
//! The first line names the columns, in any order; others are passed over. One of two sets must be there:
//!
//! | ours | Robbins (2018) | |
//! |---|---|---|
//! | `id` | `CRATER_ID` | |
//! | `latitude_deg`, `longitude_deg` | `LAT_ELLI_IMG`, `LON_ELLI_IMG`, else `LAT_CIRC_IMG`, `LON_CIRC_IMG` | east longitude |
//! | `diameter_m` | `DIAM_ELLI_MAJOR_IMG`, else `DIAM_CIRC_IMG`, in km | the longest one |
//! | `minor_diameter_m`, optional | `DIAM_ELLI_MINOR_IMG`, in km | |
//! | `azimuth_deg`, optional | 90° − `DIAM_ELLI_ANGLE_IMG` | of the longest one, clockwise from north |
//! | `depth_m`, `degradation`, `buried`, optional | | |
//!
//! A line whose ellipse is not given (Robbins leaves it empty where an arc is too short) takes the circle.
//!
//! # Assumptions
//! Robbins' angle is counter-clockwise from east, as Christian et al. (2021) read it.
//!
//! # References
//! Robbins (2019), JGR Planets 124, 871, doi:10.1029/2018JE005592: 1.3 million lunar craters of 1 km and more.

use std::path::{Path, PathBuf};

use super::{Crater, Origin};
use crate::geometry::Geodetic;
use crate::text::{self, Heading, Table, TableError};

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error("cannot read the crater list {path}: {source}")]
    Read { path: PathBuf, source: std::io::Error },
    #[error(
        "{path}:1: has no column {missing}; want id, latitude_deg, longitude_deg, diameter_m, or Robbins' CRATER_ID, \
         LAT_CIRC_IMG, LON_CIRC_IMG, DIAM_CIRC_IMG"
    )]
    NoColumn { path: PathBuf, missing: &'static str },
    #[error("{path}:{line}: {column} = {got:?} is not a number within {allowed}")]
    Number { path: PathBuf, line: usize, column: String, got: String, allowed: &'static str },
    #[error("{path}:{line}: has {got} fields, its header has {want}")]
    Fields { path: PathBuf, line: usize, got: usize, want: usize },
    #[error("{path}:{line}: the shortest diameter {minor_m} m is longer than the longest, {major_m} m")]
    Axes { path: PathBuf, line: usize, minor_m: f64, major_m: f64 },
    #[error("{path}: {source}")]
    Table { path: PathBuf, source: TableError },
    #[error("{path} lists no craters")]
    Empty { path: PathBuf },
}

/// The craters of a list, in its order. Each id begins with `prefix`.
pub fn read(path: &Path, prefix: &str, origin: Origin) -> Result<Vec<Crater>, Error> {
    let text = text::read(path).map_err(|source| Error::Read { path: path.into(), source })?;
    parse(path, &text, prefix, origin)
}

/// As [`read`]; a list may be empty where `origin` is not a catalogue: a terrain may hold no crater.
pub fn parse(path: &Path, text: &str, prefix: &str, origin: Origin) -> Result<Vec<Crater>, Error> {
    let table =
        Table::parse(text, Heading::Needed, None).map_err(|source| Error::Table { path: path.into(), source })?;
    let header: Vec<&str> = table.heading.iter().flat_map(|heading| &heading.fields).map(String::as_str).collect();
    let columns = Columns::find(path, &header)?;
    let crater = |row: &text::Row| {
        let fields: Vec<&str> = row.fields.iter().map(String::as_str).collect();
        if fields.len() != header.len() {
            return Err(Error::Fields { path: path.into(), line: row.line, got: fields.len(), want: header.len() });
        }
        columns.crater(&Row { path, line: row.line, header: &header, fields: &fields }, prefix, origin)
    };
    let craters: Vec<Crater> = table.rows.iter().map(crater).collect::<Result<_, _>>()?;
    match (origin, craters.is_empty()) {
        (Origin::Catalogue, true) => Err(Error::Empty { path: path.into() }),
        _ => Ok(craters),
    }
}

const LATITUDES: &str = "[-90, 90] deg";
const LONGITUDES: &str = "[-360, 360] deg";
const DIAMETERS: &str = "(0, 1e7] m, or (0, 1e4] km";
const ANGLES: &str = "[-360, 360] deg";

/// Where the columns of one of the two sets are.
struct Columns {
    id: usize,
    /// Latitude, longitude, diameter; the first set whose fields are given is taken.
    places: Vec<[usize; 3]>,
    minor: Option<usize>,
    /// Clockwise from north, or counter-clockwise from east.
    angle: Option<usize>,
    robbins: bool,
    depth: Option<usize>,
    degradation: Option<usize>,
    buried: Option<usize>,
}

impl Columns {
    fn find(path: &Path, header: &[&str]) -> Result<Self, Error> {
        let at = |name: &str| header.iter().position(|column| column.eq_ignore_ascii_case(name));
        let needed = |name: &'static str| at(name).ok_or_else(|| Error::NoColumn { path: path.into(), missing: name });
        let robbins = at("CRATER_ID").is_some();
        let place = |names: [&'static str; 3]| -> Result<[usize; 3], Error> {
            Ok([needed(names[0])?, needed(names[1])?, needed(names[2])?])
        };
        let mut places = Vec::new();
        if robbins {
            places.extend(place(["LAT_ELLI_IMG", "LON_ELLI_IMG", "DIAM_ELLI_MAJOR_IMG"]).ok());
            let circle = place(["LAT_CIRC_IMG", "LON_CIRC_IMG", "DIAM_CIRC_IMG"]);
            // A list cut down to its ellipses is whole.
            places.extend(if places.is_empty() { Some(circle?) } else { circle.ok() });
        } else {
            places.push(place(["latitude_deg", "longitude_deg", "diameter_m"])?);
        }
        Ok(Self {
            id: needed(if robbins { "CRATER_ID" } else { "id" })?,
            places,
            minor: at(if robbins { "DIAM_ELLI_MINOR_IMG" } else { "minor_diameter_m" }),
            angle: at(if robbins { "DIAM_ELLI_ANGLE_IMG" } else { "azimuth_deg" }),
            robbins,
            depth: at("depth_m"),
            degradation: at("degradation"),
            buried: at("buried"),
        })
    }

    fn crater(&self, row: &Row, prefix: &str, origin: Origin) -> Result<Crater, Error> {
        let given = |place: &&[usize; 3]| place.iter().all(|&column| !row.fields[column].is_empty());
        let chosen = self.places.iter().find(given).unwrap_or(&self.places[self.places.len() - 1]);
        // Robbins' first set is the ellipse, his second the circle.
        let is_ellipse = !self.robbins || std::ptr::eq(chosen, &self.places[0]) && self.minor.is_some();
        let unit_m = if self.robbins { 1000.0 } else { 1.0 };
        let [latitude, longitude, major] = *chosen;
        let major_m = unit_m * row.number(major, 1e-9, 1e7, DIAMETERS)?;
        let optional = |column: Option<usize>| column.filter(|&column| is_ellipse && !row.fields[column].is_empty());
        let minor_m = match optional(self.minor) {
            Some(minor) => unit_m * row.number(minor, 1e-9, 1e7, DIAMETERS)?,
            None => major_m,
        };
        if minor_m > major_m * (1.0 + 1e-9) {
            return Err(Error::Axes { path: row.path.into(), line: row.line, minor_m, major_m });
        }
        let angle_deg = match optional(self.angle) {
            Some(angle) => row.number(angle, -360.0, 360.0, ANGLES)?,
            None => 0.0,
        };
        let told = |column: Option<usize>, allowed| match column.filter(|&column| !row.fields[column].is_empty()) {
            Some(column) => row.number(column, 0.0, 1e6, allowed).map(Some),
            None => Ok(None),
        };
        let azimuth_deg = if self.robbins { 90.0 - angle_deg } else { angle_deg };
        Ok(Crater {
            id: format!("{prefix}{}", row.fields[self.id]),
            centre: Geodetic::from_degrees(
                row.number(latitude, -90.0, 90.0, LATITUDES)?,
                row.number(longitude, -360.0, 360.0, LONGITUDES)?,
                0.0,
            ),
            diameters_m: [major_m, minor_m],
            azimuth_rad: azimuth_deg.to_radians(),
            depth_m: told(self.depth, "[0, 1e6] m")?,
            degradation: told(self.degradation, "[0, 1e6]")?,
            buried: told(self.buried, "0 or 1")?.is_some_and(|buried| buried != 0.0),
            origin,
        })
    }
}

/// One line of a list.
struct Row<'a> {
    path: &'a Path,
    line: usize,
    header: &'a [&'a str],
    fields: &'a [&'a str],
}

impl Row<'_> {
    fn number(&self, column: usize, low: f64, high: f64, allowed: &'static str) -> Result<f64, Error> {
        let got = self.fields[column];
        let number = got.parse().ok().filter(|number| (low..=high).contains(number));
        number.ok_or_else(|| Error::Number {
            path: self.path.into(),
            line: self.line,
            column: self.header[column].into(),
            got: got.into(),
            allowed,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<Vec<Crater>, Error> {
        parse(Path::new("list.csv"), text, "", Origin::Catalogue)
    }

    /// The first ellipse is 2 km by 1 km with its long axis to the north-east; the second has none.
    #[test]
    fn robbins_columns_are_read_in_his_units() {
        let text = "CRATER_ID,LAT_CIRC_IMG,LON_CIRC_IMG,LAT_ELLI_IMG,LON_ELLI_IMG,DIAM_CIRC_IMG,DIAM_ELLI_MAJOR_IMG,\
                    DIAM_ELLI_MINOR_IMG,DIAM_ELLI_ANGLE_IMG\n\
                    00-1-000000,-19.8,264.7,-19.9,264.8,1.5,2.0,1.0,45\n00-1-000001,10,20,,,3.5,,,\n";
        let craters = parsed(text).unwrap();
        assert_eq!((craters[0].id.as_str(), craters[0].diameters_m), ("00-1-000000", [2000.0, 1000.0]));
        assert!((craters[0].azimuth_rad.to_degrees() - 45.0).abs() < 1e-12);
        assert!((craters[0].centre.latitude_rad.to_degrees() + 19.9).abs() < 1e-12);
        assert_eq!(craters[1].diameters_m, [3500.0; 2]);
        assert!((craters[1].centre.longitude_east_rad.to_degrees() - 20.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_wrong_with_a_list_is_said_with_line_and_column() {
        let said = |text: &str| parsed(text).unwrap_err().to_string();
        let header = "id,latitude_deg,longitude_deg,diameter_m,minor_diameter_m\n";
        assert!(said("name,diameter\n").contains("list.csv:1: has no column latitude_deg; want id"));
        assert!(said(header).contains("lists no craters"));
        assert_eq!(
            said(&format!("{header}1,95,0,10,\n")),
            "list.csv:2: latitude_deg = \"95\" is not a number within [-90, 90] deg"
        );
        assert!(said(&format!("{header}1,9,0,10,10\n2,9,0,x,1\n")).contains("list.csv:3: diameter_m = \"x\""));
        assert!(said(&format!("{header}1,9,0,10\n")).contains("list.csv:2: has 4 fields, its header has 5"));
        assert!(said(&format!("{header}1,9,0,10,11\n")).contains("shortest diameter 11 m is longer"));
    }
}
