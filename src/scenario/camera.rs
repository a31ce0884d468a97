//! Resolves camera, detector and outputs.

use super::resolve::Check;
use super::resolved::{Camera, CraterList, Detector, Landmarks, Outputs};
use super::spec::{self, Spec};
use crate::dataset::Format;
use crate::labels::Limits;

/// 8192²: one float plane of it takes 256 MiB.
const LARGEST_IMAGE_PIXELS: u64 = 1 << 26;

pub fn camera(written: &spec::Camera, check: &mut Check) -> Camera {
    let (columns, rows) = (written.columns, written.rows);
    let pixels = u64::from(columns) * u64::from(rows);
    let rule = format!("has {pixels} pixels, allowed are {LARGEST_IMAGE_PIXELS}");
    check.rule(pixels <= LARGEST_IMAGE_PIXELS, "camera.columns", format!("{columns} with {rows} rows"), rule);
    let side = f64::from(written.samples_per_pixel).sqrt().round() as u32;
    let rule = "is not a square number, as are 1, 4, 9, 16";
    let samples = written.samples_per_pixel;
    check.rule(side * side == samples, "camera.samples_per_pixel", samples, rule);
    let middle = [f64::from(columns) / 2.0, f64::from(rows) / 2.0];
    Camera {
        columns,
        rows,
        focal_length_px: focal_length_px(written, check),
        pixel_pitch_m: written.pixel_pitch_um.map(|pitch_um| pitch_um * 1e-6),
        principal_point_px: written.principal_point.map_or(middle, |point| [point.column, point.row]),
        distortion: written.distortion,
        samples_per_pixel: written.samples_per_pixel,
        f_number: written.f_number,
        transmission: written.transmission,
        exposure_s: written.exposure_s,
    }
}

/// `f / pitch`, or `½ columns / tan(½ field of view)`.
fn focal_length_px(written: &spec::Camera, check: &mut Check) -> f64 {
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
            return 0.5 * f64::from(written.columns) / (0.5 * field_deg.to_radians()).tan();
        }
    }
    1.0
}

pub fn detector(spec: &Spec, check: &mut Check) -> Option<Detector> {
    let detector = spec.detector?;
    let needs = "needs camera.pixel_pitch_um: electrons are counted per area of a pixel";
    check.needs(spec.camera.pixel_pitch_um.is_some(), "detector", needs);
    check.needs(
        spec.camera.band_nm.is_some() || spec.camera.response.is_some(),
        "detector",
        "needs camera.band_nm: a photon's energy is its wavelength's",
    );
    let largest_dn = f64::from((1_u32 << detector.bits.min(16)) - 1);
    let rule = format!("is not below {largest_dn}, the largest number of {} bits", detector.bits);
    check.rule(detector.offset_dn < largest_dn, "detector.offset_dn", detector.offset_dn, rule);
    Some(detector)
}

pub fn outputs(spec: &Spec, check: &mut Check) -> Outputs {
    let planes = &spec.outputs.planes;
    for (index, plane) in planes.iter().enumerate() {
        let twice = planes[..index].contains(plane);
        check.rule(!twice, &format!("outputs.planes[{index}]"), snake_case(&format!("{plane:?}")), "is listed twice");
    }
    let band = spec.camera.band_nm.is_some() || spec.camera.response.is_some();
    for (index, plane) in planes.iter().enumerate().filter(|(_, plane)| plane.is_spectral()) {
        let key = format!("outputs.planes[{index}]");
        check.needs(band, &key, format!("needs camera.band_nm or camera.response: {plane:?} is per nanometre"));
    }
    let formats = &spec.outputs.formats;
    for (index, format) in formats.iter().enumerate() {
        let twice = formats[..index].contains(format);
        let key = format!("outputs.formats[{index}]");
        check.rule(!twice, &key, format!("{format:?}"), "is listed twice");
        let of_craters = matches!(format, Format::Coco | Format::CraterChallenge);
        check.needs(!of_craters || spec.landmarks.is_some(), &key, "needs landmarks, which it lists");
    }
    spec.outputs.clone()
}

/// Lists that exist, of a terrain that has some.
pub fn landmarks(spec: &Spec, check: &mut Check) -> Option<Landmarks> {
    let written = spec.landmarks.as_ref()?;
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
    Some(Landmarks { lists, smallest_px: written.smallest_px, overlay: written.overlay })
}

pub fn hazards(written: &spec::Hazards) -> Limits {
    let spec::Hazards { footprint_m, slope_deg, roughness_m, sunlit_share } = *written;
    Limits { footprint_m, slope_rad: slope_deg.to_radians(), roughness_m, sunlit_share }
}

fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    for char in name.chars() {
        if char.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(char.to_lowercase());
    }
    snake
}
