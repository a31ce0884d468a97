//! All a renderer needs, as plain numbers: no epoch, no kernel, no file.
#![warn(missing_docs)]

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::camera::{Camera as Optics, Detector, Pose};
use crate::geometry::{BodyFixed, Camera, Position, Rotation};
use crate::photometry::{Hapke, LimbDarkening, Reflectance, SolarDisk};
use crate::shadow::{QuantizedLight, ShadowMethod, registry};
use crate::terrain::Surface;

use super::{Bounce, Quantity};

/// What stays the same from view to view. A clone shares all that is large: a session keeps one, so that nothing that is done to
/// another reaches it.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The terrain.
    pub surface: Arc<Surface>,
    /// How the ground along a ray is found.
    pub view_rays: ViewRays,
    /// What casts shadows.
    pub shadows: Arc<dyn ShadowMethod>,
    /// How the Sun's share is traced where horizon maps leave it open; `None`: it is not.
    pub refine: Option<crate::horizon::Settings>,
    /// A number of the reflectance at the nodes of each face's levels; `None`: it is the same everywhere.
    pub albedo: Option<Arc<Vec<Vec<Vec<f32>>>>>,
    /// Which number that is.
    pub albedo_role: AlbedoRole,
    /// Light from all of the sky; `None`: the sky is black.
    pub ambient: Option<Arc<Ambient>>,
    /// Sunlight that terrain reflects onto terrain; `None`: none.
    pub bounce: Option<Arc<Bounce>>,
    /// The law of the lights' discs: the Sun's. Earthshine is 1e-4 of sunlight, and its disc's own law unknown.
    pub disk: Arc<SolarDisk>,
}

/// How the first ground along a ray from the camera is found. The reference renderer always casts exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub enum ViewRays {
    /// From the camera, over the maxima of blocks of cells.
    #[default]
    Exact,
    /// From a coarse mesh above the terrain, by steps of a cell's width (Jung 2020); exactly from where the steps end. To compare
    /// with.
    Hybrid {
        /// Cells of the terrain along a side of the mesh's squares.
        #[serde(default = "default_mesh_cells")]
        #[schemars(range(min = 1, max = 256))]
        mesh_cells: u32,
        /// Steps at most.
        #[serde(default = "default_steps")]
        #[schemars(range(min = 1, max = 4096))]
        steps: u32,
    },
}

fn default_mesh_cells() -> u32 {
    8
}

fn default_steps() -> u32 {
    32
}

impl ViewRays {
    /// Steps of a ray before it is cast exactly.
    pub fn steps(self) -> u32 {
        match self {
            Self::Exact => 0,
            Self::Hybrid { steps, .. } => steps,
        }
    }
}

/// What a map of albedos holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AlbedoRole {
    /// What multiplies the reflectance.
    #[default]
    Factor,
    /// Hapke's `w`.
    SingleScattering,
}

/// A sky of the same radiance everywhere.
#[derive(Debug)]
pub struct Ambient {
    /// Radiance of all of the sky.
    pub radiance_w_m2_sr: f64,
    /// Share of it that lights the facet at each node of each face's levels.
    pub shares: Vec<Vec<Vec<f32>>>,
}

/// What may change from view to view.
#[derive(Debug, Clone)]
pub struct View {
    /// Counts the exposures of a sequence; the detector's noise depends on it.
    pub exposure: u64,
    /// Position of the camera's pupil.
    pub camera_position: Position<BodyFixed>,
    /// Turns body-fixed components into the camera's: +x right, +y down, +z along the boresight.
    pub camera_from_body: Rotation<Camera, BodyFixed>,
    /// The Sun first.
    pub lights: Vec<Light>,
    /// How the ground reflects.
    pub reflectance: Reflectance,
    /// The lens and the pixels.
    pub optics: Optics,
    /// Samples along each side of a pixel, on a regular grid.
    pub samples_per_side: usize,
    /// `∫ T dλ` of the camera's response; `None`: all wavelengths count.
    pub band_width_nm: Option<f64>,
    /// Turns light into digital numbers, where any are asked for.
    pub detector: Option<Detector>,
    /// The planes that are asked for.
    pub quantities: Vec<Quantity>,
}

/// A luminous disc.
#[derive(Debug, Clone)]
pub struct Light {
    /// Apparent position: where the light seems to come from.
    pub position: Position<BodyFixed>,
    /// Half the angle that the disc spans.
    pub angular_radius_rad: f64,
    /// Irradiance of a plane that faces it, in the camera's band.
    pub irradiance_w_m2: f64,
}

impl View {
    /// Radiance of the Moon's ground in Hapke's model, seen by one ray through each pixel's centre.
    pub fn new(pose: Pose, optics: Optics, lights: Vec<Light>) -> Self {
        Self {
            exposure: 0,
            camera_position: pose.position,
            camera_from_body: pose.camera_from_body,
            lights,
            reflectance: Reflectance::Hapke(Hapke::moon()),
            optics,
            samples_per_side: 1,
            band_width_nm: None,
            detector: None,
            quantities: vec![Quantity::Radiance],
        }
    }

    /// The view from another pose.
    pub fn from(&self, pose: &Pose) -> Self {
        Self { camera_position: pose.position, camera_from_body: pose.camera_from_body, ..self.clone() }
    }

    /// The camera's pose.
    pub fn pose(&self) -> Pose {
        Pose { position: self.camera_position, camera_from_body: self.camera_from_body }
    }

    /// With another reflectance of the ground.
    pub fn with_reflectance(self, reflectance: Reflectance) -> Self {
        Self { reflectance, ..self }
    }

    /// With another lens.
    pub fn with_optics(self, optics: Optics) -> Self {
        Self { optics, ..self }
    }

    /// With `n × n` samples in each pixel.
    pub fn with_samples_per_side(self, samples_per_side: usize) -> Self {
        Self { samples_per_side, ..self }
    }

    /// With a detector, for planes of digital numbers.
    pub fn with_detector(self, detector: Detector) -> Self {
        Self { detector: Some(detector), ..self }
    }

    /// With other planes.
    pub fn with_quantities(self, quantities: impl Into<Vec<Quantity>>) -> Self {
        Self { quantities: quantities.into(), ..self }
    }

    /// The lights as methods that find skylines in advance see them.
    pub fn quantized_lights(&self) -> Vec<QuantizedLight> {
        self.lights.iter().map(|light| QuantizedLight::new(light.position, light.angular_radius_rad)).collect()
    }
}

/// Rays that a renderer shall follow.
#[derive(Debug, Clone, PartialEq)]
pub struct Rays {
    /// The lens and the pixels.
    pub optics: Optics,
    /// Samples along each side of a pixel, on a regular grid.
    pub samples_per_side: usize,
    /// Whether one ray goes through each pixel's centre and its hit is told.
    pub centres: bool,
}

impl Rays {
    /// Offsets of the samples from the pixel's centre, in pixels.
    pub fn offsets(&self) -> Vec<glam::DVec2> {
        let n = self.samples_per_side;
        let offset = |i: usize| (i as f64 + 0.5) / n as f64 - 0.5;
        (0..n * n).map(|i| glam::DVec2::new(offset(i % n), offset(i / n))).collect()
    }
}

impl Scene {
    /// A surface under a black sky and a Sun of even brightness, without cast shadows.
    pub fn new(surface: impl Into<Arc<Surface>>) -> Self {
        let disk = SolarDisk::new(LimbDarkening::Uniform).expect("an even disc is in the law's domain");
        Self {
            surface: surface.into(),
            view_rays: ViewRays::Exact,
            shadows: registry::no_shadows(),
            refine: None,
            albedo: None,
            albedo_role: AlbedoRole::Factor,
            ambient: None,
            bounce: None,
            disk: Arc::new(disk),
        }
    }

    /// With another method of shadows.
    pub fn with_shadows(self, shadows: Arc<dyn ShadowMethod>) -> Self {
        Self { shadows, ..self }
    }

    /// With another way of finding the ground along a ray.
    pub fn with_view_rays(self, view_rays: ViewRays) -> Self {
        Self { view_rays, ..self }
    }

    /// With the Sun's share traced where horizon maps leave it open.
    pub fn with_refinement(self, settings: crate::horizon::Settings) -> Self {
        Self { refine: Some(settings), ..self }
    }

    /// With a map of albedos at the nodes of each face's levels.
    pub fn with_albedo(self, albedo: Vec<Vec<Vec<f32>>>, role: AlbedoRole) -> Self {
        Self { albedo: Some(Arc::new(albedo)), albedo_role: role, ..self }
    }

    /// With light from all of the sky.
    pub fn with_ambient(self, ambient: Ambient) -> Self {
        Self { ambient: Some(Arc::new(ambient)), ..self }
    }

    /// With sunlight that terrain reflects onto terrain.
    pub fn with_bounce(self, bounce: Bounce) -> Self {
        Self { bounce: Some(Arc::new(bounce)), ..self }
    }

    /// With another law of the lights' discs.
    pub fn with_disk(self, disk: SolarDisk) -> Self {
        Self { disk: Arc::new(disk), ..self }
    }

    /// The rays of a view's whole image.
    pub fn rays(&self, view: &View) -> Rays {
        let View { optics, samples_per_side, .. } = view;
        Rays { optics: optics.clone(), samples_per_side: *samples_per_side, centres: self.needs_centres(view) }
    }

    /// Whether the map of albedos holds Hapke's `w` and the law is his.
    pub fn albedo_is_w(&self, law: &Reflectance) -> bool {
        let holds_w = self.albedo.is_some() && self.albedo_role == AlbedoRole::SingleScattering;
        holds_w && matches!(law, Reflectance::Hapke(_))
    }

    /// Radiance over irradiance of ground where the map of albedos has a value; 1 or none where there is no map.
    pub fn brdf_sr(
        &self,
        law: &Reflectance,
        albedo: f64,
        incidence_cosine: f64,
        emission_cosine: f64,
        phase_cosine: f64,
    ) -> f64 {
        match law {
            Reflectance::Hapke(hapke) if self.albedo_is_w(law) => {
                let ground = Hapke { single_scattering_albedo: albedo.clamp(0.0, 1.0), ..*hapke };
                Reflectance::Hapke(ground).brdf_sr(incidence_cosine, emission_cosine, phase_cosine)
            }
            law => albedo * law.brdf_sr(incidence_cosine, emission_cosine, phase_cosine),
        }
    }

    /// What stands for the map's value where it has none: nothing changes, or the law's own `w`.
    pub fn bare_albedo(&self, law: &Reflectance) -> f64 {
        match law {
            Reflectance::Hapke(hapke) if self.albedo_is_w(law) => hapke.single_scattering_albedo,
            _ => 1.0,
        }
    }

    /// True where refinement or any of the view's quantities needs the ray through the pixel's centre.
    pub fn needs_centres(&self, view: &View) -> bool {
        self.refine.is_some() || view.quantities.iter().any(|quantity| quantity.is_geometric())
    }
}
