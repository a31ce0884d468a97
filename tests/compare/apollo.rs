//! Apollo 15 metric frames over the GLD100 model.

use perilune_engine::compare::{Comparison, Freedom, GeometrySource, Law, Model, Request, compare};
use perilune_engine::pipeline::{AdapterChoice, Silent};

use crate::fixtures::data;

fn request(folder: &std::path::Path, photo: &str, cache: &std::path::Path) -> Request {
    Request {
        photo: folder.join(photo),
        band: None,
        geometry: GeometrySource::File(folder.join("geometry.json")),
        dems: vec![folder.join("apollo15_metric_rev16_64ppd.tif")],
        albedo: None,
        force: false,
        law: Some(Law::LunarLambert),
        freedom: Freedom::Similarity,
        fit_pose: false,
        model: Model::Gain,
        dark: 0.0,
        pixels: None,
        ablation: false,
        turn_sun: false,
        cache: cache.into(),
        adapter: AdapterChoice::Auto,
    }
}

fn of(photo: &str) -> Option<Comparison> {
    let folder = data("apollo15")?;
    let cache = tempfile::tempdir().unwrap();
    Some(compare(&request(&folder, photo, cache.path()), &Silent).unwrap())
}

/// A shadow-free Lommel-Seeliger rendering reaches 0.860 to 0.876 after a shift of (−9, 7) and (−11, 7) rows and
/// columns of 1012: this is where ours has to lie, in pixels of the model's posting (0.357 of them), and above it.
fn assert_beats(photo: &str, rows_columns_of_1012: [f64; 2]) {
    let Some(comparison) = of(photo) else { return };
    let numbers = &comparison.numbers;
    assert!(numbers.high_pass_correlation > 0.89, "{numbers:?}");
    let [x, y] = comparison.registration.motion.shift_px;
    let scale = comparison.resolution.compared_px[0] as f64 / 1012.0;
    let [row, column] = rows_columns_of_1012.map(|shift| -shift * scale);
    // Whole pixels of 1012 were stated, without the scale that is found here: two of them.
    assert!((x - column).abs() < 2.0 * scale && (y - row).abs() < 2.0 * scale, "{x} {y} against {column} {row}");
    assert!(comparison.registration.sigma.shift_px.iter().all(|sigma| *sigma < 0.2));
}

#[test]
fn frame_0297_looks_like_its_photograph() {
    assert_beats("AS15-M-0297_SML.png", [-9.0, 7.0]);
}

#[test]
fn frame_0298_looks_like_its_photograph() {
    assert_beats("AS15-M-0298_SML.png", [-11.0, 7.0]);
}

/// The same scan as an ISIS cube, cut and reduced otherwise.
#[test]
fn a_crop_as_an_isis_cube_is_read_with_its_own_geometry() {
    let Some(comparison) = of("AS15-M-0297_crop.cub") else { return };
    assert_eq!(comparison.resolution.photo_px, [500, 500]);
    assert!(comparison.numbers.high_pass_correlation > 0.8, "{:?}", comparison.numbers);
}
