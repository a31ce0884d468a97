//! Horizons of some pixels of a scene in all azimuths: traced, swept, and how they differ.

use rayon::prelude::*;

use crate::scenes::Scene;
use crate::{Error, Table, Value};
use perilune_engine::horizon::Settings;
use perilune_engine::horizon::axis::Major;
use perilune_engine::horizon::search::Search;
use perilune_engine::horizon::trace::Tracer;
use perilune_engine::statistics::Errors;

/// Horizons of some pixels, `[pixel][azimuth]`, in radians.
pub type Profiles = Vec<Vec<f64>>;

/// The table that [`row`] fills.
pub fn table() -> Table {
    Table::new(
        "errors",
        "Horizons against traced ones",
        &[
            ("scene", ""),
            ("horizons", ""),
            ("samples", ""),
            ("mean", "deg"),
            ("RMS", "deg"),
            ("p50", "deg"),
            ("p95", "deg"),
            ("p99", "deg"),
            ("max", "deg"),
        ],
    )
}

/// Errors of the horizons that go by the name of `label`.
pub fn row(scene: &Scene, label: &str, found: &Errors) -> Vec<Value> {
    let Errors { count, mean, rms, p50, p95, p99, max } = *found;
    let mut row = vec![scene.name.as_str().into(), label.into(), (count as f64).into()];
    row.extend([mean, rms, p50, p95, p99, max].map(|rad| Value::from(rad.to_degrees())));
    row
}

/// The truth.
pub fn traced(scene: &Scene, settings: &Settings, pixels: &[[usize; 2]]) -> Profiles {
    let (tracer, level) = (Tracer::new(&scene.face, settings), &scene.face.levels[0]);
    let profile = |[column, row]: &[usize; 2]| {
        let foot = level.lifted_node(column + level.margin, row + level.margin);
        (0..settings.azimuths).map(|azimuth| tracer.skyline(foot, settings.direction(azimuth)).elevation_rad).collect()
    };
    pixels.par_iter().map(profile).collect()
}

/// What the search that the settings name says.
pub fn searched(scene: &Scene, settings: &Settings, pixels: &[[usize; 2]]) -> Result<Profiles, Error> {
    let mut profiles = vec![vec![0.0; settings.azimuths]; pixels.len()];
    for major in [Major::Row, Major::Column] {
        let search = Search::new(&scene.face, 0, major, settings, None)?.only(pixels);
        let along: Vec<usize> =
            (0..settings.azimuths).filter(|azimuth| Major::of(settings.direction(*azimuth)) == major).collect();
        let at = |pixel: &[usize; 2]| search.receivers().index(major, *pixel);
        let columns = along
            .into_par_iter()
            .map(|azimuth| {
                let plane = search.elevations_rad(settings.direction(azimuth))?;
                Ok((azimuth, pixels.iter().map(|pixel| plane[at(pixel)]).collect()))
            })
            .collect::<Result<Vec<(usize, Vec<f32>)>, Error>>()?;
        for (azimuth, values) in columns {
            profiles.iter_mut().zip(values).for_each(|(profile, value)| profile[azimuth] = f64::from(value));
        }
    }
    Ok(profiles)
}

/// Errors of all azimuths of all pixels.
pub fn errors(truth: &Profiles, tried: &Profiles) -> Errors {
    Errors::of(truth.iter().flatten().zip(tried.iter().flatten()).map(|(truth, tried)| tried - truth))
}
