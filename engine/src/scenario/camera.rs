//! Resolves camera, detector and outputs.

use std::path::PathBuf;

use super::check::Check;
use super::error::Fault;
use super::resolved::{AutoExposure, Camera, CraterList, Detector, Landmarks, Outputs};
use super::spec::{self, Spec};
use super::text;
use crate::camera::{Correction, Isd, PsfComponent, Shutter, Vignetting};
use crate::dataset::Format;
use crate::labels::{Limits, Wanted};
use crate::render::Quantity;

/// 8192²: one float plane of it takes 256 MiB.
const LARGEST_IMAGE_PIXELS: u64 = 1 << 26;

pub fn camera(spec: &Spec, check: &mut Check) -> (Camera, Option<Detector>) {
    let isd = spec.camera.isd.as_ref().and_then(|name| isd(name, check));
    (resolved(&spec.camera, isd, check), detector(&spec.camera, spec.detector, check))
}

fn resolved(written: &spec::Camera, isd: Option<Box<Isd>>, check: &mut Check) -> Camera {
    let (columns, rows) = size(written, isd.as_deref(), check);
    let pixels = u64::from(columns) * u64::from(rows);
    let rule = format!("has {pixels} pixels, allowed are {LARGEST_IMAGE_PIXELS}");
    check.rule(pixels <= LARGEST_IMAGE_PIXELS, "camera.columns", format!("{columns} with {rows} rows"), rule);
    let side = f64::from(written.samples_per_pixel).sqrt().round() as u32;
    let rule = "is not a square number, as are 1, 4, 9, 16";
    let samples = written.samples_per_pixel;
    check.rule(side * side == samples, "camera.samples_per_pixel", samples, rule);
    check.rule(written.moments % 2 == 1, "camera.moments", written.moments, "is not odd");
    let shutter = isd.as_ref().map_or_else(|| shutter(written.shutter), |isd| isd.shutter);
    if let Err(error) = shutter.check(rows) {
        check.needs(false, "camera.rows", error.to_string());
    }
    let exposed_rows = shutter.exposed_rows(rows);
    let middle = [f64::from(columns) / 2.0, f64::from(exposed_rows) / 2.0];
    let focal_length_px = if written.isd.is_some() { 1.0 } else { focal_length_px(written, columns, check) };
    Camera {
        columns,
        rows,
        focal_length_px: isd.as_ref().map_or(focal_length_px, |isd| isd.camera.optics.focal_px.x),
        pixel_pitch_m: written.pixel_pitch_um.map(|pitch_um| pitch_um * 1e-6),
        principal_point_px: match &isd {
            Some(isd) => (isd.camera.optics.principal_px + 0.5).to_array(),
            None => written.principal_point.map_or(middle, |point| [point.column, point.row]),
        },
        distortion: written.distortion,
        correction: correction(written, focal_length_px, check),
        vignetting: vignetting(written.vignetting),
        spreads: spreads(written, check),
        kernel: kernel(written, check),
        samples_per_pixel: written.samples_per_pixel,
        f_number: written.f_number.unwrap_or(4.0),
        transmission: written.transmission.unwrap_or(1.0),
        exposure_s: written.exposure_s.unwrap_or(1e-3),
        auto_exposure: written.auto_exposure.map(|written| auto_exposure(written, check)),
        moments: written.moments,
        shutter,
        preset: written.preset,
        isd,
    }
}

/// Where one is missing it is reported, and a small one taken.
fn size(written: &spec::Camera, isd: Option<&Isd>, check: &mut Check) -> (u32, u32) {
    if let Some(isd) = isd {
        for (key, given) in [
            ("columns", written.columns.is_some()),
            ("rows", written.rows.is_some()),
            ("focal_length_mm", written.focal_length_mm.is_some()),
            ("field_of_view_deg", written.field_of_view_deg.is_some()),
            ("principal_point", written.principal_point.is_some()),
            ("distortion", written.distortion.is_some()),
            ("correction", written.correction.is_some()),
            ("shutter", written.shutter.is_some()),
            ("preset", written.preset.is_some()),
        ] {
            check.needs(!given, &format!("camera.{key}"), "contradicts isd, which says it");
        }
        return (isd.camera.columns() as u32, isd.camera.rows() as u32);
    }
    let mut side = |key: &str, got: Option<u32>| {
        if got.is_none() && written.isd.is_none() {
            check.report(key, Fault::Missing);
        }
        got.unwrap_or(1).max(1)
    };
    (side("camera.columns", written.columns), side("camera.rows", written.rows))
}

fn isd(name: &str, check: &mut Check) -> Option<Box<Isd>> {
    let path = check.file("camera.isd", name);
    if path.as_os_str().is_empty() {
        return None;
    }
    match Isd::read(&path) {
        Ok(isd) => Some(Box::new(isd)),
        Err(error) => {
            check.needs(false, "camera.isd", format!("cannot be used: {error}"));
            None
        }
    }
}

/// `f / pitch`, or `½ columns / tan(½ field of view)`.
fn focal_length_px(written: &spec::Camera, columns: u32, check: &mut Check) -> f64 {
    match (written.focal_length_mm, written.field_of_view_deg) {
        (Some(_), Some(_)) => {
            check.needs(false, "camera.field_of_view_deg", "contradicts focal_length_mm; give one of the two");
        }
        (None, None) => check.needs(false, "camera", "needs focal_length_mm with pixel_pitch_um, or field_of_view_deg"),
        (Some(focal_length_mm), None) => match written.pixel_pitch_um {
            Some(pitch_um) => return focal_length_mm * 1e3 / pitch_um,
            None => check.needs(false, "camera.focal_length_mm", "needs pixel_pitch_um"),
        },
        (None, Some(field_deg)) => {
            return 0.5 * f64::from(columns) / (0.5 * field_deg.to_radians()).tan();
        }
    }
    1.0
}

/// On the plane at distance 1: millimetres over the focal length.
fn correction(written: &spec::Camera, focal_length_px: f64, check: &mut Check) -> Option<Correction> {
    let correction = written.correction?;
    check.needs(written.distortion.is_none(), "camera.correction", "contradicts distortion; give one of the two");
    let pitch_mm = written.pixel_pitch_um.unwrap_or_else(|| {
        check.needs(false, "camera.correction", "needs pixel_pitch_um: it counts in millimetres");
        1.0
    }) * 1e-3;
    let f2 = (focal_length_px * pitch_mm).powi(2);
    Some(match correction {
        spec::Correction::Radial { k0, k1, k2, k3 } => {
            Correction::Radial([k0, k1 * f2, k2 * f2 * f2, k3 * f2 * f2 * f2])
        }
        spec::Correction::AcrossTrack { k } => Correction::AcrossTrack(k * f2),
    })
}

fn vignetting(written: Option<spec::Vignetting>) -> Vignetting {
    match written {
        None | Some(spec::Vignetting::Cos4) => Vignetting::Cos4,
        Some(spec::Vignetting::Off) => Vignetting::None,
        Some(spec::Vignetting::Polynomial { a2, a4, a6 }) => Vignetting::Polynomial([a2, a4, a6]),
    }
}

fn spreads(written: &spec::Camera, check: &mut Check) -> Vec<PsfComponent> {
    let list = written.psf.as_deref().unwrap_or_default();
    let middle = written.band_nm.map(|(low, high)| 0.5 * (low + high));
    let spread = |(index, spread): (usize, &spec::PsfComponent)| match *spread {
        spec::PsfComponent::Gaussian { sigma_px } => Some(PsfComponent::Gaussian { sigma_px }),
        spec::PsfComponent::Defocus { diameter_px } => Some(PsfComponent::Disc { diameter_px }),
        spec::PsfComponent::Kernel { .. } => None,
        spec::PsfComponent::Airy { wavelength_nm } => {
            let key = format!("camera.psf[{index}]");
            check.needs(written.pixel_pitch_um.is_some(), &key, "needs camera.pixel_pitch_um");
            let known = wavelength_nm.or(middle);
            check.needs(known.is_some(), &key, "needs wavelength_nm, or camera.band_nm");
            let (pitch_um, wavelength_nm) = (written.pixel_pitch_um?, known?);
            Some(PsfComponent::Airy { cutoff_px: wavelength_nm * 1e-3 * written.f_number.unwrap_or(4.0) / pitch_um })
        }
    };
    list.iter().enumerate().filter_map(spread).collect()
}

fn kernel(written: &spec::Camera, check: &mut Check) -> Option<PathBuf> {
    let mut kernel = None;
    for (index, spread) in written.psf.iter().flatten().enumerate() {
        if let spec::PsfComponent::Kernel { path } = spread {
            let key = format!("camera.psf[{index}]");
            check.needs(kernel.is_none(), &key, "is a second kernel; one is allowed");
            kernel = Some(check.file(&format!("{key}.path"), path));
        }
    }
    kernel
}

fn shutter(written: Option<spec::Shutter>) -> Shutter {
    let upwards = |first: spec::First| first == spec::First::Bottom;
    match written.unwrap_or(spec::Shutter::Global) {
        spec::Shutter::Global => Shutter::Global,
        spec::Shutter::Rolling { line_time_s, rows_per_pose, first } => {
            Shutter::Rolling { line_time_s, rows_per_pose: rows_per_pose.max(1), upwards: upwards(first) }
        }
        spec::Shutter::LineScan { line_time_s, first } => Shutter::LineScan { line_time_s, upwards: upwards(first) },
        spec::Shutter::PushFrame { interval_s, framelet_rows, first } => {
            Shutter::PushFrame { interval_s, framelet_rows, upwards: upwards(first) }
        }
    }
}

fn auto_exposure(written: spec::AutoExposure, check: &mut Check) -> AutoExposure {
    let rule = format!("is longer than longest_s = {}", written.longest_s);
    let ordered = written.shortest_s <= written.longest_s;
    check.rule(ordered, "camera.auto_exposure.shortest_s", written.shortest_s, rule);
    written
}

fn detector(camera: &spec::Camera, detector: Option<Detector>, check: &mut Check) -> Option<Detector> {
    check.needs(
        camera.auto_exposure.is_none() || detector.is_some(),
        "camera.auto_exposure",
        "needs a detector, which it fills",
    );
    let detector = detector?;
    let needs = "needs camera.pixel_pitch_um: electrons are counted per area of a pixel";
    check.needs(camera.pixel_pitch_um.is_some(), "detector", needs);
    check.needs(
        camera.band_nm.is_some() || camera.response.is_some(),
        "detector",
        "needs camera.band_nm: a photon's energy is its wavelength's",
    );
    let largest_dn = f64::from((1_u32 << detector.bits.min(16)) - 1);
    let rule = format!("is not below {largest_dn}, the largest number of {} bits", detector.bits);
    check.rule(detector.offset_dn < largest_dn, "detector.offset_dn", detector.offset_dn, rule);
    Some(detector)
}

pub fn outputs(spec: &Spec, camera: &Camera, has_detector: bool, check: &mut Check) -> Outputs {
    let planes = &spec.outputs.planes;
    for (index, plane) in planes.iter().enumerate() {
        let (key, name) = (format!("outputs.planes[{index}]"), text::name(plane));
        let twice = planes[..index].contains(plane);
        check.rule(!twice, &key, &name, "is listed twice");
        let counted = matches!(plane, Quantity::DigitalNumber | Quantity::NoiseFreeDigitalNumber);
        check.rule(!counted || has_detector, &key, &name, "needs a detector");
        let at_once = camera.shutter == Shutter::Global;
        check.rule(!plane.is_label() || at_once, &key, &name, "needs a camera that exposes its rows at once");
    }
    let band = spec.camera.band_nm.is_some() || spec.camera.response.is_some();
    for (index, plane) in planes.iter().enumerate().filter(|(_, plane)| plane.is_spectral()) {
        let key = format!("outputs.planes[{index}]");
        check.needs(
            band,
            &key,
            format!("needs camera.band_nm or camera.response: {} is per nanometre", text::name(plane)),
        );
    }
    let formats = &spec.outputs.formats;
    for (index, format) in formats.iter().enumerate() {
        let twice = formats[..index].contains(format);
        let key = format!("outputs.formats[{index}]");
        check.rule(!twice, &key, text::name(format), "is listed twice");
        let of_craters = matches!(format, Format::Coco | Format::CraterChallenge);
        let on_map = matches!(format, Format::GeoTiff);
        let at_once = camera.shutter == Shutter::Global;
        check.needs(
            !on_map || at_once,
            &key,
            "needs a camera that exposes its rows at once: it is projected from one pose",
        );
        check.needs(!of_craters || spec.landmarks.is_some(), &key, "needs landmarks, which it lists");
    }
    spec.outputs.clone()
}

/// Lists that exist, of a terrain that has some.
pub fn landmarks(spec: &Spec, camera: &Camera, check: &mut Check) -> Option<Landmarks> {
    let written = spec.landmarks.as_ref()?;
    let needs = "needs a camera that exposes its rows at once: craters are projected from one pose";
    check.needs(camera.shutter == Shutter::Global, "landmarks", needs);
    let dems = spec.terrain.as_ref().map_or(&[][..], |terrain| &terrain.dems);
    let is_made = dems.iter().any(|dem| matches!(dem, spec::Dem::Synthetic { .. } | spec::Dem::Detail { .. }));
    let list = |(index, list): (usize, &spec::CraterList)| match list {
        spec::CraterList::Terrain => {
            let needs =
                "needs a Synthetic model or Detail in terrain.dems; craters of measured terrain come from a File";
            check.needs(is_made, &format!("landmarks.lists[{index}]"), needs);
            CraterList::Terrain
        }
        spec::CraterList::File { path } => {
            CraterList::File(check.file(&format!("landmarks.lists[{index}].path"), path))
        }
    };
    let lists = written.lists.iter().enumerate().map(list).collect();
    let &spec::Landmarks { smallest_px, largest_px, most_degraded, overlay, .. } = written;
    check.needs(smallest_px < largest_px, "landmarks.largest_px", "must be more than smallest_px");
    Some(Landmarks { lists, wanted: Wanted { smallest_px, largest_px, most_degraded }, overlay })
}

pub fn hazards(written: &spec::Hazards) -> Limits {
    let spec::Hazards { footprint_m, slope_deg, roughness_m, sunlit_share } = *written;
    Limits { footprint_m, slope_rad: slope_deg.to_radians(), roughness_m, sunlit_share }
}
