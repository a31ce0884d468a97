//! The sky of a place, and the light of an area by time.

use super::results::{AreaResult, PlaceResult};
use crate::illumination::Track;
use crate::report::plot::{Axis, Curve, Plot};

/// Points of a curve by time; between them, the least and the most are shown.
const BINS: usize = 400;

/// The skyline of a place with what the Sun's centre covers of its sky.
pub fn sky(named: &PlaceResult) -> Plot {
    let deg = |angle_rad: f64| angle_rad.to_degrees();
    let skyline = named.place.skyline().map(|[azimuth_rad, elevation_rad]| [deg(azimuth_rad), deg(elevation_rad)]);
    let mut highest = vec![f64::NEG_INFINITY; 360];
    let mut lowest = vec![f64::INFINITY; 360];
    for moment in &named.moments {
        let bin = (deg(moment.sun_azimuth_rad) as usize).min(359);
        let elevation = deg(moment.sun_elevation_rad);
        (highest[bin], lowest[bin]) = (highest[bin].max(elevation), lowest[bin].min(elevation));
    }
    let curve = |name: &str, values: &[f64]| Curve {
        name: name.into(),
        points: (0..360).map(|bin| [bin as f64 + 0.5, values[bin]]).filter(|[_, value]| value.is_finite()).collect(),
        joined: true,
    };
    Plot {
        title: format!("Sky of {}", named.name),
        x: Axis::linear("azimuth [deg]"),
        y: Axis::linear("elevation [deg]"),
        curves: vec![
            Curve { name: "skyline".into(), points: skyline.collect(), joined: true },
            curve("highest Sun", &highest),
            curve("lowest Sun", &lowest),
        ],
    }
}

/// Share of an area that is lit, and mean share of the disc.
pub fn area(result: &AreaResult, track: &Track) -> Plot {
    let steps = track.steps();
    let bin = steps.div_ceil(BINS);
    let days = |first: usize, last: usize| (first + last) as f64 / 2.0 * track.step_h() / 24.0;
    let curve = |name: &str, series: &[f64], of: &dyn Fn(&[f64]) -> f64| {
        let point = |(index, values): (usize, &[f64])| {
            let first = index * bin;
            [days(first, first + values.len() - 1), 100.0 * of(values)]
        };
        Curve { name: name.into(), points: series.chunks(bin).enumerate().map(point).collect(), joined: true }
    };
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let mut curves = vec![
        curve("lit", &result.series.lit_share, &mean),
        curve("share of the disc", &result.series.disc_share, &mean),
    ];
    if bin > 1 {
        let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        curves.push(curve("lit, least", &result.series.lit_share, &least));
        curves.push(curve("lit, most", &result.series.lit_share, &most));
    }
    let span =
        if bin > 1 { format!(", means of {:.1} days", bin as f64 * track.step_h() / 24.0) } else { String::new() };
    Plot {
        title: format!("Light of {}{span}", result.name),
        x: Axis::linear("days from the first step"),
        y: Axis::linear("share of the area [%]"),
        curves,
    }
}
