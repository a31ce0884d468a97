//! Poses of a sequence as the readers of KITTI and TUM expect them.
//!
//! ```text
//! KITTI  R₁₁ R₁₂ R₁₃ t₁ R₂₁ … t₃   camera i in the axes of camera 0, so that the first line is the identity
//! TUM    time t₁ t₂ t₃ qx qy qz qw    camera in the body's axes, scalar *last*
//! ```
//!
//! Both tell where the camera is (world from camera), the reverse of a record's `camera_from_body`. Camera axes are +x right,
//! +y down, +z forward in all of them. Times of KITTI count from the first exposure, those of TUM are TDB past J2000.
//!
//! # References
//! Geiger, Lenz & Urtasun 2012, doi:10.1109/CVPR.2012.6248074, devkit of the odometry benchmark.
//! Sturm et al. 2012, doi:10.1109/IROS.2012.6385773, file formats.

use glam::{DMat3, DQuat, DVec3};

use super::format::Format;
use super::record::ExposureMetadata;
use crate::ephemeris::Epoch;
use crate::ephemeris::ccsds::Message;

/// The files of all sequences in the formats asked for: names and text.
pub fn files(formats: &[Format], run: &str, frames: &[&ExposureMetadata]) -> Vec<(String, String)> {
    let mut files = Vec::new();
    // The exposures of one point of a sweep are neighbours.
    for frames in frames.chunk_by(|a, b| point(a) == point(b)) {
        let point = point(frames[0]);
        for format in formats {
            let texts = match format {
                Format::Kitti => vec![
                    ("kitti.txt", kitti_poses(frames)),
                    ("times.txt", kitti_times(frames)),
                    ("calib.txt", kitti_calibration(frames)),
                ],
                Format::Tum => vec![("tum.txt", tum(frames))],
                Format::Oem => vec![("oem", oem(frames, run))],
                Format::Aem => vec![("aem", aem(frames, run))],
                _ => Vec::new(),
            };
            files.extend(texts.into_iter().map(|(kind, text)| (format!("{PREFIX}{point:04}.{kind}"), text)));
        }
    }
    files
}

const PREFIX: &str = "sequence_";

/// Whether a file's name is one of these.
pub fn is_one(name: &str) -> bool {
    let numbered = name.strip_prefix(PREFIX).and_then(|rest| rest.split_once('.'));
    numbered.is_some_and(|(number, _)| number.bytes().all(|byte| byte.is_ascii_digit()))
}

fn point(facts: &ExposureMetadata) -> usize {
    facts.sweep.as_ref().map_or(0, |sweep| sweep.point)
}

const AXES: &str = "camera axes: +x right, +y down, +z along the boresight";

fn message<'a>(facts: &'a ExposureMetadata, object: &'a str) -> Message<'a> {
    Message { object, center: &facts.body.name, frame: &facts.body.frame, comment: AXES }
}

fn epoch(facts: &ExposureMetadata) -> Epoch {
    Epoch::from_et_seconds(facts.epoch.tdb_s_past_j2000)
}

fn oem(frames: &[&ExposureMetadata], object: &str) -> String {
    let state = |facts: &&ExposureMetadata| {
        let vector = |values: [f64; 3]| DVec3::from(values);
        (epoch(facts), vector(facts.pose.r_body_fixed_m), vector(facts.pose.v_body_fixed_m_s))
    };
    message(frames[0], object).oem(&frames.iter().map(state).collect::<Vec<_>>())
}

fn aem(frames: &[&ExposureMetadata], object: &str) -> String {
    let attitude = |facts: &&ExposureMetadata| (epoch(facts), facts.pose.q_wxyz);
    message(frames[0], object).aem(&frames.iter().map(attitude).collect::<Vec<_>>())
}

/// Where a camera is: its axes as columns, and its place.
fn body_from_camera(facts: &ExposureMetadata) -> (DMat3, DVec3) {
    let [w, x, y, z] = facts.pose.q_wxyz;
    (DMat3::from_quat(DQuat::from_xyzw(x, y, z, w)).transpose(), DVec3::from(facts.pose.r_body_fixed_m))
}

/// A line of twelve numbers an exposure: the upper three rows of the transform, row by row.
pub fn kitti_poses(frames: &[&ExposureMetadata]) -> String {
    let Some(first) = frames.first() else { return String::new() };
    let (first_axes, first_place) = body_from_camera(first);
    let line = |facts: &&ExposureMetadata| {
        let (axes, place) = body_from_camera(facts);
        let rotation = (first_axes.transpose() * axes).transpose();
        let place = first_axes.transpose() * (place - first_place);
        let row = |index: usize| rotation.col(index).to_array().into_iter().chain([place[index]]);
        joined((0..3).flat_map(row))
    };
    frames.iter().map(line).collect()
}

/// Seconds since the first exposure, a line each.
pub fn kitti_times(frames: &[&ExposureMetadata]) -> String {
    let Some(first) = frames.first() else { return String::new() };
    frames.iter().map(|facts| joined([facts.epoch.tdb_s_past_j2000 - first.epoch.tdb_s_past_j2000])).collect()
}

/// The projection matrix of the only camera, as `P0`. Lens distortion has no place in it.
pub fn kitti_calibration(frames: &[&ExposureMetadata]) -> String {
    let Some(first) = frames.first() else { return String::new() };
    let row = |row: &[f64; 3]| row.iter().copied().chain([0.0]).collect::<Vec<_>>();
    format!("P0: {}", joined(first.camera.k.iter().flat_map(row)))
}

/// A line of time, place and quaternion an exposure.
pub fn tum(frames: &[&ExposureMetadata]) -> String {
    let mut text = "# timestamp tx ty tz qx qy qz qw; body from camera, TDB seconds past J2000, metres\n".to_owned();
    for facts in frames {
        let [w, x, y, z] = facts.pose.q_wxyz;
        let [px, py, pz] = facts.pose.r_body_fixed_m;
        text += &joined([facts.epoch.tdb_s_past_j2000, px, py, pz, -x, -y, -z, w]);
    }
    text
}

fn joined(numbers: impl IntoIterator<Item = f64>) -> String {
    // The sum drops the sign of zero, which says nothing in a pose.
    let texts: Vec<String> = numbers.into_iter().map(|number| (number + 0.0).to_string()).collect();
    texts.join(" ") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::{CameraRecord, EpochRecord, PoseRecord};

    /// Two cameras that look along −z; the second is turned by 90° about its boresight and 10 m further along body x.
    fn frames() -> [ExposureMetadata; 2] {
        let half = 0.5_f64.sqrt();
        let facts = |tdb_s_past_j2000, r_body_fixed_m, q_wxyz| ExposureMetadata {
            epoch: EpochRecord { tdb_s_past_j2000, ..Default::default() },
            pose: PoseRecord { r_body_fixed_m, q_wxyz, ..Default::default() },
            camera: CameraRecord::opencv([4, 2], 100.0, [2.0, 1.0], [0.0; 5]),
            ..Default::default()
        };
        // A turn by 180° about x takes body (x, y, z) to camera (x, −y, −z).
        [
            facts(1.5e8, [0.0, 0.0, 50.0], [0.0, 1.0, 0.0, 0.0]),
            facts(1.5e8 + 0.25, [10.0, 0.0, 50.0], [0.0, half, half, 0.0]),
        ]
    }

    #[test]
    fn kitti_starts_at_the_identity_and_counts_from_it() {
        let frames = frames();
        let frames: Vec<&ExposureMetadata> = frames.iter().collect();
        let poses = kitti_poses(&frames);
        let lines: Vec<Vec<f64>> =
            poses.lines().map(|line| line.split(' ').map(|number| number.parse().unwrap()).collect()).collect();
        assert_eq!(lines[0], [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        // Half a turn about (1, 1, 0)/√2 takes body x to camera y and body y to camera x: of the second camera +x is body +y,
        // which is −y of the first, +y is body +x, which is +x of the first.
        let expected = [0.0, 1.0, 0.0, 10.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        assert!(lines[1].iter().zip(expected).all(|(got, wanted)| (got - wanted).abs() < 1e-12), "{:?}", lines[1]);
        assert_eq!(kitti_times(&frames), "0\n0.25\n");
        assert_eq!(kitti_calibration(&frames), "P0: 100 0 1.5 0 0 100 0.5 0 0 0 1 0\n");
    }

    #[test]
    fn tum_is_scalar_last_and_from_camera_to_body() {
        let frames = frames();
        let text = tum(&frames.iter().collect::<Vec<_>>());
        assert_eq!(text.lines().nth(1), Some("150000000 0 0 50 -1 0 0 0"));
    }
}
