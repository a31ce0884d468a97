//! Brightness across shadows, and residuals against the angles of the ground.

use glam::DVec2;
use serde::Serialize;

use super::ScalarImage;
use super::statistics::spread;

/// Photograph and render along a line towards the Sun.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Profile {
    /// Where the line begins, in pixels.
    pub from_px: [f64; 2],
    /// Distance along it, the photograph's number, the render's.
    pub points: Vec<[f64; 3]>,
}

/// Residuals over a range of an angle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bin {
    pub from_deg: f64,
    pub until_deg: f64,
    pub pixels: usize,
    /// Photograph less render.
    pub mean: f64,
    pub sigma: f64,
}

const PROFILES: usize = 3;
/// A profile begins and ends so far from its shadow.
const AROUND_PX: f64 = 12.0;
/// Shadows of one report lie this far apart, over the image's longer side.
const APART: f64 = 0.15;

/// Means of the residuals in bins of an angle; bins without pixels are left out.
pub fn binned(photo: &ScalarImage, fitted: &ScalarImage, angle_deg: &ScalarImage, step_deg: f64) -> Vec<Bin> {
    let residual = photo.zip(fitted, |photo, fitted| photo - fitted);
    let bin = |index: usize| {
        let (from_deg, until_deg) = (index as f64 * step_deg, (index + 1) as f64 * step_deg);
        let inside = residual.pairs(angle_deg).filter(move |(_, angle)| (from_deg..until_deg).contains(angle));
        let values = inside.map(|(residual, _)| residual);
        let (sigma, mean) = spread(values.clone());
        Bin { from_deg, until_deg, pixels: values.count(), mean, sigma }
    };
    (0..(180.0 / step_deg) as usize).map(bin).filter(|bin| bin.pixels > 0).collect()
}

/// Lines through the longest rendered shadows.
pub fn across_shadows(
    photo: &ScalarImage,
    fitted: &ScalarImage,
    sun_fraction: &ScalarImage,
    towards_sun: DVec2,
) -> Vec<Profile> {
    let dark = |at: DVec2| sun_fraction.sample(at.round()) < 0.5;
    let mut runs: Vec<(usize, DVec2)> = Vec::new();
    for index in 0..sun_fraction.values.len() {
        let start = DVec2::new((index % photo.columns) as f64, (index / photo.columns) as f64);
        // The end of a shadow that is farthest from the Sun.
        if dark(start) && !dark(start - towards_sun) && photo.sample(start).is_finite() {
            let length = (1..photo.columns + photo.rows).take_while(|k| dark(start + *k as f64 * towards_sun)).count();
            runs.push((length, start));
        }
    }
    runs.sort_by_key(|run| std::cmp::Reverse(run.0));
    let apart_px = APART * photo.columns.max(photo.rows) as f64;
    let mut chosen: Vec<(usize, DVec2)> = Vec::new();
    for run in runs {
        if chosen.len() < PROFILES && chosen.iter().all(|other| other.1.distance(run.1) > apart_px) {
            chosen.push(run);
        }
    }
    let profile = |(length, start): (usize, DVec2)| {
        let from = start - AROUND_PX * towards_sun;
        let steps = length + 2 * AROUND_PX as usize;
        let at = |k: usize| from + k as f64 * towards_sun;
        let points = (0..=steps).map(|k| [k as f64, photo.sample(at(k)), fitted.sample(at(k))]);
        Profile { from_px: from.to_array(), points: points.filter(|p| p[1].is_finite() && p[2].is_finite()).collect() }
    };
    chosen.into_iter().map(profile).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_fall_into_the_bins_of_their_angle() {
        let angle = ScalarImage::new(4, 1, vec![1.0, 2.0, 7.0, f64::NAN]);
        let photo = ScalarImage::new(4, 1, vec![3.0, 5.0, 10.0, 0.0]);
        let bins = binned(&photo, &ScalarImage::new(4, 1, vec![1.0; 4]), &angle, 5.0);
        assert_eq!(bins.len(), 2);
        assert_eq!((bins[0].pixels, bins[0].mean, bins[0].sigma), (2, 3.0, 1.0));
        assert_eq!((bins[1].from_deg, bins[1].mean), (5.0, 9.0));
    }

    #[test]
    fn a_profile_crosses_the_longest_shadow() {
        let lit = |i: usize| {
            let (x, y) = (i % 100, i / 100);
            if (y == 20 && (30..60).contains(&x)) || (y == 70 && (20..30).contains(&x)) { 0.0 } else { 1.0 }
        };
        let fraction = ScalarImage::new(100, 100, (0..10_000).map(lit).collect());
        let profiles = across_shadows(&fraction, &fraction, &fraction, DVec2::X);
        assert_eq!(profiles[0].from_px, [18.0, 20.0]);
        assert_eq!(profiles[0].points.iter().filter(|point| point[1] < 0.5).count(), 30);
        assert_eq!(profiles.len(), 2);
    }
}
