//! Models of elevation in closed form, and what else the tests share.

use std::f64::consts::PI;
use std::path::Path;

use glam::{DVec2, DVec3};
use perilune_engine::geometry::{Body, Geodetic};
use perilune_engine::raster::{Dem, GeoTiff, GeoTiffBand, Options};

pub const R: f64 = 1_737_400.0;

/// Map projections of a sphere in closed form (Snyder 1987, USGS Professional Paper 1395), so that the
/// models below do not come from the code under test.
#[derive(Clone, Copy)]
pub enum Projection {
    Equirectangular,
    PolarStereographic,
    Orthographic { latitude_rad: f64, longitude_rad: f64 },
    Gnomonic { latitude_rad: f64, longitude_rad: f64 },
}

impl Projection {
    pub fn proj4(self) -> String {
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
    pub fn direction(self, at: DVec2) -> DVec3 {
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
    pub fn map(self, latitude_rad: f64, longitude_rad: f64) -> DVec2 {
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

pub fn direction(latitude_rad: f64, longitude_rad: f64) -> DVec3 {
    let (sin_lat, cos_lat) = latitude_rad.sin_cos();
    DVec3::new(cos_lat * longitude_rad.cos(), cos_lat * longitude_rad.sin(), sin_lat)
}

pub fn local(latitude_rad: f64, longitude_rad: f64) -> [DVec3; 3] {
    let up = direction(latitude_rad, longitude_rad);
    let east = DVec3::new(-longitude_rad.sin(), longitude_rad.cos(), 0.0);
    [east, up.cross(east), up]
}

/// A raster whose pixels hold `height(direction)`.
pub struct Model {
    pub projection: Projection,
    pub columns: usize,
    pub rows: usize,
    pub geotransform: [f64; 6],
}

impl Model {
    /// Square pixels about a map point, which lies on a pixel's corner.
    pub fn about(projection: Projection, centre: DVec2, half: usize, pixel: f64) -> Self {
        let extent = half as f64 * pixel;
        let geotransform = [centre.x - extent, pixel, 0.0, centre.y + extent, 0.0, -pixel];
        Self { projection, columns: 2 * half, rows: 2 * half, geotransform }
    }

    pub fn directions(&self) -> impl Iterator<Item = DVec3> {
        let (g, projection, columns) = (self.geotransform, self.projection, self.columns);
        (0..columns * self.rows).map(move |index| {
            let (c, r) = ((index % columns) as f64 + 0.5, (index / columns) as f64 + 0.5);
            projection.direction(DVec2::new(g[0] + c * g[1] + r * g[2], g[3] + c * g[4] + r * g[5]))
        })
    }

    pub fn write(&self, path: &Path, height: impl Fn(DVec3) -> f64) {
        let values: Vec<f32> = self.directions().map(|direction| height(direction) as f32).collect();
        write(path, self.columns, self.rows, &self.projection.proj4(), self.geotransform, &values);
    }
}

pub fn write(path: &Path, columns: usize, rows: usize, crs: &str, geotransform: [f64; 6], values: &[f32]) {
    let bands = vec![GeoTiffBand { name: "height", unit: "m", values }];
    GeoTiff { columns, rows, bands, crs, geotransform }.write(path).unwrap();
}

pub fn gdal(program: &str, arguments: &[&str]) -> Option<String> {
    let output = std::process::Command::new(program).args(arguments).output().ok()?;
    assert!(output.status.success(), "{program} {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).unwrap())
}

pub fn open(path: &Path) -> Dem {
    Dem::open(path, &Body::moon(), &Options::default()).unwrap()
}

pub fn height_at(dem: &Dem, latitude_deg: f64, longitude_deg: f64) -> f64 {
    let point = Body::moon().position_from_geodetic(Geodetic::from_degrees(latitude_deg, longitude_deg, 0.0));
    dem.height_m(dem.georeference.projector().unwrap().pixels(&[point])[0])
}
