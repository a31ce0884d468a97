//! Frames of one view with the methods of Fritsch et al. (2025) and Jung et al. (2020): table 3 of the one, figure 13 and
//! table 2 of the other.
//!
//! Cratered ground seen obliquely, the Sun at 6°. From frame to frame the Sun moves by a hundredth of its radius, so that what
//! is found at nodes is found anew each time, as in a vertex shader. Errors are those of the irradiance in shares of full
//! Sun, of a smaller image of the same view, against traced shadows.
//!
//! # References
//! Fritsch et al. (2025), doi:10.2312/hpg.20251171, section 4.3. Jung, Schrempf & Son (2020), Optimally fast soft shadows
//! on curved terrain with dynamic programming and maximum mipmaps, section 7.

use std::sync::Arc;
use std::time::Instant;

use glam::{DQuat, DVec2, DVec3};

use super::Options;
use crate::horizons::tiles::Scratch;
use crate::scenes::Scene as Ground;
use crate::shadows::compare;
use crate::stability::scenes::{SOLAR_IRRADIANCE_W_M2, pinhole, scene, sun, view};
use crate::{Error, Table, Value};
use perilune_engine::camera::Pose;
use perilune_engine::geometry::{Position, Rotation};
use perilune_engine::gpu::Gpu;
use perilune_engine::horizon::{self, Encoding, HorizonMap, Request, Settings};
use perilune_engine::pipeline::Progress;
use perilune_engine::render::planes::Radiometry;
use perilune_engine::render::{Quantity, Renderer, Scene, View};
use perilune_engine::shadow::{Ingredients, ShadowMethod, registry};
use perilune_engine::terrain::{Ground as Kind, Surface, Terrain};

const SUN_DEG: f64 = 6.0;
const AZIMUTH_RAD: f64 = 0.7;
/// Below the horizontal, and above the ground.
const LOOK_DOWN_DEG: f64 = 30.0;
const HEIGHT_M: f64 = 2500.0;
/// Half of what is seen across, over the distance.
const HALF_WIDTH: f64 = 0.5;
/// The image whose errors are measured.
const SMALL: [u32; 2] = [160, 90];

/// A method by its name in the registry, what the papers call it, and what they print: milliseconds.
struct Method {
    name: &'static str,
    called: &'static str,
    printed_ms: [f64; 2],
}

/// What is compared with the papers' methods.
const OURS: Method = Method { name: "fourier", called: "Fourier (ours)", printed_ms: [f64::NAN; 2] };

/// Fritsch's presets; milliseconds on a notebook (RTX 2050) and a desktop computer (RTX 4090).
const PRESETS: [Method; 9] = [
    Method { name: "preset-None", called: "None", printed_ms: [1.21, 0.107] },
    Method { name: "preset-Low", called: "Low", printed_ms: [2.45, 0.204] },
    Method { name: "preset-Medium", called: "Medium", printed_ms: [4.07, 0.297] },
    Method { name: "preset-MediumFrag", called: "MediumFrag", printed_ms: [5.48, 0.363] },
    Method { name: "preset-High", called: "High", printed_ms: [9.98, 0.659] },
    Method { name: "preset-VeryHighX3", called: "VeryHighX3", printed_ms: [14.7, 0.535] },
    Method { name: "preset-VeryHighX5", called: "VeryHighX5", printed_ms: [18.6, 0.684] },
    Method { name: "preset-VeryHighX7", called: "VeryHighX7", printed_ms: [21.2, 0.823] },
    OURS,
];

/// Uniform stepping first, which the others are compared with; milliseconds on a GTX 970M, then none.
const SEARCHES: [Method; 4] = [
    Method { name: "uniform-100", called: "100 uniform steps", printed_ms: [18.2, f64::NAN] },
    Method { name: "mipmaps-5-5-5", called: "{5, 5, 5}", printed_ms: [5.4, f64::NAN] },
    Method { name: "mipmaps-5-5-5-3", called: "{5, 5, 5, 3}", printed_ms: [6.2, f64::NAN] },
    OURS,
];

/// Fritsch's table 3, Jung's figure 13 and table 2.
pub fn tables(options: &Options, gpu: Option<&Gpu>, progress: &dyn Progress) -> Result<Vec<Table>, Error> {
    let set = Set::new(options)?;
    let mut fritsch = Table::new(
        "fritsch_3",
        "Fritsch 2025, table 3: frames by preset (paper: RTX 2050, RTX 4090; 1920×1080)",
        &[
            ("preset", ""),
            ("frame", "ms"),
            ("device", "ms"),
            ("paper's notebook", "ms"),
            ("paper's desktop", "ms"),
            ("ratio to None", ""),
            ("notebook's", ""),
            ("desktop's", ""),
            ("RMS", ""),
            ("hard shadows wrong", "%"),
        ],
    );
    let sizes = if options.quick { [[640, 360], [512, 512]] } else { [[1920, 1080], [512, 512]] };
    fritsch.rows = set.rows(&PRESETS, sizes[0], options, gpu, progress)?;
    let columns = [
        ("search", ""),
        ("frame", "ms"),
        ("device", "ms"),
        ("paper (GTX 970M)", "ms"),
        ("-", ""),
        ("ratio to 100 steps", ""),
        ("paper's ratio", ""),
        ("- ", ""),
        ("RMS", ""),
        ("hard shadows wrong", "%"),
    ];
    let mut all = vec![fritsch];
    for (name, title, size) in [
        ("jung_13", "Jung 2020, figure 13: frames by runs; 1920×1080", sizes[0]),
        ("jung_2", "Jung 2020, table 2: 512×512 (paper, {5, 5, 5}: 185 Hz at 1920×1080, 402 Hz at 512²)", sizes[1]),
    ] {
        let mut table = Table::new(name, title, &columns);
        table.rows = set.rows(&SEARCHES, size, options, gpu, progress)?;
        // One machine only, and one size.
        for row in &mut table.rows {
            if name == "jung_2" {
                row[3] = Value::Missing;
                row[6] = Value::Missing;
            }
            row.remove(7);
            row.remove(4);
        }
        table.columns = columns.into_iter().filter(|(name, _)| !name.starts_with('-')).collect();
        all.push(table);
    }
    Ok(all)
}

/// The ground, its horizon maps, and the truth.
struct Set {
    terrain: Terrain,
    maps: Vec<Vec<HorizonMap>>,
    truth: Vec<Radiometry>,
    on_ground: Vec<bool>,
}

impl Set {
    fn new(options: &Options) -> Result<Self, Error> {
        let ground = Ground::synthetic(if options.quick { 256 } else { 512 }, 1)?;
        let terrain = Terrain { body: ground.body.clone(), faces: vec![ground.face.clone()] };
        let folder = Scratch::new()?;
        let settings = Settings { azimuths: if options.quick { 120 } else { 360 }, ..Settings::default() };
        let request = Request { body: &ground.body, face: &ground.face, level: 0, settings, encoding: Encoding::Fm16 };
        let maps = vec![vec![horizon::build(&request, &folder.path, &|_, _| ())?]];
        let mut set = Self { terrain, maps, truth: Vec::new(), on_ground: Vec::new() };
        let scene = set.scene(registry::reference(Settings::default()));
        let view = set.view(SMALL, 0.0).with_quantities([Quantity::DemGap]);
        let samples = Renderer::Reference.samples(&scene, &view)?;
        let is_ground = |hit: &Option<perilune_engine::terrain::Hit>| {
            hit.as_ref().is_some_and(|hit| matches!(hit.ground, Kind::Dem { .. }))
        };
        set.on_ground = samples.centres.iter().map(is_ground).collect();
        set.truth = samples.pixels;
        Ok(set)
    }

    fn scene(&self, shadows: Arc<dyn ShadowMethod>) -> Scene {
        scene(self.terrain.clone()).with_shadows(shadows)
    }

    /// A method of the registry.
    fn method(&self, name: &str) -> Result<Arc<dyn ShadowMethod>, Error> {
        let unknown = || Error::Method { got: name.into(), allowed: "names of the registry".into() };
        let options = registry::named(name).ok_or_else(unknown)?;
        let folder = Scratch::new()?;
        let prepared = options.prepare(Ingredients {
            surface: &Surface::new(self.terrain.clone()),
            settings: Settings::default(),
            lights: &[self.view(SMALL, 0.0).quantized_lights()],
            maps: self.maps.clone(),
            folder: &folder.path,
            progress: &|_, _, _| (),
        });
        prepared.map_err(|error| perilune_engine::pipeline::Error::from(error).into())
    }

    /// Obliquely towards map +Y, the Sun turned a little about the pole.
    fn view(&self, [columns, rows]: [u32; 2], turned_rad: f64) -> View {
        let map = &self.terrain.faces[0].map;
        let (low, high) = self.terrain.faces[0].levels[0].seen_m();
        let (sin, cos) = LOOK_DOWN_DEG.to_radians().sin_cos();
        // The middle of the image meets the ground half way to the northern edge.
        let at_m = DVec2::new((low.x + high.x) / 2.0, (low.y + high.y) / 2.0 - HEIGHT_M);
        let (right, forward) = (DVec3::X, DVec3::new(0.0, cos, -sin));
        let [right, down, forward] =
            [right, forward.cross(right), forward].map(|axis| map.map_from_body.inverse().turn(axis));
        let lifted = at_m.extend(map.lifted_height_m(at_m, map.radius_m + HEIGHT_M));
        let mut light = sun(map, AZIMUTH_RAD, SUN_DEG.to_radians());
        light.position = Position::from_m(DQuat::from_rotation_z(turned_rad) * light.position.vector_m());
        let camera_from_body = Rotation::from_axes(right, down, forward);
        view(Pose { position: map.body_from_lifted(lifted), camera_from_body }, vec![light])
            .with_optics(pinhole(columns, rows, f64::from(columns) * 0.5 / HALF_WIDTH))
            .with_quantities([Quantity::Radiance])
    }

    /// A row a method; ratios are to the first.
    fn rows(
        &self,
        methods: &[Method],
        size: [u32; 2],
        options: &Options,
        gpu: Option<&Gpu>,
        progress: &dyn Progress,
    ) -> Result<Vec<Vec<Value>>, Error> {
        progress.begin(&format!("frames of {}×{}", size[0], size[1]), methods.len(), "methods");
        let (mut rows, mut first) = (Vec::new(), None);
        for (done, method) in methods.iter().enumerate() {
            let scene = self.scene(self.method(method.name)?);
            let tried = Renderer::on_any(gpu).samples(&scene, &self.view(SMALL, 0.0))?;
            let found = compare(&self.truth, &tried.pixels, &self.on_ground, SOLAR_IRRADIANCE_W_M2);
            let [frame_ms, device_ms] = self.timed(gpu, &scene, size, options)?;
            let (base_ms, printed) = *first.get_or_insert((frame_ms, method.printed_ms));
            let mut row = vec![method.called.into(), frame_ms.into(), device_ms.into()];
            row.extend(method.printed_ms.map(Value::from));
            row.push((frame_ms / base_ms).into());
            row.extend([0, 1].map(|machine| Value::from(method.printed_ms[machine] / printed[machine])));
            row.extend([found.irradiance.rms, 100.0 * (1.0 - found.agreement)].map(Value::from));
            rows.push(row);
            progress.at(done + 1, methods.len());
        }
        Ok(rows)
    }

    /// Least milliseconds of a frame, and what of it the device took: others' work only adds.
    fn timed(&self, gpu: Option<&Gpu>, scene: &Scene, size: [u32; 2], options: &Options) -> Result<[f64; 2], Error> {
        let mut session = Renderer::on_any(gpu).session(scene)?;
        // The first frame compiles the program.
        session.samples(&self.view(size, 0.0))?;
        let (mut frames, mut device) = (Vec::new(), Vec::new());
        for frame in 1..=options.repeat {
            // More than the raster on which lights are held still.
            let view = self.view(size, 5e-5 * frame as f64);
            let start = Instant::now();
            session.samples(&view)?;
            frames.push(1e3 * start.elapsed().as_secs_f64());
            device.extend(session.device_time().map(|time| 1e3 * time.as_secs_f64()));
        }
        Ok([frames, device].map(|times| times.into_iter().fold(f64::NAN, f64::min)))
    }
}
