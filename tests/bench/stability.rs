//! Hard cases: what passes goes on passing, and what is wrong is seen to be wrong.

use perilune_bench::stability::methods::{MethodFactory, outcome};
use perilune_bench::stability::{Outcome, cases, run};
use perilune_engine::pipeline::Silent;
use perilune_engine::report::{Report, Value};

/// Methods, and how many cases they passed when this was written, in both renderers.
const PASSED: [(&str, f64); 12] = [
    ("traced", 28.0),
    ("fourier", 23.0),
    ("fourier-f16", 22.0),
    ("baked", 22.0),
    ("swath", 22.0),
    ("sweep", 27.0),
    ("single-azimuth", 26.0),
    ("single-azimuth-level", 26.0),
    ("single-azimuth-hard", 21.0),
    ("mipmaps-5-5-5", 9.0),
    ("mipmaps", 20.0),
    ("multiscale", 10.0),
];

fn count(report: &Report, method: &str, numbers: &str, column: usize) -> f64 {
    let rows = &report.tables[0].rows;
    let row = rows.iter().find(|row| row[0].text() == method && row[1].text() == numbers);
    match row.map(|row| &row[column]) {
        Some(Value::Number(count)) => *count,
        _ => f64::NAN,
    }
}

#[test]
fn every_method_passes_the_hard_cases_it_has_passed_and_none_ends_in_nan() {
    let folder = tempfile::tempdir().unwrap();
    let report = run(folder.path(), &Silent).unwrap();
    println!("{}", report.text());
    for ((method, least), numbers) in PASSED.iter().flat_map(|row| ["f64", "f32"].map(|numbers| (row, numbers))) {
        // Without a device there is no row of `f32`.
        let passed = count(&report, method, numbers, 2);
        assert!(passed >= *least || numbers == "f32" && passed.is_nan(), "{method} {numbers}: {passed}, was {least}");
    }
    for row in &report.tables[0].rows {
        assert_eq!(row[4], Value::Number(0.0), "{} {} ends in NaN", row[0].text(), row[1].text());
    }
}

/// The Sun a quarter of a degree higher than the closed form believes, and a share that is no number.
#[test]
fn a_planted_error_is_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    let mut cases = cases::all();
    let case = cases.iter_mut().find(|case| case.number == 1).unwrap();
    let factory = MethodFactory::new(&case.scene.surface, folder.path()).unwrap();
    assert!(matches!(outcome(case, "traced", None, &factory).unwrap(), Outcome::Pass(_)));
    let map = case.scene.surface.terrain.faces[0].map.clone();
    case.views[0].lights[0] =
        perilune_bench::stability::scenes::sun(&map, -std::f64::consts::FRAC_PI_2, 3.25_f64.to_radians());
    assert!(matches!(outcome(case, "traced", None, &factory).unwrap(), Outcome::Fail(_)));
    let mut image = perilune_engine::render::Renderer::Reference.samples(&case.scene, &case.views[0]).unwrap();
    image.pixels[7].sun_fraction = f32::NAN;
    assert_eq!(case.outcome(&[image]), Outcome::NotANumber);
}
