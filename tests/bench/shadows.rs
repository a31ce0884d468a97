//! Images with and without shadows, and under another Sun.

use std::path::Path;

use perilune_bench::shadows::matrix;
use perilune_bench::shadows::methods::{slow, usual};
use perilune_bench::shadows::{Options, compare, reduced, run};
use perilune_engine::geometry::Position;
use perilune_engine::pipeline::{self, Silent};
use perilune_engine::render::Renderer;
use perilune_engine::report::Value;
use perilune_engine::scenario::{self, Scenario};
use perilune_engine::shadow::registry;

const SCENARIO: &str = "(
    title: \"A small highland under a fixed Sun\",
    terrain: (dems: [Synthetic(columns: 192, rows: 192, posting_m: 20, latitude_deg: -89, longitude_deg: 0, seed: 5)]),
    shadows: HorizonMaps(),
    sun: (fixed: (azimuth_deg: 40, elevation_deg: 6)),
    trajectory: Waypoints(points: [(t_s: 0, latitude_deg: -89, longitude_deg: 0, height_m: 8000)]),
    camera: (columns: 128, rows: 96, field_of_view_deg: 20, samples_per_pixel: 4),
    exposures: List([\"2026-11-06T00:00:00 UTC\"]),
    outputs: (planes: [radiance]),
)";

fn small(folder: &Path) -> Scenario {
    let path = folder.join("small.ron");
    std::fs::write(&path, SCENARIO).unwrap();
    scenario::load(&path, &[], &|_| None).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_reduced_camera_sees_the_same_field_with_one_ray_a_pixel() {
    let folder = tempfile::TempDir::new().unwrap();
    let whole = small(folder.path()).camera;
    let part = reduced(&small(folder.path()), 64).camera;
    assert_eq!((part.columns, part.rows, part.samples_per_pixel), (64, 48, 1));
    assert_eq!(part.focal_length_px, whole.focal_length_px / 2.0);
    assert_eq!(part.principal_point_px, whole.principal_point_px.map(|middle| middle / 2.0));
}

#[test]
fn horizon_maps_agree_with_traced_shadows_and_no_shadows_do_not() {
    let folder = tempfile::TempDir::new().unwrap();
    let methods = [usual(), slow()].concat().into_iter().map(str::to_owned).collect();
    let options = Options { exposure: 0, pixels: 64, methods, cache: folder.path().join("cache") };
    let report = run(&small(folder.path()), &options, &Silent).unwrap_or_else(|error| panic!("{error}"));
    let agreement = |method: &str| {
        let rows = &report.tables[1].rows;
        // On whichever renderer there is.
        let row = rows.iter().find(|row| row[0].text().split(',').next() == Some(method));
        match row.unwrap_or_else(|| panic!("{method} is missing"))[1] {
            Value::Number(percent) => percent,
            _ => f64::NAN,
        }
    };
    assert!(agreement("none") < agreement("fourier") - 2.0, "{}", report.text());
    // Bounds well below what was measured on a larger scene: 99.2, 99.1, 97.8, 87.4, 96.5 %.
    let exact = ["swath", "sweep", "single-azimuth", "single-azimuth-level"].map(|method| (method, 97.0));
    let others = [("fourier", 96.0), ("baked", 96.0), ("mipmaps", 94.0), ("mipmaps-5-5-5", 80.0), ("multiscale", 90.0)];
    for (method, least) in exact.into_iter().chain(others) {
        assert!(agreement(method) > least, "{method}: {}", report.text());
    }
    assert!(report.figures.iter().all(|figure| figure.png.starts_with(b"\x89PNG")));
}

#[test]
fn a_sun_elsewhere_lowers_the_agreement() {
    let folder = tempfile::TempDir::new().unwrap();
    let (scenario, cache) = (reduced(&small(folder.path()), 48), folder.path().join("cache"));
    let mut prepared = pipeline::prepare(&scenario, &cache, &Silent).unwrap();
    let mut scene = pipeline::build_scene(&scenario, &mut prepared, &cache, &Silent).unwrap();
    scene = scene.with_shadows(registry::reference(Default::default()));
    let mut view = prepared.exposures[0].view.clone();
    let truth = Renderer::Reference.samples(&scene, &view).unwrap().pixels;
    let (ground, full_w_m2) = (vec![true; truth.len()], view.lights[0].irradiance_w_m2);
    let same = compare(&truth, &truth, &ground, full_w_m2);
    assert_eq!((same.agreement, same.irradiance.max), (1.0, 0.0));

    // A quarter turn about the axis of the Moon, which stands 1° from the zenith here.
    let sun = view.lights[0].position.vector_m();
    view.lights[0].position = Position::from_m(glam::DVec3::new(-sun.y, sun.x, sun.z));
    let turned = Renderer::Reference.samples(&scene, &view).unwrap().pixels;
    let other = compare(&truth, &turned, &ground, full_w_m2);
    assert!(other.agreement < 0.9 && other.irradiance.rms > 0.02, "{other:?}");
}

#[test]
fn each_elevation_gets_its_rows_and_a_plot_with_a_frontier() {
    let folder = tempfile::TempDir::new().unwrap();
    let methods: Vec<String> = ["none", "fourier", "baked-fm16"].map(str::to_owned).into();
    let options = Options { exposure: 0, pixels: 48, methods, cache: folder.path().join("cache") };
    let report = matrix::run(&small(folder.path()), &options, &[3.0, 12.0], 2, &Silent).unwrap();
    let rows = &report.tables[0].rows;
    let column = |name: &str| report.tables[0].columns.iter().position(|(column, _)| *column == name).unwrap();
    let number = |row: usize, name: &str| match rows[row][column(name)] {
        Value::Number(number) => number,
        _ => f64::NAN,
    };
    assert_eq!((rows.len(), report.plots.len(), report.figures.len()), (6, 2, 3));
    for first in [0, 3] {
        let [none, fourier, baked] = [first, first + 1, first + 2];
        assert!(number(none, "RMS") > 2.0 * number(fourier, "RMS"), "{}", report.text());
        assert!(number(none, "SSIM") < number(fourier, "SSIM"), "{}", report.text());
        assert!(number(none, "FLIP") > number(baked, "FLIP"), "{}", report.text());
        assert!(number(fourier, "horizon RMS") > 0.0 && number(fourier, "bytes per node") > 10.0);
        assert!(number(fourier, "least") <= number(fourier, "frame"));
        assert!(report.plots[first / 3].curves.iter().any(|curve| curve.joined && !curve.points.is_empty()));
    }
    // The lower the Sun, the more is wrong without shadows.
    assert!(number(0, "agreement") < number(3, "agreement"), "{}", report.text());
}

/// From near the zenith the Sun is seen in many azimuths of a map at once.
#[test]
fn a_method_outside_its_domain_has_an_empty_row_and_a_note() {
    let folder = tempfile::TempDir::new().unwrap();
    let methods: Vec<String> = ["none", "swath"].map(str::to_owned).into();
    let options = Options { exposure: 0, pixels: 32, methods, cache: folder.path().join("cache") };
    let report = matrix::run(&small(folder.path()), &options, &[89.7], 1, &Silent).unwrap();
    let [none, swath] = &report.tables[0].rows[..] else { panic!("{}", report.text()) };
    assert!(none[2..5].iter().all(|value| matches!(value, Value::Number(_))));
    assert!(swath[2..].iter().all(|value| *value == Value::Missing), "{}", report.text());
    assert!(report.notes.iter().any(|note| note.starts_with("Sun at 89.7°, swath: outside its domain: ")));
}
