//! Hard cases of the list that no shadow method can fail, and the tests that they are instead.

use crate::Table;

/// Numbers of the list, what they are about, and where that is tested.
pub const ELSEWHERE: [(&str, &str, &str); 22] = [
    ("13", "sign and factor of a one-sided sum", "horizon::series, tests/conformance/vectors.rs"),
    ("14, 15", "coefficients of few bits", "tests/reference/horizon/encodings.rs: decoded errors of every encoding"),
    ("18", "halves packed in words", "horizon::pack::half: every half float survives packing"),
    ("21", "a pixel at the pole", "tests/reference/raster/levels.rs: a pole is a point like any other; case 17 here"),
    ("24", "degrees taken for metres", "tests/reference/horizon/closed_forms.rs: a constant slope in every azimuth"),
    ("26", "row order, words, sentinels", "tests/reference/raster.rs: values where GDAL puts them"),
    ("29, 30", "latitude and height on a spheroid", "tests/reference/raster.rs: latitudes and radii of the CRS"),
    ("31", "overhangs", "height fields have none: shapes of asteroids are outside the program"),
    (
        "34",
        "small angles by arc cosine",
        "tests/conformance/photometry.rs: f32 against f64, directions kept as vectors",
    ),
    ("37", "scales of time", "ephemeris::epoch, tests/reference/ephemeris.rs"),
    ("38", "aberration", "tests/reference/ephemeris.rs: it turns the Sun by v/c"),
    ("39", "epochs outside kernels", "tests/reference/ephemeris.rs: one second outside is an error"),
    ("40", "frames of the Moon", "tests/reference/ephemeris.rs: mean Earth and principal axes"),
    ("41, 42", "eclipses, annular ones", "photometry::eclipse, sim bench radiometry"),
    ("43", "signs of quaternions", "ephemeris::attitude: they do not matter"),
    ("44", "a camera below the ground", "tests/cli/run_input.rs: refused with both heights"),
    ("45", "limb", "tests/reference/render/sphere.rs: the whole disc by its phase integral"),
    ("46, 47", "0/0 of reflectance laws, opposition", "tests/invariants/photometry.rs: a million directions"),
    ("48", "distortion that folds", "camera::distortion: growth ends where the cubic turns"),
    ("49", "one pose for all lines", "tests/reference/render/imaging.rs: a rolling shutter shears an edge"),
    ("50", "radiance that is not linear", "tests/invariants/render.rs: twice the distance, a quarter of the radiance"),
    (
        "51",
        "order and sines of devices",
        "tests/conformance: every shader function against f64; cli::run: the same bytes",
    ),
];

/// As a table of the report.
pub fn table() -> Table {
    let mut table = Table::new(
        "elsewhere",
        "Hard cases that are tests of their own",
        &[("hard case", ""), ("about", ""), ("where", "")],
    );
    table.rows.extend(ELSEWHERE.map(|row| <[&str; 3]>::from(row).map(Into::into).to_vec()));
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::cases;

    #[test]
    fn each_of_the_52_is_a_case_or_a_test_elsewhere() {
        let elsewhere = ELSEWHERE.iter().flat_map(|row| row.0.split(", ")).map(|number| number.parse().unwrap());
        let mut numbers: Vec<u8> = cases::all().iter().map(|case| case.number).chain(elsewhere).collect();
        numbers.sort_unstable();
        numbers.dedup();
        assert_eq!(numbers, (1..=52).collect::<Vec<_>>());
    }
}
