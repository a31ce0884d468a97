//! Shadows that horizons decide, against those that traced horizons decide.

use rayon::prelude::*;

use super::profiles::Profiles;
use crate::scenes::Scene;
use crate::{Error, Table, Value};
use perilune_engine::photometry::{LimbDarkening, SolarDisk};
use perilune_engine::quantity::SOLAR_RADIUS_M;
use perilune_engine::report::plot::{Axis, Curve, Plot};
use perilune_engine::statistics::Errors;

pub const SUN_ELEVATIONS_DEG: [f64; 4] = [1.5, 3.0, 6.0, 15.0];
const ASTRONOMICAL_UNIT_M: f64 = 149_597_870_700.0;

/// The table that [`rows`] fills.
pub fn table() -> Table {
    Table::new(
        "shadows",
        "Shadows by the same horizons against traced ones",
        &[
            ("scene", ""),
            ("horizons", ""),
            ("Sun elevation", "deg"),
            ("pixel error rate", "%"),
            ("penumbra mean", "share of the disc"),
            ("penumbra RMS", "share of the disc"),
            ("all RMS", "share of the disc"),
        ],
    )
}

/// Shadows of the horizons that go by the name of `label`, a row an elevation of the Sun.
pub fn rows(scene: &Scene, label: &str, truth: &Profiles, tried: &Profiles) -> Result<Vec<Vec<Value>>, Error> {
    let row = |elevation_deg: f64| {
        let found = shadows(truth, tried, elevation_deg.to_radians())?;
        let mut row = vec![scene.name.as_str().into(), label.into(), elevation_deg.into()];
        row.extend([100.0 * found.wrong, found.penumbra.mean, found.penumbra.rms, found.rms].map(Value::from));
        Ok(row)
    };
    SUN_ELEVATIONS_DEG.into_iter().map(row).collect()
}

/// The pixel error rate over the Sun's elevation, a plot a scene.
pub fn plots(table: &Table) -> Vec<Plot> {
    let text = |row: &[Value], column: usize| row[column].text();
    let number = |row: &[Value], column: usize| match row[column] {
        Value::Number(number) => number,
        _ => f64::NAN,
    };
    let mut plots: Vec<Plot> = Vec::new();
    for row in &table.rows {
        let title = text(row, 0);
        if plots.last().is_none_or(|plot| plot.title != title) {
            plots.push(Plot {
                title,
                x: Axis::linear("elevation of the Sun [deg]"),
                y: Axis::logarithmic("pixel error rate [%]"),
                curves: Vec::new(),
            });
        }
        let curves = &mut plots.last_mut().expect("pushed above").curves;
        let name = text(row, 1);
        if curves.last().is_none_or(|curve| curve.name != name) {
            curves.push(Curve { name, points: Vec::new(), joined: true });
        }
        curves.last_mut().expect("pushed above").points.push([number(row, 2), number(row, 3)]);
    }
    plots
}

/// Shadows of horizons against those of the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadowErrors {
    /// Share of samples that are lit in one and dark in the other.
    pub wrong: f64,
    /// Of the visible share of the disc, where either sees a part of it.
    pub penumbra: Errors,
    /// RMS of the same where the truth sees a part of the disc: the same samples whatever is tried.
    pub true_penumbra_rms: f64,
    /// Mean and RMS of the same over all samples.
    pub mean: f64,
    pub rms: f64,
}

/// Angular radius of the Sun at 1 au.
pub fn sun_radius_rad() -> f64 {
    (SOLAR_RADIUS_M / ASTRONOMICAL_UNIT_M).asin()
}

/// A Sun at 1 au and at the same elevation in every azimuth; horizons in any order, the same in both.
pub fn shadows<T>(truth: &[Vec<T>], tried: &[Vec<T>], sun_rad: f64) -> Result<ShadowErrors, Error>
where
    T: Copy + Into<f64> + Sync,
{
    let disk = SolarDisk::new(LimbDarkening::Uniform)?;
    let radius_rad = sun_radius_rad();
    let seen = |above_rad: f64| match above_rad / radius_rad {
        height if height <= -1.0 => 1.0,
        height if height >= 1.0 => 0.0,
        height => disk.visible_above(height),
    };
    // Wrong ones, errors in the penumbra, and of wholly lit ones that are wholly dark, or the other way round.
    let of_some = |(truth, tried): (&Vec<T>, &Vec<T>)| {
        let (mut wrong, mut partial, mut whole, mut penumbra) = (0_usize, Vec::new(), [0.0; 2], [0.0; 2]);
        for (truth, tried) in truth.iter().zip(tried) {
            let [truth_rad, tried_rad] = [*truth, *tried].map(|horizon_rad| horizon_rad.into() - sun_rad);
            wrong += usize::from((truth_rad < 0.0) != (tried_rad < 0.0));
            let sure = [truth_rad, tried_rad].iter().all(|above_rad| above_rad.abs() >= radius_rad);
            let error = match sure {
                true if (truth_rad < 0.0) == (tried_rad < 0.0) => continue,
                _ => seen(tried_rad) - seen(truth_rad),
            };
            if truth_rad.abs() < radius_rad {
                penumbra = [penumbra[0] + 1.0, penumbra[1] + error * error];
            }
            if sure {
                whole = [whole[0] + error, whole[1] + error * error];
            } else {
                partial.push(error);
            }
        }
        (wrong, partial, whole, penumbra)
    };
    let found: Vec<_> = truth.par_iter().zip(tried).map(of_some).collect();
    let count = truth.iter().map(Vec::len).sum::<usize>().max(1) as f64;
    let penumbra = Errors::of(found.iter().flat_map(|(_, partial, ..)| partial).copied());
    let whole = |moment: usize| found.iter().map(|(_, _, whole, _)| whole[moment]).sum::<f64>();
    let [count_in_penumbra, squares] = [0, 1].map(|i| found.iter().map(|(.., penumbra)| penumbra[i]).sum::<f64>());
    let partial = penumbra.count as f64;
    Ok(ShadowErrors {
        wrong: found.iter().map(|(wrong, ..)| wrong).sum::<usize>() as f64 / count,
        mean: (whole(0) + partial * penumbra.mean) / count,
        true_penumbra_rms: (squares / count_in_penumbra.max(1.0)).sqrt(),
        rms: ((whole(1) + partial * penumbra.rms * penumbra.rms) / count).sqrt(),
        penumbra,
    })
}

#[cfg(test)]
mod tests {
    use super::super::profiles::errors;
    use super::*;

    #[test]
    fn equal_horizons_err_nowhere_and_raised_ones_by_what_they_are_raised() {
        let truth: Profiles = (0..10).map(|p| (0..100).map(|a| 0.001 * f64::from(p * 7 + a)).collect()).collect();
        let same = shadows(&truth, &truth, 0.05).unwrap();
        assert_eq!((same.wrong, same.rms), (0.0, 0.0));
        let raised: Profiles = truth.iter().map(|profile| profile.iter().map(|h| h + 0.0105).collect()).collect();
        let found = errors(&truth, &raised);
        assert!((found.mean - 0.0105).abs() < 1e-12 && (found.max - 0.0105).abs() < 1e-12);
        // Horizons step by 0.001: those within 0.0105 below the Sun, ten or eleven of each profile's 100, go dark.
        let wrong = shadows(&truth, &raised, 0.0805).unwrap();
        assert!((wrong.wrong - 0.105).abs() < 0.006, "{wrong:?}");
        // Each profile loses the light of 10.5 of its 100 samples.
        assert!((wrong.mean + 0.105).abs() < 1e-3, "{wrong:?}");
        assert!(wrong.penumbra.mean < -0.3, "{wrong:?}");
    }
}
