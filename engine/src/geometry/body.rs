//! Bodies as spheroids: latitude, longitude, height against body-fixed coordinates.
//!
//! Latitude is geodetic: the angle of the spheroid's normal with the equator. On a sphere it is the
//! planetocentric latitude. Longitude is east positive.
//!
//! # References
//! Bowring (1976), Survey Review 23, 323, for the inverse on a spheroid.
#![warn(missing_docs)]

use glam::DVec3;

use super::{BodyFixed, Direction, Local, Position, Rotation};

/// A body as a spheroid about its rotation axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Its name, in lower case.
    pub name: String,
    /// SPICE id of the body, as in 301 for the Moon.
    pub naif_id: i32,
    /// Radius of the spheroid's equator.
    pub equatorial_radius_m: f64,
    /// From the spheroid's middle to its poles.
    pub polar_radius_m: f64,
}

/// A point by latitude, east longitude and height above the spheroid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geodetic {
    /// Planetographic: the angle of the spheroid's normal with the equator's plane, north positive.
    pub latitude_rad: f64,
    /// Longitude, east positive.
    pub longitude_east_rad: f64,
    /// Along the spheroid's normal.
    pub height_m: f64,
}

impl Geodetic {
    /// The point at a latitude and an east longitude in degrees.
    pub fn from_degrees(latitude_deg: f64, longitude_east_deg: f64, height_m: f64) -> Self {
        Self { latitude_rad: latitude_deg.to_radians(), longitude_east_rad: longitude_east_deg.to_radians(), height_m }
    }
}

impl Body {
    /// The Moon as the sphere that LOLA heights refer to.
    pub fn moon() -> Self {
        let radius_m = crate::quantity::LUNAR_RADIUS_M;
        Self { name: "moon".into(), naif_id: 301, equatorial_radius_m: radius_m, polar_radius_m: radius_m }
    }

    /// Mars' spheroid of the IAU Working Group 2015 (Archinal et al. 2018, doi:10.1007/s10569-017-9805-5), as in
    /// `pck00011.tpc`.
    pub fn mars() -> Self {
        Self { name: "mars".into(), naif_id: 499, equatorial_radius_m: 3_396_190.0, polar_radius_m: 3_376_200.0 }
    }

    /// Whether both radii are the same.
    pub fn is_sphere(&self) -> bool {
        self.equatorial_radius_m == self.polar_radius_m
    }

    fn eccentricity_squared(&self) -> f64 {
        1.0 - (self.polar_radius_m / self.equatorial_radius_m).powi(2)
    }

    /// Radius of curvature in the prime vertical.
    fn normal_radius_m(&self, sin_latitude: f64) -> f64 {
        self.equatorial_radius_m / (1.0 - self.eccentricity_squared() * sin_latitude * sin_latitude).sqrt()
    }

    /// Radius of the sphere that fits the spheroid at a latitude: the Gaussian radius `√(M N)`.
    pub fn gaussian_radius_m(&self, latitude_rad: f64) -> f64 {
        let e2 = self.eccentricity_squared();
        let normal_m = self.normal_radius_m(latitude_rad.sin());
        let meridian_m = normal_m.powi(3) * (1.0 - e2) / self.equatorial_radius_m.powi(2);
        (meridian_m * normal_m).sqrt()
    }

    /// The position of a point by latitude, longitude and height.
    pub fn position_from_geodetic(&self, point: Geodetic) -> Position<BodyFixed> {
        let (sin_lat, cos_lat) = point.latitude_rad.sin_cos();
        let (sin_lon, cos_lon) = point.longitude_east_rad.sin_cos();
        let normal_m = self.normal_radius_m(sin_lat);
        let from_axis_m = (normal_m + point.height_m) * cos_lat;
        let z_m = (normal_m * (1.0 - self.eccentricity_squared()) + point.height_m) * sin_lat;
        Position::from_m(DVec3::new(from_axis_m * cos_lon, from_axis_m * sin_lon, z_m))
    }

    /// The latitude, longitude and height of a position.
    pub fn geodetic_from_position(&self, position: Position<BodyFixed>) -> Geodetic {
        let p = position.vector_m();
        let from_axis_m = p.x.hypot(p.y);
        let longitude_east_rad = p.y.atan2(p.x);
        if self.is_sphere() {
            let latitude_rad = p.z.atan2(from_axis_m);
            return Geodetic { latitude_rad, longitude_east_rad, height_m: p.length() - self.equatorial_radius_m };
        }
        let e2 = self.eccentricity_squared();
        let latitude_rad = self.bowring_latitude_rad(p.z, from_axis_m, e2);
        let (sin_lat, cos_lat) = latitude_rad.sin_cos();
        // Height along the normal; this form keeps its digits at the pole and at the equator.
        let height_m =
            from_axis_m * cos_lat + p.z * sin_lat - self.equatorial_radius_m.powi(2) / self.normal_radius_m(sin_lat);
        Geodetic { latitude_rad, longitude_east_rad, height_m }
    }

    /// Bowring's iteration on the parametric latitude; three rounds reach 1e-15 rad near the surface.
    fn bowring_latitude_rad(&self, z_m: f64, from_axis_m: f64, e2: f64) -> f64 {
        let (a, b) = (self.equatorial_radius_m, self.polar_radius_m);
        let second_e2 = e2 / (1.0 - e2);
        let mut parametric_rad = (a * z_m).atan2(b * from_axis_m);
        let mut latitude_rad = parametric_rad;
        for _ in 0..3 {
            let (sin_u, cos_u) = parametric_rad.sin_cos();
            latitude_rad = (z_m + second_e2 * b * sin_u.powi(3)).atan2(from_axis_m - e2 * a * cos_u.powi(3));
            parametric_rad = (b * latitude_rad.sin()).atan2(a * latitude_rad.cos());
        }
        latitude_rad
    }

    /// The outward normal of the spheroid at a latitude and longitude.
    pub fn up(&self, point: Geodetic) -> Direction<BodyFixed> {
        self.local_from_body(point).inverse() * Direction::new(DVec3::Z).expect("z has length 1")
    }

    /// East, north, up at a point. At a pole the longitude given picks the axes.
    pub fn local_from_body(&self, point: Geodetic) -> Rotation<Local, BodyFixed> {
        let (sin_lat, cos_lat) = point.latitude_rad.sin_cos();
        let (sin_lon, cos_lon) = point.longitude_east_rad.sin_cos();
        Rotation::from_axes(
            DVec3::new(-sin_lon, cos_lon, 0.0),
            DVec3::new(-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat),
            DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat),
        )
    }
}

/// How far along a ray a spheroid about the body's centre is first met from outside; `None` where the ray misses it.
pub fn distance_to_spheroid_m(
    radii_m: DVec3,
    origin: Position<BodyFixed>,
    direction: Direction<BodyFixed>,
) -> Option<f64> {
    // The spheroid is the unit sphere in coordinates scaled by its radii.
    let (p, d) = (origin.vector_m() / radii_m, direction.unit() / radii_m);
    let (a, b, c) = (d.length_squared(), p.dot(d), p.length_squared() - 1.0);
    let discriminant = b * b - a * c;
    if discriminant < 0.0 || b >= 0.0 {
        return None;
    }
    // The nearer root, without cancellation.
    let distance_m = c / (discriminant.sqrt() - b);
    (distance_m >= 0.0).then_some(distance_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn geodetic_round_trips_on_sphere_and_spheroid() {
        for body in [Body::moon(), Body::mars()] {
            for latitude_deg in [-90.0, -89.9, -45.0, 0.0, 0.1, 60.0, 90.0] {
                for height_m in [-8000.0, 0.0, 21_000.0, 5e6] {
                    let there = Geodetic::from_degrees(latitude_deg, 137.4, height_m);
                    let back = body.geodetic_from_position(body.position_from_geodetic(there));
                    assert!((back.latitude_rad - there.latitude_rad).abs() < 1e-12, "{there:?} {back:?}");
                    assert!((back.height_m - there.height_m).abs() < 1e-6, "{there:?} {back:?}");
                }
            }
        }
    }

    /// Planetographic and planetocentric latitude differ by 0.338 degrees on Mars at 45.
    #[test]
    fn geodetic_latitude_is_not_planetocentric_on_mars() {
        let p = Body::mars().position_from_geodetic(Geodetic::from_degrees(45.0, 0.0, 0.0)).vector_m();
        let planetocentric_deg = p.z.atan2(p.x).to_degrees();
        assert!((45.0 - planetocentric_deg - 0.338).abs() < 5e-4, "{planetocentric_deg}");
    }
}
