//! Shadows in the photograph and in the render: agreement, and how far their edges lie apart.
//!
//! The render is in shadow where less than half of the Sun's disc is seen, the photograph where it is darker than the
//! threshold, a quarter of the way from its darkest to the median of what the render has lit: ground at a shadow's edge
//! is lit at grazing angles. Along the Sun's direction in
//! the image, from each edge of a rendered shadow, the nearest edge of the photograph with the same sense (light to
//! dark or dark to light) is found by linear interpolation between samples:
//!
//! ```text
//! displacement = place in the photograph − place in the render,   positive towards the Sun
//! ```
//!
//! An edge without a counterpart within [`REACH_PX`] counts as unmatched.

use glam::DVec2;
use serde::Serialize;

use super::ScalarImage;
use crate::statistics::quantile;

/// Shadow and light, pixel by pixel, as shares of all.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Confusion {
    pub both_dark: f64,
    pub both_lit: f64,
    /// Lit in the photograph, dark in the render.
    pub only_render_dark: f64,
    pub only_photo_dark: f64,
    /// Dark in both over dark in one.
    pub overlap: f64,
    /// Of the photograph's numbers.
    pub threshold: f64,
}

/// How far shadow edges lie apart, towards the Sun.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Displacement {
    pub edges: usize,
    /// Share without a counterpart.
    pub unmatched: f64,
    pub median_px: f64,
    /// Half the distance of the 16 % and 84 % quantiles.
    pub spread_px: f64,
    pub p95_absolute_px: f64,
    pub median_m: f64,
    pub spread_m: f64,
    pub p95_absolute_m: f64,
    #[serde(skip)]
    pub displacements_px: Vec<f64>,
}

/// Counterparts are looked for this far.
pub const REACH_PX: f64 = 6.0;
const STEP_PX: f64 = 0.25;

/// From the photograph's floor to its lit ground, this far.
const EDGE: f64 = 0.25;
/// The photograph's floor: this quantile.
const FLOOR: f64 = 0.005;

/// The number below which the photograph is in shadow; `None` where nothing or everything is rendered in shadow.
pub fn threshold(photo: &ScalarImage, sun_fraction: &ScalarImage) -> Option<f64> {
    let lit: Vec<f64> = photo.pairs(sun_fraction).filter(|pair| pair.1 >= 0.5).map(|pair| pair.0).collect();
    let all: Vec<f64> = photo.pairs(sun_fraction).map(|pair| pair.0).collect();
    if lit.len() == all.len() {
        return None;
    }
    let floor = quantile(all, FLOOR);
    Some(floor + EDGE * (quantile(lit, 0.5) - floor)).filter(|threshold| threshold.is_finite())
}

pub fn confusion(photo: &ScalarImage, sun_fraction: &ScalarImage, threshold: f64) -> Confusion {
    let mut counts = [[0.0_f64; 2]; 2];
    for (photo, fraction) in photo.pairs(sun_fraction) {
        counts[usize::from(photo < threshold)][usize::from(fraction < 0.5)] += 1.0;
    }
    let all: f64 = counts.iter().flatten().sum();
    let [[both_lit, only_render_dark], [only_photo_dark, both_dark]] = counts.map(|row| row.map(|count| count / all));
    let overlap = both_dark / (both_dark + only_render_dark + only_photo_dark);
    Confusion { both_dark, both_lit, only_render_dark, only_photo_dark, overlap, threshold }
}

/// Displacements of the edges along `towards_sun`, a unit vector of the image; `pixel_m` is a pixel's width on the ground.
pub fn displacement(
    photo: &ScalarImage,
    sun_fraction: &ScalarImage,
    threshold: f64,
    towards_sun: DVec2,
    pixel_m: f64,
) -> Displacement {
    let mut displacements_px = Vec::new();
    let mut edges = 0;
    for row in 0..photo.rows {
        for column in 0..photo.columns {
            let at = DVec2::new(column as f64, row as f64);
            let crossing = |share: f64| sun_fraction.sample(at + share * towards_sun) - 0.5;
            let (here, ahead) = (crossing(0.0), crossing(1.0));
            // A new edge between this point and the next one towards the Sun.
            let crosses = here * ahead < 0.0;
            if !crosses {
                continue;
            }
            let edge = at + here / (here - ahead) * towards_sun;
            match nearest(photo, threshold, edge, towards_sun, ahead > here) {
                Search::Found(offset) => displacements_px.push(offset),
                Search::Nothing => {}
                Search::OffImage => continue,
            }
            edges += 1;
        }
    }
    let at = |share: f64| quantile(displacements_px.clone(), share);
    let absolute = displacements_px.iter().map(|offset| offset.abs()).collect();
    let (median_px, spread_px) = (at(0.5), (at(0.84) - at(0.16)) / 2.0);
    let p95_absolute_px = quantile(absolute, 0.95);
    Displacement {
        edges,
        unmatched: 1.0 - displacements_px.len() as f64 / edges.max(1) as f64,
        median_px,
        spread_px,
        p95_absolute_px,
        median_m: median_px * pixel_m,
        spread_m: spread_px * pixel_m,
        p95_absolute_m: p95_absolute_px * pixel_m,
        displacements_px,
    }
}

enum Search {
    Found(f64),
    Nothing,
    OffImage,
}

/// The crossing of the threshold nearest to `edge`, getting lighter along `direction` or darker.
fn nearest(photo: &ScalarImage, threshold: f64, edge: DVec2, direction: DVec2, lighter: bool) -> Search {
    let steps = (REACH_PX / STEP_PX) as i64;
    let at = |k: i64| photo.sample(edge + k as f64 * STEP_PX * direction) - threshold;
    if !(at(-steps) + at(steps)).is_finite() {
        return Search::OffImage;
    }
    let crossing = |k: i64| {
        let (a, b) = (at(k), at(k + 1));
        let right_sense = if lighter { a < 0.0 && b >= 0.0 } else { a >= 0.0 && b < 0.0 };
        right_sense.then(|| (k as f64 + a / (a - b)) * STEP_PX)
    };
    let found = (-steps..steps).filter_map(crossing).min_by(|a, b| a.abs().total_cmp(&b.abs()));
    found.map_or(Search::Nothing, Search::Found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Dark discs of radius 9 with soft edges, `moved` along +x.
    fn discs(moved: f64) -> ScalarImage {
        let value = |i: usize| {
            let (x, y) = ((i % 120) as f64 - moved, (i / 120) as f64);
            let from = |cx: f64, cy: f64| (x - cx).hypot(y - cy) - 9.0;
            let nearest = from(30.0, 30.0).min(from(80.0, 50.0)).min(from(50.0, 90.0));
            1.0 / (1.0 + (-2.0 * nearest).exp())
        };
        ScalarImage::new(120, 120, (0..120 * 120).map(value).collect())
    }

    #[test]
    fn a_shadow_that_is_displaced_is_found_displaced() {
        for moved in [-2.3, 0.0, 1.6] {
            let photo = discs(moved).map(|lit| 40.0 + 160.0 * lit);
            let threshold = threshold(&photo, &discs(0.0)).unwrap();
            let found = displacement(&photo, &discs(0.0), threshold, DVec2::X, 100.0);
            assert!(found.edges > 80 && found.unmatched < 0.1, "{found:?}");
            // A quarter of the brightness lies ln(3)/2 = 0.55 px inside the sigmoid's middle, on both sides of a disc
            // alike; cubic interpolation errs by some hundredths of a pixel.
            assert!((found.median_px - moved).abs() < 0.6, "{moved}: {}", found.median_px);
            assert!((found.median_m - 100.0 * found.median_px).abs() < 1e-9);
        }
    }

    #[test]
    fn equal_shadows_agree_wholly_and_opposite_ones_do_not() {
        let photo = discs(0.0).map(|lit| 40.0 + 160.0 * lit);
        let same = confusion(&photo, &discs(0.0), 120.0);
        assert_eq!((same.only_photo_dark, same.only_render_dark, same.overlap), (0.0, 0.0, 1.0));
        let opposite = confusion(&photo, &discs(0.0).map(|lit| 1.0 - lit), 120.0);
        assert_eq!((opposite.both_dark, opposite.overlap), (0.0, 0.0));
    }
}
