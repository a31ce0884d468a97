//! Areas as arguments: a circle, a polygon, or a file of them.

use std::path::Path;

use perilune_engine::geometry::Geodetic;
use perilune_engine::illumination::Area;
use perilune_engine::text::{self, Heading, Row, Table, column_name};
use serde_json::Value as Json;

use crate::cli::place;

/// An area with its name.
#[derive(Debug, Clone)]
pub struct NamedArea {
    pub name: String,
    pub area: Area,
}

const WANT: &str = "want a circle LAT,LON,RADIUS_M, a polygon 'LAT,LON;LAT,LON;LAT,LON', or a file of areas";

/// The areas that an argument means; a file may hold several.
pub fn areas(text: &str) -> Result<Vec<NamedArea>, String> {
    let path = Path::new(text);
    if path.is_file() {
        return of_file(path).map_err(|what| format!("{text}: {what}"));
    }
    let named = |area: Area| vec![NamedArea { name: text.replace(';', " "), area }];
    let corners: Vec<&str> = text.split(';').map(str::trim).collect();
    match corners[..] {
        [circle] if circle.split(',').count() == 3 => {
            let (centre, radius) = circle.rsplit_once(',').ok_or(WANT)?;
            let radius_m = radius.trim().parse().ok().filter(|radius| (1.0..1e6).contains(radius));
            let radius_m = radius_m.ok_or_else(|| format!("--area {text}: want a radius in [1, 1e6] m"))?;
            Ok(named(Area::Circle { centre: place(centre)?, radius_m }))
        }
        [_, _, _, ..] => Ok(named(Area::Polygon(vec![corners.into_iter().map(place).collect::<Result<_, _>>()?]))),
        _ => Err(format!("--area {text} is no file: {WANT}")),
    }
}

/// GeoJSON, or the corners of one polygon as a table: latitude, longitude, where no heading says otherwise.
fn of_file(path: &Path) -> Result<Vec<NamedArea>, String> {
    let text = text::read(path).map_err(|error| error.to_string())?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if text.trim_start().starts_with('{') {
        let json: Json = serde_json::from_str(&text).map_err(|error| error.to_string())?;
        return of_geojson(&json, &name);
    }
    let table = Table::parse(&text, Heading::Optional, Some('#')).map_err(|error| error.to_string())?;
    let [latitude, longitude] = table.heading.as_ref().map_or(Ok([0, 1]), columns)?;
    let corner = |row: &Row| {
        let written = || row.fields.join(",");
        let [_, _] = &row.fields[..] else {
            return Err(format!("line {}: {:?} is not two numbers", row.line, written()));
        };
        place(&format!("{},{}", row.fields[latitude], row.fields[longitude]))
            .map_err(|want| format!("line {}: {:?}: {want}", row.line, written()))
    };
    let ring = table.rows.iter().map(corner).collect::<Result<Vec<_>, _>>()?;
    if ring.len() < 3 {
        return Err(format!("{} corners; a polygon has 3 or more lines LAT,LON", ring.len()));
    }
    Ok(vec![NamedArea { name, area: Area::Polygon(vec![ring]) }])
}

/// Names of columns, as [`column_name`] writes them.
const LATITUDES: [&str; 5] = ["latitude", "latitude_deg", "lat", "lat_deg", "latitude_degrees"];
const LONGITUDES: [&str; 11] = [
    "longitude",
    "longitude_deg",
    "lon",
    "lon_deg",
    "long",
    "lng",
    "longitude_degrees",
    "longitude_east",
    "longitude_east_deg",
    "lon_east",
    "lon_east_deg",
];

/// Where latitude and longitude stand under a heading.
fn columns(heading: &Row) -> Result<[usize; 2], String> {
    let names: Vec<String> = heading.fields.iter().map(|name| column_name(name)).collect();
    let is_of = |index: usize, known: &[&str]| names.get(index).is_some_and(|name| known.contains(&name.as_str()));
    let places = [[0, 1], [1, 0]];
    let found =
        places.into_iter().find(|[latitude, longitude]| is_of(*latitude, &LATITUDES) && is_of(*longitude, &LONGITUDES));
    found.filter(|_| names.len() == 2).ok_or_else(|| {
        let (got, latitudes, longitudes) = (heading.fields.join(", "), LATITUDES.join(", "), LONGITUDES.join(", "));
        format!(
            "line {} has the names {got}; allowed are two, one of {latitudes} and one of {longitudes}",
            heading.line
        )
    })
}

/// Polygons, alone or as features; coordinates are longitude, latitude.
fn of_geojson(json: &Json, name: &str) -> Result<Vec<NamedArea>, String> {
    let list = |key: &str| json[key].as_array().ok_or_else(|| format!("no list of {key}"));
    match json["type"].as_str().unwrap_or_default() {
        "FeatureCollection" => {
            let feature = |(index, feature)| of_geojson(feature, &format!("{name} {}", index + 1));
            Ok(list("features")?.iter().enumerate().map(feature).collect::<Result<Vec<_>, _>>()?.concat())
        }
        "Feature" => of_geojson(&json["geometry"], json["properties"]["name"].as_str().unwrap_or(name)),
        "Polygon" => Ok(vec![polygon(list("coordinates")?.iter(), name)?]),
        "MultiPolygon" => {
            let polygons = list("coordinates")?;
            Ok(vec![polygon(polygons.iter().flat_map(|rings| rings.as_array().into_iter().flatten()), name)?])
        }
        other => Err(format!("type {other:?}; allowed are FeatureCollection, Feature, Polygon, MultiPolygon")),
    }
}

fn polygon<'a>(rings: impl Iterator<Item = &'a Json>, name: &str) -> Result<NamedArea, String> {
    let corner = |corner: &Json| match (corner[0].as_f64(), corner[1].as_f64()) {
        (Some(longitude), Some(latitude)) => place(&format!("{latitude},{longitude}")),
        _ => Err(format!("the corner {corner} is not [longitude, latitude]")),
    };
    let ring = |ring: &Json| {
        let corners: Vec<Geodetic> =
            ring.as_array().into_iter().flatten().map(corner).collect::<Result<_, String>>()?;
        if corners.len() < 3 { Err(format!("a ring of {} corners", corners.len())) } else { Ok(corners) }
    };
    let rings = rings.map(ring).collect::<Result<Vec<_>, String>>()?;
    if rings.is_empty() {
        return Err("a polygon without a ring".into());
    }
    Ok(NamedArea { name: name.into(), area: Area::Polygon(rings) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> Result<Vec<NamedArea>, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("site.txt");
        std::fs::write(&path, text).unwrap();
        areas(path.to_str().unwrap())
    }

    fn corners(named: &NamedArea) -> usize {
        let Area::Polygon(rings) = &named.area else { panic!("{named:?}") };
        rings.iter().map(Vec::len).sum()
    }

    #[test]
    fn circles_polygons_and_files_are_told_apart() {
        let circle = areas("-89.45,222.69,500").unwrap();
        assert!(matches!(circle[0].area, Area::Circle { radius_m: 500.0, .. }));
        assert_eq!(corners(&areas("-89.4,220; -89.4,225; -89.5,222").unwrap()[0]), 3);
        let Area::Polygon(swapped) = &file("\u{feff}Lon;Lat\r220;-89.4\r225;-89.4\r222;-89.5").unwrap()[0].area else {
            panic!()
        };
        assert!((swapped[0][0].latitude_rad.to_degrees() + 89.4).abs() < 1e-9);
        let csv = file("latitude,longitude\n-89.4,220\n-89.4,225\n\n-89.5,222\n").unwrap();
        assert_eq!((corners(&csv[0]), csv[0].name.as_str()), (3, "site"));
    }

    #[test]
    fn geojson_has_longitudes_first_and_names() {
        let ring = "[[220,-89.4],[225,-89.4],[222,-89.5],[220,-89.4]]";
        let one = format!(r#"{{"type":"Polygon","coordinates":[{ring}]}}"#);
        let Area::Polygon(rings) = &file(&one).unwrap()[0].area else { panic!() };
        assert!((rings[0][0].latitude_rad.to_degrees() + 89.4).abs() < 1e-9);
        let feature = format!(r#"{{"type":"Feature","properties":{{"name":"pad"}},"geometry":{one}}}"#);
        let all = format!(r#"{{"type":"FeatureCollection","features":[{feature},{feature}]}}"#);
        let read = file(&all).unwrap();
        assert_eq!((read.len(), read[1].name.as_str(), corners(&read[1])), (2, "pad", 4));
    }

    #[test]
    fn what_is_no_area_is_said() {
        for (text, word) in [
            ("-89,30", "is no file"),
            ("-89,30,0", "radius"),
            ("-89,30;-89,40", "is no file"),
            ("-99,30;-89,40;-89,50", "latitude"),
        ] {
            let error = areas(text).unwrap_err();
            assert!(error.contains(word), "{text}: {error}");
        }
        for (text, word) in [
            (r#"{"type":"Point","coordinates":[1,2]}"#, "Point"),
            ("-89,30\n-89,31\n", "2 corners"),
            ("a,b\n-89,30\n", "the names a, b; allowed are two, one of latitude"),
            ("lat,lon\n-89,30\nhere\n", "line 3: \"here\""),
            ("-89,3O\n-89,31\n-88,31\n", "line 1: \"-89,3O\""),
            ("-89,30,x\n-89,31,x\n-88,31,x\n", "line 1: \"-89,30,x\""),
            (r#"{"type":"Polygon","coordinates":[]}"#, "without a ring"),
            (r#"{"type":"Polygon","coordinates":[[[1,2],["x",2],[3,4]]]}"#, "not [longitude, latitude]"),
        ] {
            let error = file(text).unwrap_err();
            assert!(error.contains(word), "{text}: {error}");
        }
    }
}
