//! Where an observer stands above the ground.

use glam::DVec3;

use crate::terrain::Gnomonic;

/// Below this height above the surface an observer stands on it and his own facet is part of his skyline.
pub(super) const ON_GROUND_M: f64 = 1e-3;

/// The lifted point `height_m` above another one along the vertical.
pub(super) fn raised(map: &Gnomonic, foot: DVec3, height_m: f64) -> DVec3 {
    if height_m == 0.0 {
        return foot;
    }
    let at_m = foot.truncate();
    at_m.extend(map.lifted_height_m(at_m, map.radius_from_lifted_m(foot) + height_m))
}
