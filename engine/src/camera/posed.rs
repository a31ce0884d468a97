//! A camera with the places it stood at while one image was taken.
//!
//! A frame camera takes its image from one pose. A line scanner is a camera of one row, a push-frame camera one of a few
//! rows, that takes many exposures; the image holds them one below the other. So every camera is an optics and a list
//! of poses, and whoever can render one exposure can render all three kinds.
//!
//! # Assumptions
//! The pose stands still during an exposure of a line or framelet.

use glam::DVec2;

use super::{Camera, CameraError};
use crate::geometry::{self, BodyFixed, Direction, Position, Rotation};

/// Where a camera is, and how it is turned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    pub position: Position<BodyFixed>,
    pub camera_from_body: Rotation<geometry::Camera, BodyFixed>,
}

impl Pose {
    /// Between two poses: a straight way at constant speed, a turn about one axis at constant rate.
    pub fn between(&self, other: &Self, share: f64) -> Self {
        let [a, b] = [self, other].map(|pose| pose.camera_from_body.quaternion());
        // q and −q are one attitude; the short way round is meant.
        let b = if a.dot(b) < 0.0 { -b } else { b };
        Self {
            position: Position::from_m(self.position.vector_m().lerp(other.position.vector_m(), share)),
            camera_from_body: Rotation::from_matrix(glam::DMat3::from_quat(a.slerp(b, share).normalize())),
        }
    }
}

/// An image's camera: the optics of one exposure, and the poses of all, the image's top first.
#[derive(Debug, Clone, PartialEq)]
pub struct PosedCamera {
    pub optics: Camera,
    pub poses: Vec<Pose>,
}

impl PosedCamera {
    pub fn columns(&self) -> usize {
        self.optics.columns as usize
    }

    pub fn rows(&self) -> usize {
        self.optics.rows as usize * self.poses.len()
    }

    /// Where an image coordinate looks from and to: the pose of the exposure that holds it. `None` off the image's
    /// rows and where the optics see nothing.
    pub fn ray(&self, pixel: DVec2) -> Option<(Position<BodyFixed>, Direction<BodyFixed>)> {
        let (pose, direction) = self.look(pixel)?;
        Some((pose.position, pose.camera_from_body.inverse() * direction))
    }

    /// The pose of the exposure that holds an image coordinate, and where it looks in the camera's own axes.
    pub fn look(&self, pixel: DVec2) -> Option<(&Pose, Direction<geometry::Camera>)> {
        let rows = f64::from(self.optics.rows);
        let exposure = ((pixel.y + 0.5) / rows).floor().min(self.poses.len() as f64 - 1.0);
        let pose = self.poses.get(exposure as usize).filter(|_| exposure >= 0.0)?;
        Some((pose, self.optics.direction(DVec2::new(pixel.x, pixel.y - exposure * rows))?))
    }

    /// The same image in pixels about `factor` times as large. A line scanner's lines are merged: a row is then as
    /// high as the way flown meanwhile and is seen from the middle of it. A framelet keeps at least one row.
    pub fn coarser(&self, factor: f64) -> Result<Self, CameraError> {
        super::check("camera reduction", factor, 1.0..=65536.0, "[1, 65536]")?;
        let reduced = |size: u32| ((f64::from(size) / factor).round() as u32).max(1);
        let columns = reduced(self.optics.columns);
        if self.poses.len() == 1 || self.optics.rows > 1 {
            let optics = self.optics.resized(columns, reduced(self.optics.rows));
            return Ok(Self { optics, poses: self.poses.clone() });
        }
        let count = reduced(self.poses.len() as u32) as usize;
        let lines = self.poses.len() as f64 / count as f64;
        let mut optics = self.optics.resized(columns, 1);
        // A row of `lines` lines is as many times as high, about the same line of sight.
        optics.principal_px.y /= lines;
        optics.focal_px.y /= lines;
        let poses = (0..count).map(|row| self.pose_at((row as f64 + 0.5) * lines - 0.5)).collect();
        Ok(Self { optics, poses })
    }

    /// The pose at a fractional exposure.
    fn pose_at(&self, exposure: f64) -> Pose {
        let first = (exposure.max(0.0) as usize).min(self.poses.len() - 1);
        let second = (first + 1).min(self.poses.len() - 1);
        self.poses[first].between(&self.poses[second], exposure - first as f64)
    }
}
