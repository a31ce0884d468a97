//! All a renderer needs, as plain numbers: no epoch, no kernel, no file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::camera::{Camera as Optics, Detector, Pose};
use crate::geometry::{BodyFixed, Camera, Position, Rotation};
use crate::horizon::HorizonMap;
use crate::photometry::{Hapke, Reflectance, SolarDisk};
use crate::shadow::{At, Baked, HeldLight, Lighting, Mipmaps, Towards};
use crate::terrain::Surface;

use super::{Bounce, Quantity};

/// What stays the same from exposure to exposure.
#[derive(Debug)]
pub struct Scene {
    pub surface: Surface,
    pub view_rays: ViewRays,
    pub shadows: Shadows,
    /// How the Sun's share is traced where horizon maps leave it open; `None`: it is not.
    pub refine: Option<crate::horizon::Settings>,
    pub reflectance: Reflectance,
    /// A number of the reflectance at the nodes of each face's levels; `None`: it is the same everywhere.
    pub albedo: Option<Vec<Vec<Vec<f32>>>>,
    /// Which number that is.
    pub albedo_role: AlbedoRole,
    /// Light from all of the sky; `None`: the sky is black.
    pub ambient: Option<Ambient>,
    /// Sunlight that terrain reflects onto terrain; `None`: none.
    pub bounce: Option<Bounce>,
    /// The law of the lights' discs: the Sun's. Earthshine is 1e-4 of sunlight, and its disc's own law unknown.
    pub disk: SolarDisk,
    /// `∫ T dλ` of the camera's response; `None`: all wavelengths count.
    pub band_width_nm: Option<f64>,
    pub optics: Optics,
    /// Turns light into digital numbers, where any are asked for.
    pub detector: Option<Detector>,
    /// Samples along each side of a pixel, on a regular grid.
    pub samples_per_side: usize,
    pub quantities: Vec<Quantity>,
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

/// A sky of the same radiance everywhere. The ground reflects its light as if it came along the normal.
#[derive(Debug)]
pub struct Ambient {
    pub radiance_w_m2_sr: f64,
    /// Share of it that lights the facet at each node of each face's levels.
    pub shares: Vec<Vec<Vec<f32>>>,
}

/// Where the terrain's shadows come from.
#[derive(Debug)]
pub enum Shadows {
    /// Only a facet's own plane shades it.
    None,
    /// Horizon maps by face and level, evaluated at every sample.
    Fourier(Vec<Vec<HorizonMap>>),
    /// Horizon maps evaluated once per node while the lights stand still.
    Baked(Baked),
    /// Lighting factors from horizon maps.
    Lighting(Lighting),
    /// Skylines of all nodes towards each light, found by the method while the lights stand still.
    Towards(Box<dyn Towards>),
    /// Maximum mipmaps, searched towards each light at every sample.
    Mipmaps(Mipmaps),
    /// The believed horizon at every sample: slow, and only for the reference renderer.
    Traced(crate::horizon::Settings),
}

impl Shadows {
    /// What the method is called in reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Fourier(_) => "fourier",
            Self::Baked(_) => "baked",
            Self::Lighting(_) => "lighting factor",
            Self::Towards(method) => method.name(),
            Self::Mipmaps(_) => "mipmaps",
            Self::Traced(_) => "traced",
        }
    }

    /// The horizon maps that the shadows come from.
    pub fn maps(&self) -> Option<&[Vec<HorizonMap>]> {
        match self {
            Self::Fourier(maps) | Self::Baked(Baked(maps)) | Self::Lighting(Lighting { maps, .. }) => Some(maps),
            Self::None | Self::Towards(_) | Self::Mipmaps(_) | Self::Traced(_) => None,
        }
    }

    /// Whether something is found for all nodes at once while the lights stand still.
    pub fn are_found_at_nodes(&self) -> bool {
        self.towards().is_some() || matches!(self, Self::Lighting(Lighting { at: At::Nodes, .. }))
    }

    /// The method that finds skylines while the lights stand still.
    pub fn towards(&self) -> Option<&dyn Towards> {
        match self {
            Self::Baked(baked) => Some(baked),
            Self::Towards(method) => Some(method.as_ref()),
            Self::None | Self::Fourier(_) | Self::Lighting(_) | Self::Mipmaps(_) | Self::Traced(_) => None,
        }
    }
}

/// What changes from exposure to exposure.
#[derive(Debug, Clone)]
pub struct View {
    /// Counts the exposures of a sequence; the detector's noise depends on it.
    pub exposure: u64,
    pub camera_position: Position<BodyFixed>,
    pub camera_from_body: Rotation<Camera, BodyFixed>,
    /// The Sun first.
    pub lights: Vec<Light>,
}

/// A luminous disc.
#[derive(Debug, Clone)]
pub struct Light {
    /// Apparent position: where the light seems to come from.
    pub position: Position<BodyFixed>,
    pub angular_radius_rad: f64,
    /// Irradiance of a plane that faces it, in the camera's band.
    pub irradiance_w_m2: f64,
}

impl View {
    /// The same exposure and lights from another pose.
    pub fn from(&self, pose: &Pose) -> Self {
        Self { camera_position: pose.position, camera_from_body: pose.camera_from_body, ..self.clone() }
    }

    /// The lights as methods that find skylines in advance see them.
    pub fn held_lights(&self) -> Vec<HeldLight> {
        self.lights.iter().map(|light| HeldLight::new(light.position, light.angular_radius_rad)).collect()
    }
}

/// Rays that a renderer shall follow.
#[derive(Debug, Clone, PartialEq)]
pub struct Rays {
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
    /// Those of the whole image from one pose.
    pub fn rays(&self) -> Rays {
        Rays { optics: self.optics.clone(), samples_per_side: self.samples_per_side, centres: self.needs_centres() }
    }

    /// Radiance over irradiance of ground where the map of albedos has a value; 1 or none where there is no map.
    pub fn brdf_sr(&self, albedo: f64, incidence_cosine: f64, emission_cosine: f64, phase_cosine: f64) -> f64 {
        match (self.albedo_role, self.reflectance) {
            (AlbedoRole::SingleScattering, Reflectance::Hapke(hapke)) if self.albedo.is_some() => {
                let ground = Hapke { single_scattering_albedo: albedo.clamp(0.0, 1.0), ..hapke };
                Reflectance::Hapke(ground).brdf_sr(incidence_cosine, emission_cosine, phase_cosine)
            }
            (_, law) => albedo * law.brdf_sr(incidence_cosine, emission_cosine, phase_cosine),
        }
    }

    /// What stands for the map's value where it has none: nothing changes, or the law's own `w`.
    pub fn bare_albedo(&self) -> f64 {
        match (self.albedo_role, self.reflectance) {
            (AlbedoRole::SingleScattering, Reflectance::Hapke(hapke)) => hapke.single_scattering_albedo,
            _ => 1.0,
        }
    }

    /// True where refinement or any of the quantities needs the ray through the pixel's centre.
    pub fn needs_centres(&self) -> bool {
        self.refine.is_some() || self.quantities.iter().any(|quantity| quantity.is_geometric())
    }
}
