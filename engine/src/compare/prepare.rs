//! Camera and ground of a comparison, from files to a scene.

use std::path::{Path, PathBuf};

use super::render::{Trial, footprint_terrain, horizons};
use super::request::{GeometrySource, NORMAL_ALBEDO, Request};
use super::{Error, Geometry};
use crate::camera::PosedCamera;
use crate::dataset;
use crate::photometry::Reflectance;
use crate::pipeline::{self, Progress, ground};
use crate::raster::{self, Picture};
use crate::render::{AlbedoRole, Scene};
use crate::scenario;

/// Camera and ground, before anything is rendered.
pub struct Prepared {
    pub geometry: Geometry,
    pub scene: Scene,
    pub inputs: Vec<dataset::Input>,
}

pub fn prepared(
    request: &Request,
    main: &Trial,
    picture: &Picture,
    progress: &dyn Progress,
) -> Result<Prepared, Error> {
    match &request.geometry {
        GeometrySource::File(path) => of_file(request, path, main, picture, progress),
        GeometrySource::Scenario { scenario, exposure } => {
            of_exposure(request, scenario.as_ref().clone(), *exposure, picture, progress)
        }
    }
}

fn of_file(
    request: &Request,
    path: &Path,
    main: &Trial,
    picture: &Picture,
    progress: &dyn Progress,
) -> Result<Prepared, Error> {
    if request.dems.is_empty() {
        return Err(Error::NoDem { path: path.into() });
    }
    let geometry = Geometry::read(path, &request.photo, [picture.columns, picture.rows])?;
    let terrain = footprint_terrain(&geometry, &request.dems).ok_or_else(|| no_ground(request, &geometry))?;
    let mut ground = ground::surface(Some(&terrain), &geometry.body, &request.cache, progress)?;
    // A map holds normal albedos; it multiplies Hapke's law as it is.
    let scale = if matches!(main.reflectance, Reflectance::Hapke(_)) { 1.0 } else { 1.0 / NORMAL_ALBEDO };
    let map = |path| Ok::<_, Error>(ground::albedo(&ground.surface, path, &raster::Reading::default(), scale)?.values);
    let albedo = request.albedo.as_deref().map(map).transpose()?;
    if let Some(albedo) = &albedo {
        ground::open_gaps(&mut ground.surface, albedo);
    }
    let shadows = horizons(&ground.surface, &request.cache, progress)?;
    let scene = Scene::new(ground.surface).with_shadows(shadows).with_disk(main.disk.clone());
    let scene = match albedo {
        Some(albedo) => scene.with_albedo(albedo, AlbedoRole::Factor),
        None => scene,
    };
    Ok(Prepared { geometry, scene, inputs: ground.inputs })
}

/// An exposure of a scenario, over its own elevation models or those given.
fn of_exposure(
    request: &Request,
    mut scenario: scenario::Scenario,
    exposure: usize,
    picture: &Picture,
    progress: &dyn Progress,
) -> Result<Prepared, Error> {
    let path = scenario.path.clone();
    let size = [scenario.camera.columns as usize, scenario.camera.rows as usize];
    if [picture.columns, picture.rows] != size {
        let (photo, allowed) = (picture.path.clone(), vec![format!("{} x {}", size[0], size[1])]);
        return Err(Error::Size { photo, columns: picture.columns, rows: picture.rows, allowed });
    }
    if exposure >= scenario.exposures.len() {
        return Err(Error::NoSuchImage { image: exposure, path, count: scenario.exposures.len() });
    }
    if !request.dems.is_empty() {
        let file = |path: &PathBuf| scenario::Dem::File {
            path: path.clone(),
            reading: raster::Reading::default(),
            values: scenario::Values::Auto,
            posting_m: None,
            extent_m: None,
        };
        let centre = scenario.terrain.as_ref().and_then(|terrain| terrain.centre);
        scenario.terrain = Some(scenario::Terrain { centre, dems: request.dems.iter().map(file).collect() });
    }
    if scenario.terrain.is_none() {
        return Err(Error::NoDem { path });
    }
    if let Some(map) = &request.albedo {
        scenario.albedo = scenario::Albedo::Map(map.clone(), raster::Reading::default());
    }
    let mut prepared = pipeline::prepare(&scenario, &request.cache, progress)?;
    let scene = pipeline::build_scene(&scenario, &mut prepared, &request.cache, progress)?;
    let view = &prepared.exposures[exposure].view;
    let pose = view.pose();
    let geometry = Geometry {
        body: prepared.frame.body.clone(),
        camera: PosedCamera { optics: view.optics.clone(), poses: vec![pose] },
        lights: view.lights.clone(),
        source: format!("scenario {}, exposure {exposure}", scenario.name),
    };
    Ok(Prepared { geometry, scene, inputs: prepared.ground.inputs })
}

pub fn no_ground(request: &Request, geometry: &Geometry) -> Error {
    let path = match &request.geometry {
        GeometrySource::File(path) => path.clone(),
        GeometrySource::Scenario { scenario, .. } => scenario.path.clone(),
    };
    Error::NoGround { path, body: geometry.body.name.clone() }
}
