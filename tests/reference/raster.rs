//! Elevation models against closed forms and GDAL's own tools.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use glam::{DVec2, DVec3};
use perilune::geometry::{Body, Geodetic, Position};
use perilune::raster::{Band, Dem, Error, GeoTiff, Georeference, Options, Values, Window};
use perilune::terrain::build::MAX_NODES_PER_SIDE;
use perilune::terrain::{NestedDem, build_cube, build_face};

const R: f64 = 1_737_400.0;

/// Map projections of a sphere in closed form (Snyder 1987, USGS Professional Paper 1395), so that the
/// models below do not come from the code under test.
#[derive(Clone, Copy)]
enum Projection {
    Equirectangular,
    PolarStereographic,
    Orthographic { latitude_rad: f64, longitude_rad: f64 },
    Gnomonic { latitude_rad: f64, longitude_rad: f64 },
}

impl Projection {
    fn proj4(self) -> String {
        let azimuthal = |name: &str, latitude_rad: f64, longitude_rad: f64| {
            let (latitude_deg, longitude_deg) = (latitude_rad.to_degrees(), longitude_rad.to_degrees());
            format!("+proj={name} +lat_0={latitude_deg} +lon_0={longitude_deg} +R={R} +units=m +no_defs")
        };
        match self {
            Self::Equirectangular => format!("+proj=eqc +R={R} +units=m +no_defs"),
            Self::PolarStereographic => format!("+proj=stere +lat_0=90 +lon_0=0 +k=1 +R={R} +units=m +no_defs"),
            Self::Orthographic { latitude_rad, longitude_rad } => azimuthal("ortho", latitude_rad, longitude_rad),
            Self::Gnomonic { latitude_rad, longitude_rad } => azimuthal("gnom", latitude_rad, longitude_rad),
        }
    }

    /// Unit vector of a map point.
    fn direction(self, at: DVec2) -> DVec3 {
        match self {
            Self::Equirectangular => direction(at.y / R, at.x / R),
            Self::PolarStereographic => {
                let colatitude_rad = 2.0 * (at.length() / (2.0 * R)).atan();
                direction(PI / 2.0 - colatitude_rad, at.x.atan2(-at.y))
            }
            Self::Orthographic { latitude_rad, longitude_rad } => {
                let [east, north, up] = local(latitude_rad, longitude_rad);
                let plane = at / R;
                plane.x * east + plane.y * north + (1.0 - plane.length_squared()).sqrt() * up
            }
            Self::Gnomonic { latitude_rad, longitude_rad } => {
                let [east, north, up] = local(latitude_rad, longitude_rad);
                (at.x * east + at.y * north + R * up).normalize()
            }
        }
    }

    /// Map point of a latitude and longitude.
    fn map(self, latitude_rad: f64, longitude_rad: f64) -> DVec2 {
        let d = direction(latitude_rad, longitude_rad);
        match self {
            Self::Equirectangular => R * DVec2::new(longitude_rad, latitude_rad),
            Self::PolarStereographic => {
                let rho = 2.0 * R * ((PI / 2.0 - latitude_rad) / 2.0).tan();
                rho * DVec2::new(longitude_rad.sin(), -longitude_rad.cos())
            }
            Self::Orthographic { latitude_rad, longitude_rad } => {
                let [east, north, _] = local(latitude_rad, longitude_rad);
                R * DVec2::new(d.dot(east), d.dot(north))
            }
            Self::Gnomonic { latitude_rad, longitude_rad } => {
                let [east, north, up] = local(latitude_rad, longitude_rad);
                R * DVec2::new(d.dot(east), d.dot(north)) / d.dot(up)
            }
        }
    }
}

fn direction(latitude_rad: f64, longitude_rad: f64) -> DVec3 {
    let (sin_lat, cos_lat) = latitude_rad.sin_cos();
    DVec3::new(cos_lat * longitude_rad.cos(), cos_lat * longitude_rad.sin(), sin_lat)
}

fn local(latitude_rad: f64, longitude_rad: f64) -> [DVec3; 3] {
    let up = direction(latitude_rad, longitude_rad);
    let east = DVec3::new(-longitude_rad.sin(), longitude_rad.cos(), 0.0);
    [east, up.cross(east), up]
}

/// A raster whose pixels hold `height(direction)`.
struct Model {
    projection: Projection,
    columns: usize,
    rows: usize,
    geotransform: [f64; 6],
}

impl Model {
    /// Square pixels about a map point, which lies on a pixel's corner.
    fn about(projection: Projection, centre: DVec2, half: usize, pixel: f64) -> Self {
        let extent = half as f64 * pixel;
        let geotransform = [centre.x - extent, pixel, 0.0, centre.y + extent, 0.0, -pixel];
        Self { projection, columns: 2 * half, rows: 2 * half, geotransform }
    }

    fn directions(&self) -> impl Iterator<Item = DVec3> {
        let (g, projection, columns) = (self.geotransform, self.projection, self.columns);
        (0..columns * self.rows).map(move |index| {
            let (c, r) = ((index % columns) as f64 + 0.5, (index / columns) as f64 + 0.5);
            projection.direction(DVec2::new(g[0] + c * g[1] + r * g[2], g[3] + c * g[4] + r * g[5]))
        })
    }

    fn write(&self, path: &Path, height: impl Fn(DVec3) -> f64) {
        let values: Vec<f32> = self.directions().map(|direction| height(direction) as f32).collect();
        write(path, self.columns, self.rows, &self.projection.proj4(), self.geotransform, &values);
    }
}

fn write(path: &Path, columns: usize, rows: usize, crs: &str, geotransform: [f64; 6], values: &[f32]) {
    let bands = vec![Band { name: "height", unit: "m", values }];
    GeoTiff { columns, rows, bands, crs, geotransform }.write(path).unwrap();
}

fn gdal(program: &str, arguments: &[&str]) -> Option<String> {
    let output = std::process::Command::new(program).args(arguments).output().ok()?;
    assert!(output.status.success(), "{program} {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).unwrap())
}

fn data(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("SIM_DATA")
        .map_or_else(|| concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/data").into(), PathBuf::from);
    let path = folder.join("dem").join(name);
    if !path.exists() {
        eprintln!("skipped: no {name}");
    }
    path.exists().then_some(path)
}

fn open(path: &Path) -> Dem {
    Dem::open(path, &Body::moon(), &Options::default()).unwrap()
}

fn height_at(dem: &Dem, latitude_deg: f64, longitude_deg: f64) -> f64 {
    let point = Body::moon().position_from_geodetic(Geodetic::from_degrees(latitude_deg, longitude_deg, 0.0));
    dem.height_m(dem.georeference.projector().unwrap().pixels(&[point])[0])
}

fn mars() -> Body {
    Body { name: "mars".into(), naif_id: 499, equatorial_radius_m: 3_396_190.0, polar_radius_m: 3_376_200.0 }
}

/// Hard cases 23 and 24: a smooth hill at 60 degrees is the same on every map of it.
#[test]
fn the_same_hill_at_60_degrees_is_the_same_from_every_projection() {
    let folder = tempfile::tempdir().unwrap();
    let (latitude_rad, longitude_rad) = (60f64.to_radians(), 25f64.to_radians());
    let summit = direction(latitude_rad, longitude_rad);
    // A cone of 30 degrees with a rounded tip, by distance along the ground.
    let height = |d: DVec3| {
        let ground_m = R * d.cross(summit).length().atan2(d.dot(summit));
        3000.0 - 30f64.to_radians().tan() * (ground_m * ground_m + 400.0 * 400.0).sqrt()
    };
    let projections = [
        (Projection::Equirectangular, 10.0),
        (Projection::PolarStereographic, 10.0),
        (Projection::Orthographic { latitude_rad: 1.03, longitude_rad: 0.44 }, 10.0),
        (Projection::Gnomonic { latitude_rad, longitude_rad }, 10.0),
    ];
    for (projection, pixel_m) in projections {
        let path = folder.path().join("cone.tif");
        Model::about(projection, projection.map(latitude_rad, longitude_rad), 300, pixel_m).write(&path, height);
        let dem = open(&path);
        let nested = NestedDem { dem: &dem, posting_m: Some(20.0), extent_m: Some(2400.0) };
        let centre = Geodetic { latitude_rad, longitude_east_rad: longitude_rad, height_m: 0.0 };
        let (face, _) = build_face(&Body::moon(), centre, &[nested], MAX_NODES_PER_SIDE).unwrap();
        let level = &face.levels[0];
        assert!(level.columns >= 119 && !level.gap.contains(&true), "{}", projection.proj4());
        for row in 0..level.rows {
            for column in 0..level.columns {
                let lifted = level.lifted_node(column, row);
                let direction = face.map.body_from_lifted(lifted).vector_m().normalize();
                let got = face.map.radius_from_lifted_m(lifted) - R;
                // Keys' interpolation errs by h³ times a third derivative: (20 m)³/(400 m)² here, a few mm.
                assert!((got - height(direction)).abs() < 0.01, "{} {got}", projection.proj4());
            }
        }
    }
}

/// A model on the level's own grid is taken over to the last bit that `f32` leaves.
#[test]
fn a_gnomonic_model_about_the_centre_is_taken_over_sample_by_sample() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rough.tif");
    let (latitude_rad, longitude_rad) = ((-85f64).to_radians(), 0.6);
    let model = Model::about(Projection::Gnomonic { latitude_rad, longitude_rad }, DVec2::ZERO, 64, 20.0);
    model.write(&path, |d| 500.0 * (d * 9e4).sin().x);
    let dem = open(&path);
    let centre = Geodetic { latitude_rad, longitude_east_rad: longitude_rad, height_m: 0.0 };
    let (face, errors) = build_face(&Body::moon(), centre, &[NestedDem::whole(&dem)], MAX_NODES_PER_SIDE).unwrap();
    let level = &face.levels[0];
    assert_eq!((level.columns, level.rows, level.posting_m), (128, 128, 20.0));
    for (index, sample) in dem.heights_m.iter().enumerate() {
        let (column, row) = (index % 128, 127 - index / 128);
        let got = face.map.radius_from_lifted_m(level.lifted_node(column, row)) - R;
        assert!((got - f64::from(*sample)).abs() < 4e-5, "half a unit in the last place of 500 m: {got} {sample}");
    }
    assert!(errors[0].max_m < 4e-5 && errors[0].samples > 16_000, "{errors:?}");
}

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

#[test]
fn a_pole_inside_a_polar_raster_is_a_point_like_any_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("polar.tif");
    let plane = |d: DVec3| 1e5 * d.x - 5e4 * d.y;
    Model::about(Projection::PolarStereographic, DVec2::ZERO, 100, 100.0).write(&path, plane);
    let dem = open(&path);
    let centre = Geodetic::from_degrees(90.0, 0.0, 0.0);
    let (face, errors) = build_face(&Body::moon(), centre, &[NestedDem::whole(&dem)], 400).unwrap();
    let level = &face.levels[0];
    assert!(level.columns >= 198 && !level.gap.contains(&true));
    for (column, row) in [(0, 0), (100, 99), (99, 100), (level.columns - 1, 7)] {
        let point = face.map.body_from_lifted(level.lifted_node(column, row)).vector_m();
        assert!((point.length() - R - plane(point.normalize())).abs() < 1e-3);
    }
    // A grid of its own spacing, so that samples fall on nodes but for the stretch of the map.
    assert!(errors[0].rms_m < 1e-3, "{errors:?}");
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

/// Hard case 29: a sphere's latitude is planetocentric, a spheroid's planetographic.
#[test]
fn latitude_is_measured_on_the_figure_of_the_crs() {
    let folder = tempfile::tempdir().unwrap();
    // North-south ramps of 100 m a degree of the raster's own latitude.
    let heights: Vec<f32> = (0..200 * 200).map(|index| 100.0 * (50.0 - (index / 200) as f32 * 0.1)).collect();
    let geotransform = [-10.05, 0.1, 0.0, 50.05, 0.0, -0.1];
    let point = Geodetic::from_degrees(45.0, 0.0, 0.0);
    let position = mars().position_from_geodetic(point);
    // tan(planetocentric) = (b/a)² tan(planetographic).
    let ratio = mars().polar_radius_m / mars().equatorial_radius_m;
    let planetocentric_deg = (ratio * ratio).atan().to_degrees();
    for (crs, expected_deg) in [
        ("+proj=longlat +R=3396190 +no_defs", planetocentric_deg),
        ("+proj=longlat +a=3396190 +b=3376200 +no_defs", 45.0),
    ] {
        let path = folder.path().join("ramp.tif");
        write(&path, 200, 200, crs, geotransform, &heights);
        let dem = Dem::open(&path, &mars(), &Options::default()).unwrap();
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
    let (a, b) = (mars().equatorial_radius_m, mars().polar_radius_m);
    let radii: Vec<f32> = (0..360 * 180)
        .map(|index| {
            let latitude_rad = (89.5 - (index / 360) as f64).to_radians();
            (1.0 / ((latitude_rad.cos() / a).powi(2) + (latitude_rad.sin() / b).powi(2)).sqrt()) as f32
        })
        .collect();
    write(&path, 360, 180, "+proj=longlat +R=3396190 +no_defs", [0.0, 1.0, 0.0, 90.0, 0.0, -1.0], &radii);
    let dem = Dem::open(&path, &mars(), &Options::default()).unwrap();
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
    let point = mars().position_from_geodetic(Geodetic::from_degrees(0.0, 20.0, 0.0));
    assert!((ographic.projector().unwrap().pixels(&[point])[0].x - 339.5).abs() < 1e-6);
}

/// Hard case 27: a hole is a gap with the heights around it, and far from it nothing changes.
#[test]
fn a_hole_is_a_gap_without_a_cliff() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hole.tif");
    let model = Model::about(Projection::Gnomonic { latitude_rad: 0.3, longitude_rad: 0.5 }, DVec2::ZERO, 50, 10.0);
    let hole = direction(0.3, 0.5);
    model.write(&path, |d| if R * d.distance(hole) < 100.0 { f64::NAN } else { 700.0 });
    let dem = open(&path);
    let centre = Geodetic { latitude_rad: 0.3, longitude_east_rad: 0.5, height_m: 0.0 };
    let (face, _) = build_face(&Body::moon(), centre, &[NestedDem::whole(&dem)], 400).unwrap();
    let level = &face.levels[0];
    let gaps = level.gap.iter().filter(|gap| **gap).count();
    assert!((gaps as f64 - PI * 100.0).abs() < 20.0, "area of the hole in nodes: {gaps}");
    for row in 0..level.rows {
        for column in 0..level.columns {
            let height = face.map.radius_from_lifted_m(level.lifted_node(column, row)) - R;
            assert!((height - 700.0).abs() < 1e-3, "{height}");
        }
    }
}

/// A fine model of another height and roughness than the coarse one under it.
#[test]
fn nested_levels_meet_without_a_crack() {
    let folder = tempfile::tempdir().unwrap();
    let (fine_path, coarse_path) = (folder.path().join("fine.tif"), folder.path().join("coarse.tif"));
    let (latitude_rad, longitude_rad) = (-1.5, 2.0);
    let waves = |d: DVec3| 300.0 * (d * 2e3).sin().x + 30.0 * (d * 2.3e4).sin().y;
    let stere = Projection::Gnomonic { latitude_rad: -1.49, longitude_rad: 2.1 };
    let middle = stere.map(latitude_rad, longitude_rad);
    Model::about(stere, middle, 200, 20.0).write(&fine_path, |d| waves(d) + 4.0);
    Model::about(stere, middle, 150, 240.0).write(&coarse_path, waves);
    let (fine, coarse) = (open(&fine_path), open(&coarse_path));
    let centre = Geodetic { latitude_rad, longitude_east_rad: longitude_rad, height_m: 0.0 };
    let dems = [NestedDem::whole(&fine), NestedDem::whole(&coarse)];
    let (face, _) = build_face(&Body::moon(), centre, &dems, MAX_NODES_PER_SIDE).unwrap();
    let [fine, coarse] = &face.levels[..] else { panic!("two levels") };
    assert_eq!(coarse.posting_m, 12.0 * fine.posting_m);
    let offset = (fine.node_m(0, 0) - coarse.node_m(0, 0)) / fine.posting_m;
    assert!((offset - offset.round()).length() < 1e-6, "one lattice");
    let mut inner: f64 = 0.0;
    for row in 0..fine.rows {
        for column in 0..fine.columns {
            let under = coarse.bilinear_m(coarse.grid_from_map(fine.node_m(column, row))).unwrap();
            let step = (fine.height_m(column, row) - under).abs();
            let border = column == 0 || row == 0 || column == fine.columns - 1 || row == fine.rows - 1;
            assert!(!border || step < 1e-3, "border stands {step} m off");
            inner = inner.max(step);
        }
    }
    assert!(inner > 4.0, "the fine level has its own heights inside: {inner}");
    assert!(!fine.gap.contains(&true), "corners outside the turned fine model rest on coarse data");
}

#[test]
fn a_level_too_large_says_what_would_fit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.tif");
    Model::about(Projection::PolarStereographic, DVec2::ZERO, 50, 10.0).write(&path, |_| 0.0);
    let dem = open(&path);
    let build = |nested| build_face(&Body::moon(), Geodetic::from_degrees(90.0, 0.0, 0.0), &[nested], 50);
    let message = build(NestedDem::whole(&dem)).unwrap_err().to_string();
    assert!(message.contains("posting_m = 20 or extent_m = 490 fits"), "{message}");
    assert!(build(NestedDem { posting_m: Some(20.0), ..NestedDem::whole(&dem) }).is_ok());
    assert!(build(NestedDem { extent_m: Some(490.0), ..NestedDem::whole(&dem) }).is_ok());
}

#[test]
fn levels_out_of_step_or_apart_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dem.tif");
    Model::about(Projection::PolarStereographic, DVec2::ZERO, 50, 10.0).write(&path, |_| 0.0);
    let dem = open(&path);
    let whole = NestedDem::whole(&dem);
    let at_pole = Geodetic::from_degrees(90.0, 0.0, 0.0);
    let build = |centre, dems: &[NestedDem]| build_face(&Body::moon(), centre, dems, 400).map(|_| ());
    let message = |result: Result<(), _>| format!("{}", result.unwrap_err());
    assert!(message(build(at_pole, &[])).contains("at least one"));
    assert!(message(build(at_pole, &[whole, whole])).contains("whole multiple"));
    let uneven = NestedDem { posting_m: Some(25.0), ..whole };
    assert!(message(build(at_pole, &[whole, uneven])).contains("posting_m = 25 is not a whole multiple"));
    let negative = NestedDem { posting_m: Some(-1.0), ..whole };
    assert!(message(build(at_pole, &[negative])).contains("posting_m = -1"));
    let elsewhere = Geodetic::from_degrees(10.0, 0.0, 0.0);
    assert!(build(elsewhere, &[whole]).is_err());
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
    let second = Options { band: Some(2), ..Options::default() };
    assert!(matches!(Dem::open(&good, &moon, &second).unwrap_err(), Error::NoSuchBand { bands: 1, .. }));

    let values = vec![0.0; 64];
    let band = Band { name: "a", unit: "m", values: &values };
    let bands = vec![band, Band { name: "b", ..band }];
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
        assert!(matches!(refuse(&plain), Error::NoCrs { .. }), "{}", refuse(&plain));
    }
}

#[test]
fn a_window_and_an_average_lie_where_the_whole_does() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tilt.tif");
    let tilt = |d: DVec3| 4e4 * d.x + 1e5 * d.z;
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
        // The mean of a 400 m square of a sphere of curvature 1e5/R² m⁻¹ is off by 0.4 mm, plus f32.
        let got = height_at(&dem, latitude_deg, longitude_deg);
        assert!((got - expected).abs() < 5e-3, "{options:?}: {got} {expected}");
    }
    let dem = Dem::open(&path, &Body::moon(), &Options { posting_m: Some(410.0), ..Options::default() }).unwrap();
    assert_eq!((dem.columns, dem.rows), (30, 30));
}

/// Every pair of neighbouring faces has the same points along its edge.
#[test]
fn faces_of_a_cube_share_their_edges() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("global.tif");
    let (columns, pixel) = (720, PI * R / 360.0);
    let geotransform = [0.0, pixel, 0.0, PI / 2.0 * R, 0.0, -pixel];
    let bump = |d: DVec3| 2000.0 * (5.0 * d.x).sin() + 500.0 * d.y * d.z;
    Model { projection: Projection::Equirectangular, columns, rows: 360, geotransform }.write(&path, bump);
    let centre = Geodetic::from_degrees(20.0, 30.0, 0.0);
    let (faces, error) = build_cube(&Body::moon(), centre, &open(&path), 40_000.0, 300_000.0, 400).unwrap();
    let edge_points = |face: &perilune::terrain::Face| {
        let level = &face.levels[0];
        let (low, high) = (level.margin, level.columns - 1 - level.margin);
        let at = |column, row| face.map.body_from_lifted(level.lifted_node(column, row)).vector_m();
        (low..=high)
            .flat_map(|along| [at(along, low), at(along, high), at(low, along), at(high, along)])
            .collect::<Vec<DVec3>>()
    };
    let points: Vec<DVec3> = faces.iter().flat_map(edge_points).collect();
    for point in &points {
        let twins = points.iter().filter(|other| other.distance(*point) < 0.01).count();
        // Twelve edges are held by two faces; a corner by three, each of which lists it twice.
        assert!(twins == 2 || twins == 6, "{twins} points at {point}");
    }
    for face in &faces {
        let level = &face.levels[0];
        assert!(level.margin as f64 * level.posting_m >= 300_000.0 && !level.gap.contains(&true));
        let corner = face.map.body_from_lifted(level.lifted_node(level.margin, level.margin)).vector_m();
        // Keys on half-degree pixels, and a lifted height of −1272 km in f32 (0.06 m).
        assert!((corner.length() - R - bump(corner.normalize())).abs() < 0.2);
    }
    // Bilinear in H is not bilinear in radius: posting²/(8R) in each direction, 230 m at 40 km.
    assert!(error.samples > 200_000 && error.max_m < 240.0, "{error:?}");
}

/// Against `gdallocationinfo`, which reads the pixel under a latitude and longitude.
#[test]
fn site01_heights_are_what_gdallocationinfo_reads() {
    let Some(path) = data("site01_connecting_ridge_10m_1600.tif") else { return };
    let dem = open(&path);
    for (column, row) in [(10, 20), (800, 800), (333, 1444), (1590, 7), (1200, 640)] {
        let centre = DVec2::new(f64::from(column), f64::from(row));
        let (x, y) = (-19_000.0 + 10.0 * (centre.x + 0.5), -4_000.0 - 10.0 * (centre.y + 0.5));
        // South polar stereographic in closed form: x = ρ sin λ, y = ρ cos λ.
        let latitude_deg = -90.0 + 2.0 * (f64::hypot(x, y) / (2.0 * R)).atan().to_degrees();
        let longitude_deg = x.atan2(y).to_degrees();
        let by_map = ["-valonly", "-geoloc", path.to_str().unwrap(), &x.to_string(), &y.to_string()];
        let Some(expected) = gdal("gdallocationinfo", &by_map) else { return };
        let expected: f64 = expected.trim().parse().unwrap();
        let got = height_at(&dem, latitude_deg, longitude_deg);
        assert!((got - expected).abs() < 0.05, "{got} {expected}");
    }
}

#[test]
fn site01_nests_in_the_polar_cap() {
    let (Some(site), Some(cap)) = (data("site01_connecting_ridge_10m_1600.tif"), data("southcap_240m_1536.tif")) else {
        return;
    };
    let (site, cap) = (open(&site), open(&cap));
    let centre = Geodetic::from_degrees(-89.463, -137.49, 0.0);
    let start = std::time::Instant::now();
    let dems = [NestedDem::whole(&site), NestedDem::whole(&cap)];
    let (face, errors) = build_face(&Body::moon(), centre, &dems, MAX_NODES_PER_SIDE).unwrap();
    eprintln!("{:?} {errors:?}", start.elapsed());
    let [fine, coarse] = &face.levels[..] else { panic!("two levels") };
    eprintln!(
        "{} x {} at {}, {} x {} at {}",
        fine.columns, fine.rows, fine.posting_m, coarse.columns, coarse.rows, coarse.posting_m
    );
    assert!((fine.posting_m, coarse.posting_m) == (10.0, 240.0));
    // The cap's corners are 260 km from the pole.
    assert!(coarse.columns as f64 * 240.0 > 500_000.0);
    assert!(coarse.gap.contains(&true) && !fine.gap.contains(&true));
    for (row, column) in
        (0..fine.rows).map(|row| (row, 0)).chain((0..fine.columns).map(|column| (fine.rows - 1, column)))
    {
        let under = coarse.bilinear_m(coarse.grid_from_map(fine.node_m(column, row))).unwrap();
        assert!((fine.height_m(column, row) - under).abs() < 1e-3);
    }
    assert!(errors[0].rms_m < 1.0 && errors[0].samples > 200_000, "{errors:?}");
}

#[test]
fn gale_builds_on_a_spheroid_with_its_gaps() {
    let Some(path) = data("mars_gale_hirise_1m_348x337.tif") else { return };
    let dem = Dem::open(&path, &mars(), &Options::default()).unwrap();
    let middle = DVec2::new(174.0, 168.0);
    let centre = mars().geodetic_from_position(dem.points(&mars(), &[middle]).unwrap()[0]);
    let (face, errors) = build_face(&mars(), centre, &[NestedDem::whole(&dem)], MAX_NODES_PER_SIDE).unwrap();
    let level = &face.levels[0];
    let gaps = level.gap.iter().filter(|gap| **gap).count();
    eprintln!(
        "{} x {} at {}: {gaps} gaps of {} nodata, {errors:?}",
        level.columns,
        level.rows,
        level.posting_m,
        dem.nodata_share()
    );
    assert!(level.heights_m.iter().all(|height| (-5000.0..-4000.0).contains(height)));
    assert!(errors[0].rms_m < 0.1, "{errors:?}");
    let node = face.map.body_from_lifted(level.lifted_node(level.columns / 2, level.rows / 2));
    let there = mars().geodetic_from_position(node);
    let pixel = dem.georeference.projector().unwrap().pixels(&[node])[0];
    assert!((there.height_m - dem.height_m(pixel)).abs() < 1e-3, "{there:?}");
}

#[test]
fn the_global_model_builds_a_cube() {
    let Some(path) = data("moon_gld100_16ppd_global.tif") else { return };
    let options = Options { posting_m: Some(8000.0), ..Options::default() };
    let dem = Dem::open(&path, &Body::moon(), &options).unwrap();
    let start = std::time::Instant::now();
    let centre = Geodetic::from_degrees(-89.0, 10.0, 0.0);
    let (faces, error) = build_cube(&Body::moon(), centre, &dem, 8000.0, 300_000.0, MAX_NODES_PER_SIDE).unwrap();
    eprintln!("{:?} {} nodes a side, {error:?}", start.elapsed(), faces[0].levels[0].columns);
    assert!(faces.iter().all(|face| !face.levels[0].gap.contains(&true)));
    // Heights of the Moon lie between −9.2 and 10.8 km.
    for face in &faces {
        let level = &face.levels[0];
        for index in (0..level.heights_m.len()).step_by(97) {
            let lifted = level.lifted_node(index % level.columns, index / level.columns);
            let point: Position<_> = face.map.body_from_lifted(lifted);
            assert!((-9_300.0..10_900.0).contains(&(point.vector_m().length() - R)));
        }
    }
}
