//! Names of made terrain: all that shapes it, as a text of its own, hashed.
//!
//! The text is spelled out here, so that neither a renamed field nor another derive gives users' terrain another name. Numbers
//! are written as Rust's `{:?}` writes them: the shortest text that gives the same number.

use crate::digest::sha256_hex;
use crate::geometry::{Body, Geodetic};
use crate::raster::Reading;
use crate::scenario::{Dem, Globe, Values};
use crate::terrain::synthetic::{Parameters, Projection};

/// A name and its members, as in `Geodetic { height_m: 0.0 }`.
fn record(name: &str, members: &[(&str, String)]) -> String {
    let members: Vec<String> = members.iter().map(|(name, value)| format!("{name}: {value}")).collect();
    format!("{name} {{ {} }}", members.join(", "))
}

fn option(value: Option<String>) -> String {
    value.map_or("None".into(), |value| format!("Some({value})"))
}

fn number(value: f64) -> String {
    format!("{value:?}")
}

pub fn of_body(body: &Body) -> String {
    record(
        "Body",
        &[
            ("name", format!("{:?}", body.name)),
            ("naif_id", body.naif_id.to_string()),
            ("equatorial_radius_m", number(body.equatorial_radius_m)),
            ("polar_radius_m", number(body.polar_radius_m)),
        ],
    )
}

fn of_point(point: &Geodetic) -> String {
    record(
        "Geodetic",
        &[
            ("latitude_rad", number(point.latitude_rad)),
            ("longitude_east_rad", number(point.longitude_east_rad)),
            ("height_m", number(point.height_m)),
        ],
    )
}

/// The text of a synthetic model's parameters.
pub fn of_parameters(parameters: Option<&Parameters>) -> String {
    let text = |of: &Parameters| {
        let projection = match of.projection {
            Projection::Gnomonic => "Gnomonic",
            Projection::PolarStereographic => "PolarStereographic",
            Projection::Equirectangular => "Equirectangular",
            Projection::Orthographic => "Orthographic",
        };
        record(
            "Parameters",
            &[
                ("columns", of.columns.to_string()),
                ("rows", of.rows.to_string()),
                ("posting_m", number(of.posting_m)),
                ("seed", of.seed.to_string()),
                ("centre", of_point(&of.centre)),
                ("projection", projection.into()),
                ("largest_m", number(of.largest_m)),
                ("smallest_m", number(of.smallest_m)),
                ("density", number(of.density)),
                ("exponent", number(of.exponent)),
                ("relief_m", number(of.relief_m)),
                ("roughness", number(of.roughness)),
            ],
        )
    };
    option(parameters.map(text))
}

/// The key of synthetic detail on a measured model with that digest.
pub fn of_detail(body: &Body, detail: &Dem, continued: Option<&Dem>, digest: Option<&str>) -> String {
    let (version, body, digest) =
        (env!("CARGO_PKG_VERSION"), of_body(body), digest.map(|digest| format!("{digest:?}")));
    let shape = format!("{version} {body} {} {} {}", of_dem(detail), option(continued.map(of_dem)), option(digest));
    sha256_hex(shape.as_bytes())
}

fn of_dem(dem: &Dem) -> String {
    let size = |size_m: &Option<f64>| option(size_m.map(number));
    match dem {
        Dem::File { path, reading, values, posting_m, extent_m } => record(
            "File",
            &[
                ("path", format!("{path:?}") + &of_reading(reading)),
                ("values", of_values(*values).into()),
                ("posting_m", size(posting_m)),
                ("extent_m", size(extent_m)),
            ],
        ),
        Dem::Synthetic { columns, rows, posting_m, centre, seed } => record(
            "Synthetic",
            &[
                ("columns", columns.to_string()),
                ("rows", rows.to_string()),
                ("posting_m", number(*posting_m)),
                ("centre", of_point(centre)),
                ("seed", seed.to_string()),
            ],
        ),
        Dem::Detail { posting_m, extent_m, centre, seed, craters, boulders_per_km2 } => record(
            "Detail",
            &[
                ("posting_m", number(*posting_m)),
                ("extent_m", number(*extent_m)),
                ("centre", option(centre.as_ref().map(of_point))),
                ("seed", seed.to_string()),
                ("craters", number(*craters)),
                ("boulders_per_km2", number(*boulders_per_km2)),
            ],
        ),
        Dem::Cube { path, reading, values, posting_m } => record(
            "Cube",
            &[
                ("path", format!("{path:?}") + &of_reading(reading)),
                ("values", of_values(*values).into()),
                ("posting_m", size(posting_m)),
            ],
        ),
        Dem::Globe(globe) => format!("Globe({})", of_globe(globe)),
    }
}

fn of_globe(globe: &Globe) -> String {
    record(
        "Globe",
        &[
            ("path", format!("{:?}", globe.path) + &of_reading(&globe.reading)),
            ("values", of_values(globe.values).into()),
            ("posting_m", option(globe.posting_m.map(number))),
            ("tiles", option(globe.tiles.as_ref().map(|tiles| format!("{tiles:?}")))),
            ("posting_px", number(globe.posting_px)),
            ("most_tiles", globe.most_tiles.to_string()),
        ],
    )
}

/// Nothing where the file alone says how it is read, as in version 0.1.
fn of_reading(reading: &Reading) -> String {
    if *reading == Reading::default() {
        return String::new();
    }
    let Reading { band, nodata, scale, offset, unit, crs } = reading;
    let members = [
        ("band", option(band.map(|band| band.to_string()))),
        ("nodata", option(nodata.map(number))),
        ("scale", option(scale.map(number))),
        ("offset", option(offset.map(number))),
        ("unit", option(unit.as_ref().map(|unit| format!("{unit:?}")))),
        ("crs", option(crs.as_ref().map(|crs| format!("{crs:?}")))),
    ];
    format!(", reading: {}", record("Reading", &members))
}

fn of_values(values: Values) -> &'static str {
    match values {
        Values::Auto => "Auto",
        Values::Height => "Height",
        Values::Radius => "Radius",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Texts of version 0.1, which name terrain that users have.
    #[test]
    fn texts_of_keys_stay_as_they_are() {
        let moon = "Body { name: \"moon\", naif_id: 301, equatorial_radius_m: 1737400.0, polar_radius_m: 1737400.0 }";
        assert_eq!(of_body(&Body { name: "moon".into(), ..Body::moon() }), moon);
        let parameters = Parameters { seed: 7, ..Parameters::highland(513, 257, 0.625, 7) };
        let text = of_parameters(Some(&parameters));
        assert!(
            text.starts_with(
                "Some(Parameters { columns: 513, rows: 257, posting_m: 0.625, seed: 7, centre: Geodetic { "
            )
        );
        let reading = Reading::default();
        let dem =
            Dem::File { path: "a b.tif".into(), reading, values: Values::Auto, posting_m: None, extent_m: Some(2e3) };
        let file = "File { path: \"a b.tif\", values: Auto, posting_m: None, extent_m: Some(2000.0) }";
        assert_eq!(of_dem(&dem), file);
    }

    /// While the derived texts are the same, old and new keys are told apart by nothing.
    #[test]
    fn texts_are_those_that_were_derived() {
        let (body, centre) = (Body::moon(), Some(Geodetic::from_degrees(-87.0, 3.1, 0.5)));
        let parameters = Parameters::highland(12, 13, 1.5, 3);
        let said = || Reading { band: Some(2), nodata: Some(-1e-7), unit: Some("km".into()), ..Reading::default() };
        assert_eq!(of_body(&body), format!("{body:?}"));
        assert_eq!(of_parameters(Some(&parameters)), format!("{:?}", Some(parameters)));
        let dems = [
            Dem::Detail { posting_m: 0.1, extent_m: 50.0, centre, seed: 3, craters: 1.0, boulders_per_km2: 1e-7 },
            Dem::Cube { path: "c.tif".into(), reading: said(), values: Values::Radius, posting_m: Some(100.0) },
            Dem::Globe(Globe {
                path: "g.tif".into(),
                reading: said(),
                values: Values::Height,
                posting_m: None,
                tiles: Some("tiles".into()),
                posting_px: 1.5,
                most_tiles: 96,
            }),
        ];
        dems.iter().for_each(|dem| assert_eq!(of_dem(dem), format!("{dem:?}")));
    }
}
