//! From the scenario's elevation models to the surface and its horizons.

use std::f64::consts::SQRT_2;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::globe::DrawnTiles;
use super::models::ModelFacts;
use super::ortho::ModelMap;
use super::{Error, Progress, terrain_key as key};

pub use super::albedo_map::{albedo, look_at_albedo};
pub use super::names::file_name;
pub use super::tiles::{Tile, horizons};

use crate::dataset::Input;
use crate::files;
use crate::geometry::{Body, Geodetic};
use crate::raster::{self, Dem, Reading};
use crate::scenario;
use crate::terrain::build::MAX_NODES_PER_SIDE;
use crate::terrain::synthetic::{self, Crater, Detail, Parameters};
use crate::terrain::{Face, NestedDem, Surface, Terrain, build_cube, build_face};

/// How far beyond its edges a cube's face looks for terrain, on the map, of the distance from which the highest height is
/// seen from the lowest over a smooth sphere. A map's metre at the edge is half a metre of ground.
const CUBE_MARGIN: f64 = 1.25;

/// The surface, where it comes from, and what resampling did to it.
#[derive(Debug)]
pub struct Ground {
    pub surface: Arc<Surface>,
    /// The terrain's centre; the sub-solar geometry of records refers to it.
    pub centre: Geodetic,
    pub inputs: Vec<Input>,
    /// What a user should know of the models' files, a line each.
    pub findings: Vec<String>,
    /// What a person can check the models by, in their order.
    pub models: Vec<ModelFacts>,
    /// Of the finest measured or made model; `None`: of a whole body, or nothing.
    pub map: Option<ModelMap>,
    /// One line a level.
    pub resampling: Vec<String>,
    /// Where the terrain is a globe, of which the surface shows a part.
    pub globe: Option<Box<DrawnTiles>>,
}

/// Opens (or makes) the DEMs and lifts them onto levels.
pub fn surface(
    terrain: Option<&scenario::Terrain>,
    body: &Body,
    cache: &Path,
    progress: &dyn Progress,
) -> Result<Ground, Error> {
    let Some(terrain) = terrain else {
        let surface = Arc::new(Surface::new(Terrain { body: body.clone(), faces: Vec::new() }));
        let centre = Geodetic::from_degrees(0.0, 0.0, 0.0);
        return Ok(Ground {
            surface,
            centre,
            inputs: Vec::new(),
            findings: Vec::new(),
            models: Vec::new(),
            map: None,
            resampling: Vec::new(),
            globe: None,
        });
    };
    if let [scenario::Dem::Globe(written)] = &terrain.dems[..] {
        return globe(written, terrain.centre, body, progress);
    }
    let paths = paths(body, &terrain.dems, cache);
    make_synthetic(body, &terrain.dems, &paths, progress)?;
    let centre = centre(terrain, &paths)?;
    make_detail(body, &terrain.dems, &paths, centre, progress)?;
    let mut dems = Vec::new();
    for (written, path) in terrain.dems.iter().zip(&paths) {
        dems.push(open(written, path, body, Some(centre), progress)?);
    }
    let (mut inputs, mut findings, mut models) = (Vec::new(), Vec::new(), Vec::new());
    for dem in &dems {
        let name = file_name(&dem.path);
        findings.extend(dem.survey.findings.iter().map(|finding| format!("{name}: {finding}")));
        models.push(ModelFacts::of(body, name.clone(), dem)?);
        inputs.push(Input { role: "dem".into(), name, sha256: raster::digest(&dem.path)? });
    }
    progress.begin("putting terrain onto its map", dems.len(), "elevation models");
    let (faces, errors) = faces(body, centre, &terrain.dems, &dems)?;
    progress.at(dems.len(), dems.len());
    let resampling = errors.iter().map(ToString::to_string).collect();
    let surface = Arc::new(Surface::new(Terrain { body: body.clone(), faces }));
    let map = model_map(&terrain.dems, &paths)?;
    Ok(Ground { surface, centre, inputs, findings, models, map, resampling, globe: None })
}

/// A globe at its coarsest: what the cameras see of it is known once they have their places.
fn globe(
    written: &scenario::Globe,
    centre: Option<Geodetic>,
    body: &Body,
    progress: &dyn Progress,
) -> Result<Ground, Error> {
    progress.begin(&format!("reading {}", file_name(&written.path)), 1, "file");
    let shown = DrawnTiles::open(body, written, written.values)?;
    let name = file_name(&written.path);
    let findings = shown.dem.findings.iter().map(|finding| format!("{name}: {finding}")).collect();
    let inputs = vec![Input { role: "dem".into(), name: name.clone(), sha256: shown.dem_sha256.clone() }];
    let (georeference, size) = Dem::lies(&written.path, &written.reading)?;
    let heights_m = Some([shown.dem.lowest_m, shown.dem.highest_m]);
    let models = vec![ModelFacts { heights_m, ..ModelFacts::unread(body, name, &georeference, size)? }];
    let centre = centre.map_or_else(|| Dem::middle(&written.path, &written.reading), Ok)?;
    Ok(Ground {
        surface: Arc::new(shown.surface()?),
        centre,
        inputs,
        findings,
        models,
        map: None,
        resampling: Vec::new(),
        globe: Some(Box::new(shown)),
    })
}

/// The map of the finest model that is no mere detail of another.
fn model_map(dems: &[scenario::Dem], paths: &[PathBuf]) -> Result<Option<ModelMap>, Error> {
    let on_map = |dem: &scenario::Dem| matches!(dem, scenario::Dem::File { .. } | scenario::Dem::Synthetic { .. });
    let finest = dems
        .iter()
        .position(on_map)
        .map(|index| Dem::lies(&paths[index], &reading_of(&dems[index]).cloned().unwrap_or_default()))
        .transpose()?;
    Ok(finest.map(|(georeference, [columns, _])| ModelMap { georeference, columns }))
}

fn faces(
    body: &Body,
    centre: Geodetic,
    written: &[scenario::Dem],
    dems: &[Dem],
) -> Result<(Vec<Face>, Vec<crate::terrain::ResamplingError>), Error> {
    if let [scenario::Dem::Cube { posting_m, .. }] = written {
        let posting_m = posting_m.unwrap_or_else(|| dems[0].georeference.posting_m());
        let margin_m = cube_margin_m(body, &dems[0]);
        let (faces, error) = build_cube(body, centre, &dems[0], posting_m, margin_m, MAX_NODES_PER_SIDE)?;
        return Ok((faces, vec![error]));
    }
    let nested: Vec<NestedDem> = written
        .iter()
        .zip(dems)
        .map(|(written, dem)| match *written {
            scenario::Dem::File { posting_m, extent_m, .. } => NestedDem { dem, posting_m, extent_m },
            _ => NestedDem::whole(dem),
        })
        .collect();
    let (face, errors) = build_face(body, centre, &nested, MAX_NODES_PER_SIDE)?;
    Ok((vec![face], errors))
}

/// From the relief, and at most a radius.
fn cube_margin_m(body: &Body, dem: &Dem) -> f64 {
    let known = dem.heights_m.iter().map(|height_m| f64::from(*height_m)).filter(|height_m| height_m.is_finite());
    let [low, high] = known.fold([0.0f64; 2], |[low, high], height_m| [low.min(height_m), high.max(height_m)]);
    let radius_m = body.equatorial_radius_m;
    (CUBE_MARGIN * (2.0 * radius_m * (high - low)).sqrt()).min(radius_m)
}

/// The models' files, whether they are there or not. The name of a synthetic one holds all that shapes it: its
/// model's parameters and those of all coarser ones, which it continues.
pub fn paths(body: &Body, dems: &[scenario::Dem], cache: &Path) -> Vec<PathBuf> {
    let mut shape = format!("{} {}", env!("CARGO_PKG_VERSION"), key::of_body(body));
    let mut path = |dem: &scenario::Dem| match dem {
        scenario::Dem::File { path, .. } | scenario::Dem::Cube { path, .. } => path.clone(),
        scenario::Dem::Globe(globe) => globe.path.clone(),
        // What it continues is a file that may change.
        scenario::Dem::Detail { .. } => {
            let measured = dems.get(1).and_then(|dem| match dem {
                scenario::Dem::File { path, .. } => raster::digest(path).ok(),
                _ => None,
            });
            let key = key::of_detail(body, dem, dems.get(1), measured.as_deref());
            cache.join("terrain").join(format!("detail-{}.tif", &key[..16]))
        }
        scenario::Dem::Synthetic { .. } => {
            shape += &format!(" {}", key::of_parameters(synthetic_parameters(dem).as_ref()));
            let key = crate::digest::sha256_hex(shape.as_bytes());
            cache.join("terrain").join(format!("highland-{}.tif", &key[..16]))
        }
    };
    let mut paths: Vec<PathBuf> = dems.iter().rev().map(&mut path).collect();
    paths.reverse();
    paths
}

/// Where the terrain is centred: as asked for, or on the middle of the finest model.
pub fn centre(terrain: &scenario::Terrain, paths: &[PathBuf]) -> Result<Geodetic, Error> {
    match terrain.centre {
        Some(centre) => Ok(centre),
        None => {
            let is_detail = |dem: &&scenario::Dem| matches!(dem, scenario::Dem::Detail { .. });
            let invented = terrain.dems.iter().take_while(is_detail).count();
            let reading = terrain.dems.get(invented).and_then(reading_of).cloned().unwrap_or_default();
            Ok(Dem::middle(&paths[invented], &reading)?)
        }
    }
}

/// What the user says of a model's file; `None`: it is made here.
fn reading_of(dem: &scenario::Dem) -> Option<&Reading> {
    match dem {
        scenario::Dem::File { reading, .. } | scenario::Dem::Cube { reading, .. } => Some(reading),
        scenario::Dem::Globe(globe) => Some(&globe.reading),
        scenario::Dem::Synthetic { .. } | scenario::Dem::Detail { .. } => None,
    }
}

/// Columns or rows of a model that may yet become a map of [`MAX_NODES_PER_SIDE`], which is told once it is read, and of one
/// that may become a cube.
const MOST_SIDE: usize = 2 * MAX_NODES_PER_SIDE;
const MOST_SIDE_OF_CUBE: usize = 8 * MAX_NODES_PER_SIDE;

/// Reads a model, or the part of it that its extent about the centre needs; all of it where there is no centre.
pub fn open(
    written: &scenario::Dem,
    path: &Path,
    body: &Body,
    centre: Option<Geodetic>,
    progress: &dyn Progress,
) -> Result<Dem, Error> {
    let (values, posting_m, extent_m, most_side) = match *written {
        scenario::Dem::File { values, posting_m, extent_m, .. } => (values, posting_m, extent_m, Some(MOST_SIDE)),
        scenario::Dem::Cube { values, posting_m, .. } => (values, posting_m, None, Some(MOST_SIDE_OF_CUBE)),
        scenario::Dem::Globe(scenario::Globe { values, posting_m, .. }) => (values, posting_m, None, None),
        scenario::Dem::Synthetic { .. } | scenario::Dem::Detail { .. } => (raster::Values::Height, None, None, None),
    };
    let reading = reading_of(written).cloned().unwrap_or_default();
    progress.begin(&format!("reading {}", file_name(path)), 1, "file");
    // The map may be turned: the square's corners can lie in any direction.
    let around =
        centre.zip(extent_m).map(|(centre, extent_m)| raster::Around { centre, distance_m: extent_m * SQRT_2 / 2.0 });
    let options = raster::Options { reading, values, posting_m, around, most_side, ..Default::default() };
    Ok(Dem::open(path, body, &options)?)
}

fn synthetic_parameters(written: &scenario::Dem) -> Option<Parameters> {
    let &scenario::Dem::Synthetic { columns, rows, posting_m, centre, seed } = written else { return None };
    Some(Parameters { centre, ..Parameters::highland(columns as usize, rows as usize, posting_m, seed) })
}

/// Makes the synthetic models, coarsest first, unless all are there.
fn make_synthetic(
    body: &Body,
    dems: &[scenario::Dem],
    paths: &[PathBuf],
    progress: &dyn Progress,
) -> Result<(), Error> {
    let wanted = dems.iter().zip(paths).rev();
    let wanted: Vec<_> = wanted.filter_map(|(dem, path)| Some((synthetic_parameters(dem)?, path))).collect();
    if wanted.iter().all(|(_, path)| path.is_file()) {
        wanted.iter().for_each(|(_, path)| used(path));
        return Ok(());
    }
    let mut coarse = None;
    for (parameters, path) in &wanted {
        progress.begin("making terrain", 0, "craters");
        let on_progress = |done: usize, total: usize| progress.at(done, total);
        let terrain = match &coarse {
            Some(coarse) => synthetic::generate_within(body, parameters, coarse, &on_progress)?,
            None => synthetic::generate(body, parameters, &on_progress)?,
        };
        keep(&terrain.craters, path, &|path| terrain.write(path))?;
        coarse = Some(terrain);
    }
    Ok(())
}

/// Makes the ground below the posting of the first measured model, unless it is there.
fn make_detail(
    body: &Body,
    dems: &[scenario::Dem],
    paths: &[PathBuf],
    centre: Geodetic,
    progress: &dyn Progress,
) -> Result<(), Error> {
    let [scenario::Dem::Detail { posting_m, extent_m, seed, craters, boulders_per_km2, .. }, measured, ..] = dems
    else {
        return Ok(());
    };
    if paths[0].is_file() {
        used(&paths[0]);
        return Ok(());
    }
    let measured = open(measured, &paths[1], body, Some(centre), progress)?;
    progress.begin("making ground below the posting", 1, "model");
    let detail = Detail {
        posting_m: *posting_m,
        extent_m: *extent_m,
        centre,
        seed: *seed,
        craters: *craters,
        boulders_per_km2: *boulders_per_km2,
    };
    let continued = synthetic::continue_below(body, &detail, &measured)?;
    keep(&continued.craters, &paths[0], &|path| continued.write(path))
}

/// Says that made terrain and its craters are in use.
fn used(path: &Path) {
    [path, &path.with_extension("craters.csv")].into_iter().for_each(files::cache::touch);
}

/// Writes made terrain and its craters.
fn keep(craters: &[Crater], path: &Path, write: &dyn Fn(&Path) -> Result<(), synthetic::Error>) -> Result<(), Error> {
    let folder = path.parent().unwrap_or(path);
    std::fs::create_dir_all(folder).map_err(|source| Error::Unwritable { path: folder.into(), source })?;
    // The craters first: the terrain's name says that both are there.
    let list = path.with_extension("craters.csv");
    let text = synthetic::craters_csv(craters);
    files::write(&list, text.as_bytes()).map_err(|source| Error::Unwritable { path: list, source })?;
    Ok(write(path)?)
}

/// Makes nodes where a map has no value gaps of a surface, which whoever holds it already does not see.
pub fn open_gaps(surface: &mut Arc<Surface>, map: &[Vec<Vec<f32>>]) {
    let levels = Arc::make_mut(surface).terrain.faces.iter_mut().flat_map(|face| &mut face.levels);
    for (level, values) in levels.zip(map.iter().flatten()) {
        level.gap.iter_mut().zip(values).for_each(|(gap, value)| *gap |= value.is_nan());
    }
}
