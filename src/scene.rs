//! Scenes, and the sessions that render views of them.

use std::path::{Path, PathBuf};

use perilune_engine::geometry::{Body, BodyFixed, Geodetic, Position};
use perilune_engine::gpu::{self, Gpu};
use perilune_engine::horizon::{HorizonMap, Memory};
use perilune_engine::photometry::{LimbDarkening, SolarDisk};
use perilune_engine::pipeline::ground::{self, Ground};
use perilune_engine::pipeline::{Progress, Silent};
use perilune_engine::render::{self, Image, Renderer, View};
use perilune_engine::scenario;
use perilune_engine::shadow::registry;
use perilune_engine::terrain::{Surface, Terrain};

use crate::{Adapter, Error, HorizonSettings};

/// A body and its terrain, and what casts shadows there: immutable, cheap to clone, shared between threads.
#[derive(Debug, Clone)]
pub struct Scene(render::Scene);

/// An elevation model in any format and map projection that GDAL reads: heights above the body's spheroid, or radii, in metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Dem {
    path: PathBuf,
    posting_m: Option<f64>,
    extent_m: Option<f64>,
}

impl Dem {
    /// The whole model at its own posting.
    pub fn file(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), posting_m: None, extent_m: None }
    }

    /// With nodes that are `posting_m` metres apart.
    pub fn with_posting_m(self, posting_m: f64) -> Self {
        Self { posting_m: Some(posting_m), ..self }
    }

    /// Only a square with sides of `extent_m` metres about the terrain's centre.
    pub fn with_extent_m(self, extent_m: f64) -> Self {
        Self { extent_m: Some(extent_m), ..self }
    }
}

/// Opens elevation models and lifts them onto one map, the finest first.
pub(crate) fn ground(
    body: &Body,
    dems: &[Dem],
    centre: Option<Geodetic>,
    progress: &dyn Progress,
) -> Result<Ground, Error> {
    let file = |dem: &Dem| scenario::Dem::File {
        path: dem.path.clone(),
        reading: perilune_engine::raster::Reading::default(),
        values: scenario::Values::Auto,
        posting_m: dem.posting_m,
        extent_m: dem.extent_m,
    };
    let terrain = scenario::Terrain { centre, dems: dems.iter().map(file).collect() };
    // Only synthetic terrain is kept in a cache.
    Ok(ground::surface(Some(&terrain), body, Path::new(""), progress)?)
}

impl Scene {
    pub(crate) fn new(engine: render::Scene) -> Self {
        Self(engine)
    }

    pub(crate) fn engine(&self) -> &render::Scene {
        &self.0
    }

    /// A body without terrain: its spheroid.
    pub fn smooth(body: &Body) -> Self {
        Self(render::Scene::new(Surface::new(Terrain { body: body.clone(), faces: Vec::new() })))
    }

    /// The terrain of elevation models, the finest first, about the middle of the first. It casts no shadows until
    /// [`with_horizons`](Self::with_horizons) or [`with_traced_shadows`](Self::with_traced_shadows) is asked for.
    ///
    /// # Errors
    /// [`ErrorKind::Raster`](crate::ErrorKind::Raster) for files that cannot be read as heights, and for models that do not
    /// overlap or are too large for one level.
    pub fn from_dems(body: &Body, dems: &[Dem]) -> Result<Self, Error> {
        Ok(Self(render::Scene::new(ground(body, dems, None, &Silent)?.surface)))
    }

    /// With shadows from horizon maps of all terrain. Tiles that the folder `cache` does not hold yet are built, which takes
    /// seconds to minutes.
    ///
    /// # Errors
    /// [`ErrorKind::Horizon`](crate::ErrorKind::Horizon) for settings out of range and tiles that cannot be written.
    pub fn with_horizons(
        self,
        settings: &HorizonSettings,
        cache: impl AsRef<Path>,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let maps = self.horizon_maps(settings, cache.as_ref(), progress, |_| ())?;
        Ok(Self(self.0.with_shadows(registry::of_maps(maps))))
    }

    /// With the reference's shadows, traced at every sample: exact and slow, and on the CPU alone.
    pub fn with_traced_shadows(self) -> Self {
        Self(self.0.with_shadows(registry::reference(Default::default())))
    }

    /// With another law of the Sun's limb; without it the disc is uniform.
    ///
    /// # Errors
    /// [`ErrorKind::Photometry`](crate::ErrorKind::Photometry) for a law whose disc has no light.
    pub fn with_limb_darkening(self, law: LimbDarkening) -> Result<Self, Error> {
        Ok(Self(self.0.with_disk(SolarDisk::new(law)?)))
    }

    /// The body that the terrain lies on.
    pub fn body(&self) -> &Body {
        &self.0.surface.terrain.body
    }

    /// The point `height_m` above the ground at a latitude and longitude in degrees, longitudes east.
    pub fn above_ground(&self, latitude_deg: f64, longitude_deg: f64, height_m: f64) -> Position<BodyFixed> {
        let on_spheroid = self.body().position_from_geodetic(Geodetic::from_degrees(latitude_deg, longitude_deg, 0.0));
        let ground = self.body().geodetic_from_position(self.0.surface.below(on_spheroid));
        self.body().position_from_geodetic(Geodetic { height_m: ground.height_m + height_m, ..ground })
    }

    /// Opens a session of the scene. Any number may be open, each in a thread of its own.
    ///
    /// # Errors
    /// [`ErrorKind::Device`](crate::ErrorKind::Device) where the adapter is not there,
    /// [`ErrorKind::Render`](crate::ErrorKind::Render) where it cannot hold the scene.
    pub fn session(&self, adapter: Adapter) -> Result<Session, Error> {
        let renderer = match adapter {
            Adapter::Cpu => Renderer::Reference,
            Adapter::Gpu => Renderer::on(&Gpu::open(gpu::Adapter::Gpu)?),
            Adapter::Auto => Renderer::on_any(Gpu::open(gpu::Adapter::Auto).ok().as_ref()),
        };
        Ok(Session(renderer.session(&self.0)?))
    }

    /// Horizon maps of all levels by face; `finished` is told the path of each tile.
    pub(crate) fn horizon_maps(
        &self,
        settings: &HorizonSettings,
        folder: &Path,
        progress: &dyn Progress,
        mut finished: impl FnMut(PathBuf),
    ) -> Result<Vec<Vec<HorizonMap>>, Error> {
        let (engine, encoding) = settings.engine();
        ground::horizons(&self.0.surface, &engine, encoding, folder, Memory::default(), progress, |tile| {
            finished(tile.path.clone());
            Ok::<_, Error>(())
        })
    }
}

/// A scene on a device, or on the CPU: renders views of it, one after the other, any number.
#[derive(Debug)]
pub struct Session(render::Session);

impl Session {
    pub(crate) fn engine(&mut self) -> &mut render::Session {
        &mut self.0
    }

    /// Renders a view: the planes that it asks for, row by row from the image's top. Two views of one session may differ in
    /// all that a [`View`] says; each comes out as if it were rendered alone.
    ///
    /// # Errors
    /// [`ErrorKind::Render`](crate::ErrorKind::Render) for a view that the scene's shadows cannot serve,
    /// [`ErrorKind::Device`](crate::ErrorKind::Device) where the device fails.
    pub fn render(&mut self, view: &View) -> Result<Image, Error> {
        Ok(self.0.render(view)?)
    }

    /// Who renders, on one line.
    pub fn adapter(&self) -> &str {
        self.0.adapter()
    }
}
