//! What of the ground was made up below the posting of a measured model.
//!
//! Made-up levels are the first of their face. What they add is the height over the first level that was measured,
//!
//! ```text
//! Δh = (H − H_measured) r/(R − H)
//! ```
//!
//! and how much of what light shows of the ground it is: the share of `Δh` in the mean squared slope over their posting.

use glam::DVec2;

use crate::terrain::{Face, Ground, Hit, Surface};

/// Over the whole made-up level.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct SyntheticDetail {
    pub rms_m: f64,
    pub share_of_squared_slope: f64,
}

/// Height of made-up ground over the measured, at a hit; 0 on measured ground, where `levels` of the first face are made up.
pub fn synthetic_detail_height_m(surface: &Surface, levels: usize, hit: &Hit) -> f64 {
    match hit.ground {
        Ground::Dem { face, level, lifted } if level < levels => {
            let face = &surface.terrain.faces[face];
            let metres = face.map.radius_from_lifted_m(lifted) / (face.map.radius_m - lifted.z);
            (lifted.z - measured_m(face, levels, lifted.truncate())) * metres
        }
        Ground::Gap => f64::NAN,
        _ => 0.0,
    }
}

/// Lifted height of the first measured level.
fn measured_m(face: &Face, levels: usize, at_m: DVec2) -> f64 {
    face.levels.get(levels).and_then(|level| level.bilinear_m(level.grid_from_map(at_m))).unwrap_or(f64::NAN)
}

/// `None` where no level is made up.
pub fn synthetic_detail(surface: &Surface, levels: usize) -> Option<SyntheticDetail> {
    let face = surface.terrain.faces.first()?;
    let finest = face.levels[..levels].first()?;
    let nodes = (0..finest.rows - 1).flat_map(|row| (0..finest.columns - 1).map(move |column| (column, row)));
    let (mut square, mut slopes, mut all_slopes, mut count) = (0.0, 0.0, 0.0, 0.0);
    for (column, row) in nodes {
        let corner = |c: usize, r: usize| {
            let measured_m = measured_m(face, levels, finest.node_m(column + c, row + r));
            (finest.height_m(column + c, row + r) - measured_m, measured_m)
        };
        let (here, right, up) = (corner(0, 0), corner(1, 0), corner(0, 1));
        let squared =
            |part: &dyn Fn((f64, f64)) -> f64| (part(right) - part(here)).powi(2) + (part(up) - part(here)).powi(2);
        let added = squared(&|heights_m| heights_m.0);
        square += here.0 * here.0;
        slopes += added;
        all_slopes += added + squared(&|heights_m| heights_m.1);
        count += 1.0;
    }
    Some(SyntheticDetail { rms_m: f64::sqrt(square / count), share_of_squared_slope: slopes / all_slopes })
}
