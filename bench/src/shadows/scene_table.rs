//! What an exposure shows.

use perilune_engine::ephemeris::{horizontal, utc_text};
use perilune_engine::pipeline::Prepared;
use perilune_engine::render::planes::Radiometry;
use perilune_engine::scenario::Scenario;

use super::{PENUMBRA, Trial, lit};
use crate::Table;

/// Columns of the exposure and their units.
const COLUMNS: [(&str, &str); 9] = [
    ("scenario", ""),
    ("epoch", ""),
    ("columns", ""),
    ("rows", ""),
    ("on terrain", "%"),
    ("lit", "%"),
    ("penumbra", "%"),
    ("Sun elevation", "deg"),
    ("Sun azimuth", "deg"),
];

/// What the exposure shows.
pub fn scene_table(scenario: &Scenario, prepared: &Prepared, exposure: usize, truth: &Trial, ground: &[bool]) -> Table {
    let exposure = &prepared.exposures[exposure];
    let sky = horizontal(&prepared.frame.body, prepared.ground.centre, exposure.sun.direction);
    let partial = |pixel: &Radiometry| (PENUMBRA..1.0 - PENUMBRA).contains(&f64::from(pixel.sun_fraction));
    let on_ground = || truth.samples.pixels.iter().zip(ground).filter(|(_, ground)| **ground).map(|(pixel, _)| pixel);
    let share = |count: usize| 100.0 * count as f64 / on_ground().count() as f64;
    let mut table = Table::new("scene", "The exposure", &COLUMNS);
    let pixels = f64::from(scenario.camera.columns * scenario.camera.rows);
    table.rows.push(vec![
        scenario.name.as_str().into(),
        utc_text(exposure.epoch).as_str().into(),
        f64::from(scenario.camera.columns).into(),
        f64::from(scenario.camera.rows).into(),
        (100.0 * on_ground().count() as f64 / pixels).into(),
        share(on_ground().filter(|pixel| lit(pixel)).count()).into(),
        share(on_ground().filter(|pixel| partial(pixel)).count()).into(),
        sky.elevation_rad.to_degrees().into(),
        sky.azimuth_rad.to_degrees().into(),
    ]);
    table
}
