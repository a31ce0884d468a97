//! Elevation models against closed forms and GDAL's own tools.

mod levels;
mod models;
mod real;

use std::f64::consts::PI;
use std::path::Path;

use glam::{DVec2, DVec3};
use perilune_engine::geometry::{Body, Geodetic};
use perilune_engine::raster::{Dem, Error, GeoTiff, GeoTiffBand, Georeference, Options, Reading, Values, Window};

use models::*;

/// Hard cases 25 and 26: half a pixel, row order.
#[test]
fn points_areas_and_south_up_rasters_lie_where_gdal_puts_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("area.tif");
    let tilt = |d: DVec3| 1000.0 * d.z + 3000.0 * d.y;
    let model = Model::about(Projection::Equirectangular, DVec2::new(9e5, 5e5), 20, 1000.0);
    model.write(&path, tilt);
    let (latitude_deg, longitude_deg) = ((5.003e5 / R).to_degrees(), (9.004e5 / R).to_degrees());
    let expected = tilt(direction(5.003e5 / R, 9.004e5 / R));
    // Bicubic on a field this smooth errs by the f32 of its samples.
    assert!((height_at(&open(&path), latitude_deg, longitude_deg) - expected).abs() < 3e-4);

    let south_up = Model { geotransform: [8.8e5, 1000.0, 0.0, 4.8e5, 0.0, 1000.0], ..model };
    let turned = folder.path().join("south_up.tif");
    south_up.write(&turned, tilt);
    assert!((height_at(&open(&turned), latitude_deg, longitude_deg) - expected).abs() < 3e-4);

    let rotated = Model { geotransform: [8.8e5, 800.0, 600.0, 5.1e5, 600.0, -800.0], ..south_up };
    let oblique = folder.path().join("rotated.tif");
    rotated.write(&oblique, tilt);
    assert!((height_at(&open(&oblique), latitude_deg, longitude_deg) - expected).abs() < 3e-4);

    // The same corners in a file whose samples are points: GDAL moves the tie point by half a pixel.
    let point = folder.path().join("point.tif");
    let arguments = ["-q", "-mo", "AREA_OR_POINT=Point", path.to_str().unwrap(), point.to_str().unwrap()];
    if gdal("gdal_translate", &arguments).is_some() {
        assert!((height_at(&open(&point), latitude_deg, longitude_deg) - expected).abs() < 3e-4);
    }
}

/// Hard cases 21 and 22, on models that start at longitudes −180 and 0.
#[test]
fn a_global_model_is_whole_over_its_seam_and_its_poles() {
    let folder = tempfile::tempdir().unwrap();
    let bump = |d: DVec3| 2000.0 * d.x + 500.0 * d.y * d.z - 800.0 * d.z;
    let mut at_pole = Vec::new();
    for west_deg in [-180.0f64, 0.0, 90.0] {
        let path = folder.path().join("global.tif");
        let (columns, pixel) = (720, PI * R / 360.0);
        let geotransform = [west_deg.to_radians() * R, pixel, 0.0, PI / 2.0 * R, 0.0, -pixel];
        Model { projection: Projection::Equirectangular, columns, rows: 360, geotransform }.write(&path, bump);
        let dem = open(&path);
        for latitude_deg in [-89.9, -89.6, -60.0, 0.1, 33.0, 89.7, 89.95] {
            for longitude_deg in [-180.0, -179.9, -0.1, 0.0, 0.2, 89.9, 90.1, 179.9, 180.0, 271.0, 359.9] {
                let expected = bump(direction(f64::to_radians(latitude_deg), f64::to_radians(longitude_deg)));
                let got = height_at(&dem, latitude_deg, longitude_deg);
                // Half a pixel about the poles is a cone: 2000 m sin(0.25 deg)/4.
                let tolerance_m = if latitude_deg.abs() > 89.75 { 5.0 } else { 0.02 };
                assert!(
                    (got - expected).abs() < tolerance_m,
                    "{west_deg} {latitude_deg} {longitude_deg}: {got} {expected}"
                );
            }
        }
        let pole: Vec<f64> = [0.0, 77.0, -100.0].map(|longitude_deg| height_at(&dem, 90.0, longitude_deg)).into();
        // 1e-9 of the pole's own height, from the rounding of the row that it is the mean of.
        assert!(pole.iter().all(|height| (height - pole[0]).abs() < 1e-6 && (height + 800.0).abs() < 0.1), "{pole:?}");
        at_pole.push(pole[0]);
    }
}

/// Hard cases 26 and 30: scale, offset, radius, and the sentinel of 16-bit rasters.
#[test]
fn scaled_integers_and_radii_become_heights() {
    let folder = tempfile::tempdir().unwrap();
    let (plain, scaled) = (folder.path().join("plain.tif"), folder.path().join("scaled.tif"));
    let values: Vec<f32> =
        (0..100).map(|index| if index == 42 { -32768.0 } else { 2.0 * index as f32 - 300.0 }).collect();
    let crs = Projection::Equirectangular.proj4();
    write(&plain, 10, 10, &crs, [0.0, 100.0, 0.0, 0.0, 0.0, -100.0], &values);
    let (from, to) = (plain.to_str().unwrap(), scaled.to_str().unwrap());
    let as_radius = ["-q", "-ot", "Int16", "-a_nodata", "none", "-a_scale", "0.5", "-a_offset", "1737400", from, to];
    if gdal("gdal_translate", &as_radius).is_none() {
        eprintln!("skipped: no gdal_translate");
        return;
    }
    let dem = open(&scaled);
    assert!(dem.heights_m[42].is_nan());
    assert_eq!(dem.heights_m[99], 0.5 * (2.0 * 99.0 - 300.0));
    assert_eq!(dem.heights_m[0], -150.0);
    let as_height = Options { values: Values::Height, ..Options::default() };
    let dem = Dem::open(&scaled, &Body::moon(), &as_height).unwrap();
    assert_eq!(dem.heights_m[0], (R - 150.0) as f32);
}

/// Hard case 27: whatever a file says that it does not know is NaN, and nothing else is.
#[test]
fn declared_and_undeclared_missing_values_are_missing() {
    let folder = tempfile::tempdir().unwrap();
    let (plain, declared) = (folder.path().join("plain.tif"), folder.path().join("declared.tif"));
    let mut values = vec![5.0; 100];
    values[..5].copy_from_slice(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -9999.0, -32768.0]);
    let crs = Projection::Equirectangular.proj4();
    write(&plain, 10, 10, &crs, [0.0, 100.0, 0.0, 0.0, 0.0, -100.0], &values);
    let missing = |path: &Path| -> Vec<usize> {
        let heights_m = open(path).heights_m;
        (0..100).filter(|index| heights_m[*index].is_nan()).collect()
    };
    // The Moon has no ground so low: −9999 and −32768 once each.
    let error = Dem::open(&plain, &Body::moon(), &Options::default()).unwrap_err();
    assert!(matches!(error, Error::Implausible { stored: -32768.0 | -9999.0, count: 1, wrong: 2, .. }), "{error}");
    let written = |nodata: f64| Reading { nodata: Some(nodata), ..Reading::default() };
    values[4] = 5.0;
    write(&plain, 10, 10, &crs, [0.0, 100.0, 0.0, 0.0, 0.0, -100.0], &values);
    let options = Options { reading: written(-9999.0), ..Options::default() };
    let heights_m = Dem::open(&plain, &Body::moon(), &options).unwrap().heights_m;
    assert_eq!((0..100).filter(|index| heights_m[*index].is_nan()).collect::<Vec<_>>(), [0, 1, 2, 3]);
    let arguments = ["-q", "-a_nodata", "-9999", plain.to_str().unwrap(), declared.to_str().unwrap()];
    if gdal("gdal_translate", &arguments).is_some() {
        assert_eq!(missing(&declared), [0, 1, 2, 3]);
    }
}

/// Hard case 29: a sphere's latitude is planetocentric, a spheroid's planetographic.
#[test]
fn latitude_is_measured_on_the_figure_of_the_crs() {
    let folder = tempfile::tempdir().unwrap();
    // North-south ramps of 100 m a degree of the raster's own latitude.
    let heights: Vec<f32> = (0..200 * 200).map(|index| 100.0 * (50.0 - (index / 200) as f32 * 0.1)).collect();
    let geotransform = [-10.05, 0.1, 0.0, 50.05, 0.0, -0.1];
    let point = Geodetic::from_degrees(45.0, 0.0, 0.0);
    let position = Body::mars().position_from_geodetic(point);
    // tan(planetocentric) = (b/a)² tan(planetographic).
    let ratio = Body::mars().polar_radius_m / Body::mars().equatorial_radius_m;
    let planetocentric_deg = (ratio * ratio).atan().to_degrees();
    for (crs, expected_deg) in [
        ("+proj=longlat +R=3396190 +no_defs", planetocentric_deg),
        ("+proj=longlat +a=3396190 +b=3376200 +no_defs", 45.0),
    ] {
        let path = folder.path().join("ramp.tif");
        write(&path, 200, 200, crs, geotransform, &heights);
        let dem = Dem::open(&path, &Body::mars(), &Options::default()).unwrap();
        let got = dem.height_m(dem.georeference.projector().unwrap().pixels(&[position])[0]);
        assert!((got / 100.0 - expected_deg).abs() < 1e-5, "{crs}: {got}");
    }
    assert!((45.0 - planetocentric_deg - 0.338).abs() < 5e-4);
}

/// A radius raster on a spheroid: the spheroid itself has height 0 everywhere.
#[test]
fn the_radii_of_a_spheroid_are_heights_of_zero_on_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("radius.tif");
    let (a, b) = (Body::mars().equatorial_radius_m, Body::mars().polar_radius_m);
    let radii: Vec<f32> = (0..360 * 180)
        .map(|index| {
            let latitude_rad = (89.5 - (index / 360) as f64).to_radians();
            (1.0 / ((latitude_rad.cos() / a).powi(2) + (latitude_rad.sin() / b).powi(2)).sqrt()) as f32
        })
        .collect();
    write(&path, 360, 180, "+proj=longlat +R=3396190 +no_defs", [0.0, 1.0, 0.0, 90.0, 0.0, -1.0], &radii);
    let dem = Dem::open(&path, &Body::mars(), &Options::default()).unwrap();
    // Half a unit in the last place of the stored radius.
    assert!(dem.heights_m.iter().all(|height| height.abs() < 0.13), "{:?}", &dem.heights_m[..3]);
}

/// Axis order and west-positive longitude as the IAU registry has them.
#[test]
fn crs_of_the_iau_registry_keep_x_east() {
    let folder = tempfile::tempdir().unwrap();
    let heights: Vec<f32> = (0..100).map(|index| (index % 10) as f32).collect();
    for (crs, body, x0) in
        [("IAU_2015:30100", Body::moon(), 20.0), ("IAU_2015:30110", Body::moon(), 20f64.to_radians() * R)]
    {
        let path = folder.path().join("iau.tif");
        let step = x0.abs() / 20.0;
        write(&path, 10, 10, crs, [x0 - 0.5 * step, step, 0.0, 0.0, 0.0, -step], &heights);
        let dem = Dem::open(&path, &body, &Options::default()).unwrap();
        let at = |longitude_deg| body.position_from_geodetic(Geodetic::from_degrees(-3.0, longitude_deg, 0.0));
        let pixels = dem.georeference.projector().unwrap().pixels(&[at(20.0), at(22.0)]);
        assert!(pixels[0].x.abs() < 1e-6 && (pixels[1].x - 2.0).abs() < 1e-6, "{crs} {pixels:?}");
    }
    // GeoTIFF cannot say that longitude runs west; formats with a WKT can. Longitude 340 W is 20 E.
    let ographic = Georeference::new("IAU_2015:49901", [0.0, 1.0, 0.0, 90.0, 0.0, -1.0], 360).unwrap();
    let point = Body::mars().position_from_geodetic(Geodetic::from_degrees(0.0, 20.0, 0.0));
    assert!((ographic.projector().unwrap().pixels(&[point])[0].x - 339.5).abs() < 1e-6);
}

#[test]
fn what_is_wrong_with_a_file_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let moon = Body::moon();
    let refuse = |path: &Path| Dem::open(path, &moon, &Options::default()).unwrap_err();
    let crs = Projection::Equirectangular.proj4();
    let north_up = [0.0, 100.0, 0.0, 0.0, 0.0, -100.0];
    let write_as = |name: &str, crs: &str, side: usize, value: f32| {
        write(&at(name), side, side, crs, north_up, &vec![value; side * side]);
        at(name)
    };

    assert!(matches!(refuse(&at("absent.tif")), Error::File { .. }));
    assert!(matches!(refuse(folder.path()), Error::Directory { .. }));
    std::fs::write(at("text.tif"), "not a raster").unwrap();
    assert!(matches!(refuse(&at("text.tif")), Error::NotARaster { .. }));
    assert!(matches!(refuse(&write_as("dot.tif", &crs, 1, 0.0)), Error::TooSmall { columns: 1, .. }));
    assert!(matches!(refuse(&write_as("void.tif", &crs, 8, f32::NAN)), Error::AllNodata { .. }));
    assert!(matches!(refuse(&write_as("odd.tif", &crs, 8, 9e5)), Error::Implausible { .. }));
    let mars = write_as("mars.tif", "+proj=eqc +R=3396190 +units=m +no_defs", 8, 0.0);
    assert!(matches!(refuse(&mars), Error::OtherBody { .. }));
    let any = Options { any_body: true, ..Options::default() };
    assert!(Dem::open(&mars, &moon, &any).is_ok());

    let good = write_as("good.tif", &crs, 512, 1.0);
    let beyond = Window { column: 500, row: 0, columns: 20, rows: 2 };
    let windowed = |window| Dem::open(&good, &moon, &Options { window: Some(window), ..Options::default() });
    assert!(matches!(windowed(beyond).unwrap_err(), Error::Window { .. }));
    let second = Options { reading: Reading { band: Some(2), ..Reading::default() }, ..Options::default() };
    assert!(matches!(Dem::open(&good, &moon, &second).unwrap_err(), Error::NoSuchBand { bands: 1, .. }));

    let values = vec![0.0; 64];
    let band = GeoTiffBand { name: "a", unit: "m", values: &values };
    let bands = vec![band, GeoTiffBand { name: "b", ..band }];
    GeoTiff { columns: 8, rows: 8, bands, crs: &crs, geotransform: north_up }.write(&at("two.tif")).unwrap();
    assert!(matches!(refuse(&at("two.tif")), Error::ManyBands { bands: 2, .. }));
    assert!(Dem::open(&at("two.tif"), &moon, &second).is_ok());

    let noise: Vec<f32> = (0..512 * 512).map(|index: u32| index.wrapping_mul(2_654_435_761) as f32 / 1e6).collect();
    write(&at("noise.tif"), 512, 512, &crs, north_up, &noise);
    let bytes = std::fs::read(at("noise.tif")).unwrap();
    std::fs::write(at("cut.tif"), &bytes[..bytes.len() / 2]).unwrap();
    let error = refuse(&at("cut.tif"));
    assert!(matches!(error, Error::Damaged { .. } | Error::NotARaster { .. }), "{error}");
    assert!(
        std::fs::read_dir(folder.path()).unwrap().all(|f| !f.unwrap().file_name().to_string_lossy().contains(".part"))
    );

    let plain = at("plain.tif");
    let complex = at("complex.tif");
    let (from, to) = (good.to_str().unwrap(), complex.to_str().unwrap());
    if gdal("gdal_translate", &["-q", "-ot", "CFloat32", from, to]).is_some() {
        assert!(matches!(refuse(&complex), Error::NotReal { .. }));
        gdal("gdal_translate", &["-q", "-co", "PROFILE=BASELINE", from, plain.to_str().unwrap()]).unwrap();
        std::fs::remove_file(at("plain.tif.aux.xml")).unwrap();
        assert!(matches!(refuse(&plain), Error::NoCrs { .. }), "{}", refuse(&plain));
    }
}

#[test]
fn a_window_and_an_average_lie_where_the_whole_does() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tilt.tif");
    let tilt = |d: DVec3| 4e3 * d.x + 1e4 * d.z;
    Model::about(Projection::Equirectangular, DVec2::new(9e5, 5e5), 60, 100.0).write(&path, tilt);
    let (latitude_deg, longitude_deg) = ((5.003e5 / R).to_degrees(), (9.004e5 / R).to_degrees());
    let expected = tilt(direction(5.003e5 / R, 9.004e5 / R));
    let window = Some(Window { column: 31, row: 17, columns: 61, rows: 80 });
    for options in [
        Options { window, ..Options::default() },
        Options { posting_m: Some(410.0), ..Options::default() },
        Options { window, posting_m: Some(300.0), ..Options::default() },
    ] {
        let dem = Dem::open(&path, &Body::moon(), &options).unwrap();
        // The mean of a 400 m square of a sphere of curvature 1e4/R² m⁻¹ is off by 0.04 mm, plus f32.
        let got = height_at(&dem, latitude_deg, longitude_deg);
        assert!((got - expected).abs() < 5e-3, "{options:?}: {got} {expected}");
    }
    let dem = Dem::open(&path, &Body::moon(), &Options { posting_m: Some(410.0), ..Options::default() }).unwrap();
    assert_eq!((dem.columns, dem.rows), (30, 30));
}
