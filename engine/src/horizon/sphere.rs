//! The bare sphere beyond the end of the terrain.
//!
//! In units of the map's radius, from the lifted point `(x, h)` along the unit map direction `d`, the
//! sphere lies at lifted height `1 − √(K + 2pt + t²)` with `K = 1 + |x|²`, `p = x·d`. With `M = 1 − h`
//! and `D = K − M²` (positive for an observer above the sphere) the tangent from the point touches at
//!
//! ```text
//! t = (pD + M √(D (K − p²)))/(M² − p²)      slope = −(p + t)/√(K + 2pt + t²)
//! ```
//!
//! which is the dip `acos(R/r)`. Where the terrain reaches beyond the tangent point the sphere counts from the
//! terrain's edge outwards. An observer below the sphere stands on one through his own feet instead:
//! the datum must not rise as a cliff at the edge of a low-lying map.

use glam::{DVec2, DVec3};

use crate::terrain::Gnomonic;

/// Slope `dH` per map metre of the bare sphere's skyline beyond `edge_m`, and its map distance.
pub fn skyline_beyond(map: &Gnomonic, observer: DVec3, direction: DVec2, edge_m: f64) -> (f64, f64) {
    let radius_m = map.radius_m;
    let (x, h, edge) = (observer.truncate() / radius_m, observer.z / radius_m, edge_m / radius_m);
    let (k, m, p) = (1.0 + x.length_squared(), 1.0 - h, x.dot(direction));
    let above = x.length_squared() + h * (2.0 - h);
    let reach = |t: f64| (k + t * (2.0 * p + t)).sqrt();
    if above <= 0.0 {
        return (-m / k.sqrt() * (2.0 * p + edge) / (reach(edge) + k.sqrt()), edge_m);
    }
    let touch = (p * above + m * (above * (k - p * p)).sqrt()) / (m * m - p * p);
    if touch >= edge {
        return (-(p + touch) / reach(touch), touch * radius_m);
    }
    // (M − reach)/t without its cancellation.
    (-(above + edge * (2.0 * p + edge)) / ((m + reach(edge)) * edge), edge_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Body, Geodetic};

    /// Dip −acos(R/(R + h)) at the centre and away from it, where the map is oblique.
    #[test]
    fn the_sphere_dips_by_the_arc_cosine_everywhere() {
        let map = Gnomonic::about(&Body::moon(), Geodetic::from_degrees(-90.0, 0.0, 0.0));
        for height_m in [2.0, 100.0, 5000.0, 100_000.0] {
            for at_m in [DVec2::ZERO, DVec2::new(120_000.0, -40_000.0), DVec2::new(-900_000.0, 300_000.0)] {
                for azimuth_rad in [0.0, 0.7, 2.0, 4.4] {
                    let direction = super::super::settings::direction(azimuth_rad);
                    let observer = at_m.extend(map.lifted_height_m(at_m, map.radius_m + height_m));
                    let (slope, _) = skyline_beyond(&map, observer, direction, 0.0);
                    let dip_rad = -map.elevation_tangent(observer, direction, slope).atan();
                    let expected_rad = (map.radius_m / (map.radius_m + height_m)).acos();
                    // acos itself loses 1e-16/dip.
                    assert!((dip_rad - expected_rad).abs() < 1e-11, "{height_m} m at {at_m}: {dip_rad} {expected_rad}");
                }
            }
        }
    }

    #[test]
    fn an_observer_below_the_datum_sees_no_cliff_at_the_edge() {
        let map = Gnomonic::about(&Body::moon(), Geodetic::from_degrees(-90.0, 0.0, 0.0));
        let observer = DVec3::new(0.0, 0.0, -500.0);
        let (slope, _) = skyline_beyond(&map, observer, DVec2::X, 10.0);
        assert!((-1e-5..=0.0).contains(&map.elevation_tangent(observer, DVec2::X, slope)));
    }
}
