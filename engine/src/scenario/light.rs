//! Resolves the Sun, the camera's band and what the one sends through the other.

use std::path::PathBuf;

use super::check::Check;
use super::resolved::{FixedSun, LimbDarkened, Passband, Sun};
use super::spec::{self, Spec};
use crate::photometry::{Curve, SolarSpectrum, VISIBLE_NM};
use crate::quantity::{ASTRONOMICAL_UNIT_M, TOTAL_SOLAR_IRRADIANCE_W_M2};

/// From the ultraviolet to the thermal infrared, where reflected sunlight ends.
const BAND_NM: [f64; 2] = [100.0, 20_000.0];

/// What a Sun of given irradiance is called in records.
const GIVEN: &str = "as given";

/// What all of sunlight is called.
const TOTAL: &str = "total solar irradiance (IAU 2015 B3)";

/// The Sun and the camera's band; `None`: all wavelengths.
pub fn light(spec: &Spec, has_terrain: bool, check: &mut Check) -> (Sun, Option<Passband>) {
    let needs = "needs terrain: the Sun is held in the sky of the terrain's centre";
    check.needs(spec.sun.fixed.is_none() || has_terrain, "sun.fixed", needs);
    let response = response(&spec.camera, check);
    let has_band = spec.camera.band_nm.is_some() || spec.camera.response.is_some();
    let (spectrum, table) = spectrum(spec, has_band, check);
    let (irradiance_w_m2, name, band) = through(spec, spectrum, response, check);
    let sun = Sun {
        limb_darkening: limb_darkening(&spec.sun.disc, band.as_ref()),
        spectrum: name,
        table,
        irradiance_w_m2,
        eclipses: spec.sun.eclipses,
        fixed: spec.sun.fixed.map(|fixed| FixedSun {
            azimuth_rad: fixed.azimuth_deg.to_radians(),
            elevation_rad: fixed.elevation_deg.to_radians(),
            distance_m: fixed.range_au * ASTRONOMICAL_UNIT_M,
        }),
    };
    (sun, band)
}

/// The camera's response, and the file that it comes from.
fn response(camera: &spec::Camera, check: &mut Check) -> Option<(Curve, Option<PathBuf>)> {
    check.needs(
        camera.response.is_none() || camera.band_nm.is_none(),
        "camera.response",
        "contradicts band_nm; give one of the two",
    );
    if let Some(name) = &camera.response {
        let (curve, path) = curve("camera.response", name, check)?;
        check.rule(curve.peak() <= 1.0, "camera.response", format!("{name:?}"), "has values above 1");
        return Some((curve, Some(path)));
    }
    let (low, high) = camera.band_nm?;
    let [lowest, highest] = BAND_NM;
    let rule = format!("must rise from its lower to its upper end within [{lowest}, {highest}] nm");
    let rises = lowest <= low && low < high && high <= highest;
    check.rule(rises, "camera.band_nm", format!("({low}, {high})"), rule);
    rises.then(|| Curve::top_hat([low, high]).ok().map(|curve| (curve, None))).flatten()
}

/// The spectrum, and the file that it comes from.
fn spectrum(spec: &Spec, has_band: bool, check: &mut Check) -> (Option<SolarSpectrum>, Option<PathBuf>) {
    let written = &spec.sun.spectrum;
    let contradicts = spec.sun.irradiance_w_m2.is_some();
    check.needs(written.is_none() || !contradicts, "sun.spectrum", "contradicts irradiance_w_m2; give one of the two");
    let bandless = "needs camera.band_nm or camera.response; without a band all of sunlight counts";
    check.needs(written.is_none() || has_band || contradicts, "sun.spectrum", bandless);
    match written {
        None if has_band && spec.sun.irradiance_w_m2.is_none() => (Some(SolarSpectrum::tsis1_hsrs()), None),
        None => (None, None),
        Some(spec::Spectrum::Tsis1Hsrs) => (Some(SolarSpectrum::tsis1_hsrs()), None),
        Some(spec::Spectrum::E490) => (Some(SolarSpectrum::e490()), None),
        Some(spec::Spectrum::Table(name)) => match curve("sun.spectrum", name, check) {
            Some((curve, path)) => (Some(SolarSpectrum { name: name.clone(), curve }), Some(path)),
            None => (None, None),
        },
    }
}

/// Irradiance at 1 au in the band, the spectrum's name, and the band.
fn through(
    spec: &Spec,
    spectrum: Option<SolarSpectrum>,
    response: Option<(Curve, Option<PathBuf>)>,
    check: &mut Check,
) -> (f64, String, Option<Passband>) {
    let band = response.map(|(response, path)| {
        let width_nm = Curve::integral(&[&response], 0);
        let wavelength_nm = Curve::integral(&[&response], 1) / width_nm;
        Passband { response, path, width_nm, wavelength_nm }
    });
    match (spectrum, band) {
        (Some(spectrum), Some(band)) => match spectrum.through(&band.response) {
            Ok(light) => {
                (light.irradiance_w_m2, spectrum.name, Some(Passband { wavelength_nm: light.wavelength_nm, ..band }))
            }
            Err(error) => {
                let key = if spec.camera.response.is_some() { "camera.response" } else { "camera.band_nm" };
                check.needs(false, key, error.to_string());
                (TOTAL_SOLAR_IRRADIANCE_W_M2, TOTAL.into(), Some(band))
            }
        },
        (_, band) => match spec.sun.irradiance_w_m2 {
            Some(irradiance_w_m2) => (irradiance_w_m2, GIVEN.into(), band),
            None => (TOTAL_SOLAR_IRRADIANCE_W_M2, TOTAL.into(), band),
        },
    }
}

fn limb_darkening(disc: &spec::Disc, band: Option<&Passband>) -> Option<LimbDarkened> {
    let spec::Disc::LimbDarkened { wavelength_nm, law } = *disc else { return None };
    let wavelength_nm = wavelength_nm.or(band.map(|band| band.wavelength_nm)).unwrap_or(VISIBLE_NM);
    Some(LimbDarkened { law, wavelength_m: wavelength_nm * 1e-9 })
}

/// A curve from a file.
fn curve(key: &str, name: &str, check: &mut Check) -> Option<(Curve, PathBuf)> {
    let path = check.file(key, name);
    if path.as_os_str().is_empty() {
        return None;
    }
    let text = crate::text::read(&path).map_err(|error| error.to_string());
    match text.and_then(|text| Curve::parse(&text).map_err(|error| error.to_string())) {
        Ok(curve) => Some((curve, path)),
        Err(error) => {
            check.rule(false, key, format!("{name:?}"), format!("is no curve: {error}"));
            None
        }
    }
}
