//! What a person wants to know of a scenario before it runs: where the models lie, what the camera sees, how high the Sun
//! stands, how bright it gets, who casts shadows, what it takes.
//!
//! A few rays of a few exposures are followed in f64 over the terrain, without cast shadows: no image is rendered.

mod cost;
pub mod look;
pub mod signal;
pub mod text;

use std::sync::Arc;

use serde::Serialize;

pub use cost::{CostFacts, Renders, check_memory};
pub use signal::SignalFacts;

use super::device;
use super::models::{Extent, ModelFacts};
use super::warnings::{self, Places, Warning};
use super::{Error, Exposure, albedo_map, auto, scene};
use crate::gpu::{Adapter, Gpu};
use crate::raster;
use crate::render::Scene;
use crate::scenario::{Albedo, Scenario};
use crate::terrain::Surface;
use look::{AlbedoMap, Look, azimuths, least_and_greatest};
use signal::Expected;

/// Exposures that are looked at, evenly chosen.
const EXPOSURES: usize = 64;

/// All that is told of a scenario.
#[derive(Debug, Clone, Serialize)]
pub struct Facts {
    /// Finest first; without those that are not made yet.
    pub models: Vec<ModelFacts>,
    pub view: ViewFacts,
    pub sun: SunFacts,
    pub signal: SignalFacts,
    pub shadows: ShadowFacts,
    pub cost: CostFacts,
}

/// What the camera sees.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ViewFacts {
    pub exposures_looked_at: usize,
    pub rays_each: usize,
    /// Above the ground below the camera; least and greatest, as all pairs here.
    pub height_above_ground_m: [f64; 2],
    /// `None`: no ray meets the body.
    pub pixel_m: Option<[f64; 2]>,
    /// Rays through each pixel.
    pub rays_a_pixel: u32,
    /// Of the terrain's nodes where they are finest; `None`: there is no terrain.
    pub finest_posting_m: Option<f64>,
    /// Of the rays on ground, those on elevation models; of the worst exposure and of the best.
    pub share_on_models: Option<[f64; 2]>,
    /// Of all rays, those that meet the body.
    pub share_on_body: [f64; 2],
    /// Where the images' middles look.
    pub target: Option<Extent>,
}

impl ViewFacts {
    /// Rays that leave little aliasing: a quarter of the nodes in the largest pixel. Under a Sun at 2° four rays leave 1.5 % RMS of the
    /// light over pixels of 3.2 postings and 6.3 % over 12; sixteen leave 0.4 and 1.5 %.
    pub fn rays_advised(&self) -> Option<u32> {
        let postings = self.pixel_m?[1] / self.finest_posting_m?;
        Some((0.25 * postings * postings).ceil().min(f64::from(u32::MAX)) as u32)
    }
}

/// Where the Sun stands over the ground that the images' middles show.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SunFacts {
    /// From where to where, the short way round.
    pub azimuth_deg: [f64; 2],
    pub elevation_deg: [f64; 2],
}

/// How shadows are cast, and by whom.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShadowFacts {
    pub method: String,
    /// `None`: the scenario names the method.
    pub why: Option<String>,
    /// Who renders.
    pub renderer: String,
    /// Why the adapter does not.
    pub adapter_cannot: Option<String>,
}

/// A scenario with its poses and its ground.
#[derive(Debug)]
pub struct Known<'a> {
    pub points: &'a [Scenario],
    pub exposures: &'a [Exposure],
    pub surface: &'a Arc<Surface>,
    pub models: &'a [ModelFacts],
}

/// What looks find over some ground: it serves check and run alike.
#[derive(Debug)]
pub struct Looker {
    scene: Scene,
    albedo: Option<AlbedoMap>,
    places: Places,
}

impl Looker {
    pub fn new(scenario: &Scenario, surface: &Arc<Surface>, models: &[ModelFacts]) -> Result<Self, Error> {
        let albedo = match &scenario.albedo {
            Albedo::Constant(_) => None,
            Albedo::Map(path, reading) => Some((path, reading, scene::albedo_scale(scenario))),
            // A map of w: the law takes its own for this.
            Albedo::SingleScattering(path, reading) => Some((path, reading, 0.0)),
        };
        let read = |(path, reading, scale): (&std::path::PathBuf, &raster::Reading, f64)| -> Result<AlbedoMap, Error> {
            let levels = surface.terrain.faces.iter().flat_map(|face| &face.levels);
            let finest_m = levels.map(|level| level.posting_m).reduce(f64::min);
            let options = raster::Options { posting_m: finest_m, ..albedo_map::options(reading) };
            Ok(AlbedoMap { dem: raster::Dem::open(path, &scenario.body, &options)?, scale })
        };
        let albedo = albedo.map(read).transpose()?;
        let of_albedo = albedo.as_ref().map(|map| {
            let size = [map.dem.columns, map.dem.rows];
            Extent::of_raster(&scenario.body, &map.dem.georeference, size)
        });
        let extents = models.iter().filter_map(|model| model.extent);
        let places = Places {
            models: extents.reduce(Extent::with).filter(|_| scenario.terrain.is_some()),
            albedo: of_albedo.transpose()?.flatten(),
        };
        let scene = Scene::new(surface.clone()).with_disk(scene::disk(scenario)?);
        Ok(Self { scene, albedo, places })
    }

    pub fn look(&self, exposure: &Exposure) -> Result<Look, Error> {
        Look::of(&self.scene, self.albedo.as_ref(), exposure)
    }

    /// What is odd about an exposure before it is rendered.
    pub fn warnings(&self, look: &Look) -> Vec<Warning> {
        warnings::of_look(look, &self.places)
    }
}

/// All facts, and a line for each kind of what is odd.
pub fn gather(scenario: &Scenario, known: &Known) -> Result<(Facts, Vec<String>), Error> {
    let Known { points, exposures, surface, models } = *known;
    let looker = Looker::new(scenario, surface, models)?;
    let (mut looks, mut expected, mut odd) = (Vec::new(), Vec::new(), Vec::new());
    for index in chosen(exposures.len()) {
        let exposure = &exposures[index];
        let look = looker.look(exposure)?;
        let mut found = looker.warnings(&look);
        let auto = points[exposure.point].camera.auto_exposure;
        if let Some(detector) = exposure.view.detector.as_ref().filter(|_| look.on_ground() > 0) {
            let signal = Expected::of(&look, detector, auto.as_ref());
            found.extend(warnings::of_expected(&signal, look.sun_up > 0));
            expected.push(signal);
        }
        if !found.is_empty() {
            odd.push((index, found));
        }
        looks.push(look);
    }
    let mut lines = warnings::summed(&odd, looks.len());
    let choice = auto::choose(scenario, surface, exposures);
    let (shadows, renders) = shadows(scenario, known, &choice);
    let effort = auto::effort(scenario, surface, exposures, choice.method.as_ref());
    let cost = cost::cost(scenario, &surface.terrain, choice.method.as_ref(), effort, renders);
    lines.extend(models.iter().flat_map(warnings::of_model));
    lines.extend(warnings::of_memory(cost.memory_bytes, cost.memory_available_bytes));
    let detector = exposures.first().and_then(|exposure| exposure.view.detector.as_ref());
    let facts = Facts {
        models: models.to_vec(),
        view: view(&looks, scenario, surface),
        sun: sun(&looks),
        signal: signal::signal(&looks, &expected, detector),
        shadows,
        cost,
    };
    Ok((facts, lines))
}

/// Evenly from the first to the last.
fn chosen(count: usize) -> Vec<usize> {
    let looked = count.min(EXPOSURES);
    (0..looked).map(|index| if looked > 1 { index * (count - 1) / (looked - 1) } else { 0 }).collect()
}

fn view(looks: &[Look], scenario: &Scenario, surface: &Surface) -> ViewFacts {
    let postings_m = surface.terrain.faces.iter().flat_map(|face| &face.levels).map(|level| level.posting_m);
    let range = |value: &dyn Fn(&Look) -> f64| least_and_greatest(looks.iter().map(value)).unwrap_or_default();
    let shares = looks.iter().filter(|look| look.on_ground() > 0);
    let targets: Vec<_> = looks.iter().filter(|look| look.on_ground() > 0).map(|look| look.target).collect();
    ViewFacts {
        exposures_looked_at: looks.len(),
        rays_each: looks.first().map_or(0, |look| look.rays),
        height_above_ground_m: range(&|look| look.height_m),
        pixel_m: least_and_greatest(looks.iter().filter_map(|look| look.pixel_m).flatten()),
        rays_a_pixel: scenario.camera.samples_per_pixel,
        finest_posting_m: postings_m.min_by(f64::total_cmp),
        share_on_models: least_and_greatest(shares.map(|look| look.on_models as f64 / look.on_ground() as f64)),
        share_on_body: range(&|look| look.on_ground() as f64 / look.rays.max(1) as f64),
        target: Extent::around(&targets, [false; 2]),
    }
}

fn sun(looks: &[Look]) -> SunFacts {
    let azimuths_rad: Vec<f64> = looks.iter().map(|look| look.sun.azimuth_rad).collect();
    let elevations = looks.iter().map(|look| look.sun.elevation_rad.to_degrees());
    SunFacts {
        azimuth_deg: azimuths(&azimuths_rad).unwrap_or_default().map(f64::to_degrees),
        elevation_deg: least_and_greatest(elevations).unwrap_or_default(),
    }
}

/// Who casts shadows and who renders, as a run with `--adapter auto` would settle it.
fn shadows(scenario: &Scenario, known: &Known, choice: &auto::Choice) -> (ShadowFacts, Renders) {
    let method = choice.method.as_ref();
    let facts = |renderer: String, adapter_cannot: Option<String>| ShadowFacts {
        method: method.spelling(),
        why: choice.why.clone(),
        renderer,
        adapter_cannot,
    };
    let reference = || crate::render::reference::NAME.to_owned();
    if !method.runs_on_device() {
        return (
            facts(reference(), Some(format!("{} has no part for devices", method.spelling()))),
            Renders::Reference,
        );
    }
    match Gpu::open(Adapter::Auto) {
        Err(error) => (facts(reference(), Some(error.to_string())), Renders::Reference),
        Ok(gpu) => match device::holds(&gpu, scenario, &known.surface.terrain, method, known.exposures) {
            Ok(()) if gpu.is_software() => (facts(gpu.describe(), None), Renders::Software),
            Ok(()) => (facts(gpu.describe(), None), Renders::Card),
            Err(error) => (facts(reference(), Some(error.to_string())), Renders::Reference),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_exposures_are_all_looked_at_and_many_evenly() {
        assert_eq!(chosen(0), Vec::<usize>::new());
        assert_eq!((chosen(1), chosen(3)), (vec![0], vec![0, 1, 2]));
        let many = chosen(1000);
        assert_eq!((many.len(), many[0], many[63]), (64, 0, 999));
        assert!(many.windows(2).all(|pair| pair[1] - pair[0] >= 15 && pair[1] - pair[0] <= 16));
    }

    #[test]
    fn azimuths_run_the_short_way_round() {
        let rad = |degrees: [f64; 3]| degrees.map(f64::to_radians);
        let [from, until] = azimuths(&rad([359.0, 1.0, 358.0])).unwrap().map(f64::to_degrees);
        assert!((from - 358.0).abs() < 1e-9 && (until - 361.0).abs() < 1e-9);
    }
}
