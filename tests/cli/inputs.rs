//! Rasters as users have them: each is read right, or refused by name, or warned of.
//!
//! Inputs from the shared folder show one ground, `h = 150 + 0.08 e + 250 exp(−((e − 300)/200)² − ((n − 150)/120)²)` m about 80° S,
//! 210° E; where the folder is missing those tests are skipped. Small ones are made here.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use perilune_engine::geometry::{Body, Geodetic};
use perilune_engine::pipeline::{Silent, ground};
use perilune_engine::raster::{Dem, Error, Options, Reading, Values};
use perilune_engine::scenario::{self, Scenario};

use crate::fixtures;

const R: f64 = 1_737_400.0;

/// The ground that nearly all inputs show.
fn ground_m(place: Geodetic) -> f64 {
    let east =
        R * 80_f64.to_radians().cos() * (place.longitude_east_rad.to_degrees().rem_euclid(360.0) - 210.0).to_radians();
    let north = R * (place.latitude_rad + 80_f64.to_radians());
    let bump = ((east - 300.0) / 200.0).powi(2) + ((north - 150.0) / 120.0).powi(2);
    150.0 + 0.08 * east + 250.0 * (-bump).exp()
}

fn input(name: &str) -> Option<PathBuf> {
    fixtures::data(&format!("inputs/{name}/scenario.ron"))
}

/// The scenario of an input with some of its text changed; `None` where the folder is missing.
fn changed(name: &str, from: &str, to: &str) -> Option<Result<Scenario, String>> {
    let path = input(name)?;
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{text}");
    let places = scenario::SearchPath::of(&path, &[]);
    Some(scenario::resolve(&path, &text.replace(from, to), &places, &|_| None).map_err(|error| error.to_string()))
}

/// The first model of a scenario as a run reads it.
fn first_dem(scenario: &Scenario) -> Result<Dem, String> {
    let dem = &scenario.terrain.as_ref().unwrap().dems[0];
    let path = ground::paths(&scenario.body, std::slice::from_ref(dem), Path::new(""))[0].clone();
    ground::open(dem, &path, &scenario.body, None, &Silent).map_err(|error| error.to_string())
}

fn opened(name: &str) -> Option<Result<Dem, String>> {
    let scenario = changed(name, "", "")?;
    Some(scenario.and_then(|scenario| first_dem(&scenario)))
}

/// Heights minus the formula's, `above_m` higher: root mean square of those that are there, and how many are missing.
fn against_formula(dem: &Dem, above_m: f64) -> (f64, usize) {
    let pixels: Vec<_> = (0..dem.columns * dem.rows)
        .map(|i| glam::DVec2::new((i % dem.columns) as f64, (i / dem.columns) as f64))
        .collect();
    let places = dem.georeference.projector().unwrap().geodetics(&pixels);
    let errors =
        places.iter().zip(&dem.heights_m).map(|(place, height_m)| f64::from(*height_m) - ground_m(*place) - above_m);
    let known: Vec<f64> = errors.filter(|error| !error.is_nan()).collect();
    let mean = known.iter().map(|error| error * error).sum::<f64>() / known.len() as f64;
    (mean.sqrt(), dem.heights_m.len() - known.len())
}

/// What is stored in 16 bits, or scaled, errs by half a step.
#[test]
fn models_in_all_units_and_forms_show_the_same_ground() {
    let cases = [
        ("00_base", 0.0, 0),
        ("01_pds3_float_km", 0.0, 0),
        ("02_unit_km", 0.0, 0),
        ("02b_unit_ft", 0.0, 0),
        ("03_compound_ft", 0.0, 0),
        ("06b_undeclared_inside_-3.40282e+38", 0.0, 36),
        ("18_radius_1738000", 600.0, 0),
        ("19b_alpha", 0.0, 0),
        ("21_sparse", 0.0, 1),
        ("23b_netcdf_subdatasets", 0.0, 0),
        ("24_zip", 0.0, 0),
        ("40b_isis_positive_west", 0.0, 0),
    ];
    for (name, above_m, missing) in cases {
        let Some(dem) = opened(name) else { return };
        let dem = dem.unwrap_or_else(|error| panic!("{name}: {error}"));
        let (rms_m, found) = against_formula(&dem, above_m);
        assert!(rms_m < 0.5 && (found > 0) == (missing > 0), "{name}: {rms_m} m, {found} missing");
        assert!(missing < 2 || missing == found, "{name}: {found} missing");
        assert_eq!(dem.survey.findings.len(), usize::from(name.starts_with("18")), "{name}: {:?}", dem.survey.findings);
    }
}

#[test]
fn what_cannot_be_read_right_is_refused_with_the_key_that_settles_it() {
    for (name, said) in [
        ("06_undeclared_-9999", "nodata: -9999"),
        ("45b_radius_zero_inside", "a radius of moon lies between 1727700 and 1748700 m: 0 comes 16 times"),
        ("45b_radius_zero_inside", "nodata: 0"),
        ("19_two_bands", "has 2 bands: choose one with the key band: 1"),
        ("22_gcp_only", "ground control points"),
    ] {
        let Some(dem) = opened(name) else { return };
        let error = dem.unwrap_err();
        assert!(error.contains(said) && error.lines().count() == 1, "{name}: {error}");
    }
    let Some(container) = changed("23b_netcdf_subdatasets", "NETCDF:\\\"dem.nc\\\":z1", "dem.nc") else { return };
    let error = first_dem(&container.unwrap()).unwrap_err();
    assert!(error.contains("container of 2 rasters") && error.contains("z1"), "{error}");
}

#[test]
fn keys_say_what_a_file_does_not() {
    let cases = [
        ("06_undeclared_-9999", "nodata: -9999", true),
        ("45b_radius_zero_inside", "nodata: 0", true),
        ("19_two_bands", "band: 1", false),
        ("42_jp2_int16", "scale: 0.5", false),
        ("02_unit_km", "unit: \"Kilometre\", values: Height", false),
        ("18_radius_1738000", "crs: \"+proj=stere +lat_0=-90 +R=1737400 +units=m\"", false),
    ];
    for (name, keys, has_gaps) in cases {
        let Some(scenario) = changed(name, "File(", &format!("File({keys}, ")) else { return };
        let dem = first_dem(&scenario.unwrap()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let (rms_m, missing) = against_formula(&dem, 0.0);
        // Steps of 0.5 m err by 0.15 m.
        assert!(name.starts_with("18") || rms_m < 0.3, "{name}: {rms_m}");
        assert_eq!(missing > 0, has_gaps, "{name}");
    }
    let wrong = changed("02_unit_km", "File(", "File(unit: \"furlong\", scale: 0, ").unwrap().unwrap_err();
    assert!(wrong.contains("unit = \"furlong\" is none of the units m, km") && wrong.contains("scale = 0"), "{wrong}");
}

/// Radii as `f32` have steps of 0.125 m: 7° at a posting of 1 m. Heights of the same plane have none.
#[test]
fn steps_are_warned_of_where_they_tilt_the_ground() {
    let Some(radii) = opened("44_f32_radius") else { return };
    let findings = radii.unwrap().survey.findings;
    assert!(
        findings.len() == 1 && findings[0].contains("steps of 0.125 m") && findings[0].contains("7.1 deg"),
        "{findings:?}"
    );
    let heights = changed("44_f32_radius", "dem.tif", "height.tif").unwrap().unwrap();
    assert_eq!(first_dem(&heights).unwrap().survey.findings, Vec::<String>::new());
}

/// What `sim run` writes into a folder of its own.
fn run(scenario: &Path) -> Output {
    let folder = tempfile::tempdir().unwrap();
    run_into(scenario, folder.path())
}

fn run_into(scenario: &Path, folder: &Path) -> Output {
    let paths = [folder.join("out"), folder.join("cache"), scenario.into()];
    let [out, cache, scenario] = [0, 1, 2].map(|index| paths[index].to_str().unwrap());
    program(&["run", "--adapter", "cpu", "--output", out, "--cache", cache, scenario])
}

fn program(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_sim")).args(arguments).output().unwrap()
}

#[test]
fn albedo_maps_keep_to_the_range_of_their_constants() {
    for (name, said) in [
        ("30b_albedo_byte", "write scale: 0.00392"),
        ("30d_albedo_negative", "an albedo lies between 0 and 1: -0.05"),
        ("30e_albedo_undeclared_fill", "nodata: -9999"),
        ("30g_albedo_rgb", "choose one with the key band: 1 (red), 2 (green), 3 (blue)"),
    ] {
        let Some(path) = input(name) else { return };
        let output = run(&path);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && error.contains(said), "{name}: {error}");
    }
}

/// Checks of 0.02 and 0.22, ten to a node, are 0.12 from afar.
#[test]
fn an_albedo_map_finer_than_the_ground_is_averaged() {
    let Some(scenario) = changed("31_albedo_finer_than_dem", "", "") else { return };
    let scenario = scenario.unwrap();
    let ground = ground::surface(scenario.terrain.as_ref(), &scenario.body, Path::new(""), &Silent).unwrap();
    let scenario::Albedo::Map(path, reading) = &scenario.albedo else { panic!("a map") };
    let map = ground::albedo(&ground.surface, path, reading, 1.0).unwrap();
    let known: Vec<f32> = map.values.concat().concat().into_iter().filter(|albedo| !albedo.is_nan()).collect();
    assert!(known.len() > 100 && known.iter().all(|albedo| (albedo - 0.12).abs() < 1e-3), "{:?}", &known[..10]);
}

/// Rows that hold nothing are cut off and lie beside the model, where the sphere is invented.
#[test]
fn ground_that_no_file_gave_is_labelled() {
    let Some(nodata) = input("92_nodata_border") else { return };
    let folder = tempfile::tempdir().unwrap();
    let run = |path: &Path, name: &str| {
        let out = folder.path().join(name);
        let output = run_into(path, &out);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let mut records = walk(&out).into_iter().filter(|path| path.extension().is_some_and(|found| found == "json"));
        let shares = records.find_map(|path| {
            let record: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()?;
            record.pointer("/quality/share_interpolated_dem").and_then(serde_json::Value::as_f64)
        });
        shares.expect("a record with its share")
    };
    let share = run(&nodata, "border");
    // 291 of 1024 pixels lay at height 0.
    assert!((share - 291.0 / 1024.0).abs() < 0.01, "{share}");
    assert_eq!(run(&input("00_base").unwrap(), "base"), 0.0);
    assert_eq!(run(&input("17_dem_elsewhere").unwrap(), "elsewhere"), 1.0);
}

fn walk(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.flat_map(|entry| if entry.path().is_dir() { walk(&entry.path()) } else { vec![entry.path()] }).collect()
}

/// A tiny skew leaves a global model whole; the middle of its seam has a height.
#[test]
fn a_skew_of_rounding_size_opens_no_seam() {
    for name in ["16_global_seam", "16b_global_tiny_skew"] {
        let Some(dem) = fixtures::data(&format!("inputs/{name}/dem.tif")) else { return };
        let dem = Dem::open(&dem, &Body::moon(), &Options::default()).unwrap();
        let seam = Body::moon().position_from_geodetic(Geodetic::from_degrees(10.0, 180.0, 0.0));
        assert!(dem.height_m(dem.georeference.projector().unwrap().pixels(&[seam])[0]).is_finite(), "{name}");
    }
}

/// Headers, names and sizes that would take all memory or all day.
#[test]
fn hostile_rasters_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let open = |path: &Path, options: &Options| Dem::open(path, &Body::moon(), options).unwrap_err();
    let sparse = |name: &str, columns: usize, rows: usize, block: [usize; 2]| {
        let path = folder.path().join(name);
        sparse_tiff(&path, columns, rows, block);
        path
    };
    let most = Options { most_side: Some(5792), ..Options::default() };
    let polar = sparse("polar.tif", 30_400, 30_400, [512, 512]);
    let error = open(&polar, &most);
    assert!(
        matches!(error, Error::TooLarge { columns: 30_400, .. }) && error.to_string().contains("extent_m = "),
        "{error}"
    );
    let huge = sparse("huge.tif", 1_000_000, 1_000_000, [4096, 4096]);
    assert!(matches!(open(&huge, &Options::default()), Error::TooMany { .. }));
    let strip = sparse("strip.tif", 2_000_000, 320, [2_000_000 / 16 * 16, 320]);
    assert!(matches!(open(&strip, &Options::default()), Error::Block { .. }));
    // Wherever it lies, none of it is read.
    assert!(matches!(open(Path::new("PG:dbname=moon"), &Options::default()), Error::Remote { .. }));
}

/// A GeoTIFF of whose tiles none is there.
fn sparse_tiff(path: &Path, columns: usize, rows: usize, block: [usize; 2]) {
    let driver = gdal::DriverManager::get_driver_by_name("GTiff").unwrap();
    let [width, height] = block.map(|side| format!("{side}"));
    let options = [
        "TILED=YES".into(),
        "SPARSE_OK=TRUE".into(),
        "BIGTIFF=YES".into(),
        "COMPRESS=DEFLATE".into(),
        format!("BLOCKXSIZE={width}"),
        format!("BLOCKYSIZE={height}"),
    ];
    let options = gdal::raster::RasterCreationOptions::from_iter(options.iter().map(String::as_str));
    let mut file = driver.create_with_band_type_with_options::<f32, _>(path, columns, rows, 1, &options).unwrap();
    let crs = "+proj=stere +lat_0=-90 +R=1737400 +units=m";
    file.set_spatial_ref(&gdal::spatial_ref::SpatialRef::from_proj4(crs).unwrap()).unwrap();
    file.set_geo_transform(&[-304_000.0, 20.0, 0.0, 304_000.0, 0.0, -20.0]).unwrap();
    file.close().unwrap();
}

/// A sparse model of 30 400² pixels, of which one tile is there: the rest is gap, and none of it is read.
#[test]
fn missing_tiles_are_gaps_and_take_no_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("polar.tif");
    sparse_tiff(&path, 30_400, 30_400, [256, 256]);
    let file = gdal::Dataset::open_ex(
        &path,
        gdal::DatasetOptions { open_flags: gdal::GdalOpenFlags::GDAL_OF_UPDATE, ..Default::default() },
    );
    let values = vec![150.0_f32; 256 * 256];
    let mut buffer = gdal::raster::Buffer::new((256, 256), values);
    file.unwrap().rasterband(1).unwrap().write((256, 512), (256, 256), &mut buffer).unwrap();
    let dem = Dem::open(&path, &Body::moon(), &Options { posting_m: Some(320.0), ..Options::default() }).unwrap();
    assert_eq!((dem.columns, dem.rows), (1900, 1900));
    let known: Vec<usize> = (0..1900 * 1900).filter(|index| !dem.heights_m[*index].is_nan()).collect();
    assert!(known.len() == 16 * 16 && known.iter().all(|index| dem.heights_m[*index] == 150.0), "{}", known.len());
    assert_eq!((known[0] % 1900, known[0] / 1900), (16, 32));
    assert_eq!((dem.survey.known, dem.survey.pixels), (256 * 256, 30_400 * 30_400));
}

/// Kilometres without a unit: radii are told by their size; what may be heights in m too is asked for.
#[test]
fn radii_in_kilometres_are_told_or_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dem.tif");
    let write = |value: &dyn Fn(usize) -> f32| {
        let values: Vec<f32> = (0..64 * 64).map(value).collect();
        let bands = vec![perilune_engine::raster::GeoTiffBand { name: "height", unit: "", values: &values }];
        let geotransform = [0.0, 100.0, 0.0, 0.0, 0.0, -100.0];
        let crs = "+proj=eqc +R=1737400 +units=m";
        perilune_engine::raster::GeoTiff { columns: 64, rows: 64, bands, crs, geotransform }.write(&path).unwrap();
    };
    let open = |values: Values, unit: Option<&str>| {
        let reading = Reading { unit: unit.map(str::to_string), ..Reading::default() };
        Dem::open(&path, &Body::moon(), &Options { reading, values, ..Options::default() })
    };
    write(&|index| 1737.4 + 1e-3 * (index % 64) as f32);
    let error = open(Values::Auto, None).unwrap_err();
    assert!(matches!(error, Error::Ambiguous { .. }) && error.to_string().contains("unit: \"km\""), "{error}");
    for dem in [open(Values::Radius, None), open(Values::Auto, Some("km"))] {
        assert!((dem.unwrap().heights_m[10] - 10.0).abs() < 0.1);
    }
    assert!((open(Values::Height, None).unwrap().heights_m[10] - 1737.41).abs() < 1e-3);
    write(&|index| 100.0 * (index % 64) as f32 - 1000.0);
    assert_eq!(open(Values::Auto, None).unwrap().heights_m[10], 0.0);
    let refused = open(Values::Auto, Some("K")).unwrap_err().to_string();
    assert!(refused.contains("its unit \"K\" is not known"), "{refused}");
}

/// `sim horizon` and its like take paths: a database is none.
#[test]
fn a_database_is_no_file() {
    let output = program(&["horizon", "PG:", "--output", "tiles"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && said.contains("local files"), "{said}");
}

/// Between its sources a VRT reads as 0 where it declares no nodata value.
#[test]
fn gaps_of_a_vrt_are_gaps() {
    let folder = tempfile::tempdir().unwrap();
    let values: Vec<f32> = (0..64 * 64).map(|index| 2000.0 + (index % 64) as f32).collect();
    let bands = vec![perilune_engine::raster::GeoTiffBand { name: "height", unit: "m", values: &values }];
    let geotransform = [0.0, 100.0, 0.0, 0.0, 0.0, -100.0];
    let crs = "+proj=eqc +R=1737400 +units=m";
    let source = folder.path().join("part.tif");
    perilune_engine::raster::GeoTiff { columns: 64, rows: 64, bands, crs, geotransform }.write(&source).unwrap();
    let wkt = gdal::spatial_ref::SpatialRef::from_proj4(crs).unwrap().to_wkt().unwrap().replace('"', "&quot;");
    let vrt = format!(
        "<VRTDataset rasterXSize=\"150\" rasterYSize=\"80\"><SRS>{wkt}</SRS>\
         <GeoTransform>0, 100, 0, 0, 0, -100</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource>\
         <SourceFilename relativeToVRT=\"1\">part.tif</SourceFilename><SourceBand>1</SourceBand>\
         <SrcRect xOff=\"0\" yOff=\"0\" xSize=\"64\" ySize=\"64\"/><DstRect xOff=\"50\" yOff=\"7\" xSize=\"64\" ySize=\"64\"/>\
         </SimpleSource></VRTRasterBand></VRTDataset>"
    );
    let path = folder.path().join("mosaic.vrt");
    std::fs::write(&path, vrt).unwrap();
    let dem = Dem::open(&path, &Body::moon(), &Options::default()).unwrap();
    for index in 0..150 * 80 {
        let (column, row) = (index % 150, index / 150);
        let inside = (50..114).contains(&column) && (7..71).contains(&row);
        assert_eq!(!dem.heights_m[index].is_nan(), inside, "{column} {row}");
    }
    assert_eq!(dem.heights_m[7 * 150 + 50], 2000.0);
}
