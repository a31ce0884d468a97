//! The intervals of the exact search: how wide they are, and whether the trace lies in them.

use rayon::prelude::*;

use super::profiles::Profiles;
use crate::scenes::Scene;
use crate::{Table, Value};
use perilune_engine::horizon::Settings;
use perilune_engine::horizon::axis::Major;
use perilune_engine::horizon::exact::{Exact, Interval};
use perilune_engine::statistics::Errors;

/// The table that [`row`] fills.
pub fn table() -> Table {
    Table::new(
        "certificates",
        "Certified intervals of the exact search",
        &[
            ("scene", ""),
            ("samples", ""),
            ("traced outside", "samples"),
            ("median width", "deg"),
            ("p95 width", "deg"),
            ("largest width", "deg"),
        ],
    )
}

/// Intervals at some pixels in all azimuths, held to their traced elevations.
pub fn row(scene: &Scene, settings: &Settings, pixels: &[[usize; 2]], truth: &Profiles) -> Vec<Value> {
    let (mut outside, mut widths_rad) = (0, Vec::new());
    for major in [Major::Row, Major::Column] {
        let exact = Exact::new(&scene.face, 0, major, settings).only(pixels);
        let at = |pixel: &[usize; 2]| exact.receivers.index(major, *pixel);
        let along: Vec<usize> =
            (0..settings.azimuths).filter(|azimuth| Major::of(settings.direction(*azimuth)) == major).collect();
        let found: Vec<(usize, Vec<f64>)> = along
            .into_par_iter()
            .map(|azimuth| {
                let plane = exact.intervals_rad(settings.direction(azimuth));
                let of_pixels = || pixels.iter().map(|pixel| &plane[at(pixel)]).zip(truth);
                let missed = of_pixels().filter(|(interval, truth)| !interval.contains(truth[azimuth])).count();
                let width = |(Interval { low_rad, high_rad }, _): (&Interval, _)| f64::from(high_rad - low_rad);
                (missed, of_pixels().map(width).collect())
            })
            .collect();
        for (missed, widths) in found {
            outside += missed;
            widths_rad.extend(widths);
        }
    }
    let Errors { count, p50, p95, max, .. } = Errors::of(widths_rad);
    let mut row = vec![scene.name.as_str().into(), (count as f64).into(), f64::from(outside as u32).into()];
    row.extend([p50, p95, max].map(|rad| Value::from(rad.to_degrees())));
    row
}
