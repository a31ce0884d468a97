//! From a scenario to images on disk: the stories of the crate's document, in order.
//!
//! ```text
//! kernels -> Sun and frames      DEMs -> levels -> horizon tiles      trajectory, pointing -> views
//!                        all of them -> scene -> renderer -> planes -> dataset
//! ```
//!
//! Whatever can fail for the user's sake fails before the first exposure: kernels, epochs, poses and terrain are
//! ready when the horizons begin.

mod albedo_map;
mod applicability;
pub mod auto;
mod camera_record;
pub mod capture;
mod check;
mod craters;
pub mod device;
pub(crate) mod error;
pub mod facts;
mod frames;
pub mod globe;
pub mod ground;
mod images;
pub mod lights;
pub mod models;
pub mod motion;
mod names;
mod ortho;
mod output;
mod progress;
mod record;
mod run;
pub mod scene;
mod sequence;
mod split;
mod stand_in;
mod terrain_key;
mod tiles;
pub mod warnings;
mod watch;

use std::path::Path;
use std::sync::Arc;

pub use check::{Checked, check};
pub use device::AdapterChoice;
pub use error::Error;
pub use frames::{Frames, Stride};
pub use motion::Exposure;
pub use progress::{Progress, Silent};
pub use run::{Options, Report, Seconds, Stages, run};

use hifitime::Unit;

use crate::dataset;
use crate::ephemeris::{Almanac, BodyFrame, KernelSource, default_kernels};
use crate::horizon;
use crate::labels::{Crater, Rim};
use crate::raster;
use crate::render::{Bounce, Scene};
use crate::scenario::{self, Albedo, Ambient, Scenario, Sky};
use crate::shadow::Ingredients;

/// All that is settled before the first exposure.
#[derive(Debug)]
pub struct Prepared {
    pub almanac: Almanac,
    pub frame: BodyFrame,
    pub ground: ground::Ground,
    /// The scenario at each point of its sweep; one without a sweep.
    pub points: Vec<Scenario>,
    pub sweep: Option<scenario::Sweep>,
    pub exposures: Vec<Exposure>,
    /// Of each point of the sweep.
    pub motions: Vec<motion::Motion>,
    pub shadows: auto::Choice,
    /// With their rims; empty where the scenario asks for no landmarks.
    pub craters: Vec<(Crater, Rim)>,
}

/// Kernels, terrain and poses of a scenario.
pub fn prepare(scenario: &Scenario, cache: &Path, progress: &dyn Progress) -> Result<Prepared, Error> {
    let almanac = Almanac::load_sources(&kernels(scenario))?;
    let (frame, note) = body_frame(scenario, &almanac)?;
    let mut ground = ground::surface(scenario.terrain.as_ref(), &frame.body, cache, progress)?;
    for (role, path) in scenario.other_files() {
        let sha256 = raster::digest(path)?;
        ground.inputs.push(dataset::Input { role: role.into(), name: names::file_name(path), sha256 });
    }
    let points = points(scenario);
    for point in &points {
        scene::reflectance(point)?;
        scene::detector(point)?;
    }
    let (exposures, motions) = globe::exposures::exposures(&points, &almanac, &frame, &mut ground, progress)?;
    let craters = craters::of_lists(scenario, &mut ground, cache)?;
    sequence::check(scenario, &exposures)?;
    motion::band(scenario, &exposures)?;
    let shadows = auto::choose(scenario, &ground.surface, &exposures);
    if let Some(why) = &shadows.why {
        progress.say(why);
    }
    note.iter().chain(&scenario.notes).chain(&ground.findings).for_each(|note| progress.say(note));
    applicability::warnings(scenario, Some(&ground.surface)).iter().for_each(|warning| progress.say(warning));
    Ok(Prepared { almanac, frame, ground, points, sweep: scenario.sweep.clone(), exposures, motions, shadows, craters })
}

/// The scenario at each point of its sweep.
fn points(scenario: &Scenario) -> Vec<Scenario> {
    (0..scenario.points()).map(|point| scenario.at_point(point)).collect()
}

/// The scenario's kernels, or the shipped ones, and the trajectory's.
fn kernels(scenario: &Scenario) -> Vec<KernelSource> {
    let mut kernels = scenario.kernels.clone().unwrap_or_else(default_kernels);
    if let scenario::Trajectory::Spk { path: Some(path), .. } = &scenario.trajectory {
        kernels.push(path.clone());
    }
    kernels
}

/// The scenario's frame with the figure that its heights refer to, and what there is to say of it.
fn body_frame(scenario: &Scenario, almanac: &Almanac) -> Result<(BodyFrame, Option<String>), Error> {
    // By its id: a body of one's own has any name.
    let id = scenario.body.naif_id.to_string();
    let reach = scene::timing(scenario).reach_s(scenario.camera.longest_exposure_s()) * Unit::Second;
    let ends = [scenario.exposures.iter().min(), scenario.exposures.iter().max()];
    let epochs: Vec<_> = ends.into_iter().flatten().flat_map(|epoch| [*epoch - reach, *epoch + reach]).collect();
    let (named, note) = almanac.body_frame_at(&id, scenario.frame.as_deref(), &epochs)?;
    Ok((BodyFrame { body: scenario.body.clone(), ..named }, note))
}

/// The scene that a renderer reads, with its shadows.
pub fn build_scene(
    scenario: &Scenario,
    prepared: &mut Prepared,
    cache: &Path,
    progress: &dyn Progress,
) -> Result<Scene, Error> {
    let Prepared { ground, exposures, shadows: choice, .. } = prepared;
    let albedo = match &scenario.albedo {
        Albedo::Constant(_) => None,
        Albedo::Map(path, reading) | Albedo::SingleScattering(path, reading) => {
            let map = ground::albedo(&ground.surface, path, reading, scene::albedo_scale(scenario))?;
            map.findings.iter().for_each(|finding| progress.say(finding));
            Some(map.values)
        }
    };
    if let Some(albedo) = &albedo {
        ground::open_gaps(&mut ground.surface, albedo);
    }
    let settings = scene::horizon_settings(scenario);
    let mut tiles = Vec::new();
    let mut maps = |settings: horizon::Settings| {
        let (folder, encoding) = (cache.join("horizon"), scenario.horizon.encoding);
        let settings = horizon::Settings { band: motion::band(scenario, exposures)?, ..settings };
        let listed = |tile: &ground::Tile| {
            tiles.push(tile.input());
            Ok::<_, Error>(())
        };
        if let Some(globe) = &ground.globe {
            return globe.horizons(settings, encoding, cache, progress, listed);
        }
        ground::horizons(&ground.surface, &settings, encoding, &folder, horizon::Memory::default(), progress, listed)
    };
    let method = &choice.method;
    let given = if method.needs_maps() { maps(settings)? } else { Vec::new() };
    let shadows = method.prepare(Ingredients {
        surface: &ground.surface,
        settings,
        lights: &auto::lights(exposures),
        maps: given,
        folder: &cache.join("horizon"),
        progress: &|what, done, all| match done {
            0 => progress.begin(what, all, "azimuths"),
            _ => progress.at(done, all),
        },
    })?;
    let from_maps = matches!(scenario.ambient, Some(Ambient { sky: Sky::Horizons, .. })) || scenario.bounce.is_some();
    let made = if from_maps && shadows.maps().is_none() { maps(settings)? } else { Vec::new() };
    let horizons = shadows.maps().unwrap_or(&made[..]);
    let ambient = scene::ambient(scenario, &ground.surface, horizons);
    let bounce = scenario.bounce.map(|bounce| {
        Bounce::new(&ground.surface, horizons, bounce.azimuths as usize, bounce.elevations as usize)
            .with_orders(bounce.orders as usize)
    });
    ground.inputs.extend(tiles);
    Ok(Scene {
        refine: scenario.refine.then_some(settings),
        albedo: albedo.map(Arc::new),
        albedo_role: scene::albedo_role(scenario),
        ambient: ambient.map(Arc::new),
        bounce: bounce.map(Arc::new),
        ..Scene::new(ground.surface.clone())
            .with_view_rays(scenario.view_rays)
            .with_shadows(shadows)
            .with_disk(scene::disk(scenario)?)
    })
}
