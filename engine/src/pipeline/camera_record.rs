//! What is written down about an exposure's camera, its shutter and its detector.

use glam::DVec2;

use super::capture::CapturedExposure;
use super::{Exposure, Prepared};
use crate::camera::{Camera as Optics, Correction, Pose, PsfComponent, Shutter, Vignetting};
use crate::dataset::{CameraEffects, CameraRecord, DetectorRecord, RowPose, SensorRecord};
use crate::geometry::Direction;
use crate::render::Scene;
use crate::scenario::Scenario;

pub fn camera(
    scenario: &Scenario,
    prepared: &Prepared,
    scene: &Scene,
    captured: &CapturedExposure,
    exposure: &Exposure,
) -> CameraRecord {
    let camera = &scenario.camera;
    let record = CameraRecord::opencv(
        [camera.columns as usize, camera.rows as usize],
        camera.focal_length_px,
        camera.principal_point_px,
        camera.distortion.as_ref().map_or([0.0; 5], |d| [d.k1, d.k2, d.p1, d.p2, d.k3]),
    );
    let mut record = CameraRecord { shutter: shutter(scenario, captured), ..record };
    // An ISD's rows may be of another height, or run upwards.
    record.k[1][1] = exposure.view.optics.focal_px.y;
    if let Some(correction) = exposure.view.optics.correction() {
        (record.dist_model, record.dist_coeffs) = corrected(correction);
    }
    record.effects = effects(scenario, prepared, scene, captured, exposure);
    record
}

fn corrected(correction: Correction) -> (String, Vec<f64>) {
    match correction {
        Correction::Radial(k) => {
            let model =
                "from measured to ideal on the plane z = 1: ideal = measured (1 + k0 + k1 r^2 + k2 r^4 + k3 r^6)";
            (model.into(), k.to_vec())
        }
        Correction::AcrossTrack(k) => {
            ("from measured to ideal on the plane z = 1: x_ideal = x / (1 + k x^2), y_ideal = y".into(), vec![k])
        }
        Correction::Added(c) => {
            let model = "from measured to ideal on the plane z = 1: ideal = measured + c0 + c1 r + c2 r^2 + c3 r^3, x and y by turns";
            (model.into(), c.iter().flat_map(|c| c.to_array()).collect())
        }
    }
}

/// Nothing but words where all rows are exposed at once, for an instant.
fn shutter(scenario: &Scenario, captured: &CapturedExposure) -> String {
    let camera = &scenario.camera;
    let direction = |upwards: bool| if upwards { "from the bottom up" } else { "from the top down" };
    let rows = match camera.shutter {
        Shutter::Global => "global".into(),
        Shutter::Rolling { line_time_s, rows_per_pose, upwards } => {
            format!("rolling, {line_time_s} s a row {}, a pose for each {rows_per_pose}", direction(upwards))
        }
        Shutter::LineScan { line_time_s, upwards } => {
            format!("line scan, {line_time_s} s a line {}", direction(upwards))
        }
        Shutter::PushFrame { interval_s, framelet_rows, upwards } => {
            format!("push frame, {interval_s} s a framelet of {framelet_rows} rows {}", direction(upwards))
        }
    };
    match camera.moments {
        1 => format!("{rows}, instantaneous"),
        moments => format!("{rows}, {moments} moments of {} s each", captured.exposure_s / f64::from(moments)),
    }
}

fn effects(
    scenario: &Scenario,
    prepared: &Prepared,
    scene: &Scene,
    captured: &CapturedExposure,
    exposure: &Exposure,
) -> Option<CameraEffects> {
    let camera = &scenario.camera;
    let spread = |spread: &PsfComponent| match spread {
        PsfComponent::Gaussian { sigma_px } => format!("Gaussian, sigma {sigma_px} px"),
        PsfComponent::Airy { cutoff_px } => format!("Airy, wavelength times f-number {cutoff_px:.6} px"),
        PsfComponent::Disc { diameter_px } => format!("defocus, disc of {diameter_px} px"),
    };
    let kernel = camera.kernel.as_deref().map(|path| format!("kernel {}", super::names::file_name(path)));
    let psf: Vec<String> = camera.spreads.iter().map(spread).chain(kernel).collect();
    let vignetting = match camera.vignetting {
        Vignetting::Cos4 => None,
        Vignetting::None => Some("none".into()),
        Vignetting::Polynomial([a2, a4, a6]) => Some(format!(
            "1 + {a2} r^2 + {a4} r^4 + {a6} r^6, r from the principal point in halves of the image's diagonal"
        )),
    };
    let shared = matches!(camera.shutter, Shutter::Rolling { rows_per_pose, .. } if rows_per_pose > 1);
    let effects = CameraEffects {
        psf_cut_off: (!camera.spreads.is_empty()).then_some(captured.psf_cut_off),
        psf,
        vignetting,
        moments: (camera.moments > 1).then_some(camera.moments),
        shared_pose_error_px: shared.then(|| shared_pose_error_px(scenario, prepared, scene, captured, exposure)),
        planes: String::new(),
    };
    let planes = "radiance, radiance factor, focal plane irradiance and digital numbers".into();
    (effects != CameraEffects::default()).then_some(CameraEffects { planes, ..effects })
}

/// How far the ground at the first row of each band, in the middle column, lies from where it would with a pose of its
/// own; without ground there, its direction.
fn shared_pose_error_px(
    scenario: &Scenario,
    prepared: &Prepared,
    scene: &Scene,
    captured: &CapturedExposure,
    exposure: &Exposure,
) -> f64 {
    let optics = &exposure.view.optics;
    let block_s = scenario.camera.shutter.block_time_s();
    let pieces = scenario.camera.shutter.pieces(scenario.camera.rows);
    let off = |(band, (time_s, pose)): (&crate::camera::ExposedRows, &(f64, Pose))| {
        let pixel = DVec2::new(0.5 * (f64::from(optics.columns) - 1.0), band.first_row as f64);
        let Prepared { motions, almanac, frame, .. } = prepared;
        let motion = &motions[exposure.point];
        let ends = [-block_s, block_s].map(|end| motion.pose(almanac, frame, exposure.epoch, time_s + end).ok());
        let moved = ends.into_iter().flatten().filter_map(|own| moved_px(scene, optics, pixel, pose, &own));
        moved.fold(0.0, f64::max)
    };
    pieces.iter().flatten().zip(&captured.bands).map(off).fold(0.0, f64::max)
}

/// Between where a pixel's ground is seen from one pose and from another.
fn moved_px(scene: &Scene, optics: &Optics, pixel: DVec2, from: &Pose, to: &Pose) -> Option<f64> {
    let direction = from.camera_from_body.inverse() * optics.direction(pixel)?;
    let seen = match scene.surface.intersect(from.position, direction) {
        Some(hit) => to.position.direction_to(hit.position)?,
        None => Direction::new(direction.unit())?,
    };
    Some((optics.pixel(to.camera_from_body * seen)? - pixel).length())
}

pub fn rows(captured: &CapturedExposure) -> Vec<RowPose> {
    let row = |(first_row, (t_s, pose)): (&usize, &(f64, Pose))| {
        let q = pose.camera_from_body.quaternion();
        RowPose {
            first_row: *first_row,
            t_s: *t_s,
            r_body_fixed_m: pose.position.vector_m().to_array(),
            q_wxyz: [q.w, q.x, q.y, q.z],
        }
    };
    captured.first_rows.iter().zip(&captured.bands).map(row).collect()
}

pub fn sensor(scenario: &Scenario, captured: &CapturedExposure) -> SensorRecord {
    let camera = &scenario.camera;
    let auto = camera.auto_exposure.map(|auto| {
        format!(
            "so that the {} quantile of the lit pixels fills {} of the detector's range, within {} to {} s",
            auto.quantile, auto.level, auto.shortest_s, auto.longest_s
        )
    });
    SensorRecord {
        seed: scenario.seed,
        exposure_s: captured.exposure_s,
        f_number: camera.f_number,
        transmission: camera.transmission,
        samples_per_pixel: camera.samples_per_pixel,
        gain_e_per_dn: scenario.detector.as_ref().map(|detector| detector.gain_e_per_dn),
        detector: captured.detector.as_ref().map(|detector| DetectorRecord {
            quantum_efficiency: detector.quantum_efficiency,
            wavelength_nm: detector.wavelength_m * 1e9,
            pixel_pitch_um: detector.pixel_pitch_m * 1e6,
            dark_current_e_per_s: detector.dark_current_e_s,
            read_noise_e: detector.read_noise_e,
            prnu: detector.prnu,
            dsnu_e: detector.dsnu_e,
            full_well_e: detector.full_well_e,
            blooming: detector.blooming,
            gain_e_per_dn: scenario.detector.map_or(1.0 / detector.gain_dn_e, |written| written.gain_e_per_dn),
            offset_dn: detector.offset_dn,
            bits: detector.bits,
            noise: "EMVA 1288; random numbers belong to seed, exposure, pixel and stage alone".into(),
        }),
        auto_exposure: auto,
    }
}
