//! A photograph's view, rendered: the true camera over the elevation models, with the shadows asked for.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DQuat, DVec2, DVec3};

use super::{Error, Geometry, ScalarImage};
use crate::camera::PosedCamera;
use crate::geometry::{Body, BodyFixed, Position};
use crate::gpu::{Adapter, Gpu};
use crate::horizon::{self, Encoding, Memory};
use crate::photometry::{Reflectance, SolarDisk};
use crate::pipeline::{self, AdapterChoice, Progress, ground};
use crate::render::{Image, Light, Plane, Quantity, Renderer, Scene, View, planes};
use crate::scenario;
use crate::shadow::{ShadowMethod, registry};
use crate::terrain::{Ground, Hit, Surface, Terrain};

/// What is rendered besides radiance, once.
const GEOMETRIC: [Quantity; 6] = [
    Quantity::Radiance,
    Quantity::SunFraction,
    Quantity::Incidence,
    Quantity::Normal,
    Quantity::Latitude,
    Quantity::Longitude,
];

/// Relief that may cast shadows into the view from outside.
const RELIEF_M: f64 = 10_000.0;
/// How far beyond the view ground is looked for, at least and at most.
const MARGIN_M: [f64; 2] = [20_000.0, 200_000.0];
/// Sight lines that find the ground in view, along a side of the image.
const PROBES: usize = 9;

/// Elevation models that cover what the camera sees, and what casts shadows into it.
pub fn footprint_terrain(geometry: &Geometry, dems: &[PathBuf]) -> Option<scenario::Terrain> {
    let seen = footprint(&geometry.body, &geometry.camera);
    let (first, last) = (*seen.first()?, *seen.last()?);
    // The middle of what is seen.
    let sum: DVec3 = seen.iter().map(|point| point.vector_m().normalize()).sum();
    let middle = if sum.length() > 1e-6 { sum.normalize() } else { first.vector_m().lerp(last.vector_m(), 0.5) };
    let radius_m = first.vector_m().length();
    let angle = |point: &Position<BodyFixed>| point.vector_m().angle_between(middle);
    let widest = seen.iter().map(angle).fold(0.0, f64::max).min(1.2);
    let sun = geometry.lights.first()?.position.vector_m();
    let lowest_rad = seen.iter().map(|point| std::f64::consts::FRAC_PI_2 - point.vector_m().angle_between(sun));
    let lowest_rad = lowest_rad.fold(f64::INFINITY, f64::min);
    let margin_m = (RELIEF_M / lowest_rad.max(1e-3).tan()).clamp(MARGIN_M[0], MARGIN_M[1]);
    let extent_m = 2.0 * (radius_m * widest.tan() + margin_m);
    let centre = geometry.body.geodetic_from_position(Position::from_m(middle * radius_m));
    let file = |path: &PathBuf| scenario::Dem::File {
        path: path.clone(),
        reading: crate::raster::Reading::default(),
        values: scenario::Values::Auto,
        posting_m: None,
        extent_m: Some(extent_m),
    };
    let centre = Some(crate::geometry::Geodetic { height_m: 0.0, ..centre });
    Some(scenario::Terrain { centre, dems: dems.iter().map(file).collect() })
}

/// Points of the bare body on sight lines over the whole image.
fn footprint(body: &Body, camera: &PosedCamera) -> Vec<Position<BodyFixed>> {
    let bare = Surface::new(Terrain { body: body.clone(), faces: Vec::new() });
    let size = DVec2::new(camera.columns() as f64, camera.rows() as f64);
    let probe = |index: usize| {
        let share = DVec2::new((index % PROBES) as f64, (index / PROBES) as f64) / (PROBES - 1) as f64;
        let (position, direction) = camera.ray(share * (size - 1.0))?;
        bare.intersect(position, direction).map(|hit| hit.position)
    };
    (0..PROBES * PROBES).filter_map(probe).collect()
}

/// Horizon maps of a surface, kept in `cache`.
pub fn horizons(surface: &Surface, cache: &Path, progress: &dyn Progress) -> Result<Arc<dyn ShadowMethod>, Error> {
    let (settings, folder) = (horizon::Settings::default(), cache.join("horizon"));
    let silent = |_: &ground::Tile| Ok::<_, pipeline::Error>(());
    Ok(registry::of_maps(ground::horizons(
        surface,
        &settings,
        Encoding::Fm16,
        &folder,
        Memory::default(),
        progress,
        silent,
    )?))
}

/// Ground, camera and lights, ready for trials.
#[derive(Debug)]
pub struct RenderSession {
    scene: Scene,
    views: Vec<View>,
    up: DVec3,
    gpu: Option<Gpu>,
}

/// What a trial may choose.
#[derive(Debug, Clone)]
pub struct Trial {
    pub name: String,
    pub reflectance: Reflectance,
    pub disk: SolarDisk,
    /// Cast shadows; without them only a facet's own plane shades it.
    pub shadows: bool,
    /// The Sun's radius over its true one.
    pub sun_radii: f64,
    /// How the Sun is turned from its true place in the sky of the image's middle: azimuth (clockwise), elevation.
    pub sun_turn_rad: [f64; 2],
}

/// Who looks, and by which light.
#[derive(Debug, Clone, Copy)]
pub struct Viewpoint<'a> {
    pub camera: &'a PosedCamera,
    pub lights: &'a [Light],
    /// The vertical in the image's middle.
    pub up: DVec3,
    /// Along a side of a pixel.
    pub samples: usize,
}

impl RenderSession {
    /// The scene is seen through the stage's camera.
    pub fn new(stage: &Viewpoint, scene: Scene, adapter: AdapterChoice) -> Result<Self, Error> {
        let for_host = !scene.shadows.runs_on_device();
        let gpu = match adapter {
            AdapterChoice::Gpu => Some(Gpu::open(Adapter::Gpu).map_err(pipeline::Error::from)?),
            AdapterChoice::Auto if !for_host => Gpu::open(Adapter::Auto).ok(),
            AdapterChoice::Auto | AdapterChoice::Cpu => None,
        };
        let mut studio = Self { scene, views: Vec::new(), up: stage.up, gpu };
        studio.restage(stage);
        Ok(studio)
    }

    /// Sees the same scene through another stage's camera.
    pub fn restage(&mut self, stage: &Viewpoint) {
        let view = |(index, pose): (usize, &crate::camera::Pose)| View {
            exposure: index as u64,
            samples_per_side: stage.samples,
            ..View::new(*pose, stage.camera.optics.clone(), stage.lights.to_vec())
        };
        self.views = stage.camera.poses.iter().enumerate().map(view).collect();
        self.up = stage.up;
    }

    pub fn surface(&self) -> &Surface {
        &self.scene.surface
    }

    pub fn adapter(&self) -> String {
        Renderer::on_any(self.gpu.as_ref()).adapter()
    }

    /// Every plane of the view as the trial has it; NaN off the elevation models.
    pub fn whole(&mut self, trial: &Trial) -> Result<Planes, Error> {
        self.render(trial, &GEOMETRIC)
    }

    /// Radiance alone, also of the bare body.
    pub fn radiance(&mut self, trial: &Trial) -> Result<ScalarImage, Error> {
        Ok(self.render(trial, &[Quantity::Radiance])?.values("RADIANCE"))
    }

    fn turned(&self, sun: Position<BodyFixed>, [azimuth_rad, elevation_rad]: [f64; 2]) -> Position<BodyFixed> {
        let across = sun.vector_m().cross(self.up).normalize_or_zero();
        let risen = DQuat::from_axis_angle(across, elevation_rad) * sun.vector_m();
        // Clockwise from above.
        Position::from_m(DQuat::from_axis_angle(self.up, -azimuth_rad) * risen)
    }

    /// The exposures one below the other.
    fn render(&self, trial: &Trial, quantities: &[Quantity]) -> Result<Planes, Error> {
        let scene = self.scene.clone().with_disk(trial.disk.clone());
        let scene = if trial.shadows { scene } else { scene.with_shadows(registry::no_shadows()) };
        let mut session = Renderer::on_any(self.gpu.as_ref()).session(&scene)?;
        let mut whole: Option<Image> = None;
        for view in &self.views {
            let mut view = view.clone().with_reflectance(trial.reflectance).with_quantities(quantities);
            view.lights[0].angular_radius_rad *= trial.sun_radii;
            view.lights[0].position = self.turned(view.lights[0].position, trial.sun_turn_rad);
            let samples = session.samples(&view)?;
            let mut part = planes::image(&scene, &view, &samples);
            if scene.needs_centres(&view) {
                let on_terrain = |hit: &Option<Hit>| hit.is_some_and(|hit| matches!(hit.ground, Ground::Dem { .. }));
                mask(&mut part, &samples.centres.iter().map(on_terrain).collect::<Vec<_>>());
            }
            match &mut whole {
                None => whole = Some(part),
                Some(whole) => append(whole, part),
            }
        }
        Ok(Planes { image: whole.expect("a camera has a pose") })
    }
}

fn mask(image: &mut Image, on_terrain: &[bool]) {
    for plane in &mut image.planes {
        let off = plane.values.iter_mut().zip(on_terrain).filter(|(_, on)| !**on);
        off.for_each(|(value, _)| *value = f32::NAN);
    }
}

fn append(whole: &mut Image, part: Image) {
    whole.rows += part.rows;
    for (plane, more) in whole.planes.iter_mut().zip(part.planes) {
        plane.values.extend(more.values);
    }
}

/// Rendered planes by name.
#[derive(Debug, Clone)]
pub struct Planes {
    image: Image,
}

impl Planes {
    pub fn values(&self, name: &str) -> ScalarImage {
        let plane: &Plane =
            self.image.planes.iter().find(|plane| plane.name == name).expect("a plane that was asked for");
        ScalarImage::from_f32(self.image.columns, self.image.rows, &plane.values)
    }
}
