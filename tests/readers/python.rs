//! The Python page: `tests/python/dataset.py` loads a swept and split dataset.

use super::{python, told};
use crate::cli::run::{Run, SMALL};

/// One camera over nine places, in cells smaller than their distance.
fn dataset() -> Run {
    let swept = SMALL
        .replace("planes: [radiance, sun_fraction, depth, dem_gap]", "planes: [radiance, depth, latitude]")
        .replace("count: 4", "count: 1")
        .replace(
            "outputs:",
            "sweep: (design: Grid, north_m: Values([-300, 0, 300]), east_m: Values([-300, 0, 300])),
             split: (train: 0.5, validation: 0.25, test: 0.25, cell_m: 200),
             outputs:",
        );
    let run = Run::of(&swept);
    run.succeed(&[]);
    run
}

/// The ray of each pixel, drawn to its depth, ends at its latitude: K, pose and depth mean what the page says. A float of 89°
/// is good to 4e-6°; one of 1500 m to 6e-5 m, which is 2e-9°.
#[test]
fn thirty_lines_of_python_load_a_dataset() {
    let Some(python) = python("numpy, OpenEXR") else { return };
    let run = dataset();
    let folder = run.path("out").display().to_string();
    let all = told(&python, "dataset.py", &[&folder]);
    assert_eq!((&all["images"], &all["shape"]), (&9.into(), &serde_json::json!([2, 64, 64])));
    assert!(all["latitude_error_deg"].as_f64().unwrap() < 8e-6, "{all}");
    // Where PyTorch is there, its loader has stacked two of them.
    assert!(all.get("batch").is_none_or(|shape| *shape == serde_json::json!([2, 2, 64, 64])), "{all}");
    let train = told(&python, "dataset.py", &[&folder, "train"])["images"].as_u64().unwrap();
    assert!((1..9).contains(&train), "{train}");
}
