//! Files and places that a run cannot use: one line on standard error, exit code 1, nothing rendered, no panic.
//!
//! What is wrong within a scenario's text is in `bad_input.rs`.

use std::path::Path;

use perilune_engine::raster::{GeoTiff, GeoTiffBand};
use tiff::encoder::{TiffEncoder, colortype::Gray32Float};

use super::run::{Run, SMALL};

/// The polar stereographic map of lunar DEMs.
const MOON: &str = "+proj=stere +lat_0=-90 +lon_0=0 +R=1737400 +units=m +no_defs";
/// Around the path of the small scenario, 30.3 to 30.6 km from the pole.
const GEOTRANSFORM: [f64; 6] = [-640.0, 20.0, 0.0, 31_000.0, 0.0, -20.0];

/// What `sim run` says where it must refuse.
fn refusal(run: &Run, arguments: &[&str]) -> String {
    let output = run.sim(arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.starts_with("error: ") && said.lines().count() == 1, "{said}");
    assert!(output.stdout.is_empty());
    assert_nothing_rendered(run);
    said
}

fn assert_nothing_rendered(run: &Run) {
    let rendered = std::fs::read_dir(run.path("out")).into_iter().flatten().count();
    assert_eq!(rendered, 0, "something was rendered");
}

fn assert_refuses(run: &Run, parts: &[&str]) {
    let said = refusal(run, &[]);
    assert!(parts.iter().all(|part| said.contains(part)), "{said} should contain {parts:?}");
}

/// The small scenario over `dem.tif`, which `make` writes.
fn over_dem(make: impl FnOnce(&Path)) -> Run {
    let synthetic = "Synthetic(columns: 128, rows: 128, posting_m: 20, latitude_deg: -89, longitude_deg: 0, seed: 1)";
    assert!(SMALL.contains(synthetic));
    let run = Run::of(&SMALL.replace(synthetic, "File(path: \"dem.tif\")"));
    make(&run.path("dem.tif"));
    run
}

fn write_dem(path: &Path, side: usize, height_m: f32, crs: &str) {
    let values = vec![height_m; side * side];
    let bands = vec![GeoTiffBand { name: "height", unit: "m", values: &values }];
    GeoTiff { columns: side, rows: side, bands, crs, geotransform: GEOTRANSFORM }.write(path).unwrap();
}

#[test]
fn a_flat_dem_runs() {
    let run = over_dem(|path| write_dem(path, 64, 100.0, MOON));
    run.succeed(&["--frames", "3..4"]);
}

#[test]
fn a_dem_that_is_missing_or_a_folder_is_named_with_its_place_in_the_scenario() {
    let missing = over_dem(|_| ());
    assert_refuses(&missing, &["small.ron:4:20: terrain.dems[0].path = \"dem.tif\" is not found"]);
    let folder = over_dem(|path| std::fs::create_dir(path).unwrap());
    assert_refuses(&folder, &["terrain.dems[0].path = \"dem.tif\" is a directory, not a file"]);
}

#[test]
fn a_dem_without_a_map_is_refused() {
    let bare = over_dem(|path| {
        let mut file = std::fs::File::create(path).unwrap();
        let mut encoder = TiffEncoder::new(&mut file).unwrap();
        encoder.write_image::<Gray32Float>(8, 8, &[0.0; 64]).unwrap();
    });
    assert_refuses(&bare, &["dem.tif has no coordinate reference system"]);
}

#[test]
fn a_dem_of_another_body_is_refused_with_both_radii() {
    let mars = over_dem(|path| write_dem(path, 64, 0.0, &MOON.replace("1737400", "3396190")));
    assert_refuses(&mars, &["referenced to a body of radius 3396190 m, moon has 1737400 m"]);
}

#[test]
fn a_dem_that_holds_nothing_is_refused() {
    assert_refuses(&over_dem(|path| write_dem(path, 64, f32::NAN, MOON)), &["every pixel is nodata"]);
    assert_refuses(&over_dem(|path| write_dem(path, 1, 0.0, MOON)), &["has 1 x 1 pixels", "at least 2 x 2"]);
    assert_refuses(&over_dem(|path| std::fs::write(path, "").unwrap()), &["not a raster that GDAL can open"]);
}

#[test]
fn a_truncated_dem_is_refused() {
    let cut = over_dem(|path| {
        let terrain = sim_terrain(path);
        let bytes = std::fs::read(path).unwrap();
        assert!(terrain && bytes.len() > 10_000);
        std::fs::write(path, &bytes[..bytes.len() / 2]).unwrap();
    });
    assert_refuses(&cut, &["dem.tif", "truncated or damaged"]);
}

fn sim_terrain(path: &Path) -> bool {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_sim"));
    command.args(["terrain", "--columns", "128", "--rows", "128", "-o"]).arg(path).output().unwrap().status.success()
}

/// The small scenario with the default kernels copied beside it and changed by `damage`.
fn with_kernel(damage: impl FnOnce(&mut Vec<u8>)) -> Run {
    let kernels = Path::new(env!("CARGO_MANIFEST_DIR")).join("kernels");
    let run = Run::of(&SMALL.replace("pointing:", "kernels: [\"a.bsp\", \"perilune_iau.tpc\"],\n    pointing:"));
    let mut bytes = std::fs::read(kernels.join("perilune_2020_2040.bsp")).unwrap();
    damage(&mut bytes);
    std::fs::write(run.path("a.bsp"), bytes).unwrap();
    run
}

#[test]
fn a_damaged_kernel_is_refused() {
    assert_refuses(&with_kernel(|bytes| bytes.truncate(bytes.len() / 2)), &["a.bsp is corrupted: "]);
    assert_refuses(&with_kernel(|bytes| bytes.truncate(0)), &["a.bsp"]);
    assert_refuses(&with_kernel(|bytes| bytes.iter_mut().for_each(|byte| *byte = b'?')), &["a.bsp is "]);
}

/// The file record says where the first summaries are; a summary is two doubles and six integers, the fourth of
/// which is the data type (NAIF, *DAF Required Reading*).
#[test]
fn a_kernel_of_an_unsupported_type_is_refused_with_the_types_that_are_read() {
    let run = with_kernel(|bytes| {
        let first_record = i32::from_le_bytes(bytes[76..80].try_into().unwrap()) as usize;
        let data_type = 1024 * (first_record - 1) + 24 + 2 * 8 + 3 * 4;
        bytes[data_type..data_type + 4].copy_from_slice(&5_i32.to_le_bytes());
    });
    assert_refuses(&run, &["a.bsp: segment", "has data type 5; allowed are "]);
}

#[test]
fn an_epoch_that_no_kernel_covers_is_refused_with_the_coverage() {
    let run = Run::of(&SMALL.replace("2026-11-06", "2046-11-06"));
    assert_refuses(&run, &["at 2046-11-06T00:00:00Z is outside the loaded coverage: 2019-12-31T00:00:00Z to 2041-"]);
}

#[test]
fn an_unknown_frame_is_refused_with_those_there_are() {
    let run = Run::of(&SMALL.replace("pointing:", "frame: \"MOON_ELSEWHERE\",\n    pointing:"));
    assert_refuses(&run, &["frame `MOON_ELSEWHERE` is unknown; allowed are IAU_<BODY>"]);
}

#[test]
fn a_camera_in_the_ground_is_refused_with_both_heights() {
    let run = over_dem(|path| write_dem(path, 64, 2000.0, MOON));
    let text = std::fs::read_to_string(run.path("small.ron")).unwrap();
    std::fs::write(run.path("small.ron"), text.replace("height_above: Terrain, ", "")).unwrap();
    let said = refusal(&run, &[]);
    assert!(said.contains("at exposure 0 (2026-11-06T00:00:00Z) the camera is 1500.0 m above"), "{said}");
    assert!(said.contains("the ground below it 2000.0 m"), "{said}");
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_anything_is_made() {
    let run = Run::of(SMALL);
    std::fs::write(run.path("out"), "mine").unwrap();
    assert_refuses(&run, &["out is a file, not a directory"]);
    assert_eq!(std::fs::read_to_string(run.path("out")).unwrap(), "mine");
    assert!(!run.path("cache").exists());

    let below_a_file = std::process::Command::new(env!("CARGO_BIN_EXE_sim"))
        .arg("run")
        .arg(run.path("small.ron"))
        .args(["--output", "/dev/null/inside", "--adapter", "cpu"])
        .output()
        .unwrap();
    let said = String::from_utf8(below_a_file.stderr).unwrap();
    assert!(said.starts_with("error: cannot create the output directory /dev/null/inside: "), "{said}");
}

#[test]
fn a_cache_that_cannot_be_written_is_refused() {
    let run = Run::of(SMALL);
    std::fs::write(run.path("cache"), "mine").unwrap();
    assert_refuses(&run, &["cannot write", "cache"]);
}

/// A limit of no bytes a file fails every write to the disk, and leaves pipes alone.
#[test]
#[cfg(unix)]
fn a_disk_error_is_told_in_the_systems_words() {
    let run = Run::of(SMALL);
    let mut command = std::process::Command::new("sh");
    command.args(["-c", "trap '' XFSZ; ulimit -f 0; exec \"$@\"", "sh", env!("CARGO_BIN_EXE_sim"), "run"]);
    command.arg(run.path("small.ron")).arg("--output").arg(run.path("out")).arg("--cache").arg(run.path("cache"));
    let output = command.output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.starts_with("error: cannot write ") && said.lines().count() == 1, "{said}");
    assert_eq!(said.matches("File too large").count(), 1, "{said}");
    assert_nothing_rendered(&run);
}

#[test]
fn exposures_that_the_scenario_does_not_have_are_refused() {
    for frames in ["4..9", "2..5", "3..1"] {
        let refusal = refusal(&Run::of(SMALL), &["--frames", frames]);
        assert!(refusal.contains(frames) && refusal.contains("--frames"), "{refusal}");
        assert!(refusal.contains("the scenario has 4"), "{refusal}");
    }
}

#[test]
fn a_scenario_that_is_no_text_is_refused() {
    let run = Run::of(SMALL);
    std::fs::remove_file(run.path("small.ron")).unwrap();
    assert_refuses(&run, &["no scenario ", "small.ron"]);
    std::fs::create_dir(run.path("small.ron")).unwrap();
    assert_refuses(&run, &["cannot read the scenario ", "small.ron", "directory"]);
    std::fs::remove_dir(run.path("small.ron")).unwrap();
    std::fs::write(run.path("small.ron"), b"(title: \"\xff\xfe\")").unwrap();
    assert_refuses(&run, &["cannot read the scenario ", "UTF-8"]);
}

/// Without any driver `auto` renders on the CPU and says so; `gpu` refuses.
#[test]
#[cfg(target_os = "linux")]
fn without_a_gpu_auto_falls_back_and_gpu_refuses() {
    let run = Run::of(SMALL);
    let with = |adapter: &str| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_sim"));
        command.arg("run").arg(run.path("small.ron")).arg("--output").arg(run.path("out"));
        command.arg("--cache").arg(run.path("cache")).args(["--frames", "0..1", "--adapter", adapter]);
        command.env("VK_DRIVER_FILES", "/dev/null").env("VK_ICD_FILENAMES", "/dev/null").output().unwrap()
    };
    let refused = with("gpu");
    let said = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(1), "{said}");
    assert!(said.starts_with("error: no ") && said.lines().count() == 1, "{said}");
    let fallen_back = with("auto");
    let said = String::from_utf8(fallen_back.stderr).unwrap();
    assert!(fallen_back.status.success(), "{said}");
    assert!(said.contains("rendering with the reference renderer on the CPU"), "{said}");
}
