//! The lifted gnomonic map: the body's surface as a flat height field on which lines stay lines.
//!
//! Seen from a centre of projection with outward axis z, a point `(x, y, z)`, `z > 0`, goes to
//!
//! ```text
//! X = R x/z      Y = R y/z      H = R − R²/z
//! ```
//!
//! `(X, Y)` is the gnomonic map of its direction on the plane that touches the sphere of radius `R`,
//! and `H` the *lifted height*: for a point at radius `r` and central angle `c` from the map's centre
//! `H = R − R²/(r cos c)`, which is close to the height near the centre and bends away with curvature.
//! The map is projective: straight lines go to straight lines, planes to planes, and order in height is
//! kept. View rays, sunrays and great circles are straight in `(X, Y, H)`, so curvature costs nothing and
//! is exact; a convex hull, a tangent or a bound by a maximum means the same in both spaces.
//!
//! # Assumptions
//! None on a sphere or spheroid: a node stores its true distance from the centre of projection. Between
//! nodes the surface is bilinear *in H*, which differs from bilinear in radius by less than
//! `posting²/(8R)`: 7 µm at 10 m on the Moon, 4 mm at 240 m.

use glam::{DMat3, DVec2, DVec3};

use crate::geometry::{Body, BodyFixed, Direction, Geodetic, Map, Position, Rotation};

/// How azimuths on the map grow with those on the ground, for shaders: [`Gnomonic::azimuth_ratio`].
pub const AZIMUTH_RATIO_WGSL: &str = include_str!("azimuth_ratio.wgsl");

/// A gnomonic map with its lifted heights.
#[derive(Debug, Clone, PartialEq)]
pub struct Gnomonic {
    /// Centre of projection, in body-fixed metres: the body's centre, or the local centre of curvature.
    pub origin: Position<BodyFixed>,
    /// Components along (right, up on the map, outward) from body-fixed ones.
    pub map_from_body: Rotation<Map, BodyFixed>,
    /// Radius `R` of the sphere that the plane touches.
    pub radius_m: f64,
}

impl Gnomonic {
    /// A map about a point of `body`, up on the map towards local north (at a pole, the projection axis
    /// of longitude 0). On a spheroid it stands on the sphere of Gaussian curvature at that point.
    pub fn about(body: &Body, centre: Geodetic) -> Self {
        let centre = Geodetic { height_m: 0.0, ..centre };
        let local_from_body = body.local_from_body(centre).matrix();
        let radius_m = body.gaussian_radius_m(centre.latitude_rad);
        let up = body.up(centre).unit();
        let origin_m =
            if body.is_sphere() { DVec3::ZERO } else { body.position_from_geodetic(centre).vector_m() - radius_m * up };
        Self { origin: Position::from_m(origin_m), map_from_body: Rotation::from_matrix(local_from_body), radius_m }
    }

    /// The map's centre seen from its centre of projection, and the axes (east, north, outward) of the map about it with
    /// north up. At a pole the longitude is the one that the map stands on.
    pub fn north_up(&self) -> (Geodetic, DMat3) {
        let axes = self.map_from_body.matrix();
        let (up, outward) = (axes.row(1), axes.row(2));
        let latitude_rad = outward.z.clamp(-1.0, 1.0).asin();
        // Where the meridians meet, the axis that points up tells the longitude that the map stands on.
        let meridian = if outward.truncate().length() > 1e-9 { outward } else { -up * outward.z.signum() };
        let centre = Geodetic { latitude_rad, longitude_east_rad: meridian.y.atan2(meridian.x), height_m: 0.0 };
        let sphere =
            Body { name: String::new(), naif_id: 0, equatorial_radius_m: self.radius_m, polar_radius_m: self.radius_m };
        (centre, sphere.local_from_body(centre).matrix())
    }

    /// The same map turned about its centre, so that `up_m` (a direction on this map) points up.
    pub fn turned_to(self, up_m: DVec2) -> Self {
        let Some(up) = up_m.try_normalize() else { return self };
        let turn = Rotation::<Map, Map>::from_axes(DVec3::new(up.y, -up.x, 0.0), DVec3::new(up.x, up.y, 0.0), DVec3::Z);
        Self { map_from_body: turn * self.map_from_body, ..self }
    }

    /// The six maps of a cube about the body's centre, the first of them about `centre`: each covers
    /// `|X|, |Y| ≤ R`, and neighbours share the heights along their edges.
    pub fn cube(body: &Body, centre: Geodetic) -> [Self; 6] {
        let towards = body.up(Geodetic { height_m: 0.0, ..centre });
        let first = Geodetic { latitude_rad: towards.unit().z.asin(), ..centre };
        let sphere = Body { polar_radius_m: body.equatorial_radius_m, ..body.clone() };
        let [x, y, z] = axes(sphere.local_from_body(first).matrix());
        [(x, y, z), (x, z, -y), (x, -z, y), (-z, y, x), (z, y, -x), (-x, y, -z)].map(|(x, y, z)| Self {
            origin: Position::from_m(DVec3::ZERO),
            map_from_body: Rotation::from_axes(x, y, z),
            radius_m: body.equatorial_radius_m,
        })
    }

    /// `(X, Y, H)` of a body-fixed point; `None` on the far side, `z ≤ 0`.
    pub fn lifted_from_body(&self, position: Position<BodyFixed>) -> Option<DVec3> {
        let p = self.map_vector(position);
        (p.z > 0.0).then(|| self.lift(p))
    }

    /// The vector from the centre of projection, in map axes.
    pub fn map_vector(&self, position: Position<BodyFixed>) -> DVec3 {
        self.map_from_body.turn(position.vector_m() - self.origin.vector_m())
    }

    fn lift(&self, p: DVec3) -> DVec3 {
        let r = self.radius_m;
        // R − R²/z written so that it keeps its digits where z is near R.
        DVec3::new(r * p.x / p.z, r * p.y / p.z, r * (p.z - r) / p.z)
    }

    /// The vector from the centre of projection, in map axes, of a lifted point.
    pub fn unlift(&self, lifted: DVec3) -> DVec3 {
        let r = self.radius_m;
        // R/(R − H) = z/R scales the point of the plane.
        DVec3::new(lifted.x, lifted.y, r) * (r / (r - lifted.z))
    }

    pub fn body_from_lifted(&self, lifted: DVec3) -> Position<BodyFixed> {
        let p = self.map_from_body.inverse().turn(self.unlift(lifted));
        Position::from_m(p + self.origin.vector_m())
    }

    /// The lifted height of the point at `radius_m` from the centre of projection above map point `at_m`.
    pub fn lifted_height_m(&self, at_m: DVec2, radius_m: f64) -> f64 {
        let r = self.radius_m;
        let inverse_cos = (1.0 + at_m.length_squared() / (r * r)).sqrt();
        // R − R²/(r cos c) = R (r − R/cos c)/r
        r * (radius_m - r * inverse_cos) / radius_m
    }

    /// Distance from the centre of projection of a lifted point.
    pub fn radius_from_lifted_m(&self, lifted: DVec3) -> f64 {
        self.unlift(lifted).length()
    }

    /// The direction away from the centre of projection above a map point, in map axes: the *up* that
    /// horizon elevations refer to.
    pub fn up(&self, at_m: DVec2) -> Direction<Map> {
        Direction::new(at_m.extend(self.radius_m)).expect("a plane at distance R misses the origin")
    }

    /// The outward normal of a surface with lifted `gradient` at a lifted point. The tangent plane of the
    /// height field is a plane in space, `−gx x − gy y + (R − H + gx X + gy Y) z/R = R`.
    pub fn normal(&self, lifted: DVec3, gradient: DVec2) -> Direction<Map> {
        let z = 1.0 + (gradient.dot(lifted.truncate()) - lifted.z) / self.radius_m;
        Direction::new((-gradient).extend(z)).expect("a height field has no vertical face")
    }

    /// The straight map direction in which `towards` leaves the vertical above `at_m`: the *map azimuth*
    /// vector, not normalised, zero where `towards` is vertical.
    pub fn map_direction(&self, at_m: DVec2, towards: Direction<Map>) -> DVec2 {
        let s = towards.unit();
        s.truncate() - at_m * (s.z / self.radius_m)
    }

    /// How much faster map azimuth turns than true azimuth, dA_map/dA, for a map direction at `at_m`: the map
    /// stretches distances by 1/cos²c away from its centre and by 1/cos c across.
    pub fn azimuth_ratio(&self, at_m: DVec2, direction: DVec2) -> f64 {
        let along = at_m.dot(direction.normalize_or_zero()) / self.radius_m;
        let stretch = 1.0 + at_m.length_squared() / (self.radius_m * self.radius_m);
        (1.0 - along * along / stretch) * stretch.sqrt()
    }

    /// Elevation above the local horizontal, as its tangent, of the line that leaves the lifted point
    /// `from` in the unit map direction `direction` with lifted slope `slope` = dH/d(map metre):
    ///
    /// ```text
    /// tan ε = (s r/R + q)/√(1 − q²),   q = (X·d/R) cos c,   r/R = 1/((1 − H/R) cos c)
    /// ```
    pub fn elevation_tangent(&self, from: DVec3, direction: DVec2, slope: f64) -> f64 {
        let r = self.radius_m;
        let at = from.truncate();
        let cos_c = 1.0 / (1.0 + at.length_squared() / (r * r)).sqrt();
        let q = at.dot(direction) / r * cos_c;
        let radius_ratio = 1.0 / ((1.0 - from.z / r) * cos_c);
        (slope * radius_ratio + q) / (1.0 - q * q).sqrt()
    }
}

/// The rows of a rotation matrix.
fn axes(matrix: DMat3) -> [DVec3; 3] {
    [matrix.row(0), matrix.row(1), matrix.row(2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> Gnomonic {
        Gnomonic::about(&Body::moon(), Geodetic::from_degrees(-85.0, 30.0, 0.0))
    }

    #[test]
    fn lifting_round_trips_to_a_micrometre() {
        let body = Body::moon();
        for (lat, lon, h) in [(-85.0, 30.0, 0.0), (-86.0, 31.0, 5000.0), (-70.0, -100.0, -4000.0)] {
            let p = body.position_from_geodetic(Geodetic::from_degrees(lat, lon, h));
            let back = map().body_from_lifted(map().lifted_from_body(p).unwrap());
            assert!(p.distance_m(back) < 1e-6);
        }
    }

    #[test]
    fn a_straight_line_in_space_is_straight_when_lifted() {
        let body = Body::moon();
        let a = body.position_from_geodetic(Geodetic::from_degrees(-85.0, 30.0, 9000.0)).vector_m();
        let b = body.position_from_geodetic(Geodetic::from_degrees(-84.0, 70.0, -500.0)).vector_m();
        let [p, q, m] = [0.0, 1.0, 0.3].map(|t| map().lifted_from_body(Position::from_m(a.lerp(b, t))).unwrap());
        let (pq, pm) = (q - p, m - p);
        assert!(pq.cross(pm).length() / pq.length() < 1e-6, "off the line in metres");
    }

    #[test]
    fn the_elevation_of_a_lifted_slope_is_the_angle_in_space() {
        let body = Body::moon();
        let here = body.position_from_geodetic(Geodetic::from_degrees(-85.5, 33.0, 120.0));
        let there = body.position_from_geodetic(Geodetic::from_degrees(-83.0, 10.0, 4000.0));
        let (p, q) = (map().lifted_from_body(here).unwrap(), map().lifted_from_body(there).unwrap());
        let step = (q - p).truncate();
        let tangent = map().elevation_tangent(p, step.normalize(), (q.z - p.z) / step.length());
        let up = here.vector_m().normalize();
        let sight = (there.vector_m() - here.vector_m()).normalize();
        let expected = sight.dot(up) / sight.reject_from(up).length();
        assert!((tangent - expected).abs() < 1e-12, "{tangent} {expected}");
    }

    #[test]
    fn map_azimuth_turns_with_true_azimuth_at_the_stated_ratio() {
        let at = DVec2::new(400_000.0, -700_000.0);
        let up = map().up(at).unit();
        let (east, north) = (up.any_orthonormal_pair().0, up.any_orthonormal_pair().1);
        for azimuth in [0.0_f64, 0.7, 1.9, 3.0] {
            let towards = |a: f64| {
                let direction = Direction::new(a.cos() * north + a.sin() * east).unwrap();
                map().map_direction(at, direction)
            };
            let (a, b) = (towards(azimuth - 1e-5), towards(azimuth + 1e-5));
            let measured = a.angle_to(b).abs() / 2e-5;
            let ratio = map().azimuth_ratio(at, towards(azimuth));
            assert!((measured / ratio - 1.0).abs() < 1e-6, "{measured} {ratio}");
        }
    }

    #[test]
    fn the_normal_of_level_ground_is_up_wherever_on_the_map() {
        let at = DVec2::new(150_000.0, -90_000.0);
        let height = |at: DVec2| map().lifted_height_m(at, 1_737_400.0);
        let gradient =
            DVec2::new(height(at + DVec2::X) - height(at - DVec2::X), height(at + DVec2::Y) - height(at - DVec2::Y))
                / 2.0;
        let normal = map().normal(at.extend(height(at)), gradient);
        assert!(normal.angle_to(map().up(at)) < 1e-6);
    }

    #[test]
    fn map_direction_points_along_the_great_circle() {
        let at = DVec2::new(30_000.0, -12_000.0);
        let towards = Direction::<Map>::new(DVec3::new(0.3, 0.9, -0.1)).unwrap();
        let start = map().unlift(at.extend(0.0));
        let ahead = map().lift(start + 1000.0 * towards.unit());
        let moved = ahead.truncate() - at;
        assert!(moved.perp_dot(map().map_direction(at, towards)).abs() / moved.length() < 1e-6);
    }

    #[test]
    fn cube_faces_are_right_handed_and_cover_six_ways() {
        let faces = Gnomonic::cube(&Body::moon(), Geodetic::from_degrees(10.0, 20.0, 0.0));
        let sum: DVec3 = faces.iter().map(|f| f.map_from_body.matrix().row(2)).sum();
        assert!(sum.length() < 1e-12);
        assert!(faces.iter().all(|f| (f.map_from_body.matrix().determinant() - 1.0).abs() < 1e-12));
    }
}
