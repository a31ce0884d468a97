//! Every shadow method on a case.

use std::path::Path;
use std::sync::Arc;

use super::{Case, Outcome};
use crate::Error;
use perilune_engine::gpu::Gpu;
use perilune_engine::horizon::{self, Encoding, HorizonMap, Memory, Request, Settings};
use perilune_engine::pipeline;
use perilune_engine::render::{Renderer, View};
use perilune_engine::shadow::{Ingredients, MethodOptions, ShadowMethod, registry};
use perilune_engine::terrain::{Face, Surface};

/// Azimuths of the horizon maps.
const AZIMUTHS: usize = 120;
/// Of maps whose method asks for no encoding of its own.
const ENCODING: Encoding = Encoding::Fm16;

/// Horizon maps by face and level.
type Maps = Vec<Vec<HorizonMap>>;

/// Makes a terrain's methods by name, from its horizon maps.
#[derive(Debug)]
pub struct MethodFactory<'a> {
    maps: Vec<(Encoding, Maps)>,
    cache: &'a Path,
}

impl<'a> MethodFactory<'a> {
    pub fn new(surface: &Surface, cache: &'a Path) -> Result<Self, Error> {
        let terrain = &surface.terrain;
        let settings = Settings { azimuths: AZIMUTHS, ..Settings::default() };
        let maps = |encoding| -> Result<Maps, Error> {
            let map = |face: &Face, level: usize| {
                let request = Request { body: &terrain.body, face, level, settings, encoding };
                horizon::open_or_build(&request, &cache.join("horizon"), Memory::default(), &|_, _| ())
            };
            let of_face = |face: &Face| (0..face.levels.len()).map(|level| map(face, level)).collect();
            Ok(terrain.faces.iter().map(of_face).collect::<Result<_, _>>()?)
        };
        let mut made: Vec<(Encoding, Maps)> = Vec::new();
        let options = registry::hard_case_names().filter_map(registry::named);
        for encoding in options.filter(|options| options.needs_maps()).map(|options| options.encoding(ENCODING)) {
            if made.iter().all(|(known, _)| *known != encoding) {
                made.push((encoding, maps(encoding)?));
            }
        }
        Ok(Self { maps: made, cache })
    }

    /// A method for a view's lights; `None` outside its domain.
    fn method(
        &self,
        options: &dyn MethodOptions,
        surface: &Surface,
        view: &View,
    ) -> Result<Option<Arc<dyn ShadowMethod>>, Error> {
        let encoding = options.encoding(ENCODING);
        let maps = self.maps.iter().find(|(known, _)| options.needs_maps() && *known == encoding);
        let prepared = options.prepare(Ingredients {
            surface,
            settings: Settings::default(),
            lights: &[view.quantized_lights()],
            maps: maps.map(|(_, maps)| maps.clone()).unwrap_or_default(),
            folder: &self.cache.join("horizon"),
            progress: &|_, _, _| (),
        });
        match prepared {
            Ok(method) => Ok(Some(method)),
            Err(why) if why.is_outside_domain() => Ok(None),
            Err(error) => Err(pipeline::Error::from(error).into()),
        }
    }
}

fn within_domain(case: &Case, options: &dyn MethodOptions) -> bool {
    let posting_m = case.scene.surface.terrain.faces[0].levels[0].posting_m;
    let domain = options.domain();
    case.reach_m <= domain.reach_postings * posting_m && (domain.penumbrae || !case.soft)
}

/// The case by a method, in the reference renderer or on a device.
pub fn outcome(case: &mut Case, name: &str, gpu: Option<&Gpu>, factory: &MethodFactory) -> Result<Outcome, Error> {
    let unknown =
        || Error::Method { got: name.into(), allowed: registry::hard_case_names().collect::<Vec<_>>().join(", ") };
    let options = registry::named(name).ok_or_else(unknown)?;
    if !within_domain(case, options.as_ref()) {
        return Ok(Outcome::Outside);
    }
    let mut images = Vec::new();
    let mut held = None;
    for view in &case.views {
        // A device keeps what others than those for given lights have uploaded.
        if held.is_none() || options.is_for_given_lights() {
            let Some(method) = factory.method(options.as_ref(), &case.scene.surface, view)? else {
                return Ok(Outcome::Outside);
            };
            case.scene.shadows = method;
            held = Some(Renderer::on_any(gpu).session(&case.scene)?);
        }
        if let Some(session) = &mut held {
            images.push(session.samples(view)?);
        }
    }
    Ok(case.outcome(&images))
}
