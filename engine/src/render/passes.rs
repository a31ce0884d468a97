//! The renderer for GPUs: one compute pass over the pixels, f32 around the camera.
//!
//! Everything of planetary size is subtracted on the host in f64: a level's grid is counted from the
//! camera's cell, a map's ray parameters come from the camera's exact place in it, and directions of rays
//! are tabulated by [`crate::camera`], distortion included. The exposures of a sequence share all buffers
//! but a few hundred bytes.
//!
//! `reference` is the twin; `tests/conformance` holds the two together.

mod hits;
mod rays;
mod skylines;
mod starts;
mod uncertain;
mod upload;

use std::convert::Infallible;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

use glam::{DVec2, DVec3};
use wgpu::{Buffer, ComputePipeline};

pub use starts::SHADER as MESH_SHADER;
pub use upload::DeviceGround;

use rays::Band;
use skylines::DeviceSkylines;
use starts::{DeviceMesh, Starts};
use uncertain::trace_uncertain;
use upload::PackedLevel;

use super::layout::{CentreOut, LightParameters, MapFace, MapLevel, PixelOut, RayWindow, ViewParameters};
use super::planes::{Radiometry, Samples};
use super::recent::Recent;
use super::{Diffuse, Rays, RenderError, Scene, View, ViewRays, reference, sky_reflectance};
use crate::geometry::{BodyFixed, Position};
use crate::gpu::{Gpu, GpuError, workgroups};
use crate::photometry::{REFLECTANCE_WGSL, Reflectance, SOLAR_DISK_WGSL, SkyReflectance};
use crate::shadow::device::{BINDINGS, DevicePart, LevelTexels};
use crate::shadow::field_pages::page_bits;
use crate::shadow::{Skylines, UnpreparedLight};
use crate::terrain::Face;

/// The pass but for the shadow method's part ([`DevicePart::wgsl`]): declarations may come in any order.
pub const SHADER: &str = concat!(
    include_str!("passes.wgsl"),
    include_str!("ray_window.wgsl"),
    include_str!("starts.wgsl"),
    include_str!("../terrain/maps.wgsl"),
    include_str!("../terrain/surface.wgsl"),
    include_str!("../terrain/azimuth_ratio.wgsl"),
    include_str!("../gpu/cut_short.wgsl"),
);

/// Pixels of one workgroup, as in the shader.
const GROUP: usize = 64;

/// Rays of a pixel in one pass, at first. Software Vulkan cuts loops short after 65 535 turns, which a grazing ray over wide terrain
/// with some lights brings near by itself: where it does, fewer are followed at once.
const RAYS_AT_ONCE: usize = 16;

/// A scene on a device, and what its views have asked for so far.
#[derive(Debug)]
pub struct Passes {
    gpu: Gpu,
    shader: String,
    /// Those that no view changes.
    constants: Vec<Constant>,
    programs: Recent<Vec<Constant>, ComputePipeline>,
    tables: Recent<Rays, Table>,
    skies: Recent<Reflectance, Option<Arc<SkyReflectance>>>,
    disk_tables: Buffer,
    ground: DeviceGround,
    /// What the shadow method's WGSL reads, and where each level lies in it.
    method_buffers: Vec<Buffer>,
    method_texels: Vec<LevelTexels>,
    skylines: Option<DeviceSkylines>,
    /// Where rays start that are not cast exactly from the camera.
    mesh: Option<DeviceMesh>,
    device_time: Option<Duration>,
}

/// Bindings of the pass itself, as in the shader: the view's, which changes with the rays that are followed, and the others.
const VIEW: u32 = BINDINGS as u32;
const FIRST_OWN: u32 = VIEW + 1;

/// An `override` value of the shader.
type Constant = (&'static str, f64);

/// Programs that are kept. Views differ in few of the numbers that a program is made for.
const PROGRAMS: usize = 16;

/// Laws whose reflection of the sky is kept.
const SKIES: usize = 16;

/// Bytes of rays' directions that are kept, and what a table counts for at least.
const TABLE_BYTES: usize = 512 << 20;
const LEAST_TABLE_BYTES: usize = 1 << 20;

/// The directions of some rays, on the device.
#[derive(Debug)]
struct Table {
    bands: Vec<Band>,
    window: RayWindow,
}

/// What a session keeps besides its scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CacheSize {
    /// Compiled programs.
    pub programs: usize,
    /// Tables of rays.
    pub tables: usize,
}

/// What the device made of a view.
#[derive(Debug)]
struct Dispatched {
    pixels: Vec<PixelOut>,
    /// Empty where no plane needs them.
    centres: Vec<CentreOut>,
    seconds: Option<f64>,
}

impl Passes {
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, RenderError> {
        let DevicePart { wgsl, constants: of_method, buffers, texels, fields } =
            scene.shadows.device(gpu, &scene.surface, &scene.disk)?;
        let ground = DeviceGround::new(gpu, scene)?;
        let mut constants = vec![
            ("FACES", scene.surface.terrain.faces.len() as f64),
            ("ALBEDO_MAP", f64::from(u8::from(scene.albedo.is_some()))),
            ("SKY_W_M2", scene.ambient.as_ref().map_or(0.0, |ambient| ambient.irradiance_w_m2())),
            ("BOUNCES", f64::from(u8::from(scene.bounce.is_some()))),
        ];
        constants.extend(scene.disk.constants());
        if fields.is_some() {
            constants.push(("FIELD_PAGE_BITS", f64::from(page_bits(gpu))));
        }
        let skylines = fields.map(|fields| DeviceSkylines::new(gpu, fields, scene)).transpose()?;
        constants.extend(ground.constants);
        constants.extend(of_method);
        let mesh = match scene.view_rays {
            ViewRays::Exact => None,
            ViewRays::Hybrid { mesh_cells, .. } => Some(DeviceMesh::new(gpu, scene, mesh_cells as usize)?),
        };
        constants.push(("STEPS", f64::from(scene.view_rays.steps())));
        let shader = [SHADER, SOLAR_DISK_WGSL, REFLECTANCE_WGSL, &wgsl].concat();
        Ok(Self {
            gpu: gpu.clone(),
            shader,
            constants,
            programs: Recent::new(PROGRAMS),
            tables: Recent::new(TABLE_BYTES),
            skies: Recent::new(SKIES),
            disk_tables: gpu.storage("disc tables", &scene.disk.tables()),
            ground,
            method_buffers: buffers,
            method_texels: texels,
            skylines,
            mesh,
            device_time: None,
        })
    }

    /// What some rays from a view's pose see. The scene is the one that was given to [`Self::new`].
    pub fn follow(&mut self, scene: &Scene, rays: &Rays, view: &View) -> Result<Samples, RenderError> {
        // Bounced light is found on the host, from the same shadows as the reference renderer's.
        let shadow = match scene.bounce {
            Some(_) => reference::shadow(scene, view, &self.found_on_host(scene, view)?)?,
            None => None,
        };
        let sky = self.sky_reflectance(scene, &view.reflectance);
        let diffuse = Diffuse::of(scene, view, shadow.as_deref(), sky);
        let Dispatched { pixels, centres, seconds } = self.dispatch(scene, rays, view, &diffuse)?;
        self.device_time = seconds.map(Duration::from_secs_f64);
        let pixels = pixels.iter().map(Radiometry::from).collect();
        let centres =
            if rays.centres { hits::of_centres(&self.ground, scene, &rays.optics, view, &centres) } else { Vec::new() };
        let mut samples = Samples { pixels, centres };
        trace_uncertain(scene, rays, view, &diffuse, &mut samples);
        Ok(samples)
    }

    /// The skylines that the last view was rendered with.
    pub fn skylines(&mut self, scene: &Scene) -> Result<Skylines, RenderError> {
        match self.skylines.as_mut().filter(|_| scene.shadows.skylines().is_some()) {
            Some(kept) => kept.on_host(&self.gpu, scene),
            None => Ok(Skylines::default()),
        }
    }

    pub fn device_time(&self) -> Option<Duration> {
        self.device_time
    }

    pub fn cache_size(&self) -> CacheSize {
        CacheSize { programs: self.programs.len(), tables: self.tables.len() }
    }

    /// How a law reflects the scene's sky; it is found once.
    fn sky_reflectance(&mut self, scene: &Scene, law: &Reflectance) -> Option<Arc<SkyReflectance>> {
        let make = |law: &Reflectance| Ok::<_, Infallible>((sky_reflectance(scene, law).map(Arc::new), 1));
        let Ok(sky) = self.skies.get_or_make(*law, make);
        sky.clone()
    }

    /// Skylines towards a view's lights, where this method finds them on the host; they are found once.
    fn found_on_host(&mut self, scene: &Scene, view: &View) -> Result<Skylines, UnpreparedLight> {
        match &mut self.skylines {
            Some(skylines) => skylines.found_on_host(scene, &view.quantized_lights()),
            None => Ok(Skylines::default()),
        }
    }

    fn dispatch(
        &mut self,
        scene: &Scene,
        rays: &Rays,
        view: &View,
        diffuse: &Diffuse,
    ) -> Result<Dispatched, RenderError> {
        let gpu = &self.gpu;
        let bounced = diffuse.bounced.as_ref().map_or_else(Vec::new, |light| light.table());
        let bounced = gpu.storage("bounced light", &bounced);
        let sky = gpu.storage("sky reflectance", &diffuse.sky_table());
        let bounced_places = scene.bounce.as_ref().map_or_else(Vec::new, |bounce| bounce.places());
        let lights_on_raster = view.quantized_lights();
        let finding =
            self.skylines.as_mut().map(|s| s.towards(gpu, scene, &self.ground, &lights_on_raster)).transpose()?;
        let terrain = &scene.surface.terrain;
        let faces: Vec<MapFace> =
            terrain.faces.iter().enumerate().map(|(index, face)| self.map_face(scene, view, index, face)).collect();
        let placed = |(index, level): (usize, &PackedLevel)| {
            let centred = level.centred(scene, view);
            let centred = bounced_places.get(index).map_or(centred, |place| centred.with_bounced(*place));
            let placed = self.method_texels.get(index).map_or(centred, |texels| centred.with_texels(texels));
            self.skylines.as_ref().map_or(placed, |skylines| skylines.placed(placed, index))
        };
        let levels: Vec<MapLevel> = self.ground.levels.iter().enumerate().map(placed).collect();
        let fields = self.skylines.as_ref().map_or(&[][..], DeviceSkylines::buffers);
        let of_method = fields.iter().chain(&self.method_buffers);
        let lights = lights(scene, view);
        let faces = gpu.storage("maps", &never_empty(faces));
        let levels = gpu.storage("levels", &never_empty(levels));
        let lights = gpu.storage("lights", &lights);
        let reflectance = gpu.storage("reflectance", &[view.reflectance.parameters()]);
        let points = Points::of(rays);
        let make = |rays: &Rays| Ok::<_, RenderError>(Table::new(gpu, rays, &points.offsets));
        let table = self.tables.get_or_make(rays.clone(), make)?;
        let constants = points.constants().into_iter().chain(view_constants(scene, view)).collect();
        let pipeline = self.programs.get_or_make(constants, |constants| {
            let constants = [&constants[..], &self.constants].concat();
            gpu.compute("radiance", &self.shader, "main", &constants).map(|program| (program, 1))
        })?;
        let starts = match &self.mesh {
            Some(mesh) => mesh.starts(gpu, scene, view, table.window, [&faces, &levels]),
            None => Starts::at_the_camera(gpu),
        };
        let (mut pixels, mut centres, mut seconds) = (Vec::new(), Vec::new(), finding.unwrap_or(Some(0.0)));
        let mut at_once = RAYS_AT_ONCE;
        for band in &table.bands {
            let pixels_out = gpu.output("pixels", (band.pixels * size_of::<PixelOut>()) as u64);
            let centres_out = gpu.output("centres", (band.pixels * size_of::<CentreOut>()) as u64);
            let own = [
                &faces,
                &levels,
                &lights,
                &reflectance,
                &self.disk_tables,
                &self.ground.heights,
                &self.ground.gradients[0],
                &self.ground.maxima,
                &self.ground.albedos,
                &band.rays,
                &pixels_out,
                &centres_out,
                &self.ground.gradients[1],
                &self.ground.skies,
                &starts.window,
                &starts.depths,
                &sky,
                &bounced,
            ];
            let buffers: Vec<_> = (0..).zip(of_method.clone()).chain((FIRST_OWN..).zip(own)).collect();
            let groups = workgroups(band.pixels.div_ceil(GROUP));
            let mut follow = |rays: Range<usize>| {
                let parameters = gpu.storage("view", &[ViewParameters::new(&terrain.body, view, band.pixels, rays)]);
                let buffers = [&buffers[..], &[(VIEW, &parameters)]].concat();
                let spent = gpu.run_bound(pipeline, &buffers, groups);
                seconds = seconds.zip(spent).map(|(sum, spent)| sum + spent);
            };
            pixels.extend(loop {
                let rays = points.offsets.len();
                (0..rays).step_by(at_once).for_each(|first| follow(first..rays.min(first + at_once)));
                let pixels = gpu.read::<PixelOut>(&pixels_out)?;
                match pixels.iter().any(|pixel| pixel.hit == PixelOut::CUT_SHORT) {
                    false => break pixels,
                    true if at_once > 1 => at_once /= 2,
                    true => return Err(GpuError::CutShort { what: "rays" }.into()),
                }
            });
            if rays.centres {
                centres.extend(gpu.read::<CentreOut>(&centres_out)?);
            }
        }
        Ok(Dispatched { pixels, centres, seconds })
    }

    fn map_face(&self, scene: &Scene, view: &View, index: usize, face: &Face) -> MapFace {
        let first_level = self.ground.levels.iter().position(|level| level.face == index).unwrap_or(0);
        MapFace::new(view, face, &self.ground.balls[index], first_level, scene.surface.terrain.faces.len() == 1)
    }
}

/// The values of the shader that hang on the view.
fn view_constants(scene: &Scene, view: &View) -> [Constant; 3] {
    [
        ("LIGHTS", view.lights.len() as f64),
        ("ALBEDO_IS_W", f64::from(u8::from(scene.albedo_is_w(&view.reflectance)))),
        view.reflectance.constant(),
    ]
}

/// Where rays go through each pixel.
struct Points {
    /// From its centre, the samples first.
    offsets: Vec<DVec2>,
    samples: usize,
    /// Which of them goes through the centre; as many as there are where none does.
    centre: usize,
}

impl Points {
    fn of(rays: &Rays) -> Self {
        let mut offsets = rays.offsets();
        let samples = offsets.len();
        // Where a sample goes through the centre it serves for both.
        let central = offsets.iter().position(|offset| *offset == DVec2::ZERO);
        if rays.centres && central.is_none() {
            offsets.push(DVec2::ZERO);
        }
        let centre = if rays.centres { central.unwrap_or(samples) } else { offsets.len() };
        Self { offsets, samples, centre }
    }

    fn constants(&self) -> [Constant; 3] {
        [("RAYS", self.offsets.len()), ("SAMPLES", self.samples), ("CENTRE", self.centre)]
            .map(|(name, number)| (name, number as f64))
    }
}

impl Table {
    /// With its size in bytes.
    fn new(gpu: &Gpu, rays: &Rays, offsets: &[DVec2]) -> (Self, usize) {
        let (bands, window) = Band::all(gpu, &rays.optics, offsets);
        let bytes: usize = bands.iter().map(|band| band.rays.size() as usize).sum();
        (Self { bands, window }, bytes.max(LEAST_TABLE_BYTES))
    }
}

impl From<&PixelOut> for Radiometry {
    fn from(pixel: &PixelOut) -> Self {
        let gap = pixel.hit < 0.0;
        let ground = |value: f32| if gap || pixel.hit == 0.0 { f32::NAN } else { value };
        Self {
            radiance_w_m2_sr: if gap { f32::NAN } else { pixel.radiance },
            irradiance_w_m2: ground(pixel.irradiance),
            sun_fraction: ground(pixel.fraction),
            hit: if gap { 1.0 } else { pixel.hit },
        }
    }
}

/// Lights by map, and by body last.
fn lights(scene: &Scene, view: &View) -> Vec<LightParameters> {
    let of_frame = |vector: &dyn Fn(Position<BodyFixed>) -> DVec3| -> Vec<LightParameters> {
        view.lights.iter().map(|light| LightParameters::new(light, vector(light.position))).collect()
    };
    let maps = scene.surface.terrain.faces.iter().flat_map(|face| of_frame(&|position| face.map.map_vector(position)));
    maps.chain(of_frame(&|position| position.vector_m())).collect()
}

/// A binding holds at least one element; a scene without maps reads none of them.
fn never_empty<T: bytemuck::Zeroable>(mut values: Vec<T>) -> Vec<T> {
    if values.is_empty() {
        values.push(T::zeroed());
    }
    values
}
