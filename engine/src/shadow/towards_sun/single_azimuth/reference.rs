//! The paper's loop, one node and one azimuth at a time, in `f64`.

use glam::{DVec2, DVec3};

use crate::grid::Cell;
use crate::horizon::Settings;
use crate::horizon::sphere::skyline_beyond;
use crate::terrain::{Face, Level};

/// Elevation of the skyline from a node on level `level` in a unit map direction.
pub fn elevation_rad(
    face: &Face,
    level: usize,
    point: DVec3,
    towards: DVec2,
    spacing: f64,
    settings: &Settings,
) -> f64 {
    let map = &face.map;
    let at_m = point.truncate();
    let raised_m = map.lifted_height_m(at_m, map.radius_from_lifted_m(point) + settings.observer_height_m);
    let observer = at_m.extend(if settings.observer_height_m == 0.0 { point.z } else { raised_m });
    let reach_m = settings.search_m.unwrap_or(f64::INFINITY);
    let mut steepest = f64::NEG_INFINITY;
    // Where the finer level ends.
    let mut from_m = 0.0;
    for level in &face.levels[level..] {
        let step_m = spacing * level.posting_m;
        let end_m = exit_m(level, at_m, towards).max(from_m);
        let first = (from_m / step_m).floor() as usize + 1;
        for t_m in (first..).map(|k| k as f64 * step_m).take_while(|t_m| *t_m <= end_m.min(reach_m)) {
            if let Some(height_m) = ground_m(level, at_m + t_m * towards) {
                steepest = steepest.max((height_m - observer.z) / t_m);
            }
        }
        from_m = end_m;
    }
    let (beyond, _) = skyline_beyond(map, observer, towards, from_m);
    map.elevation_tangent(observer, towards, steepest.max(beyond)).atan()
}

/// Where the line from a map point leaves a level.
pub fn exit_m(level: &Level, at_m: DVec2, towards: DVec2) -> f64 {
    let (low, high) = (level.node_m(0, 0), level.node_m(level.columns - 1, level.rows - 1));
    let end = DVec2::select(towards.cmpgt(DVec2::ZERO), high, low);
    let runs = (end - at_m) / towards;
    let run = |axis: usize| if towards[axis] == 0.0 { f64::INFINITY } else { runs[axis] };
    run(0).min(run(1)).max(0.0)
}

/// The bilinear surface; `None` where a gap has a share in it.
fn ground_m(level: &Level, at_m: DVec2) -> Option<f64> {
    let far = DVec2::new((level.columns - 1) as f64, (level.rows - 1) as f64);
    let grid = level.grid_from_map(at_m).clamp(DVec2::ZERO, far);
    let cell = Cell::inside([level.columns, level.rows], grid)?;
    let (corners, shares) = (cell.corners().map(|(column, row)| level.index(column, row)), cell.weights());
    let absent = corners.iter().zip(shares).any(|(corner, share)| level.gap[*corner] && share > 1e-6);
    let height_m = |(corner, share): (&usize, f64)| share * f64::from(level.heights_m[*corner]);
    (!absent).then(|| corners.iter().zip(shares).map(height_m).sum())
}
