//! The renderer for GPUs: one compute pass over the pixels, f32 around the camera.
//!
//! Everything of planetary size is subtracted on the host in f64: a level's grid is counted from the
//! camera's cell, a map's ray parameters come from the camera's exact place in it, and directions of rays
//! are tabulated by [`crate::camera`], distortion included. The exposures of a sequence share all buffers
//! but a few hundred bytes.
//!
//! `reference` is the twin; `tests/conformance` holds the two together.

use std::time::Duration;

use glam::{DVec2, DVec3};
use wgpu::{Buffer, ComputePipeline};

use super::layout::{CentreOut, LightParameters, MapFace, MapLevel, PixelOut, ViewParameters};
use super::planes::{Radiometry, Samples};
use super::{RenderError, Renderer, Scene, Shadows, View};
use crate::geometry::{BodyFixed, Position};
use crate::gpu::Gpu;
use crate::horizon::{Encoding, HorizonMap, SERIES_WGSL};
use crate::photometry::{REFLECTANCE_WGSL, SOLAR_DISK_WGSL, SolarDisk};
use crate::terrain::{Face, Ground, Hit, Level, Pyramid, Surface};

/// The pass, as one text: declarations may come in any order.
pub const SHADER: &str = concat!(include_str!("passes.wgsl"), include_str!("../terrain/surface.wgsl"));

/// Gradients of nodes without heights; the shader takes slopes this steep for gaps.
const GAP_SLOPE: f32 = 1e30;

/// The shader takes rays beyond 1e20 for none.
const NO_RAY: f32 = 1e30;

/// Rays in one dispatch, at most: 32 MiB of directions.
const RAYS_AT_ONCE: usize = 4 << 20;

/// Pixels of one workgroup, as in the shader.
const GROUP: usize = 64;

/// Renders with compute shaders.
#[derive(Debug)]
pub struct Passes<'a> {
    gpu: &'a Gpu,
    prepared: Option<Prepared>,
    device_time: Option<Duration>,
}

/// What stays on the device from view to view.
#[derive(Debug)]
struct Prepared {
    pipeline: ComputePipeline,
    reflectance: Buffer,
    disk_tables: Buffer,
    heights: Buffer,
    /// In two pages.
    gradients: [Buffer; 2],
    maxima: Buffer,
    /// Horizon maps, in pages.
    texels: [Buffer; PAGES],
    albedos: Buffer,
    levels: Vec<Packed>,
    /// Directions of the rays, in bands of whole pixels.
    bands: Vec<Band>,
}

/// A level as the shader knows it, and where it comes from.
#[derive(Debug)]
struct Packed {
    shader: MapLevel,
    face: usize,
    level: usize,
}

#[derive(Debug)]
struct Band {
    pixels: usize,
    rays: Buffer,
}

/// What the device made of a view.
#[derive(Debug)]
struct Dispatched {
    pixels: Vec<PixelOut>,
    /// Empty where no plane needs them.
    centres: Vec<CentreOut>,
    seconds: Option<f64>,
}

impl<'a> Passes<'a> {
    pub fn new(gpu: &'a Gpu) -> Self {
        Self { gpu, prepared: None, device_time: None }
    }
}

impl Renderer for Passes<'_> {
    fn adapter(&self) -> String {
        self.gpu.describe()
    }

    fn device_time(&self) -> Option<Duration> {
        self.device_time
    }

    fn samples(&mut self, scene: &Scene, view: &View) -> Result<Samples, RenderError> {
        if self.prepared.is_none() {
            self.prepared = Some(Prepared::new(self.gpu, scene, view)?);
        }
        let prepared = self.prepared.as_ref().expect("prepared above");
        let Dispatched { pixels, centres, seconds } = prepared.dispatch(self.gpu, scene, view)?;
        self.device_time = seconds.map(Duration::from_secs_f64);
        let pixels = pixels.iter().map(Radiometry::from).collect();
        let centres = if scene.needs_centres() { prepared.hits(scene, view, &centres) } else { Vec::new() };
        Ok(Samples { pixels, centres })
    }
}

impl Prepared {
    fn new(gpu: &Gpu, scene: &Scene, view: &View) -> Result<Self, RenderError> {
        let horizons = match &scene.shadows {
            Shadows::None => None,
            Shadows::Fourier(maps) => Some(maps),
            Shadows::Traced(_) => return Err(RenderError::TracedOnGpu),
        };
        let mut store = Store::default();
        for (face, levels) in scene.surface.terrain.faces.iter().enumerate() {
            for level in 0..levels.levels.len() {
                let horizon = horizons.map(|maps| &maps[face][level]);
                let albedo = scene.albedo.as_ref().map(|maps| maps[face][level].as_slice());
                store.add(&scene.surface, face, level, horizon, albedo);
            }
        }
        let offsets = scene.sample_offsets();
        // Where a sample goes through the centre it serves for both.
        let central = offsets.iter().position(|offset| *offset == DVec2::ZERO);
        let extra = scene.needs_centres() && central.is_none();
        let rays_per_pixel = offsets.len() + usize::from(extra);
        let centre = if scene.needs_centres() { central.unwrap_or(offsets.len()) } else { rays_per_pixel };
        let page_bits = self::page_bits::<[u32; 4]>(gpu);
        let gradient_page_bits = self::page_bits::<[f32; 2]>(gpu);
        let mut constants = vec![
            ("PAGES", pages_needed(&store.texels, page_bits)? as f64),
            ("PAGE_BITS", f64::from(page_bits)),
            ("GRADIENT_PAGE_BITS", f64::from(gradient_page_bits)),
            ("MORE_GRADIENTS", f64::from(u8::from(store.gradients.len() > 1 << gradient_page_bits))),
            ("RAYS", rays_per_pixel as f64),
            ("SAMPLES", offsets.len() as f64),
            ("CENTRE", centre as f64),
            ("FACES", scene.surface.terrain.faces.len() as f64),
            ("LIGHTS", view.lights.len() as f64),
            ("ALBEDO_MAP", f64::from(u8::from(scene.albedo.is_some()))),
            ("HORIZONS", f64::from(u8::from(horizons.is_some()))),
            scene.reflectance.constant(),
        ];
        constants.extend(SolarDisk::constants());
        let shader = [SHADER, SOLAR_DISK_WGSL, REFLECTANCE_WGSL, SERIES_WGSL].concat();
        let mut points = offsets;
        if extra {
            points.push(DVec2::ZERO);
        }
        Ok(Self {
            pipeline: gpu.compute("radiance", &shader, "main", &constants)?,
            reflectance: gpu.storage("reflectance", &[scene.reflectance.parameters()]),
            disk_tables: gpu.storage("disc tables", &scene.disk.tables()),
            heights: checked(gpu, "lifted heights", &store.heights_m)?,
            gradients: gradient_pages(gpu, &store.gradients, gradient_page_bits)?,
            maxima: checked(gpu, "maxima", &store.maxima_m)?,
            texels: pages(gpu, &store.texels, page_bits),
            albedos: checked(gpu, "albedos", &store.albedos)?,
            levels: store.levels,
            bands: bands(gpu, scene, &points),
        })
    }

    fn dispatch(&self, gpu: &Gpu, scene: &Scene, view: &View) -> Result<Dispatched, RenderError> {
        let terrain = &scene.surface.terrain;
        let faces: Vec<MapFace> =
            terrain.faces.iter().enumerate().map(|(index, face)| self.map_face(scene, view, index, face)).collect();
        let levels: Vec<MapLevel> = self.levels.iter().map(|level| level.centred(scene, view)).collect();
        let lights = lights(scene, view);
        let faces = gpu.storage("maps", &never_empty(faces));
        let levels = gpu.storage("levels", &never_empty(levels));
        let lights = gpu.storage("lights", &lights);
        let (mut pixels, mut centres, mut seconds) = (Vec::new(), Vec::new(), Some(0.0));
        for band in &self.bands {
            let parameters = gpu.storage("view", &[ViewParameters::new(&terrain.body, view, band.pixels)]);
            let pixels_out = gpu.output("pixels", (band.pixels * size_of::<PixelOut>()) as u64);
            let centres_out = gpu.output("centres", (band.pixels * size_of::<CentreOut>()) as u64);
            let buffers = [
                &parameters,
                &faces,
                &levels,
                &lights,
                &self.reflectance,
                &self.disk_tables,
                &self.heights,
                &self.gradients[0],
                &self.maxima,
                &self.albedos,
                &band.rays,
                &pixels_out,
                &centres_out,
                &self.texels[0],
                &self.texels[1],
                &self.texels[2],
                &self.texels[3],
                &self.gradients[1],
            ];
            let groups = band.pixels.div_ceil(GROUP);
            // A dimension holds at most 65535 workgroups.
            let across = groups.min(1 << 15);
            let spent = gpu.run(&self.pipeline, &buffers, [across as u32, groups.div_ceil(across) as u32, 1]);
            seconds = seconds.zip(spent).map(|(sum, spent)| sum + spent);
            pixels.extend(gpu.read::<PixelOut>(&pixels_out)?);
            if scene.needs_centres() {
                centres.extend(gpu.read::<CentreOut>(&centres_out)?);
            }
        }
        Ok(Dispatched { pixels, centres, seconds })
    }

    fn map_face(&self, scene: &Scene, view: &View, index: usize, face: &Face) -> MapFace {
        let first_level = self.levels.iter().position(|level| level.face == index).unwrap_or(0);
        MapFace::new(view, face, first_level, scene.surface.terrain.faces.len() == 1)
    }

    /// The centres' hits in f64: the device says where on which cell, the host computes the point.
    fn hits(&self, scene: &Scene, view: &View, centres: &[CentreOut]) -> Vec<Option<Hit>> {
        use rayon::prelude::*;
        let columns = scene.optics.columns as usize;
        let pixel = |index: usize| DVec2::new((index % columns) as f64, (index / columns) as f64);
        centres.par_iter().enumerate().map(|(index, centre)| self.hit(scene, view, pixel(index), centre)).collect()
    }

    fn hit(&self, scene: &Scene, view: &View, pixel: DVec2, centre: &CentreOut) -> Option<Hit> {
        let terrain = &scene.surface.terrain;
        match centre.ground {
            CentreOut::DEM => {
                let &Packed { face, level, ref shader } = &self.levels[centre.level as usize];
                let grid_level = &terrain.faces[face].levels[level];
                let cell = DVec2::new(f64::from(centre.cell % shader.columns), f64::from(centre.cell / shader.columns));
                let grid = cell + DVec2::from(centre.fraction.map(f64::from)) + grid_level.margin as f64;
                let lifted = grid_level.map_from_grid(grid).extend(grid_level.bilinear_m(grid)?);
                let position = terrain.faces[face].map.body_from_lifted(lifted);
                let distance_m = position.distance_m(view.camera_position);
                Some(Hit { ground: Ground::Dem { face, level, lifted }, position, distance_m })
            }
            CentreOut::MISS => None,
            ground => {
                let direction = view.camera_from_body.inverse() * scene.optics.direction(pixel)?;
                let distance_m = f64::from(centre.distance_m);
                let ground = if ground == CentreOut::GAP { Ground::Gap } else { Ground::Bare };
                let position: Position<BodyFixed> =
                    Position::from_m(view.camera_position.vector_m() + distance_m * direction.unit());
                Some(Hit { ground, position, distance_m })
            }
        }
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

/// The terrain's numbers in the shader's order: the seen parts of all levels, one after the other.
#[derive(Debug, Default)]
struct Store {
    levels: Vec<Packed>,
    heights_m: Vec<f32>,
    gradients: Vec<[f32; 2]>,
    maxima_m: Vec<f32>,
    texels: Vec<[u32; 4]>,
    albedos: Vec<f32>,
}

impl Store {
    fn add(
        &mut self,
        surface: &Surface,
        face: usize,
        level: usize,
        horizon: Option<&HorizonMap>,
        albedo: Option<&[f32]>,
    ) {
        let full = &surface.terrain.faces[face].levels[level];
        let seen = full.seen();
        let pyramid = if full.margin == 0 { &surface.pyramids[face][level] } else { &Pyramid::new(&seen) };
        let mut shader = MapLevel::new(&seen, face);
        shader.heights_offset = self.heights_m.len() as u32;
        shader.maxima_offset = self.maxima_m.len() as u32;
        shader.mips = pyramid.mips.len() as u32;
        self.heights_m.extend(&seen.heights_m);
        self.gradients.extend(gradients(full));
        self.maxima_m.extend(pyramid.mips.iter().flat_map(|mip| &mip.maxima_m));
        if let Some(albedo) = albedo {
            let seen = full.margin..full.rows - full.margin;
            let cut = |row: usize| full.index(full.margin, row)..full.index(full.columns - full.margin, row);
            self.albedos.extend(seen.flat_map(|row| &albedo[cut(row)]));
        }
        if let Some(map) = horizon {
            shader.has_horizon = 1;
            shader.horizon_halving = u32::from(map.encoding == Encoding::Fm16);
            for (offset, texels) in shader.horizon.iter_mut().zip(&map.levels) {
                *offset = self.texels.len() as u32;
                self.texels.extend(&texels.texels);
            }
        }
        self.levels.push(Packed { shader, face, level });
    }
}

impl Packed {
    /// The level with its grid counted from the camera's cell.
    fn centred(&self, scene: &Scene, view: &View) -> MapLevel {
        let face = &scene.surface.terrain.faces[self.face];
        let Some(lifted) = MapFace::direct_start(&face.map, view.camera_position) else { return self.shader };
        let level = &face.levels[self.level];
        self.shader.about(level.grid_from_map(lifted.truncate()) - level.margin as f64)
    }
}

/// A binding holds at least one element; a scene without maps reads none of them.
fn never_empty<T: bytemuck::Zeroable>(mut values: Vec<T>) -> Vec<T> {
    if values.is_empty() {
        values.push(T::zeroed());
    }
    values
}

/// Gradients of the seen nodes; those without heights of their own are marked.
fn gradients(level: &Level) -> Vec<[f32; 2]> {
    use rayon::prelude::*;
    let rows = level.margin..level.rows - level.margin;
    rows.into_par_iter()
        .flat_map_iter(|row| {
            (level.margin..level.columns - level.margin).map(move |column| {
                if level.gap[level.index(column, row)] {
                    [GAP_SLOPE; 2]
                } else {
                    level.gradient(column, row).as_vec2().to_array()
                }
            })
        })
        .collect()
}

/// Lights by map, and by body last.
fn lights(scene: &Scene, view: &View) -> Vec<LightParameters> {
    let of_frame = |vector: &dyn Fn(Position<BodyFixed>) -> DVec3| -> Vec<LightParameters> {
        view.lights.iter().map(|light| LightParameters::new(light, vector(light.position))).collect()
    };
    let maps = scene.surface.terrain.faces.iter().flat_map(|face| of_frame(&|position| face.map.map_vector(position)));
    maps.chain(of_frame(&|position| position.vector_m())).collect()
}

fn bands(gpu: &Gpu, scene: &Scene, points: &[DVec2]) -> Vec<Band> {
    let (columns, rows) = (scene.optics.columns as usize, scene.optics.rows as usize);
    let rows_at_once = (RAYS_AT_ONCE / (points.len() * columns)).clamp(1, rows);
    (0..rows)
        .step_by(rows_at_once)
        .map(|first| {
            let until = (first + rows_at_once).min(rows);
            let rays = directions(scene, first..until, points);
            Band { pixels: (until - first) * columns, rays: gpu.storage("rays", &rays) }
        })
        .collect()
}

/// `x/z, y/z` of each ray, pixel by pixel; `NO_RAY` where the optics see nothing.
fn directions(scene: &Scene, rows: std::ops::Range<usize>, points: &[DVec2]) -> Vec<[f32; 2]> {
    use rayon::prelude::*;
    rows.into_par_iter()
        .flat_map_iter(|row| {
            (0..scene.optics.columns).flat_map(move |column| {
                points.iter().map(move |offset| {
                    let pixel = DVec2::new(column as f64, row as f64) + *offset;
                    scene.optics.direction(pixel).map_or([NO_RAY; 2], |direction| {
                        let d = direction.unit();
                        [(d.x / d.z) as f32, (d.y / d.z) as f32]
                    })
                })
            })
        })
        .collect()
}

/// Most bindings of horizon maps, as in the shader.
const PAGES: usize = 4;

/// Elements of a page, as a power of two, that the adapter takes in one binding.
fn page_bits<T>(gpu: &Gpu) -> u32 {
    (gpu.device.limits().max_storage_buffer_binding_size / size_of::<T>() as u64).ilog2().min(31)
}

fn gradient_pages(gpu: &Gpu, gradients: &[[f32; 2]], page_bits: u32) -> Result<[Buffer; 2], RenderError> {
    let (first, more) = gradients.split_at(gradients.len().min(1 << page_bits));
    Ok([checked(gpu, "gradients", first)?, checked(gpu, "gradients", more)?])
}

fn pages_needed(texels: &[[u32; 4]], page_bits: u32) -> Result<usize, RenderError> {
    let pages = texels.len().div_ceil(1 << page_bits).max(1);
    if pages > PAGES {
        let bytes = |texels: usize| (texels * size_of::<[u32; 4]>()) as u64;
        let (needed_mib, allowed_mib) = (bytes(texels.len()) >> 20, bytes(PAGES << page_bits) >> 20);
        return Err(RenderError::BufferTooLarge { what: "horizon maps", needed_mib, allowed_mib });
    }
    Ok(pages)
}

fn pages(gpu: &Gpu, texels: &[[u32; 4]], page_bits: u32) -> [Buffer; PAGES] {
    let mut chunks = texels.chunks(1 << page_bits);
    std::array::from_fn(|_| gpu.storage("horizon maps", chunks.next().unwrap_or(&[])))
}

fn checked<T: bytemuck::Pod>(gpu: &Gpu, what: &'static str, values: &[T]) -> Result<Buffer, RenderError> {
    let needed = size_of_val(values) as u64;
    let allowed = gpu.device.limits().max_storage_buffer_binding_size;
    if needed > allowed {
        return Err(RenderError::BufferTooLarge { what, needed_mib: needed >> 20, allowed_mib: allowed >> 20 });
    }
    Ok(gpu.storage(what, values))
}
