//! The face that other programs build on, held against the program and against itself.

use std::path::Path;
use std::process::Command;

use perilune::{
    Adapter, Camera, Dem, Ephemeris, ErrorKind, Geodetic, HorizonSettings, Pose, Quantity, Scenario, Scene, Silent,
    View, parse_epoch,
};
use tempfile::TempDir;

/// Two exposures with a detector's noise, a lens that blurs, and a camera that moves meanwhile.
const SCENARIO: &str = r#"(
    title: "Two images for the face",
    terrain: (dems: [
        Synthetic(columns: 97, rows: 97, posting_m: 20, latitude_deg: -85, longitude_deg: 0, seed: 3),
    ]),
    horizon: Settings(azimuths: 64),
    trajectory: Waypoints(height_above: Terrain, points: [
        (t_s: -1, latitude_deg: -85.02, longitude_deg: 0, height_m: 1500),
        (t_s: 11, latitude_deg: -85, longitude_deg: 0, height_m: 1000),
    ]),
    pointing: (towards: Nadir),
    camera: (columns: 48, rows: 32, field_of_view_deg: 40, pixel_pitch_um: 5, band_nm: (400, 700), exposure_s: 0.01, psf: [Gaussian(sigma_px: 0.7)], moments: 3),
    detector: (quantum_efficiency: 0.5, full_well_e: 30000, gain_e_per_dn: 10, bits: 12, read_noise_e: 5),
    exposures: Series(start: "2026-11-24T00:00:00 UTC", step_s: 10, count: 2),
    outputs: (planes: [radiance, digital_number, range]),
)"#;

/// What `sim run` writes for a scenario in a folder.
fn run(folder: &Path) {
    let mut program = Command::new(env!("CARGO_BIN_EXE_sim"));
    program.args(["run", "scenario.ron", "--output", "out", "--cache", "cache", "--adapter", "cpu"]);
    let output = program.current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn a_sequence_renders_what_the_program_writes() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("scenario.ron"), SCENARIO).unwrap();
    run(folder.path());
    let scenario = Scenario::load(folder.path().join("scenario.ron")).unwrap();
    let sequence = scenario.prepare(folder.path().join("cache"), &Silent).unwrap();
    let mut session = sequence.scene().session(Adapter::Cpu).unwrap();
    for exposure in [1, 0] {
        let image = sequence.render(&mut session, exposure).unwrap();
        let path = folder.path().join(format!("out/exposure_{exposure:04}.exr"));
        let written = perilune_engine::dataset::read_exr(&path).unwrap();
        for plane in &image.planes {
            let (_, theirs) = written.channels.iter().find(|(name, _)| name == plane.name).unwrap();
            assert!(plane.values.iter().zip(theirs).all(|(a, b)| a.to_bits() == b.to_bits()), "{}", plane.name);
        }
        assert_eq!(image.planes.len(), 3);
    }
}

#[test]
fn problems_of_a_text_have_line_column_and_key() {
    let error = Scenario::parse(&SCENARIO.replace("rows: 32", "rows: -32"), ".").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Scenario);
    let problems = error.problems();
    assert_eq!(problems.len(), 1, "{problems:?}");
    assert_eq!((problems[0].line, problems[0].key.as_str()), (12, "camera.rows"));
    assert!(problems[0].message.contains("-32"), "{}", problems[0].message);
}

/// A model on disk, nothing of a scenario: the ground is where the file has it, and shadows darken.
#[test]
fn a_scene_of_elevation_models_is_built_without_a_scenario() {
    let folder = TempDir::new().unwrap();
    let model = folder.path().join("ridge.tif");
    let arguments =
        ["terrain", "--columns", "97", "--rows", "97", "--posting", "20", "--at=-85,0", "--output", "ridge.tif"];
    let made = Command::new(env!("CARGO_BIN_EXE_sim")).args(arguments).current_dir(folder.path()).output().unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));

    let moon = Ephemeris::of("moon").unwrap();
    let open = Scene::from_dems(moon.body(), &[Dem::file(&model)]).unwrap();
    let settings = HorizonSettings { azimuths: 64, ..HorizonSettings::default() };
    let shaded = open.clone().with_horizons(&settings, folder.path().join("cache"), &Silent).unwrap();
    let target = open.above_ground(-85.0, 0.0, 0.0);
    let place = open.above_ground(-85.0, 0.0, 2000.0);
    assert!((place.distance_m(target) - 2000.0).abs() < 1e-6);
    let pose = Pose::looking_at(place, target, moon.north_at(target)).unwrap();
    let mut sun = moon.sunlight(target, parse_epoch("2026-11-24T00:00:00 UTC").unwrap()).unwrap();
    sun.irradiance_w_m2 = 1000.0;
    let camera = Camera::from_field_of_view(32, 32, 0.5).unwrap();
    let view = View::new(pose, camera, vec![sun]).with_quantities([Quantity::SunFraction, Quantity::Range]);
    let lit = |scene: &Scene| {
        let image = scene.session(Adapter::Cpu).unwrap().render(&view).unwrap();
        let middle = image.plane(Quantity::Range).unwrap().values[16 * 32 + 16];
        assert!((f64::from(middle) - 2000.0).abs() < 30.0, "{middle}");
        image.plane(Quantity::SunFraction).unwrap().values.iter().sum::<f32>()
    };
    let (open, shaded) = (lit(&open), lit(&shaded));
    assert!(0.0 < shaded && shaded < open, "{shaded} of {open}");
}

#[test]
fn what_is_not_there_is_told_by_its_kind() {
    let moon = Ephemeris::of("moon").unwrap();
    let far = parse_epoch("2060-01-01T00:00:00 UTC").unwrap();
    let place = Geodetic::from_degrees(0.0, 0.0, 0.0);
    assert_eq!(moon.sun(place, far).unwrap_err().kind(), ErrorKind::Ephemeris);
    assert_eq!(Ephemeris::of("vulcan").unwrap_err().kind(), ErrorKind::Ephemeris);
    let missing = Scene::from_dems(moon.body(), &[Dem::file("nowhere.tif")]).unwrap_err();
    assert_eq!(missing.kind(), ErrorKind::Raster, "{missing}");
    assert_eq!(perilune::HorizonTile::open("nowhere.tif").unwrap_err().kind(), ErrorKind::Horizon);
}
