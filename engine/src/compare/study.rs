//! A photograph held against its render, from files to numbers.
//!
//! ```text
//! photograph, geometry, DEMs -> resolution -> render -> registration -> photometric fit -> numbers, edges, ablation
//! ```
//!
//! Both are compared at the coarser of their resolutions: the photograph is averaged over areas until its pixels are as
//! large on the ground as the elevation model's posting, and both are smoothed by the [`SLOPE_SIGMA`](super::resolution::SLOPE_SIGMA) postings
//! over which the model's slopes are means. The render has the photograph's pixels, or larger ones up to a third of
//! those compared, and is reduced as the photograph is: a render compared with itself differs by nothing.
//!
//! # Assumptions
//! The Sun's distance and the poses stand still during an exposure. The border of [`BORDER`] of the image, with its
//! fiducial marks and what a shift brings in, does not count.

use std::path::PathBuf;

use glam::{DVec2, DVec3};

use super::ablation::{self, Row};
use super::edges::{self, Confusion, Displacement};
use super::numbers::Numbers;
use super::photometric::{Model, Response};
use super::pose::{self, PoseFit};
use super::prepare::{Prepared, no_ground, prepared};
use super::profile::{self, Bin, Profile};
use super::register::{Registration, register_detail, warped};
use super::render::{Planes, RenderSession, Trial, Viewpoint};
use super::request::{GeometrySource, Law, Request};
use super::resolution::{FINER, Resolution};
use super::scales::{Scale, scales};
use super::{Error, Geometry, ScalarImage, provenance};
use crate::camera::PosedCamera;
use crate::geometry::{BodyFixed, Position};
use crate::pipeline::{Progress, ground};
use crate::raster::Picture;
use crate::scenario;
use crate::terrain::{Ground, Surface};

/// Width of the border that does not count, over the image's sides.
pub const BORDER: f64 = 0.03;
/// Standard deviation of the Gaussian that the high-pass takes away, over the longer side.
pub const HIGH_PASS: f64 = 1.0 / 16.0;

/// Times that a pose is taken and the view rendered anew: what the first leaves is a tenth of a pixel at most.
const POSE_ROUNDS: usize = 4;
/// A pose is taken no further once the image's corner moves by less.
const POSE_SETTLED_PX: f64 = 0.01;

/// All that a report tells.
#[derive(Debug, Clone)]
pub struct Comparison {
    pub photo_name: String,
    pub geometry: String,
    pub adapter: String,
    pub dems: Vec<String>,
    pub law: String,
    pub model: Model,
    pub albedo: AlbedoSource,
    pub resolution: Resolution,
    /// Left after `fitted_pose`, where there is one.
    pub registration: Registration,
    /// The pose that explains the registration.
    pub pose: Option<PoseFit>,
    /// The pose that was fitted and taken.
    pub fitted_pose: Option<PoseFit>,
    pub response: Response,
    pub numbers: Numbers,
    /// Likeness size by size.
    pub scales: Vec<Scale>,
    /// Every photometric model with its fit.
    pub responses: Vec<(Model, Response, Numbers)>,
    pub confusion: Option<Confusion>,
    pub displacement: Option<Displacement>,
    pub ablation: Vec<Row>,
    /// Where the photograph has the Sun.
    pub sun: Option<ablation::Sun>,
    pub by_incidence: Vec<Bin>,
    pub by_slope: Vec<Bin>,
    pub profiles: Vec<Profile>,
    /// The photograph, the registered render as the photograph would show it, and the share of the Sun seen.
    pub photo: ScalarImage,
    pub fitted: ScalarImage,
    pub sun_fraction: ScalarImage,
}

/// Where the ground's brightness comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum AlbedoSource {
    Constant,
    Map(String),
    /// Forced: the map holds the photograph, for this reason.
    HoldsPhoto {
        map: String,
        reason: String,
    },
}

/// The view, rendered and registered.
struct Registered {
    planes: Planes,
    radiance: ScalarImage,
    registration: Registration,
    pose: Option<PoseFit>,
}

/// What a photograph is registered with.
struct Registering<'a> {
    request: &'a Request,
    resolution: &'a Resolution,
    main: &'a Trial,
    photo: &'a ScalarImage,
    samples: usize,
}

/// Compares a photograph with its render.
pub fn compare(request: &Request, progress: &dyn Progress) -> Result<Comparison, Error> {
    let albedo = check_albedo(request)?;
    let picture = Picture::open(&request.photo, request.band)?;
    let main = main_trial(request)?;
    let Prepared { mut geometry, scene, inputs } = prepared(request, &main, &picture, progress)?;
    let resolution = resolution(request, &picture, &geometry, &scene.surface)?;
    let (camera, mut sky) = viewpoint(request, &resolution, &geometry, &scene.surface)?;
    let samples = samples(request, &resolution);
    let stage = Viewpoint { camera: &camera, lights: &geometry.lights, up: sky.up, samples };
    let mut studio = RenderSession::new(&stage, scene, request.adapter)?;
    let photo = reduced_photo(&picture, &camera, &resolution);
    let registering = Registering { request, resolution: &resolution, main: &main, photo: &photo, samples };
    let (registered, fitted_pose) = registering.run(&mut studio, &mut geometry, &mut sky, progress)?;
    let Registered { planes, radiance, registration, pose } = registered;
    let moved = |image: &ScalarImage| warped(image, &registration.motion);
    let render = moved(&radiance);
    let sun_fraction = moved(&resolution.reduced(planes.values("SUN_FRACTION")));

    let fit = |model: Model| fit(model, &photo, &render, [resolution.high_pass_px, request.dark]);
    let (model, response, numbers, fitted) = fit(request.model);
    let responses = Model::ALL.map(fit).map(|(model, response, numbers, _)| (model, response, numbers)).to_vec();
    let (confusion, displacement) = edges_of_shadows(&photo, &sun_fraction, &sky, resolution.compared_pixel_m);
    let [incidence, slope] =
        [planes.values("LOCALINCIDENCE"), slope(&planes, &geometry)].map(|plane| moved(&resolution.reduced(plane)));
    let (photo_grid, radiance, freedom) = (&photo, &radiance, request.freedom);
    let setting =
        ablation::Setting { photo: photo_grid, radiance, resolution: &resolution, freedom, model: request.model };
    let rows = request.ablation.then(|| ablation::run(&mut studio, &main, &setting, progress)).transpose()?;
    let sun = request.turn_sun.then(|| ablation::sun(&mut studio, &main, &setting, progress)).transpose()?;
    Ok(Comparison {
        photo_name: ground::file_name(&request.photo),
        geometry: geometry.source,
        adapter: studio.adapter(),
        dems: inputs.iter().map(|input| format!("{} (SHA-256 {})", input.name, input.sha256)).collect(),
        law: main.name,
        scales: scales(&photo, &fitted),
        model,
        albedo,
        resolution,
        numbers,
        responses,
        confusion,
        displacement,
        ablation: rows.unwrap_or_default(),
        sun,
        by_incidence: profile::binned(&photo, &fitted, &incidence, 5.0),
        by_slope: profile::binned(&photo, &fitted, &slope, 2.5),
        profiles: profile::across_shadows(&photo, &fitted, &sun_fraction, sky.towards_sun),
        registration,
        pose,
        fitted_pose,
        response,
        photo,
        fitted,
        sun_fraction,
    })
}

/// A model fitted to the photograph, its numbers, and the render as it answers.
fn fit(
    model: Model,
    photo: &ScalarImage,
    render: &ScalarImage,
    [high_pass_px, dark]: [f64; 2],
) -> (Model, Response, Numbers, ScalarImage) {
    let response = Response::fit(model, photo, render);
    let fitted = response.apply(render);
    let numbers = Numbers::of(photo, render, &fitted, high_pass_px, dark);
    (model, response, numbers, fitted)
}

/// The camera that renders, and the sky above what it sees.
fn viewpoint(
    request: &Request,
    resolution: &Resolution,
    geometry: &Geometry,
    surface: &Surface,
) -> Result<(PosedCamera, Sky), Error> {
    let camera = geometry.camera.coarser(resolution.render_factor())?;
    let sky = Sky::of(geometry, &camera, surface).ok_or_else(|| no_ground(request, geometry))?;
    Ok((camera, sky))
}

/// The photograph as it is compared: reduced, smoothed, without its border.
fn reduced_photo(picture: &Picture, camera: &PosedCamera, resolution: &Resolution) -> ScalarImage {
    let photo =
        ScalarImage::from_f32(picture.columns, picture.rows, &picture.values).reduced(camera.columns(), camera.rows());
    let photo = resolution.seen(photo);
    let border = |side: usize| (BORDER * side as f64).ceil() as usize;
    photo.without_border(border(photo.columns), border(photo.rows))
}

/// How the shadows of photograph and render agree, where a threshold tells the photograph's.
fn edges_of_shadows(
    photo: &ScalarImage,
    sun_fraction: &ScalarImage,
    sky: &Sky,
    pixel_m: f64,
) -> (Option<Confusion>, Option<Displacement>) {
    let threshold = edges::threshold(photo, sun_fraction);
    let confusion = threshold.map(|threshold| edges::confusion(photo, sun_fraction, threshold));
    let displacement =
        threshold.map(|threshold| edges::displacement(photo, sun_fraction, threshold, sky.towards_sun, pixel_m));
    (confusion, displacement)
}

impl Registering<'_> {
    /// Renders and registers, in rounds where the pose is fitted: the geometry's camera and the sky follow it.
    fn run(
        &self,
        studio: &mut RenderSession,
        geometry: &mut Geometry,
        sky: &mut Sky,
        progress: &dyn Progress,
    ) -> Result<(Registered, Option<PoseFit>), Error> {
        let rounds = if self.request.fit_pose { POSE_ROUNDS } else { 0 };
        progress.begin("rendering", 1 + rounds, "images");
        let mut registered = self.once(studio, geometry)?;
        let mut fitted_pose = None;
        for round in 1..=rounds {
            progress.at(round, 1 + rounds);
            let corner_px = registered.registration.motion.corner_px(self.photo.columns, self.photo.rows);
            let Some(pose) = registered.pose.filter(|_| corner_px >= POSE_SETTLED_PX) else { break };
            geometry.camera = pose.apply(&geometry.camera);
            fitted_pose = Some(pose.after(fitted_pose));
            let camera;
            (camera, *sky) = viewpoint(self.request, self.resolution, geometry, studio.surface())?;
            studio.restage(&Viewpoint { camera: &camera, lights: &geometry.lights, up: sky.up, samples: self.samples });
            registered = self.once(studio, geometry)?;
        }
        Ok((registered, fitted_pose))
    }

    fn once(&self, studio: &mut RenderSession, geometry: &Geometry) -> Result<Registered, Error> {
        let planes = studio.whole(self.main)?;
        let radiance = self.resolution.seen(planes.values("RADIANCE"));
        let registration = register_detail(self.photo, &radiance, self.resolution.high_pass_px, self.request.freedom)?;
        let compared = geometry.camera.coarser(self.resolution.factor())?;
        let pose = pose::explain(&compared, studio.surface(), &registration);
        Ok(Registered { planes, radiance, registration, pose })
    }
}

fn main_trial(request: &Request) -> Result<Trial, Error> {
    match (&request.geometry, request.law) {
        (_, Some(law)) => Trial::of(law),
        (GeometrySource::Scenario { scenario, .. }, None) => Trial::of_scenario(scenario),
        (GeometrySource::File(_), None) => Trial::of(Law::LunarLambert),
    }
}

/// The map given, or the scenario's.
fn albedo_map(request: &Request) -> Option<PathBuf> {
    let own = match &request.geometry {
        GeometrySource::Scenario { scenario, .. } => match &scenario.albedo {
            scenario::Albedo::Map(path, _) => Some(path.clone()),
            scenario::Albedo::Constant(_) | scenario::Albedo::SingleScattering(..) => None,
        },
        GeometrySource::File(_) => None,
    };
    request.albedo.clone().or(own)
}

/// Samples along a side of a rendered pixel: a scenario's own, else about three along a compared one.
fn samples(request: &Request, resolution: &Resolution) -> usize {
    match &request.geometry {
        GeometrySource::Scenario { scenario, .. } => scenario.camera.samples_per_pixel.isqrt() as usize,
        GeometrySource::File(_) => (FINER * resolution.render_factor() / resolution.factor()).round().max(1.0) as usize,
    }
}

/// Refuses a map that holds the photograph, before any work.
fn check_albedo(request: &Request) -> Result<AlbedoSource, Error> {
    let Some(albedo) = albedo_map(request) else { return Ok(AlbedoSource::Constant) };
    let map = provenance::source(&albedo)?;
    match provenance::holds(&albedo, &request.photo)? {
        None => Ok(AlbedoSource::Map(map)),
        Some(reason) if request.force => Ok(AlbedoSource::HoldsPhoto { map, reason }),
        Some(reason) => Err(Error::AlbedoHoldsPhoto { albedo, reason }),
    }
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

/// The middle of the image: its vertical, and the Sun in it.
struct Sky {
    up: DVec3,
    /// The unit vector of the image along which the ground comes nearer to the Sun.
    towards_sun: DVec2,
}

impl Sky {
    fn of(geometry: &Geometry, camera: &PosedCamera, surface: &Surface) -> Option<Self> {
        let (hit, _) = look(camera, surface, middle(camera))?;
        let pose = &camera.poses[camera.poses.len() / 2];
        let here = hit.position.vector_m();
        let up = here.normalize();
        let sun = (geometry.lights[0].position.vector_m() - here).normalize();
        let ahead = sun.reject_from(up).try_normalize()?;
        let pixel = |point: DVec3| {
            let direction = pose.position.direction_to(Position::from_m(point))?;
            camera.optics.pixel(pose.camera_from_body * direction)
        };
        let step_m = 1e-3 * hit.distance_m;
        Some(Self { up, towards_sun: (pixel(here + step_m * ahead)? - pixel(here)?).try_normalize()? })
    }
}

/// Angle of the ground with the spheroid's horizontal plane, in degrees.
fn slope(planes: &Planes, geometry: &Geometry) -> ScalarImage {
    let [x, y, z, latitude, longitude] =
        ["NORMAL.X", "NORMAL.Y", "NORMAL.Z", "LATITUDE", "LONGITUDE"].map(|name| planes.values(name));
    let value = |i: usize| {
        let normal = DVec3::new(x.values[i], y.values[i], z.values[i]);
        let place = crate::geometry::Geodetic::from_degrees(latitude.values[i], longitude.values[i], 0.0);
        if normal.is_nan() { f64::NAN } else { normal.angle_between(geometry.body.up(place).unit()).to_degrees() }
    };
    ScalarImage::new(x.columns, x.rows, (0..x.values.len()).map(value).collect())
}
