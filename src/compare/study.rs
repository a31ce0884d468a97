//! A photograph held against its render, from files to numbers.
//!
//! ```text
//! photograph, geometry, DEMs -> resolution -> render -> registration -> photometric fit -> numbers, edges, ablation
//! ```
//!
//! Both are compared at the coarser of their resolutions: the photograph is averaged over areas until its pixels are as
//! large on the ground as the elevation model's posting, and the render is made with pixels of that size.
//!
//! # Assumptions
//! The Sun's distance and the poses stand still during an exposure. The border of [`BORDER`] of the image, with its
//! fiducial marks and what a shift brings in, does not count.

use std::path::{Path, PathBuf};

use glam::DVec2;

use super::ablation::{self, Row};
use super::edges::{self, Confusion, Displacement};
use super::numbers::Numbers;
use super::photometric::{Model, Response};
use super::profile::{self, Bin, Profile};
use super::register::{Freedom, Registration, register, warped};
use super::render::{Planes, Studio, Trial, footprint_terrain, horizons};
use super::{Error, Geometry, Grid, provenance};
use crate::camera::PosedCamera;
use crate::geometry::{BodyFixed, Position};
use crate::photometry::{LimbDarkening, Reflectance, SolarDisk};
use crate::pipeline::{self, AdapterChoice, Progress, ground};
use crate::raster::Picture;
use crate::scenario;
use crate::terrain::{Ground, Surface};

/// What to compare, and how.
#[derive(Debug, Clone)]
pub struct Request {
    pub photo: PathBuf,
    /// Of the photograph, counted from 1.
    pub band: Option<usize>,
    pub geometry: GeometrySource,
    pub dems: Vec<PathBuf>,
    pub albedo: Option<PathBuf>,
    /// Compare even where the albedo map holds the photograph.
    pub force: bool,
    pub law: Law,
    pub freedom: Freedom,
    pub model: Model,
    /// Jung's dark level, a share of the photograph's largest number.
    pub dark: f64,
    /// Pixels along the longer side; `None`: as many as the elevation model resolves.
    pub pixels: Option<usize>,
    pub ablation: bool,
    pub cache: PathBuf,
    pub adapter: AdapterChoice,
}

/// Where the camera and the Sun come from.
#[derive(Debug, Clone)]
pub enum GeometrySource {
    /// A frame of ours or a CSM ISD.
    File(PathBuf),
    /// An exposure of a scenario, counted from 0.
    Scenario { scenario: Box<scenario::Scenario>, exposure: usize },
}

/// Laws of reflection by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    Lambert,
    LommelSeeliger,
    LunarLambert,
    Minnaert,
    HapkeMoon,
}

/// Width of the border that does not count, over the image's sides.
pub const BORDER: f64 = 0.03;
/// Standard deviation of the Gaussian that the high-pass takes away, over the longer side.
pub const HIGH_PASS: f64 = 1.0 / 16.0;
/// Effective wavelength of panchromatic film and of unfiltered silicon under sunlight.
pub const WAVELENGTH_NM: f64 = 580.0;
/// Moon's mean normal albedo; only ratios count in a comparison.
const NORMAL_ALBEDO: f64 = 0.12;
/// Slope of the Minnaert exponent with phase is left out: 0.7 fits the Moon near 60°.
const MINNAERT_EXPONENT: f64 = 0.7;

impl Law {
    pub const ALL: [Self; 5] =
        [Self::Lambert, Self::LommelSeeliger, Self::LunarLambert, Self::Minnaert, Self::HapkeMoon];

    pub fn name(self) -> &'static str {
        match self {
            Self::Lambert => "Lambert",
            Self::LommelSeeliger => "Lommel-Seeliger",
            Self::LunarLambert => "lunar-Lambert",
            Self::Minnaert => "Minnaert k = 0.7",
            Self::HapkeMoon => "Hapke, Moon",
        }
    }

    pub fn reflectance(self) -> Reflectance {
        let normal_albedo = NORMAL_ALBEDO;
        match self {
            Self::Lambert => Reflectance::Lambert { normal_albedo },
            Self::LommelSeeliger => Reflectance::LommelSeeliger { normal_albedo },
            Self::LunarLambert => Reflectance::LunarLambert { normal_albedo },
            Self::Minnaert => Reflectance::Minnaert { normal_albedo, exponent: MINNAERT_EXPONENT },
            Self::HapkeMoon => Reflectance::Hapke(crate::photometry::Hapke::moon()),
        }
    }
}

impl Trial {
    /// Cast shadows of a limb-darkened Sun.
    pub fn of(law: Law) -> Result<Self, Error> {
        let disk = SolarDisk::new(LimbDarkening::hestroffer_magnan(WAVELENGTH_NM)?)?;
        Ok(Self { name: law.name().into(), reflectance: law.reflectance(), disk, shadows: true, sun_radii: 1.0 })
    }
}

/// All that a report tells.
#[derive(Debug, Clone)]
pub struct Comparison {
    pub photo_name: String,
    pub geometry: String,
    pub adapter: String,
    pub dems: Vec<String>,
    pub law: Law,
    pub model: Model,
    pub albedo: AlbedoSource,
    pub resolution: Resolution,
    pub registration: Registration,
    pub response: Response,
    pub numbers: Numbers,
    /// Every photometric model with its fit.
    pub responses: Vec<(Model, Response, Numbers)>,
    pub confusion: Option<Confusion>,
    pub displacement: Option<Displacement>,
    /// Towards the Sun in the image.
    pub towards_sun: DVec2,
    /// Angle of a compared pixel, and distance of the ground, in the middle of the image.
    pub pixel_rad: f64,
    pub range_m: f64,
    pub ablation: Vec<Row>,
    pub by_incidence: Vec<Bin>,
    pub by_slope: Vec<Bin>,
    pub profiles: Vec<Profile>,
    /// The photograph, the registered render as the photograph would show it, and the share of the Sun seen.
    pub photo: Grid,
    pub fitted: Grid,
    pub sun_fraction: Grid,
}

/// Where the ground's brightness comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum AlbedoSource {
    Constant,
    Map(String),
    /// Forced: the map holds the photograph, for this reason.
    HoldsPhoto { map: String, reason: String },
}

/// At what the two were compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    pub photo_px: [usize; 2],
    pub photo_pixel_m: f64,
    pub posting_m: f64,
    pub compared_px: [usize; 2],
    pub compared_pixel_m: f64,
    pub high_pass_px: f64,
    /// Distance of the ground in the middle of the image.
    pub range_m: f64,
}

/// Compares a photograph with its render.
pub fn compare(request: &Request, progress: &dyn Progress) -> Result<Comparison, Error> {
    let albedo = check_albedo(request)?;
    let picture = Picture::open(&request.photo, request.band)?;
    let (geometry, mut ground) = geometry(request, &picture, progress)?;
    let resolution = resolution(request, &picture, &geometry, &ground.surface)?;
    let factor = resolution.compared_pixel_m / resolution.photo_pixel_m;
    let camera = geometry.camera.coarser(factor)?;
    let scale = if matches!(request.law, Law::HapkeMoon) { 1.0 } else { 1.0 / NORMAL_ALBEDO };
    let maps = request.albedo.as_ref().map(|path| ground::albedo(&mut ground.surface, path, scale)).transpose()?;
    let shadows = horizons(&ground.surface, &request.cache, progress)?;
    let trial = Trial::of(request.law)?;
    let towards_sun = towards_sun(&geometry, &camera, &ground.surface).ok_or_else(|| no_ground(request, &geometry))?;
    let mut studio = Studio::new(&geometry, &camera, ground.surface, shadows, maps, &trial, request.adapter)?;

    progress.begin("rendering", 1, "image");
    let planes = studio.whole(&trial)?;
    progress.at(1, 1);
    let photo = Grid::from_f32(picture.columns, picture.rows, &picture.values).reduced(camera.columns(), camera.rows());
    let border = |side: usize| (BORDER * side as f64).ceil() as usize;
    let photo = photo.without_border(border(photo.columns), border(photo.rows));
    let high_pass_px = resolution.high_pass_px;
    let radiance = planes.grid("RADIANCE");
    let registration = register(&photo.high_pass(high_pass_px), &radiance.high_pass(high_pass_px), request.freedom)?;
    let render = warped(&radiance, &registration.motion);
    let sun_fraction = warped(&planes.grid("SUN_FRACTION"), &registration.motion);

    let fit = |model: Model| {
        let response = Response::fit(model, &photo, &render);
        let fitted = response.apply(&render);
        let numbers = Numbers::of(&photo, &render, &fitted, high_pass_px, request.dark);
        (model, response, numbers, fitted)
    };
    let (model, response, numbers, fitted) = fit(request.model);
    let responses = Model::ALL.map(fit).map(|(model, response, numbers, _)| (model, response, numbers)).to_vec();
    let threshold = edges::threshold(&photo, &sun_fraction);
    let confusion = threshold.map(|threshold| edges::confusion(&photo, &sun_fraction, threshold));
    let pixel_m = resolution.compared_pixel_m;
    let displacement =
        threshold.map(|threshold| edges::displacement(&photo, &sun_fraction, threshold, towards_sun, pixel_m));
    let [incidence, slope] = [planes.grid("LOCALINCIDENCE"), slope(&planes, &geometry)]
        .map(|plane| warped(&plane, &registration.motion));
    let setting = ablation::Setting {
        photo: &photo,
        radiance: &radiance,
        registration: &registration,
        high_pass_px,
        model: request.model,
    };
    let ablation =
        if request.ablation { ablation::run(&mut studio, request.law, &setting, progress)? } else { Vec::new() };
    Ok(Comparison {
        photo_name: ground::file_name(&request.photo),
        geometry: geometry.source,
        adapter: studio.adapter(),
        dems: ground.inputs.iter().map(|input| format!("{} (SHA-256 {})", input.name, input.sha256)).collect(),
        law: request.law,
        model,
        albedo,
        resolution,
        numbers,
        responses,
        confusion,
        displacement,
        towards_sun,
        pixel_rad: resolution.compared_pixel_m / resolution.range_m,
        range_m: resolution.range_m,
        ablation,
        by_incidence: profile::binned(&photo, &fitted, &incidence, 5.0),
        by_slope: profile::binned(&photo, &fitted, &slope, 2.5),
        profiles: profile::across_shadows(&photo, &fitted, &sun_fraction, towards_sun),
        registration,
        response,
        photo,
        fitted,
        sun_fraction,
    })
}

/// Refuses a map that holds the photograph, before any work.
fn check_albedo(request: &Request) -> Result<AlbedoSource, Error> {
    let Some(albedo) = &request.albedo else { return Ok(AlbedoSource::Constant) };
    let map = provenance::source(albedo)?;
    match provenance::holds(albedo, &request.photo)? {
        None => Ok(AlbedoSource::Map(map)),
        Some(reason) if request.force => Ok(AlbedoSource::HoldsPhoto { map, reason }),
        Some(reason) => Err(Error::AlbedoHoldsPhoto { albedo: albedo.clone(), reason }),
    }
}

fn geometry(
    request: &Request,
    picture: &Picture,
    progress: &dyn Progress,
) -> Result<(Geometry, ground::Ground), Error> {
    match &request.geometry {
        GeometrySource::File(path) => {
            if request.dems.is_empty() {
                return Err(Error::NoDem { path: path.clone() });
            }
            let geometry = Geometry::read(path, &request.photo, [picture.columns, picture.rows])?;
            let terrain =
                footprint_terrain(&geometry, &request.dems).ok_or_else(|| no_ground(request, &geometry))?;
            let ground = ground::surface(Some(&terrain), &geometry.body, &request.cache, progress)?;
            Ok((geometry, ground))
        }
        GeometrySource::Scenario { scenario, exposure } => {
            Geometry::of_exposure(scenario, *exposure, &request.dems, picture, &request.cache, progress)
        }
    }
}

fn no_ground(request: &Request, geometry: &Geometry) -> Error {
    let path = match &request.geometry {
        GeometrySource::File(path) => path.clone(),
        GeometrySource::Scenario { scenario, .. } => scenario.path.clone(),
    };
    Error::NoGround { path, body: geometry.body.name.clone() }
}

/// The coarser of the photograph's and the elevation model's resolution in the middle of the image.
fn resolution(
    request: &Request,
    picture: &Picture,
    geometry: &Geometry,
    surface: &Surface,
) -> Result<Resolution, Error> {
    let middle = middle(&geometry.camera);
    let (hit, _) = look(&geometry.camera, surface, middle).ok_or_else(|| no_ground(request, geometry))?;
    let next = look(&geometry.camera, surface, middle + DVec2::X).map_or(hit.position, |(hit, _)| hit.position);
    let photo_pixel_m = hit.position.distance_m(next);
    let posting_m = match hit.ground {
        Ground::Dem { face, level, .. } => surface.terrain.faces[face].levels[level].posting_m,
        Ground::Bare | Ground::Gap => return Err(no_ground(request, geometry)),
    };
    let longer = picture.columns.max(picture.rows) as f64;
    let factor = request.pixels.map_or(posting_m / photo_pixel_m, |pixels| longer / pixels as f64).max(1.0);
    let camera = geometry.camera.coarser(factor)?;
    let compared_px = [camera.columns(), camera.rows()];
    Ok(Resolution {
        photo_px: [picture.columns, picture.rows],
        photo_pixel_m,
        posting_m,
        compared_px,
        compared_pixel_m: photo_pixel_m * factor,
        high_pass_px: HIGH_PASS * compared_px[0].max(compared_px[1]) as f64,
        range_m: hit.distance_m,
    })
}

fn middle(camera: &PosedCamera) -> DVec2 {
    (DVec2::new(camera.columns() as f64, camera.rows() as f64) / 2.0).floor()
}

fn look(camera: &PosedCamera, surface: &Surface, pixel: DVec2) -> Option<(crate::terrain::Hit, Position<BodyFixed>)> {
    let (position, direction) = camera.ray(pixel)?;
    surface.intersect(position, direction).map(|hit| (hit, position))
}

/// The unit vector of the image along which the ground comes nearer to the Sun, in the middle of the image.
fn towards_sun(geometry: &Geometry, camera: &PosedCamera, surface: &Surface) -> Option<DVec2> {
    let (hit, _) = look(camera, surface, middle(camera))?;
    let pose = &camera.poses[camera.poses.len() / 2];
    let here = hit.position.vector_m();
    let sun = (geometry.lights[0].position.vector_m() - here).normalize();
    let ahead = sun.reject_from(here.normalize()).try_normalize()?;
    let pixel = |point: glam::DVec3| {
        let direction = pose.position.direction_to(Position::from_m(point))?;
        camera.optics.pixel(pose.camera_from_body * direction)
    };
    let step_m = 1e-3 * hit.distance_m;
    (pixel(here + step_m * ahead)? - pixel(here)?).try_normalize()
}

/// Angle of the ground with the spheroid's horizontal plane, in degrees.
fn slope(planes: &Planes, geometry: &Geometry) -> Grid {
    let [x, y, z, latitude, longitude] =
        ["NORMAL.X", "NORMAL.Y", "NORMAL.Z", "LATITUDE", "LONGITUDE"].map(|name| planes.grid(name));
    let value = |i: usize| {
        let normal = glam::DVec3::new(x.values[i], y.values[i], z.values[i]);
        let place = crate::geometry::Geodetic::from_degrees(latitude.values[i], longitude.values[i], 0.0);
        if normal.is_nan() { f64::NAN } else { normal.angle_between(geometry.body.up(place).unit()).to_degrees() }
    };
    Grid::new(x.columns, x.rows, (0..x.values.len()).map(value).collect())
}

impl Geometry {
    /// Of an exposure of a scenario, over its own elevation models or those given.
    fn of_exposure(
        scenario: &scenario::Scenario,
        exposure: usize,
        dems: &[PathBuf],
        picture: &Picture,
        cache: &Path,
        progress: &dyn Progress,
    ) -> Result<(Self, ground::Ground), Error> {
        let mut scenario = scenario.clone();
        let path = scenario.path.clone();
        let (columns, rows) = (scenario.camera.columns as usize, scenario.camera.rows as usize);
        if [picture.columns, picture.rows] != [columns, rows] {
            let allowed = vec![format!("{columns} x {rows}")];
            return Err(Error::Size { photo: picture.path.clone(), columns: picture.columns, rows: picture.rows, allowed });
        }
        if exposure >= scenario.exposures.len() {
            return Err(Error::NoSuchImage { image: exposure, path, count: scenario.exposures.len() });
        }
        if !dems.is_empty() {
            let centre = scenario.terrain.as_ref().and_then(|terrain| terrain.centre);
            let file = |path: &PathBuf| scenario::Dem::File {
                path: path.clone(),
                values: scenario::Values::Auto,
                posting_m: None,
                extent_m: None,
            };
            scenario.terrain = Some(scenario::Terrain { centre, dems: dems.iter().map(file).collect() });
        }
        if scenario.terrain.is_none() {
            return Err(Error::NoDem { path });
        }
        let prepared = pipeline::prepare(&scenario, cache, progress)?;
        let view = &prepared.exposures[exposure].view;
        let pose = crate::camera::Pose { position: view.camera_position, camera_from_body: view.camera_from_body };
        let geometry = Self {
            body: prepared.frame.body.clone(),
            camera: PosedCamera { optics: pipeline::scene::optics(&scenario)?, poses: vec![pose] },
            lights: view.lights.clone(),
            source: format!("scenario {}, exposure {exposure}", scenario.name),
        };
        Ok((geometry, prepared.ground))
    }
}
