//! The pose that explains a motion of the image: how the camera is turned, and its focal length.
//!
//! What the photograph shows at `x` the render shows at `T(x)`, where its sight line meets the ground at `G`. From its
//! own place `p(x)` and with its own axes the camera would see `G` at `x` if it were turned by `Q` and had `1 + f` times
//! its focal length:
//!
//! ```text
//! minimise Σ |u − Q v|² over Q, f,     u = camera_from_body (G − p)/|G − p|,     v ∝ (vx, vy, (1 + f) vz)
//! ```
//!
//! over a grid of pixels, `v` being where pixel `x` looks. `Q` is told as a rotation vector in the camera's axes: *roll*
//! about the boresight, *pitch* about the image's right, *yaw* about its downward axis; the photograph's camera looks
//! along `Q v` in the axes that were told.
//!
//! # Assumptions
//! The place stays: a shift of the ground and a turn are one and the same in a single image, to the parallax of its relief.
//! A scale may be told as the focal length or as the distance. Deviations are the motion's, one by one; errors of the
//! shading and of the terrain that the whole image shares are not in them: on a known scene of 144 pixels the turns come to
//! rest within 1.6 of them, the focal length 4 of them off, 3e-4 or 0.02 pixels at the image's edge. A scanner's scale
//! along its track is its speed, which no focal length explains: [`PoseFit::left_px`] tells what is left.

use glam::{DQuat, DVec2, DVec3};
use serde::Serialize;

use super::register::{Freedom, Motion, Registration};
use crate::camera::{Pose, PosedCamera};
use crate::geometry::Rotation;
use crate::linear::solve;
use crate::terrain::Surface;

/// A turn of the camera and a change of its focal length.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PoseFit {
    /// About x (right), y (down) and z (boresight): pitch, yaw, roll.
    pub turn_rad: [f64; 3],
    pub turn_sigma_rad: [f64; 3],
    /// Focal length over the one told, less 1.
    pub focal: f64,
    pub focal_sigma: f64,
    /// Root mean square of what it leaves of the motion.
    pub left_px: f64,
}

/// Sight lines along a side of the image.
const PROBES: usize = 9;
const ROUNDS: usize = 10;
/// Turn, in radians, and focal length.
const UNKNOWNS: usize = 4;

/// The pose that explains a registration of images with the pixels of `camera`; `None` where nothing was moved.
pub fn explain(camera: &PosedCamera, surface: &Surface, registration: &Registration) -> Option<PoseFit> {
    if registration.freedom == Freedom::Nothing || !registration.settled {
        return None;
    }
    let fit = |motion: Motion| fit(&sights(camera, surface, &motion), registration.freedom);
    let (motion, sigma) = (registration.motion, registration.sigma);
    let found = fit(motion)?;
    let [x, y] = motion.shift_px;
    let moved = [
        Motion { shift_px: [x + sigma.shift_px[0], y], ..motion },
        Motion { shift_px: [x, y + sigma.shift_px[1]], ..motion },
        Motion { rotation_rad: motion.rotation_rad + sigma.rotation_rad, ..motion },
        Motion { scale: motion.scale + sigma.scale, ..motion },
    ];
    let mut variance = [0.0; UNKNOWNS];
    for motion in moved {
        let other = fit(motion)?;
        (0..UNKNOWNS).for_each(|k| variance[k] += (other.0[k] - found.0[k]).powi(2));
    }
    let ([a, b, c, focal], [da, db, dc, focal_sigma]) = (found.0, variance.map(f64::sqrt));
    let left_px = found.1 * camera.optics.focal_px.x.abs();
    Some(PoseFit { turn_rad: [a, b, c], turn_sigma_rad: [da, db, dc], focal, focal_sigma, left_px })
}

impl PoseFit {
    /// This pose of a camera that has an earlier one already, told from where that began.
    pub fn after(&self, earlier: Option<Self>) -> Self {
        let Some(earlier) = earlier else { return *self };
        let turn = |pose: &Self| DQuat::from_scaled_axis(pose.turn_rad.into());
        let turn_rad = (turn(&earlier) * turn(self)).to_scaled_axis().to_array();
        Self { turn_rad, focal: (1.0 + earlier.focal) * (1.0 + self.focal) - 1.0, ..*self }
    }

    /// The camera with this pose.
    pub fn apply(&self, camera: &PosedCamera) -> PosedCamera {
        let mut optics = camera.optics.clone();
        optics.focal_px *= 1.0 + self.focal;
        let back = glam::DMat3::from_quat(DQuat::from_scaled_axis(self.turn_rad.into()).inverse());
        let turned = |pose: &Pose| Pose {
            camera_from_body: Rotation::from_matrix(back * pose.camera_from_body.matrix()),
            ..*pose
        };
        PosedCamera { optics, poses: camera.poses.iter().map(turned).collect() }
    }
}

/// `(v, u)`: where a pixel looks, and where the camera would see what that pixel shows.
fn sights(camera: &PosedCamera, surface: &Surface, motion: &Motion) -> Vec<(DVec3, DVec3)> {
    let (columns, rows) = (camera.columns(), camera.rows());
    let last = DVec2::new(columns as f64, rows as f64) - 1.0;
    let probe = |index: usize| {
        let share = DVec2::new((index % PROBES) as f64, (index / PROBES) as f64) / (PROBES - 1) as f64;
        // A motion of a tenth of the image stays on it.
        let at = last * (0.1 + 0.8 * share);
        let (pose, looks) = camera.look(at)?;
        let (position, direction) = camera.ray(motion.apply(columns, rows, at))?;
        let hit = surface.intersect(position, direction)?;
        let seen = pose.camera_from_body * pose.position.direction_to(hit.position)?;
        Some((looks.unit(), seen.unit()))
    };
    (0..PROBES * PROBES).filter_map(probe).collect()
}

/// Turn and focal length, and the root mean square angle left.
fn fit(sights: &[(DVec3, DVec3)], freedom: Freedom) -> Option<([f64; UNKNOWNS], f64)> {
    let (mut turn, mut focal) = (DQuat::IDENTITY, 0.0);
    let predicted = |turn: DQuat, focal: f64, v: DVec3| turn * (v * DVec3::new(1.0, 1.0, 1.0 + focal)).normalize();
    for _ in 0..ROUNDS {
        let (mut normal, mut right) = ([[0.0; UNKNOWNS]; UNKNOWNS], [0.0; UNKNOWNS]);
        for (v, u) in sights {
            let now = predicted(turn, focal, *v);
            const STEP: f64 = 1e-6;
            let by_focal = (predicted(turn, focal + STEP, *v) - now) / STEP;
            let jacobian = [DVec3::X.cross(now), DVec3::Y.cross(now), DVec3::Z.cross(now), by_focal];
            for (i, a) in jacobian.iter().enumerate() {
                jacobian.iter().enumerate().for_each(|(j, b)| normal[i][j] += a.dot(*b));
                right[i] += a.dot(*u - now);
            }
        }
        if freedom == Freedom::Shift {
            // Neither turned about the boresight nor scaled.
            for fixed in [2, 3] {
                normal.iter_mut().for_each(|row| row[fixed] = 0.0);
                normal[fixed] = [0.0; UNKNOWNS];
                (normal[fixed][fixed], right[fixed]) = (1.0, 0.0);
            }
        }
        let [x, y, z, away] = solve(normal, right)?;
        turn = DQuat::from_scaled_axis(DVec3::new(x, y, z)) * turn;
        focal += away;
    }
    let left: f64 = sights.iter().map(|(v, u)| u.distance_squared(predicted(turn, focal, *v))).sum();
    let [a, b, c] = turn.to_scaled_axis().to_array();
    Some(([a, b, c, focal], (left / sights.len() as f64).sqrt()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::geometry::Position;

    #[test]
    fn one_pose_after_another_is_both_at_once() {
        let pose = |turn_rad: [f64; 3], focal: f64| PoseFit {
            turn_rad,
            turn_sigma_rad: [0.0; 3],
            focal,
            focal_sigma: 0.0,
            left_px: 0.0,
        };
        let camera = PosedCamera {
            optics: Camera::pinhole(10, 10, DVec2::splat(100.0)).unwrap(),
            poses: vec![Pose {
                position: Position::from_m(DVec3::X),
                camera_from_body: Rotation::from_axes(DVec3::Y, DVec3::Z, DVec3::X),
            }],
        };
        let (first, second) = (pose([0.1, -0.2, 0.3], 0.02), pose([-0.05, 0.02, 0.04], -0.01));
        let step_by_step = second.apply(&first.apply(&camera));
        let at_once = second.after(Some(first)).apply(&camera);
        let matrices = [&step_by_step, &at_once].map(|camera| camera.poses[0].camera_from_body.matrix());
        assert!((matrices[0] - matrices[1]).to_cols_array().iter().all(|entry| entry.abs() < 1e-15));
        assert!((step_by_step.optics.focal_px - at_once.optics.focal_px).length() < 1e-12);
        assert_eq!(first.after(None), first);
    }
}
