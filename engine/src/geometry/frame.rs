//! Reference frames as types, so that mixing them does not compile.
//!
//! A [`Position`] is a vector in metres from the origin of its frame, a [`Direction`] has length 1,
//! and a [`Rotation<To, From>`] turns components in `From` into components in `To`.

use std::fmt::Debug;
use std::marker::PhantomData;
use std::ops::Mul;

use glam::{DMat3, DQuat, DVec3};

/// A reference frame.
pub trait Frame: Copy + Debug + Send + Sync + 'static {}

macro_rules! frames {
    ($($(#[$doc:meta])* $name:ident)*) => { $(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $name;
        impl Frame for $name {}
    )* };
}

frames! {
    /// Axes of the International Celestial Reference Frame, origin at the body's centre.
    Icrf
    /// Rotates with the body; origin at its centre, +z at the north pole, +x at longitude 0.
    BodyFixed
    /// East, north, up at a point of the surface.
    Local
    /// The axes of a gnomonic map (right, up on the map, outward); origin at its centre of projection.
    Map
    /// OpenCV axes: +x right, +y down, +z along the boresight; origin at the pinhole.
    Camera
}

/// A point, in metres from the origin of `F`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Position<F> {
    vector_m: DVec3,
    frame: PhantomData<F>,
}

impl<F: Frame> Position<F> {
    pub fn from_m(vector_m: DVec3) -> Self {
        Self { vector_m, frame: PhantomData }
    }

    pub fn vector_m(self) -> DVec3 {
        self.vector_m
    }

    /// Distance between two points, in metres.
    pub fn distance_m(self, other: Self) -> f64 {
        self.vector_m.distance(other.vector_m)
    }

    /// The direction from here to `other`, or `None` where they coincide.
    pub fn direction_to(self, other: Self) -> Option<Direction<F>> {
        Direction::new(other.vector_m - self.vector_m)
    }
}

/// A unit vector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction<F> {
    unit: DVec3,
    frame: PhantomData<F>,
}

impl<F: Frame> Direction<F> {
    /// Normalises `vector`; `None` where it is zero or not finite.
    pub fn new(vector: DVec3) -> Option<Self> {
        vector.try_normalize().map(|unit| Self { unit, frame: PhantomData })
    }

    pub fn unit(self) -> DVec3 {
        self.unit
    }

    /// The angle between two directions, in radians, accurate for small angles too.
    pub fn angle_to(self, other: Self) -> f64 {
        self.unit.cross(other.unit).length().atan2(self.unit.dot(other.unit))
    }
}

/// Turns components in `From` into components in `To`; the product of rotations type-checks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation<To, From> {
    matrix: DMat3,
    frames: PhantomData<(To, From)>,
}

impl<To: Frame, From: Frame> Rotation<To, From> {
    /// `matrix` must be orthonormal with determinant +1.
    pub fn from_matrix(matrix: DMat3) -> Self {
        debug_assert!((matrix.determinant() - 1.0).abs() < 1e-6, "not a rotation: {matrix:?}");
        Self { matrix, frames: PhantomData }
    }

    /// The rotation whose rows are the axes of `To`, given in `From`.
    pub fn from_axes(x: DVec3, y: DVec3, z: DVec3) -> Self {
        Self::from_matrix(DMat3::from_cols(x, y, z).transpose())
    }

    pub fn matrix(self) -> DMat3 {
        self.matrix
    }

    /// The quaternion `q` with `q * v_from = v_to`.
    pub fn quaternion(self) -> DQuat {
        DQuat::from_mat3(&self.matrix).normalize()
    }

    pub fn inverse(self) -> Rotation<From, To> {
        Rotation { matrix: self.matrix.transpose(), frames: PhantomData }
    }

    /// Rotates a vector that is neither point nor unit direction (a velocity, a difference).
    pub fn turn(self, vector: DVec3) -> DVec3 {
        self.matrix * vector
    }
}

impl<A: Frame, B: Frame, C: Frame> Mul<Rotation<B, C>> for Rotation<A, B> {
    type Output = Rotation<A, C>;

    fn mul(self, right: Rotation<B, C>) -> Rotation<A, C> {
        Rotation { matrix: self.matrix * right.matrix, frames: PhantomData }
    }
}

impl<To: Frame, From: Frame> Mul<Direction<From>> for Rotation<To, From> {
    type Output = Direction<To>;

    fn mul(self, direction: Direction<From>) -> Direction<To> {
        Direction { unit: self.matrix * direction.unit, frame: PhantomData }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quaternion_of_a_rotation_turns_vectors_like_its_matrix() {
        let matrix = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 1.1);
        let rotation = Rotation::<Camera, BodyFixed>::from_matrix(matrix);
        let vector = DVec3::new(0.3, -0.2, 0.7);
        assert!((rotation.quaternion() * vector - rotation.turn(vector)).length() < 1e-15);
    }

    #[test]
    fn a_small_angle_keeps_its_digits() {
        let a = Direction::<Icrf>::new(DVec3::X).unwrap();
        let b = Direction::<Icrf>::new(DVec3::new(1.0, 1e-9, 0.0)).unwrap();
        assert!((a.angle_to(b) - 1e-9).abs() < 1e-24);
    }

    #[test]
    fn a_zero_vector_has_no_direction() {
        assert!(Direction::<Icrf>::new(DVec3::ZERO).is_none());
        assert!(Direction::<Icrf>::new(DVec3::splat(f64::NAN)).is_none());
    }
}
