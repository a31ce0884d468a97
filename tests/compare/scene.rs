//! A hilly ground in closed form, seen by cameras whose ISDs are written here: a few lines that know nothing of the
//! program's cameras, terrain or shading.

use std::path::{Path, PathBuf};

use glam::{DMat3, DQuat, DVec3};
use perilune_engine::compare::{Freedom, Model};
use perilune_engine::compare::{GeometrySource, Request};
use perilune_engine::pipeline::AdapterChoice;
use perilune_engine::raster::{GeoTiff, GeoTiffBand};
use serde_json::{Value, json};

pub const R: f64 = 1_737_400.0;
const POSTING_M: f64 = 20.0;
const NODES: usize = 260;
/// Between the first pixel's centre and the ground's middle.
const HALF_M: f64 = POSTING_M * (NODES as f64 - 1.0) / 2.0;

/// Metres of longitude and latitude about (0, 0).
fn plane(direction: DVec3) -> [f64; 2] {
    [R * direction.y.atan2(direction.x), R * direction.z.asin()]
}

/// Hills and bowls of 120 to 300 m with slopes up to 25 degrees.
pub fn height_m(direction: DVec3) -> f64 {
    let [x, y] = plane(direction);
    (1..=60)
        .map(|k| {
            let turn = |step: f64| (f64::from(k) * step).fract();
            let (cx, cy) = ((turn(0.754_877_666) - 0.5) * 5000.0, (turn(0.569_840_291) - 0.5) * 5000.0);
            let width = 120.0 + 180.0 * turn(0.381_966);
            let height = width * if turn(0.618_034) > 0.5 { 0.22 } else { -0.25 };
            height * (-((x - cx).powi(2) + (y - cy).powi(2)) / (2.0 * width * width)).exp()
        })
        .sum()
}

/// The elevation model as a GeoTIFF.
pub fn write_dem(path: &Path) {
    let direction = |i: usize| {
        let (x, y) = ((i % NODES) as f64 * POSTING_M - HALF_M, HALF_M - (i / NODES) as f64 * POSTING_M);
        let (lon, lat) = (x / R, y / R);
        DVec3::new(lat.cos() * lon.cos(), lat.cos() * lon.sin(), lat.sin())
    };
    let values: Vec<f32> = (0..NODES * NODES).map(|i| height_m(direction(i)) as f32).collect();
    let edge_m = HALF_M + POSTING_M / 2.0;
    GeoTiff {
        columns: NODES,
        rows: NODES,
        bands: vec![GeoTiffBand { name: "height", unit: "m", values: &values }],
        crs: "+proj=eqc +R=1737400 +units=m +no_defs",
        geotransform: [-edge_m, POSTING_M, 0.0, edge_m, 0.0, -POSTING_M],
    }
    .write(path)
    .unwrap();
}

/// Lommel-Seeliger brightness of the ground along a ray, without cast shadows.
fn brightness(origin: DVec3, look: DVec3, sun: DVec3) -> f64 {
    let excess = |p: DVec3| p.length() - R - height_m(p.normalize());
    let mut p = origin;
    for _ in 0..60 {
        // Towards the ground along the ray, slope allowed for by not going all the way.
        p += 0.9 * excess(p) / -look.dot(p.normalize()) * look;
    }
    let slope = |axis: DVec3| (excess(p + 0.5 * axis) - excess(p - 0.5 * axis)) / 1.0;
    let normal = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).normalize();
    let (mu0, mu) = (normal.dot(sun).max(0.0), -normal.dot(look));
    mu0 / (mu0 + mu)
}

/// What carries the camera: where it is and how its sensor's axes (columns: x, y, boresight) lie, body-fixed.
pub trait Carrier {
    fn at(&self, time_s: f64) -> (DVec3, DMat3);
}

/// From south to north along longitude 0, 12 km up, looking down with x northwards, a little turned about the boresight.
pub struct Flight {
    pub speed_m_s: f64,
    pub twist_rad: f64,
}

impl Carrier for Flight {
    fn at(&self, time_s: f64) -> (DVec3, DMat3) {
        let lat = self.speed_m_s * time_s / R;
        let up = DVec3::new(lat.cos(), 0.0, lat.sin());
        let north = DVec3::new(-lat.sin(), 0.0, lat.cos());
        let x = DQuat::from_axis_angle(up, self.twist_rad) * north;
        (up * (R + 12_000.0), DMat3::from_cols(x, (-up).cross(x), -up))
    }
}

/// Square images of so many pixels.
pub const PIXELS: usize = 144;
/// 20 m from 12 km: 50 mm and 83.3 µm.
pub const FOCAL_MM: f64 = 50.0;
pub const PITCH_MM: f64 = FOCAL_MM * 20.0 / 12_000.0;

/// The body turns by this much a second, from this angle at time 0: so that J2000 is not body-fixed.
const SPIN_RAD_S: f64 = 1e-3;
const START_RAD: f64 = 0.4;

/// `body_from_j2000`.
fn body(time_s: f64) -> DQuat {
    DQuat::from_rotation_z(-(START_RAD + SPIN_RAD_S * time_s))
}

fn wxyz(q: DQuat) -> [f64; 4] {
    [q.w, q.x, q.y, q.z]
}

/// A direction to the Sun, by azimuth from north and elevation at (0, 0).
pub fn sun(azimuth_deg: f64, elevation_deg: f64) -> DVec3 {
    let (a, e) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
    DVec3::new(e.sin(), e.cos() * a.sin(), e.cos() * a.cos())
}

/// What all ISDs have in common. Tables run from −20 s to 20 s in steps of 1 s.
pub fn isd(model: &str, carrier: &dyn Carrier, sun: DVec3) -> Value {
    let times: Vec<f64> = (-20..=20).map(f64::from).collect();
    let j2000 = |time: f64| body(time).inverse();
    let positions: Vec<[f64; 3]> = times.iter().map(|&t| (j2000(t) * carrier.at(t).0 / 1e3).to_array()).collect();
    // sensor_from_j2000 = sensor_from_body · body_from_j2000
    let pointing: Vec<[f64; 4]> =
        times.iter().map(|&t| wxyz(DQuat::from_mat3(&carrier.at(t).1).inverse() * body(t))).collect();
    let turning: Vec<[f64; 4]> = times.iter().map(|&t| wxyz(body(t))).collect();
    let sun_km = j2000(0.0) * sun * 1.496e8;
    json!({
        "name_model": model,
        "image_lines": PIXELS, "image_samples": PIXELS,
        "focal2pixel_lines": [0.0, -1.0 / PITCH_MM, 0.0],
        "focal2pixel_samples": [0.0, 0.0, 1.0 / PITCH_MM],
        "focal_length_model": { "focal_length": FOCAL_MM },
        "detector_center": { "line": PIXELS as f64 / 2.0, "sample": PIXELS as f64 / 2.0 },
        "optical_distortion": { "radial": { "coefficients": [0.0, 0.0, 0.0] } },
        "radii": { "semimajor": 1737.4, "semiminor": 1737.4, "unit": "km" },
        "center_ephemeris_time": 0.0, "starting_ephemeris_time": 0.0,
        "instrument_position": { "unit": "km", "positions": positions, "ephemeris_times": times, "reference_frame": 1 },
        "instrument_pointing": { "quaternions": pointing, "ephemeris_times": times },
        "body_rotation": { "quaternions": turning, "ephemeris_times": times },
        "sun_position": { "unit": "km", "positions": [sun_km.to_array()], "ephemeris_times": [0.0] },
    })
}

/// A photograph, pixel by pixel: when, and where on the focal plane (mm, ideal), pixel (column, row) looks.
pub fn photograph(carrier: &dyn Carrier, sun: DVec3, pixel: impl Fn(f64, f64) -> (f64, [f64; 2])) -> Vec<f64> {
    let value = |i: usize| {
        let (time_s, [x, y]) = pixel((i % PIXELS) as f64, (i / PIXELS) as f64);
        let (position, axes) = carrier.at(time_s);
        brightness(position, (axes * DVec3::new(x, y, FOCAL_MM)).normalize(), sun)
    };
    (0..PIXELS * PIXELS).map(value).collect()
}

/// A case on disk.
pub struct Case {
    pub folder: tempfile::TempDir,
}

impl Case {
    pub fn new(isd: &Value, photo: &[f64]) -> Self {
        let case = Self { folder: tempfile::tempdir().unwrap() };
        write_dem(&case.path("dem.tif"));
        std::fs::write(case.path("isd.json"), isd.to_string()).unwrap();
        // 16 bits, and a black that is not 0.
        let dn = photo.iter().map(|value| (2000.0 + 60_000.0 * value).round() as u16).collect();
        let image = image::ImageBuffer::<image::Luma<u16>, Vec<u16>>::from_raw(PIXELS as u32, PIXELS as u32, dn);
        image.unwrap().save(case.path("photo.png")).unwrap();
        case
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn request(&self) -> Request {
        Request {
            photo: self.path("photo.png"),
            band: None,
            geometry: GeometrySource::File(self.path("isd.json")),
            dems: vec![self.path("dem.tif")],
            albedo: None,
            force: false,
            law: Some(perilune_engine::compare::Law::LommelSeeliger),
            freedom: Freedom::Similarity,
            fit_pose: false,
            model: Model::Gain,
            dark: 0.0,
            pixels: None,
            ablation: false,
            turn_sun: false,
            cache: self.path("cache"),
            adapter: AdapterChoice::Cpu,
        }
    }
}
