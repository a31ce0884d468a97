//! From the scenario's crater lists to rims on the surface.

use std::path::Path;

use super::names::file_name;
use super::{Error, ground};
use crate::dataset::Input;
use crate::labels::{Crater, Origin, Rim, catalogue, without_repeats};
use crate::raster;
use crate::scenario::{CraterList, Dem, Scenario};

/// The craters of all lists with their rims. Catalogues join the ground's inputs.
pub fn of_lists(scenario: &Scenario, ground: &mut ground::Ground, cache: &Path) -> Result<Vec<(Crater, Rim)>, Error> {
    use rayon::prelude::*;
    let (body, lists) = (&scenario.body, scenario.landmarks.as_ref().map_or(&[][..], |landmarks| &landmarks.lists));
    let mut read = Vec::new();
    for (index, list) in lists.iter().enumerate() {
        match list {
            CraterList::Terrain => read.extend(of_terrain(scenario, cache)?),
            CraterList::File(path) => {
                // Ids of two catalogues may be the same.
                let prefix = if lists.len() > 1 { format!("{index}/") } else { String::new() };
                read.push(catalogue::read(path, &prefix, Origin::Catalogue)?);
                let sha256 = raster::digest(path)?;
                ground.inputs.push(Input { role: "craters".into(), name: file_name(path), sha256 });
            }
        }
    }
    let rim = |crater: Crater| {
        let rim = Rim::of(&crater, &ground.surface);
        (crater, rim)
    };
    Ok(without_repeats(read, body).into_par_iter().map(rim).collect())
}

/// The lists of the made models, the finest first: it repeats what it holds of the coarser ones'.
fn of_terrain(scenario: &Scenario, cache: &Path) -> Result<Vec<Vec<Crater>>, Error> {
    let dems = scenario.terrain.as_ref().map_or(&[][..], |terrain| &terrain.dems);
    let mut lists = Vec::new();
    for (index, (dem, path)) in dems.iter().zip(ground::paths(&scenario.body, dems, cache)).enumerate() {
        let origin = match dem {
            Dem::Synthetic { .. } => Origin::Synthetic,
            Dem::Detail { .. } => Origin::SyntheticDetail,
            Dem::File { .. } | Dem::Cube { .. } | Dem::Globe(_) => continue,
        };
        lists.push(catalogue::read(&path.with_extension("craters.csv"), &format!("terrain{index}/"), origin)?);
    }
    Ok(lists)
}
