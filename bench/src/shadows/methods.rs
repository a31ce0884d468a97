//! The shadow methods that a comparison tries, by name.

use std::path::Path;
use std::sync::Arc;

use crate::Error;
use perilune_engine::horizon::{Encoding, HorizonMap, Memory, Settings};
use perilune_engine::pipeline::{self, Prepared, Progress, auto, ground};
use perilune_engine::shadow::method::Bench;
use perilune_engine::shadow::{Ingredients, ShadowMethod, registry};

/// What is tried where nobody asks for more.
pub fn usual() -> Vec<&'static str> {
    registry::names(Bench::Usual).collect()
}

/// Methods that take minutes a frame on large terrain.
pub fn slow() -> Vec<&'static str> {
    registry::names(Bench::Slow).collect()
}

/// All names, for people.
pub fn allowed() -> String {
    let names = usual().into_iter().chain(slow()).chain(registry::patterns());
    names.collect::<Vec<_>>().join(", ")
}

/// What stops a run, or why a method cannot do a scene.
pub fn outside_domain(method: &str, error: Error) -> Result<String, Error> {
    match error {
        Error::Pipeline(pipeline::Error::Shadows(why)) if why.is_outside_domain() => {
            Ok(format!("{method}: outside its domain: {why}."))
        }
        other => Err(other),
    }
}

/// Makes methods by name for a prepared scenario.
#[derive(Debug)]
pub struct MethodFactory<'a> {
    pub prepared: &'a Prepared,
    pub settings: Settings,
    /// Horizon maps by face and level.
    pub maps: Vec<Vec<HorizonMap>>,
    pub cache: &'a Path,
}

impl MethodFactory<'_> {
    /// The method of a name.
    pub fn method(&self, name: &str, progress: &dyn Progress) -> Result<Arc<dyn ShadowMethod>, Error> {
        let unknown = || Error::Method { got: name.into(), allowed: allowed() };
        let options = registry::named(name).ok_or_else(unknown)?;
        let maps = if options.needs_maps() {
            let given = self.maps.iter().flatten().map(|map| map.encoding).next().unwrap_or_default();
            self.encoded(options.encoding(given), progress)?
        } else {
            Vec::new()
        };
        let prepared = options.prepare(Ingredients {
            surface: &self.prepared.ground.surface,
            settings: self.settings,
            lights: &auto::lights(&self.prepared.exposures),
            maps,
            folder: &self.cache.join("horizon"),
            progress: &|what, done, all| match done {
                0 => progress.begin(what, all, "azimuths"),
                _ => progress.at(done, all),
            },
        });
        prepared.map_err(|error| pipeline::Error::from(error).into())
    }

    /// Maps in an encoding; those at hand where it is theirs.
    fn encoded(&self, encoding: Encoding, progress: &dyn Progress) -> Result<Vec<Vec<HorizonMap>>, Error> {
        if self.maps.iter().flatten().all(|map| map.encoding == encoding) {
            return Ok(self.maps.clone());
        }
        let folder = self.cache.join("horizon");
        let surface = &self.prepared.ground.surface;
        let finished = |_: &ground::Tile| Ok::<_, pipeline::Error>(());
        let maps = ground::horizons(surface, &self.settings, encoding, &folder, Memory::default(), progress, finished)?;
        Ok(maps)
    }

    /// What a device holds for a method, per node of the terrain.
    pub fn bytes_per_node(&self, method: &dyn ShadowMethod) -> f64 {
        let nodes = self.prepared.ground.surface.terrain.seen_nodes().max(1);
        method.device_bytes(nodes) / nodes as f64
    }
}
